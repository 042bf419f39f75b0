#![no_main]
//! X3P files: as they are, and as archives whose members are the parts between zero bytes, since
//! hardly any change of an archive gets past its checksums.

use libfuzzer_sys::fuzz_target;
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;

fuzz_target!(|bytes: &[u8]| {
    asperity_fuzz::read(bytes);
    let mut parts = bytes.splitn(2, |byte| *byte == 0);
    let document = parts.next().unwrap_or_default();
    let heights = parts.next().unwrap_or_default();
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, part) in
        [("main.xml", document), ("bindata/data.bin", heights), ("bindata/valid.bin", &[0b101])]
    {
        archive
            .start_file(
                name,
                SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored),
            )
            .expect("a new name");
        archive.write_all(part).expect("memory");
    }
    asperity_fuzz::read(archive.finish().expect("memory").get_ref());
});
