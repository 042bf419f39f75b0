//! Friction tables in the layout of the published ones: contact area in the first column, one
//! column per realisation, their average.

use super::About;
use crate::stages::bem::Given;
use crate::stages::realise::SurfaceKind;
use crate::stages::tables::{ComparisonRow, CorrectionRow, FrictionRow, Model};
use crate::text::{latex_text, markdown_text};
use std::fmt::Write;

/// More realisations than this are left to CSV and Parquet.
const MOST_SHOWN: usize = 30;

/// Friction over contact area, or over pressure, for one kind of surfaces and one speed.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionTable {
    /// Contact model.
    pub model: Model,
    /// Which surfaces.
    pub kind: SurfaceKind,
    /// Sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// What its rows are given for.
    pub given: Given,
    /// Rows by ascending contact area or pressure.
    pub rows: Vec<FrictionRow>,
}

/// Sorts rows into tables.
pub fn friction_tables(rows: &[FrictionRow]) -> Vec<FrictionTable> {
    let key = |row: &FrictionRow| (row.model, row.kind, row.speed_mm_s, row.given);
    rows.chunk_by(|a, b| key(a) == key(b))
        .map(|rows| FrictionTable {
            model: rows[0].model,
            kind: rows[0].kind,
            speed_mm_s: rows[0].speed_mm_s,
            given: rows[0].given,
            rows: rows.to_vec(),
        })
        .collect()
}

/// A number with four significant digits.
pub(crate) fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let digits = (3 - value.abs().log10().floor() as i32).max(0) as usize;
    format!("{value:.digits$}")
}

impl FrictionTable {
    /// What the table holds, in one line: all that its numbers depend on.
    pub fn caption(&self, about: &About) -> String {
        let tolerance = about.tolerance.map(|tolerance| format!(", tolerance {tolerance}"));
        format!(
            "Friction coefficient over {}, model {}, {}, {} mm/s{}{}, {}{}, {}, asperity {}",
            self.in_order("contact area fraction", "mean pressure")[0],
            self.model,
            self.road(),
            self.speed_mm_s,
            self.direction(about),
            self.other_condition(),
            self.basis(),
            tolerance.unwrap_or_default(),
            about.material(),
            crate::artifact::TOOL_VERSION
        )
    }

    /// What stands for the road: `measured profiles of 16 windows, waves from 0.06 mm`.
    fn road(&self) -> String {
        let Some(first) = self.rows.first() else { return self.kind.to_string() };
        let windows = match first.windows {
            0 => String::new(),
            1 => " of 1 window".into(),
            windows => format!(" of {windows} windows"),
        };
        let shortest = significant(first.shortest_wavelength_mm);
        format!("{}{windows}, waves from {shortest} mm", self.kind)
    }

    /// Direction of sliding, where the surfaces are rough in both.
    fn direction(&self, about: &About) -> String {
        let angle = about.angle_deg.filter(|_| self.kind.method.is_areal());
        angle.map_or(String::new(), |angle| format!(" at {angle}° from x"))
    }

