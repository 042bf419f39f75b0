//! The sweeps that are fitted together, with first values of their shifts.

use super::model::{FreeVerticals, Series};
use super::result::LeftOut;
use super::shift::{self, first_shifts};
use super::verticals::{Start, WALK_PER_ROOT_K};
use super::{FitError, FitOptions, GivenShift, SAME_TEMPERATURE_K, Sweep, VerticalChoice};
use crate::rubber::VerticalShift;
use std::f64::consts::LN_10;

/// Largest `log10 a_T` that counts as that of the reference, for rounding in a table.
const NO_SHIFT_DECADES: f64 = 1e-6;

/// Connected sweeps by ascending temperature.
#[derive(Debug)]
pub(super) struct Chain {
    pub sweeps: Vec<Sweep>,
    /// Number of the sweep at the reference temperature.
    pub reference: usize,
    /// Temperature of the reference in °C, if temperatures are known.
    pub reference_c: Option<f64>,
    /// ln a of every sweep: start of the fit or, if `given`, fixed values.
    pub ln_shifts: Vec<f64>,
    /// Whether the shifts are given instead of fitted.
    pub given: bool,
    /// Given factors about the reference, of a master curve that has no temperature itself.
    pub curve_factors: Vec<GivenShift>,
    pub vertical: VerticalChoice,
    /// Sweeps that cannot be joined to these.
    pub left_out: Vec<LeftOut>,
    /// Temperatures of the pairs that E'' and tan δ have joined, in °C.
    pub joined_by_loss_c: Vec<[f64; 2]>,
    /// Whether a pair of sweeps with a poorly determined shift lies between a sweep and the reference.
    pub uncertain: Vec<bool>,
    /// The colder sweep of each such pair.
    loose: Vec<usize>,
    /// The colder sweep of each pair along a power law, where vertical factors are free.
    featureless: Vec<usize>,
}

impl Chain {
    /// ln b of a sweep by the choice; where factors are fitted, their reference.
    pub fn ln_known_vertical(&self, sweep: usize) -> f64 {
        let temperature_c = self.sweeps[sweep].temperature_c;
        let known = temperature_c.zip(self.reference_c).zip(known_vertical(self.vertical));
        known.map_or(0.0, |((temperature_c, reference_c), shift)| {
            shift.ln_factor(temperature_c, reference_c)
        })
    }

    /// A series without terms, with the shifts from which the fit starts.
    pub fn start(&self) -> Series {
        Series {
            ln_equilibrium: 0.0,
            terms: Vec::new(),
            ln_shifts: self.ln_shifts.clone(),
            ln_verticals: vec![0.0; self.sweeps.len()],
        }
    }

    /// The vertical factors, relative to the known ones, that the fit has to find.
    pub fn free_verticals(&self) -> Option<FreeVerticals> {
        matches!(self.vertical, VerticalChoice::Free { .. }).then(|| FreeVerticals {
            free: (0..self.sweeps.len()).map(|k| k != self.reference).collect(),
            steps: (1..self.sweeps.len()).map(|k| self.step(k - 1)).collect(),
            noise: 0.0,
        })
    }

    /// Possible error of ln a of a sweep beyond the scatter, from pairs with a poorly determined shift between it and
    /// the reference: each shift may be anything from zero to that of sweeps that just touch. Along a power law it is
    /// the error of the vertical factor over the slope.
    pub fn slack(&self, sweep: usize, ln_shifts: &[f64]) -> f64 {
        let between = self.between(sweep);
        let of = |k: &usize| {
            let place = ln_shifts[*k] - ln_shifts[k + 1];
            place.abs().max((ln_length(&self.sweeps[*k]) - place).abs())
        };
        let by_factor = |k: &usize| {
            let [colder, hotter] = [&self.sweeps[*k], &self.sweeps[k + 1]];
            // No further than sweeps that just touch, however flat they are.
            (1.96 * self.step(*k) / shift::slope(colder, hotter).max(0.0)).min(ln_length(colder))
        };
        let inside = |k: &&usize| between.contains(*k);
        let loose: f64 = self.loose.iter().filter(inside).map(of).sum();
        loose + self.featureless.iter().filter(inside).map(by_factor).sum::<f64>()
    }

