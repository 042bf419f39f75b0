//! What a reader of the averages should be told: friction that the shortest waves still make, and slopes beyond the
//! half-space.

use super::{FrictionRow, Model, TheoryConstants};
use crate::rubber::RubberModel;
use crate::stages::micro::{Parting, partings};
use crate::stages::realise::{ArealRow, Surface};
use crate::surface::{SineScale, Wave};
use crate::theory::Persson;
use crate::units::Units;
use std::f64::consts::TAU;

/// Beyond this root mean square slope the half-space is far from finite deformation, whatever the surface.
const STEEP: f64 = 1.0;

/// What the last octave may make of friction whose error is not known.
const UNSTATED: f64 = 0.1;

/// Warnings, each for all kinds of surfaces that it holds for. `threshold` is that of the microscale, if there is one.
pub(super) fn doubts(
    rows: &[FrictionRow],
    surfaces: &[Surface],
    rubber: &RubberModel,
    threshold: Option<f64>,
) -> Vec<String> {
    let (mut steep, mut growing, mut shortest_mm) = (Vec::new(), Vec::new(), f64::INFINITY);
    for (own, parting) in partings(surfaces, threshold.unwrap_or(f64::INFINITY)) {
        let kind = own[0].kind;
        let slope = slope_left(own, parting);
        if slope > STEEP {
            steep.push(format!("{slope:.2} by {kind}"));
        }
        let of_kind: Vec<&FrictionRow> =
            rows.iter().filter(|row| row.kind == kind && row.model == Model::Bem).collect();
        if let Some((grown, error)) = still_growing(&own[0], &of_kind, rubber) {
            let stated = match error {
                Some(error) => format!("stated error {:.0} %", 100.0 * error),
                None => "no stated error".into(),
            };
            growing.push(format!("{:.0} % of {kind} ({stated})", 100.0 * grown));
            shortest_mm =
                of_kind.iter().map(|r| r.shortest_wavelength_mm).fold(shortest_mm, f64::min);
        }
    }
    let mut warnings = Vec::new();
    if !steep.is_empty() {
        let remedy = match threshold {
            None => "a section [micro] corrects it",
            Some(_) => "lower micro.rms_slope_threshold, or solve all waves ([fem])",
        };
        warnings.push(format!(
            "root mean square slopes are left to the half-space, which is linear in slopes: {}; {remedy}",
            steep.join(", ")
        ));
    }
    if !growing.is_empty() {
        warnings.push(format!(
            "the octave above the shortest wavelength of {shortest_mm:.4} mm makes more of the friction than the stated error, by \
             Persson's theory: {}; friction is that down to this wavelength, and grows with shorter ones (`asperity cutoff`)",
            growing.join(", ")
        ));
    }
    warnings
}

/// A warning of areal surfaces that are steeper than a linear model of contact admits.
pub(super) fn steep_maps(surfaces: &[ArealRow]) -> Option<String> {
    let of_kind = surfaces.chunk_by(|a, b| a.kind == b.kind);
    let steep: Vec<String> = of_kind
        .filter_map(|own| {
            let square: f64 = own.iter().map(|row| row.rms_gradient.powi(2)).sum();
            let gradient = (square / own.len() as f64).sqrt();
            (gradient > STEEP).then(|| format!("{gradient:.2} by {}", own[0].kind))
        })
        .collect();
    (!steep.is_empty()).then(|| {
        format!(
            "root mean square gradients of areal surfaces are left to the half-space, which is linear in slopes: {}; there is \
             no finite deformation of areal surfaces: see what [micro] or [fem] change of the profiles, or raise \
             realise.shortest_wavelength_mm",
            steep.join(", ")
        )
    })
}

/// Speed in mm/s above which the heat of the contact changes friction (docs/heat.md).
const WARM_MM_S: f64 = 100.0;

/// A warning of friction at speeds at which a rubber with loss is not as cold as it is taken here.
pub(super) fn isothermal(rows: &[FrictionRow], rubber: &RubberModel) -> Option<String> {
    let fastest = rows.iter().map(|row| row.speed_mm_s).fold(0.0, f64::max);
    let elastic = matches!(rubber, RubberModel::Maxwell(rubber) if rubber.branches.is_empty());
    (fastest > WARM_MM_S && !elastic).then(|| {
        format!(
            "the tables are isothermal also above 0.1 m/s (speeds here reach {fastest} mm/s), where frictional heat changes \
             friction: [feedback.heat] solves profiles with it"
        )
    })
}

