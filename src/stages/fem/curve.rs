//! One curve of friction over contact area: one surface at one speed, solved along its pressures.

use super::{Fem, FemCurveRow, FemSolveRow};
use crate::artifact::{ArtifactError, Digest, SolveStore};
use crate::fem::error::FemError;
use crate::fem::profile::RigidProfile;
use crate::fem::steady::{BlockOptions, SteadyContact};
use crate::rubber::RubberModel;
use crate::stages::bem::Wanted;
use crate::stages::between_solves::{SolvedPoint, ValueBetween, values_at};
use crate::stages::kept::{self, Kept, KeptPath};
use crate::stages::realise::Surface;
use crate::stages::realise::SurfaceKind;
use crate::stages::{SolveError, Watch};
use crate::units::Units;
use serde_json::{Value, json};

/// Revision of the solver: part of the key of every stored solve.
const SOLVER_REVISION: u32 = 7;

/// The curve of one surface at one speed.
pub(crate) struct CurveResult {
    pub rows: Vec<FemCurveRow>,
    pub solves: Vec<FemSolveRow>,
    pub warnings: Vec<String>,
}

/// Sets up the contact at finite deformation.
type SetUp<'a> = Box<dyn Fn() -> Result<SteadyContact, FemError> + 'a>;

/// One surface at one speed.
pub(super) struct Solver<'a> {
    surface: &'a Surface,
    speed_mm_s: f64,
    columns: usize,
    ratio: f64,
    path: KeptPath<'a, SetUp<'a>>,
    /// Of ascending pressure.
    solves: Vec<FemSolveRow>,
}

/// Friction and heat may be this far apart, relative to a friction that is not next to nothing.
const MOST_APART: f64 = 0.05;
const LEAST_FRICTION: f64 = 0.05;
/// Solves beyond which a sweep is not led on.
const MOST_SOLVES: usize = 120;

impl<'a> Solver<'a> {
    pub fn new(
        columns: usize,
        parameters: &Fem,
        rubber: &'a RubberModel,
        surface: &'a Surface,
        speed_mm_s: f64,
        store: &'a SolveStore,
        watch: Watch<'a>,
    ) -> Result<Self, SolveError> {
        let interrupted = watch.interrupted;
        let problem = problem(rubber, surface, speed_mm_s, columns);
        let kept = Kept::open(store, problem, interrupted)?;
        let set_up: SetUp = Box::new(move || {
            let waves = &surface.profile;
            let period = waves.iter().map(|wave| wave.wavelength).fold(0.0, f64::max);
            let profile = RigidProfile::from_waves(waves, period);
            let options = BlockOptions::of_profile(columns, &profile);
            let rubber = rubber.maxwell()?;
            let (law, speed) = (rubber.finite_strain, speed_mm_s.mm_to_m());
            Ok(SteadyContact::new(rubber, law, speed, profile, options)?.interruptible(interrupted))
        });
        Ok(Self {
            surface,
            speed_mm_s,
            columns,
            ratio: parameters.pressure_ratio,
            path: KeptPath::new(kept, columns, set_up),
            solves: Vec::new(),
        })
    }

