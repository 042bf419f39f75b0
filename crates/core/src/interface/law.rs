//! Shear stress of the contact area over speed and temperature.

use super::ShearError;
use crate::numerics::interpolation::CubicHermite;
use crate::rubber::ZERO_CELSIUS;

/// Boltzmann constant over the elementary charge in eV/K, exact since the SI of 2019.
const BOLTZMANN_EV: f64 = 1.380_649e-23 / 1.602_176_634e-19;

/// Shear stress τ_f that the contact area carries.
#[derive(Debug, Clone, PartialEq)]
pub enum ShearLaw {
    /// A bell over the logarithm of the speed.
    Gaussian(GaussianShear),
    /// Measured values over the speed.
    Table(ShearTable),
}

/// A bell over the logarithm of the speed (Lorenz, Oh, Nam, Jeon & Persson, J. Chem. Phys. 142, 194701, 2015,
/// doi:10.1063/1.4919221), as bonds that form, stretch and break by heat have it (Schallamach 1963):
///
/// ```text
/// τ_f = τ_0 exp(-c [log10(v a'/v_0)]²),   a' = exp(ε/k_B (1/T - 1/T_0))
/// ```
///
/// Its full width at half maximum is `2 √(ln 2 / c)` decades. None of its constants is universal: published values of v_0
/// for tread compounds differ by three decades, hence there are no defaults.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaussianShear {
    /// Largest shear stress τ_0 in Pa.
    pub peak_stress: f64,
    /// Speed v_0 in m/s at which it has it, at the reference temperature.
    pub peak_speed: f64,
    /// c, dimensionless.
    pub width: f64,
    /// How it shifts with temperature; not at all if `None`.
    pub shift: Option<Activation>,
}

/// A shift of the speed with temperature by an activation energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Activation {
    /// ε in eV.
    pub energy_ev: f64,
    /// T_0 in °C.
    pub reference_c: f64,
}

impl Activation {
    /// `ln a' = ε/k_B (1/T - 1/T_0)` at a temperature in °C: the speed times a' has at T_0 the stress of the speed at T.
    pub fn ln_factor(&self, temperature_c: f64) -> f64 {
        let inverse = |c: f64| 1.0 / (c + ZERO_CELSIUS);
        self.energy_ev / BOLTZMANN_EV * (inverse(temperature_c) - inverse(self.reference_c))
    }
}

/// Measured shear stresses over the speed, interpolated by a monotone cubic in the logarithms of both.
#[derive(Debug, Clone, PartialEq)]
pub struct ShearTable {
    speeds: [f64; 2],
    ln_stress: CubicHermite,
    shift: Option<Activation>,
}

impl ShearTable {
    /// A table of speeds in m/s, ascending, and stresses in Pa.
    ///
    /// # Errors
    /// [`ShearError::TooFewSpeeds`], [`ShearError::NotAscending`], [`ShearError::OutOfRange`] for a number that is not
    /// positive and finite.
    pub fn new(points: &[[f64; 2]], shift: Option<Activation>) -> Result<Self, ShearError> {
        let [[lowest, _], .., [highest, _]] = points else {
            return Err(ShearError::TooFewSpeeds { points: points.len() });
        };
        for [speed, stress] in points {
            positive("the speed in m/s", *speed)?;
            positive("the shear stress in Pa", *stress)?;
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
            return Err(ShearError::NotAscending { speed: pair[1][0], before: pair[0][0] });
        }
        check_shift(shift)?;
        let logarithms = |k: usize| points.iter().map(|point| point[k].ln()).collect();
        let ln_stress = CubicHermite::monotone_parabolas(logarithms(0), logarithms(1));
        Ok(Self { speeds: [*lowest, *highest], ln_stress, shift })
    }
}

impl ShearLaw {
    /// Shear stress in Pa at a speed in m/s and a temperature in °C. Without a shift the temperature has no effect.
    ///
    /// # Errors
    /// [`ShearError::OutOfRange`] for a speed that is not positive or a temperature below absolute zero,
    /// [`ShearError::OutsideTable`].
    pub fn stress(&self, speed: f64, temperature_c: f64) -> Result<f64, ShearError> {
        positive("the speed in m/s", speed)?;
        check_temperature("the temperature in °C", temperature_c)?;
        let ln_factor = self.shift().map_or(0.0, |shift| shift.ln_factor(temperature_c));
        let ln_speed = speed.ln() + ln_factor;
        match self {
            Self::Gaussian(law) => {
                let decades = (ln_speed - law.peak_speed.ln()) / std::f64::consts::LN_10;
                Ok(law.peak_stress * (-law.width * decades * decades).exp())
            }
            Self::Table(table) => {
                let [lowest, highest] = table.speeds.map(f64::ln);
                // The ends themselves are part of the table, whatever the round-off of the logarithm.
                let slack = 1e-12 * (highest - lowest);
                if !(lowest - slack..=highest + slack).contains(&ln_speed) {
                    let (range, shifted) = (table.speeds, ln_factor != 0.0);
                    let speed = ln_speed.exp();
                    return Err(ShearError::OutsideTable { speed, range, shifted });
                }
                Ok(table.ln_stress.at(ln_speed.clamp(lowest, highest)).exp())
            }
        }
    }

    /// How the speed shifts with temperature.
    pub fn shift(&self) -> Option<Activation> {
        match self {
            Self::Gaussian(law) => law.shift,
            Self::Table(table) => table.shift,
        }
    }

