//! One curve of friction over contact area: one surface at one speed.

use super::{Bem, Given, SolveRow};
use crate::artifact::{ArrayDataset, ArtifactError, Attribute, Digest, SolveStore};
use crate::contact::curve::{CurveError, friction_curve};
use crate::contact::refine::{
    GridError, HALF_SPACE, LEAST_CONTACT_POINTS, OnGrid, RefineError, Refined, Refinement, Watched,
    on_grid,
};
use crate::contact::sliding::POINTS_RANGE;
use crate::contact::{ContactError, ContactSolution, CurvePoint, CurveValue, SlidingContact};
use crate::numerics::Interrupt;
use crate::rubber::{RubberModel, Viscoelastic};
use crate::stages::SolveError;
use crate::stages::kept::{self, Kept};
use crate::stages::realise::Surface;
use crate::surface::wave;
use crate::units::Units;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::time::Instant;

/// Revision of the contact solver: part of the key of every stored solve. To be raised when the
/// same problem gives another number.
const SOLVER_REVISION: u32 = 4;

/// Of the coarsest grid where an accuracy is asked for; three grids make an estimate.
const FIRST_POINTS_PER_WAVE: u32 = 8;
/// No grid is finer where an accuracy is asked for.
const MOST_POINTS: usize = 1 << 22;
/// The grid may be refined this many times for small contacts.
const MOST_REFINEMENTS: u32 = 4;
/// Coarser grids that tell the error of one, each of half the points.
const MOST_HALVINGS: u32 = 3;

/// Solves one surface at one speed and keeps what it solved.
pub(crate) struct Curve<'a> {
    grids: Grids<'a>,
    kept: Kept<'a>,
    rule: GridRule,
    solves: Vec<SolveRow>,
}

/// How fine the grids of the contacts of a surface are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct GridRule {
    fewest_contact_points: f64,
    grid_tolerance: Option<f64>,
    /// Points of the one grid without a tolerance.
    base_points: usize,
    /// Points of the coarsest grid with one.
    first_points: usize,
}

/// The contact of one surface at one speed on the grids that it is solved on.
struct Grids<'a> {
    rubber: &'a RubberModel,
    surface: &'a Surface,
    speed_mm_s: f64,
    period: f64,
    interrupted: &'a Interrupt,
    /// Contacts by their number of grid points, set up when first needed.
    contacts: BTreeMap<usize, SlidingContact>,
}

/// Friction at what was wanted, in the order of the recipe, and the fields.
type Computed = (Vec<(Given, CurveValue)>, Vec<FieldSolution>);

/// Fields of a contact at a wanted area.
pub(super) struct FieldSolution {
    group: String,
    area_fraction: f64,
    spacing: f64,
    solution: ContactSolution,
}

impl<'a> Curve<'a> {
    pub fn new(
        parameters: &Bem,
        rubber: &'a RubberModel,
        surface: &'a Surface,
        speed_mm_s: f64,
        store: &'a SolveStore,
        interrupted: &'a Interrupt,
    ) -> Result<Self, ArtifactError> {
        let (period, contacts) = (surface.period(), BTreeMap::new());
        Ok(Self {
            grids: Grids { rubber, surface, speed_mm_s, period, interrupted, contacts },
            kept: Kept::open(store, problem(rubber, surface, speed_mm_s), interrupted)?,
            rule: GridRule::new(parameters, surface),
            solves: Vec::new(),
        })
    }

    /// Notes that every solve of a task is stored.
    pub fn finish(&mut self, task: &Digest) -> Result<(), ArtifactError> {
        self.kept.finish(task)
    }

