//! Predictions against measurements: misfits, bands, fitted constants.

use super::set::{Label, Prediction, Set, ValidationError};
use crate::interface::{
    FittedShear, Fixed, Interval, MeasuredFriction, PredictedFriction, ShearError, ShearLaw,
    fit_shear,
};
use crate::measurement::Beside;
use crate::units::Units;
use serde::Serialize;

/// Where the shear stress of a prediction is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Case {
    /// There is none: hysteresis alone.
    Hysteresis,
    /// The section `[adhesion]`.
    Given,
    /// Fitted to the set itself.
    Own,
    /// One law fitted to all sets together.
    Joint,
    /// Fitted to all other sets.
    Other,
}

impl Case {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hysteresis => "hysteresis",
            Self::Given => "given",
            Self::Own => "own",
            Self::Joint => "joint",
            Self::Other => "other",
        }
    }
}

/// A constant of the shear stress in the unit of the recipe's key, with its 95 % interval if it was fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Constant {
    /// Key of the section `[adhesion]`.
    pub key: &'static str,
    /// Its value.
    pub value: f64,
    /// Ends of the interval; absent if the constant was not fitted.
    pub interval_95: Option<[f64; 2]>,
}

/// A fitted law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedLaw {
    /// Titles of the sets that it was fitted to.
    pub fitted_to: Vec<String>,
    /// Temperature in °C at which `speed_mm_s` holds: `validation.reference_c`, else the lowest of the sets; none for a law that
    /// does not shift.
    pub reference_c: Option<f64>,
    /// Measurements less fitted constants.
    pub degrees_of_freedom: usize,
    /// The constants.
    pub constants: Vec<Constant>,
}

/// A measurement beside its prediction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JudgedPoint {
    /// Title of its set.
    pub set: String,
    /// Sliding speed.
    pub speed_mm_s: f64,
    /// Temperature.
    pub temperature_c: f64,
    /// Mean pressure.
    pub pressure_mpa: f64,
    /// Measured friction.
    pub measured: f64,
    /// Predicted friction: hysteretic and adhesive.
    pub predicted: f64,
    /// Predicted less measured.
    pub misfit: f64,
    /// Part of the hysteresis.
    pub hysteretic: f64,
    /// Part of the shear of the contact area.
    pub adhesive: f64,
    /// Contact area fraction.
    pub contact_area_fraction: f64,
    /// Ends of the 95 % band; absent if an error of the computation is unknown.
    pub band_95: Option<[f64; 2]>,
    /// What the band is made of.
    pub band_parts: BandParts,
    /// Whether the measurement is inside the band; absent without a band.
    pub inside: Option<bool>,
}

/// Half widths that make the 95 % band of a point: the band reaches `sqrt(fit² + (hysteresis + area)²)` to each side.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BandParts {
    /// The fitted constants and the scatter of the measurements about the law; 0 where nothing is fitted.
    pub fit: f64,
    /// Error of the computed hysteresis, by the surfaces and by the grid; absent if it is unknown.
    pub hysteresis: Option<f64>,
    /// Error of the contact area, times its friction; 0 without adhesion, absent if it is unknown.
    pub area: Option<f64>,
}

impl BandParts {
    /// The half width of the band; `None` if a part is unknown.
    fn half_width(&self) -> Option<f64> {
        Some(self.fit.hypot(self.hysteresis? + self.area?))
    }
}

/// One prediction in one case, over all sets.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judged {
    /// What makes the prediction.
    #[serde(flatten)]
    pub label: Label,
    /// Where its shear stress is from.
    pub case: Case,
    /// Root mean square misfit over all points.
    pub rms: f64,
    /// The same of each set, in their order.
    pub rms_of_sets: Vec<f64>,
    /// Number of points inside their band.
    pub inside_band: usize,
    /// Number of points that have one.
    pub with_band: usize,
    /// The fitted laws: none, one for all sets, or one a set.
    pub laws: Vec<FittedLaw>,
    /// The measurements.
    pub points: Vec<JudgedPoint>,
}

