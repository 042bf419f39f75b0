//! Finite deformation: physics.md section 4, and each route as the check of the other.

use crate::surfaces::{shortest_wave, table_2_1};
use approx::assert_relative_eq;
use asperity::contact::SlidingContact;
use asperity::fem::error::{FemError, PathEnd};
use asperity::fem::profile::RigidProfile;
use asperity::fem::steady::solution::SteadySolution;
use asperity::fem::steady::{BlockOptions, SteadyContact};
use asperity::fem::transient::{TransientContact, TransientOptions};
use asperity::reference::FullContact;
use asperity::rubber::{MaxwellBranch, Rheology, Rubber};
use asperity::surface::{SineScale, Wave};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const PERIOD: f64 = 6.25e-5;

fn sine(amplitude: f64) -> RigidProfile {
    RigidProfile::from_waves(&[Wave { wavelength: PERIOD, amplitude, phase: 0.0 }], PERIOD)
}

fn contact(rubber: &Rubber, speed: f64, amplitude: f64, options: BlockOptions) -> SteadyContact {
    SteadyContact::new(rubber, Rheology::NeoHookean, speed, sine(amplitude), options).unwrap()
}

fn assert_solved(solution: &SteadySolution) {
    // The bound that a solution is promised to hold.
    assert!(solution.residual <= 1e-9, "{}", solution.residual);
    let load: f64 = solution.nodes.iter().map(|node| node.pressure).sum();
    assert!(load > 0.0);
    for node in &solution.nodes {
        assert!(node.pressure >= 0.0 && node.separation >= -1e-12, "{node:?}");
        // 1e-8 of heights of micrometres.
        assert!(node.pressure == 0.0 || node.separation.abs() < 1e-12, "{node:?}");
    }
}

/// At small slopes the block is the half-space: the difference vanishes with the elements and the
/// height of the block.
#[test]
fn small_slopes_have_the_friction_of_the_half_space() {
    // rms slope 0.044; thesis section 4.4.
    let (amplitude, pressure, speed) = (6.25e-7, 5.88e4, 0.01);
    let rubber = table_2_1();
    let friction = |amplitude, pressure, options| {
        let solution = contact(&rubber, speed, amplitude, options).solve(pressure).unwrap();
        assert_solved(&solution);
        solution.friction_coefficient
    };
    let half_space = |amplitude, pressure| {
        let heights = sine(amplitude).sample(4096);
        let mut contact = SlidingContact::new(&rubber, speed, PERIOD, &heights).unwrap();
        contact.solve(pressure).unwrap().friction_coefficient
    };
    let expected = half_space(amplitude, pressure);
    assert_relative_eq!(
        friction(amplitude, pressure, BlockOptions::new(64)),
        expected,
        max_relative = 0.01
    );
    // A fourth of the slope, so that the error of finite slopes is below that of the mesh.
    let (amplitude, pressure) = (0.25 * amplitude, 0.25 * pressure);
    let expected = half_space(amplitude, pressure);
    let errors = [32, 64, 128, 256].map(|columns| {
        let options = BlockOptions { height_ratio: 1.5, ..BlockOptions::new(columns) };
        (friction(amplitude, pressure, options) / expected - 1.0).abs()
    });
    assert!(errors.windows(2).all(|pair| pair[1] < pair[0]), "{errors:?}");
    assert!(errors[3] < 1e-3, "{errors:?}");
}

/// In full contact at a small slope the half-space has a closed form, and the mesh is refined at every depth: on
/// rows of one growth the error stays at 0.2 %.
#[test]
fn more_columns_refine_the_mesh_at_every_depth() {
    let (amplitude, pressure, speed) = (3e-8, 3e4, 0.01);
    let rubber = table_2_1();
    let heights = sine(amplitude).sample(4096);
    let mut half_space = SlidingContact::new(&rubber, speed, PERIOD, &heights).unwrap();
    let exact = half_space.solve(pressure).unwrap().friction_coefficient;
    let errors = [64, 128].map(|columns| {
        let options = BlockOptions::of_profile(columns, &sine(amplitude));
        let options = BlockOptions { height_ratio: 1.5, ..options };
        let solution = contact(&rubber, speed, amplitude, options).solve(pressure).unwrap();
        assert_solved(&solution);
        assert_relative_eq!(solution.contact_area_fraction, 1.0, max_relative = 1e-12);
        (solution.friction_coefficient / exact - 1.0).abs()
    });
    assert!(errors[0] < 2e-3 && errors[1] < 0.6 * errors[0], "{errors:?}");
}