    /// Solves pressures at the ratio of the recipe, from below the smallest to above the largest
    /// area; returns why the path ended before that, if it did. A pressure without a solution may have one
    /// close by, so half the step is tried before the sweep ends.
    pub fn sweep(&mut self, wanted: &Wanted, guess: f64) -> Result<Option<FemError>, SolveError> {
        let ends = |values: &[f64]| {
            (
                values.first().copied().unwrap_or(f64::INFINITY),
                values.last().copied().unwrap_or(0.0),
            )
        };
        let (smallest, largest) = ends(&wanted.area_fractions);
        let (least, most) = ends(&wanted.pressures_mpa);
        let (least, most) = (least.mpa_to_pa(), most.mpa_to_pa());
        let mut pressure = guess;
        let mut area = self.point(pressure)?.contact_area_fraction;
        let (mut lower_area, mut too_slight) = (area, None);
        while (lower_area > smallest || pressure > least) && self.solves.len() < MOST_SOLVES {
            pressure /= self.ratio;
            match self.point(pressure) {
                Ok(row) => lower_area = row.contact_area_fraction,
                // A contact of less than a node has no solution; those above have.
                Err(SolveError::FiniteDeformation(error @ FemError::PathEnded { .. })) => {
                    too_slight = Some(error);
                    break;
                }
                Err(error) => return Err(error),
            }
        }
        pressure = guess;
        let mut ended = None;
        while (area < largest || pressure < most) && self.solves.len() < MOST_SOLVES {
            let step = if ended.is_none() { self.ratio } else { self.ratio.sqrt() };
            match self.point(pressure * step) {
                Ok(row) => {
                    pressure *= step;
                    area = row.contact_area_fraction;
                    ended = None;
                }
                Err(SolveError::FiniteDeformation(error @ FemError::PathEnded { .. })) => {
                    if ended.replace(error).is_some() {
                        break;
                    }
                }
                Err(error) => return Err(error),
            }
        }
        self.solves.sort_by(|a, b| a.pressure_mpa.total_cmp(&b.pressure_mpa));
        Ok(ended.or(too_slight))
    }

    /// A warning where friction and heat are apart: the mesh is too coarse for these contacts.
    pub fn coarse_mesh(&self) -> Option<String> {
        let apart = |row: &FemSolveRow| {
            let difference = (row.friction_coefficient - row.friction_from_heat).abs();
            difference > MOST_APART * row.friction_coefficient.abs().max(LEAST_FRICTION)
        };
        let solves: Vec<&FemSolveRow> = self.solves.iter().filter(|row| apart(row)).collect();
        let largest = solves.iter().map(|row| row.contact_area_fraction).fold(0.0, f64::max);
        let Surface { kind, realisation, .. } = self.surface;
        (!solves.is_empty()).then(|| {
            format!(
                "{kind}, realisation {realisation}, {} mm/s: friction and heat are more than 5 % \
                 apart in {} of {} solves, up to area {largest:.3}: more elements would tell them \
                 better (fem.columns_per_shortest_wavelength)",
                self.speed_mm_s,
                solves.len(),
                self.solves.len()
            )
        })
    }

    /// Friction at the areas and pressures that lie between solved ones.
    pub fn values(&self, wanted: &Wanted) -> Vec<FemCurveRow> {
        values_between(wanted, &self.solves, |row| FemCurveRow {
            kind: self.surface.kind,
            realisation: self.surface.realisation,
            speed_mm_s: self.speed_mm_s,
            ..row
        })
    }

    /// The same on half the columns, where the solutions were reached from there.
    pub fn coarser_values(&self, wanted: &Wanted) -> Option<Vec<FemCurveRow>> {
        let coarser = |row: &FemSolveRow| {
            Some(FemSolveRow {
                friction_coefficient: row.coarser_friction_coefficient?,
                contact_area_fraction: row.coarser_contact_area_fraction?,
                ..row.clone()
            })
        };
        let solves: Option<Vec<FemSolveRow>> = self.solves.iter().map(coarser).collect();
        solves.map(|solves| values_between(wanted, &solves, |row| row))
    }

    fn point(&mut self, pressure: f64) -> Result<FemSolveRow, SolveError> {
        let Self { surface, speed_mm_s, columns, path, .. } = self;
        let (kind, realisation) = (surface.kind, surface.realisation);
        let row = path.at(pressure, |solution, seconds| {
            let coarser = solution.coarser;
            Ok(FemSolveRow {
                kind,
                realisation,
                speed_mm_s: *speed_mm_s,
                pressure_mpa: pressure.pa_to_mpa(),
                friction_coefficient: solution.friction_coefficient,
                friction_from_heat: solution.hysteretic_friction,
                contact_area_fraction: solution.contact_area_fraction,
                mean_separation_mm: solution.mean_separation.m_to_mm(),
                coarser_friction_coefficient: coarser.map(|half| half.friction_coefficient),
                coarser_contact_area_fraction: coarser.map(|half| half.contact_area_fraction),
                residual: solution.residual,
                newton_steps: solution.newton_steps as u64,
                columns: *columns as u64,
                seconds,
            })
        })?;
        // The same surface may have been solved under another name.
        let row = FemSolveRow { kind, realisation, ..row };
        self.solves.push(row.clone());
        Ok(row)
    }

