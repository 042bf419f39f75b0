//! Generalised Maxwell model of a linear viscoelastic solid.

use super::finite_strain::BadConstant;
use super::{FrequencyRange, Rheology, Viscoelastic};
use crate::error_kind::{ErrorKind, HasKind};
use rustfft::num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// A spring `E_k` in series with a dashpot `E_k τ_k`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MaxwellBranch {
    /// Modulus E_k in Pa.
    pub modulus: f64,
    /// Relaxation time τ_k in s.
    pub relaxation_time: f64,
}

/// Generalised Maxwell model with a constant Poisson ratio (thesis 2.2.5-6):
/// `E(ω) = E_inf + Σ_k E_k i ω τ_k / (1 + i ω τ_k)`.
///
/// Without branches it is an elastic solid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rubber {
    /// Name under which tables quote it.
    pub name: String,
    /// Relaxed modulus E_inf in Pa.
    pub equilibrium_modulus: f64,
    /// Maxwell branches in parallel with the equilibrium spring.
    pub branches: Vec<MaxwellBranch>,
    /// Poisson ratio, the same at all frequencies.
    pub poisson_ratio: f64,
    /// Law of its springs at finite strain; neo-Hooke unless it is known better. The half-space, of small strains, does
    /// not ask for it.
    #[serde(default, skip_serializing_if = "Rheology::is_default")]
    pub finite_strain: Rheology,
}

/// Errors of the numbers of a rubber.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RubberError {
    /// A modulus or time that is not positive and finite.
    #[error("rubber {rubber}: {quantity} is {value}, it must be positive and finite")]
    NotPositive {
        /// Name of the rubber.
        rubber: String,
        /// Which number.
        quantity: String,
        /// Its value in SI.
        value: f64,
    },
    /// A Poisson ratio that plane strain does not allow.
    #[error("rubber {rubber}: poisson_ratio is {value}, it must lie between 0 and 0.5")]
    PoissonRatio {
        /// Name of the rubber.
        rubber: String,
        /// The value.
        value: f64,
    },
    /// A Poisson ratio too close to that of an incompressible solid for finite elements.
    #[error(
        "rubber {rubber}: poisson_ratio is {value}, the finite-deformation model takes at most {limit}"
    )]
    NotCompressible {
        /// Name of the rubber.
        rubber: String,
        /// The value.
        value: f64,
        /// The largest value it takes.
        limit: f64,
    },
    /// A constant of the law at finite strain that is none.
    #[error("rubber {rubber}: {key} is {value}, it must be {range}")]
    Law {
        /// Name of the rubber.
        rubber: String,
        /// Its key.
        key: &'static str,
        /// The value.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// Measured moduli at fewer than two frequencies.
    #[error("rubber {rubber} has moduli at {points} point(s), it needs at least two")]
    TooFewPoints {
        /// Name of the rubber.
        rubber: String,
        /// How many there are.
        points: usize,
    },
    /// Measured frequencies out of order.
    #[error(
        "rubber {rubber}: the frequency {frequency_hz:e} Hz comes after {before_hz:e} Hz, frequencies must ascend"
    )]
    NotAscending {
        /// Name of the rubber.
        rubber: String,
        /// The frequency in Hz.
        frequency_hz: f64,
        /// The one before it in Hz.
        before_hz: f64,
    },
    /// A table of moduli where relaxation times are needed.
    #[error(
        "rubber {rubber} is a table of moduli and has no relaxation times, which finite deformation needs: fit a Prony \
         series to the table (`asperity rubber fit TABLE --to RUBBER.toml`) and give that file"
    )]
    NoRelaxationTimes {
        /// Name of the rubber.
        rubber: String,
    },
    /// A modulus outside the measured frequencies.
    #[error(
        "the modulus of rubber {rubber} is not known at {frequency_hz:.3e} Hz: it was measured from {:.3e} to {:.3e} \
         Hz; measure it there (at another temperature), choose a speed and waves within that range, or hold the moduli \
         at the ends of the range (extrapolate = \"hold\" in the rubber file)",
        .measured.lowest_hz,
        .measured.highest_hz
    )]
    NotMeasured {
        /// Name of the rubber.
        rubber: String,
        /// The frequency asked for in Hz.
        frequency_hz: f64,
        /// The measured frequencies.
        measured: FrequencyRange,
    },
}

impl HasKind for RubberError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NotPositive { .. }
            | Self::PoissonRatio { .. }
            | Self::NotCompressible { .. }
            | Self::Law { .. }
            | Self::TooFewPoints { .. }
            | Self::NotAscending { .. }
            | Self::NoRelaxationTimes { .. }
            | Self::NotMeasured { .. } => ErrorKind::Input,
        }
    }
}

