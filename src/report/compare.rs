//! Which of two runs has more friction, with the interval of the difference.

use super::About;
use super::ReportError;
use super::tables::significant;
use crate::artifact::RunView;
use crate::numerics::statistics::MeanEstimate;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};
use crate::stages::bem::Given;
use crate::stages::realise::{AREAL, SURFACES, SurfaceKind};
use crate::stages::tables::{FRICTION, FrictionRow, Model};
use serde::Serialize;
use serde_json::Value;

/// How the averages of two runs are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pairing {
    /// Realisation by realisation: both runs have the same surfaces, or the same phases on other ones.
    Paired,
    /// By the scatter of both.
    Independent,
}

/// One average of a run beside that of another.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Contact model of both.
    pub model: Model,
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// What friction is given for.
    pub given: Given,
    /// Contact area fraction of the first run.
    pub contact_area_fraction: f64,
    /// Mean pressure in MPa of the first run.
    pub pressure_mpa: f64,
    /// Mean friction coefficient of the first run.
    pub first: f64,
    /// Mean friction coefficient of the second run.
    pub second: f64,
    /// Second less first.
    pub difference: f64,
    /// Half width of the 95 % confidence interval of the difference by scans and phases; absent where one of the runs has
    /// none.
    pub confidence_95: Option<f64>,
    /// How it was found.
    pub pairing: Pairing,
}

impl Difference {
    /// Whether the interval leaves out zero.
    pub fn is_told(&self) -> bool {
        self.confidence_95.is_some_and(|half| self.difference.abs() > half)
    }
}

/// Two runs beside each other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Compared {
    /// Every average that both runs have.
    pub rows: Vec<Difference>,
    /// Rubber and temperature of each run.
    pub materials: [String; 2],
    /// What else the recipes say of the surfaces, where it differs.
    pub warnings: Vec<String>,
}

/// Compares the averages that both runs have.
///
/// # Errors
/// [`ReportError`] if results cannot be read.
pub fn compare(first: &RunView, second: &RunView) -> Result<Compared, ReportError> {
    let (a, b) = (first.rows(FRICTION)?, second.rows(FRICTION)?);
    let shared = Shared::of(first, second)?;
    let of_row = |row: &FrictionRow| {
        let other = b.iter().find(|other| {
            (other.model, other.kind) == (row.model, row.kind)
                && other.speed_mm_s == row.speed_mm_s
                && other.condition() == row.condition()
        })?;
        Some(difference(row, other, shared))
    };
    let rows: Vec<Difference> = a.iter().filter_map(of_row).collect();
    let mut warnings = Vec::new();
    let shortest = |rows: &[FrictionRow]| {
        rows.iter().map(|row| row.shortest_wavelength_mm).fold(f64::INFINITY, f64::min)
    };
    let (short_a, short_b) = (shortest(&a), shortest(&b));
    if (short_a / short_b - 1.0).abs() > 1e-6 {
        warnings.push(format!(
            "the shortest wavelengths are {} and {} mm: friction grows with shorter ones, so that the difference is theirs too",
            significant(short_a),
            significant(short_b)
        ));
    }
    let (about_a, about_b) = (About::of(first)?, About::of(second)?);
    if rows.iter().any(|row| row.kind.method.is_areal()) {
        if about_a.angle_deg != about_b.angle_deg {
            warnings.push(format!(
                "areal surfaces: the rubber slides at {} degrees in the first run and at {} in the second",
                about_a.angle_deg.unwrap_or_default(),
                about_b.angle_deg.unwrap_or_default()
            ));
        }
        if about_a.thickness_mm != about_b.thickness_mm {
            let body = |about: &About| {
                about.thickness_mm.map_or("a half-space".into(), |mm| format!("a layer of {mm} mm"))
            };
            warnings.push(format!(
                "areal surfaces: the rubber is {} in the first run and {} in the second",
                body(&about_a),
                body(&about_b)
            ));
        }
    }
    Ok(Compared { rows, materials: [about_a.material(), about_b.material()], warnings })
}

/// What two runs share.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Shared {
    /// All profiles.
    surfaces: bool,
    /// All areal surfaces.
    areal: bool,
    /// The seed of the phases.
    seed: bool,
}

