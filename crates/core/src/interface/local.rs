//! Shear traction of the interface over the normal pressure.

use super::ShearError;
use super::law::positive;
use crate::numerics::interpolation::CubicHermite;

/// Shear traction τ(p) of an interface that slides everywhere, at one speed and one temperature.
///
/// It acts along the deformed surface against the motion. Without stick the direction is known beforehand, so that a
/// steady contact needs no history of the slip.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum LocalFriction {
    /// No shear traction.
    #[default]
    None,
    /// `τ = μ p` with one coefficient.
    Coulomb {
        /// μ, dimensionless.
        coefficient: f64,
    },
    /// A shear stress that hardly depends on the pressure, `τ = τ_f (1 - exp(-μ_max p / τ_f))`: in all of the contact but
    /// its edges τ_f, as [`ShearLaw`](super::ShearLaw) has it. A step from nothing to τ_f at the edge of the contact has
    /// no solution on most grids: a node in contact would be lifted by its own shear.
    Stress {
        /// τ_f in Pa.
        stress: f64,
        /// μ_max, dimensionless: the coefficient at vanishing pressure.
        largest_coefficient: f64,
    },
    /// `τ = μ(p) p` with a coefficient that was computed or measured at some pressures.
    Table(FrictionOverPressure),
}

/// Shear traction at one pressure.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Traction {
    /// τ in Pa.
    pub stress: f64,
    /// dτ/dp, dimensionless.
    pub slope: f64,
}

impl LocalFriction {
    /// The traction at a pressure in Pa, zero at pressures of zero and below.
    pub fn at(&self, pressure: f64) -> Traction {
        if pressure <= 0.0 {
            return Traction::default();
        }
        match self {
            Self::None => Traction::default(),
            Self::Coulomb { coefficient } => {
                Traction { stress: coefficient * pressure, slope: *coefficient }
            }
            Self::Stress { stress, largest_coefficient } => {
                let exponent = -largest_coefficient * pressure / stress;
                let slope = largest_coefficient * exponent.exp();
                Traction { stress: -stress * exponent.exp_m1(), slope }
            }
            Self::Table(table) => table.at(pressure),
        }
    }

    /// Checks the constants.
    ///
    /// # Errors
    /// [`ShearError::OutOfRange`] for the first that is not that of a law.
    pub fn validate(&self) -> Result<(), ShearError> {
        match self {
            Self::None | Self::Table(_) => Ok(()),
            Self::Coulomb { coefficient } => coefficient_in_range(*coefficient),
            Self::Stress { stress, largest_coefficient } => {
                positive("the shear stress of the interface in Pa", *stress)?;
                positive("the largest local friction coefficient", *largest_coefficient)
            }
        }
    }
}

/// A friction coefficient over the pressure, interpolated by a monotone cubic in ln p.
///
/// Below the first pressure the coefficient is that of the first. Above the last one the traction is that of the last
/// times `(p / p_last)^(1 + s)` with the slope s of ln μ over ln p there, between -1, as in full contact, and 0: no
/// growth is extrapolated. Who uses a table asks [`Self::range`] what share of the load lies outside.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionOverPressure {
    range: [f64; 2],
    coefficient: CubicHermite,
    last: f64,
    /// s of the extrapolation.
    decline: f64,
}

impl FrictionOverPressure {
    /// A table of pressures in Pa, ascending, and friction coefficients.
    ///
    /// # Errors
    /// [`ShearError::TooFewPressures`], [`ShearError::PressuresNotAscending`], [`ShearError::OutOfRange`] for a pressure
    /// that is not positive or a coefficient that is negative or not finite.
    pub fn new(points: &[[f64; 2]]) -> Result<Self, ShearError> {
        let [[lowest, _], .., [highest, last]] = *points else {
            return Err(ShearError::TooFewPressures { points: points.len() });
        };
        for [pressure, coefficient] in points {
            positive("the pressure in Pa", *pressure)?;
            coefficient_in_range(*coefficient)?;
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
            let [pressure, before] = [pair[1][0], pair[0][0]];
            return Err(ShearError::PressuresNotAscending { pressure, before });
        }
        let abscissae = points.iter().map(|point| point[0].ln()).collect();
        let ordinates = points.iter().map(|point| point[1]).collect();
        let coefficient = CubicHermite::monotone_parabolas(abscissae, ordinates);
        let [before, end] = [points[points.len() - 2], points[points.len() - 1]];
        let decline = (end[1] / before[1]).ln() / (end[0] / before[0]).ln();
        let decline = if decline.is_finite() { decline.clamp(-1.0, 0.0) } else { 0.0 };
        Ok(Self { range: [lowest, highest], coefficient, last, decline })
    }

