//! The contact of one group of waves under the law of the group below.

use super::{HomogenisationError, ScaleLaw};
use crate::contact::SlidingContact;
use crate::fem::error::FemError;
use crate::fem::profile::RigidProfile;
use crate::fem::steady::{BlockOptions, SteadyContact};
use crate::interface::LocalFriction;
use crate::multiscale::SoftContact;
use crate::numerics::Interrupt;
use crate::rubber::RubberModel;

/// How the contact of a group is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mechanics {
    /// On the half-space, for small slopes: shear of the interface changes no pressure, and its friction adds to that of
    /// the pressures.
    HalfSpace,
    /// At finite deformation, by [`SteadyContact`]: the shear carries a part of the load on slopes.
    FiniteDeformation,
}

/// What all groups have in common.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'a> {
    /// The rubber.
    pub rubber: &'a RubberModel,
    /// Sliding speed in m/s; each group slides as fast.
    pub speed: f64,
    /// How contacts are solved.
    pub mechanics: Mechanics,
    /// Grid points or elements on the shortest wave of a group.
    pub resolution: usize,
    /// Ratio of neighbouring pressures of a law.
    pub pressure_ratio: f64,
    /// Ends a solve.
    pub interrupt: &'a Interrupt,
}

/// A group of waves at one mean pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScalePoint {
    /// Mean pressure in Pa.
    pub pressure: f64,
    /// Friction coefficient with that of all groups below.
    pub friction: f64,
    /// Contact area fraction with that of all groups below: the mean of their area over the local pressures.
    pub area: f64,
    /// Contact area fraction of this group alone, as if it were smooth.
    pub area_of_group: f64,
    /// Mean separation in m, above the mean plane of the groups below where those are a layer.
    pub separation: f64,
    /// Largest local pressure in Pa.
    pub largest_pressure: f64,
    /// Share of the load on points whose pressure is beyond the law of the group below.
    pub load_beyond: f64,
}

/// The contact of one group.
pub struct Scale<'a> {
    solver: Solver,
    below: Option<&'a ScaleLaw>,
    friction: LocalFriction,
}

enum Solver {
    HalfSpace(SlidingContact),
    Layered(SoftContact),
    Finite(Box<SteadyContact>),
}

/// Pressures, friction of the group, area of the group and separation of a contact.
struct Solved {
    pressures: Vec<f64>,
    friction: f64,
    area: f64,
    separation: f64,
}

impl<'a> Scale<'a> {
    /// The contact of a profile whose points answer by the law of the waves `below`, whose separation is a layer of the
    /// profile if `layered`.
    ///
    /// # Errors
    /// Those of the contact that is set up.
    pub fn new(
        setting: &Setting,
        profile: &RigidProfile,
        below: Option<&'a ScaleLaw>,
        layered: bool,
    ) -> Result<Self, HomogenisationError> {
        let friction = below.map_or(LocalFriction::None, |law| law.friction.clone());
        let layer = below.filter(|_| layered).map(ScaleLaw::layer).transpose()?;
        let &Setting { rubber, speed, interrupt, resolution, .. } = setting;
        let resolved = resolution * profile.shortest_waves() as usize;
        let period = profile.period();
        let solver = match (setting.mechanics, layer) {
            (Mechanics::HalfSpace, None) => {
                let heights = profile.sample(resolved);
                Solver::HalfSpace(SlidingContact::new_interruptible(
                    rubber, speed, period, &heights, interrupt,
                )?)
            }
            (Mechanics::HalfSpace, Some(law)) => {
                let heights = profile.sample(resolved);
                Solver::Layered(SoftContact::new_interruptible(
                    rubber, speed, period, &heights, law, interrupt,
                )?)
            }
            (Mechanics::FiniteDeformation, layer) => {
                let options = BlockOptions::of_profile(resolved, profile);
                let rubber = rubber.maxwell().map_err(FemError::from)?;
                let law = rubber.finite_strain;
                let contact = SteadyContact::new(rubber, law, speed, profile.clone(), options)?;
                let contact = contact.interruptible(interrupt).with_interface(friction.clone())?;
                Solver::Finite(Box::new(match layer {
                    None => contact,
                    Some(law) => contact.on_layer(law.in_proportion_below_the_samples()),
                }))
            }
        };
        Ok(Self { solver, below, friction })
    }

    /// The contact at a mean pressure in Pa.
    ///
    /// # Errors
    /// Those of the contact.
    pub fn at(&mut self, pressure: f64) -> Result<ScalePoint, HomogenisationError> {
        let solved = self.solve(pressure)?;
        let (load, count) = (solved.pressures.iter().sum::<f64>(), solved.pressures.len() as f64);
        let touching = solved.pressures.iter().filter(|p| **p > 0.0).count() as f64;
        let area = match self.below {
            None => solved.area,
            Some(law) => {
                let within = solved.pressures.iter().map(|p| law.area(*p)).sum::<f64>();
                // Edges of the contact lie between points.
                within / count * (solved.area * count / touching)
            }
        };
        let beyond = self.below.map_or(0.0, |law| {
            let [_, highest] = law.range();
            solved.pressures.iter().filter(|p| **p > highest).sum::<f64>() / load
        });
        Ok(ScalePoint {
            pressure,
            friction: solved.friction,
            area: area.min(1.0),
            area_of_group: solved.area,
            separation: solved.separation,
            largest_pressure: solved.pressures.iter().copied().fold(0.0, f64::max),
            load_beyond: beyond,
        })
    }

    fn solve(&mut self, pressure: f64) -> Result<Solved, HomogenisationError> {
        let shear = |pressures: &[f64], law: &LocalFriction| {
            let sum: f64 = pressures.iter().map(|p| law.at(*p).stress).sum();
            sum / pressures.len() as f64 / pressure
        };
        Ok(match &mut self.solver {
            Solver::HalfSpace(contact) => {
                let solution = contact.solve(pressure)?;
                Solved {
                    friction: solution.friction_coefficient
                        + shear(&solution.pressure, &self.friction),
                    area: solution.contact_area_fraction,
                    separation: solution.mean_separation,
                    pressures: solution.pressure,
                }
            }
            Solver::Layered(contact) => {
                let solution = contact.solve(pressure)?;
                Solved {
                    friction: solution.friction_coefficient
                        + shear(&solution.pressure, &self.friction),
                    area: solution.contact_points as f64 / solution.pressure.len() as f64,
                    separation: solution.mean_separation,
                    pressures: solution.pressure,
                }
            }
            Solver::Finite(contact) => {
                let solution = contact.solve(pressure)?;
                Solved {
                    friction: solution.friction_coefficient,
                    area: solution.contact_area_fraction,
                    separation: solution.mean_separation,
                    pressures: solution.nodes.iter().map(|node| node.pressure).collect(),
                }
            }
        })
    }
}
