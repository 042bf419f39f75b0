//! One curve of friction over contact area: one areal surface at one speed in one direction.

use super::task::{Sweep, Task};
use super::{Areal, ArealCurveRow, ArealSolveRow, ArealUnsolvedRow, scale};
use crate::artifact::{ArrayDataset, ArtifactError, Attribute, Digest, SolveStore};
use crate::contact::areal::{ArealContact, ArealSetup, ArealSurface, Sliding};
use crate::contact::curve::{Accuracy, CurveError, friction_curve_within};
use crate::contact::refine::{AREAL, LEAST_CONTACT_POINTS, OnGrid, on_grid};
use crate::contact::{CurvePoint, CurveValue};
use crate::numerics::Interrupt;
use crate::rubber::{RubberModel, Viscoelastic};
use crate::stages::bem::{Given, solved};
use crate::stages::kept::{self, Kept};
use crate::stages::{SolveError, StageError};
use crate::units::Units;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::time::Instant;

/// Revision of the areal contact solver: part of the key of every stored solve. To be raised when the same problem gives
/// another number.
const SOLVER_REVISION: u32 = 1;

/// Fewest points along a direction of the coarser grids that tell the error.
const LEAST_POINTS: usize = 16;
/// Grids are multiples of eight points along each direction.
const MOST_HALVINGS: u32 = 3;
/// Root of 2 π: the area of a small contact of isotropic roughness is this many times the pressure over modulus and root mean
/// square gradient (Bush, Gibson & Thomas, doi:10.1016/0043-1648(75)90145-3).
const AREA_PER_PRESSURE: f64 = 2.506_628_274_631;

/// The solves, the curve and the fields of one task.
pub(crate) struct CurveResult {
    pub solves: Vec<ArealSolveRow>,
    pub curve: Vec<ArealCurveRow>,
    /// What the curve has no value for.
    pub unsolved: Vec<ArealUnsolvedRow>,
    /// The first reason why it has not.
    pub failure: Option<StageError>,
    pub fields: Vec<ArrayDataset>,
    /// Friction to which relative errors of the curve refer where friction is less.
    pub least_friction: f64,
}

/// Solves one surface at one speed in one direction and keeps what it solved.
pub(super) struct Curve<'a> {
    grids: Grids<'a>,
    kept: Kept<'a>,
    solves: Vec<ArealSolveRow>,
}

/// The contact on the grids that it is solved on.
struct Grids<'a> {
    task: &'a Task,
    rubber: &'a RubberModel,
    thickness: Option<f64>,
    /// Points of the finest grid.
    points: [usize; 2],
    /// Heights on the finest grid, sampled when first needed.
    heights: Option<Vec<f64>>,
    /// Contacts by how often the finest grid is halved, set up when first needed.
    contacts: BTreeMap<u32, ArealContact>,
    interrupted: &'a Interrupt,
}

/// Friction at what the recipe asks for, in its order.
#[derive(Default)]
pub(super) struct Computed {
    pub values: Vec<(Given, CurveValue)>,
    /// Areas and pressures in Pa without a value, and why.
    pub unsolved: Vec<(Given, f64, CurveError<SolveError>)>,
    pub fields: Vec<ArrayDataset>,
}

/// Values at some of the areas that were asked for, and why there is none at the others.
type Settled = (Vec<CurveValue>, Vec<(f64, CurveError<SolveError>)>);

impl<'a> Curve<'a> {
    pub fn new(
        sweep: &Sweep,
        rubber: &'a RubberModel,
        task: &'a Task,
        store: &'a SolveStore,
        interrupted: &'a Interrupt,
    ) -> Result<Self, ArtifactError> {
        Ok(Self {
            grids: Grids {
                task,
                rubber,
                thickness: sweep.areal.thickness_mm.map(Units::mm_to_m),
                points: sweep.areal.grid(&task.surface),
                heights: None,
                contacts: BTreeMap::new(),
                interrupted,
            },
            kept: Kept::open(store, problem(&sweep.areal, rubber, task), interrupted)?,
            solves: Vec::new(),
        })
    }