impl Shared {
    fn of(first: &RunView, second: &RunView) -> Result<Self, ReportError> {
        let (a, b) = (first.stage_manifest("realise")?, second.stage_manifest("realise")?);
        let (Some(a), Some(b)) = (a, b) else {
            return Ok(Self { surfaces: false, areal: false, seed: false });
        };
        let same = |file: &str| {
            let content = |manifest: &crate::artifact::Manifest| {
                manifest.output(file).map(|output| output.content_digest)
            };
            content(&a).is_some() && content(&a) == content(&b)
        };
        let seed = |parameters: &Value| parameters.get("seed").cloned();
        Ok(Self {
            surfaces: same(SURFACES.file().name),
            areal: same(AREAL.file.name),
            seed: seed(&a.parameters) == seed(&b.parameters),
        })
    }

    /// Whether realisations of that kind are the same in both runs, or have the same phases.
    fn pairs(self, kind: SurfaceKind) -> bool {
        let same = if kind.method.is_areal() { self.areal } else { self.surfaces };
        same || self.seed && !kind.method.of_a_window()
    }
}

fn difference(row: &FrictionRow, other: &FrictionRow, shared: Shared) -> Difference {
    let difference = other.mean - row.mean;
    let (a, b) = (&row.realisations, &other.realisations);
    let paired = shared.pairs(row.kind) && a.len() == b.len() && a.len() > 1;
    // The choice of scans changes friction of both alike where the surfaces are the same: only their difference feels it.
    let relative = |row: &FrictionRow| row.scan_error.map(|error| error / row.mean.abs());
    let scans = match (row.scan_error, other.scan_error) {
        (Some(_), Some(_)) if shared.surfaces => {
            relative(row).zip(relative(other)).map(|(a, b)| a.max(b) * difference.abs())
        }
        (Some(a), Some(b)) => Some(a.hypot(b)),
        _ => None,
    };
    let scatter = if paired {
        let each: Vec<f64> = a.iter().zip(b).map(|(a, b)| b - a).collect();
        Some(MeanEstimate::of(&each).confidence_95)
    } else {
        row.confidence_95.zip(other.confidence_95).map(|(a, b)| a.hypot(b))
    };
    Difference {
        model: row.model,
        kind: row.kind,
        speed_mm_s: row.speed_mm_s,
        given: row.given,
        contact_area_fraction: row.contact_area_fraction,
        pressure_mpa: row.pressure_mpa,
        first: row.mean,
        second: other.mean,
        difference,
        confidence_95: scatter.zip(scans).map(|(scatter, scans)| scatter.hypot(scans)),
        pairing: if paired { Pairing::Paired } else { Pairing::Independent },
    }
}