/// Root mean square slope of what is left to the half-space, in the mean over the surfaces.
fn slope_left(surfaces: &[Surface], parting: Parting) -> f64 {
    let slopes = surfaces.iter().map(|surface| {
        let scales = parting.scales(&surface.profile);
        mean_square_slope(&scales.macroscale)
    });
    (slopes.sum::<f64>() / surfaces.len() as f64).sqrt()
}

fn mean_square_slope(waves: &[Wave]) -> f64 {
    let slope = |wave: &Wave| TAU * wave.amplitude / wave.wavelength;
    0.5 * waves.iter().map(|wave| slope(wave).powi(2)).sum::<f64>()
}

/// Share of the friction that the shortest octave makes by Persson's theory of the first surface, and the stated error, both
/// relative, where the first exceeds the second, or a tenth if there is none: the average is then one of the shortest wavelength.
fn still_growing(
    surface: &Surface,
    rows: &[&FrictionRow],
    rubber: &RubberModel,
) -> Option<(f64, Option<f64>)> {
    let present = || surface.profile.iter().filter(|wave| wave.amplitude != 0.0);
    let shortest = present().map(|wave| wave.wavelength).fold(f64::INFINITY, f64::min);
    let scale = |wave: &Wave| SineScale { wavelength: wave.wavelength, amplitude: wave.amplitude };
    let all: Vec<SineScale> = present().map(scale).collect();
    // The next wave of a ladder of octaves belongs to the rest.
    let limit = 2.0 * shortest * (1.0 - 1e-9);
    let rest: Vec<SineScale> = all.iter().copied().filter(|s| s.wavelength >= limit).collect();
    if rest.is_empty() {
        return None;
    }
    let gamma = TheoryConstants::default().persson_gamma;
    let grown = |row: &FrictionRow| {
        let theory = |scales: &[SineScale]| {
            let speed = row.speed_mm_s.mm_to_m();
            // A rubber that was not measured that far has been warned of before.
            let theory = Persson::new(scales, rubber, speed, gamma).ok()?;
            Some(theory.friction_coefficient(row.pressure_mpa.mpa_to_pa()))
        };
        Some(1.0 - theory(&rest)? / theory(&all)?)
    };
    rows.iter()
        .filter_map(|row| Some((grown(row)?, row.error_estimate.map(|e| e / row.mean.abs()))))
        .filter(|(grown, error)| *grown > error.unwrap_or(UNSTATED))
        .max_by(|a, b| {
            let excess = |of: &(f64, Option<f64>)| of.0 - of.1.unwrap_or(UNSTATED);
            excess(a).total_cmp(&excess(b))
        })
}

#[cfg(test)]
mod tests {
    use super::super::average::tests::curve;
    use super::super::{average, basis};
    use super::*;
    use crate::rubber::{MaxwellBranch, Rubber};
    use crate::stages::realise::SurfaceKind;

    #[test]
    fn steep_and_growing_surfaces_are_named_once_for_all() {
        let wave = |wavelength: f64, slope: f64| {
            let amplitude = slope * wavelength * 2.0_f64.sqrt() / TAU;
            Wave { wavelength, amplitude, phase: 0.0 }
        };
        let surface = |waves: u32, slope: f64| Surface {
            kind: SurfaceKind::sines(waves),
            realisation: 1,
            profile: vec![wave(1e-4, slope), wave(2e-4, slope)],
        };
        let surfaces = [surface(8, 0.9), surface(9, 0.2)];
        let values =
            [8, 9].map(|waves| vec![curve(waves, 1, 0.05, 1.0), curve(waves, 2, 0.05, 1.01)]);
        let mut rows = average(Model::Bem, values.concat());
        for row in &mut rows {
            (row.scan_error, row.shortest_wavelength_mm) = (Some(0.0), 0.1);
            row.error_estimate = basis::sum_of_errors(row);
        }
        let mut rubber = Rubber::elastic(4e6, 0.49);
        rubber.branches.push(MaxwellBranch { modulus: 1e8, relaxation_time: 1e-5 });
        let rubber = RubberModel::from(rubber);
        let warnings = doubts(&rows, &surfaces, &rubber, None);
        // Slopes of 1.27 and 0.28; half of the friction against an error of 7 %.
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        assert!(warnings[0].contains("1.27 by 8 waves; a section [micro]"), "{}", warnings[0]);
        assert!(warnings[1].contains("8 waves (stated") && warnings[1].contains("9 waves (stated"));
        for row in &mut rows {
            row.error_estimate = Some(10.0);
        }
        assert!(doubts(&rows, &surfaces[1..], &rubber, Some(0.7)).is_empty());
    }
}