    /// Possible error of ln b of a sweep beyond the scatter, from pairs along a power law between it and the reference.
    pub fn vertical_slack(&self, sweep: usize) -> f64 {
        let between = self.between(sweep);
        let inside = |k: &&usize| between.contains(*k);
        self.featureless.iter().filter(inside).map(|k| 1.96 * self.step(*k)).sum()
    }

    /// The pairs between a sweep and the reference.
    fn between(&self, sweep: usize) -> std::ops::Range<usize> {
        sweep.min(self.reference)..sweep.max(self.reference)
    }

    /// Standard deviation of the change of ln b from a sweep to the next.
    fn step(&self, k: usize) -> f64 {
        WALK_PER_ROOT_K * (celsius(&self.sweeps[k + 1]) - celsius(&self.sweeps[k])).sqrt()
    }

    /// Starts of a fit of vertical factors: the known ones, none, both ends of the likely range, and the shifts by tan
    /// δ, which no factor changes.
    pub fn starts(&self) -> Vec<Start> {
        let sweeps = self.sweeps.len();
        let mut starts =
            vec![Start { ln_shifts: self.ln_shifts.clone(), ln_verticals: vec![0.0; sweeps] }];
        if self.given {
            return starts;
        }
        let known: Vec<f64> = (0..sweeps).map(|k| self.ln_known_vertical(k)).collect();
        let divided_by = |ln: &[f64]| -> Vec<Sweep> {
            self.sweeps.iter().zip(ln).map(|(sweep, ln)| divided(sweep, ln.exp())).collect()
        };
        let reference_c = celsius(&self.sweeps[self.reference]);
        let difference = |k: usize| celsius(&self.sweeps[k]) - reference_c;
        let span = (0..sweeps).map(|k| difference(k).abs()).fold(0.0, f64::max);
        // Both ends of the prior's 95 % interval at the temperature that is furthest away.
        let end = |sign: f64| {
            let ln = move |k: usize| sign * 1.96 * WALK_PER_ROOT_K * difference(k) / span.sqrt();
            (0..sweeps).map(ln).collect::<Vec<f64>>()
        };
        let none = known.iter().map(|ln| -ln).collect();
        for ln_verticals in [none, end(1.0), end(-1.0)] {
            let all: Vec<f64> = ln_verticals.iter().zip(&known).map(|(ln, at)| ln + at).collect();
            let ln_shifts = shift::by_storage_from(&divided_by(&all), &self.ln_shifts);
            starts.push(Start { ln_shifts, ln_verticals });
        }
        starts.push(shift::by_loss_factor_from(&divided_by(&known), &self.ln_shifts));
        for start in &mut starts {
            for values in [&mut start.ln_shifts, &mut start.ln_verticals] {
                let at_reference = values[self.reference];
                values.iter_mut().for_each(|value| *value -= at_reference);
            }
        }
        starts
    }
}

/// ln of the ratio of the highest and the lowest frequency.
fn ln_length(sweep: &Sweep) -> f64 {
    let last = sweep.points.last().map_or(1.0, |point| point.angular_frequency);
    (last / sweep.points[0].angular_frequency).ln()
}

fn celsius(sweep: &Sweep) -> f64 {
    sweep.temperature_c.unwrap_or(f64::NAN)
}

fn divided(sweep: &Sweep, factor: f64) -> Sweep {
    let mut sweep = sweep.clone();
    for point in &mut sweep.points {
        point.storage_modulus /= factor;
        point.loss_modulus /= factor;
    }
    sweep
}

fn known_vertical(vertical: VerticalChoice) -> Option<VerticalShift> {
    match vertical {
        VerticalChoice::RhoT { expansion_per_k } | VerticalChoice::Free { expansion_per_k } => {
            Some(VerticalShift::RhoT { expansion_per_k })
        }
        VerticalChoice::None => None,
    }
}

