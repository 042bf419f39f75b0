//! Error against seconds, one line for each solver.

use super::{CaseResult, Line};
use asperity::plot::{Axis, Colour, Figure, Mark, Panel, Points, Series};

/// The mark of a line.
type Look = fn(Points) -> Mark;

/// Double precision: errors below are drawn there.
const SMALLEST_ERROR: f64 = 1e-16;

/// Error over seconds, both logarithmic, a line for each method: above those whose result is a
/// friction, below those of scans. Without results the figure has no panel.
pub fn figure(results: &[CaseResult]) -> Figure {
    let lines = |friction: bool| -> Vec<&Line> {
        let lines = results.iter().flat_map(|result| &result.lines);
        lines.filter(|line| line.points.iter().all(|p| p.result.is_some()) == friction).collect()
    };
    let panels = [
        ("Friction", "relative error of friction", lines(true)),
        ("Scans", "relative error of the result", lines(false)),
    ];
    let panels = panels.into_iter().filter(|(_, _, lines)| !lines.is_empty());
    Figure {
        caption: "Relative error of every solver over its time, one point for each value of its \
                  accuracy knob."
            .into(),
        panels: panels.map(|(title, error, lines)| panel(title, error, &lines)).collect(),
    }
}

fn panel(title: &str, error: &str, lines: &[&Line]) -> Panel {
    let series = lines.iter().enumerate().flat_map(|(number, line)| {
        let points = line.points.iter().map(|p| (p.seconds, p.relative_error.max(SMALLEST_ERROR)));
        let points: Points = points.collect();
        // Colours come round; dashes and open circles tell the second time from the first.
        let (joined, marks): (Look, Look) = if number < Colour::COUNT {
            (Mark::Line, Mark::FilledCircles)
        } else {
            (Mark::Dashed, Mark::OpenCircles)
        };
        let colour = Colour::Nth(number);
        [
            Series::new(line.method, colour, joined(points.clone())),
            Series::unnamed(colour, marks(points)),
        ]
    });
    Panel {
        title: title.into(),
        x: Axis::logarithmic("time / s"),
        y: Axis::logarithmic(error),
        series: series.collect(),
    }
}