    /// Friction at the wanted areas, then at the wanted pressures, and the fields where they are wanted.
    pub(super) fn compute(&mut self, parameters: &Bem) -> Result<Computed, CurveError<SolveError>> {
        let mut at_pressures = Vec::with_capacity(parameters.pressures_mpa.len());
        for pressure_mpa in &parameters.pressures_mpa {
            let point = self.point(pressure_mpa.mpa_to_pa()).map_err(CurveError::Solve)?;
            at_pressures.push((Given::Pressure, solved(point)));
        }
        let Some(&smallest) = parameters.area_fractions.first() else {
            return Ok((at_pressures, Vec::new()));
        };
        let finest = self.rule.base_points << MOST_REFINEMENTS;
        if self.rule.grid_tolerance.is_none() && smallest * (finest as f64) < LEAST_CONTACT_POINTS {
            let unresolved = SolveError::Unresolved { area: smallest, points: finest };
            return Err(CurveError::Solve(unresolved));
        }
        let guess = self.first_guess(smallest);
        let curve = |targets: &[f64], this: &mut Self| {
            friction_curve(targets, parameters.interpolation_tolerance(), guess, |p| this.point(p))
        };
        let values = curve(&parameters.area_fractions, self)?;
        let mut values: Vec<_> = values.into_iter().map(|value| (Given::Area, value)).collect();
        values.extend(at_pressures);
        if parameters.field_area_fractions.is_empty() {
            return Ok((values, Vec::new()));
        }
        // The solves are in the store by now, so this second curve costs next to nothing.
        let wanted = curve(&parameters.field_area_fractions, self)?;
        let fields = wanted.iter().map(|value| self.field(value)).collect::<Result<_, _>>();
        Ok((values, fields.map_err(CurveError::Solve)?))
    }

    /// All solves of the curve by ascending pressure, each once.
    pub fn into_solves(mut self) -> Vec<SolveRow> {
        self.solves.sort_by(|a, b| a.pressure_mpa.total_cmp(&b.pressure_mpa));
        self.solves.dedup_by(|a, b| a.pressure_mpa == b.pressure_mpa);
        self.solves
    }

    /// Pressure at which the area is about `area`: an elastic rough contact of small area carries
    /// `p = A |E_r| h' / 2` (slope of Bush, Gibson & Thomas, doi:10.1016/0043-1648(75)90145-3),
    /// taken with the modulus at the frequency of the steepest wave. Only a start.
    fn first_guess(&self, area: f64) -> f64 {
        let slope = |wave: &wave::Wave| wave.amplitude / wave.wavelength;
        let Grids { rubber, surface, speed_mm_s, .. } = &self.grids;
        let profile = &surface.profile;
        let Some(steepest) = profile.iter().max_by(|a, b| slope(a).total_cmp(&slope(b))) else {
            return 1e5;
        };
        let frequency = (TAU / steepest.wavelength * speed_mm_s).mm_to_m();
        let rms_slope = profile.iter().map(|w| (TAU * slope(w)).powi(2) / 2.0).sum::<f64>().sqrt();
        0.5 * area * rubber.reduced_modulus(frequency).norm() * rms_slope
    }

    /// One pressure, on a grid that is fine enough for its contact.
    fn point(&mut self, pressure: f64) -> Result<CurvePoint, SolveError> {
        let (row, error) = self.contact(pressure)?;
        Ok(self.keep(row, error))
    }

    /// The contact at a pressure in Pa on a grid that is fine enough for it, with its errors by the grid.
    pub fn contact(&mut self, pressure: f64) -> Result<(SolveRow, Option<GridError>), SolveError> {
        let rule = self.rule;
        let refined = rule.refined(pressure, |points| self.solve(pressure, points), on_its_grid)?;
        let discretisation_error = refined.error.map(|error| error.friction_coefficient);
        Ok((SolveRow { discretisation_error, ..refined.solution }, refined.error))
    }

    fn keep(&mut self, row: SolveRow, error: Option<GridError>) -> CurvePoint {
        let point = CurvePoint {
            mean_pressure: row.pressure_mpa.mpa_to_pa(),
            contact_area_fraction: row.contact_area_fraction,
            friction_coefficient: row.friction_coefficient,
            error,
        };
        self.solves.push(row);
        point
    }

    /// One solve on so many grid points.
    fn solve(&mut self, pressure: f64, points: usize) -> Result<SolveRow, SolveError> {
        let Self { grids, kept, .. } = self;
        let values = [("pressure", json!(pressure)), ("points", json!(points))];
        let row = kept.take_or(&values, || grids.solve(pressure, points))?;
        // The name of the approximation and the number of the realisation are no part of the
        // problem, so the same surface may have been solved under others.
        let (kind, realisation) = (grids.surface.kind, grids.surface.realisation);
        Ok(SolveRow { kind, realisation, ..row })
    }

