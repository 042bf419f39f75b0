//! Figures as descriptions, drawn all alike: panels with axes and series, as SVG and PNG.

mod draw;
mod png;
mod ticks;

pub use png::png;
pub(crate) use ticks::scientific;

use crate::error_kind::{ErrorKind, HasKind};
use plotters::style::RGBColor;
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

/// Distinct for readers who do not see all colours (Okabe & Ito).
pub(crate) const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];

/// Font of every figure.
pub(crate) const FONT: &str = "sans-serif";

/// Axes and what is drawn in them.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Heading.
    pub title: String,
    /// Horizontal axis.
    pub across: Axis,
    /// Vertical axis.
    pub up: Axis,
    /// What is drawn, the first at the bottom.
    pub series: Vec<Series>,
}

/// One axis; its range is that of the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Name with unit.
    pub label: String,
    /// Scale.
    pub scale: Scale,
    /// The range ends exactly here, instead of a little below the data.
    pub from: Option<f64>,
}

/// Scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps.
    Linear,
    /// Equal ratios; values that are not positive are left out.
    Logarithmic,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, from: None }
    }

    /// A linear axis from zero.
    pub fn from_zero(label: impl Into<String>) -> Self {
        Self { from: Some(0.0), ..Self::linear(label) }
    }

    /// A logarithmic axis.
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self { scale: Scale::Logarithmic, ..Self::linear(label) }
    }

    /// Coordinate of a value; none if the axis has no place for it.
    fn coordinate(&self, value: f64) -> Option<f64> {
        let coordinate = match self.scale {
            Scale::Linear => value,
            Scale::Logarithmic => value.log10(),
        };
        coordinate.is_finite().then_some(coordinate)
    }
}

/// Something drawn, with its name in the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend; none keeps it out.
    pub label: Option<String>,
    /// Number of the colour; same number, same colour.
    pub colour: usize,
    /// What it looks like.
    pub mark: Mark,
}

/// Points (across, up) in the units of the axes.
pub type Points = Vec<(f64, f64)>;

/// Look and values of a series, `(across, up)` in the units of the axes.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A line, interrupted where a value has no place.
    Line(Points),
    /// A dashed line.
    Dashed(Points),
    /// Discs.
    Discs(Points),
    /// Small pale discs, for many.
    Dots(Points),
    /// Circles.
    Circles(Points),
    /// Between two curves: `(across, low, high)`.
    Band(Vec<(f64, f64, f64)>),
    /// Vertical error bars: `(across, low, high)`.
    Bars(Vec<(f64, f64, f64)>),
    /// From zero up: `(from, to, height)`.
    Columns(Vec<(f64, f64, f64)>),
    /// The full height of the panel between two places.
    Span(f64, f64),
    /// A vertical line over the full height.
    Vertical(f64),
    /// A horizontal line over the full width.
    Horizontal(f64),
}

impl Series {
    /// A series with a name.
    pub fn new(label: impl Into<String>, colour: usize, mark: Mark) -> Self {
        Self { label: Some(label.into()), colour, mark }
    }

    /// A series that the legend does not name.
    pub fn unnamed(colour: usize, mark: Mark) -> Self {
        Self { label: None, colour, mark }
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
    /// [`FigureError`] if the drawing fails.
    pub fn svg(&self) -> Result<String, FigureError> {
        let svg = draw::svg(&self.panels)?;
        Ok(described(&svg, "figure", "", &self.caption))
    }

    /// Each panel as an SVG element of its own for a page, with `name` in the identifiers.
    ///
    /// # Errors
    /// [`FigureError`] if the drawing fails.
    pub fn elements(&self, name: &str) -> Result<Vec<String>, FigureError> {
        let element = |(number, panel): (usize, &Panel)| {
            let svg = draw::svg(std::slice::from_ref(panel))?;
            Ok(described(&svg, &format!("{name}-{}", number + 1), &panel.title, &self.caption))
        };
        self.panels.iter().enumerate().map(element).collect()
    }
}

/// An SVG with a title and a description for those who do not see it.
pub(crate) fn described(svg: &str, id: &str, title: &str, description: &str) -> String {
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
