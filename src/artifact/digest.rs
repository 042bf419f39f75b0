//! BLAKE3 digests of bytes, files and JSON values.

use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::ArtifactError;

/// BLAKE3 digest of 256 bits; 64 lower-case hexadecimal digits as text and in JSON.
///
/// `{}` prints all digits, `{:#}` the first 16, enough to tell results apart by eye.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Digest([u8; 32]);

impl Digest {
    /// Digest of bytes in memory.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self(*blake3::hash(bytes).as_bytes())
    }

    /// Digest of a file, read in pieces.
    ///
    /// # Errors
    /// [`ArtifactError::Io`] if the file cannot be read.
    pub fn of_file(path: &Path) -> Result<Self, ArtifactError> {
        let file = File::open(path).map_err(ArtifactError::io("open", path))?;
        let mut hasher = blake3::Hasher::new();
        hasher.update_reader(file).map_err(ArtifactError::io("read", path))?;
        Ok(Self::of_hasher(&hasher))
    }

    /// Digest of the canonical JSON form of a value: keys sorted, no white space, floats with the
    /// fewest digits that read back to the same bits. The order of fields does not matter; a
    /// number that is not finite counts as `null`, as everywhere in JSON.
    ///
    /// # Errors
    /// [`ArtifactError::NotRepresentable`] if the value has no JSON form (a map whose keys are not text).
    pub fn of_json(value: &impl Serialize) -> Result<Self, ArtifactError> {
        let value = serde_json::to_value(value).map_err(|error| {
            ArtifactError::NotRepresentable { what: "the value".into(), reason: error.to_string() }
        })?;
        Ok(Self::of_value(&value))
    }

    /// [`Digest::of_json`] of a value that is JSON already.
    pub fn of_value(value: &Value) -> Self {
        let mut text = String::new();
        write_canonical(value, &mut text);
        Self::of_bytes(text.as_bytes())
    }

    /// The digest that a JSON document carries in its field `digest`: of all its other fields.
    ///
    /// # Errors
    /// As [`Digest::of_json`].
    pub fn seal_of(document: &impl Serialize) -> Result<Self, ArtifactError> {
        let mut value = serde_json::to_value(document).map_err(|error| {
            ArtifactError::NotRepresentable { what: "the value".into(), reason: error.to_string() }
        })?;
        if let Value::Object(fields) = &mut value {
            fields.remove("digest");
        }
        Ok(Self::of_value(&value))
    }

    pub(super) fn of_hasher(hasher: &blake3::Hasher) -> Self {
        Self(*hasher.finalize().as_bytes())
    }
}

/// A reader that digests what is read through it, so that a file need not be in memory to know
/// that it is still the one that was digested before.
pub struct Digesting<R> {
    reader: R,
    hasher: blake3::Hasher,
}

impl<R: Read> Digesting<R> {
    /// Reads from `reader`.
    pub fn new(reader: R) -> Self {
        Self { reader, hasher: blake3::Hasher::new() }
    }

    /// Digest of all bytes, those that are still to be read included.
    ///
    /// # Errors
    /// Those of the reader.
    pub fn finish(mut self) -> io::Result<Digest> {
        self.hasher.update_reader(&mut self.reader)?;
        Ok(Digest::of_hasher(&self.hasher))
    }
}

impl<R: Read> Read for Digesting<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.reader.read(buffer)?;
        self.hasher.update(&buffer[..read]);
        Ok(read)
    }
}

/// Sorts the keys itself: whether `serde_json` keeps them sorted depends on a feature that any
/// other crate of the build may switch on.
fn write_canonical(value: &Value, text: &mut String) {
    match value {
        Value::Array(items) => {
            text.push('[');
            for item in items {
                write_canonical(item, text);
                text.push(',');
            }
            text.push(']');
        }
        Value::Object(map) => {
            let sorted: BTreeMap<_, _> = map.iter().collect();
            text.push('{');
            for (key, item) in sorted {
                text.push_str(&Value::from(key.as_str()).to_string());
                text.push(':');
                write_canonical(item, text);
                text.push(',');
            }
            text.push('}');
        }
        scalar => text.push_str(&scalar.to_string()),
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hex = blake3::Hash::from_bytes(self.0).to_hex();
        f.write_str(if f.alternate() { &hex[..16] } else { &hex })
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Digest({self:#})")
    }
}

impl From<Digest> for String {
    fn from(digest: Digest) -> Self {
        digest.to_string()
    }
}

impl FromStr for Digest {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        // One text for each digest: a letter whose case has changed is damage.
        let lower_case = !text.bytes().any(|byte| byte.is_ascii_uppercase());
        let hash = blake3::Hash::from_hex(text).ok().filter(|_| lower_case);
        hash.map(|hash| Self(*hash.as_bytes()))
            .ok_or_else(|| format!("`{text}` is no digest of 64 lower-case hexadecimal digits"))
    }
}

impl TryFrom<String> for Digest {
    type Error = String;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

impl schemars::JsonSchema for Digest {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Digest".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "type": "string",
            "pattern": "^[0-9a-f]{64}$",
            "description": "BLAKE3 digest of 256 bits, 64 lower-case hexadecimal digits",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_empty_input_has_the_published_digest() {
        // First test vector of the BLAKE3 reference implementation.
        let expected = "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262";
        assert_eq!(Digest::of_bytes(b"").to_string(), expected);
        assert_eq!(format!("{:#}", Digest::of_bytes(b"")), expected[..16]);
        assert_eq!(expected.parse::<Digest>().unwrap(), Digest::of_bytes(b""));
    }

    #[test]
    fn a_file_has_the_digest_of_its_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let bytes: Vec<u8> = (0..200_000_u32).map(|i| (i % 251) as u8).collect();
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(Digest::of_file(&path).unwrap(), Digest::of_bytes(&bytes));
        let missing = Digest::of_file(&folder.path().join("none")).unwrap_err().to_string();
        assert!(missing.contains("none") && missing.contains("check the path"), "{missing}");
    }

    #[test]
    fn json_ignores_the_order_of_keys_and_sees_every_bit() {
        let of = |text: &str| Digest::of_value(&serde_json::from_str(text).unwrap());
        assert_eq!(of(r#"{"a":1,"b":{"c":2,"d":3}}"#), of(r#"{"b":{"d":3,"c":2},"a":1}"#));
        assert_ne!(of(r#"{"a":[1,2]}"#), of(r#"{"a":[2,1]}"#));
        assert_ne!(of(r#"["1"]"#), of("[1]"));
        assert_ne!(of(r#"["a,b"]"#), of(r#"["a","b"]"#));
        let next = f64::from_bits(0.1_f64.to_bits() + 1);
        assert_ne!(Digest::of_json(&0.1).unwrap(), Digest::of_json(&next).unwrap());
    }

    #[test]
    fn text_that_is_no_digest_is_refused() {
        assert!(serde_json::from_str::<Digest>("\"abc\"").is_err());
        let digest = Digest::of_bytes(b"x");
        let text = serde_json::to_string(&digest).unwrap();
        assert_eq!(serde_json::from_str::<Digest>(&text).unwrap(), digest);
    }
}
