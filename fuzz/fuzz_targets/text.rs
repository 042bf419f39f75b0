#![no_main]
//! Texts of unknown shape, height maps of Gwyddion, and the descriptions proposed for the rest.

use asperity_fuzz::scans::text_shape::TextShape;
use asperity_fuzz::scans::{TextFormat, parse_text};
use libfuzzer_sys::fuzz_target;

#[derive(serde::Deserialize)]
struct File {
    ingest: Ingest,
}

#[derive(serde::Deserialize)]
struct Ingest {
    text: TextFormat,
}

fuzz_target!(|bytes: &[u8]| {
    asperity_fuzz::read(bytes);
    if let Some(shape) = TextShape::of(bytes) {
        let section = shape.recipe_section();
        if let Ok(format) = shape.format() {
            let file: File = toml::from_str(&section).expect("the proposed section is TOML");
            assert_eq!(file.ingest.text, format);
            asperity_fuzz::within_memory(bytes.len(), || {
                let _ = parse_text("fuzz", bytes, &format);
                0
            });
        }
    }
});
