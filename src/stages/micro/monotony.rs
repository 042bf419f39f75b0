//! What every contact does as it is pressed harder: its area grows and its separation falls. A microscale that
//! does otherwise shows its mesh, or a part of the rubber that has turned over. Areas are counted in elements of the
//! mesh, between whose nodes an edge of the contact is read off: a fall of less than one says nothing.

use super::{COLUMNS_KEY, SampleRow};

/// Changes of the separation below this, relative to the largest one, are round-off.
const ROUND_OFF: f64 = 1e-9;

/// Says where the contact area at finite deformation falls by more than one of `columns` elements or the mean
/// separation rises, given samples at ascending pressures. `None` if neither happens; the largest change if there are
/// several.
pub(super) fn breaks(samples: &[SampleRow], columns: usize) -> Option<String> {
    let element = 1.0 / columns as f64;
    let separation: fn(&SampleRow) -> f64 = |row| row.separation_finite_deformation_mm;
    let round_off = ROUND_OFF * samples.iter().map(|row| separation(row).abs()).fold(0.0, f64::max);
    let area = largest_rise(samples, |row| -row.area_finite_deformation, element);
    let separation = largest_rise(samples, separation, round_off);
    let words = |what, place: Option<Place>, value: fn(&SampleRow) -> f64, unit| {
        let Place { before, after } = place?;
        Some(format!(
            "{what} from {:.5}{unit} at {:.3} MPa to {:.5}{unit} at {:.3} MPa",
            value(before),
            before.pressure_mpa,
            value(after),
            after.pressure_mpa
        ))
    };
    let found: Vec<String> = [
        words("the contact area falls", area, |row| row.area_finite_deformation, ""),
        words(
            "the mean separation rises",
            separation,
            |row| row.separation_finite_deformation_mm,
            " mm",
        ),
    ]
    .into_iter()
    .flatten()
    .collect();
    (!found.is_empty()).then(|| {
        format!(
            "of the microscale at finite deformation {}, which no real contact does; try another {COLUMNS_KEY} and do \
             not trust corrections beyond",
            found.join(", and ")
        )
    })
}

struct Place<'a> {
    before: &'a SampleRow,
    after: &'a SampleRow,
}

/// The neighbours between which the value rises most, if it does by more than `least`.
fn largest_rise(
    samples: &[SampleRow],
    value: impl Fn(&SampleRow) -> f64,
    least: f64,
) -> Option<Place<'_>> {
    let rise = |pair: &&[SampleRow]| value(&pair[1]) - value(&pair[0]);
    let largest = samples.windows(2).max_by(|a, b| rise(a).total_cmp(&rise(b)))?;
    (rise(&largest) > least).then(|| Place { before: &largest[0], after: &largest[1] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::realise::SurfaceKind;

    fn row(pressure_mpa: f64, area: f64, separation_mm: f64) -> SampleRow {
        SampleRow {
            kind: SurfaceKind::sines(8),
            realisation: 0,
            stretch: 0,
            speed_mm_s: 10.0,
            pressure_mpa,
            friction_half_space: 0.5,
            friction_finite_deformation: 0.4,
            friction_from_heat: 0.4,
            area_half_space: area,
            area_finite_deformation: area,
            separation_half_space_mm: separation_mm,
            separation_finite_deformation_mm: separation_mm,
            interpolation_error: 0.0,
            discretisation_error: None,
            residual: 0.0,
            newton_steps: 5,
            seconds: 0.0,
        }
    }

    #[test]
    fn what_grows_and_falls_as_it_should_is_not_mentioned() {
        let samples = [row(1.0, 0.1, 0.03), row(2.0, 0.2, 0.02), row(4.0, 0.2, 0.01)];
        assert_eq!(breaks(&samples, 64), None);
        assert_eq!(breaks(&[row(1.0, 0.1, 0.03)], 64), None);
        assert_eq!(breaks(&[], 64), None);
    }

    #[test]
    fn an_area_that_falls_by_less_than_an_element_is_the_mesh() {
        let samples = [row(1.0, 0.3, 0.03), row(2.0, 0.3 - 0.9 / 64.0, 0.02)];
        assert_eq!(breaks(&samples, 64), None);
        assert!(breaks(&samples, 128).unwrap().contains("area falls from 0.30000 at 1.000 MPa"));
    }

    #[test]
    fn a_falling_area_and_a_rising_separation_are_named_with_their_pressures() {
        let samples =
            [row(1.0, 0.1, 0.03), row(2.0, 0.3, 0.02), row(4.0, 0.25, 0.01), row(8.0, 0.4, 0.02)];
        let words = breaks(&samples, 64).unwrap();
        let parts = [
            "area falls from 0.30000 at 2.000 MPa to 0.25000 at 4.000 MPa",
            "rises from 0.01000 mm at 4.000 MPa to 0.02000 mm at 8.000 MPa",
        ];
        for part in parts {
            assert!(words.contains(part), "{words}");
        }
    }
}