    /// Notes that every solve of a task is stored.
    pub fn finish(&mut self, task: &Digest) -> Result<(), ArtifactError> {
        self.kept.finish(task)
    }

    /// Friction at the areas, then at the pressures of the recipe, and the fields where they are asked for. What has no
    /// solution, or does not settle on a curve, is left out with the reason.
    ///
    /// # Errors
    /// Those that more than one value would have: the interrupt, the store, a problem that is none.
    pub fn compute(&mut self, sweep: &Sweep) -> Result<Computed, CurveError<SolveError>> {
        let Sweep { areal, wanted } = sweep;
        let mut computed = Computed::default();
        let (values, unsolved) = self.settled(&wanted.area_fractions, areal.tolerance)?;
        computed.values.extend(values.into_iter().map(|value| (Given::Area, value)));
        computed.unsolved.extend(unsolved.into_iter().map(|(area, why)| (Given::Area, area, why)));
        // The solves are in the store by now, so this second curve costs next to nothing.
        let (values, unsolved) = self.settled(&areal.field_area_fractions, areal.tolerance)?;
        for value in values {
            computed.fields.extend(self.grids.fields(&value).map_err(CurveError::Solve)?);
        }
        let known = |area: &f64| wanted.area_fractions.contains(area);
        let of_fields = unsolved.into_iter().filter(|(area, _)| !known(area));
        computed.unsolved.extend(of_fields.map(|(area, why)| (Given::Area, area, why)));
        for pressure in wanted.pressures_mpa.iter().map(|pressure| pressure.mpa_to_pa()) {
            match self.point(pressure) {
                Ok(point) => computed.values.push((Given::Pressure, solved(point))),
                Err(error) if error.is_no_solution() => {
                    computed.unsolved.push((Given::Pressure, pressure, CurveError::Solve(error)));
                }
                Err(error) => return Err(CurveError::Solve(error)),
            }
        }
        Ok(computed)
    }

    /// Friction at some areas: of all as one curve, or, where that does not settle, of each by itself.
    fn settled(
        &mut self,
        areas: &[f64],
        tolerance: f64,
    ) -> Result<Settled, CurveError<SolveError>> {
        match self.of_areas(areas, tolerance) {
            Ok(values) => Ok((values, Vec::new())),
            Err(error) if !is_no_value(&error) => Err(error),
            Err(error) if areas.len() == 1 => Ok((Vec::new(), vec![(areas[0], error)])),
            Err(_) => {
                let (mut values, mut unsolved) = Settled::default();
                for &area in areas {
                    match self.of_areas(&[area], tolerance) {
                        Ok(value) => values.extend(value),
                        Err(error) if is_no_value(&error) => unsolved.push((area, error)),
                        Err(error) => return Err(error),
                    }
                }
                Ok((values, unsolved))
            }
        }
    }

    fn of_areas(
        &mut self,
        areas: &[f64],
        tolerance: f64,
    ) -> Result<Vec<CurveValue>, CurveError<SolveError>> {
        let Some(&smallest) = areas.first() else { return Ok(Vec::new()) };
        let points = self.grids.points[0] * self.grids.points[1];
        if smallest * (points as f64) < LEAST_CONTACT_POINTS {
            return Err(CurveError::Solve(SolveError::Unresolved { area: smallest, points }));
        }
        let guess = self.first_guess(smallest);
        let accuracy = Accuracy { tolerance, least_friction: self.least_friction() };
        friction_curve_within(areas, accuracy, guess, |pressure| self.point(pressure))
    }

    /// Friction to which relative errors refer where friction is less, see [`scale`].
    pub fn least_friction(&self) -> f64 {
        let Task { surface, speed_mm_s, .. } = self.grids.task;
        scale::least_friction(&surface.map, self.grids.rubber, speed_mm_s.mm_to_m())
    }