/// All predictions in all cases.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Validated {
    /// Titles of the sets.
    pub sets: Vec<String>,
    /// Every prediction in every case.
    pub results: Vec<Judged>,
    /// What could not be made or fitted, and why.
    pub left_out: Vec<String>,
}

impl Validated {
    /// The result that speaks for the sets: that of the first prediction, under the given law if there is one, else under one law
    /// for all sets, or, of a single set, under its own.
    pub fn headline(&self) -> Option<&Judged> {
        let first = &self.results.first()?.label;
        let own = || self.results.iter().filter(|result| result.label == *first);
        let wanted = if self.sets.len() > 1 { Case::Joint } else { Case::Own };
        let of = |case: Case| own().find(|result| result.case == case);
        of(Case::Given).or_else(|| of(wanted)).or_else(|| of(Case::Hysteresis))
    }
}

/// Judges every prediction that all sets have.
///
/// The band of a prediction adds, in squares, the 95 % interval of one more measurement under the fitted law
/// ([`FittedShear::predict`]) and the error of the computation: that of the hysteresis, and that of the contact area times its
/// friction. Without a fitted law it is the error of the computation alone.
///
/// # Errors
/// [`ValidationError::DifferentConstants`], [`ValidationError::SameTitle`].
pub fn judge(sets: &[Set]) -> Result<Validated, ValidationError> {
    let (fixed, reference_c) = common_constants(sets)?;
    for (k, set) in sets.iter().enumerate() {
        if sets[..k].iter().any(|other| other.title == set.title) {
            return Err(ValidationError::SameTitle { title: set.title.clone() });
        }
    }
    let mut left_out: Vec<String> = sets
        .iter()
        .flat_map(|set| set.left_out.iter().map(|reason| format!("{}: {reason}", set.title)))
        .collect();
    let mut results = Vec::new();
    for first in sets.first().map(|set| &set.predictions[..]).unwrap_or_default() {
        let own = |set: &Set| set.predictions.iter().find(|own| own.label == first.label).cloned();
        let Some(predictions) = sets.iter().map(own).collect::<Option<Vec<Prediction>>>() else {
            left_out.push(format!("{}: not every set has it", first.label));
            continue;
        };
        let judging =
            Judging { sets, predictions: &predictions, fixed, reference_c, label: &first.label };
        for case in [Case::Hysteresis, Case::Given, Case::Own, Case::Joint, Case::Other] {
            match judging.case(case) {
                Ok(judged) => results.extend(judged),
                Err(error) => left_out.push(format!("{}, {}: {error}", first.label, case.name())),
            }
        }
    }
    let sets = sets.iter().map(|set| set.title.clone()).collect();
    Ok(Validated { sets, results, left_out })
}

impl std::fmt::Display for Label {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{}, {}", self.model, self.surfaces)?;
        if self.effect == "none" { Ok(()) } else { write!(f, ", {}", self.effect) }
    }
}

/// The constants that no set has fitted and the temperature in °C of their speed, if it is stated; all must agree.
fn common_constants(sets: &[Set]) -> Result<(Fixed, Option<f64>), ValidationError> {
    let fixed = sets.first().map(|set| set.fixed).unwrap_or_default();
    let reference_c = sets.first().and_then(|set| set.reference_c);
    for set in sets {
        let keys = [
            ("speed_mm_s", set.fixed.peak_speed == fixed.peak_speed),
            ("width", set.fixed.width == fixed.width),
            ("activation_ev", set.fixed.energy_ev == fixed.energy_ev),
            ("reference_c", set.reference_c == reference_c),
        ];
        if let Some((key, _)) = keys.into_iter().find(|(_, same)| !same) {
            return Err(ValidationError::DifferentConstants { key });
        }
    }
    Ok((fixed, reference_c))
}

/// Relative difference of shortest wavelengths that counts as none, as in the tables of total friction.
const SAME_WAVELENGTH: f64 = 0.05;

/// Why a case has no result.
#[derive(Debug, thiserror::Error)]
enum Unjudged {
    #[error(transparent)]
    Shear(#[from] ShearError),
    #[error(
        "the law is fitted at {fitted_c} °C without a shift, and a measurement is at {celsius} °C: set validation.activation_ev"
    )]
    Temperature { fitted_c: f64, celsius: f64 },
    #[error(
        "the law of [adhesion] belongs to a shortest wavelength of {fitted} mm, and these surfaces end at {own:.6} mm"
    )]
    Wavelength { fitted: f64, own: f64 },
}

