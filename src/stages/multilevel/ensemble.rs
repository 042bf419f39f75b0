//! The realisations of one approximation at one speed under both models.

use super::bound::negligible;
use super::estimate::{Estimate, Spread, differences, mean, variance};
use super::rows::{AverageRow, PairRow};
use super::shares::{Costs, Goal, Shares, choose};
use super::{HalfSpace, Multilevel};
use crate::contact::refine::LEAST_FRICTION;
use crate::stages::bem::Given;
use crate::stages::bem::{Bem, CurveRow};
use crate::stages::fem::{self, FemCurve, FemCurveRow, FemSolveRow};
use crate::stages::micro::is_of;
use crate::stages::realise::Surface;
use crate::stages::realise::SurfaceKind;
use crate::units::Units;

/// One approximation at one speed.
pub(super) struct Ensemble<'a> {
    pub speed_mm_s: f64,
    /// All its surfaces.
    pub surfaces: &'a [Surface],
    /// Half-space curves of the first of them.
    pub half_space: Vec<Vec<CurveRow>>,
    /// How many of these are those of `bem`.
    from_bem: usize,
    /// Finite-element curves of the first of them.
    pub full: Vec<FemCurve>,
    /// Numbers that are wanted.
    pub wanted: Shares,
    most: Shares,
    costs: Costs,
    tolerance: Option<f64>,
    /// Bound of the relative difference of the models, if it is small enough to do without finite
    /// elements.
    negligible: Option<f64>,
    area_fractions: &'a [f64],
}

/// Friction, pressure and errors of both models at one contact area.
struct AtArea<'a> {
    half_space: Vec<&'a CurveRow>,
    full: Vec<&'a FemCurveRow>,
}

impl<'a> Ensemble<'a> {
    pub fn new(
        parameters: &Multilevel,
        bem: &'a Bem,
        surfaces: &'a [Surface],
        speed_mm_s: f64,
        results: &HalfSpace,
    ) -> Self {
        let curve = |surface: &Surface| -> Vec<CurveRow> {
            let own = results
                .curves
                .iter()
                .filter(|row| row.given == Given::Area && is_of(row, surface, speed_mm_s));
            own.cloned().collect()
        };
        let curves = surfaces.iter().map(curve);
        let half_space: Vec<Vec<CurveRow>> = curves.take_while(|rows| !rows.is_empty()).collect();
        let first = &surfaces[0];
        let negligible = bem.average_tolerance.and_then(|tolerance| negligible(first, tolerance));
        let solved = half_space.len();
        // Only a tolerance asks for more than the half-space has.
        let all = if bem.average_tolerance.is_some() { surfaces.len() } else { solved };
        let [begin, end] = [parameters.first_realisations, parameters.most_realisations]
            .map(|count| if negligible.is_some() { 0 } else { count as usize });
        let own = |row: &&_| is_own(row, first.kind, speed_mm_s);
        let mesh = fem::cost(&parameters.fem(), first);
        let solves = results.solves.iter().filter(own);
        Self {
            speed_mm_s,
            surfaces,
            from_bem: solved,
            half_space,
            full: Vec::new(),
            wanted: Shares { half_space: solved, pairs: begin.min(solved) },
            most: Shares { half_space: all, pairs: end.min(all) },
            costs: Costs::new(solves, solved, mesh, &parameters.fem(), bem),
            tolerance: bem.average_tolerance,
            negligible,
            area_fractions: &bem.area_fractions,
        }
    }