    /// Checks the constants.
    ///
    /// # Errors
    /// [`ShearError::OutOfRange`] for the first that is not that of a law.
    pub fn validate(&self) -> Result<(), ShearError> {
        match self {
            Self::Table(_) => Ok(()),
            Self::Gaussian(law) => {
                positive("the largest shear stress in Pa", law.peak_stress)?;
                positive("the speed of the largest shear stress in m/s", law.peak_speed)?;
                positive("the width of the shear law", law.width)?;
                check_shift(law.shift)
            }
        }
    }
}

fn check_shift(shift: Option<Activation>) -> Result<(), ShearError> {
    let Some(Activation { energy_ev, reference_c }) = shift else { return Ok(()) };
    let range = "between 0 and 10";
    if !(0.0..=10.0).contains(&energy_ev) {
        let quantity = "the activation energy in eV";
        return Err(ShearError::OutOfRange { quantity, value: energy_ev, range });
    }
    check_temperature("the reference temperature in °C", reference_c)
}

pub(super) fn check_temperature(quantity: &'static str, value: f64) -> Result<(), ShearError> {
    if value > -ZERO_CELSIUS && value.is_finite() {
        return Ok(());
    }
    Err(ShearError::OutOfRange {
        quantity,
        value,
        range: "finite and above absolute zero, -273.15",
    })
}

pub(super) fn positive(quantity: &'static str, value: f64) -> Result<(), ShearError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(ShearError::OutOfRange { quantity, value, range: "positive and finite" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn shifted() -> Activation {
        Activation { energy_ev: 0.97, reference_c: 20.0 }
    }

    fn law() -> GaussianShear {
        GaussianShear { peak_stress: 6.5e6, peak_speed: 6e-3, width: 0.1, shift: Some(shifted()) }
    }

    /// Factors of `../shared/design/extensions.md`, section 2, which were computed by other code.
    #[test]
    fn the_factor_of_temperature_is_that_of_the_activation_energy() {
        let cases = [
            (-20.0, 431.49),
            (0.0, 16.635),
            (40.0, 0.086089),
            (60.0, 0.0099488),
            (80.0, 0.0014681),
        ];
        for (temperature_c, expected) in cases {
            let factor = shifted().ln_factor(temperature_c).exp();
            approx::assert_relative_eq!(factor, expected, max_relative = 5e-5);
        }
    }

    #[test]
    fn the_bell_has_its_peak_and_its_width() {
        let law = ShearLaw::Gaussian(law());
        assert_eq!(law.stress(6e-3, 20.0).unwrap(), 6.5e6);
        let half_width = (2.0_f64.ln() / 0.1).sqrt();
        for side in [-1.0, 1.0] {
            let speed = 6e-3 * 10.0_f64.powf(side * half_width);
            let stress = law.stress(speed, 20.0).unwrap();
            approx::assert_relative_eq!(stress, 3.25e6, max_relative = 1e-13);
        }
        // 2 sqrt(ln 2 / 0.1) decades.
        approx::assert_relative_eq!(2.0 * half_width, 5.2655, max_relative = 1e-5);
    }

    #[test]
    fn a_table_holds_its_values_and_nothing_beyond() {
        let points = [[1e-5, 1e6], [1e-3, 4e6], [1e-1, 2e6]];
        let table = ShearLaw::Table(ShearTable::new(&points, None).unwrap());
        for [speed, stress] in points {
            approx::assert_relative_eq!(
                table.stress(speed, -5.0).unwrap(),
                stress,
                max_relative = 1e-12
            );
        }
        let between = table.stress(1e-4, 20.0).unwrap();
        assert!((1e6..4e6).contains(&between), "{between}");
        assert!(matches!(table.stress(0.2, 20.0), Err(ShearError::OutsideTable { .. })));
        let shifted = ShearLaw::Table(ShearTable::new(&points, Some(shifted())).unwrap());
        // 0.1 m/s at 0 °C is 1.66 m/s at 20 °C.
        let error = shifted.stress(0.1, 0.0).unwrap_err().to_string();
        assert!(error.contains("times the shift factor"), "{error}");
    }

    #[test]
    fn numbers_that_no_law_has_are_refused() {
        let refused =
            |law: GaussianShear| ShearLaw::Gaussian(law).validate().unwrap_err().to_string();
        let message = refused(GaussianShear { width: -0.1, ..law() });
        assert_eq!(message, "the width of the shear law is -0.1, it must be positive and finite");
        assert!(refused(GaussianShear { peak_stress: f64::NAN, ..law() }).contains("NaN"));
        let shift = Some(Activation { energy_ev: 90.0, ..shifted() });
        assert!(
            refused(GaussianShear { shift, ..law() }).contains("activation energy in eV is 90")
        );
        let law = ShearLaw::Gaussian(law());
        assert!(law.stress(0.0, 20.0).is_err() && law.stress(1.0, -300.0).is_err());
        assert!(ShearTable::new(&[[1.0, 1e6]], None).is_err());
        assert!(ShearTable::new(&[[1.0, 1e6], [1.0, 2e6]], None).is_err());
    }

    proptest! {
        /// Temperature acts on the speed alone.
        #[test]
        fn temperature_is_a_factor_of_the_speed(decades in -8.0..4.0, celsius in -40.0..120.0) {
            let law = ShearLaw::Gaussian(law());
            let speed = 10.0_f64.powf(decades);
            let moved = speed * shifted().ln_factor(celsius).exp();
            let (a, b) = (law.stress(speed, celsius).unwrap(), law.stress(moved, 20.0).unwrap());
            // The exponent reaches 100, which multiplies round-off.
            prop_assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        }
    }
}
