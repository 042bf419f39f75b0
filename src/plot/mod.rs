//! Figures as descriptions, all drawn in one way: panels with axes and series, as SVG and PNG.
//!
//! | module | what it holds |
//! |---|---|
//! | `colours` | colours of values, with a lightness that grows evenly |
//! | `panel` | the description: [`Panel`], [`Axis`], [`Series`], [`Mark`], [`Map`] |
//! | `draw` | the description as SVG; no other module draws |
//! | `ticks` | where axes have ticks and what stands at them |
//! | `png` | SVG to PNG, with the font of the program |
//! | `raster` | pictures of maps and colour bars, as elements of an SVG |

mod colours;
mod draw;
mod panel;
mod png;
mod raster;
mod ticks;

pub use panel::{Axis, Colour, Map, Mark, Panel, Points, Scale, Series};
pub use png::png;
pub(crate) use ticks::scientific;

use crate::error_kind::{ErrorKind, HasKind};
use std::fmt::Write;

/// A figure that could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the figure could not be drawn: {0}")]
pub struct FigureError(pub(crate) String);

impl HasKind for FigureError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Failure
    }
}

/// A figure: panels one below the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// What it shows, in one sentence.
    pub caption: String,
    /// Its panels.
    pub panels: Vec<Panel>,
}

impl Figure {
    /// All panels as one SVG document.
    ///
    /// # Errors
    /// [`FigureError`] if there is no panel, if a panel has no values, or if the drawing fails.
    pub fn svg(&self) -> Result<String, FigureError> {
        let svg = draw::svg(&self.panels)?;
        Ok(described(&svg, "figure", "", &self.caption))
    }

    /// Each panel as an SVG element of its own for a page, with `name` in the identifiers.
    ///
    /// # Errors
    /// Those of [`Figure::svg`].
    pub fn elements(&self, name: &str) -> Result<Vec<String>, FigureError> {
        let element = |(number, panel): (usize, &Panel)| {
            let svg = draw::svg(std::slice::from_ref(panel))?;
            Ok(described(&svg, &format!("{name}-{}", number + 1), &panel.title, &self.caption))
        };
        self.panels.iter().enumerate().map(element).collect()
    }
}

/// An SVG with a title and a description for readers who do not see it.
fn described(svg: &str, id: &str, title: &str, description: &str) -> String {
    let Some((start, rest)) = svg.split_once("<svg ") else { return svg.to_owned() };
    let Some((attributes, content)) = rest.split_once('>') else { return svg.to_owned() };
    let title = if title.is_empty() { description } else { title };
    let mut text = String::with_capacity(svg.len() + 400);
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "{start}<svg role=\"img\" aria-labelledby=\"{id}-title {id}-description\" \
         {attributes}>\n<title id=\"{id}-title\">{}</title>\n\
         <desc id=\"{id}-description\">{}</desc>{content}",
        escaped(title),
        escaped(description)
    );
    text
}

/// Text as content of an element.
fn escaped(text: &str) -> String {
    maud::html! { (text) }.into_string()
}
