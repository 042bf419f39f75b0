//! What a figure is made of: panels, axes and series, without a word on how they are drawn.

/// Axes and what is drawn in them.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Heading; a long one is set smaller.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
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
    /// Value at which the axis starts; without it, a little below the smallest value.
    pub start: Option<f64>,
}

/// Scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences have equal lengths.
    Linear,
    /// Equal ratios have equal lengths; values that are not positive are left out.
    Logarithmic,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, start: None }
    }

    /// A linear axis that starts at zero.
    pub fn from_zero(label: impl Into<String>) -> Self {
        Self { start: Some(0.0), ..Self::linear(label) }
    }

    /// A logarithmic axis.
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self { scale: Scale::Logarithmic, ..Self::linear(label) }
    }

    /// Coordinate of a value: the value or its decadic logarithm. `None` if that is not finite.
    pub(super) fn coordinate(&self, value: f64) -> Option<f64> {
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
    /// Name in the legend; a series without one is not in it.
    pub label: Option<String>,
    /// Colour.
    pub colour: Colour,
    /// Look and values. A named series without values is an entry of the legend alone.
    pub mark: Mark,
}

/// Colour of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// Black: limits, sums, references.
    Black,
    /// Grey: what lies behind the rest.
    Grey,
    /// One of six colours, counted from 0; the seventh is the first again.
    Nth(usize),
}

impl Colour {
    /// How many colours [`Colour::Nth`] tells apart.
    pub const COUNT: usize = 6;
}

/// Points `(x, y)` in the units of the axes.
pub type Points = Vec<(f64, f64)>;

/// Look and values of a series, in the units of the axes.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A line; a value that the axis cannot show interrupts it.
    Line(Points),
    /// A dashed line, interrupted likewise.
    Dashed(Points),
    /// A dotted line, interrupted likewise.
    Dotted(Points),
    /// Filled circles.
    FilledCircles(Points),
    /// Open circles.
    OpenCircles(Points),
    /// Small pale filled circles, for many points.
    Dots(Points),
    /// The area between two curves, `(x, low, high)`, interrupted like a line.
    Band(Vec<(f64, f64, f64)>),
    /// Vertical error bars `(x, low, high)`.
    ErrorBars(Vec<(f64, f64, f64)>),
    /// Bars from zero up, `(from, to, height)`, `from` and `to` on the horizontal axis.
    Histogram(Vec<(f64, f64, f64)>),
    /// A short tick on the lower edge of the panel at each x.
    Rug(Vec<f64>),
    /// The full height of the panel between two x.
    Span(f64, f64),
    /// A dotted line over the full height at an x.
    VerticalLine(f64),
    /// A dotted line over the full width at a y.
    HorizontalLine(f64),
    /// A map in colours. It is drawn alone in its panel, at equal scales along both axes.
    Map(Map),
}

/// Values on a rectangle, to be shown as colours.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Cells along x and y.
    pub cells: [usize; 2],
    /// Lengths along x and y, in the unit of both axes.
    pub size: [f64; 2],
    /// That unit, for the scale bar.
    pub unit: &'static str,
    /// Values row by row from the lowest y up, x fastest. NaN is drawn in light grey.
    pub values: Vec<f64>,
    /// Axis of the colour bar.
    pub colours: Axis,
    /// Direction of an arrow below the map, in degrees from x towards y, and what it says.
    pub arrow: Option<(f64, String)>,
    /// Lines of text below the map.
    pub notes: Vec<String>,
}

impl Series {
    /// A series with a name.
    pub fn new(label: impl Into<String>, colour: Colour, mark: Mark) -> Self {
        Self { label: Some(label.into()), colour, mark }
    }

    /// A series that the legend does not name.
    pub fn unnamed(colour: Colour, mark: Mark) -> Self {
        Self { label: None, colour, mark }
    }
}

impl Panel {
    /// The map that fills the panel, if it has one.
    pub(super) fn map(&self) -> Option<&Map> {
        self.series.iter().find_map(|series| match &series.mark {
            Mark::Map(map) => Some(map),
            _ => None,
        })
    }
}

impl Mark {
    /// The values that the horizontal axis must have room for.
    pub(super) fn x(&self) -> Vec<f64> {
        match self {
            Self::Line(points)
            | Self::Dashed(points)
            | Self::Dotted(points)
            | Self::FilledCircles(points)
            | Self::OpenCircles(points)
            | Self::Dots(points) => points.iter().map(|point| point.0).collect(),
            Self::Band(rows) | Self::ErrorBars(rows) => rows.iter().map(|row| row.0).collect(),
            Self::Histogram(bars) => bars.iter().flat_map(|bar| [bar.0, bar.1]).collect(),
            Self::Rug(positions) => positions.clone(),
            Self::Span(from, to) => vec![*from, *to],
            Self::VerticalLine(x) => vec![*x],
            Self::HorizontalLine(_) => vec![],
            Self::Map(map) => vec![0.0, map.size[0]],
        }
    }

    /// The values that the vertical axis must have room for.
    pub(super) fn y(&self) -> Vec<f64> {
        match self {
            Self::Line(points)
            | Self::Dashed(points)
            | Self::Dotted(points)
            | Self::FilledCircles(points)
            | Self::OpenCircles(points)
            | Self::Dots(points) => points.iter().map(|point| point.1).collect(),
            Self::Band(rows) | Self::ErrorBars(rows) => {
                rows.iter().flat_map(|row| [row.1, row.2]).collect()
            }
            Self::Histogram(bars) => bars.iter().map(|bar| bar.2).collect(),
            Self::Rug(_) | Self::Span(..) | Self::VerticalLine(_) => vec![],
            Self::HorizontalLine(y) => vec![*y],
            Self::Map(map) => vec![0.0, map.size[1]],
        }
    }
}
