//! The fixed point between a line contact and the moduli of its waves.

use super::strain::strain_of_waves;
use super::{EffectiveError, EffectiveRubber, FeedbackSetup, HeatFeedback, StrainLaw, WaveFactors};
use crate::contact::half_space::wave_moduli;
use crate::contact::{ContactError, ContactSolution, SlidingContact};
use crate::heat::{HeatSource, LineLoad, Temperatures};
use crate::numerics::anderson::Anderson;
use crate::rubber::{RubberError, Viscoelastic};
use std::f64::consts::TAU;

/// Times that a temperature or a strain beyond the law is halved, on the way to the fixed point.
const MOST_HALVINGS: i32 = 40;
/// Change of moduli and of friction or area below which the last contact is near the next one.
const NEAR: f64 = 0.1;
/// Times that a step to moduli at unknown frequencies is halved.
const MOST_RETREATS: usize = 6;

/// A contact whose moduli follow from its heat and its strain.
pub struct FeedbackContact<'a> {
    setup: FeedbackSetup<'a>,
    wavenumber: Vec<f64>,
    /// The contact without feedback.
    plain: SlidingContact,
}

/// Heat of a contact whose fixed point was found; temperatures are rises in K over that before sliding.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatReport {
    /// Power `mu p v` of the hysteretic friction in W/m², by the spectrum of the pressure.
    pub power: f64,
    /// Integral of the heat source in W/m².
    pub heat: f64,
    /// Power of the shear stress in contact in W/m².
    pub shear_power: f64,
    /// Heat flux into the road in W/m², of nominal area.
    pub road_flux: f64,
    /// Surface in contact, mean over its points.
    pub contact_mean: f64,
    /// Surface, mean over the period.
    pub background: f64,
    /// Highest anywhere.
    pub highest: f64,
    /// Depth of the highest in m.
    pub highest_depth: f64,
    /// Sliding distance in m.
    pub sliding_distance: f64,
}

/// A contact with and without feedback.
#[derive(Debug, Clone, PartialEq)]
pub struct Feedback {
    /// Without: cold and at small strain.
    pub without: ContactSolution,
    /// With the effective moduli.
    pub with: ContactSolution,
    /// Effective moduli, over the wavenumber.
    pub factors: WaveFactors,
    /// Temperature rise in K that each wave meets; empty without heat.
    pub rise: Vec<f64>,
    /// Strain that each wave meets; empty without a law of it.
    pub strain: Vec<f64>,
    /// Heat of the contact with feedback.
    pub heat: Option<HeatReport>,
    /// Contacts solved.
    pub steps: usize,
    /// Change in the last step of factors of moduli, and of friction or area.
    pub change: [f64; 2],
}

/// A contact with effective moduli alone.
#[derive(Debug, Clone, PartialEq)]
pub struct EffectiveContact {
    /// The contact.
    pub solution: ContactSolution,
    /// Effective moduli, over the wavenumber.
    pub factors: WaveFactors,
    /// Temperature rise in K that each wave meets; empty without heat.
    pub rise: Vec<f64>,
    /// Strain that each wave meets; empty without a law of it.
    pub strain: Vec<f64>,
    /// Heat of the contact.
    pub heat: Option<HeatReport>,
    /// Contacts solved.
    pub steps: usize,
    /// Change in the last step of factors of moduli, and of friction or area.
    pub change: [f64; 2],
}

/// One evaluation of the map whose fixed point is sought.
struct Step {
    solution: ContactSolution,
    thermal: Option<(HeatSource, Temperatures)>,
    rise: Vec<f64>,
    strain: Vec<f64>,
    wanted: WaveFactors,
    /// Why the wanted factors are not those of the whole rise or strain.
    refusal: Option<EffectiveError>,
}

impl<'a> FeedbackContact<'a> {
    /// Sets up the contact.
    ///
    /// # Errors
    /// As [`SlidingContact::new`], and [`ContactError::OutOfRange`] or [`crate::heat::HeatError::OutOfRange`] for a setting out of range.
    pub fn new(setup: FeedbackSetup<'a>) -> Result<Self, EffectiveError> {
        setup.check()?;
        let plain = sliding(setup.rubber, &setup)?;
        let waves = (setup.heights.len() - 1) / 2;
        let wavenumber = (1..=waves).map(|k| TAU * k as f64 / setup.period).collect();
        Ok(Self { setup, wavenumber, plain })
    }

