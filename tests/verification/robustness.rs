//! Every contact is solved: all loads, speeds, grids and kinds of profile.

use crate::surfaces::{Profile, random_phases, single_peak, superposed, table_2_1, white_noise};
use asperity::contact::SlidingContact;
use asperity::contact::sliding::RESIDUAL_TOLERANCE;
use rayon::prelude::*;

/// Loads over the smallest pressure of full contact.
const LOADS: [f64; 7] = [1e-5, 1e-3, 0.03, 0.2, 0.7, 0.99, 1.01];

type MakeProfile = fn(usize) -> Profile;

const PROFILES: [(&str, MakeProfile); 6] = [
    ("one sine", |points| superposed(&[0.3], points)),
    ("three waves", |points| superposed(&random_phases(3, 1), points)),
    ("eight waves", |points| superposed(&random_phases(8, 2), points)),
    ("white noise", |points| white_noise(points, 3)),
    ("one peak", single_peak),
    ("flat", |points| Profile { period: 1e-3, heights: vec![2.0; points] }),
];

/// Solves every combination; returns what failed.
fn failures(grids: &[usize], speeds: &[f64], seeds_of_load: &[f64]) -> Vec<String> {
    let mut cases = Vec::new();
    for (name, make) in PROFILES {
        for points in grids {
            cases.extend(speeds.iter().map(|speed| (name, make, *points, *speed)));
        }
    }
    cases
        .into_par_iter()
        .flat_map_iter(|(name, make, points, speed)| {
            let profile = make(points);
            let mut contact =
                SlidingContact::new(&table_2_1(), speed, profile.period, &profile.heights).unwrap();
            let full = contact.smallest_full_contact_pressure();
            let full = if full > 0.0 { full } else { 1e6 };
            let mut failed = Vec::new();
            for load in seeds_of_load {
                let case = format!("{name}, {points} points, {speed:e} m/s, load {load:e}");
                match contact.solve(load * full) {
                    Err(error) => failed.push(format!("{case}: {error}")),
                    Ok(solution) => {
                        let area = solution.contact_area_fraction;
                        let sound = solution.residual <= RESIDUAL_TOLERANCE
                            && area > 0.0
                            && area <= 1.0
                            && solution.mean_separation >= 0.0
                            && solution.friction_coefficient.is_finite();
                        if !sound {
                            failed.push(format!(
                                "{case}: residual {:e}, area {area}, separation {:e}",
                                solution.residual, solution.mean_separation
                            ));
                        }
                    }
                }
            }
            failed
        })
        .collect()
}

#[test]
fn a_coarse_product_of_cases() {
    let failed = failures(&[256, 257, 1000, 4096], &[1e-9, 1e-5, 1e-2, 1.0, 1e3], &LOADS);
    assert!(failed.is_empty(), "{} failed:\n{}", failed.len(), failed.join("\n"));
}

#[test]
#[ignore = "takes many minutes"]
fn the_full_product_of_cases() {
    let speeds: Vec<f64> = (-9..=3).map(|exponent| 10_f64.powi(exponent)).collect();
    let loads: Vec<f64> = (0..24).map(|i| 1e-6 * 1.85_f64.powi(i)).collect();
    let mut failed = failures(&[256, 257, 1000, 4096, 65536], &speeds, &loads);
    failed.extend(failures(&[1 << 20], &[1e-9, 1e-2, 1e3], &[1e-3, 0.03, 0.2]));
    assert!(failed.is_empty(), "{} failed:\n{}", failed.len(), failed.join("\n"));
}
