//! The strain measure that a law is written in.

use super::logarithm::Logarithm;
use super::symmetric::Symmetric;

/// The strain measure `m(C)` of a law at one deformation, with its derivatives by `C`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measure {
    /// `m = C - 1`.
    Green(Symmetric),
    /// `m = ln C`.
    Logarithmic(Logarithm),
}

impl Measure {
    /// `m`.
    #[inline]
    pub fn value(&self) -> Symmetric {
        match self {
            Self::Green(strain) => *strain,
            Self::Logarithmic(logarithm) => logarithm.value(),
        }
    }

    /// The change `dm/dC : δC` of the measure. The derivative is symmetric, so the same takes the
    /// conjugate stress `T` to the second Piola-Kirchhoff stress `S = T : dm/dC`.
    #[inline]
    pub fn derivative(&self, x: &Symmetric) -> Symmetric {
        match self {
            Self::Green(_) => *x,
            Self::Logarithmic(logarithm) => logarithm.derivative(x),
        }
    }

    /// The change `δS = δT : dm/dC + T : d²m/dC² : δC` of the second Piola-Kirchhoff stress with
    /// that of the conjugate stress.
    #[inline]
    pub fn stress_change(
        &self,
        conjugate: &Symmetric,
        conjugate_change: &Symmetric,
        strain_change: &Symmetric,
    ) -> Symmetric {
        match self {
            Self::Green(_) => *conjugate_change,
            Self::Logarithmic(logarithm) => {
                let elastic = logarithm.derivative(conjugate_change);
                let geometric = logarithm.second_derivative(conjugate, strain_change);
                [0, 1, 2].map(|i| elastic[i] + geometric[i])
            }
        }
    }
}

impl Default for Measure {
    /// Without deformation, of the default law.
    fn default() -> Self {
        Self::Green([0.0; 3])
    }
}
