#![no_main]
//! Texts of unknown shape.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = asperity::scans::text_shape::TextShape::of(bytes);
});