    /// The contact at the mean pressure `p` in Pa.
    ///
    /// # Errors
    /// [`EffectiveError::NotConverged`]; [`EffectiveError::Temperature`] or [`EffectiveError::Strain`] if the contact is warmer, or
    /// more strained, than the laws know; what [`SlidingContact::solve`], [`HeatSource::new`] and [`Temperatures::new`] refuse.
    pub fn solve(&mut self, mean_pressure: f64) -> Result<Feedback, EffectiveError> {
        let without = self.plain.solve(mean_pressure)?;
        let found = self.fixed_point(mean_pressure, without.clone(), self.no_factors())?;
        let EffectiveContact { solution: with, factors, rise, strain, heat, steps, change } = found;
        Ok(Feedback { without, with, factors, rise, strain, heat, steps, change })
    }

    /// The contact with feedback alone, as in [`Self::solve`], found from factors near its own: those on a coarser grid, at
    /// another speed or pressure. A fixed point is held to the same tolerance wherever it is sought from, and near it takes fewer
    /// contacts. Where there are several, the one that is found may depend on the start.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_from(
        &mut self,
        mean_pressure: f64,
        start: &WaveFactors,
    ) -> Result<EffectiveContact, EffectiveError> {
        let factors = start.at_waves(self.wavenumber.clone());
        let solution = self.sliding(&factors)?.solve(mean_pressure)?;
        self.fixed_point(mean_pressure, solution, factors)
    }

    /// The same from the contact without feedback.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_effective(
        &mut self,
        mean_pressure: f64,
    ) -> Result<EffectiveContact, EffectiveError> {
        let without = self.plain.solve(mean_pressure)?;
        self.fixed_point(mean_pressure, without, self.no_factors())
    }

    fn no_factors(&self) -> WaveFactors {
        WaveFactors::none(self.wavenumber.clone())
    }

    /// The contact whose moduli have some factors.
    fn sliding(&self, factors: &WaveFactors) -> Result<SlidingContact, ContactError> {
        let setup = &self.setup;
        let rubber = EffectiveRubber { rubber: setup.rubber, factors, speed: setup.speed };
        sliding(&rubber, setup)
    }

    /// The fixed point, from the contact `solution` with some `factors`.
    fn fixed_point(
        &self,
        mean_pressure: f64,
        solution: ContactSolution,
        mut factors: WaveFactors,
    ) -> Result<EffectiveContact, EffectiveError> {
        let mut step = self.evaluate(solution, &factors)?;
        let mut anderson = Anderson::new(self.weights());
        let mut change = [self.distance(&factors, &step.wanted), 0.0];
        let mut steps = 1;
        while change.iter().any(|c| c.is_nan() || *c > self.setup.tolerance) {
            if steps >= self.setup.most_steps {
                return Err(self.not_converged(mean_pressure, steps, change, step.refusal));
            }
            let next = anderson.next(&self.packed(&factors), &self.packed(&step.wanted));
            let near = change.iter().all(|c| *c < NEAR);
            let next = self.unpacked(&next);
            let (solution, used) =
                self.contact(mean_pressure, &step.solution, &factors, next, near)?;
            let relative =
                |new: f64, old: f64| (new - old).abs() / old.abs().max(f64::MIN_POSITIVE);
            let (new, old) = (&solution, &step.solution);
            let moved = relative(new.friction_coefficient, old.friction_coefficient)
                .max(relative(new.contact_area_fraction, old.contact_area_fraction));
            factors = used;
            step = self.evaluate(solution, &factors)?;
            change = [self.distance(&factors, &step.wanted), moved];
            steps += 1;
        }
        if let Some(refusal) = step.refusal {
            return Err(refusal);
        }
        let heat = step.thermal.as_ref().map(|(source, field)| self.report(source, field));
        let Step { solution, rise, strain, .. } = step;
        Ok(EffectiveContact { solution, factors, rise, strain, heat, steps, change })
    }

    /// The contact with the `next` factors, or with some between them and the last ones where the rubber is not known at the
    /// frequencies that they lead to.
    fn contact(
        &self,
        mean_pressure: f64,
        last: &ContactSolution,
        factors: &WaveFactors,
        mut next: WaveFactors,
        near: bool,
    ) -> Result<(ContactSolution, WaveFactors), EffectiveError> {
        for retreat in 0.. {
            match self.sliding(&next) {
                Ok(mut contact) => {
                    // From a contact that is not near, the coarser grids are faster.
                    let solution = match near {
                        true => contact.solve_near(mean_pressure, &last.pressure)?,
                        false => contact.solve(mean_pressure)?,
                    };
                    return Ok((solution, next));
                }
                Err(ContactError::Rubber(RubberError::NotMeasured { .. }))
                    if retreat < MOST_RETREATS =>
                {
                    let [from, to] = [factors, &next].map(|f| self.packed(f));
                    let half: Vec<f64> = from.iter().zip(&to).map(|(a, b)| 0.5 * (a + b)).collect();
                    next = self.unpacked(&half);
                }
                Err(error) => return Err(error.into()),
            }
        }
        unreachable!("the last retreat returns its error")
    }

    /// What a contact with some factors makes of heat and strain, and the factors that these would have.
    fn evaluate(
        &self,
        solution: ContactSolution,
        factors: &WaveFactors,
    ) -> Result<Step, EffectiveError> {
        let setup = &self.setup;
        let rubber = EffectiveRubber { rubber: setup.rubber, factors, speed: setup.speed };
        let moduli = wave_moduli(&rubber, setup.speed, setup.period, setup.heights.len());
        let load = LineLoad {
            speed: setup.speed,
            period: setup.period,
            pressure: &solution.pressure,
            moduli: &moduli,
        };
        let mut wanted = WaveFactors::none(self.wavenumber.clone());
        let (mut thermal, mut rise, mut strain, mut refusal) = (None, vec![], vec![], None);
        if let Some(heat) = &setup.heat {
            let source = HeatSource::new(&load, &heat.thermal)?;
            let field = Temperatures::new(&source, &solution.pressure, &heat.thermal)?;
            // The pressure as weight: where it carries, a wave has its modulus. The points in contact as such would make the
            // rise jump as one of them comes or goes.
            rise = field.felt_by_waves(&solution.pressure, &self.wavenumber)?;
            refusal = warmed(heat, &rise, &mut wanted);
            thermal = Some((source, field));
        }
        if let Some(law) = setup.strain {
            strain = strain_of_waves(&load);
            refusal = strained(law, &strain, &mut wanted).or(refusal);
        }
        Ok(Step { solution, thermal, rise, strain, wanted, refusal })
    }

    fn report(&self, source: &HeatSource, field: &Temperatures) -> HeatReport {
        let thermal = self.setup.heat.map(|heat| heat.thermal);
        let (highest, highest_depth) = field.highest();
        let speed = self.setup.speed.abs();
        let flux = field.road_flux();
        HeatReport {
            power: source.power(),
            heat: source.heat(),
            shear_power: field.shear_power(),
            road_flux: flux.iter().sum::<f64>() / flux.len() as f64,
            contact_mean: field.contact_mean(),
            background: field.background(),
            highest,
            highest_depth,
            sliding_distance: thermal.map_or(0.0, |t| t.duration * speed),
        }
    }

    fn not_converged(
        &self,
        pressure: f64,
        steps: usize,
        change: [f64; 2],
        refusal: Option<EffectiveError>,
    ) -> EffectiveError {
        refusal.unwrap_or(EffectiveError::NotConverged {
            pressure,
            speed: self.setup.speed,
            steps,
            moduli: change[0],
            contact: change[1],
            tolerance: self.setup.tolerance,
        })
    }

    /// The unknowns: the logarithms of the factors of temperature, the factors of strain.
    fn packed(&self, factors: &WaveFactors) -> Vec<f64> {
        let mut unknowns = vec![];
        if self.setup.heat.is_some() {
            unknowns.extend(factors.ln_shift.iter().chain(&factors.ln_vertical));
        }
        if self.setup.strain.is_some() {
            unknowns.extend(factors.storage.iter().chain(&factors.loss));
        }
        unknowns
    }

    fn unpacked(&self, unknowns: &[f64]) -> WaveFactors {
        let mut factors = WaveFactors::none(self.wavenumber.clone());
        let mut parts = unknowns.chunks_exact(self.wavenumber.len());
        let mut take = |into: &mut Vec<f64>, least: f64| {
            for (x, new) in into.iter_mut().zip(parts.next().unwrap_or_default()) {
                *x = new.max(least);
            }
        };
        if self.setup.heat.is_some() {
            take(&mut factors.ln_shift, f64::NEG_INFINITY);
            take(&mut factors.ln_vertical, f64::NEG_INFINITY);
        }
        if self.setup.strain.is_some() {
            // An accelerated step may overshoot what no modulus has.
            take(&mut factors.storage, 1e-3);
            take(&mut factors.loss, 0.0);
        }
        factors
    }

    /// Octaves count alike.
    fn weights(&self) -> Vec<f64> {
        let parts =
            2 * (usize::from(self.setup.heat.is_some()) + usize::from(self.setup.strain.is_some()));
        let waves = self.wavenumber.len();
        (0..parts * waves).map(|i| 1.0 / (i % waves + 1) as f64).collect()
    }

    fn distance(&self, a: &WaveFactors, b: &WaveFactors) -> f64 {
        let pairs = self.packed(a).into_iter().zip(self.packed(b));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }
}

