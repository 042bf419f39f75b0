//! Friction, contact area and separation of a group of waves over its mean pressure.

use super::HomogenisationError;
use super::scale::{Scale, ScalePoint, Setting};
use crate::fem::profile::RigidProfile;
use crate::interface::{FrictionOverPressure, LocalFriction};
use crate::multiscale::{LawEnd, LocalLaw};
use crate::numerics::interpolation::CubicHermite;

/// Contact area fraction from which on a group is pressed flat.
const FLAT: f64 = 0.999;

/// What a group of waves answers to a mean pressure, with all groups below.
#[derive(Debug, Clone, PartialEq)]
pub struct ScaleLaw {
    /// Friction over the pressure.
    pub friction: LocalFriction,
    area: CubicHermite,
    /// Largest height above the mean in m.
    touch: f64,
    points: Vec<ScalePoint>,
}

impl ScaleLaw {
    /// The law of a profile over pressures in a range in Pa, in steps of the ratio of the setting. Where contacts of the
    /// range have no solution, at its lower end of less than a node and at its upper end beyond what the rubber bears, the
    /// law is that of the others.
    ///
    /// # Errors
    /// Those of the contacts that are no want of a solution; [`HomogenisationError::TooFewContacts`] for the group of a
    /// number if fewer than two have one.
    pub fn new(
        setting: &Setting,
        profile: &RigidProfile,
        below: Option<&ScaleLaw>,
        layered: bool,
        range: [f64; 2],
        group: usize,
    ) -> Result<Self, HomogenisationError> {
        let wanted = Wanted { range, enough: None, group };
        let points = contacts(setting, profile, below, layered, wanted)?;
        let heights = profile.sample(64 * profile.shortest_waves() as usize);
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let below_touch = below.filter(|_| layered).map_or(0.0, |law| law.touch);
        let pairs: Vec<[f64; 2]> =
            points.iter().map(|point| [point.pressure, point.friction.max(0.0)]).collect();
        let friction = LocalFriction::Table(FrictionOverPressure::new(&pairs)?);
        let logarithms = points.iter().map(|point| point.pressure.ln()).collect();
        let areas = points.iter().map(|point| point.area.max(f64::MIN_POSITIVE).ln()).collect();
        let area = CubicHermite::monotone_parabolas(logarithms, areas);
        Ok(Self { friction, area, touch: highest - mean + below_touch, points })
    }

    /// The contacts that the law goes through.
    pub fn points(&self) -> &[ScalePoint] {
        &self.points
    }

    /// Lowest and highest pressure in Pa.
    pub fn range(&self) -> [f64; 2] {
        [self.points[0].pressure, self.points[self.points.len() - 1].pressure]
    }

    /// Contact area fraction at a pressure in Pa; below the lowest one in proportion to it, above the highest that there.
    pub fn area(&self, pressure: f64) -> f64 {
        if pressure <= 0.0 {
            return 0.0;
        }
        let [lowest, _] = self.range();
        let share = (pressure / lowest).min(1.0);
        share * self.area.at(pressure.max(lowest).ln()).exp()
    }

    /// The mean separation as a layer for longer waves.
    ///
    /// # Errors
    /// [`HomogenisationError::Separation`] if separations do not fall with the pressure.
    pub fn layer(&self) -> Result<LocalLaw, HomogenisationError> {
        let falling = self.falling();
        let pressures: Vec<f64> = falling.iter().map(|point| point.pressure).collect();
        let separations: Vec<f64> = falling.iter().map(|point| point.separation).collect();
        let flat = falling.last().is_some_and(|point| point.area_of_group >= FLAT);
        let end = if flat { LawEnd::FullContact } else { LawEnd::PartialContact };
        Ok(LocalLaw::new(self.touch, &pressures, &separations, end)?)
    }

    /// The points until the group is pressed flat, from where on its separation stays.
    fn falling(&self) -> &[ScalePoint] {
        let falls = |pair: &[ScalePoint]| pair[1].separation < pair[0].separation;
        let count = self.points.windows(2).take_while(|pair| falls(pair)).count();
        &self.points[..=count]
    }
}

/// Contacts of a group that are wanted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted {
    /// Lowest and highest pressure in Pa.
    pub range: [f64; 2],
    /// Pressure in Pa and contact area fraction at which the contacts end early.
    pub enough: Option<[f64; 2]>,
    /// Number of the group, for messages.
    pub group: usize,
}

/// The contacts of a group over a range of pressures, ascending.
pub(super) fn contacts(
    setting: &Setting,
    profile: &RigidProfile,
    below: Option<&ScaleLaw>,
    layered: bool,
    Wanted { range, enough, group }: Wanted,
) -> Result<Vec<ScalePoint>, HomogenisationError> {
    let mut scale = Scale::new(setting, profile, below, layered)?;
    let steps = ((range[1] / range[0]).ln() / setting.pressure_ratio.ln()).ceil().max(1.0) as usize;
    let (mut points, mut reason) = (Vec::new(), None);
    let mut failures = 0;
    for k in 0..=steps {
        let pressure = range[0] * (range[1] / range[0]).powf(k as f64 / steps as f64);
        match scale.at(pressure) {
            // Of a contact that one node carries friction is that of its grid.
            Ok(point) if points.is_empty() && too_slight(setting, profile, &point) => {}
            Ok(point) => {
                failures = 0;
                points.push(point);
                let is_enough = |[most, area]: [f64; 2]| pressure >= most && point.area >= area;
                // Values are interpolated, which needs two contacts.
                if points.len() > 1 && enough.is_some_and(is_enough) {
                    break;
                }
            }
            Err(error) if error.is_no_solution() => {
                reason = Some(error.to_string());
                failures += 1;
                if !points.is_empty() && failures == MOST_FAILURES {
                    break;
                }
            }
            Err(error) => return Err(error),
        }
    }
    if points.len() < 2 {
        let solved = points.len();
        return Err(HomogenisationError::TooFewContacts { group, solved, range, reason });
    }
    Ok(points)
}

/// Pressures in a row without a solution after which a law ends.
const MOST_FAILURES: usize = 2;
/// Points or nodes of a contact on a shortest wave from which on it counts.
const FEWEST_NODES: f64 = 3.0;

/// Whether the contact of a group is of a few nodes alone.
fn too_slight(setting: &Setting, profile: &RigidProfile, point: &ScalePoint) -> bool {
    let nodes = setting.resolution as f64 * profile.shortest_waves();
    point.area_of_group * nodes < FEWEST_NODES
}
