//! From the shortest group of waves to the longest.

use super::HomogenisationError;
use super::law::{ScaleLaw, Wanted, contacts};
use super::scale::{Scale, ScalePoint, Setting};
use crate::fem::profile::RigidProfile;

/// What a group passes on to the next longer one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Passed {
    /// Friction over the local pressure; the rubber meets the longer waves as a hard wall.
    Friction,
    /// Friction and the mean separation over the local pressure, by which longer waves stand lower where they press more.
    FrictionAndSeparation,
}

/// All groups of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Homogenised {
    /// Laws of all groups but the longest, the shortest first.
    pub laws: Vec<ScaleLaw>,
    /// The longest group, with all below: friction and contact area of the surface over its mean pressure, ascending.
    pub curve: Vec<ScalePoint>,
}

/// A law reaches up to the largest local pressure of the next group without friction times this, since friction moves
/// pressures, and down to a share of it.
const ABOVE: f64 = 1.25;
const DOWN_TO: f64 = 1e-3;
/// Factor and number of pressures that are tried for the largest local pressure.
const LESS: f64 = 0.7;
const MOST_TRIES: usize = 12;

/// Friction of a surface over a range of mean pressures in Pa, from its groups of waves, the shortest first, each as the
/// profile of one period. The curve ends early where both the pressure in Pa and the contact area fraction are `enough`; a point
/// beyond is solved, between which and the one before values may be interpolated.
///
/// # Errors
/// [`HomogenisationError::NoGroups`]; [`HomogenisationError::TooFewContacts`]; those of the contacts.
pub fn homogenise(
    setting: &Setting,
    groups: &[RigidProfile],
    passed: Passed,
    range: [f64; 2],
    enough: [f64; 2],
) -> Result<Homogenised, HomogenisationError> {
    let (longest, shorter) = groups.split_last().ok_or(HomogenisationError::NoGroups)?;
    let mut ranges = vec![range];
    for group in groups[1..].iter().rev() {
        let [_, highest] = ranges[ranges.len() - 1];
        let largest = ABOVE * largest_pressure(setting, group, highest)?;
        ranges.push([DOWN_TO * largest, largest]);
    }
    let layered = passed == Passed::FrictionAndSeparation;
    let mut laws: Vec<ScaleLaw> = Vec::new();
    for (at, group) in shorter.iter().enumerate() {
        let range = ranges[ranges.len() - 1 - at];
        let law = ScaleLaw::new(setting, group, laws.last(), layered, range, at + 1)?;
        laws.push(law);
    }
    let below = laws.last();
    let wanted = Wanted { range, enough: Some(enough), group: groups.len() };
    let curve = contacts(setting, longest, below, layered, wanted)?;
    Ok(Homogenised { laws, curve })
}

/// The largest local pressure in Pa of a group without friction at a mean pressure, or in proportion at the highest one
/// below it that has a solution.
fn largest_pressure(
    setting: &Setting,
    group: &RigidProfile,
    pressure: f64,
) -> Result<f64, HomogenisationError> {
    let mut scale = Scale::new(setting, group, None, false)?;
    let mut tried = pressure;
    for _ in 0..MOST_TRIES {
        match scale.at(tried) {
            Ok(point) => return Ok(point.largest_pressure * pressure / tried),
            Err(error) if error.is_no_solution() => tried *= LESS,
            Err(error) => return Err(error),
        }
    }
    Ok(scale.at(tried)?.largest_pressure * pressure / tried)
}
