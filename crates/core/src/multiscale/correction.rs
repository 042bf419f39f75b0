//! The correction of the friction of a macro contact by the microscale.

use super::LawError;
use crate::numerics::interpolation::CubicHermite;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the change of the friction of the microscale is applied to the friction of all waves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CorrectionRule {
    /// Multiplied: friction changes by the ratio of both frictions of the microscale. The waves that are left to
    /// the half-space deform too, and so get the same relative change.
    #[default]
    Ratio,
    /// Added: friction changes by the difference of both frictions of the microscale, the rule of the thesis
    /// (5.1.1-2).
    Difference,
}

/// How local frictions become one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MeanRule {
    /// Weighted with the local pressure: friction is a force, and so adds up.
    #[default]
    Force,
    /// The plain mean over the contact points, the rule of the thesis (5.1.1-2).
    Points,
}

/// Friction and area of the microscale over its mean pressure, under both models.
#[derive(Debug, Clone)]
pub struct Microscale {
    pressures: (f64, f64),
    half_space: CubicHermite,
    finite: CubicHermite,
    area_change: CubicHermite,
    interpolation_error: f64,
    discretisation_error: Option<CubicHermite>,
}

/// Friction of the microscale under both models, averaged over the macro contact, and the change of the area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Mean friction weighted with the local pressures.
    pub force: MeanFriction,
    /// Plain mean of friction over the contact points.
    pub points: MeanFriction,
    /// Change of the contact area fraction.
    pub area: f64,
    /// Estimated error of the friction at finite deformation by the mesh, weighted with the local pressures; `None` if
    /// that of the microscale is not known.
    pub discretisation_error: Option<f64>,
}

/// A mean friction coefficient of the microscale under both models.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanFriction {
    /// On the half-space.
    pub half_space: f64,
    /// At finite deformation.
    pub finite_deformation: f64,
}

impl MeanFriction {
    /// `finite_deformation - half_space`.
    pub fn difference(self) -> f64 {
        self.finite_deformation - self.half_space
    }

    /// The friction coefficient of all waves, `of_all_waves` on the half-space, corrected by a rule.
    pub fn applied(self, rule: CorrectionRule, of_all_waves: f64) -> f64 {
        of_all_waves + self.gain(rule, of_all_waves) * self.difference()
    }

    /// Factor of the difference, and of its error, in [`Self::applied`]. Without friction on the
    /// half-space, as of a rubber without loss, there is no ratio, and the difference is added.
    pub fn gain(self, rule: CorrectionRule, of_all_waves: f64) -> f64 {
        match rule {
            CorrectionRule::Ratio if self.half_space > 0.0 => of_all_waves / self.half_space,
            CorrectionRule::Ratio | CorrectionRule::Difference => 1.0,
        }
    }
}

impl Microscale {
    /// From samples at ascending pressures in Pa: friction of both models, the contact area
    /// fraction at finite deformation less that of the half-space, and the errors by interpolation.
    /// Between the samples cubics in `ln p`.
    ///
    /// # Panics
    /// If the lengths differ, there is no sample, or the pressures do not ascend from above zero.
    pub fn new(
        pressures: &[f64],
        half_space: Vec<f64>,
        finite: Vec<f64>,
        area_change: Vec<f64>,
        errors: Vec<f64>,
    ) -> Self {
        let logarithms = || pressures.iter().map(|p| p.ln()).collect::<Vec<f64>>();
        Self {
            pressures: (pressures[0], pressures[pressures.len() - 1]),
            half_space: CubicHermite::smooth(logarithms(), half_space),
            finite: CubicHermite::smooth(logarithms(), finite),
            area_change: CubicHermite::smooth(logarithms(), area_change),
            interpolation_error: errors.into_iter().fold(0.0, f64::max),
            discretisation_error: None,
        }
    }