/// The sweeps that neighbours join to the reference, with the others left out.
///
/// # Errors
/// [`FitError::Reference`]; [`FitError::NoOverlap`] if nothing is joined to the reference.
pub(super) fn joined(sweeps: Vec<Sweep>, options: &FitOptions) -> Result<Chain, FitError> {
    let wanted = options.reference_c.map(|wanted| nearest(&sweeps, wanted)).transpose()?;
    let first = first_shifts(&reduced(&sweeps, options.vertical));
    let groups = || first.groups.iter().cloned();
    let group = match wanted {
        Some(wanted) => groups().find(|group| group.contains(&wanted)),
        // Of equally long ones the coldest.
        None => groups().rev().max_by_key(std::iter::ExactSizeIterator::len),
    };
    let group = group.ok_or(FitError::Empty)?;
    if group.len() == 1 && sweeps.len() > 1 {
        let colder = if group.start > 0 { group.start - 1 } else { group.start };
        return Err(no_overlap(&sweeps[colder], &sweeps[colder + 1]));
    }
    let reference = wanted.unwrap_or(group.start + (group.len() - 1) / 2);
    let relative = first.ln_shifts[group.clone()].iter();
    let ln_shifts = relative.map(|ln| ln - first.ln_shifts[reference]).collect();
    let temperature = |k: usize| celsius(&sweeps[k]);
    let between = |k: usize| if k < reference { k..reference } else { reference..k };
    let free = matches!(options.vertical, VerticalChoice::Free { .. });
    let featureless = |k: &usize| free && shift::featureless(&sweeps[*k], &sweeps[k + 1]);
    let featureless: Vec<usize> = (0..sweeps.len() - 1).filter(featureless).collect();
    let open = || first.uncertain.iter().chain(&featureless);
    let uncertain = |k: usize| open().any(|pair| between(k).contains(pair));
    let inside = |pairs: &[usize]| -> Vec<usize> {
        let both = |k: &&usize| group.contains(*k) && group.contains(&(**k + 1));
        pairs.iter().filter(both).map(|k| k - group.start).collect()
    };
    let by_loss = first.by_loss.iter().filter(|k| group.contains(k));
    let others = (0..sweeps.len()).filter(|k| !group.contains(k));
    Ok(Chain {
        reference: reference - group.start,
        reference_c: sweeps[reference].temperature_c,
        ln_shifts,
        given: false,
        curve_factors: Vec::new(),
        vertical: options.vertical,
        left_out: others
            .map(|k| LeftOut {
                temperature_c: temperature(k),
                storage_mpa: storage_range_mpa(&sweeps[k]),
            })
            .collect(),
        joined_by_loss_c: by_loss.map(|k| [temperature(*k), temperature(k + 1)]).collect(),
        uncertain: group.clone().map(uncertain).collect(),
        loose: inside(&first.uncertain),
        featureless: inside(&featureless),
        sweeps: sweeps[group].to_vec(),
    })
}

/// All sweeps with given shift factors.
///
/// # Errors
/// [`FitError::NoShiftFactor`], [`FitError::Reference`], [`FitError::NoReference`].
pub(super) fn given(
    sweeps: Vec<Sweep>,
    given: &[GivenShift],
    options: &FitOptions,
) -> Result<Chain, FitError> {
    let about = |reference: GivenShift| {
        move |shift: &GivenShift| GivenShift {
            log10_shift: shift.log10_shift - reference.log10_shift,
            ..*shift
        }
    };
    let mut chain = Chain {
        reference: 0,
        reference_c: None,
        ln_shifts: vec![0.0; sweeps.len()],
        given: true,
        curve_factors: Vec::new(),
        vertical: options.vertical,
        left_out: Vec::new(),
        joined_by_loss_c: Vec::new(),
        uncertain: vec![false; sweeps.len()],
        loose: Vec::new(),
        featureless: Vec::new(),
        sweeps,
    };
    if let [Sweep { temperature_c: None, .. }] = chain.sweeps[..] {
        let reference = curve_reference(given, options.reference_c)?;
        chain.reference_c = Some(reference.temperature_c);
        chain.curve_factors = given.iter().map(about(reference)).collect();
        return Ok(chain);
    }
    let wanted = options.reference_c.map(|wanted| nearest(&chain.sweeps, wanted)).transpose()?;
    chain.reference = wanted.unwrap_or((chain.sweeps.len() - 1) / 2);
    chain.reference_c = chain.sweeps[chain.reference].temperature_c;
    let of = |sweep: &Sweep| factor(given, sweep.temperature_c.unwrap_or(f64::NAN));
    let reference = of(&chain.sweeps[chain.reference])?;
    let ln = |sweep: &Sweep| Ok(LN_10 * about(reference)(&of(sweep)?).log10_shift);
    chain.ln_shifts = chain.sweeps.iter().map(ln).collect::<Result<_, FitError>>()?;
    Ok(chain)
}

