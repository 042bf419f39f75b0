#![no_main]
//! Digital Surf files, plain and compressed.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    asperity_fuzz::read(bytes);
    for signature in [b"DIGITAL SURF", b"DSCOMPRESSED"] {
        asperity_fuzz::read_with(signature, bytes);
    }
});
