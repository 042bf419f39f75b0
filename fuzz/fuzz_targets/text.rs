#![no_main]
//! Texts of unknown shape.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Some(shape) = asperity_fuzz::scans::text_shape::TextShape::of(bytes) {
        let _ = shape.recipe_section();
    }
});
