//! Names and paths as text, without loss: file systems allow bytes that are not UTF-8, such as Latin-1 names on
//! the shares of laboratories, while JSON, TOML and tables hold Unicode only.
//!
//! A path that is UTF-8 is its own text. Any other is `bytes:` and its bytes percent-encoded (RFC 3986), as in
//! `bytes:stra%DFe/scan.txt`, which reads back to the same bytes.

use crate::os;
use percent_encoding::{AsciiSet, CONTROLS, percent_decode_str, percent_encode};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};
use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};

const PREFIX: &str = "bytes:";
const ESCAPED: &AsciiSet = &CONTROLS.add(b'%');

/// A name for tables and messages: itself if it is UTF-8, else its bytes percent-encoded, as in `stra%DFe`.
pub fn text(name: &OsStr) -> String {
    let escaped = || percent_encode(name.as_encoded_bytes(), ESCAPED).to_string();
    name.to_str().map_or_else(escaped, str::to_owned)
}

/// A path as it is kept in JSON and TOML, without loss.
pub fn path_text(path: &Path) -> String {
    match path.to_str() {
        Some(plain) if !plain.starts_with(PREFIX) => plain.to_owned(),
        _ => format!("{PREFIX}{}", percent_encode(path.as_os_str().as_encoded_bytes(), ESCAPED)),
    }
}

fn path_of(text: String) -> PathBuf {
    match text.strip_prefix(PREFIX) {
        None => PathBuf::from(text),
        Some(escaped) => PathBuf::from(os::name_of_bytes(percent_decode_str(escaped).collect())),
    }
}

/// A path for libraries that take UTF-8 only: the path itself, or one through a temporary link that is there as
/// long as this is.
pub struct Utf8Path {
    path: PathBuf,
    _link: Option<tempfile::TempDir>,
}

impl Utf8Path {
    /// # Errors
    /// Those of the operating system, if a link is needed and cannot be made.
    pub fn of(path: &Path) -> io::Result<Self> {
        if path.to_str().is_some() {
            return Ok(Self { path: path.to_owned(), _link: None });
        }
        let link = tempfile::tempdir()?;
        let place = link.path().join("link");
        let target = std::path::absolute(path)?;
        // A file that is to be made has a name of ours: then its folder is the odd part of the path.
        let path = match (target.parent(), target.file_name().and_then(OsStr::to_str)) {
            (Some(folder), Some(name)) => {
                os::link(folder, &place)?;
                place.join(name)
            }
            _ => {
                os::link(&target, &place)?;
                place
            }
        };
        Ok(Self { path, _link: Some(link) })
    }
}

impl AsRef<Path> for Utf8Path {
    fn as_ref(&self) -> &Path {
        &self.path
    }
}

/// For `#[serde(with)]` on a path.
pub mod path {
    use super::{Deserialize, Deserializer, Path, PathBuf, Serialize, Serializer, of, path_text};

    /// # Errors
    /// Those of the serialiser.
    pub fn serialize<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
        path_text(path).serialize(serializer)
    }

    /// # Errors
    /// Anything but a text.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PathBuf, D::Error> {
        of(String::deserialize(deserializer)?)
    }
}

/// For `#[serde(with)]` on a path that may be absent, with `#[serde(default)]`.
pub mod optional_path {
    use super::{Deserialize, Deserializer, PathBuf, Serialize, Serializer, of, path_text};

    /// # Errors
    /// Those of the serialiser.
    pub fn serialize<S: Serializer>(
        path: &Option<PathBuf>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        path.as_deref().map(path_text).serialize(serializer)
    }

    /// # Errors
    /// Anything but a text or nothing.
    pub fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<PathBuf>, D::Error> {
        Option::<String>::deserialize(deserializer)?.map(of).transpose()
    }
}

/// For `#[serde(with)]` on a list of paths.
pub mod paths {
    use super::{Deserialize, Deserializer, PathBuf, Serializer, of, path_text};

    /// # Errors
    /// Those of the serialiser.
    pub fn serialize<S: Serializer>(paths: &[PathBuf], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(paths.iter().map(|path| path_text(path)))
    }

    /// # Errors
    /// Anything but a list of texts.
    pub fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<PathBuf>, D::Error> {
        Vec::<String>::deserialize(deserializer)?.into_iter().map(of).collect()
    }
}

/// A NUL byte ends a name for the operating system.
fn of<E: Error>(text: String) -> Result<PathBuf, E> {
    let path = path_of(text);
    if path.as_os_str().as_encoded_bytes().contains(&0) {
        return Err(E::custom("a path has no NUL byte"));
    }
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Files {
        #[serde(with = "path")]
        one: PathBuf,
        #[serde(with = "paths")]
        many: Vec<PathBuf>,
    }

    #[test]
    fn every_path_comes_back_from_json_and_toml() {
        let odd = |bytes: &[u8]| PathBuf::from(os::name_of_bytes(bytes.to_vec()));
        let many = vec![
            PathBuf::from("plain/ö %41.txt"),
            odd(b"stra\xdfe/%DF \xc3\xb6.txt"),
            PathBuf::from("bytes:x"),
        ];
        let files = Files { one: odd(b"\xe9"), many };
        let json = serde_json::to_value(&files).unwrap();
        assert_eq!(json["one"], "bytes:%E9");
        assert_eq!(json["many"][0], "plain/ö %41.txt");
        assert_eq!(serde_json::from_value::<Files>(json).unwrap(), files);
        let toml = toml::to_string(&files).unwrap();
        assert_eq!(toml::from_str::<Files>(&toml).unwrap(), files);
        assert!(serde_json::from_str::<Files>(r#"{"one": "a\u0000", "many": []}"#).is_err());
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join(odd(b"stra\xdfe"));
        std::fs::create_dir(&place).unwrap();
        let new = place.join("new");
        std::fs::write(Utf8Path::of(&new).unwrap(), "x").unwrap();
        let own = place.join(odd(b"\xff"));
        std::fs::rename(&new, &own).unwrap();
        assert_eq!(std::fs::read(Utf8Path::of(&own).unwrap()).unwrap(), b"x");
        assert_eq!(text(odd(b"stra\xdfe").as_os_str()), "stra%DFe");
        assert_eq!(text(OsStr::new("straße %")), "straße %");
    }
}
