#![no_main]
//! Binary and text SDF files.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    asperity_fuzz::read(bytes);
    for version in ["aBCR-1.0", "aISO-1.0", "bBCR-1.0", "bISO-1.0", "bISO-2.0"] {
        asperity_fuzz::read_with(version.as_bytes(), bytes);
    }
});