/// The factor at the temperature of a master curve: the one asked for, else the one that is 1.
fn curve_reference(given: &[GivenShift], wanted: Option<f64>) -> Result<GivenShift, FitError> {
    match wanted {
        Some(wanted_c) => factor(given, wanted_c).map_err(|_| FitError::Reference {
            wanted_c,
            measured_c: given.iter().map(|shift| shift.temperature_c).collect(),
        }),
        None => given
            .iter()
            .find(|shift| shift.log10_shift.abs() < NO_SHIFT_DECADES)
            .copied()
            .ok_or(FitError::NoReference),
    }
}

fn factor(given: &[GivenShift], temperature_c: f64) -> Result<GivenShift, FitError> {
    let distance = |shift: &GivenShift| (shift.temperature_c - temperature_c).abs();
    let nearest = given.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.filter(|shift| distance(shift) <= SAME_TEMPERATURE_K).copied().ok_or_else(|| {
        let given_c = given.iter().map(|shift| shift.temperature_c).collect();
        FitError::NoShiftFactor { temperature_c, given_c }
    })
}

/// Number of the sweep at a temperature in °C.
fn nearest(sweeps: &[Sweep], wanted_c: f64) -> Result<usize, FitError> {
    let distance = |sweep: &Sweep| (sweep.temperature_c.unwrap_or(f64::NAN) - wanted_c).abs();
    let nearest =
        (0..sweeps.len()).min_by(|a, b| distance(&sweeps[*a]).total_cmp(&distance(&sweeps[*b])));
    nearest.filter(|k| distance(&sweeps[*k]) <= SAME_TEMPERATURE_K).ok_or_else(|| {
        let measured_c = sweeps.iter().filter_map(|sweep| sweep.temperature_c).collect();
        FitError::Reference { wanted_c, measured_c }
    })
}

/// The sweeps divided by the known vertical factors about 0 °C, to join them before the reference is chosen.
fn reduced(sweeps: &[Sweep], vertical: VerticalChoice) -> Vec<Sweep> {
    let Some(shift) = known_vertical(vertical) else { return sweeps.to_vec() };
    let factor =
        |sweep: &Sweep| shift.ln_factor(sweep.temperature_c.unwrap_or_default(), 0.0).exp();
    sweeps.iter().map(|sweep| divided(sweep, factor(sweep))).collect()
}

fn no_overlap(colder: &Sweep, hotter: &Sweep) -> FitError {
    FitError::NoOverlap {
        colder_c: colder.temperature_c.unwrap_or(f64::NAN),
        hotter_c: hotter.temperature_c.unwrap_or(f64::NAN),
        colder_mpa: storage_range_mpa(colder),
        hotter_mpa: storage_range_mpa(hotter),
    }
}

fn storage_range_mpa(sweep: &Sweep) -> [f64; 2] {
    let moduli = || sweep.points.iter().map(|point| point.storage_modulus / 1e6);
    [moduli().fold(f64::INFINITY, f64::min), moduli().fold(0.0, f64::max)]
}