    /// All solves by ascending pressure.
    pub fn into_solves(self) -> Vec<FemSolveRow> {
        self.solves
    }

    /// Notes that every solve of a task is stored.
    pub fn finish(&mut self, task: &Digest) -> Result<(), ArtifactError> {
        self.path.finish(task)
    }
}

/// Friction between solves at ascending pressures; `named` completes a row.
fn values_between(
    wanted: &Wanted,
    solves: &[FemSolveRow],
    named: impl Fn(FemCurveRow) -> FemCurveRow,
) -> Vec<FemCurveRow> {
    let solved = |row: &FemSolveRow| SolvedPoint {
        pressure_mpa: row.pressure_mpa,
        friction_coefficient: row.friction_coefficient,
        contact_area_fraction: row.contact_area_fraction,
    };
    let row = |value: ValueBetween| {
        named(FemCurveRow {
            kind: SurfaceKind::sines(0),
            realisation: 0,
            speed_mm_s: 0.0,
            given: value.given,
            contact_area_fraction: value.contact_area_fraction,
            pressure_mpa: value.pressure_mpa,
            friction_coefficient: value.friction_coefficient,
            interpolation_error: value.interpolation_error,
            discretisation_error: None,
        })
    };
    let solved: Vec<SolvedPoint> = solves.iter().map(solved).collect();
    values_at(wanted, &solved).into_iter().map(row).collect()
}