/// One prediction of all sets.
struct Judging<'a> {
    sets: &'a [Set],
    predictions: &'a [Prediction],
    fixed: Fixed,
    reference_c: Option<f64>,
    label: &'a Label,
}

/// The shear stress of a case.
enum Shear<'a> {
    None,
    Law(&'a ShearLaw),
    Fitted(&'a FittedShear),
}

impl Judging<'_> {
    /// Judges the prediction in one case. Returns `None` if the case does not apply to the sets.
    fn case(&self, case: Case) -> Result<Option<Judged>, Unjudged> {
        let all: Vec<usize> = (0..self.sets.len()).collect();
        let but = |one: usize| all.iter().copied().filter(|k| *k != one).collect::<Vec<_>>();
        let several = self.sets.len() > 1;
        match case {
            Case::Hysteresis => Ok(Some(self.judged(case, &[])?)),
            Case::Given if self.sets.iter().all(|set| set.given.is_some()) => {
                self.require_fitted_wavelength()?;
                Ok(Some(self.judged(case, &[])?))
            }
            Case::Own => {
                let fits = all.iter().map(|k| self.fit(&[*k])).collect::<Result<Vec<_>, _>>()?;
                Ok(Some(self.judged(case, &fits)?))
            }
            Case::Joint if several => Ok(Some(self.judged(case, &[self.fit(&all)?])?)),
            Case::Other if several => {
                let fits = all.iter().map(|k| self.fit(&but(*k))).collect::<Result<Vec<_>, _>>()?;
                self.require_shift(&fits)?;
                Ok(Some(self.judged(case, &fits)?))
            }
            Case::Given | Case::Joint | Case::Other => Ok(None),
        }
    }

    /// A law that was fitted at one temperature says nothing of another one.
    fn require_shift(&self, fits: &[(Vec<usize>, FittedShear)]) -> Result<(), Unjudged> {
        let celsius =
            |k: usize| self.predictions[k].values.iter().map(|value| value.measured.temperature_c);
        for (k, (of, fit)) in fits.iter().enumerate() {
            let fitted = of.first().and_then(|first| celsius(*first).next());
            let mut own = celsius(k);
            if let (None, Some(fitted_c), Some(celsius)) =
                (fit.law.shift, fitted, own.find(|own| Some(*own) != fitted))
            {
                return Err(Unjudged::Temperature { fitted_c, celsius });
            }
        }
        Ok(())
    }

    /// A law belongs to the shortest wavelength that it was fitted at.
    fn require_fitted_wavelength(&self) -> Result<(), Unjudged> {
        for (set, prediction) in self.sets.iter().zip(self.predictions) {
            let own = prediction.shortest_wavelength_mm;
            let given = set.given.as_ref().map(|(_, fitted)| *fitted);
            if let Some(fitted) =
                given.filter(|fitted| (own / fitted - 1.0).abs() > SAME_WAVELENGTH)
            {
                return Err(Unjudged::Wavelength { fitted, own });
            }
        }
        Ok(())
    }

    /// One law for some sets.
    fn fit(&self, of: &[usize]) -> Result<(Vec<usize>, FittedShear), ShearError> {
        let measured: Vec<MeasuredFriction> = of
            .iter()
            .flat_map(|k| self.predictions[*k].values.iter().map(|value| value.measured))
            .collect();
        let first = measured.first().map(|m| m.temperature_c);
        let one = measured.iter().all(|m| Some(m.temperature_c) == first);
        let shifts = !one || self.fixed.energy_ev.is_some();
        let known = self.sets.iter().filter_map(|set| set.temperature_c).reduce(f64::min);
        let reference_c = self.reference_c.or(known).or(first);
        let fit = fit_shear(&measured, reference_c.filter(|_| shifts), self.fixed)?;
        Ok((of.to_vec(), fit))
    }

    /// The points of a case under its laws: none, one for all sets, or one a set.
    fn judged(&self, case: Case, fits: &[(Vec<usize>, FittedShear)]) -> Result<Judged, ShearError> {
        let (mut points, mut rms_of_sets) = (Vec::new(), Vec::new());
        for (k, (set, prediction)) in self.sets.iter().zip(self.predictions).enumerate() {
            let fitted = if fits.len() == 1 { fits.first() } else { fits.get(k) };
            let shear = match (case, fitted, &set.given) {
                (Case::Given, _, Some((law, _))) => Shear::Law(law),
                (_, Some((_, fit)), _) => Shear::Fitted(fit),
                _ => Shear::None,
            };
            let own: Vec<JudgedPoint> = prediction
                .values
                .iter()
                .map(|value| shear.judge(&set.title, value))
                .collect::<Result<_, _>>()?;
            rms_of_sets.push(rms(&own));
            points.extend(own);
        }
        let law = |(of, fit): &(Vec<usize>, FittedShear)| FittedLaw {
            fitted_to: of.iter().map(|k| self.sets[*k].title.clone()).collect(),
            reference_c: fit.law.shift.map(|shift| shift.reference_c),
            degrees_of_freedom: fit.degrees_of_freedom,
            constants: constants(fit),
        };
        Ok(Judged {
            label: self.label.clone(),
            case,
            rms: rms(&points),
            rms_of_sets,
            inside_band: points.iter().filter(|point| point.inside == Some(true)).count(),
            with_band: points.iter().filter(|point| point.inside.is_some()).count(),
            laws: fits.iter().map(law).collect(),
            points,
        })
    }
}

