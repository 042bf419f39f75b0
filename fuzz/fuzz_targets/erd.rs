#![no_main]
//! ERD files.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    asperity_fuzz::read(bytes);
    asperity_fuzz::read_with(b"ERDFILEV2.00\n", bytes);
});
