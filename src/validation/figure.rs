//! The comparison as a figure.

use super::judge::{Case, JudgedPoint, Validated};
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};

impl Validated {
    /// Friction over speed, a panel for each set: the measurement, the headline with its band and its part by hysteresis, and the same
    /// prediction in the other cases.
    pub fn figure(&self) -> Option<Figure> {
        let headline = self.headline()?;
        let own = |case: Case| {
            self.results.iter().find(|result| result.label == headline.label && result.case == case)
        };
        let panel = |set: &String| {
            let of = |points: &[JudgedPoint]| -> Vec<JudgedPoint> {
                let mut own: Vec<_> =
                    points.iter().filter(|point| point.set == *set).cloned().collect();
                own.sort_by(|a, b| a.speed_mm_s.total_cmp(&b.speed_mm_s));
                own
            };
            let line = |points: &[JudgedPoint], value: fn(&JudgedPoint) -> f64| {
                points.iter().map(|point| (point.speed_mm_s, value(point))).collect::<Vec<_>>()
            };
            let points = of(&headline.points);
            let band: Vec<(f64, f64, f64)> = points
                .iter()
                .filter_map(|point| {
                    let [low, high] = point.band_95?;
                    Some((point.speed_mm_s, low.max(0.0), high))
                })
                .collect();
            let mut series = Vec::new();
            if !band.is_empty() {
                series.push(Series::unnamed(Colour::Nth(0), Mark::Band(band)));
            }
            let name = |case: Case| format!("{} ({})", headline.label, case.name());
            let hysteretic = line(&points, |point| point.hysteretic);
            series.push(Series::new("hysteresis", Colour::Grey, Mark::Line(hysteretic)));
            let predicted = line(&points, |point| point.predicted);
            series.push(Series::new(name(headline.case), Colour::Nth(0), Mark::Line(predicted)));
            let others = [Case::Own, Case::Joint, Case::Other].into_iter();
            for (k, result) in
                others.filter(|case| *case != headline.case).filter_map(own).enumerate()
            {
                let predicted = line(&of(&result.points), |point| point.predicted);
                series.push(Series::new(
                    name(result.case),
                    Colour::Nth(k + 1),
                    Mark::Dashed(predicted),
                ));
            }
            let measured = line(&points, |point| point.measured);
            series.push(Series::new("measured", Colour::Black, Mark::FilledCircles(measured)));
            Panel {
                title: set.clone(),
                x: Axis::logarithmic("sliding speed v / (mm/s)"),
                y: Axis::from_zero("friction coefficient"),
                series,
            }
        };
        Some(Figure {
            caption: format!(
                "Measured friction over sliding speed beside {}, with the 95 % band of the case {}.",
                headline.label,
                headline.case.name()
            ),
            panels: self.sets.iter().map(panel).collect(),
        })
    }
}
