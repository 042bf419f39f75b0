//! The study of one sine wave as Markdown.

use super::ReportError;
use crate::artifact::RunView;
use crate::report::read::rows;
use crate::stages::sinusoid::{
    AGREEMENT, ASYMPTOTES, AgreementRow, AsymptoteRow, Model, PEAKS, POINTS, PRESSURES, PeakRow,
    PointRow,
};
use std::fmt::Write;

/// The tables of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Friction and area against speed.
    pub points: Vec<PointRow>,
    /// The same against pressure; may be empty.
    pub pressures: Vec<PointRow>,
    /// Elastic limits.
    pub asymptotes: Vec<AsymptoteRow>,
    /// Friction maxima.
    pub peaks: Vec<PeakRow>,
    /// How far the models agree with the neo-Hookean one.
    pub agreement: Vec<AgreementRow>,
}

/// A value of a point with its mesh error.
type Quantity = fn(&PointRow) -> (Option<f64>, Option<f64>);

fn friction(row: &PointRow) -> (Option<f64>, Option<f64>) {
    (row.friction_coefficient, row.friction_mesh_error)
}

fn area(row: &PointRow) -> (Option<f64>, Option<f64>) {
    (row.contact_area_fraction, row.area_mesh_error)
}

impl Study {
    /// The study of a run.
    ///
    /// # Errors
    /// [`ReportError`] if its tables cannot be read.
    pub fn read(run: &RunView) -> Result<Self, ReportError> {
        Ok(Self {
            points: run.rows(POINTS)?,
            pressures: rows(run, PRESSURES)?.unwrap_or_default(),
            asymptotes: run.rows(ASYMPTOTES)?,
            peaks: run.rows(PEAKS)?,
            agreement: run.rows(AGREEMENT)?,
        })
    }

    /// The study as a Markdown document: conclusions first, then all values.
    pub fn markdown(&self) -> String {
        let mut text = String::new();
        self.conclusions(&mut text);
        self.agreement_by_slope(&mut text);
        self.maxima(&mut text);
        let by_speed = |row: &PointRow| (row.speed_mm_s, row.deborah_number);
        for (name, quantity) in
            [("Friction coefficient", friction as Quantity), ("Contact area fraction", area)]
        {
            for curve in self.points.chunk_by(|a, b| a.aspect_ratio == b.aspect_ratio) {
                let (slope, pressure) = (curve[0].rms_slope, curve[0].pressure_mpa);
                let _ = writeln!(text, "## {name}, rms slope {slope:.2}, {pressure} MPa\n");
                side_by_side(&mut text, ["speed mm/s", "De"], curve, by_speed, quantity);
            }
        }
        self.limits(&mut text);
        let by_pressure = |row: &PointRow| (row.speed_mm_s, row.pressure_mpa);
        if let Some(first) = self.pressures.first() {
            let _ =
                writeln!(text, "## Friction against pressure, rms slope {:.2}\n", first.rms_slope);
            let header = ["speed mm/s", "pressure MPa"];
            side_by_side(&mut text, header, &self.pressures, by_pressure, friction);
        }
        text
    }

    /// For each model, quantity and level: the rms slope up to which points agree and none parts.
    fn conclusions(&self, text: &mut String) {
        text.push_str(
            "## Agreement with the neo-Hookean model\n\n\
             | model | quantity | level | agrees up to rms slope | parts from | points agree | part | undecided | compared |\n\
             |---|---|---:|---:|---:|---:|---:|---:|---:|\n",
        );
        let mut rows: Vec<&AgreementRow> = self.agreement.iter().collect();
        let order = |a: &AgreementRow, b: &AgreementRow| {
            let names =
                (a.model.name(), a.quantity.name()).cmp(&(b.model.name(), b.quantity.name()));
            names.then(a.level.total_cmp(&b.level))
        };
        rows.sort_by(|a, b| order(a, b).then(a.aspect_ratio.total_cmp(&b.aspect_ratio)));
        for group in rows.chunk_by(|a, b| order(a, b).is_eq()) {
            let held = group.iter().take_while(|row| row.part == 0).count();
            let slope = |row: Option<&&AgreementRow>| {
                row.map_or("-".into(), |row| format!("{:.2}", row.rms_slope))
            };
            let sum = |value: fn(&AgreementRow) -> u32| -> u32 {
                group.iter().map(|row| value(row)).sum()
            };
            let first = group[0];
            let _ = writeln!(
                text,
                "| {} | {} | {} % | {} | {} | {} | {} | {} | {} of {} |",
                first.model,
                first.quantity,
                100.0 * first.level,
                slope(group[..held].iter().rfind(|row| row.agree > 0)),
                slope(group.get(held)),
                sum(|row| row.agree),
                sum(|row| row.part),
                sum(|row| row.undecided),
                sum(|row| row.compared),
                sum(|row| row.compared + row.missing),
            );
        }
        text.push('\n');
    }