    fn field(&mut self, value: &CurveValue) -> Result<FieldSolution, SolveError> {
        let points = self.rule.base_points;
        let grids = &mut self.grids;
        let solution = grids.contact(points)?.solve(value.mean_pressure)?;
        let area_fraction = value.contact_area_fraction;
        let Surface { kind, realisation, .. } = grids.surface;
        let group = format!(
            "{}/realisation_{realisation}/speed_{}_mm_s/area_{area_fraction}",
            kind.file_name(),
            grids.speed_mm_s
        );
        Ok(FieldSolution { group, area_fraction, spacing: grids.period / points as f64, solution })
    }
}

impl GridRule {
    /// That of the stage for a surface.
    pub fn new(parameters: &Bem, surface: &Surface) -> Self {
        Self {
            fewest_contact_points: f64::from(parameters.fewest_contact_points),
            grid_tolerance: parameters.grid_tolerance,
            base_points: base_points(parameters, surface),
            first_points: points(surface, FIRST_POINTS_PER_WAVE),
        }
    }

    /// Points of the grid of a contact that is not small.
    pub fn usual_points(&self) -> usize {
        self.base_points
    }

    /// Points of the coarsest grid that is solved.
    pub fn coarsest_points(&self) -> usize {
        match self.grid_tolerance {
            Some(_) => self.first_points,
            None => (self.base_points >> MOST_HALVINGS).max(*POINTS_RANGE.start()),
        }
    }

    /// A contact at a pressure in Pa on a grid that is fine enough for it: doubled to the accuracy that is asked for, or, without
    /// one, the usual grid, doubled while the contact has too few points, and judged by three coarser ones.
    pub fn refined<S>(
        &self,
        pressure: f64,
        mut solve: impl FnMut(usize) -> Result<S, SolveError>,
        view: impl Fn(&S) -> OnGrid,
    ) -> Result<Refined<S>, SolveError> {
        let Some(tolerance) = self.grid_tolerance else {
            let points = self.sufficient_points(&mut solve, &view)?;
            let least = *POINTS_RANGE.start();
            return on_grid(points, least, HALF_SPACE, solve, SolveError::is_no_solution, view);
        };
        let refinement = Refinement {
            tolerance,
            watched: Watched::FrictionOverArea,
            orders: HALF_SPACE,
            first: self.first_points,
            most: MOST_POINTS,
        };
        refinement.run(|points| solve(points).map(Some), view).map_err(|error| match error {
            RefineError::Solve(error) => error,
            unreached @ RefineError::NotReached { .. } => {
                SolveError::Accuracy { pressure, reason: unreached.to_string() }
            }
        })
    }

    /// The usual grid, doubled while the contact has too few points.
    fn sufficient_points<S>(
        &self,
        solve: &mut impl FnMut(usize) -> Result<S, SolveError>,
        view: &impl Fn(&S) -> OnGrid,
    ) -> Result<usize, SolveError> {
        let mut points = self.base_points;
        for _ in 0..MOST_REFINEMENTS {
            let found = view(&solve(points)?);
            if found.contact_area_fraction * points as f64 >= self.fewest_contact_points {
                break;
            }
            points *= 2;
        }
        Ok(points)
    }
}

