//! Names that a terminal would obey are printed visibly.

use super::{Outcome, binary};
use std::fs;

#[test]
fn what_a_terminal_obeys_is_shown_in_errors() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a\u{1b}[2Jb.toml", "a\u{202e}b.toml", "a\nerror: b.toml", "a\u{9b}31mb.toml"] {
        let path = folder.path().join(name);
        for command in ["status", "run", "export", "inspect"] {
            let outcome = Outcome::of(binary().arg(command).arg(&path).current_dir(&folder));
            assert_ne!(outcome.code, 0, "{command} {name:?}");
            let all = outcome.stdout + &outcome.stderr;
            let obeyed = |c: char| c.is_control() && c != '\n' || c == '\u{202e}';
            assert!(!all.contains(obeyed), "{command}: {all:?}");
            // A line end within a name does not look like a message of its own.
            let errors = all.lines().filter(|line| line.starts_with("error: ")).count();
            assert!(errors <= 1, "{command}: {all}");
        }
    }
}

#[test]
fn long_keys_do_not_fill_the_screen() {
    let folder = tempfile::tempdir().unwrap();
    let recipe = folder.path().join("recipe.toml");
    fs::write(&recipe, format!("{} = 1\n", "k".repeat(1_000_000))).unwrap();
    let outcome = Outcome::of(binary().arg("run").arg(&recipe).current_dir(&folder));
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.len() < 20_000, "{}", outcome.stderr.len());
    assert!(outcome.stderr.contains("characters left out"));
}
