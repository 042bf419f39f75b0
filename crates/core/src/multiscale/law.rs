//! The local law: mean separation of the microscale over its mean pressure.

use super::error::LawError;
use crate::numerics::interpolation::CubicHermite;

/// How a local law ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LawEnd {
    /// In partial contact: pressures beyond the last sample are refused.
    PartialContact,
    /// In full contact: the separation stays that of the last sample, a hard wall.
    FullContact,
}

/// Relation between the local mean pressure p and the local mean separation g(p) of the short
/// waves of a profile under the rubber (thesis 5.1).
///
/// What is interpolated is the indentation `d = g(0) - g(p)`, its logarithm over that of the
/// pressure, by monotone cubics. The law of a sine wave on an elastic body is
/// `d = D s (1 - ln s)` with `s = p / p*` (Westergaard), a line contact has `d ~ p (a - b ln p)`:
/// in logarithms both are nearly straight lines of slope one, with a slow change over decades,
/// and a linear law is exactly one. Measured on the wave 0.0625 mm / 0.01867 mm (rubber Table
/// 2.1, 10 and 50 mm/s, full contact at 9.07 and 20.0 MPa), 32 samples at
/// `p = p* (0.1 + 0.9 k/31)^4` meet the separation within 3e-5 of the amplitude, 16 within 4e-4;
/// samples at logarithmic steps waste most of them near first touch and reach 5e-4 with 32.
///
/// Below the first sample the law goes on as the line contact (2 % of the first indentation off
/// at most; straight in the root of the pressure it would be 8 %)
/// with the value and the slope found there, `d = d_1 s (1 - (1 - m) ln s)` with `s = p / p_1`;
/// a slope `m` above one, as of a lossy rubber that is stiffer on smaller spots, as the power
/// `d_1 s^m`.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalLaw {
    touch_separation: f64,
    logarithm: CubicHermite,
    /// In the order of their pressures, at least one.
    samples: Vec<Sample>,
    /// Logarithmic slope at the first sample.
    first_slope: f64,
    end: LawEnd,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Sample {
    pressure: f64,
    indentation: f64,
}

/// A point of the law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LawPoint {
    /// Pressure in Pa, not negative.
    pub pressure: f64,
    /// Indentation `g(0) - g` in m; negative in a gap, where the pressure is zero.
    pub indentation: f64,
    /// `-dg/dp` in m/Pa, not negative; infinite in a gap.
    pub compliance: f64,
}

impl LocalLaw {
    /// Law through samples: pressures in Pa that ascend from above zero, separations in m that
    /// descend from `touch_separation`, the largest height of the micro profile above its mean.
    ///
    /// # Errors
    /// [`LawError`] names the first sample that breaks these rules.
    pub fn new(
        touch_separation: f64,
        pressures: &[f64],
        separations: &[f64],
        end: LawEnd,
    ) -> Result<Self, LawError> {
        check(touch_separation, pressures, separations)?;
        let indentations: Vec<f64> = separations.iter().map(|g| touch_separation - g).collect();
        let logarithms = |values: &[f64]| values.iter().map(|x| x.ln()).collect::<Vec<f64>>();
        let mut logarithm =
            CubicHermite::monotone_parabolas(logarithms(pressures), logarithms(&indentations));
        // A single sample has no slope: the law is a straight line to it. A slope of one to round-off counts as one, or
        // the slope at zero pressure would be infinite.
        let first_slope = match logarithm.derivative(pressures[0].ln()) {
            m if pressures.len() == 1 || (m - 1.0).abs() < 1e-9 => 1.0,
            m => m,
        };
        if end == LawEnd::FullContact {
            logarithm = logarithm.flat_at_the_end();
        }
        let samples = pressures
            .iter()
            .zip(&indentations)
            .map(|(p, d)| Sample { pressure: *p, indentation: *d })
            .collect();
        Ok(Self { touch_separation, logarithm, samples, first_slope, end })
    }

    /// Separation g(0) at first touch in m.
    pub fn touch_separation(&self) -> f64 {
        self.touch_separation
    }

    /// The largest sampled pressure in Pa.
    pub fn largest_pressure(&self) -> f64 {
        self.last().pressure
    }

    /// Separation g in m at a pressure in Pa.
    ///
    /// # Errors
    /// [`LawError::BeyondSamples`] above the largest sampled pressure unless the law ends in full
    /// contact; [`LawError::NotAPressure`] below zero.
    pub fn separation(&self, pressure: f64) -> Result<f64, LawError> {
        self.admit(pressure)?;
        Ok(self.touch_separation - self.indentation(pressure))
    }

    /// Slope dg/dp in m/Pa, not positive; at zero pressure minus infinity where the law begins
    /// like a line contact.
    ///
    /// # Errors
    /// As [`Self::separation`].
    pub fn slope(&self, pressure: f64) -> Result<f64, LawError> {
        self.admit(pressure)?;
        Ok(-self.compliance(pressure))
    }

    /// The separation in m at a pressure in Pa as iterations need it: beyond the samples that of the last.
    pub(crate) fn height(&self, pressure: f64) -> f64 {
        self.touch_separation - self.indentation(pressure)
    }

    /// The same law, but in proportion to the pressure below the first sample: its slope there is finite, as solvers need it
    /// that take the separation for a given pressure.
    pub(crate) fn in_proportion_below_the_samples(mut self) -> Self {
        self.first_slope = 1.0;
        self
    }

