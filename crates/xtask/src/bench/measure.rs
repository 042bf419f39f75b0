//! Repeats and their median.

use super::Failure;
use std::time::Instant;

/// A solver is repeated at least this often after its warm-up.
const FEWEST_REPEATS: usize = 3;
/// And at most this often.
const MOST_REPEATS: usize = 25;
/// Further repeats are made while all of them together take less than this, in s.
const ENOUGH_SECONDS: f64 = 0.3;

/// How much is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Effort {
    /// All values of the knobs, medians of repeats.
    #[default]
    Full,
    /// Two values of each knob, once: to see that everything runs, not for results.
    Quick,
}

impl Effort {
    /// The sizes that are run.
    pub fn of<T>(self, sizes: &[T]) -> &[T] {
        match self {
            Self::Full => sizes,
            Self::Quick => &sizes[..sizes.len().min(2)],
        }
    }
}

/// What repeated runs gave.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured<T> {
    /// The result of the last one.
    pub result: T,
    /// Median time in s.
    pub seconds: f64,
    /// Number of repeats, the warm-up not counted.
    pub repeats: usize,
}

/// Runs once to warm up, then repeatedly, 3 to 25 times and for about 0.3 s; once and without a
/// warm-up for [`Effort::Quick`].
///
/// # Errors
/// The first failure.
pub fn measure<T>(
    effort: Effort,
    run: &mut dyn FnMut() -> Result<T, Failure>,
) -> Result<Measured<T>, Failure> {
    let (mut result, first) = timed(run)?;
    if effort == Effort::Quick {
        return Ok(Measured { result, seconds: first, repeats: 1 });
    }
    let mut seconds: Vec<f64> = Vec::new();
    while seconds.len() < FEWEST_REPEATS
        || (seconds.len() < MOST_REPEATS && seconds.iter().sum::<f64>() < ENOUGH_SECONDS)
    {
        let (again, time) = timed(run)?;
        result = again;
        seconds.push(time);
    }
    Ok(Measured { result, repeats: seconds.len(), seconds: median(seconds) })
}

fn timed<T>(run: &mut dyn FnMut() -> Result<T, Failure>) -> Result<(T, f64), Failure> {
    let start = Instant::now();
    let result = run()?;
    Ok((result, start.elapsed().as_secs_f64()))
}

/// The middle value, of an even number the mean of both middle ones; NaN of none.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    if n == 0 { f64::NAN } else { 0.5 * (values[(n - 1) / 2] + values[n / 2]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 100.0]), 3.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 100.0]), 3.0);
        assert!(median(Vec::new()).is_nan());
    }

    #[test]
    fn a_warm_up_is_no_repeat() {
        let mut runs = 0;
        let mut count = || {
            runs += 1;
            Ok(runs)
        };
        let full = measure(Effort::Full, &mut count).unwrap();
        assert_eq!(full.result, full.repeats + 1);
        assert!((FEWEST_REPEATS..=MOST_REPEATS).contains(&full.repeats));
        let quick = measure(Effort::Quick, &mut count).unwrap();
        assert_eq!((quick.repeats, quick.result), (1, full.result + 1));
    }

    #[test]
    fn a_failure_is_handed_on() {
        let mut fail = || Err::<(), Failure>("no solution".into());
        assert_eq!(measure(Effort::Full, &mut fail).unwrap_err().to_string(), "no solution");
    }
}