impl Shear<'_> {
    fn judge(&self, set: &str, value: &Beside) -> Result<JudgedPoint, ShearError> {
        let at = &value.measured;
        let PredictedFriction { friction, adhesive, half_width_95 } = match self {
            Self::Fitted(fit) => fit.predict(at)?,
            Self::None => without_scatter(at, 0.0),
            Self::Law(law) => {
                let stress = law.stress(at.speed, at.temperature_c)?;
                without_scatter(at, stress * at.contact_area_fraction / at.pressure)
            }
        };
        let by_area = value.relative_area_error.map(|error| error * adhesive);
        let of_shear = if adhesive == 0.0 { Some(0.0) } else { by_area };
        let band_parts =
            BandParts { fit: half_width_95, hysteresis: value.hysteretic_error, area: of_shear };
        let band_95 = band_parts.half_width().map(|half| [friction - half, friction + half]);
        Ok(JudgedPoint {
            set: set.into(),
            speed_mm_s: at.speed.m_to_mm(),
            temperature_c: at.temperature_c,
            pressure_mpa: at.pressure.pa_to_mpa(),
            measured: at.friction,
            predicted: friction,
            misfit: friction - at.friction,
            hysteretic: at.hysteretic,
            adhesive,
            contact_area_fraction: at.contact_area_fraction,
            band_95,
            band_parts,
            inside: band_95.map(|[low, high]| (low..=high).contains(&at.friction)),
        })
    }
}

/// Friction by a law without fitted constants.
fn without_scatter(at: &MeasuredFriction, adhesive: f64) -> PredictedFriction {
    PredictedFriction { friction: at.hysteretic + adhesive, adhesive, half_width_95: 0.0 }
}

fn rms(points: &[JudgedPoint]) -> f64 {
    let sum: f64 = points.iter().map(|point| point.misfit * point.misfit).sum();
    (sum / points.len() as f64).sqrt()
}

fn constants(fit: &FittedShear) -> Vec<Constant> {
    let constant = |key, interval: Interval, unit: fn(f64) -> f64| Constant {
        key,
        value: unit(interval.value),
        interval_95: interval.ends.map(|ends| ends.map(unit)),
    };
    let mut constants = vec![
        constant("shear_mpa", fit.peak_stress, f64::pa_to_mpa),
        constant("speed_mm_s", fit.peak_speed, f64::m_to_mm),
        constant("width", fit.width, |c| c),
    ];
    constants.extend(fit.energy_ev.map(|energy| constant("activation_ev", energy, |c| c)));
    constants
}

#[cfg(test)]
mod tests;