    /// Whether the law holds at a pressure.
    ///
    /// # Errors
    /// As [`Self::separation`].
    pub fn admit(&self, pressure: f64) -> Result<(), LawError> {
        if pressure.is_nan() || pressure < 0.0 {
            return Err(LawError::NotAPressure { pressure });
        }
        let largest = self.last().pressure;
        if pressure > largest && self.end == LawEnd::PartialContact {
            return Err(LawError::BeyondSamples { pressure, largest });
        }
        Ok(())
    }

    fn first(&self) -> Sample {
        self.samples[0]
    }

    fn last(&self) -> Sample {
        self.samples[self.samples.len() - 1]
    }

    /// Indentation from the first sample to the last, computed from the sample before it: the round-off of the
    /// logarithms themselves, 1e-14 of the indentation, would exceed the tolerance of a solution where the law is 1e4
    /// times deeper than the profile.
    fn between_samples(&self, pressure: f64) -> f64 {
        let piece = self.samples.partition_point(|s| s.pressure <= pressure) - 1;
        let from = self.samples[piece];
        from.indentation * self.logarithm.rise(piece, (pressure / from.pressure).ln()).exp()
    }

    /// `g(0) - g(p)` in m; beyond the samples of a law in partial contact the last value, for intermediate iterations only.
    pub(super) fn indentation(&self, pressure: f64) -> f64 {
        if pressure >= self.last().pressure {
            self.last().indentation
        } else if pressure >= self.first().pressure {
            self.between_samples(pressure)
        } else {
            let s = pressure / self.first().pressure;
            let m = self.first_slope;
            let share = match s {
                0.0 => 0.0,
                _ if m > 1.0 => s.powf(m),
                _ => s * (1.0 - (1.0 - m) * s.ln()),
            };
            self.first().indentation * share
        }
    }

    /// `-dg/dp` in m/Pa.
    pub(crate) fn compliance(&self, pressure: f64) -> f64 {
        if pressure > self.last().pressure {
            return 0.0;
        }
        if pressure >= self.first().pressure && self.first().pressure < self.last().pressure {
            return self.logarithm.derivative(pressure.ln()) * self.between_samples(pressure)
                / pressure;
        }
        let s = pressure / self.first().pressure;
        let m = self.first_slope;
        let share = match m {
            1.0 => 1.0,
            _ if m > 1.0 => m * s.powf(m - 1.0),
            _ => m - (1.0 - m) * s.ln(),
        };
        self.first().indentation / self.first().pressure * share
    }

    /// The point of the law on the line `c p + d = s`, in m: every `s` has exactly one, since
    /// `d` grows with `p`. Below zero it is a gap, `p = 0` and `d = s`.
    ///
    /// `guess` is a pressure to start from.
    pub(super) fn on_line(&self, c: f64, s: f64, guess: f64) -> LawPoint {
        if s <= 0.0 {
            return LawPoint { pressure: 0.0, indentation: s, compliance: f64::INFINITY };
        }
        let at_end = c * self.last().pressure + self.last().indentation;
        if s >= at_end {
            let pressure = self.last().pressure + (s - at_end) / c;
            return LawPoint { pressure, indentation: self.last().indentation, compliance: 0.0 };
        }
        let pressure = self.pressure_on_line(c, s, guess);
        // The larger part is computed from the line, so that neither is a difference of nearly equal numbers.
        let indentation = self.indentation(pressure);
        LawPoint { pressure, indentation, compliance: self.compliance(pressure) }
    }

    /// Newton's method in the logarithm of the pressure, kept within a shrinking bracket.
    fn pressure_on_line(&self, c: f64, s: f64, guess: f64) -> f64 {
        let (mut lower, mut upper) = (0.0_f64, (s / c).min(self.last().pressure));
        let mut pressure = if guess > 0.0 && guess < upper { guess } else { 0.5 * upper };
        for _ in 0..MOST_LINE_STEPS {
            let value = c * pressure + self.indentation(pressure);
            if value > s {
                upper = pressure;
            } else {
                lower = pressure;
            }
            let slope = (c + self.compliance(pressure)) * pressure / value;
            let mut next = pressure * ((s / value).ln() / slope).exp();
            if !(next > lower && next < upper) {
                next = if lower > 0.0 { (lower * upper).sqrt() } else { 0.01 * upper };
            }
            let settled = (next - pressure).abs() <= 2.0 * f64::EPSILON * pressure;
            pressure = next;
            if settled || pressure < f64::MIN_POSITIVE {
                break;
            }
        }
        pressure
    }
}

/// Steps after which a bracket is as small as round-off allows.
const MOST_LINE_STEPS: usize = 80;

fn check(touch: f64, pressures: &[f64], separations: &[f64]) -> Result<(), LawError> {
    if pressures.len() != separations.len() || pressures.is_empty() {
        let (pressures, separations) = (pressures.len(), separations.len());
        return Err(LawError::Length { pressures, separations });
    }
    if !touch.is_finite() {
        return Err(LawError::Touch { value: touch });
    }
    let mut before = (0.0, touch);
    for (index, (p, g)) in pressures.iter().zip(separations).enumerate() {
        if !(*p > before.0 && p.is_finite()) {
            return Err(LawError::Pressure { index, value: *p, before: before.0 });
        }
        if !(*g < before.1 && g.is_finite()) {
            return Err(LawError::Separation { index, value: *g, before: before.1 });
        }
        before = (*p, *g);
    }
    Ok(())
}
