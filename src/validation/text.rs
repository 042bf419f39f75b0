//! The comparison as text.

use super::judge::{Case, Constant, Judged, Validated};
use crate::report::significant;
use std::fmt::Write;

impl Case {
    /// What it means, in a few words.
    fn means(self) -> &'static str {
        match self {
            Self::Hysteresis => "hysteresis alone, nothing fitted",
            Self::Given => "the law of [adhesion], nothing fitted",
            Self::Own => "a law fitted to each set",
            Self::Joint => "one law fitted to all sets",
            Self::Other => "fitted to the other sets: a prediction",
        }
    }
}

impl Validated {
    /// All cases in a table, and the points of the headline.
    pub fn text(&self) -> String {
        // Writing to a string cannot fail.
        let mut text = String::new();
        let width = |of: fn(&Judged) -> usize, least: usize| {
            self.results.iter().map(of).max().unwrap_or(0).max(least)
        };
        let names = width(|result| result.label.to_string().chars().count(), 10);
        let _ = writeln!(
            text,
            "{:<names$}  {:<10}  {:>6}  {:>8}  fitted constants",
            "prediction", "case", "rms", "in band"
        );
        for result in &self.results {
            let band = match result.with_band {
                0 => "-".into(),
                with_band => format!("{}/{with_band}", result.inside_band),
            };
            let _ = writeln!(
                text,
                "{:<names$}  {:<10}  {:>6.3}  {band:>8}  {}",
                result.label.to_string(),
                result.case.name(),
                result.rms,
                laws(result)
            );
        }
        text.push('\n');
        for case in [Case::Hysteresis, Case::Given, Case::Own, Case::Joint, Case::Other] {
            if self.results.iter().any(|result| result.case == case) {
                let _ = writeln!(text, "{:<10}  {}", case.name(), case.means());
            }
        }
        for reason in &self.left_out {
            let _ = writeln!(text, "left out    {reason}");
        }
        if let Some(headline) = self.headline() {
            let _ = writeln!(
                text,
                "\n{}, {}: rms {:.3}",
                headline.label,
                headline.case.name(),
                headline.rms
            );
            text += &points(headline);
        }
        text
    }
}

/// Ratio of the ends of an interval beyond which measurements do not determine a constant.
const UNDETERMINED: f64 = 1e3;

/// The fitted constants with their intervals; those that were not fitted stand in brackets.
fn laws(result: &Judged) -> String {
    let constant = |constant: &Constant| {
        let Constant { key, value, interval_95 } = constant;
        match interval_95 {
            Some([low, high]) if *low > 0.0 && *high > UNDETERMINED * low => {
                format!("{key} {} (not determined)", significant(*value))
            }
            Some(ends) => {
                let [low, high] = ends.map(significant);
                format!("{key} {} ({low} to {high})", significant(*value))
            }
            None => format!("[{key} {value}]"),
        }
    };
    let law = |law: &super::judge::FittedLaw| {
        let at = law.reference_c.map(|celsius| format!(" at {celsius} °C")).unwrap_or_default();
        law.constants.iter().map(constant).collect::<Vec<_>>().join(", ") + &at
    };
    match &result.laws[..] {
        [] => "none".into(),
        laws => laws.iter().map(law).collect::<Vec<_>>().join("; "),
    }
}

fn points(result: &Judged) -> String {
    let mut text = String::new();
    text += "        mm/s      °C     MPa     Ac/A0  hysteretic  adhesive  predicted         95 % band  measured   misfit\n";
    let mut set = "";
    for point in &result.points {
        if point.set != set {
            set = &point.set;
            let _ = writeln!(text, "{set}");
        }
        let band = match point.band_95 {
            None => "unknown".into(),
            Some([low, high]) => format!("{low:.3} to {high:.3}"),
        };
        let _ = writeln!(
            text,
            "{:>12.4}  {:>6}  {:>6.3}  {:>8.5}  {:>10.4}  {:>8.4}  {:>9.4}  {band:>16}  {:>8.4}  {:>+7.4}{}",
            point.speed_mm_s,
            point.temperature_c,
            point.pressure_mpa,
            point.contact_area_fraction,
            point.hysteretic,
            point.adhesive,
            point.predicted,
            point.measured,
            point.misfit,
            if point.inside == Some(false) { "  outside" } else { "" }
        );
    }
    text
}