/// The contact of a set-up with another rubber, or its own.
fn sliding(
    rubber: &dyn Viscoelastic,
    setup: &FeedbackSetup,
) -> Result<SlidingContact, ContactError> {
    let FeedbackSetup { speed, period, heights, .. } = *setup;
    match setup.interrupt {
        None => SlidingContact::new(rubber, speed, period, heights),
        Some(interrupt) => {
            SlidingContact::new_interruptible(rubber, speed, period, heights, interrupt)
        }
    }
}

/// Writes the factors of a rise of the temperature; where the law does not know it, those of as much of it as it knows, with the
/// reason.
fn warmed(heat: &HeatFeedback, rise: &[f64], wanted: &mut WaveFactors) -> Option<EffectiveError> {
    let mut refusal = None;
    for halving in 0..=MOST_HALVINGS {
        let share = 0.5_f64.powi(halving);
        match factors_at(heat, rise, share, wanted) {
            Ok(()) => break,
            Err(error) => refusal = refusal.or(Some(error)),
        }
    }
    refusal
}

fn factors_at(
    heat: &HeatFeedback,
    rise: &[f64],
    share: f64,
    wanted: &mut WaveFactors,
) -> Result<(), EffectiveError> {
    let values = |temperature_c: f64| -> Result<[f64; 2], String> {
        let pair = [heat.law.ln_shift(temperature_c)?, heat.law.ln_vertical(temperature_c)?];
        let finite = pair.iter().all(|x| x.is_finite());
        if finite { Ok(pair) } else { Err(format!("the law gives {pair:?}")) }
    };
    let refused = |temperature_c: f64, q: f64| {
        move |reason| EffectiveError::Temperature { temperature_c, wavelength: TAU / q, reason }
    };
    let cold = heat.temperature_c;
    let reference = values(cold).map_err(refused(cold, wanted.wavenumber[0]))?;
    for (k, rise) in rise.iter().enumerate() {
        let temperature_c = cold + share * rise;
        let here = values(temperature_c).map_err(refused(temperature_c, wanted.wavenumber[k]))?;
        wanted.ln_shift[k] = here[0] - reference[0];
        wanted.ln_vertical[k] = here[1] - reference[1];
    }
    Ok(())
}

/// As [`warmed`], of the strain.
fn strained(
    law: &dyn StrainLaw,
    strain: &[f64],
    wanted: &mut WaveFactors,
) -> Option<EffectiveError> {
    let mut refusal = None;
    for halving in 0..=MOST_HALVINGS {
        let share = 0.5_f64.powi(halving);
        let failed = strain.iter().enumerate().find_map(|(k, strain)| {
            let strain = share * strain;
            let checked = |name: &str, factor: Result<f64, String>| {
                let factor = factor?;
                let good = factor > 0.0 && factor.is_finite();
                if good { Ok(factor) } else { Err(format!("the {name} factor is {factor}")) }
            };
            let pair = checked("storage", law.storage_factor(strain))
                .and_then(|f| Ok([f, checked("loss", law.loss_factor(strain))?]));
            match pair {
                Ok([f, g]) => {
                    wanted.storage[k] = f;
                    wanted.loss[k] = g;
                    None
                }
                Err(reason) => {
                    let wavelength = TAU / wanted.wavenumber[k];
                    Some(EffectiveError::Strain { strain, wavelength, reason })
                }
            }
        });
        match failed {
            None => break,
            Some(error) => refusal = refusal.or(Some(error)),
        }
    }
    refusal
}