    fn agreement_by_slope(&self, text: &mut String) {
        text.push_str(
            "## Where the curves part\n\n\
             | model | quantity | level | rms slope | agree | part | undecided | missing | parts from De | to De | largest difference | at De |\n\
             |---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
        );
        let number = |value: Option<f64>| value.map_or(String::new(), short);
        for row in &self.agreement {
            let _ = writeln!(
                text,
                "| {} | {} | {} % | {:.2} | {} | {} | {} | {} | {} | {} | {} | {} |",
                row.model,
                row.quantity,
                100.0 * row.level,
                row.rms_slope,
                row.agree,
                row.part,
                row.undecided,
                row.missing,
                number(row.parts_from_deborah_number),
                number(row.parts_to_deborah_number),
                percent(row.largest_difference),
                number(row.largest_at_deborah_number),
            );
        }
        text.push('\n');
    }

    fn maxima(&self, text: &mut String) {
        text.push_str(
            "## Largest friction\n\n\
             | rms slope | model | friction | mesh error | speed mm/s | De | against neo-hookean |\n\
             |---:|---|---:|---:|---:|---:|---:|\n",
        );
        for peak in &self.peaks {
            let bound = if peak.bracketed { "" } else { "≥ " };
            let error =
                peak.friction_mesh_error.map_or(String::new(), |error| format!("{error:.4}"));
            let _ = writeln!(
                text,
                "| {:.2} | {} | {bound}{:.4} | {error} | {} | {} | {} |",
                peak.rms_slope,
                peak.model,
                peak.friction_coefficient,
                short(peak.speed_mm_s),
                short(peak.deborah_number),
                percent(peak.relative_to_neo_hookean),
            );
        }
        text.push('\n');
    }

    fn limits(&self, text: &mut String) {
        text.push_str(
            "## Elastic limits\n\n\
             | rms slope | limit | E/(1-ν²) MPa | area, Hertz | area, half-space | full contact MPa | largest pressure, Hertz MPa |\n\
             |---:|---|---:|---:|---:|---:|---:|\n",
        );
        for row in &self.asymptotes {
            let _ = writeln!(
                text,
                "| {:.2} | {} | {:.2} | {:.4} | {:.4} | {:.3} | {:.2} |",
                row.rms_slope,
                row.limit,
                row.reduced_modulus_mpa,
                row.hertz_area_fraction,
                row.westergaard_area_fraction,
                row.full_contact_pressure_mpa,
                row.hertz_maximum_pressure_mpa,
            );
        }
        text.push('\n');
    }
}

/// A table with two columns of coordinates and a column for each model.
fn side_by_side(
    text: &mut String,
    header: [&str; 2],
    rows: &[PointRow],
    place: impl Fn(&PointRow) -> (f64, f64),
    quantity: Quantity,
) {
    let names = Model::ALL.map(Model::name);
    let _ = writeln!(text, "| {} | {} | {} |", header[0], header[1], names.join(" | "));
    let _ = writeln!(text, "|{}", "---:|".repeat(2 + names.len()));
    for row in rows.iter().filter(|row| row.model == Model::ALL[0]) {
        let cells = Model::ALL.map(|model| {
            let found =
                rows.iter().find(|other| other.model == model && place(other) == place(row));
            found.map_or(String::new(), |found| cell(found, quantity))
        });
        let (first, second) = place(row);
        let _ = writeln!(text, "| {} | {} | {} |", short(first), short(second), cells.join(" | "));
    }
    text.push('\n');
}

/// Value and mesh error, or the pressure at which the path ended.
fn cell(row: &PointRow, quantity: Quantity) -> String {
    let at = |pressure: Option<f64>| pressure.map(|pressure| format!("{pressure:.3} MPa"));
    match quantity(row) {
        (Some(value), Some(error)) => format!("{value:.4} ± {error:.4}"),
        (Some(value), None) => format!("{value:.4}"),
        (None, _) => {
            let end = at(row.path_ended_at_mpa.or(row.coarse_path_ended_at_mpa));
            format!("no solution beyond {}", end.unwrap_or_else(|| "the first contact".into()))
        }
    }
}

/// Three digits.
fn short(value: f64) -> String {
    let magnitude = value.abs().log10().floor();
    if !(-3.0..6.0).contains(&magnitude) {
        return format!("{value:.2e}");
    }
    format!("{value:.*}", (2.0 - magnitude).max(0.0) as usize)
}

fn percent(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| format!("{:+.1} %", 100.0 * value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_three_digits() {
        let texts = [0.012_345, 1.0, 417.3, 23_960.0, 1e7, 2e-4].map(short);
        assert_eq!(texts, ["0.0123", "1.00", "417", "23960", "1.00e7", "2.00e-4"]);
    }
}
