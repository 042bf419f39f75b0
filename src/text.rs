//! Names that come from files and recipes, made harmless where they are printed.
//!
//! A name may hold control characters that move the cursor of a terminal, marks that turn the
//! direction of writing, formulas that a spreadsheet runs, or the marks of Markdown and LaTeX.

use std::borrow::Cow;

/// Characters of a message of which no more is printed.
const LONGEST_MESSAGE: usize = 4000;

/// Whether a character shows nothing itself but changes how others show, beside line end and
/// tabulator: C0 and C1 controls, bidirectional marks (Unicode Technical Report 36), separators of
/// lines and paragraphs, blanks without width.
fn is_hidden(character: char) -> bool {
    character.is_control() && !matches!(character, '\n' | '\t')
        || matches!(character,
            '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}')
}

/// Text of several lines with every hidden character written as `\u001b`, which JSON reads as the
/// same character.
pub fn visible(text: &str) -> Cow<'_, str> {
    replaced(text, is_hidden)
}

/// A name in one line: as [`visible`], line ends and tabulators too.
pub fn visible_line(text: &str) -> Cow<'_, str> {
    replaced(text, |character| is_hidden(character) || character.is_control())
}

fn replaced(text: &str, hidden: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.chars().any(&hidden) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for character in text.chars() {
        if hidden(character) {
            shown.push_str(&format!("\\u{:04x}", u32::from(character)));
        } else {
            shown.push(character);
        }
    }
    Cow::Owned(shown)
}

/// A message that fits on a screen or two: its first and last part, and how much is left out.
pub fn cut(text: &str) -> Cow<'_, str> {
    let count = text.chars().count();
    if count <= LONGEST_MESSAGE {
        return Cow::Borrowed(text);
    }
    let half = LONGEST_MESSAGE / 2;
    let start: String = text.chars().take(half).collect();
    let end: String = text.chars().skip(count - half).collect();
    Cow::Owned(format!("{start} ... ({} characters left out) ... {end}", count - 2 * half))
}

/// A name in Markdown, as text and as a cell of a table.
pub fn markdown_text(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in visible_line(text).chars() {
        match character {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            // An underscore within a word stands for itself.
            '|' | '\\' | '`' | '*' | '[' | ']' => {
                escaped.push('\\');
                escaped.push(character);
            }
            _ => escaped.push(character),
        }
    }
    escaped
}

/// A name in LaTeX: one line, without characters that LaTeX or babel take for commands or that the
/// default fonts print as others.
pub fn latex_text(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in visible_line(text).chars() {
        match character {
            '\\' => escaped.push_str("\\textbackslash{}"),
            '~' => escaped.push_str("\\textasciitilde{}"),
            '^' => escaped.push_str("\\textasciicircum{}"),
            '<' => escaped.push_str("\\textless{}"),
            '>' => escaped.push_str("\\textgreater{}"),
            '|' => escaped.push_str("\\textbar{}"),
            '"' => escaped.push_str("\\char34{}"),
            '`' => escaped.push_str("\\textasciigrave{}"),
            '\'' => escaped.push_str("\\char39{}"),
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => {
                escaped.push('\\');
                escaped.push(character);
            }
            _ => escaped.push(character),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_obeys_is_printed_visibly() {
        let name = "a\u{1b}[2Jb\u{202e}c\nd\u{9b}e\r";
        assert_eq!(visible(name), "a\\u001b[2Jb\\u202ec\nd\\u009be\\u000d");
        assert_eq!(visible_line(name), "a\\u001b[2Jb\\u202ec\\u000ad\\u009be\\u000d");
        assert!(matches!(visible("Höhe µm 粗さ\tx"), Cow::Borrowed(_)));
        let json = format!("\"{}\"", visible("\u{202e}"));
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), "\u{202e}");
    }

    #[test]
    fn long_messages_keep_their_start_and_end() {
        assert_eq!(cut("short"), "short");
        let long = format!("start{}end", "ö".repeat(100_000));
        let shown = cut(&long);
        assert!(shown.starts_with("start") && shown.ends_with("end"));
        assert!(shown.contains("96008 characters left out"), "{}", shown.len());
    }

    #[test]
    fn names_are_no_markup() {
        assert_eq!(markdown_text("a|b<script>\n_x_"), "a\\|b&lt;script&gt;\\\\u000a_x_");
        assert_eq!(
            latex_text("50 % \"x\"\n\\y"),
            "50 \\% \\char34{}x\\char34{}\\textbackslash{}u000a\\textbackslash{}y"
        );
    }
}
