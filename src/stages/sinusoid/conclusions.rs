//! What the points say: where friction is largest and how far the models agree.

use super::problem::Model;
use super::{AgreementRow, PeakRow, PointRow};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The maximum of friction of every curve that has a point.
pub(super) fn peaks(points: &[PointRow]) -> Vec<PeakRow> {
    let mut peaks: Vec<PeakRow> = curves(points).filter_map(peak).collect();
    let reference: Vec<PeakRow> =
        peaks.iter().filter(|peak| peak.model == Model::NeoHookean).cloned().collect();
    for peak in &mut peaks {
        let same = reference.iter().find(|other| other.aspect_ratio == peak.aspect_ratio);
        peak.relative_to_neo_hookean = same
            .filter(|other| other.bracketed && peak.bracketed)
            .map(|other| peak.friction_coefficient / other.friction_coefficient - 1.0);
    }
    peaks
}

/// Points of one aspect ratio and model each, by ascending speed.
fn curves(points: &[PointRow]) -> impl Iterator<Item = &[PointRow]> {
    points.chunk_by(|a, b| a.aspect_ratio == b.aspect_ratio && a.model == b.model)
}

fn peak(curve: &[PointRow]) -> Option<PeakRow> {
    let friction = |i: usize| curve.get(i).and_then(|point| point.friction_coefficient);
    let highest = (0..curve.len())
        .filter(|i| friction(*i).is_some())
        .max_by(|a, b| friction(*a).unwrap_or(0.0).total_cmp(&friction(*b).unwrap_or(0.0)))?;
    let point = &curve[highest];
    let at = |i: usize| Some((curve.get(i)?.speed_mm_s.ln(), friction(i)?));
    let around = highest
        .checked_sub(1)
        .and_then(|before| Some([at(before)?, at(highest)?, at(highest + 1)?]));
    let (logarithm, largest) = match around {
        Some(around) => vertex(around),
        None => (point.speed_mm_s.ln(), point.friction_coefficient?),
    };
    let speed_mm_s = logarithm.exp();
    Some(PeakRow {
        aspect_ratio: point.aspect_ratio,
        rms_slope: point.rms_slope,
        model: point.model,
        friction_coefficient: largest,
        friction_mesh_error: point.friction_mesh_error,
        speed_mm_s,
        deborah_number: point.deborah_number * speed_mm_s / point.speed_mm_s,
        bracketed: around.is_some(),
        relative_to_neo_hookean: None,
    })
}

/// Vertex of the parabola through three points of which the middle one is highest.
fn vertex([left, middle, right]: [(f64, f64); 3]) -> (f64, f64) {
    let slope = |a: (f64, f64), b: (f64, f64)| (b.1 - a.1) / (b.0 - a.0);
    let curvature = (slope(middle, right) - slope(left, middle)) / (right.0 - left.0);
    if curvature == 0.0 {
        return middle;
    }
    // Newton's form about the middle: y = y_m + s (x - x_m) + curvature (x - x_m)².
    let steepness = slope(left, middle) + curvature * (middle.0 - left.0);
    let step = -0.5 * steepness / curvature;
    (middle.0 + step, middle.1 + 0.5 * steepness * step)
}

/// The other models against the neo-Hookean one, for each quantity and level.
pub(super) fn agreement(points: &[PointRow], levels: &[f64]) -> Vec<AgreementRow> {
    let reference = Model::NeoHookean;
    let mut rows = Vec::new();
    for curve in curves(points).filter(|curve| curve[0].model != reference) {
        let same = |other: &&[PointRow]| {
            other[0].model == reference && other[0].aspect_ratio == curve[0].aspect_ratio
        };
        let Some(reference) = curves(points).find(same) else { continue };
        for quantity in Quantity::ALL {
            let differences: Vec<Option<Difference>> = quantity.differences(curve, reference);
            rows.extend(levels.iter().map(|level| summary(curve, quantity, *level, &differences)));
        }
    }
    rows
}

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Quantity {
    /// Friction, relative to that of the neo-Hookean model at the same speed.
    #[serde(rename = "friction")]
    Friction,
    /// Friction, relative to the largest of the neo-Hookean model.
    #[serde(rename = "friction of peak")]
    FrictionOfPeak,
    /// Contact area, relative to that of the neo-Hookean model at the same speed.
    #[serde(rename = "area")]
    Area,
}

impl std::fmt::Display for Quantity {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// Relative difference at one speed and what the meshes leave open of it.
#[derive(Clone, Copy)]
struct Difference {
    deborah_number: f64,
    value: f64,
    uncertainty: f64,
}

enum Verdict {
    Agrees,
    Parts,
    Undecided,
}

impl Quantity {
    const ALL: [Self; 3] = [Self::Friction, Self::FrictionOfPeak, Self::Area];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Friction => "friction",
            Self::FrictionOfPeak => "friction of peak",
            Self::Area => "area",
        }
    }

    fn value(self, point: &PointRow) -> Option<f64> {
        match self {
            Self::Friction | Self::FrictionOfPeak => point.friction_coefficient,
            Self::Area => point.contact_area_fraction,
        }
    }

    /// Without a coarser mesh nothing is known of the error.
    fn error(self, point: &PointRow) -> f64 {
        let error = match self {
            Self::Friction | Self::FrictionOfPeak => point.friction_mesh_error,
            Self::Area => point.area_mesh_error,
        };
        error.unwrap_or(f64::INFINITY)
    }

    /// One for each speed; none where one of the curves has no solution.
    fn differences(self, curve: &[PointRow], reference: &[PointRow]) -> Vec<Option<Difference>> {
        let peak = reference.iter().filter_map(|p| p.friction_coefficient).fold(0.0, f64::max);
        let difference = |(point, reference): (&PointRow, &PointRow)| {
            let (ours, theirs) = (self.value(point)?, self.value(reference)?);
            let scale = if self == Self::FrictionOfPeak { peak } else { theirs.abs() };
            Some(Difference {
                deborah_number: point.deborah_number,
                value: (ours - theirs) / scale,
                uncertainty: (self.error(point) + self.error(reference)) / scale,
            })
        };
        curve.iter().zip(reference).map(difference).collect()
    }
}