/// Eight decades of speed, over which branches go from following at once to not at all: the stress of those that
/// follow at once must not come from differences of strains of order one.
#[test]
fn full_contact_of_a_tiny_slope_is_exact_over_eight_decades_of_speed() {
    // A slope of 1e-6.
    let (amplitude, pressure) = (1e-6 * PERIOD / std::f64::consts::TAU, 1e4);
    let rubber = table_2_1();
    for speed in [1e-6, 1e-4, 0.01, 1.0, 100.0] {
        let wave = SineScale { wavelength: PERIOD, amplitude };
        let half_space = FullContact { rubber: &rubber, wave, speed };
        let exact = half_space.friction_coefficient(pressure).unwrap();
        let options = BlockOptions::of_profile(128, &sine(amplitude));
        let solution = contact(&rubber, speed, amplitude, options).solve(pressure).unwrap();
        assert_solved(&solution);
        // The elements of this mesh, the same at each speed.
        assert_relative_eq!(solution.friction_coefficient, exact, max_relative = 1.5e-3);
    }
}

/// On a flat profile every node carries its share, at any height of the pressure.
#[test]
fn a_flat_profile_presses_uniformly_without_friction() {
    for pressure in [1e4, 1e6, 5e6, 2.5e7] {
        let solution =
            contact(&table_2_1(), 0.01, 0.0, BlockOptions::new(16)).solve(pressure).unwrap();
        assert_solved(&solution);
        assert_relative_eq!(solution.contact_area_fraction, 1.0, max_relative = 1e-12);
        assert!(solution.friction_coefficient.abs() < 1e-12);
        for node in &solution.nodes {
            assert_relative_eq!(node.pressure, pressure, max_relative = 1e-8);
        }
    }
}

/// In full contact, where the field has no edges, the work of the drag is the heat of the branches
/// to the accuracy of the flow rule; in partial contact the difference falls with the elements.
#[test]
fn the_work_of_the_drag_is_the_heat_of_the_branches() {
    let full = contact(&table_2_1(), 0.01, 3e-6, BlockOptions::new(128)).solve(2e6).unwrap();
    assert_relative_eq!(full.contact_area_fraction, 1.0, max_relative = 1e-12);
    assert_relative_eq!(full.friction_coefficient, full.hysteretic_friction, max_relative = 1e-5);
    let amplitude = shortest_wave().amplitude;
    let error = |columns| {
        let options = BlockOptions::new(columns);
        let solution = contact(&table_2_1(), 0.01, amplitude, options).solve(1e6).unwrap();
        (solution.hysteretic_friction / solution.friction_coefficient - 1.0).abs()
    };
    // Contact edges fall between nodes, so that one mesh is better by chance than the next.
    let errors = [32, 64, 128, 256].map(error);
    let finest = errors[2].max(errors[3]);
    assert!(finest < errors[0] / 10.0 && errors[3] < 1e-3, "{errors:?}");
}

#[test]
fn an_elastic_block_has_no_friction() {
    let rubber = Rubber::elastic(4.17e6, 0.49);
    let solution = contact(&rubber, 0.01, 6e-6, BlockOptions::new(64)).solve(5e5).unwrap();
    assert_solved(&solution);
    // Symmetric up to the residual.
    assert!(solution.friction_coefficient.abs() < 1e-7, "{}", solution.friction_coefficient);
    assert_eq!(solution.hysteretic_friction, 0.0);
}

/// Friction on both sides of its maximum by both routes. One branch, so that the drag forgets
/// its start within a few periods.
#[test]
fn both_routes_have_one_friction() {
    let (equilibrium, modulus, amplitude, pressure) = (4e6, 4e6, 5e-6, 3e5);
    let columns = 80;
    let friction = [0.1, 0.35, 1.2].map(|angular| {
        let speed = 0.01;
        let relaxation_time = angular * PERIOD / (std::f64::consts::TAU * speed);
        let rubber = Rubber {
            name: "one branch".into(),
            equilibrium_modulus: equilibrium,
            branches: vec![MaxwellBranch { modulus, relaxation_time }],
            poisson_ratio: 0.49,
            finite_strain: Default::default(),
        };
        let options = BlockOptions::new(columns);
        // On twice the columns, where its own error is a thousandth.
        let finer = BlockOptions::new(2 * columns);
        let steady = contact(&rubber, speed, amplitude, finer).solve(pressure).unwrap();
        let drag = TransientOptions {
            drag_periods: 6,
            averaged_periods: 1,
            ..TransientOptions::default()
        };
        let transient = TransientContact::new(
            &rubber,
            Rheology::NeoHookean,
            speed,
            sine(amplitude),
            options.mesh(PERIOD),
            drag,
        )
        .unwrap()
        .run(pressure, |_| {})
        .unwrap();
        let [a, b] = [steady.friction_coefficient, transient.friction_coefficient.mean];
        assert_relative_eq!(a, b, max_relative = 5e-3);
        a
    });
    assert!(friction[1] > friction[0] && friction[1] > friction[2], "{friction:?}");
}

