//! One surface under one method: groups of waves, and the curve of friction over contact area that they give.

use super::section::{OlderMethod, ScaleMechanics};
use super::{MethodCurveRow, Methods};
use crate::artifact::SolveStore;
use crate::fem::profile::RigidProfile;
use crate::homogenisation::{Homogenised, Passed, ScalePoint, Setting, homogenise};
use crate::numerics::Interrupt;
use crate::rubber::RubberModel;
use crate::stages::bem::Wanted;
use crate::stages::between_solves::{SolvedPoint, ValueBetween, values_at};
use crate::stages::kept::{self, Kept};
use crate::stages::realise::Surface;
use crate::stages::{SolveError, StageError};
use crate::surface::Wave;
use crate::units::Units;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::time::Instant;

/// Revision of the curves: part of the key of every stored one. To be raised when the same problem gives another number.
const SOLVER_REVISION: u32 = 1;
/// Largest share of the load beyond the law of a shorter scale with which a value counts.
const MOST_BEYOND: f64 = 0.05;
/// How far a curve begins below the pressures of the half-space, and goes on beyond them until it has the largest area: scale
/// by scale the same area may need another pressure.
const BEFORE: f64 = 2.0;
const BEYOND: f64 = 4.0;

/// Waves that are solved together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Group {
    waves: Vec<Wave>,
    /// The crests of its one wave on a flat.
    crests: bool,
}

impl Group {
    /// One wave alone; its place on the period changes nothing.
    fn alone(wave: &Wave, crests: bool) -> Self {
        Self { waves: vec![Wave { phase: 0.0, ..*wave }], crests }
    }

    pub fn profile(&self) -> RigidProfile {
        if self.crests {
            return RigidProfile::crests(self.waves[0]);
        }
        let period = self.waves.iter().map(|wave| wave.wavelength).fold(0.0, f64::max);
        RigidProfile::from_waves(&self.waves, period)
    }
}

/// What is solved: surfaces that differ in what the method does not see share it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Task {
    pub method: OlderMethod,
    pub mechanics: ScaleMechanics,
    /// Shortest waves below the split.
    pub split_waves: Option<u32>,
    pub speed_mm_s: f64,
    /// From the shortest.
    pub groups: Vec<Group>,
    /// Lowest and highest mean pressure in Pa.
    pub range: [f64; 2],
    /// Largest mean pressure in Pa and contact area fraction at which the recipe asks for friction.
    pub enough: [f64; 2],
}

impl Task {
    /// All that a section asks for on a surface at a speed, whose contacts on the half-space are between two pressures in MPa,
    /// up to a contact area fraction.
    pub fn of(
        section: &Methods,
        surface: &Surface,
        speed_mm_s: f64,
        [lowest, highest]: [f64; 2],
        largest_area: f64,
    ) -> Vec<Self> {
        let range = [lowest.mpa_to_pa() / BEFORE, highest.mpa_to_pa() * BEYOND];
        let mut tasks = Vec::new();
        for &mechanics in &section.mechanics {
            for &method in &section.methods {
                for (split_waves, groups) in groupings(section, method, &surface.profile) {
                    tasks.push(Self {
                        method,
                        mechanics,
                        split_waves,
                        speed_mm_s,
                        groups,
                        range,
                        enough: [highest.mpa_to_pa(), largest_area],
                    });
                }
            }
        }
        tasks
    }

    /// What it is, for messages.
    pub fn name(&self) -> String {
        let split =
            self.split_waves.map_or(String::new(), |waves| format!(" after {waves} wave(s)"));
        format!("{}{split}, {}, {} mm/s", self.method, self.mechanics, self.speed_mm_s)
    }

    /// The curve from the store, or solved and kept there.
    ///
    /// # Errors
    /// Those that more than this curve would have: the interrupt, the store, a problem that is none.
    pub fn solve(
        &self,
        section: &Methods,
        rubber: &RubberModel,
        store: &SolveStore,
        interrupt: &Interrupt,
    ) -> Result<Curve, StageError> {
        let mut problem = kept::problem_at_finite_deformation("methods", SOLVER_REVISION, rubber);
        problem["speed_mm_s"] = json!(self.speed_mm_s);
        let solved =
            Kept::open(store, problem, interrupt).map_err(SolveError::from).and_then(|mut kept| {
                let values = [
                    ("groups", json!(self.groups)),
                    ("layered", json!(self.passed() == Passed::FrictionAndSeparation)),
                    ("mechanics", json!(self.mechanics)),
                    ("resolution", json!(section.resolution(self.mechanics))),
                    ("pressure_ratio", json!(section.pressure_ratio)),
                    ("range", json!(self.range)),
                    ("enough", json!(self.enough)),
                ];
                kept.take_or(&values, || self.curve(section, rubber, interrupt))
            });
        solved.map_err(|error| {
            error.in_stage(|source| StageError::Solve { problem: self.name(), source })
        })
    }

