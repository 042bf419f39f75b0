#![no_main]
//! Digital Surf files, plain and compressed.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for signature in [b"DIGITAL SURF", b"DSCOMPRESSED"] {
        let _ = asperity::scans::file::parse_file("fuzz", &[signature.as_slice(), bytes].concat());
    }
});