/// Friction must not depend on how a path reached its pressure.
#[test]
fn a_continued_path_ends_where_a_new_one_does() {
    let amplitude = shortest_wave().amplitude;
    let mut continued = contact(&table_2_1(), 0.01, amplitude, BlockOptions::new(32));
    for pressure in [2e5, 1.2e6, 5e5] {
        let a = continued.solve(pressure).unwrap();
        let b =
            contact(&table_2_1(), 0.01, amplitude, BlockOptions::new(32)).solve(pressure).unwrap();
        assert_solved(&a);
        // The residuals of both.
        assert_relative_eq!(a.friction_coefficient, b.friction_coefficient, max_relative = 1e-7);
    }
}

/// One wave at 3.31 MPa: physics.md has 0.545 +- 0.001 from two other codes.
#[test]
fn a_strongly_sheared_block_has_the_friction_of_other_codes() {
    let amplitude = shortest_wave().amplitude;
    let solution =
        contact(&table_2_1(), 0.01, amplitude, BlockOptions::new(128)).solve(3.31e6).unwrap();
    assert_solved(&solution);
    assert!(
        (solution.friction_coefficient - 0.545).abs() < 2e-3,
        "{}",
        solution.friction_coefficient
    );
    assert!(solution.shear > 1.0);
}

/// One wave at large pressures, in less than a hundred Newton steps from scratch: friction of another
/// code of the same equations, which converged to 1e-3 between 64 and 128 columns; the heat of the
/// branches on 96 columns.
#[test]
fn large_pressures_are_solved_whatever_the_shear() {
    let amplitude = shortest_wave().amplitude;
    let expected = [
        (0.01, [(8.07e6, 0.4483), (1.2e7, 0.3887), (1.8e7, 0.3321), (2.5e7, 0.2957)].as_slice()),
        (0.05, [(8e6, 0.5539), (1.6e7, 0.4308), (2.5e7, 0.3626)].as_slice()),
    ];
    for (speed, points) in expected {
        for (pressure, friction) in points {
            let [coarse, fine] = [64, 96].map(|columns| {
                contact(&table_2_1(), speed, amplitude, BlockOptions::new(columns))
                    .solve(*pressure)
                    .unwrap()
            });
            for solution in [&coarse, &fine] {
                assert_solved(solution);
                assert!(solution.newton_steps < 100, "{}", solution.newton_steps);
            }
            let [coarse, fine, heat] =
                [coarse.friction_coefficient, fine.friction_coefficient, fine.hysteretic_friction];
            assert_relative_eq!(coarse, fine, max_relative = 2e-3);
            assert_relative_eq!(fine, *friction, max_relative = 1e-3);
            assert_relative_eq!(heat, fine, max_relative = 7e-3);
        }
    }
}

/// The columns stand above their points of the profile: a shear of 6 slants no element.
#[test]
fn contact_nodes_stand_at_equal_distances_however_large_the_shear() {
    let amplitude = shortest_wave().amplitude;
    let solution =
        contact(&table_2_1(), 0.05, amplitude, BlockOptions::new(64)).solve(2.5e7).unwrap();
    assert!(solution.shear > 6.0, "{}", solution.shear);
    for (j, node) in solution.nodes.iter().enumerate() {
        assert_relative_eq!(node.x, j as f64 * PERIOD / 64.0, epsilon = 1e-15);
    }
}

/// Rows that coarsen with depth change friction and heat by less than a thousandth, and the area by what
/// is left of a node's force at its edges.
#[test]
fn coarsening_rows_change_little() {
    let amplitude = shortest_wave().amplitude;
    let [uniform, coarsened] = [false, true].map(|coarsening| {
        let options = BlockOptions { coarsening, ..BlockOptions::new(256) };
        contact(&table_2_1(), 0.01, amplitude, options).solve(2e6).unwrap()
    });
    let area = |solution: &SteadySolution| solution.contact_area_fraction;
    for (a, b, tolerance) in [
        (uniform.friction_coefficient, coarsened.friction_coefficient, 1e-3),
        (uniform.hysteretic_friction, coarsened.hysteretic_friction, 1e-3),
        (area(&uniform), area(&coarsened), 5e-3),
    ] {
        assert_relative_eq!(a, b, max_relative = tolerance);
    }
}

