//! Small files that were made to take much.

use super::{ALONE, read_within_promise};
use std::io::{Cursor, Write};
use std::sync::PoisonError;
use zip::CompressionMethod;
use zip::write::SimpleFileOptions;

const MEGA: usize = 1 << 20;

fn archive(members: &[(&str, &[u8])], method: CompressionMethod) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in members {
        archive.start_file(*name, SimpleFileOptions::default().compression_method(method)).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn x3p(document: &str, method: CompressionMethod) -> Vec<u8> {
    archive(&[("main.xml", document.as_bytes())], method)
}

fn document(size: (u64, u64), data: &str) -> String {
    let (columns, rows) = size;
    format!(
        "<R><Record1><FeatureType>SUR</FeatureType><Axes>\
         <CX><AxisType>I</AxisType><Increment>2e-6</Increment></CX>\
         <CY><AxisType>I</AxisType><Increment>3e-6</Increment></CY>\
         <CZ><AxisType>A</AxisType><DataType>D</DataType></CZ></Axes></Record1>\
         <Record3><MatrixDimension><SizeX>{columns}</SizeX><SizeY>{rows}</SizeY><SizeZ>1</SizeZ>\
         </MatrixDimension>{data}</Record3></R>"
    )
}

/// A compressed Digital Surf surface of 16-bit heights in one stream.
fn digital_surf(columns: i32, rows: i32, packed: &[u8], stated: u32) -> Vec<u8> {
    let mut bytes = vec![0; 512];
    let mut put = |offset: usize, field: &[u8]| {
        bytes[offset..offset + field.len()].copy_from_slice(field);
    };
    put(0, b"DSCOMPRESSED");
    put(14, &1_i16.to_le_bytes());
    put(18, &2_i16.to_le_bytes());
    put(98, &16_i16.to_le_bytes());
    put(108, &columns.to_le_bytes());
    put(112, &rows.to_le_bytes());
    put(120, &[1.0_f32.to_le_bytes(), 1.0_f32.to_le_bytes(), 1.0_f32.to_le_bytes()].concat());
    put(180, b"um              um              um");
    bytes.extend(1_u32.to_le_bytes());
    bytes.extend(stated.to_le_bytes());
    bytes.extend((packed.len() as u32).to_le_bytes());
    bytes.extend(packed);
    bytes
}

fn zlib_of_zeros(length: usize) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    for _ in 0..length / MEGA {
        encoder.write_all(&[0; MEGA]).unwrap();
    }
    encoder.finish().unwrap()
}

#[track_caller]
fn refused(name: &str, bytes: &[u8], parts: &[&str]) {
    let answer = read_within_promise(name, bytes);
    for part in parts {
        assert!(answer.contains(part), "{name}: `{part}` is not in {answer}");
    }
}

#[test]
fn documents_of_x3p() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let packed = CompressionMethod::Deflated;
    let stored = CompressionMethod::Stored;
    // 94 kB that took 10 GB: each of 45 000 children had the name of its parent in its path.
    let name = "n".repeat(240_000);
    let children = format!("<R><{name}>{}</{name}></R>", "<a/>".repeat(45_000));
    refused("names", &x3p(&children, packed), &["Record1/FeatureType", "absent"]);
    let names: String = (0..40).map(|i| format!("<{}{i}>", "n".repeat(200_000))).collect();
    refused("nested names", &x3p(&format!("<R>{names}"), stored), &["names of elements"]);
    let attributes: String = (0..MEGA / 2).map(|i| format!(" a{i}=''")).collect();
    refused("attributes", &x3p(&format!("<R{attributes}/>"), stored), &["more than 262144 bytes"]);
    let comment = format!("<R><!--{}--></R>", "c".repeat(8 * MEGA));
    refused("comment", &x3p(&comment, stored), &["more than 262144 bytes"]);
    let text = format!("<R><Record2><Comment>{}", "a&amp;".repeat(MEGA));
    refused("text", &x3p(&text, stored), &["Record2/Comment", "the length of the text"]);
    let texts: String = (0..90_000).map(|i| format!("<e{i}>text</e{i}>")).collect();
    refused("elements", &x3p(&format!("<R>{texts}</R>"), packed), &["Record1/FeatureType"]);
    let data = format!("<DataList>{}</DataList>", "<Datum/>".repeat(5 * MEGA / 8));
    let undeclared = format!("<R><Record3>{data}</Record3></R>");
    refused(
        "data before their number",
        &x3p(&undeclared, stored),
        &["65537", "MatrixDimension before"],
    );
    let many = document((1 << 14, 1 << 14), &data);
    refused(
        "more declared than there",
        &x3p(&many, stored),
        &["number of data", "expected 268435456"],
    );
    let missing = document((5 << 20 >> 3, 1), &data);
    refused("data without heights", &x3p(&missing, stored), &["heights are missing"]);
    refused("packed data", &x3p(&missing, packed), &["heights are missing"]);
    let blanks = format!("<R>{}</R>", " ".repeat(64 * MEGA));
    refused(
        "a bomb of blanks",
        &x3p(&blanks, packed),
        &["main.xml", "unpack to 67108871", "200 times"],
    );
}