    fn passed(&self) -> Passed {
        match self.method {
            OlderMethod::Projection => Passed::FrictionAndSeparation,
            _ => Passed::Friction,
        }
    }

    fn curve(
        &self,
        section: &Methods,
        rubber: &RubberModel,
        interrupt: &Interrupt,
    ) -> Result<Curve, SolveError> {
        let start = Instant::now();
        let profiles: Vec<RigidProfile> = self.groups.iter().map(Group::profile).collect();
        let setting = Setting {
            rubber,
            speed: self.speed_mm_s.mm_to_m(),
            mechanics: self.mechanics.into(),
            resolution: section.resolution(self.mechanics),
            pressure_ratio: section.pressure_ratio,
            interrupt,
        };
        // Half of all that is resolved: the difference is the error of grid and pressures together.
        let coarse = Setting {
            resolution: setting.resolution / 2,
            pressure_ratio: setting.pressure_ratio.powi(2),
            ..setting
        };
        let solve = |setting: &Setting| {
            homogenise(setting, &profiles, self.passed(), self.range, self.enough)
        };
        let fine = match solve(&setting) {
            Ok(found) => found,
            Err(error) if error.is_no_solution() => return Ok(Curve::Unsolved(error.to_string())),
            Err(error) => return Err(error.into()),
        };
        let seconds = start.elapsed().as_secs_f64();
        let coarser = match solve(&coarse) {
            Ok(found) => points(&found),
            Err(error) if error.is_no_solution() => Vec::new(),
            Err(error) => return Err(error.into()),
        };
        Ok(Curve::Solved { points: points(&fine), coarser, seconds })
    }
}

/// The groups of waves of a method, with the number of waves below the split where there is a choice. Waves without an
/// amplitude count, and are in no group; a split with none to one side is left out.
fn groupings(
    section: &Methods,
    method: OlderMethod,
    waves: &[Wave],
) -> Vec<(Option<u32>, Vec<Group>)> {
    let present = |waves: &[Wave]| -> Vec<Wave> {
        waves.iter().filter(|wave| wave.amplitude != 0.0).copied().collect()
    };
    let together = |waves: &[Wave]| match waves {
        [wave] => Group::alone(wave, false),
        waves => Group { waves: waves.to_vec(), crests: false },
    };
    match method {
        OlderMethod::Recursive => {
            let groups = present(waves).iter().map(|wave| Group::alone(wave, false)).collect();
            vec![(None, groups)]
        }
        OlderMethod::Particles => match present(waves).as_slice() {
            [shortest, others @ ..] if !others.is_empty() => {
                vec![(None, vec![Group::alone(shortest, true), together(others)])]
            }
            _ => Vec::new(),
        },
        OlderMethod::Split | OlderMethod::Projection => {
            let asked = |k: &u32| section.split_waves.is_empty() || section.split_waves.contains(k);
            let split = |k: u32| {
                let (short, long) = waves.split_at(k as usize);
                let (short, long) = (present(short), present(long));
                let both = !short.is_empty() && !long.is_empty();
                both.then(|| (Some(k), vec![together(&short), together(&long)]))
            };
            (1..waves.len() as u32).filter(asked).filter_map(split).collect()
        }
    }
}

/// A contact of a curve as it is kept.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Point {
    pressure_mpa: f64,
    friction_coefficient: f64,
    contact_area_fraction: f64,
    load_beyond: f64,
}

/// A curve, or why there is none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Curve {
    Solved { points: Vec<Point>, coarser: Vec<Point>, seconds: f64 },
    Unsolved(String),
}

fn points(found: &Homogenised) -> Vec<Point> {
    let kept = |point: &ScalePoint| Point {
        pressure_mpa: point.pressure.pa_to_mpa(),
        friction_coefficient: point.friction,
        contact_area_fraction: point.area,
        load_beyond: point.load_beyond,
    };
    found.curve.iter().map(kept).collect()
}

impl Curve {
    /// Wall time of it in seconds.
    pub fn seconds(&self) -> Option<f64> {
        match self {
            Self::Solved { seconds, .. } => Some(*seconds),
            Self::Unsolved(_) => None,
        }
    }

    /// Friction at the areas and pressures that lie between its contacts, for a surface.
    pub fn rows(&self, task: &Task, surface: &Surface, wanted: &Wanted) -> Vec<MethodCurveRow> {
        let Self::Solved { points, coarser, .. } = self else { return Vec::new() };
        let within: Vec<Point> =
            points.iter().filter(|point| point.load_beyond <= MOST_BEYOND).copied().collect();
        let coarser = between(coarser, wanted);
        let row = |value: &ValueBetween| {
            let same = coarser.iter().find(|other| other.condition() == value.condition());
            let difference = |other: &ValueBetween| {
                (value.friction_coefficient - other.friction_coefficient).abs()
            };
            MethodCurveRow {
                model: task.method,
                mechanics: task.mechanics,
                split_waves: task.split_waves,
                kind: surface.kind,
                realisation: surface.realisation,
                speed_mm_s: task.speed_mm_s,
                given: value.given,
                contact_area_fraction: value.contact_area_fraction,
                pressure_mpa: value.pressure_mpa,
                friction_coefficient: value.friction_coefficient,
                interpolation_error: value.interpolation_error,
                discretisation_error: same.map(difference),
                load_beyond_law: beyond(&within, value.pressure_mpa),
            }
        };
        between(&within, wanted).iter().map(row).collect()
    }
}