impl Difference {
    fn verdict(&self, level: f64) -> Verdict {
        if self.value.abs() + self.uncertainty <= level {
            Verdict::Agrees
        } else if self.value.abs() - self.uncertainty > level {
            Verdict::Parts
        } else {
            Verdict::Undecided
        }
    }
}

fn summary(
    curve: &[PointRow],
    quantity: Quantity,
    level: f64,
    differences: &[Option<Difference>],
) -> AgreementRow {
    let mut row = AgreementRow {
        aspect_ratio: curve[0].aspect_ratio,
        rms_slope: curve[0].rms_slope,
        model: curve[0].model,
        quantity,
        level,
        compared: 0,
        missing: 0,
        agree: 0,
        part: 0,
        undecided: 0,
        parts_from_deborah_number: None,
        parts_to_deborah_number: None,
        largest_difference: None,
        largest_at_deborah_number: None,
    };
    for difference in differences {
        let Some(difference) = difference else {
            row.missing += 1;
            continue;
        };
        row.compared += 1;
        match difference.verdict(level) {
            Verdict::Agrees => row.agree += 1,
            Verdict::Parts => {
                row.part += 1;
                row.parts_from_deborah_number.get_or_insert(difference.deborah_number);
                row.parts_to_deborah_number = Some(difference.deborah_number);
            }
            Verdict::Undecided => {
                row.undecided += 1;
                continue;
            }
        }
        if row.largest_difference.is_none_or(|largest| difference.value.abs() > largest.abs()) {
            row.largest_difference = Some(difference.value);
            row.largest_at_deborah_number = Some(difference.deborah_number);
        }
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point of which only what is compared matters.
    fn point(model: Model, speed: f64, friction: Option<f64>, error: f64) -> PointRow {
        PointRow {
            aspect_ratio: 0.1,
            rms_slope: 0.44,
            model,
            speed_mm_s: speed,
            deborah_number: speed / 2.0,
            pressure_mpa: 2.0,
            columns: 64,
            friction_coefficient: friction,
            friction_coarse: None,
            friction_extrapolated: None,
            friction_mesh_error: friction.map(|_| error),
            contact_area_fraction: friction,
            area_coarse: None,
            area_extrapolated: None,
            area_mesh_error: None,
            mean_separation_mm: None,
            separation_mesh_error_mm: None,
            residual: None,
            why_missing: None,
            path_ended_at_mpa: None,
            coarse_path_ended_at_mpa: None,
        }
    }

    fn points() -> Vec<PointRow> {
        let of = |model, values: [Option<f64>; 5], error: f64| {
            let speeds = [1.0, 2.0, 4.0, 8.0, 16.0];
            speeds.into_iter().zip(values).map(move |(v, f)| point(model, v, f, error))
        };
        let half_space = [Some(0.102), Some(0.22), Some(0.43), Some(0.21), None];
        let neo = [Some(0.1), Some(0.2), Some(0.4), Some(0.2), Some(0.1)];
        of(Model::HalfSpace, half_space, 0.001).chain(of(Model::NeoHookean, neo, 0.001)).collect()
    }

    #[test]
    fn points_agree_part_or_stay_undecided_by_their_mesh_errors() {
        let rows = agreement(&points(), &[0.05]);
        assert_eq!(rows.len(), 3);
        let counts =
            |row: &AgreementRow| (row.compared, row.missing, row.agree, row.part, row.undecided);
        // 2 % ± 2 % agrees, 10 % ± 1 % and 7.5 % ± 0.5 % part, 5 % ± 1 % is open.
        assert_eq!(counts(&rows[0]), (4, 1, 1, 2, 1));
        assert_eq!(
            (rows[0].parts_from_deborah_number, rows[0].parts_to_deborah_number),
            (Some(1.0), Some(2.0))
        );
        approx::assert_relative_eq!(rows[0].largest_difference.unwrap(), 0.1, max_relative = 1e-12);
        // Over the maximum 0.4: 0.5, 5, 7.5 and 2.5 %, each ± 0.5 %.
        assert_eq!(counts(&rows[1]), (4, 1, 2, 1, 1));
        // Areas without a mesh error decide nothing.
        assert_eq!((counts(&rows[2]), rows[2].largest_difference), ((4, 1, 0, 0, 4), None));
    }

    #[test]
    fn a_parabola_has_its_vertex() {
        let parabola = |x: f64| (x, 0.7 - 0.2 * (x - 1.3).powi(2));
        let (x, y) = vertex([parabola(0.0), parabola(1.0), parabola(2.5)]);
        approx::assert_relative_eq!(x, 1.3, max_relative = 1e-13);
        approx::assert_relative_eq!(y, 0.7, max_relative = 1e-13);
    }

    #[test]
    fn a_maximum_beside_a_missing_point_is_not_bracketed() {
        let found = peaks(&points());
        assert_eq!(found.len(), 2);
        assert!(found[0].bracketed && found[0].friction_coefficient >= 0.43);
        assert!(found[0].relative_to_neo_hookean.unwrap() > 0.0);
        let mut cut = points();
        cut[3].friction_coefficient = None;
        let found = peaks(&cut);
        assert_eq!((found[0].bracketed, found[0].friction_coefficient), (false, 0.43));
        assert_eq!(found[0].relative_to_neo_hookean, None);
    }
}