    /// Lowest and highest pressure in Pa of the table.
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// The friction coefficient at a pressure in Pa.
    pub fn coefficient(&self, pressure: f64) -> f64 {
        if pressure > self.range[1] {
            self.last * (pressure / self.range[1]).powf(self.decline)
        } else {
            self.coefficient.at(pressure.max(self.range[0]).ln())
        }
    }

    fn at(&self, pressure: f64) -> Traction {
        let coefficient = self.coefficient(pressure);
        let by_logarithm = if pressure > self.range[1] {
            self.decline * coefficient
        } else {
            self.coefficient.derivative(pressure.ln())
        };
        Traction { stress: coefficient * pressure, slope: coefficient + by_logarithm }
    }
}

fn coefficient_in_range(coefficient: f64) -> Result<(), ShearError> {
    if (0.0..=100.0).contains(&coefficient) {
        return Ok(());
    }
    let quantity = "the local friction coefficient";
    Err(ShearError::OutOfRange { quantity, value: coefficient, range: "between 0 and 100" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn table() -> FrictionOverPressure {
        FrictionOverPressure::new(&[[1e5, 0.8], [3e5, 0.7], [1e6, 0.5], [2e6, 0.3]]).unwrap()
    }

    #[test]
    fn slopes_are_derivatives_of_the_traction() {
        let laws = [
            LocalFriction::None,
            LocalFriction::Coulomb { coefficient: 0.4 },
            LocalFriction::Stress { stress: 2e6, largest_coefficient: 3.0 },
            LocalFriction::Table(table()),
        ];
        for law in laws {
            for pressure in [2e4, 1.7e5, 6e5, 1.5e6, 5e6] {
                let step = 1e-6 * pressure;
                let [after, before] = [pressure + step, pressure - step].map(|p| law.at(p).stress);
                let difference = (after - before) / (2.0 * step);
                assert_relative_eq!(law.at(pressure).slope, difference, epsilon = 1e-7);
            }
            assert_eq!(law.at(0.0), Traction::default());
            assert_eq!(law.at(-1.0), Traction::default());
        }
    }

    #[test]
    fn a_stress_is_reached_inside_the_contact_and_a_coefficient_at_its_edge() {
        let law = LocalFriction::Stress { stress: 2e6, largest_coefficient: 3.0 };
        assert_relative_eq!(law.at(2e7).stress, 2e6, max_relative = 1e-12);
        assert_relative_eq!(law.at(1.0).stress, 3.0, max_relative = 1e-5);
    }

    #[test]
    fn a_table_holds_its_values_and_does_not_grow_beyond() {
        let table = table();
        assert_relative_eq!(table.coefficient(3e5), 0.7, max_relative = 1e-14);
        assert_eq!(table.coefficient(1.0), 0.8);
        // ln(0.3 / 0.5) / ln 2 = -0.737.
        assert_relative_eq!(
            table.coefficient(4e6),
            0.3 * 2_f64.powf(-0.736_965_594_166_206),
            max_relative = 1e-12
        );
        let rising = FrictionOverPressure::new(&[[1e5, 0.2], [1e6, 0.5]]).unwrap();
        assert_eq!(rising.coefficient(1e7), 0.5);
    }

    #[test]
    fn numbers_that_no_law_has_are_refused() {
        let refused = |points: &[[f64; 2]]| FrictionOverPressure::new(points).unwrap_err();
        assert!(refused(&[[1e5, 0.2]]).to_string().contains("1 pressure(s)"));
        let message = refused(&[[1e5, 0.2], [1e5, 0.3]]).to_string();
        assert!(message.contains("100000 Pa comes after 100000 Pa"), "{message}");
        assert!(refused(&[[1e5, 0.2], [2e5, f64::NAN]]).to_string().contains("NaN"));
        assert!(LocalFriction::Coulomb { coefficient: -0.1 }.validate().is_err());
        assert!(
            LocalFriction::Stress { stress: 0.0, largest_coefficient: 1.0 }.validate().is_err()
        );
    }
}