fn between(points: &[Point], wanted: &Wanted) -> Vec<ValueBetween> {
    let solved = |point: &Point| SolvedPoint {
        pressure_mpa: point.pressure_mpa,
        friction_coefficient: point.friction_coefficient,
        contact_area_fraction: point.contact_area_fraction,
    };
    values_at(wanted, &points.iter().map(solved).collect::<Vec<_>>())
}

/// The larger share of the load beyond the law of the two contacts around a pressure.
fn beyond(points: &[Point], pressure_mpa: f64) -> f64 {
    let above = points.partition_point(|point| point.pressure_mpa < pressure_mpa);
    let around = &points[above.saturating_sub(1)..(above + 1).min(points.len())];
    around.iter().map(|point| point.load_beyond).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::realise::SurfaceKind;

    fn surface(waves: u32) -> Surface {
        let wave = |k: u32| Wave {
            wavelength: 1e-4 * 2_f64.powi(k as i32),
            amplitude: 1e-5,
            phase: 0.5 + f64::from(k),
        };
        let profile = (0..waves).map(wave).collect();
        Surface { kind: SurfaceKind::sines(waves), realisation: 1, profile }
    }

    fn tasks(section: &Methods, waves: u32) -> Vec<Task> {
        Task::of(section, &surface(waves), 10.0, [0.1, 1.0], 0.1)
    }

    #[test]
    fn every_method_groups_the_waves_its_own_way() {
        let section = Methods { mechanics: vec![ScaleMechanics::HalfSpace], ..Methods::default() };
        let found = tasks(&section, 3);
        let sizes = |task: &Task| -> Vec<usize> {
            task.groups.iter().map(|group| group.waves.len()).collect()
        };
        let all: Vec<_> =
            found.iter().map(|task| (task.method, task.split_waves, sizes(task))).collect();
        let expected = [
            (OlderMethod::Recursive, None, vec![1, 1, 1]),
            (OlderMethod::Split, Some(1), vec![1, 2]),
            (OlderMethod::Split, Some(2), vec![2, 1]),
            (OlderMethod::Particles, None, vec![1, 2]),
            (OlderMethod::Projection, Some(1), vec![1, 2]),
            (OlderMethod::Projection, Some(2), vec![2, 1]),
        ];
        assert_eq!(all, expected);
        assert!(found[3].groups[0].crests && !found[3].groups[1].crests);
        assert_eq!((found[0].range, found[0].enough), ([5e4, 4e6], [1e6, 0.1]));
    }

    /// Realisations differ in phases, of which a recursion over single waves sees nothing: one curve for all.
    #[test]
    fn single_waves_have_no_phase() {
        let section = Methods { methods: vec![OlderMethod::Recursive], ..Methods::default() };
        let other = Surface {
            profile: surface(3).profile.iter().map(|w| Wave { phase: 0.1, ..*w }).collect(),
            ..surface(3)
        };
        assert_eq!(tasks(&section, 3), Task::of(&section, &other, 10.0, [0.1, 1.0], 0.1));
    }

    #[test]
    fn one_wave_cannot_be_split() {
        let found = tasks(&Methods::default(), 1);
        assert!(found.iter().all(|task| task.method == OlderMethod::Recursive), "{found:?}");
        let section = Methods { split_waves: vec![2], ..Methods::default() };
        let splits: Vec<_> = tasks(&section, 3).iter().map(|task| task.split_waves).collect();
        assert!(!splits.contains(&Some(1)) && splits.contains(&Some(2)));
    }

    #[test]
    fn values_beyond_a_law_are_left_out() {
        let point = |k: i32, load_beyond: f64| Point {
            pressure_mpa: 0.1 * f64::from(k),
            friction_coefficient: 0.5,
            contact_area_fraction: 0.02 * f64::from(k),
            load_beyond,
        };
        let points = vec![point(1, 0.0), point(2, 0.01), point(3, 0.04), point(4, 0.2)];
        let curve = Curve::Solved { points, coarser: Vec::new(), seconds: 1.0 };
        let wanted = Wanted { area_fractions: vec![0.03, 0.05, 0.07], pressures_mpa: vec![] };
        let task = &tasks(&Methods::default(), 3)[0];
        let rows = curve.rows(task, &surface(3), &wanted);
        let areas: Vec<f64> = rows.iter().map(|row| row.contact_area_fraction).collect();
        assert_eq!(areas, [0.03, 0.05]);
        assert_eq!((rows[0].load_beyond_law, rows[1].load_beyond_law), (0.01, 0.04));
        assert_eq!(rows[0].discretisation_error, None);
    }
}