/// What all solves of a curve have in common.
pub(super) fn problem(
    rubber: &RubberModel,
    surface: &Surface,
    speed_mm_s: f64,
    columns: usize,
) -> Value {
    let mut problem = kept::problem_at_finite_deformation("fem", SOLVER_REVISION, rubber);
    problem["profile"] = json!(surface.profile);
    problem["speed_mm_s"] = json!(speed_mm_s);
    problem["columns"] = json!(columns);
    problem
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::error::PathEnd;
    use crate::numerics::Interrupt;
    use crate::rubber::{Rheology, Rubber};
    use crate::surface::Wave;

    fn solved(pressure_mpa: f64, friction_coefficient: f64, area: f64) -> FemSolveRow {
        FemSolveRow {
            kind: SurfaceKind::sines(3),
            realisation: 3,
            speed_mm_s: 50.0,
            pressure_mpa,
            friction_coefficient,
            friction_from_heat: friction_coefficient,
            contact_area_fraction: area,
            mean_separation_mm: 0.04,
            coarser_friction_coefficient: None,
            coarser_contact_area_fraction: None,
            residual: 0.0,
            newton_steps: 5,
            columns: 256,
            seconds: 0.0,
        }
    }

    /// A pressure far beyond the modulus: refused, and known as that to the next run.
    #[test]
    fn a_refusal_is_kept_and_not_tried_again() {
        let folder = tempfile::tempdir().unwrap();
        let store = SolveStore::open(folder.path()).unwrap();
        let wave = Wave { wavelength: 1e-3, amplitude: 1e-4, phase: 0.0 };
        let surface = Surface { kind: SurfaceKind::sines(1), realisation: 1, profile: vec![wave] };
        let (interrupted, parameters) = (Interrupt::default(), Fem::default());
        let watch = Watch { progress: &|_, _| {}, interrupted: &interrupted };
        let rubber = RubberModel::from(crate::rubber::Rubber::table_2_1());
        let solver =
            || Solver::new(16, &parameters, &rubber, &surface, 10.0, &store, watch).unwrap();
        let refused = |mut solver: Solver, pressure: f64| match solver.point(pressure) {
            Err(SolveError::FiniteDeformation(FemError::PathEnded {
                wanted,
                columns,
                reached,
                beyond: None,
            })) => {
                assert_eq!((wanted, columns), (pressure, 16));
                reached
            }
            other => panic!("{other:?}"),
        };
        let hopeless = 1e13;
        let reached = refused(solver(), hopeless);
        assert_eq!(refused(solver(), hopeless), reached);
        // The store is believed: it says so of a pressure that has a solution.
        let mut key = problem(&rubber, &surface, 10.0, 16);
        key["pressure"] = json!(1e4);
        let refusal = json!({ "refused": PathEnd::NotGrown });
        store.put(&Digest::of_value(&key), &refusal).unwrap();
        assert_eq!(refused(solver(), 1e4), PathEnd::NotGrown);
        // And goes on behind one.
        let mut behind = solver();
        assert!(behind.point(hopeless).is_err());
        assert_eq!(behind.point(2e4).unwrap().pressure_mpa, 0.02);
    }

    /// The law of a rubber decides on its solves and is part of their identity, if the rubber names one.
    #[test]
    fn a_law_that_is_named_has_solves_of_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let store = SolveStore::open(folder.path()).unwrap();
        let wave = Wave { wavelength: 1e-3, amplitude: 1.5e-4, phase: 0.0 };
        let surface = Surface { kind: SurfaceKind::sines(1), realisation: 1, profile: vec![wave] };
        let (interrupted, parameters) = (Interrupt::default(), Fem::default());
        let watch = Watch { progress: &|_, _| {}, interrupted: &interrupted };
        let finite_strain = Rheology::ArrudaBoyce { locking_stretch: 1.5 };
        let named = Rubber { finite_strain, ..Rubber::table_2_1() };
        let [plain, named] = [Rubber::table_2_1(), named].map(RubberModel::from);
        let friction = |rubber: &RubberModel| {
            let mut solver =
                Solver::new(16, &parameters, rubber, &surface, 10.0, &store, watch).unwrap();
            solver.point(5e5).unwrap().friction_coefficient
        };
        let [a, b] = [&plain, &named].map(friction);
        assert!((a / b - 1.0).abs() > 1e-3, "{a} {b}");
        let key = |rubber: &RubberModel| problem(rubber, &surface, 10.0, 16);
        assert!(key(&plain).get("finite_strain").is_none());
        assert_eq!(key(&named)["finite_strain"], json!(finite_strain));
        // The half-space asks for no law.
        assert_eq!(kept::problem("bem", 1, &plain), kept::problem("bem", 1, &named));
    }

    /// Solves of a real curve: from the second to the third the area grows by a hundredth and friction by a
    /// seventh. As a function of the area it was -0.27 at 0.01.
    #[test]
    fn an_area_that_nearly_stands_still_gives_no_slope() {
        let solves = [
            solved(0.0956, 0.3187, 0.00831),
            solved(0.1196, 0.3852, 0.01328),
            solved(0.1494, 0.4413, 0.01342),
            solved(0.1868, 0.5138, 0.01784),
            solved(0.2335, 0.5850, 0.02157),
        ];
        let area_fractions = vec![0.005, 0.01, 0.0134, 0.02];
        let wanted = Wanted { area_fractions, pressures_mpa: Vec::new() };
        let rows = values_between(&wanted, &solves, |row| row);
        let areas: Vec<f64> = rows.iter().map(|row| row.contact_area_fraction).collect();
        assert_eq!(areas, [0.01, 0.0134, 0.02]);
        for pair in rows.windows(2) {
            assert!(pair[0].friction_coefficient < pair[1].friction_coefficient, "{rows:?}");
        }
        for row in &rows {
            assert!((0.31..0.59).contains(&row.friction_coefficient), "{row:?}");
            assert!(row.interpolation_error > 0.0 && row.interpolation_error < 0.1, "{row:?}");
        }
    }
}
