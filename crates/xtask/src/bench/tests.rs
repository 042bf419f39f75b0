use super::*;
use std::collections::BTreeSet;

#[test]
fn names_and_knobs_are_as_they_should_be() {
    let cases = cases();
    let names: BTreeSet<&str> = cases.iter().map(|case| case.name).collect();
    assert_eq!(names.len(), cases.len());
    for case in &cases {
        for method in case.methods {
            assert!(method.values.is_sorted_by(|a, b| a < b), "{}", method.name);
            if let Reference::OverResolved { value, quick, .. } = case.reference {
                let finest = method.values.iter().max().unwrap();
                assert!(value > *finest && quick > method.values[1], "{}", method.name);
            }
        }
    }
}

#[test]
fn a_name_that_is_no_case_brings_the_names_that_are() {
    let message = select(&["sine".into()]).unwrap_err().to_string();
    assert!(message.starts_with("there is no case sine: choose from half-space-1-wave, "));
    assert!(message.ends_with(", spectrum"));
    let chosen = select(&["spectrum".into(), "hybrid".into()]).unwrap();
    assert_eq!(chosen.iter().map(|case| case.name).collect::<Vec<_>>(), ["hybrid", "spectrum"]);
}

/// The order of friction in the grid is 2.2 for a lossy rubber (`tests/convergence`); a knob that
/// goes from 32 to 512 points should leave a hundredth of the error, an eighth is asked for here
/// at least from one fourfold grid to the next.
#[test]
fn the_error_of_one_sine_falls_along_the_knob() {
    let case = select(&["half-space-1-wave".into()]).unwrap()[0];
    let Reference::OverResolved { prepare, value, .. } = case.reference else {
        panic!("friction has an over-resolved reference")
    };
    let reference = case.once("reference", prepare, value).unwrap();
    let errors: Vec<f64> = [32, 128, 512, 2048]
        .map(|points| relative_error(&case.once("", prepare, points).unwrap(), &reference))
        .to_vec();
    assert!(errors.windows(2).all(|pair| pair[1] < pair[0] / 4.0), "{errors:?}");
}

#[test]
fn transforms_and_sums_agree_to_round_off() {
    for case in select(&["correlation".into(), "spectrum".into()]).unwrap() {
        let result = case.run(Effort::Quick, &|_| ()).unwrap();
        for point in result.lines.iter().flat_map(|line| &line.points) {
            // A sum of n rounded terms is off by at most n times 1e-16; n is 2048.
            assert!(point.relative_error < 2e-13, "{}: {point:?}", case.name);
            assert_eq!(point.result, None);
        }
    }
}

#[test]
fn errors_are_euclidean() {
    assert_eq!(relative_error(&[3.0, 4.5], &[3.0, 4.0]), 0.1);
}

#[test]
fn results_are_a_table_and_a_plot() {
    let names = ["half-space-1-wave".into(), "correlation".into()];
    let results: Vec<CaseResult> = select(&names)
        .unwrap()
        .iter()
        .map(|case| case.run(Effort::Quick, &|_| ()).unwrap())
        .collect();
    let table = report::markdown(&results);
    assert_eq!(table.matches("## ").count(), 2);
    // Three methods of two values each.
    let rows = table.lines().filter(|line| line.contains("| points |"));
    assert_eq!(rows.count(), 6);
    let svg = figure::figure(&results).svg().unwrap();
    for text in ["time / s", "relative error of friction", "half-space, 1 wave", "correlation, FFT"]
    {
        assert!(svg.contains(text), "{text}");
    }
    assert!(figure::figure(&[]).svg().is_err());
}