impl Grids<'_> {
    fn solve(&mut self, pressure: f64, points: usize) -> Result<SolveRow, SolveError> {
        let start = Instant::now();
        let solution = self.contact(points)?.solve(pressure)?;
        Ok(SolveRow {
            kind: self.surface.kind,
            realisation: self.surface.realisation,
            speed_mm_s: self.speed_mm_s,
            pressure_mpa: pressure.pa_to_mpa(),
            friction_coefficient: solution.friction_coefficient,
            hysteretic_friction: solution.hysteretic_friction,
            contact_area_fraction: solution.contact_area_fraction,
            mean_separation_mm: solution.mean_separation.m_to_mm(),
            discretisation_error: None,
            residual: solution.residual,
            iterations: solution.iterations as u64,
            grid_points: points as u64,
            seconds: start.elapsed().as_secs_f64(),
        })
    }

    fn contact(&mut self, points: usize) -> Result<&mut SlidingContact, SolveError> {
        use std::collections::btree_map::Entry;
        match self.contacts.entry(points) {
            Entry::Occupied(contact) => Ok(contact.into_mut()),
            Entry::Vacant(place) => {
                // Checked before the heights are sampled: they might not fit into the memory.
                if !POINTS_RANGE.contains(&points) {
                    return Err(ContactError::OutOfRange {
                        quantity: "the number of grid points \
                                   (bem.points_per_shortest_wavelength for each shortest wave of a period)",
                        value: points as f64,
                        range: "8 to 16777216",
                    }
                    .into());
                }
                let goes_on = || !self.interrupted.is_set();
                let heights =
                    wave::sample_while(&self.surface.profile, self.period, points, goes_on)
                        .ok_or(SolveError::Interrupted)?;
                let speed = self.speed_mm_s.mm_to_m();
                Ok(place.insert(SlidingContact::new_interruptible(
                    self.rubber,
                    speed,
                    self.period,
                    &heights,
                    self.interrupted,
                )?))
            }
        }
    }
}

/// Points of the grid of a surface that all pressures are solved on, unless their contacts need more.
pub(super) fn base_points(parameters: &Bem, surface: &Surface) -> usize {
    points(surface, parameters.points_per_shortest_wavelength)
}

/// Points of a grid with so many on the shortest wave: the next power of two.
fn points(surface: &Surface, per_wave: u32) -> usize {
    let present = surface.profile.iter().filter(|wave| wave.amplitude != 0.0);
    let shortest = present.map(|wave| wave.wavelength).fold(f64::INFINITY, f64::min);
    ((f64::from(per_wave) * surface.period() / shortest).round() as usize).next_power_of_two()
}

/// What all solves of a curve have in common.
pub(super) fn problem(rubber: &RubberModel, surface: &Surface, speed_mm_s: f64) -> Value {
    let mut problem = kept::problem("bem", SOLVER_REVISION, rubber);
    problem["profile"] = json!(surface.profile);
    problem["speed_mm_s"] = json!(speed_mm_s);
    problem
}

/// A value at a pressure that was solved itself.
pub(crate) fn solved(point: CurvePoint) -> CurveValue {
    CurveValue {
        contact_area_fraction: point.contact_area_fraction,
        mean_pressure: point.mean_pressure,
        friction_coefficient: point.friction_coefficient,
        interpolation_error: 0.0,
        discretisation_error: point.error.map(|error| error.friction_coefficient),
        relative_area_error: point
            .error
            .map(|error| error.contact_area_fraction / point.contact_area_fraction),
    }
}

fn on_its_grid(row: &SolveRow) -> OnGrid {
    OnGrid {
        points: row.grid_points as usize,
        friction_coefficient: row.friction_coefficient,
        contact_area_fraction: row.contact_area_fraction,
    }
}

impl FieldSolution {
    /// The fields as datasets.
    pub fn datasets(&self) -> Vec<ArrayDataset> {
        let attributes = BTreeMap::from([
            ("spacing_m".to_owned(), Attribute::Float(self.spacing)),
            ("mean_pressure_pa".to_owned(), Attribute::Float(self.solution.mean_pressure)),
            ("wanted_area_fraction".to_owned(), Attribute::Float(self.area_fraction)),
            (
                "contact_area_fraction".to_owned(),
                Attribute::Float(self.solution.contact_area_fraction),
            ),
            (
                "friction_coefficient".to_owned(),
                Attribute::Float(self.solution.friction_coefficient),
            ),
            ("mean_separation_m".to_owned(), Attribute::Float(self.solution.mean_separation)),
        ]);
        let dataset = |name: &str, unit: &str, values: &[f64]| ArrayDataset {
            name: format!("{}/{name}", self.group),
            unit: unit.to_owned(),
            attributes: attributes.clone(),
            values: values.to_vec(),
        };
        vec![
            dataset("pressure", "Pa", &self.solution.pressure),
            dataset("separation", "m", &self.solution.separation),
        ]
    }
}