impl Compared {
    /// Relative difference over speed, or over area or pressure where there is one speed alone: a line for each model, kind
    /// of surfaces and what is fixed.
    pub fn figure(&self, names: [&str; 2]) -> Option<Figure> {
        let first = self.rows.first()?;
        let over_speed = self.rows.iter().any(|row| row.speed_mm_s != first.speed_mm_s);
        let abscissa = |row: &Difference| match (over_speed, row.given) {
            (true, _) => row.speed_mm_s,
            (false, Given::Area) => row.contact_area_fraction,
            (false, Given::Pressure) => row.pressure_mpa,
        };
        let name = |row: &Difference| {
            let condition = match (over_speed, row.given) {
                (false, _) => format!("{} mm/s", row.speed_mm_s),
                (true, Given::Area) => format!("Ac/A0 = {}", row.contact_area_fraction),
                (true, Given::Pressure) => format!("{} MPa", row.pressure_mpa),
            };
            format!("{}, {}, {condition}", row.model, row.kind)
        };
        let mut lines: Vec<(String, Vec<&Difference>)> = Vec::new();
        for row in &self.rows {
            let name = name(row);
            match lines.iter_mut().find(|(known, _)| *known == name) {
                Some((_, rows)) => rows.push(row),
                None => lines.push((name, vec![row])),
            }
        }
        let series = lines.into_iter().enumerate().flat_map(|(number, (name, rows))| {
            let colour = Colour::Nth(number);
            let percent = |value: f64, row: &Difference| 100.0 * value / row.first;
            let bars = rows.iter().filter_map(|row| {
                let half = row.confidence_95?;
                let ends = [row.difference - half, row.difference + half];
                Some((abscissa(row), percent(ends[0], row), percent(ends[1], row)))
            });
            let bars = Series::unnamed(colour, Mark::ErrorBars(bars.collect()));
            let points: Vec<(f64, f64)> =
                rows.iter().map(|row| (abscissa(row), percent(row.difference, row))).collect();
            [
                bars,
                Series::new(name, colour, Mark::Line(points.clone())),
                Series::unnamed(colour, Mark::FilledCircles(points)),
            ]
        });
        let x = match (over_speed, first.given) {
            (true, _) => Axis::logarithmic("sliding speed v / (mm/s); 1 km/h is 278 mm/s"),
            (false, Given::Area) => Axis::from_zero("contact area fraction Ac/A0"),
            (false, Given::Pressure) => Axis::from_zero("mean pressure p / MPa"),
        };
        let panel = Panel {
            title: format!("Friction of {} over that of {}", names[1], names[0]),
            x,
            y: Axis::linear("difference of friction / %"),
            series: series
                .chain([Series::unnamed(Colour::Black, Mark::HorizontalLine(0.0))])
                .collect(),
        };
        let caption = format!(
            "Difference of friction between {} ({}) and {} ({}), relative to the first, with the 95 % confidence interval of \
             the difference.",
            names[0], self.materials[0], names[1], self.materials[1]
        );
        Some(Figure { caption, panels: vec![panel] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(method: crate::stages::realise::Method, realisations: &[f64]) -> FrictionRow {
        let estimate = MeanEstimate::of(realisations);
        FrictionRow {
            model: Model::Bem,
            kind: SurfaceKind { method, waves: 0 },
            speed_mm_s: 10.0,
            given: Given::Area,
            contact_area_fraction: 0.05,
            shortest_wavelength_mm: 0.06,
            windows: 9,
            realisations: realisations.to_vec(),
            half_space_realisations: None,
            mean: estimate.mean,
            standard_deviation: Some(estimate.standard_deviation),
            confidence_95: Some(estimate.confidence_95),
            scan_error: Some(0.0),
            interpolation_error: 0.0,
            discretisation_error: None,
            left_out_error: 0.0,
            microscale_error: None,
            model_error: None,
            error_estimate: None,
            pressure_mpa: 1.0,
            shortest_reliable_wavelength_mm: None,
        }
    }

    #[test]
    fn the_same_surfaces_are_compared_one_by_one() {
        use crate::stages::realise::Method::Measured;
        let (a, b) = (row(Measured, &[0.1, 0.5, 0.9]), row(Measured, &[0.2, 0.61, 0.99]));
        let same = Shared { surfaces: true, areal: true, seed: true };
        let paired = difference(&a, &b, same);
        assert!(paired.is_told() && paired.pairing == Pairing::Paired, "{paired:?}");
        // t(2) 0.01 / sqrt 3.
        approx::assert_relative_eq!(paired.confidence_95.unwrap(), 0.02484, max_relative = 1e-3);
        let other = difference(&a, &b, Shared { surfaces: false, areal: false, seed: true });
        assert!(!other.is_told() && other.pairing == Pairing::Independent);
        let sines = crate::stages::realise::Method::Sines;
        let mut a = row(sines, &[0.1, 0.5, 0.9]);
        let mut b = row(sines, &[0.2, 0.61, 0.99]);
        (a.scan_error, b.scan_error) = (Some(0.3), Some(0.4));
        let shared_phases =
            difference(&a, &b, Shared { surfaces: false, areal: false, seed: true });
        assert_eq!(shared_phases.pairing, Pairing::Paired);
        // Two roads: the errors of both scans count.
        assert!(shared_phases.confidence_95.unwrap() > 0.5);
        let one_road = difference(&a, &b, same);
        // Of one road they change the difference alone: two thirds of 0.1.
        approx::assert_relative_eq!(
            one_road.confidence_95.unwrap(),
            0.066_67_f64.hypot(0.02484),
            max_relative = 1e-2
        );
    }
}
