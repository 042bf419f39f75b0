//! What can go wrong in a finite-deformation contact.

use super::steady::solution::SteadySolution;
use crate::error_kind::{ErrorKind, HasKind};
use crate::rubber::{Rheology, RubberError};
use serde::{Deserialize, Serialize};

/// Why there is no solution to report.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FemError {
    /// The numbers of the rubber are out of range, in general or for finite elements.
    #[error(transparent)]
    Rubber(#[from] RubberError),
    /// A number outside its range.
    #[error("{quantity} is {value}, it must be {range}")]
    OutOfRange {
        /// Which number, with its unit.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// The range it must lie in.
        range: &'static str,
    },
    /// The path of solutions ended below the pressure asked for.
    #[error(
        "no finite-deformation solution at {:.4} MPa on {columns} columns: the path ended {}{}",
        .wanted / 1e6, .reached.describe(), .beyond.map_or(String::new(), |beyond| format!("; {beyond}"))
    )]
    PathEnded {
        /// The mean pressure asked for, in Pa.
        wanted: f64,
        /// Columns of the mesh.
        columns: usize,
        /// The last point that converged.
        reached: PathEnd,
        /// How far the rubber was strained there, if the equations have a solution but the law of the rubber does not
        /// hold in it.
        beyond: Option<BeyondLaw>,
    },
    /// The user's interrupt.
    #[error("interrupted")]
    Interrupted,
    /// No pressure was found that gives the contact area.
    #[error(
        "no pressure gives the contact area fraction {wanted} on {columns} columns: the nearest \
         found is {found} at {:.6} MPa", .pressure / 1e6
    )]
    AreaNotReached {
        /// The contact area fraction asked for.
        wanted: f64,
        /// The nearest one found.
        found: f64,
        /// Its mean pressure in Pa.
        pressure: f64,
        /// Columns of the mesh.
        columns: usize,
    },
}

impl HasKind for FemError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Rubber(_) | Self::OutOfRange { .. } => ErrorKind::Input,
            Self::PathEnded { .. } | Self::AreaNotReached { .. } => ErrorKind::Failure,
            Self::Interrupted => ErrorKind::Interrupted,
        }
    }
}

impl FemError {
    /// Whether the solver found no solution; otherwise it was not asked for one that there could be, or
    /// was interrupted.
    pub fn is_no_solution(&self) -> bool {
        matches!(self, Self::PathEnded { .. } | Self::AreaNotReached { .. })
    }
}

/// A strain at which the law of the rubber does not hold.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BeyondLaw {
    /// The law with its constants.
    pub law: Rheology,
    /// `I1 - 3` of the spring that is strained most.
    pub invariant: f64,
}

impl BeyondLaw {
    /// If the law does not hold there.
    pub(super) fn of(law: Rheology, invariant: Option<f64>) -> Option<Self> {
        let invariant = invariant?;
        // NaN is no state either.
        let holds = invariant <= law.limit();
        (!holds).then_some(Self { law, invariant })
    }
}

impl std::fmt::Display for BeyondLaw {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let Self { law, invariant } = self;
        let (name, limit) = (law.name(), law.limit());
        write!(
            f,
            "I1 - 3 is {invariant:.4} in the spring that is strained most, and the law of {name} holds up to {limit:.4}: "
        )?;
        match law {
            Rheology::ArrudaBoyce { .. } => {
                f.write_str("its chains are straight there; choose a larger locking_stretch or a smaller pressure")
            }
            _ => f.write_str(
                "its shear stress has a maximum there; choose a larger c3_over_c1, fitted to larger strains, or a \
                 smaller pressure",
            ),
        }
    }
}

/// The last converged point of a path of growing pressure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum PathEnd {
    /// Not even the first, slight contact converged.
    NotStarted,
    /// At this pressure not all waves of a profile of many scales could grow, or the contact on the
    /// whole profile did not converge.
    NotGrown,
    /// A smaller pressure converged.
    At {
        /// Its mean pressure in Pa.
        pressure: f64,
        /// Its friction coefficient.
        friction_coefficient: f64,
        /// Its contact area fraction.
        contact_area_fraction: f64,
    },
}

impl PathEnd {
    pub(super) fn at(solution: &SteadySolution) -> Self {
        Self::At {
            pressure: solution.mean_pressure,
            friction_coefficient: solution.friction_coefficient,
            contact_area_fraction: solution.contact_area_fraction,
        }
    }

    fn describe(&self) -> String {
        match self {
            Self::NotStarted => "before the first contact was found".into(),
            Self::NotGrown => "before the contact on all waves of the profile converged".into(),
            Self::At { pressure, friction_coefficient, contact_area_fraction } => format!(
                "at {:.4} MPa, where friction is {friction_coefficient:.4} and the contact area \
                 fraction {contact_area_fraction:.4}",
                pressure / 1e6
            ),
        }
    }
}
