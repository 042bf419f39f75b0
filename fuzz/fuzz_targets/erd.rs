#![no_main]
//! ERD files.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = asperity::scans::file::parse_file("fuzz", &[b"ERDFILEV2.00\n".as_slice(), bytes].concat());
});
