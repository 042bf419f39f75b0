//! Predictions as a table, as CSV and as JSON.

use std::io::Write;

use asperity::theory::IsotropicPrediction;
use asperity::units::Units;
use serde::Serialize;
use std::f64::consts::TAU;

use super::flash::FlashRow;
use crate::cli::output::significant;

/// One prediction; the names are the keys of JSON and the columns of CSV.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Row {
    pub(super) speed_mm_s: f64,
    pub(super) pressure_mpa: f64,
    magnification: f64,
    shortest_wavelength_mm: f64,
    contact_area_fraction: f64,
    contact_area_fraction_error: f64,
    friction_coefficient: f64,
    friction_coefficient_error: f64,
    full_contact_friction: f64,
    mean_gap_mm: f64,
    mean_gap_error_mm: f64,
    full_contact_rms_pressure_mpa: f64,
    rms_height_mm: f64,
    rms_gradient: f64,
    pub(super) unmeasured_share: f64,
}

const COLUMNS: [&str; 15] = [
    "speed_mm_s",
    "pressure_mpa",
    "magnification",
    "shortest_wavelength_mm",
    "contact_area_fraction",
    "contact_area_fraction_error",
    "friction_coefficient",
    "friction_coefficient_error",
    "full_contact_friction",
    "mean_gap_mm",
    "mean_gap_error_mm",
    "full_contact_rms_pressure_mpa",
    "rms_height_mm",
    "rms_gradient",
    "unmeasured_share",
];

impl Row {
    pub(super) fn new(speed_mm_s: f64, pressure_mpa: f64, at: &IsotropicPrediction) -> Self {
        Self {
            speed_mm_s,
            pressure_mpa,
            magnification: at.magnification,
            shortest_wavelength_mm: (TAU / at.wavenumber).m_to_mm(),
            contact_area_fraction: at.contact_area_fraction,
            contact_area_fraction_error: at.errors.contact_area_fraction,
            friction_coefficient: at.friction_coefficient,
            friction_coefficient_error: at.errors.friction_coefficient,
            full_contact_friction: at.full_contact_friction,
            mean_gap_mm: at.mean_gap.m_to_mm(),
            mean_gap_error_mm: at.errors.mean_gap.m_to_mm(),
            full_contact_rms_pressure_mpa: at.full_contact_pressure.pa_to_mpa(),
            rms_height_mm: at.rms_height.m_to_mm(),
            rms_gradient: at.rms_gradient,
            unmeasured_share: at.unmeasured_share,
        }
    }

    /// Whether another row is of the same speed and pressure, with fewer waves.
    fn same_contact(&self, before: &Self) -> bool {
        self.magnification > before.magnification
    }

    fn values(&self) -> [f64; 15] {
        [
            self.speed_mm_s,
            self.pressure_mpa,
            self.magnification,
            self.shortest_wavelength_mm,
            self.contact_area_fraction,
            self.contact_area_fraction_error,
            self.friction_coefficient,
            self.friction_coefficient_error,
            self.full_contact_friction,
            self.mean_gap_mm,
            self.mean_gap_error_mm,
            self.full_contact_rms_pressure_mpa,
            self.rms_height_mm,
            self.rms_gradient,
            self.unmeasured_share,
        ]
    }
}

/// Columns of the heated rubber in CSV.
const FLASH_COLUMNS: [&str; 7] = [
    "flash_contact_area_fraction",
    "flash_contact_area_fraction_error",
    "flash_friction_coefficient",
    "flash_friction_coefficient_error",
    "flash_mean_gap_mm",
    "flash_rise_k",
    "flash_steps",
];

/// The rows as a table for people: what is asked for most.
pub(super) fn table(rows: &[Row]) -> String {
    let header = ["mm/s", "MPa", "shortest / mm", "Ac/A0", "friction", "gap / mm", "rms gradient"];
    let cells = |row: &Row| {
        [
            row.speed_mm_s.to_string(),
            row.pressure_mpa.to_string(),
            significant(row.shortest_wavelength_mm),
            significant(row.contact_area_fraction),
            significant(row.friction_coefficient),
            significant(row.mean_gap_mm),
            significant(row.rms_gradient),
        ]
    };
    columns(header, rows.iter().map(cells))
}