    /// Range of what is not given.
    fn other_condition(&self) -> String {
        let of = |value: fn(&FrictionRow) -> f64| {
            let values = self.rows.iter().map(value);
            let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
                (low.min(value), high.max(value))
            });
            let (low, high) = (significant(low), significant(high));
            if low == high { low } else { format!("{low} to {high}") }
        };
        match self.given {
            Given::Area => format!(", mean pressure {} MPa", of(|row| row.pressure_mpa)),
            Given::Pressure => {
                format!(", contact area fraction {}", of(|row| row.contact_area_fraction))
            }
        }
    }

    /// Name for a file of the table, without extension.
    pub fn file_stem(&self) -> String {
        let over = match self.given {
            Given::Area => "",
            Given::Pressure => "_over_pressure",
        };
        format!("friction_{}_{}_{}_mm_s{over}", self.model, self.kind.file_name(), self.speed_mm_s)
    }

    /// Number of realisations in the averages, in words.
    fn basis(&self) -> String {
        let realisations = self.realisations();
        match self.rows.first().and_then(|row| row.half_space_realisations) {
            Some(half_space) => format!(
                "{half_space} realisations of the half-space, {realisations} of them with all waves at finite \
                 deformation"
            ),
            None if realisations == 1 => "1 realisation".into(),
            None => format!("{realisations} realisations"),
        }
    }

    fn realisations(&self) -> usize {
        self.rows.first().map_or(0, |row| row.realisations.len())
    }

    /// Realisations that a document shows one by one: all of them, or none if they would not fit on a page.
    fn shown(&self) -> usize {
        let realisations = self.realisations();
        if realisations <= MOST_SHOWN { realisations } else { 0 }
    }

    /// What friction is given for first, and what follows from it.
    fn in_order<T>(&self, area: T, pressure: T) -> [T; 2] {
        match self.given {
            Given::Area => [area, pressure],
            Given::Pressure => [pressure, area],
        }
    }

    /// Contact area fraction and pressure in MPa, the one that is given as it was typed.
    pub fn conditions(&self, row: &FrictionRow) -> [String; 2] {
        let (area, pressure) = (row.contact_area_fraction, row.pressure_mpa);
        match self.given {
            Given::Area => [area.to_string(), significant(pressure)],
            Given::Pressure => [pressure.to_string(), significant(area)],
        }
    }

    fn header(&self) -> Vec<String> {
        let conditions = self.in_order("contact_area_fraction", "pressure_mpa");
        let mut header = conditions.map(str::to_owned).to_vec();
        header.extend((1..=self.shown()).map(|k| format!("realisation_{k}")));
        let rest = ["mean", "standard_deviation", "confidence_95", "error_estimate"];
        header.extend(rest.map(str::to_owned));
        header
    }

    /// Cells as text; friction with five decimals, as published.
    fn cells(&self) -> impl Iterator<Item = Vec<String>> {
        let optional = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v:.5}"));
        self.rows.iter().map(move |row| {
            let mut cells = self.conditions(row).to_vec();
            let shown = row.realisations.iter().take(self.shown());
            cells.extend(shown.map(|friction| format!("{friction:.5}")));
            cells.push(format!("{:.5}", row.mean));
            cells.push(optional(row.standard_deviation));
            cells.push(optional(row.confidence_95));
            cells.push(optional(row.error_estimate));
            cells
        })
    }
}

/// Tables as Markdown, each with its caption.
pub fn markdown(tables: &[FrictionTable], about: &About) -> String {
    let mut text = String::new();
    for table in tables {
        let header = table.header();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}\n", markdown_text(&table.caption(about)));
        let _ = writeln!(text, "| {} |", header.join(" | "));
        let _ = writeln!(text, "|{}", "---:|".repeat(header.len()));
        for cells in table.cells() {
            let _ = writeln!(text, "| {} |", cells.join(" | "));
        }
        text.push('\n');
    }
    text
}

/// Computed beside published friction as Markdown, a table for each published one, after the note
/// of the recipe.
pub fn comparison_markdown(
    note: &str,
    rows: &[ComparisonRow],
    corrections: &[CorrectionRow],
) -> String {
    let mut text = format!("{}\n\n", note.trim());
    for table in rows.chunk_by(|a, b| a.published_table == b.published_table) {
        let first = &table[0];
        let _ = writeln!(
            text,
            "## {}\n\n{} waves, {} mm/s, `{}`; computed: mean of {} realisations, half width of its 95 % \
             confidence interval and estimated error by the {}, asperity {}\n",
            markdown_text(&first.published_table),
            first.waves,
            first.speed_mm_s,
            first.model,
            first.realisations,
            if first.model == Model::Bem { "grid" } else { "mesh" },
            crate::artifact::TOOL_VERSION
        );
        text.push_str(
            "| area fraction | published | computed | 95 % | discretisation | difference |\n",
        );
        text.push_str("|---:|---:|---:|---:|---:|---:|\n");
        for row in table {
            let error = |value: Option<f64>, digits: usize| {
                value.map_or(String::new(), |half| format!("± {half:.digits$}"))
            };
            let _ = writeln!(
                text,
                "| {} | {:.3} | {:.3} | {} | {} | {:+.1} % |",
                row.contact_area_fraction,
                row.published,
                row.computed,
                error(row.confidence_95, 3),
                error(row.discretisation_error, 4),
                100.0 * row.relative_difference
            );
        }
        text.push('\n');
    }
    for table in corrections.chunk_by(|a, b| a.published_table == b.published_table) {
        corrections_markdown(&mut text, table);
    }
    text
}