    /// With the errors by the mesh at the sampled `pressures` in Pa, if they are known.
    ///
    /// # Panics
    /// If the lengths differ.
    #[must_use]
    pub fn with_discretisation_errors(
        mut self,
        pressures: &[f64],
        errors: Option<Vec<f64>>,
    ) -> Self {
        let logarithms = pressures.iter().map(|p| p.ln()).collect();
        self.discretisation_error = errors.map(|errors| CubicHermite::linear(logarithms, errors));
        self
    }

    /// Whether a point of the macro contact with this local pressure in Pa is a contact point: one with at least
    /// the smallest sampled pressure, below which the mesh of the microscale does not resolve the contact.
    pub fn is_contact_point(&self, pressure: f64) -> bool {
        pressure >= self.pressures.0
    }

    /// The largest sampled pressure in Pa.
    pub fn largest_pressure(&self) -> f64 {
        self.pressures.1
    }

    /// Largest estimated error of a correction by interpolation.
    pub fn interpolation_error(&self) -> f64 {
        self.interpolation_error
    }

    /// Friction of the half-space and at finite deformation at a sampled pressure in Pa; none
    /// outside the samples.
    pub fn friction(&self, pressure: f64) -> Option<(f64, f64)> {
        let sampled = (self.pressures.0..=self.pressures.1).contains(&pressure);
        let log = pressure.ln();
        sampled.then(|| (self.half_space.at(log), self.finite.at(log)))
    }

    /// The correction under local pressures in Pa on equidistant points. Of points that are no
    /// [contact points](Self::is_contact_point) the little force takes the friction of the smallest sampled
    /// pressure, and the area is left out. `None` if there is no contact point.
    ///
    /// # Errors
    /// [`LawError::BeyondSamples`] for a pressure above the largest sampled one.
    pub fn correction(&self, local: &[f64]) -> Result<Option<Correction>, LawError> {
        let (smallest, largest) = self.pressures;
        let (mut force, mut points) = (Sums::default(), Sums::default());
        let (mut area, mut mesh) = (0.0, 0.0);
        for &pressure in local.iter().filter(|p| **p > 0.0) {
            if pressure > largest {
                return Err(LawError::BeyondSamples { pressure, largest });
            }
            let log = pressure.max(smallest).ln();
            let friction = (self.half_space.at(log), self.finite.at(log));
            force.add(pressure, friction);
            mesh +=
                self.discretisation_error.as_ref().map_or(0.0, |error| pressure * error.at(log));
            if self.is_contact_point(pressure) {
                points.add(1.0, friction);
                area += self.area_change.at(log);
            }
        }
        let load = force.weight;
        let (Some(force), Some(points)) = (force.mean(), points.mean()) else { return Ok(None) };
        Ok(Some(Correction {
            force,
            points,
            area: area / local.len() as f64,
            discretisation_error: self.discretisation_error.is_some().then(|| mesh / load),
        }))
    }
}

/// Weighted sums of the friction of both models.
#[derive(Default)]
struct Sums {
    weight: f64,
    half_space: f64,
    finite_deformation: f64,
}

impl Sums {
    fn add(&mut self, weight: f64, (half_space, finite_deformation): (f64, f64)) {
        self.weight += weight;
        self.half_space += weight * half_space;
        self.finite_deformation += weight * finite_deformation;
    }

    /// `None` without any weight.
    fn mean(&self) -> Option<MeanFriction> {
        let Self { weight, half_space, finite_deformation } = *self;
        (weight > 0.0).then(|| MeanFriction {
            half_space: half_space / weight,
            finite_deformation: finite_deformation / weight,
        })
    }
}