/// The heated rubber beside the cold one, with all waves.
pub(super) fn flash_table(cold: &[Row], hot: &[FlashRow]) -> String {
    let header =
        ["mm/s", "MPa", "Ac/A0 cold", "hot", "friction cold", "hot", "gap hot / mm", "rise / K"];
    let all_waves = cold.chunk_by(|a, b| b.same_contact(a)).filter_map(<[Row]>::last);
    let cells = |(cold, hot): (&Row, &FlashRow)| {
        [
            hot.speed_mm_s.to_string(),
            hot.pressure_mpa.to_string(),
            significant(cold.contact_area_fraction),
            significant(hot.contact_area_fraction),
            significant(cold.friction_coefficient),
            significant(hot.friction_coefficient),
            significant(hot.mean_gap_mm),
            significant(hot.rise_k),
        ]
    };
    columns(header, all_waves.zip(hot).map(cells))
}

pub(super) fn columns<const N: usize>(
    header: [&str; N],
    rows: impl Iterator<Item = [String; N]>,
) -> String {
    let lines: Vec<[String; N]> = [header.map(String::from)].into_iter().chain(rows).collect();
    let width = |column: usize| lines.iter().map(|line| line[column].len()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..N).map(width).collect();
    let line = |cells: &[String; N]| {
        let cells = cells.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}"));
        cells.collect::<Vec<_>>().join("  ") + "\n"
    };
    lines.iter().map(line).collect()
}

/// The rows as CSV, with all digits; those of the heated rubber beside the rows of all waves.
pub(super) fn write_csv(
    out: &mut dyn Write,
    rows: &[Row],
    flash: &[FlashRow],
) -> std::io::Result<()> {
    let heated = if flash.is_empty() { &[][..] } else { &FLASH_COLUMNS[..] };
    writeln!(out, "{}", [&COLUMNS[..], heated].concat().join(","))?;
    let mut flash = flash.iter();
    for (k, row) in rows.iter().enumerate() {
        let mut cells: Vec<String> = row.values().map(number).to_vec();
        let last = rows.get(k + 1).is_none_or(|next| !next.same_contact(row));
        let hot = if last { flash.next() } else { None };
        cells.extend(match hot {
            Some(hot) => hot.values().map(number).to_vec(),
            None => vec![String::new(); heated.len()],
        });
        writeln!(out, "{}", cells.join(","))?;
    }
    Ok(())
}

fn number(value: f64) -> String {
    match value == 0.0 || (1e-4..1e6).contains(&value.abs()) {
        true => value.to_string(),
        false => format!("{value:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_has_the_keys_of_the_json_in_their_order() {
        let row = Row {
            speed_mm_s: 1.0,
            pressure_mpa: 2.0,
            magnification: 3.0,
            shortest_wavelength_mm: 4.0,
            contact_area_fraction: 5.0,
            contact_area_fraction_error: 6e-9,
            friction_coefficient: 7.0,
            friction_coefficient_error: 8.0,
            full_contact_friction: 9.0,
            mean_gap_mm: 10.0,
            mean_gap_error_mm: 11.0,
            full_contact_rms_pressure_mpa: 12.0,
            rms_height_mm: 13.0,
            rms_gradient: 14.0,
            unmeasured_share: 15.0,
        };
        let json = serde_json::to_value(row).unwrap();
        for (name, value) in COLUMNS.iter().zip(row.values()) {
            assert_eq!(json[name].as_f64(), Some(value), "{name}");
        }
        let mut csv = Vec::new();
        write_csv(&mut csv, &[row], &[]).unwrap();
        let text = String::from_utf8(csv).unwrap();
        assert!(text.ends_with("\n1,2,3,4,5,6e-9,7,8,9,10,11,12,13,14,15\n"), "{text}");
    }
}