#[test]
fn the_pressure_of_an_area_is_found() {
    let amplitude = shortest_wave().amplitude;
    for fraction in [0.02, 0.1, 0.25] {
        let mut contact = contact(&table_2_1(), 0.01, amplitude, BlockOptions::new(64));
        let solution = contact.solve_for_area(fraction, 1e-3).unwrap();
        assert_solved(&solution);
        assert_relative_eq!(solution.contact_area_fraction, fraction, max_relative = 1e-3);
    }
}

/// Whatever is asked for: a solution, or an error with the last point that was one.
#[test]
fn every_case_is_solved_or_says_where_the_path_ended() {
    let mut solved = 0;
    let mut cases = 0;
    for amplitude in [2e-6, 1.867e-5, 3.125e-5] {
        for speed in [1e-4, 1e-2, 1.0] {
            for (pressure, rheology) in [
                (5e4, Rheology::NeoHookean),
                (1e6, Rheology::NeoHookean),
                (2e7, Rheology::NeoHookean),
                (2e5, Rheology::Linear),
            ] {
                cases += 1;
                let options = BlockOptions::new(32);
                let mut contact =
                    SteadyContact::new(&table_2_1(), rheology, speed, sine(amplitude), options)
                        .unwrap();
                match contact.solve(pressure) {
                    Ok(solution) => {
                        assert_solved(&solution);
                        assert_eq!(solution.mean_pressure, pressure);
                        solved += 1;
                    }
                    Err(FemError::PathEnded { wanted, reached, .. }) => {
                        assert_eq!(wanted, pressure);
                        if let PathEnd::At { pressure: last, friction_coefficient, .. } = reached {
                            assert!(last < pressure && friction_coefficient.is_finite());
                        }
                    }
                    Err(error) => panic!("{error}"),
                }
            }
        }
    }
    assert!(solved >= cases / 2, "{solved} of {cases}");
}

/// Random slopes, speeds, pressures and laws; prints how many were solved and which were not.
#[test]
#[ignore = "takes ten minutes of processor time"]
fn four_hundred_random_cases_are_solved_or_refused_with_their_last_point() {
    let mut refused = Vec::new();
    for case in 0..400 {
        let mut generator = Pcg64::seed_from_u64(1000 + case);
        let mut between = |low: f64, high: f64| low + (high - low) * generator.random::<f64>();
        let rheology =
            if between(0.0, 1.0) < 0.5 { Rheology::NeoHookean } else { Rheology::Linear };
        let speed = 10_f64.powf(between(-4.0, 0.0));
        let pressure = 1e6 * 10_f64.powf(between(0.05_f64.log10(), 25_f64.log10()));
        let slope = between(0.05, 2.2);
        let profile = sine(slope * PERIOD / std::f64::consts::TAU);
        let options = BlockOptions::new(64);
        let mut contact =
            SteadyContact::new(&table_2_1(), rheology, speed, profile, options).unwrap();
        match contact.solve(pressure) {
            Ok(solution) => assert_solved(&solution),
            Err(FemError::PathEnded { reached, .. }) => {
                println!(
                    "{case}: {rheology:?}, {speed} m/s, {pressure} Pa, slope {slope}: {reached:?}"
                );
                refused.push(rheology);
            }
            Err(error) => panic!("{error}"),
        }
    }
    println!("{} of 400 solved", 400 - refused.len());
    // Paths of the linear law end where its shear stress does not grow any more.
    assert!(refused.iter().all(|rheology| *rheology == Rheology::Linear), "{refused:?}");
    assert!(refused.len() < 60, "{}", refused.len());
}

#[test]
fn bad_numbers_are_named() {
    let rubber = table_2_1();
    let new = |speed, options| {
        SteadyContact::new(&rubber, Rheology::NeoHookean, speed, sine(1e-6), options)
            .err()
            .unwrap()
            .to_string()
    };
    assert!(new(0.0, BlockOptions::new(64)).contains("the speed in m/s is 0"));
    assert!(new(0.01, BlockOptions::new(4)).contains("the number of columns is 4"));
    let flat = BlockOptions { height_ratio: 0.0, ..BlockOptions::new(64) };
    assert!(new(0.01, flat).contains("the height of the block in periods is 0"));
    let mut contact = contact(&rubber, 0.01, 1e-6, BlockOptions::new(16));
    assert!(contact.solve(f64::NAN).unwrap_err().to_string().contains("NaN"));
    assert!(
        contact.solve_for_area(1.0, 0.1).unwrap_err().to_string().contains("area fraction is 1")
    );
}
