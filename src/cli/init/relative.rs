//! Paths as they stand in a recipe: relative to its folder.

use std::path::{Component, Path, PathBuf};

use crate::cli::CliError;

/// The way from `folder`, which need not be there yet, to the file or folder `to`, which is. Where
/// they have no root in common, the whole path.
///
/// # Errors
/// [`CliError::Input`] for a path that is not there.
pub(super) fn relative(folder: &Path, to: &Path) -> Result<PathBuf, CliError> {
    let failed = |path: &Path, error| CliError::input(format!("{}: {error}", path.display()));
    let to = to.canonicalize().map_err(|error| failed(to, error))?;
    let absolute = std::path::absolute(folder).map_err(|error| failed(folder, error))?;
    // Links on the way to the folder lead elsewhere; what is not there yet has none.
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

/// A path as a text of a recipe.
///
/// # Errors
/// [`CliError::Input`] for a name that is no UTF-8, which no recipe can hold.
pub(super) fn quoted(path: &Path) -> Result<String, CliError> {
    let text = path.to_str().ok_or_else(|| {
        let name = path.display();
        CliError::input(format!("{name}: the name is not UTF-8, which a recipe is; rename it"))
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