    /// The surfaces whose half-space curves are wanted and not there.
    pub fn open_half_space(&self) -> &'a [Surface] {
        &self.surfaces[self.half_space.len()..self.wanted.half_space]
    }

    /// The surfaces whose finite-element curves are wanted and not there. Their half-space curves are
    /// needed first, and are there: pairs come after the half-space.
    pub fn open_pairs(&self) -> &'a [Surface] {
        &self.surfaces[self.full.len()..self.wanted.pairs]
    }

    pub fn is_complete(&self) -> bool {
        self.open_half_space().is_empty() && self.open_pairs().is_empty()
    }

    /// The curve as a task of the finite elements.
    pub fn fem_task(&self, surface: &Surface) -> Option<fem::Task> {
        let curve = self.half_space.get(surface.realisation as usize - 1)?;
        let first_guess = curve.first()?.pressure_mpa.mpa_to_pa();
        Some(fem::Task { surface: surface.clone(), speed_mm_s: self.speed_mm_s, first_guess })
    }

    /// Raises the wanted numbers where the intervals are too wide for the tolerance.
    pub fn extend(&mut self) {
        let Some(tolerance) = self.tolerance else { return };
        let (mut goals, mut missed) = (Vec::new(), false);
        for at in self.at_areas() {
            let average = self.average(&at);
            let wanted = tolerance * average.friction_coefficient.abs().max(LEAST_FRICTION);
            let others = average.interpolation_error
                + average.discretisation_error.unwrap_or(0.0)
                + average.left_out_error
                + average.model_error;
            let half_width = wanted - others;
            // More realisations do not mend what mesh and interpolation take.
            if half_width > 0.0 {
                missed |= average.confidence_95.is_none_or(|width| width > half_width);
                let (half_space, full) = at.friction();
                goals.push(Goal { spread: Spread::new(&half_space, &full), half_width });
            }
        }
        if missed && let Some(next) = choose(&goals, self.wanted, self.most, self.costs) {
            self.wanted = next;
        }
    }

    /// The areas at which every pair has a value.
    fn at_areas(&self) -> impl Iterator<Item = AtArea<'_>> {
        let at_area = |(k, area): (usize, &f64)| {
            let of_full = |curve: &'_ FemCurve| {
                curve.rows.iter().position(|row| row.contact_area_fraction == *area)
            };
            let full = self.full.iter().map(|curve| Some(&curve.rows[of_full(curve)?]));
            Some(AtArea {
                half_space: self.half_space.iter().map(|curve| &curve[k]).collect(),
                full: full.collect::<Option<_>>()?,
            })
        };
        self.area_fractions.iter().enumerate().filter_map(at_area)
    }

    fn average(&self, at: &AtArea) -> AverageRow {
        let (half_space, full) = at.friction();
        let estimate = Estimate::new(&half_space, &full);
        let present = |value: f64| value.is_finite().then_some(value);
        let difference = differences(&half_space, &full);
        let confidence_95 = present(estimate.confidence_95);
        let (interpolation_error, discretisation_error) = at.solver_errors();
        let model_error = self.negligible.unwrap_or(0.0) * estimate.mean.abs();
        let left_out_error = at.left_out_error();
        let others = interpolation_error + left_out_error + model_error;
        let known = discretisation_error.zip(confidence_95);
        AverageRow {
            kind: self.surfaces[0].kind,
            speed_mm_s: self.speed_mm_s,
            contact_area_fraction: at.half_space[0].contact_area_fraction,
            pressure_mpa: at.pressure(),
            friction_coefficient: estimate.mean,
            half_space_realisations: half_space.len() as u32,
            pairs: full.len() as u32,
            half_space_mean: mean(&half_space),
            mean_difference: present(mean(&difference)),
            half_space_deviation: present(variance(&half_space).sqrt()),
            difference_deviation: present(variance(&difference).sqrt()),
            confidence_95,
            degrees_of_freedom: present(estimate.degrees_of_freedom),
            interpolation_error,
            discretisation_error,
            left_out_error,
            model_error,
            error_estimate: known.map(|(mesh, width)| others + mesh + width),
        }
    }

    pub fn averages(&self) -> Vec<AverageRow> {
        self.at_areas().map(|at| self.average(&at)).collect()
    }

    pub fn pairs(&self) -> Vec<PairRow> {
        let pair = |half_space: &CurveRow, full: &FemCurveRow| PairRow {
            kind: full.kind,
            realisation: full.realisation,
            speed_mm_s: full.speed_mm_s,
            contact_area_fraction: full.contact_area_fraction,
            pressure_half_space_mpa: half_space.pressure_mpa,
            pressure_finite_deformation_mpa: full.pressure_mpa,
            friction_half_space: half_space.friction_coefficient,
            friction_finite_deformation: full.friction_coefficient,
            difference: full.friction_coefficient - half_space.friction_coefficient,
            interpolation_error: full.interpolation_error,
            discretisation_error: full.discretisation_error,
        };
        let of_one = |(full, half_space): (&FemCurve, &Vec<CurveRow>)| -> Vec<PairRow> {
            let same = |row: &FemCurveRow| {
                let area = row.contact_area_fraction;
                half_space.iter().find(|other| other.contact_area_fraction == area)
            };
            full.rows.iter().filter_map(|row| Some(pair(same(row)?, row))).collect()
        };
        self.full.iter().zip(&self.half_space).flat_map(of_one).collect()
    }

    /// Half-space curves beyond those of `bem`.
    pub fn further(&self) -> impl Iterator<Item = &CurveRow> {
        self.half_space[self.from_bem..].iter().flatten()
    }

    pub fn solves(&self) -> impl Iterator<Item = &FemSolveRow> {
        self.full.iter().flat_map(|curve| &curve.solves)
    }

    pub fn warnings(&self) -> Vec<String> {
        let mut warnings: Vec<String> =
            self.full.iter().flat_map(|curve| curve.warnings.iter().cloned()).collect();
        let averages = self.averages();
        let (kind, speed) = (self.surfaces[0].kind, self.speed_mm_s);
        let unreached = self.area_fractions.len() - averages.len();
        if unreached > 0 {
            warnings.push(format!(
                "{kind}, {speed} mm/s: {unreached} of {} areas have no average: the finite elements do \
                 not reach them in every realisation",
                self.area_fractions.len()
            ));
        }
        warnings.extend(self.tolerance.and_then(|tolerance| self.missed(tolerance, &averages)));
        warnings
    }

    fn missed(&self, tolerance: f64, averages: &[AverageRow]) -> Option<String> {
        let relative = |row: &AverageRow| {
            let error = row.error_estimate.unwrap_or(f64::INFINITY);
            error / row.friction_coefficient.abs().max(LEAST_FRICTION)
        };
        let worst = averages.iter().max_by(|a, b| relative(a).total_cmp(&relative(b)))?;
        let count = averages.iter().filter(|row| relative(row) > tolerance).count();
        let share = |error: Option<f64>| {
            error.map_or_else(
                || "not known".into(),
                |error| format!("{:.1} %", 100.0 * error / worst.friction_coefficient.abs()),
            )
        };
        (count > 0).then(|| {
            format!(
                "{}, {} mm/s: the error of {count} of {} averages exceeds the tolerance {tolerance}: at \
                 area {} it is {} of the friction, {} of it by {} realisations and {} pairs, {} by the mesh \
                 (multilevel.most_realisations, realise.most_realisations, \
                 multilevel.columns_per_shortest_wavelength)",
                worst.kind,
                worst.speed_mm_s,
                averages.len(),
                worst.contact_area_fraction,
                share(worst.error_estimate),
                share(worst.confidence_95),
                worst.half_space_realisations,
                worst.pairs,
                share(worst.discretisation_error),
            )
        })
    }
}