/// Local mean pressures: the pressures of a periodic macro grid, averaged over `points` of them
/// about each. The law and the friction of the microscale belong to a mean over one period of it;
/// pressures that the macro contact resolves below that length have no meaning for it.
pub fn running_mean(pressures: &[f64], points: usize) -> Vec<f64> {
    let n = pressures.len();
    let points = points.clamp(1, n);
    let first = |i: usize| (i + n - points / 2) % n;
    let mean = |i: usize| {
        let window = (0..points).map(|k| pressures[(first(i) + k) % n]);
        window.sum::<f64>() / points as f64
    };
    (0..n).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Linear in ln p, which the cubics keep.
    fn microscale() -> Microscale {
        let pressures = [1.0, 2.0, 4.0, 8.0];
        let finite = pressures.iter().map(|p: &f64| 0.5 + 0.1 * p.ln()).collect();
        let area = pressures.iter().map(|p: &f64| 0.01 * p.ln()).collect();
        Microscale::new(&pressures, vec![0.4; 4], finite, area, vec![0.0, 2e-4, 1e-4, 0.0])
    }

    #[test]
    fn errors_by_the_mesh_are_weighted_with_the_pressures() {
        let pressures = [1.0, 2.0, 4.0, 8.0];
        let errors = pressures.iter().map(|p: &f64| 1e-3 * p.ln()).collect();
        let known = microscale().with_discretisation_errors(&pressures, Some(errors));
        let correction = known.correction(&[0.0, 2.0, 6.0]).unwrap().unwrap();
        let expected = 1e-3 * (2.0 * 2.0_f64.ln() + 6.0 * 6.0_f64.ln()) / 8.0;
        assert_relative_eq!(
            correction.discretisation_error.unwrap(),
            expected,
            max_relative = 1e-12
        );
        let unknown = microscale().with_discretisation_errors(&pressures, None);
        assert_eq!(unknown.correction(&[2.0]).unwrap().unwrap().discretisation_error, None);
    }

    #[test]
    fn means_are_those_by_hand() {
        let correction = microscale().correction(&[0.0, 0.5, 2.0, 6.0]).unwrap().unwrap();
        let (two, six) = (0.1 + 0.1 * 2.0_f64.ln(), 0.1 + 0.1 * 6.0_f64.ln());
        let points = 0.5 * (two + six);
        assert_relative_eq!(correction.points.difference(), points, max_relative = 1e-12);
        let force = (0.5 * 0.1 + 2.0 * two + 6.0 * six) / 8.5;
        assert_relative_eq!(correction.force.difference(), force, max_relative = 1e-12);
        assert_relative_eq!(correction.force.half_space, 0.4, max_relative = 1e-12);
        let friction = |rule| correction.force.applied(rule, 0.7);
        assert_relative_eq!(
            friction(CorrectionRule::Difference),
            0.7 + force,
            max_relative = 1e-12
        );
        let ratio = (0.4 + force) / 0.4;
        assert_relative_eq!(friction(CorrectionRule::Ratio), 0.7 * ratio, max_relative = 1e-12);
        let lossless = MeanFriction { half_space: 0.0, finite_deformation: 0.0 };
        assert_eq!(lossless.applied(CorrectionRule::Ratio, 0.0), 0.0);
        assert_relative_eq!(correction.area, 0.01 * 12.0_f64.ln() / 4.0, max_relative = 1e-12);
    }

    #[test]
    fn nothing_beyond_the_samples() {
        let microscale = microscale();
        let error = microscale.correction(&[3.0, 8.1]).unwrap_err();
        assert!(matches!(error, LawError::BeyondSamples { pressure: 8.1, largest: 8.0 }));
        assert!(microscale.friction(0.9).is_none() && microscale.friction(8.1).is_none());
        let (half_space, finite) = microscale.friction(8.0).unwrap();
        assert_relative_eq!(finite - half_space, 0.1 + 0.1 * 8.0_f64.ln(), max_relative = 1e-12);
    }

    #[test]
    fn running_means_keep_the_load() {
        let pressures = [0.0, 3.0, 0.0, 0.0, 6.0];
        let mean = running_mean(&pressures, 3);
        assert_eq!(mean, [3.0, 1.0, 1.0, 2.0, 2.0]);
        assert_eq!(running_mean(&pressures, 1), pressures);
        assert_relative_eq!(running_mean(&pressures, 4).iter().sum::<f64>(), 9.0);
    }

    #[test]
    fn no_contact_point_no_correction() {
        for local in [[0.0; 3], [0.0, 0.9, 0.0]] {
            assert_eq!(microscale().correction(&local).unwrap(), None);
        }
    }
}