    /// All solves of the curve by ascending pressure, each once.
    pub fn into_solves(mut self) -> Vec<ArealSolveRow> {
        self.solves.sort_by(|a, b| a.pressure_mpa.total_cmp(&b.pressure_mpa));
        self.solves.dedup_by(|a, b| a.pressure_mpa == b.pressure_mpa);
        self.solves
    }

    /// Pressure at which the area is about `area`, with the modulus at the frequency of the shortest wave. Only a start.
    fn first_guess(&self, area: f64) -> f64 {
        let Task { surface, speed_mm_s, .. } = self.grids.task;
        let frequency = TAU / surface.map.shortest * speed_mm_s.mm_to_m();
        let modulus = self.grids.rubber.reduced_modulus(frequency).norm();
        area * modulus * surface.map.roughness().rms_gradient / AREA_PER_PRESSURE
    }

    /// One pressure, with its error by coarser grids.
    fn point(&mut self, pressure: f64) -> Result<CurvePoint, SolveError> {
        let [nx, ny] = self.grids.points;
        // Coarser grids are every second point.
        let least = (nx >> MOST_HALVINGS).max(LEAST_POINTS * nx.div_ceil(ny.min(nx)));
        let refined = on_grid(
            nx,
            least,
            AREAL,
            |points| self.solve(pressure, (nx / points).ilog2()),
            SolveError::is_no_solution,
            |row| OnGrid {
                points: (row.points_x * row.points_y) as usize,
                friction_coefficient: row.friction_coefficient,
                contact_area_fraction: row.contact_area_fraction,
            },
        )?;
        let discretisation_error = refined.error.map(|error| error.friction_coefficient);
        let row = ArealSolveRow { discretisation_error, ..refined.solution };
        let point = CurvePoint {
            mean_pressure: pressure,
            contact_area_fraction: row.contact_area_fraction,
            friction_coefficient: row.friction_coefficient,
            error: refined.error,
        };
        self.solves.push(row);
        Ok(point)
    }

    /// One solve on the finest grid, or one that is halved so often.
    fn solve(&mut self, pressure: f64, halvings: u32) -> Result<ArealSolveRow, SolveError> {
        let Self { grids, kept, .. } = self;
        let values = [("pressure", json!(pressure)), ("halvings", json!(halvings))];
        let row = kept.take_or(&values, || grids.solve(pressure, halvings))?;
        // The method and the number of the realisation are no part of the problem.
        let (kind, realisation) = (grids.task.surface.kind, grids.task.surface.realisation);
        Ok(ArealSolveRow { kind, realisation, ..row })
    }
}

