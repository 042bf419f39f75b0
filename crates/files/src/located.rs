//! Text files of numbers: read as a whole, with the place of what is wrong in the message.

use std::path::Path;

/// A problem and its line, counted from 1, if it has one.
pub type Located = (Option<usize>, String);

/// Reads a text and parses it.
///
/// # Errors
/// A message with the file and the line.
pub fn read_located<T>(
    path: &Path,
    parse: impl FnOnce(&str) -> Result<T, Located>,
) -> Result<T, String> {
    let in_file = |problem: String| format!("{}: {problem}", path.display());
    let bytes = crate::read(path, crate::LARGEST_NUMBERS)
        .map_err(|error| in_file(format!("cannot be read: {error}{}", crate::advice(&error))))?;
    let text = String::from_utf8(bytes).map_err(|_| in_file("is not UTF-8 text".into()))?;
    parse(&text).map_err(|(line, problem)| match line {
        Some(line) => format!("{}, line {line}: {problem}", path.display()),
        None => in_file(problem),
    })
}

/// Cells of a line, separated by commas, semicolons or blanks. Blanks around a comma or semicolon are part of the separator;
/// between two separators is an empty cell.
pub fn cells(line: &str) -> Vec<&str> {
    line.split([',', ';'])
        .flat_map(|part| match part.trim() {
            "" => vec![""],
            cells => cells.split_whitespace().collect(),
        })
        .collect()
}
