//! The choice of a law, with its constants.

use super::hencky::Hencky;
use super::invariant::Stiffening;
use super::law::Law;
use super::measure::Measure;
use super::neo_hookean::NeoHookean;
use super::symmetric::Symmetric;
use serde::{Deserialize, Serialize};

/// The law of a spring.
///
/// The moduli are those of linear viscoelasticity under each law; the constants here say how the shear part stiffens with
/// the invariant of the elastic part of the deformation, `y = I1 - 3 - 2 ln J`, which is `I1 - 3` without change of
/// volume. Every spring has the same constants.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(tag = "law", rename_all = "kebab-case")]
pub enum Rheology {
    /// Compressible neo-Hooke on the elastic part of the deformation, `W = μ/2 y`.
    #[default]
    NeoHookean,
    /// Linear viscoelastic Kirchhoff stress in the logarithmic strain.
    Linear,
    /// `W = c1 y + c2 y² + c3 y³` with `2 c1 = μ` (Yeoh 1993, doi:10.5254/1.3538343).
    Yeoh {
        /// `c2 / c1`, negative as a rule.
        c2_over_c1: f64,
        /// `c3 / c1`.
        c3_over_c1: f64,
    },
    /// Chains of limited length, five terms of their series, with the modulus μ at small strain (Arruda & Boyce 1993,
    /// doi:10.1016/0022-5096(93)90013-6).
    ArrudaBoyce {
        /// Stretch at which the chains are straight, above 1: the law ends at `I1 = 3 λ²`.
        locking_stretch: f64,
    },
}

/// Why the constants of a law are none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BadConstant {
    /// Its key in the file of a rubber.
    pub key: &'static str,
    /// Its value.
    pub value: f64,
    /// What it must be.
    pub range: &'static str,
}

impl Rheology {
    /// Name of the law.
    pub fn name(self) -> &'static str {
        match self {
            Self::NeoHookean => "neo-Hooke",
            Self::Linear => "linear",
            Self::Yeoh { .. } => "Yeoh",
            Self::ArrudaBoyce { .. } => "Arruda-Boyce",
        }
    }

    /// Whether it is the law of a rubber that names none.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// The first constant that is none.
    pub fn bad_constant(self) -> Option<BadConstant> {
        match self {
            Self::NeoHookean | Self::Linear => None,
            Self::Yeoh { c2_over_c1, c3_over_c1 } => {
                let constants = [("c2_over_c1", c2_over_c1), ("c3_over_c1", c3_over_c1)];
                let bad = constants.into_iter().find(|(_, value)| !value.is_finite());
                bad.map(|(key, value)| BadConstant { key, value, range: "finite" })
            }
            Self::ArrudaBoyce { locking_stretch: value } => {
                let (key, range) = ("locking_stretch", "above 1 and finite");
                let good = value > 1.0 && value.is_finite();
                (!good).then_some(BadConstant { key, value, range })
            }
        }
    }

    /// How the shear part stiffens; not at all under neo-Hooke and the linear law.
    pub fn stiffening(self) -> Stiffening {
        match self {
            Self::NeoHookean | Self::Linear => Stiffening::NONE,
            Self::Yeoh { c2_over_c1, c3_over_c1 } => Stiffening::yeoh(c2_over_c1, c3_over_c1),
            Self::ArrudaBoyce { locking_stretch } => Stiffening::arruda_boyce(locking_stretch),
        }
    }

    /// Largest `y` of a spring up to which the law holds: the locking stretch, or where the shear stress of Yeoh's law
    /// has its maximum; infinite for the others.
    pub fn limit(self) -> f64 {
        self.stiffening().limit()
    }

    /// Whether the tangent of this law has the part that comes from its stiffening.
    pub(crate) fn stiffens(self) -> bool {
        match self {
            Self::NeoHookean | Self::Linear => false,
            Self::Yeoh { .. } | Self::ArrudaBoyce { .. } => true,
        }
    }

    /// Whether the measure of this law is the strain `C - 1` itself.
    pub(crate) fn is_in_green_strain(self) -> bool {
        match self {
            Self::NeoHookean | Self::Yeoh { .. } | Self::ArrudaBoyce { .. } => {
                NeoHookean::IN_GREEN_STRAIN
            }
            Self::Linear => Hencky::IN_GREEN_STRAIN,
        }
    }

    /// The measure of this law at the strain `C - 1`; `None` where the law has none, since `C` is not
    /// positive definite.
    #[inline]
    pub fn measure(self, strain: &Symmetric) -> Option<Measure> {
        match self {
            Self::NeoHookean | Self::Yeoh { .. } | Self::ArrudaBoyce { .. } => {
                NeoHookean::measure(strain)
            }
            Self::Linear => Hencky::measure(strain),
        }
    }

    /// `G(m)` and `V(m)` of the tangent, see [`Law::metric`].
    #[inline]
    pub(crate) fn metric(self, measure: &Symmetric) -> Option<(Symmetric, f64)> {
        match self {
            Self::NeoHookean | Self::Yeoh { .. } | Self::ArrudaBoyce { .. } => {
                NeoHookean::metric(measure)
            }
            Self::Linear => Hencky::metric(measure),
        }
    }

    /// `V(m)` of the tangent, see [`Law::metric`].
    #[inline]
    pub(crate) fn volume(self, measure: &Symmetric) -> f64 {
        match self {
            Self::NeoHookean | Self::Yeoh { .. } | Self::ArrudaBoyce { .. } => {
                NeoHookean::volume(measure)
            }
            Self::Linear => Hencky::volume(measure),
        }
    }
}