#[test]
fn archives() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    // With `main.xml` among them it is taken for an X3P file.
    let members = (0..30_000).map(|i| format!("member_{i}"));
    let names: Vec<String> = members.chain(["main.xml".into()]).collect();
    let members: Vec<(&str, &[u8])> = names.iter().map(|name| (name.as_str(), &b""[..])).collect();
    refused("members", &archive(&members, CompressionMethod::Stored), &["archive members", "1000"]);
    let inner = archive(&[("main.xml", &[b' '; MEGA])], CompressionMethod::Deflated);
    let nested = archive(&[("main.xml", &inner)], CompressionMethod::Stored);
    refused("an archive in an archive", &nested, &["file: "]);
    let link = "<DataLink><PointDataLink>data</PointDataLink></DataLink>";
    let main = document((1 << 13, 1 << 10), link);
    let zeros = vec![0; 64 * MEGA];
    let bomb =
        archive(&[("main.xml", main.as_bytes()), ("data", &zeros)], CompressionMethod::Deflated);
    refused(
        "a bomb of heights",
        &bomb,
        &["archive member data", "unpack to 67108864", "200 times"],
    );
    // The sizes that an archive states are not believed: the size of the data is that of the stored member.
    let short =
        archive(&[("main.xml", main.as_bytes()), ("data", &[0; 10])], CompressionMethod::Stored);
    refused("fewer heights than declared", &short, &["its length in bytes", "67108864"]);
}

#[test]
fn compressed_surfaces() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    // 1 MB that was taken for 16384 x 16384 points.
    let packed = zlib_of_zeros(512 * MEGA);
    let surface = digital_surf(1 << 14, 1 << 14, &packed, 512 << 20);
    refused("zeros", &surface, &["unpack to 536870912", "200 times"]);
    let noise: Vec<u8> =
        (0..4 * MEGA).map(|i| (i.wrapping_mul(2_654_435_761) >> 11) as u8).collect();
    let surface = digital_surf(1 << 14, 1 << 14, &noise, 512 << 20);
    refused("no stream", &surface, &["file: byte", "copy the file again"]);
    let small = zlib_of_zeros(MEGA);
    refused(
        "a stream of another length",
        &digital_surf(700, 700, &small, 980_000),
        &["after its length"],
    );
}

#[test]
fn texts() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let erd = |body: &[u8]| {
        [b"ERDFILEV2.00\n1,-1,-1,1,5,0.1,-1\nUNITSNAMmm\nXUNITS  m\n".as_slice(), body].concat()
    };
    let bytes = |what: &str| what.repeat(8 * MEGA / what.len()).into_bytes();
    for end in ["\n", "\r", "\r\n", "\n\n \n"] {
        refused("line ends", &bytes(end), &["empty"]);
        refused("line ends of ERD", &erd(&bytes(end)), &["a line END"]);
        refused(
            "line ends behind END",
            &erd(&[b"END\n".to_vec(), bytes(end)].concat()),
            &["missing"],
        );
    }
    refused("separators", &bytes(","), &["line"]);
    refused("blanks and numbers", &bytes("1 "), &["line"]);
    refused("one number", &bytes("1"), &["line 1", "4194304 bytes"]);
    refused("quotation marks", &bytes("\"\n1\n"), &["line 1", "quotation mark"]);
    refused("cells in quotation marks", &[bytes("\"\","), b"\n".to_vec()].concat(), &["line 1"]);
    let keywords = erd(&bytes("TITLE   a\nXUNITS  m\n"));
    refused("keywords", &keywords, &["a line END"]);
    refused(
        "letters of another encoding",
        &[b"# ".to_vec(), vec![0x80; 8 * MEGA]].concat(),
        &["line 1"],
    );
    let fields = [b"aISO-1.0\n".to_vec(), bytes("=\n")].concat();
    refused("fields of SDF", &fields, &["number of fields", "1000"]);
    let header = "aISO-1.0\nNumPoints=4000000\nNumProfiles=1\nXscale=1e-6\nYscale=0\nZscale=1\nDataType=7\n*\n";
    refused(
        "heights of SDF",
        &[header.as_bytes().to_vec(), bytes("1\n")].concat(),
        &["4000001 or more"],
    );
    let many = header.replace("4000000", "268435456");
    refused("points of SDF", many.as_bytes(), &["heights must have 536870911 bytes"]);
    let gwyddion = "# a: b\n# c: 1 m\n# d: 1 m\n# e: m\n";
    for body in ["1 ", "1\n", "\n"] {
        read_within_promise("Gwyddion", &[gwyddion.as_bytes().to_vec(), bytes(body)].concat());
    }
}