impl Rubber {
    /// An elastic solid: modulus in Pa.
    pub fn elastic(modulus: f64, poisson_ratio: f64) -> Self {
        Self {
            name: "elastic".into(),
            equilibrium_modulus: modulus,
            branches: Vec::new(),
            poisson_ratio,
            finite_strain: Rheology::default(),
        }
    }

    /// Checks that every modulus and time is positive, the Poisson ratio is in `[0, 0.5]` and the law at finite strain
    /// has its constants.
    ///
    /// # Errors
    /// Names the first number that is not.
    pub fn validate(&self) -> Result<(), RubberError> {
        let not_positive = |quantity: String, value: f64| RubberError::NotPositive {
            rubber: self.name.clone(),
            quantity,
            value,
        };
        let positive = |value: f64| value > 0.0 && value.is_finite();
        if !positive(self.equilibrium_modulus) {
            return Err(not_positive("the equilibrium modulus".into(), self.equilibrium_modulus));
        }
        for (k, branch) in self.branches.iter().enumerate() {
            if !positive(branch.modulus) {
                return Err(not_positive(
                    format!("the modulus of branch {}", k + 1),
                    branch.modulus,
                ));
            }
            if !positive(branch.relaxation_time) {
                return Err(not_positive(
                    format!("the relaxation time of branch {}", k + 1),
                    branch.relaxation_time,
                ));
            }
        }
        if !(0.0..=0.5).contains(&self.poisson_ratio) {
            return Err(RubberError::PoissonRatio {
                rubber: self.name.clone(),
                value: self.poisson_ratio,
            });
        }
        self.check_law(self.finite_strain)
    }

    /// Checks the constants of a law at finite strain.
    pub(super) fn check_law(&self, law: Rheology) -> Result<(), RubberError> {
        law.bad_constant().map_or(Ok(()), |BadConstant { key, value, range }| {
            Err(RubberError::Law { rubber: self.name.clone(), key, value, range })
        })
    }

    /// Complex modulus E(ω) in Pa at the angular frequency ω in rad/s; its real part is the
    /// storage modulus, its imaginary part the loss modulus.
    pub fn complex_modulus(&self, angular_frequency: f64) -> Complex64 {
        let mut modulus = Complex64::new(self.equilibrium_modulus, 0.0);
        for branch in &self.branches {
            let wt = angular_frequency * branch.relaxation_time;
            // i wt / (1 + i wt), written so that a huge wt does not overflow.
            let inverse = 1.0 / wt;
            let weight = if wt == 0.0 {
                Complex64::ZERO
            } else {
                Complex64::new(1.0, inverse) / (1.0 + inverse * inverse)
            };
            modulus += branch.modulus * weight;
        }
        modulus
    }

    /// Complex reduced modulus `E_r(ω) = E(ω) / (1 - ν²)` of plane strain, in Pa.
    pub fn reduced_modulus(&self, angular_frequency: f64) -> Complex64 {
        self.complex_modulus(angular_frequency) / (1.0 - self.poisson_ratio.powi(2))
    }

    /// The rubber with all relaxation times multiplied by a factor, as at another temperature.
    pub fn shifted(&self, factor: f64) -> Self {
        let shifted = |branch: &MaxwellBranch| MaxwellBranch {
            relaxation_time: branch.relaxation_time * factor,
            ..*branch
        };
        Self { branches: self.branches.iter().map(shifted).collect(), ..self.clone() }
    }

    /// The rubber with all moduli multiplied by a factor, as at another temperature.
    pub fn scaled(&self, factor: f64) -> Self {
        let scaled =
            |branch: &MaxwellBranch| MaxwellBranch { modulus: branch.modulus * factor, ..*branch };
        Self {
            equilibrium_modulus: self.equilibrium_modulus * factor,
            branches: self.branches.iter().map(scaled).collect(),
            ..self.clone()
        }
    }

    /// Glassy modulus `E_inf + Σ E_k` in Pa, the limit of infinite frequency.
    pub fn glassy_modulus(&self) -> f64 {
        self.equilibrium_modulus + self.branches.iter().map(|b| b.modulus).sum::<f64>()
    }
}

impl Viscoelastic for Rubber {
    fn name(&self) -> &str {
        &self.name
    }

    fn complex_modulus(&self, angular_frequency: f64) -> Complex64 {
        Self::complex_modulus(self, angular_frequency)
    }

    fn poisson_ratio(&self) -> f64 {
        self.poisson_ratio
    }

    fn validate(&self) -> Result<(), RubberError> {
        Self::validate(self)
    }
}
