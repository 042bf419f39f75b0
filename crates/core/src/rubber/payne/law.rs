//! The factors over strain at one temperature, and over temperature.

use super::{Kraus, PayneError, PayneTable};
use serde::Serialize;

/// The factors over strain of one sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub enum PayneCurve {
    /// Kraus' law.
    Kraus(Kraus),
    /// The measured factors.
    Table(PayneTable),
}

impl PayneCurve {
    fn factors(&self, strain: f64) -> [f64; 2] {
        match self {
            Self::Kraus(law) => law.factors(strain),
            Self::Table(table) => table.factors(strain),
        }
    }

    /// Largest measured strain.
    pub fn highest_strain(&self) -> f64 {
        match self {
            Self::Kraus(law) => law.highest_strain,
            Self::Table(table) => table.highest_strain(),
        }
    }
}

/// How a rubber softens with strain, at each temperature at which it was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Payne {
    curves: Vec<(Option<f64>, PayneCurve)>,
}

/// How a rubber softens with strain at one temperature: what a contact asks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PayneLaw {
    near: PayneCurve,
    /// The sweep on the other side, and its weight.
    far: Option<(PayneCurve, f64)>,
    highest_strain: f64,
}

impl Payne {
    /// The curves of sweeps, with their temperatures in °C.
    ///
    /// # Errors
    /// [`PayneError::Empty`]; [`PayneError::Temperatures`] for several curves without a temperature each of its own;
    /// [`PayneError::Number`] for a curve or a temperature that is out of range.
    pub fn new(mut curves: Vec<(Option<f64>, PayneCurve)>) -> Result<Self, PayneError> {
        if curves.is_empty() {
            return Err(PayneError::Empty);
        }
        for (temperature_c, curve) in &curves {
            if let Some(value) = temperature_c.filter(|celsius| !celsius.is_finite()) {
                let (quantity, wanted) = ("temperature in °C", "a finite number");
                return Err(PayneError::Number { temperature_c: None, quantity, value, wanted });
            }
            if let PayneCurve::Kraus(law) = curve {
                law.validate(*temperature_c)?;
            }
        }
        if curves.len() > 1 {
            let celsius = |curve: &(Option<f64>, PayneCurve)| curve.0.unwrap_or(f64::NAN);
            curves.sort_by(|a, b| celsius(a).total_cmp(&celsius(b)));
            if !curves.windows(2).all(|pair| celsius(&pair[0]) < celsius(&pair[1])) {
                return Err(PayneError::Temperatures);
            }
        }
        Ok(Self { curves })
    }

    /// The curves by ascending temperature in °C.
    pub fn curves(&self) -> &[(Option<f64>, PayneCurve)] {
        &self.curves
    }

    /// Lowest and highest temperature of the sweeps in °C; `None` for one sweep without a temperature.
    pub fn measured_c(&self) -> Option<[f64; 2]> {
        let ends =
            [self.curves.first(), self.curves.last()].map(|end| end.and_then(|curve| curve.0));
        Some([ends[0]?, ends[1]?])
    }

    /// The law at a temperature in °C: between two sweeps both factors are interpolated linearly in temperature, outside
    /// them, and without a temperature, the nearest (first) sweep holds.
    pub fn at(&self, temperature_c: Option<f64>) -> PayneLaw {
        let celsius = temperature_c.or(self.curves[0].0).unwrap_or(0.0);
        let above = self.curves.partition_point(|(at, _)| at.is_some_and(|at| at <= celsius));
        let near = self.curves[above.saturating_sub(1)].clone();
        let far = match (near.0, self.curves.get(above)) {
            (Some(from), Some((Some(to), curve))) if celsius > from => {
                Some((curve.clone(), (celsius - from) / (to - from)))
            }
            _ => None,
        };
        let others = far.iter().map(|(curve, _)| curve.highest_strain());
        let highest_strain = others.fold(near.1.highest_strain(), f64::max);
        PayneLaw { near: near.1, far, highest_strain }
    }

    /// A warning where a temperature in °C lies outside those of the sweeps.
    pub fn extrapolation(&self, temperature_c: f64) -> Option<String> {
        let [lowest, highest] = self.measured_c()?;
        let known = (lowest..=highest).contains(&temperature_c);
        (!known && lowest < highest).then(|| {
            format!(
                "strain sweeps were measured from {lowest} to {highest} °C: at {temperature_c} °C the softening with \
                 strain is that of the nearest one"
            )
        })
    }
}

impl PayneLaw {
    /// `f(ε) = E'(ε)/E'(0)` at an amplitude of elongation ε (dimensionless; its sign does not matter): 1 at 0, positive, at
    /// most 1, constant beyond the largest measured strain. NaN for NaN.
    pub fn storage_factor(&self, strain: f64) -> f64 {
        self.factors(strain)[0]
    }

    /// `g(ε) = E''(ε)/E''(0)` at an amplitude of elongation ε: 1 at 0, positive, and constant beyond the largest measured
    /// strain. It may exceed 1 at medium strains. NaN for NaN.
    pub fn loss_factor(&self, strain: f64) -> f64 {
        self.factors(strain)[1]
    }

    /// Both factors, `[f, g]`.
    pub fn factors(&self, strain: f64) -> [f64; 2] {
        if strain.is_nan() {
            return [f64::NAN; 2];
        }
        let near = self.near.factors(strain.abs());
        let Some((far, weight)) = &self.far else { return near };
        let far = far.factors(strain.abs());
        [0, 1].map(|part| (1.0 - weight) * near[part] + weight * far[part])
    }

    /// Largest measured strain, beyond which the factors are constant.
    pub fn highest_strain(&self) -> f64 {
        self.highest_strain
    }

    /// A warning where a strain lies beyond the measurement.
    pub fn extrapolation(&self, strain: f64) -> Option<String> {
        (strain.abs() > self.highest_strain).then(|| {
            format!(
                "strains reach {:.3} and strain sweeps were measured up to {:.3}: beyond it the softening is that at the \
                 largest measured strain",
                strain.abs(),
                self.highest_strain
            )
        })
    }
}