fn is_own(row: &crate::stages::bem::SolveRow, kind: SurfaceKind, speed_mm_s: f64) -> bool {
    row.kind == kind && row.speed_mm_s == speed_mm_s
}

impl AtArea<'_> {
    /// Friction of the half-space and at finite deformation.
    fn friction(&self) -> (Vec<f64>, Vec<f64>) {
        (
            self.half_space.iter().map(|row| row.friction_coefficient).collect(),
            self.full.iter().map(|row| row.friction_coefficient).collect(),
        )
    }

    fn pressure(&self) -> f64 {
        let half_space: Vec<f64> = self.half_space.iter().map(|row| row.pressure_mpa).collect();
        let full: Vec<f64> = self.full.iter().map(|row| row.pressure_mpa).collect();
        Estimate::new(&half_space, &full).mean
    }

    /// Mean errors by interpolation and by mesh or grid, of the model whose errors do not cancel.
    fn solver_errors(&self) -> (f64, Option<f64>) {
        let (interpolation, mesh): (Vec<f64>, Vec<Option<f64>>) = if self.full.is_empty() {
            let rows = self.half_space.iter();
            rows.map(|row| (row.interpolation_error, row.discretisation_error)).unzip()
        } else {
            let rows = self.full.iter();
            rows.map(|row| (row.interpolation_error, row.discretisation_error)).unzip()
        };
        let mesh: Option<Vec<f64>> = mesh.into_iter().collect();
        (mean(&interpolation), mesh.map(|mesh| mean(&mesh)))
    }

    /// Waves that are left out change the mean of the half-space in proportion to the realisations without
    /// them, and that of the pairs likewise; the difference of both stays.
    fn left_out_error(&self) -> f64 {
        let errors: Vec<f64> = self.half_space.iter().map(|row| row.left_out_error).collect();
        let pairs = &errors[..self.full.len()];
        let of_pairs = if pairs.is_empty() { 0.0 } else { mean(pairs) };
        (mean(&errors) - of_pairs).abs()
    }
}
