//! Paths of a recipe, relative to its folder.

use std::path::{Component, Path, PathBuf};

use crate::cli::CliError;

/// The path of the existing file or folder `to` relative to `folder`, which need not exist yet; the
/// absolute path if they have no root in common.
///
/// # Errors
/// [`CliError::Input`] for a path that is not there.
pub(super) fn relative(folder: &Path, to: &Path) -> Result<PathBuf, CliError> {
    let failed = |path: &Path, error| CliError::input(format!("{}: {error}", path.display()));
    let to = to.canonicalize().map_err(|error| failed(to, error))?;
    let absolute = std::path::absolute(folder).map_err(|error| failed(folder, error))?;
    // Resolve the links in the part of the path that exists.
    let known = absolute.ancestors().find_map(|path| Some((path, path.canonicalize().ok()?)));
    let from = match known {
        Some((path, known)) => known.join(absolute.strip_prefix(path).unwrap_or(Path::new(""))),
        None => absolute,
    };
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return Ok(to);
    }
    let up = from.components().skip(shared).map(|_| Component::ParentDir);
    let way: PathBuf = up.chain(to.components().skip(shared)).collect();
    Ok(if way.as_os_str().is_empty() { PathBuf::from(".") } else { way })
}

/// A path as a string in a recipe.
///
/// # Errors
/// [`CliError::Input`] for a name that is not UTF-8, which a recipe cannot hold.
pub(super) fn quoted(path: &Path) -> Result<String, CliError> {
    let text = path.to_str().ok_or_else(|| {
        let name = path.display();
        CliError::input(format!("{name}: the name is not UTF-8, as a recipe must be; rename it"))
    })?;
    Ok(toml::Value::String(text.to_owned()).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_go_up_and_down_and_to_folders_that_are_not_there() {
        let root = tempfile::tempdir().unwrap();
        let at = |path: &str| root.path().join(path);
        std::fs::create_dir_all(at("a/b")).unwrap();
        std::fs::write(at("a/b/scan.txt"), "").unwrap();
        for (folder, to, way) in [
            ("project", "a/b", "../a/b"),
            ("a", "a/b/scan.txt", "b/scan.txt"),
            ("a/new/deep", "a/b", "../../b"),
            ("a/b", "a/b", "."),
        ] {
            assert_eq!(relative(&at(folder), &at(to)).unwrap(), PathBuf::from(way), "{folder}");
        }
        assert!(relative(&at("a"), &at("nowhere")).is_err());
        assert_eq!(quoted(Path::new("a \"b\"")).unwrap(), "'a \"b\"'");
    }
}
