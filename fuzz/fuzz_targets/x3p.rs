#![no_main]
//! X3P files.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = asperity::scans::file::parse_file("fuzz", &[b"PK\x03\x04".as_slice(), bytes].concat());
});