impl Grids<'_> {
    fn solve(&mut self, pressure: f64, halvings: u32) -> Result<ArealSolveRow, SolveError> {
        let start = Instant::now();
        let contact = self.contact(halvings)?;
        let points = contact.points();
        let solution = contact.solve(pressure)?;
        let Task { surface, speed_mm_s, angle_deg } = self.task;
        Ok(ArealSolveRow {
            kind: surface.kind,
            realisation: surface.realisation,
            speed_mm_s: *speed_mm_s,
            angle_deg: *angle_deg,
            pressure_mpa: pressure.pa_to_mpa(),
            friction_coefficient: solution.friction_coefficient,
            lateral_coefficient: solution.lateral_coefficient,
            hysteretic_friction: solution.hysteretic_friction,
            contact_area_fraction: solution.contact_area_fraction,
            mean_separation_mm: solution.mean_separation.m_to_mm(),
            discretisation_error: None,
            residual: solution.residual,
            iterations: solution.iterations as u64,
            points_x: points[0] as u64,
            points_y: points[1] as u64,
            seconds: start.elapsed().as_secs_f64(),
        })
    }

    fn contact(&mut self, halvings: u32) -> Result<&mut ArealContact, SolveError> {
        use std::collections::btree_map::Entry;
        let (task, [nx, ny]) = (self.task, self.points);
        let heights = self.heights.get_or_insert_with(|| task.surface.map.sample([nx, ny]));
        match self.contacts.entry(halvings) {
            Entry::Occupied(contact) => Ok(contact.into_mut()),
            Entry::Vacant(place) => {
                let step = 1 << halvings;
                let rows = heights.chunks_exact(nx).step_by(step);
                let heights: Vec<f64> =
                    rows.flat_map(|row| row.iter().step_by(step)).copied().collect();
                let setup = ArealSetup {
                    rubber: self.rubber,
                    sliding: Sliding {
                        speed: task.speed_mm_s.mm_to_m(),
                        angle: task.angle_deg.to_radians(),
                    },
                    surface: ArealSurface {
                        heights: &heights,
                        points: [nx >> halvings, ny >> halvings],
                        periods: task.surface.map.periods,
                    },
                    thickness: self.thickness,
                    memory_limit: None,
                };
                Ok(place.insert(ArealContact::new_interruptible(&setup, self.interrupted)?))
            }
        }
    }

    /// Pressure and separation at the pressure of a value, as datasets.
    fn fields(&mut self, value: &CurveValue) -> Result<[ArrayDataset; 2], SolveError> {
        let solution = self.contact(0)?.solve(value.mean_pressure)?;
        let Task { surface, speed_mm_s, angle_deg } = self.task;
        let float = |name: &str, value: f64| (name.to_owned(), Attribute::Float(value));
        let integer = |name: &str, value: i64| (name.to_owned(), Attribute::Integer(value));
        let attributes = BTreeMap::from([
            integer("points_x", self.points[0] as i64),
            integer("points_y", self.points[1] as i64),
            float("period_x_m", surface.map.periods[0]),
            float("period_y_m", surface.map.periods[1]),
            float("angle_deg", *angle_deg),
            float("speed_mm_s", *speed_mm_s),
            ("method".to_owned(), Attribute::Text(surface.kind.method.name().to_owned())),
            integer("realisation", i64::from(surface.realisation)),
            float("mean_pressure_pa", solution.mean_pressure),
            float("contact_area_fraction", solution.contact_area_fraction),
            float("friction_coefficient", solution.friction_coefficient),
        ]);
        let group = format!(
            "{}/realisation_{}/speed_{speed_mm_s}_mm_s/angle_{angle_deg}/area_{}",
            surface.kind.file_name(),
            surface.realisation,
            value.contact_area_fraction
        );
        let dataset = |name: &str, unit: &str, values: Vec<f64>| ArrayDataset {
            name: format!("{group}/{name}"),
            unit: unit.to_owned(),
            attributes: attributes.clone(),
            values,
        };
        Ok([
            dataset("pressure", "Pa", solution.pressure),
            dataset("separation", "m", solution.separation),
        ])
    }
}

/// Whether a curve has no value for a reason of its own, that other curves need not have.
fn is_no_value(error: &CurveError<SolveError>) -> bool {
    match error {
        CurveError::Solve(error) => error.is_no_solution(),
        CurveError::NotSmooth { .. } | CurveError::NotBracketed { .. } => true,
        CurveError::Targets(_) => false,
    }
}

/// What all solves of a curve have in common.
pub(super) fn problem(parameters: &Areal, rubber: &RubberModel, task: &Task) -> Value {
    let mut problem = kept::problem("areal", SOLVER_REVISION, rubber);
    let map = &task.surface.map;
    let bytes: Vec<u8> = map.heights.iter().flat_map(|z| z.to_le_bytes()).collect();
    problem["heights"] = json!(Digest::of_bytes(&bytes));
    problem["points"] = json!(map.points);
    problem["periods"] = json!(map.periods);
    problem["grid"] = json!(parameters.grid(&task.surface));
    problem["thickness_mm"] = json!(parameters.thickness_mm);
    problem["speed_mm_s"] = json!(task.speed_mm_s);
    problem["angle_deg"] = json!(task.angle_deg);
    problem
}
