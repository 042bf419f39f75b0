use super::*;
use crate::rubber::Rubber;

fn heights() -> Vec<f64> {
    (0..64).map(|i| 1e-5 * (0.1 * f64::from(i)).sin()).collect()
}

fn sine() -> SlidingContact {
    SlidingContact::new(&Rubber::elastic(3e6, 0.5), 0.01, 1e-3, &heights()).unwrap()
}

#[test]
fn an_iteration_that_rests_above_the_tolerance_is_refused() {
    let mut contact = sine();
    let mut solution = contact.solve(1e4).unwrap();
    let rests = Outcome { converged: true, iterations: 9, applications: 9, changes: 0 };
    assert!(contact.accept(solution.clone(), Some(rests)).is_ok());
    let wanders = Outcome { converged: false, changes: 2, ..rests };
    let error = contact.accept(solution.clone(), Some(wanders)).unwrap_err();
    assert!(matches!(error, ContactError::NotConverged { changes: 2, .. }), "{error}");
    for residual in [1.01 * RESIDUAL_TOLERANCE, f64::NAN] {
        solution.residual = residual;
        for outcome in [Some(rests), None] {
            let error = contact.accept(solution.clone(), outcome).unwrap_err();
            assert!(matches!(error, ContactError::NotConverged { changes: 0, .. }), "{error}");
        }
    }
}

#[test]
fn an_interrupt_ends_a_solve_and_is_no_answer() {
    let interrupt = Interrupt::default();
    let set_up = || {
        let rubber = Rubber::elastic(3e6, 0.5);
        SlidingContact::new_interruptible(&rubber, 0.01, 1e-3, &heights(), &interrupt)
    };
    let mut contact = set_up().unwrap();
    let solution = contact.solve(1e4).unwrap();
    interrupt.set();
    assert_eq!(set_up().err(), Some(ContactError::Interrupted));
    assert_eq!(contact.solve(1e4), Err(ContactError::Interrupted));
    assert_eq!(contact.solve_for_area(0.3, 1e-6), Err(ContactError::Interrupted));
    assert_eq!(sine().solve(1e4).unwrap(), solution);
}

#[test]
fn full_contact_beyond_the_reach_of_double_precision_is_refused() {
    let mut contact = sine();
    assert!(contact.solve(1e9).is_ok());
    for pressure in [1e17, 1e100, 1e300] {
        let error = contact.solve(pressure).unwrap_err();
        assert!(matches!(error, ContactError::NotConverged { .. }), "{error}");
    }
}