/// Published beside computed friction of a microscale, of one table.
fn corrections_markdown(text: &mut String, table: &[CorrectionRow]) {
    let first = &table[0];
    let _ = writeln!(
        text,
        "## {}\n\nMicroscale of {} waves, {} mm/s; computed: between samples, error of the difference by \
         interpolation at most {:.1e}, asperity {}\n",
        markdown_text(&first.published_table),
        first.waves,
        first.speed_mm_s,
        first.interpolation_error,
        crate::artifact::TOOL_VERSION
    );
    text.push_str(
        "| pressure (MPa) | half-space, published | computed | finite deformation, published | computed | mesh |\n\
         |---:|---:|---:|---:|---:|---:|\n",
    );
    for row in table {
        let mesh = row.discretisation_error.map_or(String::new(), |error| format!("± {error:.4}"));
        let _ = writeln!(
            text,
            "| {} | {:.4} | {:.4} | {:.4} | {:.4} | {mesh} |",
            row.pressure_mpa,
            row.published_half_space,
            row.computed_half_space,
            row.published_finite_deformation,
            row.computed_finite_deformation,
        );
    }
    text.push('\n');
}

/// Tables as LaTeX with booktabs, each a floating table with its caption.
pub fn latex(tables: &[FrictionTable], about: &About) -> String {
    let mut text = String::new();
    for table in tables {
        let n = table.shown();
        let conditions = table.in_order("$A_c/A_0$", "$p$ / MPa");
        let mut header = conditions.map(str::to_owned).to_vec();
        header.extend((1..=n).map(|k| k.to_string()));
        header.extend(["mean", "s.d.", "95\\,\\%", "error"].map(str::to_owned));
        let columns = format!(
            "S[table-format=1.3]S[table-format=1.4]{}",
            "S[table-format=1.5]".repeat(n + 4)
        );
        let braced: Vec<String> = header.iter().map(|cell| format!("{{{cell}}}")).collect();
        let _ = writeln!(text, "% needs the packages booktabs and siunitx");
        let _ = writeln!(text, "\\begin{{table}}\n\\centering");
        let _ = writeln!(text, "\\caption{{{}}}", latex_text(&table.caption(about)));
        let _ = writeln!(text, "\\begin{{tabular}}{{{columns}}}\n\\toprule");
        let _ = writeln!(text, "{} \\\\\n\\midrule", braced.join(" & "));
        for cells in table.cells() {
            let _ = writeln!(text, "{} \\\\", cells.join(" & "));
        }
        let _ = writeln!(text, "\\bottomrule\n\\end{{tabular}}\n\\end{{table}}\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::{long_table, values_table};
    use super::*;
    use serde_json::json;

    fn about(rubber: &str) -> About {
        About {
            rubber: rubber.into(),
            temperature_c: None,
            tolerance: None,
            angle_deg: None,
            thickness_mm: None,
        }
    }

    fn row(waves: u32, area: f64, realisations: &[f64]) -> FrictionRow {
        FrictionRow {
            model: Model::Bem,
            kind: SurfaceKind::sines(waves),
            speed_mm_s: 10.0,
            given: Given::Area,
            contact_area_fraction: area,
            shortest_wavelength_mm: 0.06,
            windows: 9,
            realisations: realisations.to_vec(),
            half_space_realisations: None,
            mean: 0.5,
            standard_deviation: (realisations.len() > 1).then_some(0.1),
            confidence_95: None,
            scan_error: None,
            interpolation_error: 0.0,
            left_out_error: 0.0,
            microscale_error: None,
            model_error: None,
            discretisation_error: None,
            error_estimate: Some(0.25),
            pressure_mpa: 1.0,
            shortest_reliable_wavelength_mm: None,
        }
    }

    #[test]
    fn the_layout_is_that_of_the_published_tables() {
        let rows =
            [row(8, 0.002, &[0.701, 0.53646]), row(8, 0.05, &[0.9, 0.8]), row(9, 0.1, &[1.0])];
        let tables = friction_tables(&rows);
        assert_eq!(tables.len(), 2);
        let text = markdown(&tables, &about("50 % silica_x"));
        assert!(text.contains(
            "| contact_area_fraction | pressure_mpa | realisation_1 | realisation_2 | mean |"
        ));
        assert!(
            text.contains("| 0.002 | 1.000 | 0.70100 | 0.53646 | 0.50000 | 0.10000 |  | 0.25000 |"),
            "{text}"
        );
        let text = latex(&tables, &about("50 % silica_x"));
        assert!(text.contains("rubber 50 \\% silica\\_x"), "{text}");
        assert_eq!(text.matches("\\toprule").count(), 2);
        let odd = "a|b <i>\n\n% \u{1b}[2J \"q\" ~";
        assert!(markdown(&tables, &about(odd)).contains("rubber a\\|b &lt;i&gt;\\\\u000a"));
        let text = latex(&tables, &about(odd));
        let caption = text.lines().find(|line| line.starts_with("\\caption")).unwrap();
        assert!(caption.contains("\\% ") && caption.ends_with('}'), "{caption}");
        assert!(!text.contains('\u{1b}'));
        let all = About {
            rubber: "x".into(),
            temperature_c: Some(-10.0),
            tolerance: Some(0.01),
            angle_deg: None,
            thickness_mm: None,
        };
        assert_eq!(
            tables[0].caption(&all),
            format!(
                "Friction coefficient over contact area fraction, model bem, 8 waves of 9 windows, waves from 0.06000 mm, \
                 10 mm/s, mean pressure 1.000 MPa, 2 realisations, tolerance 0.01, rubber x at -10 °C, asperity {}",
                crate::artifact::TOOL_VERSION
            )
        );
        assert_eq!(tables[1].file_stem(), "friction_bem_9_waves_10_mm_s");
    }

    #[test]
    fn a_document_shows_hundreds_of_realisations_by_their_average() {
        let table = &friction_tables(&[row(8, 0.05, &[0.5; 31])])[0];
        assert_eq!(table.header().len(), 6);
        assert!(markdown(std::slice::from_ref(table), &about("x")).contains("31 realisations"));
        assert_eq!(long_table(&table.rows).unwrap().names().len(), 9 + 31 + 11);
    }

    #[test]
    fn the_long_table_leaves_absent_realisations_empty() {
        let table = long_table(&[row(8, 0.1, &[0.7, 0.8]), row(9, 0.1, &[0.9])]).unwrap();
        assert_eq!(table.names().len(), 22);
        let rows = table.first_rows(2).unwrap();
        assert_eq!(
            (&rows[0]["realisation_2"], &rows[1]["realisation_2"]),
            (&json!(0.8), &json!(null))
        );
    }

    #[test]
    fn the_layout_of_values_has_a_row_for_each() {
        let table = values_table(&[row(8, 0.1, &[0.7, 0.8]), row(9, 0.1, &[0.9])]).unwrap();
        let rows = table.first_rows(9).unwrap();
        assert_eq!(rows.len(), 3);
        assert_eq!(
            (&rows[1]["realisation"], &rows[1]["friction_coefficient"]),
            (&json!(2), &json!(0.8))
        );
        assert_eq!((&rows[2]["waves"], &rows[2]["method"]), (&json!(9), &json!("sines")));
    }

    /// Names that would end a caption, a comment or the run of LaTeX.
    #[test]
    fn latex_with_odd_names_compiles() {
        let version = std::process::Command::new("pdflatex").arg("--version").output();
        if version.is_err() {
            println!("skipped: there is no pdflatex on this machine");
            return;
        }
        let tables = friction_tables(&[row(8, 0.002, &[0.701, 0.53646])]);
        let odd = "a|b \"q\" 'r' `s` <i>\n\n% \\input{x} $_^~#&{} \u{1b}[2J ö 20 °C";
        let body = latex(&tables, &about(odd));
        let document = format!(
            "\\documentclass{{article}}\n\\usepackage{{booktabs,siunitx}}\n\\begin{{document}}\n{body}\n\\end{{document}}\n"
        );
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("t.tex"), document).unwrap();
        let output = std::process::Command::new("pdflatex")
            .args(["-interaction=nonstopmode", "-halt-on-error", "t.tex"])
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }
}
