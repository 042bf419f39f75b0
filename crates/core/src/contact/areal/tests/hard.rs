//! Extreme numbers, and input that is refused.

use super::*;
use crate::contact::ContactError;
use crate::rubber::MaxwellBranch;

#[test]
fn odd_prime_and_oblong_grids_with_unequal_spacings_converge() {
    let rubber = Rubber::table_2_1();
    for (points, periods) in [
        ([61, 47], [1e-3, 1e-3]),
        ([97, 32], [1e-3, 0.2e-3]),
        ([64, 131], [0.7e-3, 2e-3]),
        ([150, 2], [1e-3, 1e-4]),
        ([3, 200], [1e-5, 1e-3]),
    ] {
        let heights = rough(points, 6, 0.2);
        let mut areal = contact(&rubber, 0.02, 0.5, &heights, points, periods);
        for pressure in [1e4, 1e6] {
            let solution = areal.solve(pressure).unwrap();
            assert_complementary(&solution);
        }
    }
}

#[test]
fn areas_from_next_to_nothing_to_next_to_all_are_met_at_all_speeds() {
    let rubber = Rubber::table_2_1();
    let points = [128, 120];
    let heights = rough(points, 10, 0.3);
    for speed in [0.0, 1e-9, 0.05, 1.0, 30.0, 1e3] {
        let mut areal = contact(&rubber, speed, 0.3, &heights, points, [1e-3, 1e-3]);
        let mut previous: Option<ArealSolution> = None;
        for area in [1e-4, 0.01, 0.2, 0.8, 0.99, 0.9999] {
            // The area of a lossy rubber jumps where a contact spreads by one of the 15360 points.
            let tolerance = (1.0_f64 / (15360.0 * area)).clamp(1e-4, 0.5);
            let solution = areal.solve_for_area(area, tolerance).unwrap();
            assert_complementary(&solution);
            if let Some(before) = previous {
                assert!(solution.mean_pressure > before.mean_pressure);
                assert!(solution.mean_separation < before.mean_separation);
                assert!(solution.points_in_contact > before.points_in_contact);
            }
            // The work on the slopes is known to the error by which few points resolve a contact.
            let (work, power) = (solution.friction_coefficient, solution.hysteretic_friction);
            let unresolved = 0.3 / (solution.points_in_contact * 15360.0).sqrt();
            assert!((work - power).abs() <= unresolved, "{speed} {area}: {work} {power}");
            assert!(power >= 0.0);
            previous = Some(solution);
        }
    }
}

#[test]
fn a_modulus_ratio_of_ten_thousand_converges_at_all_speeds() {
    let rubber = Rubber {
        name: "hard".into(),
        equilibrium_modulus: 1e6,
        branches: vec![MaxwellBranch { modulus: 1e10, relaxation_time: 1e-4 }],
        poisson_ratio: 0.5,
        finite_strain: Default::default(),
    };
    let points = [64, 64];
    let heights = rough(points, 6, 0.3);
    for speed in [1e-9, 1e-6, 1e-3, 1.0, 1e3] {
        let mut areal = contact(&rubber, speed, 0.0, &heights, points, [1e-3, 1e-3]);
        for area in [0.02, 0.3] {
            // One of the 4096 points.
            let solution = areal.solve_for_area(area, 1.0 / (4096.0 * area)).unwrap();
            assert_complementary(&solution);
        }
    }
}

/// A search for an area ends with pressures that differ by next to nothing.
#[test]
fn a_start_that_is_nearly_the_solution_is_brought_to_it() {
    let rubber = Rubber::table_2_1();
    let points = [96, 96];
    let heights = rough(points, 12, 0.3);
    let mut areal = contact(&rubber, 0.05, 0.0, &heights, points, [1e-3, 1e-3]);
    let solution = areal.solve(3e5).unwrap();
    for change in [1e-4, 1e-7, 1e-9, 1e-10, 1e-13] {
        let near = areal.solve_near(3e5 * (1.0 + change), solution.pressure.clone()).unwrap();
        assert_complementary(&near);
        let rise = near.mean_pressure / solution.mean_pressure - 1.0;
        approx::assert_relative_eq!(rise, change, max_relative = 1e-2);
    }
}

#[test]
fn flat_plateaus_and_a_single_spike_are_carried() {
    let rubber = Rubber::table_2_1();
    let points = [64, 48];
    let plateau = |k: usize| if (k % 64 / 8 + k / 64 / 8).is_multiple_of(3) { 2e-5 } else { 0.0 };
    let plateaus: Vec<f64> = (0..64 * 48).map(plateau).collect();
    let mut spike = vec![0.0; 64 * 48];
    // Off the coarser grids.
    spike[33 * 64 + 17] = 1e-5;
    for speed in [0.0, 0.1] {
        let solve = |heights: &[f64], pressure| {
            let mut areal = contact(&rubber, speed, 0.2, heights, points, [1e-3, 1e-3]);
            let solution = areal.solve(pressure).unwrap();
            assert_complementary(&solution);
            solution
        };
        assert!(solve(&plateaus, 1e4).points_in_contact < 0.4);
        let on_spike = solve(&spike, 1.0);
        assert_eq!(on_spike.points_in_contact, 1.0 / (64.0 * 48.0));
        assert!(on_spike.contact_area_fraction <= 1.0 / (64.0 * 48.0));
        assert!(solve(&spike, 1e6).points_in_contact > 0.5);
    }
    // No roughness at all: full contact under any pressure.
    let mut flat = contact(&rubber, 0.1, 0.0, &[3.3; 64 * 48], points, [1e-3, 1e-3]);
    let solution = flat.solve(1.0).unwrap();
    assert_eq!((solution.contact_area_fraction, solution.friction_coefficient), (1.0, 0.0));
    let error = flat.solve_for_area(0.5, 1e-3).unwrap_err();
    assert!(matches!(error, ContactError::AreaNotReached { found: 1.0, .. }), "{error}");
}

#[test]
fn area_grows_smoothly_with_pressure_and_less_raggedly_than_points() {
    let rubber = Rubber::elastic(3e6, 0.5);
    let points = [96, 96];
    let heights = rough(points, 8, 0.3);
    let mut areal = contact(&rubber, 0.0, 0.0, &heights, points, [1e-3, 1e-3]);
    let curve: Vec<[f64; 2]> = (0..40)
        .map(|k| areal.solve(2e5 * 1.005_f64.powi(k)).unwrap())
        .map(|s| [s.contact_area_fraction, s.points_in_contact])
        .collect();
    // Root mean square second difference.
    let ragged = |which: usize| {
        let second = |w: &[[f64; 2]]| (w[0][which] - 2.0 * w[1][which] + w[2][which]).powi(2);
        curve.windows(3).map(second).sum::<f64>().sqrt()
    };
    assert!(ragged(0) < 0.5 * ragged(1), "{:e} {:e}", ragged(0), ragged(1));
    assert!(curve.windows(2).all(|w| w[1][0] > w[0][0]));
}

#[test]
fn input_without_a_contact_is_refused_with_its_reason() {
    let rubber = Rubber::table_2_1();
    let points = [8, 6];
    let good = rough(points, 2, 0.3);
    let with = |change: &dyn Fn(&mut ArealSetup)| {
        let sliding = Sliding { speed: 0.1, angle: 0.0 };
        let surface = ArealSurface { heights: &good, points, periods: [1e-3, 1e-3] };
        let mut setup =
            ArealSetup { rubber: &rubber, sliding, surface, thickness: None, memory_limit: None };
        change(&mut setup);
        ArealContact::new(&setup).err()
    };
    assert_eq!(with(&|_| {}), None);
    for (column, row, value) in [(3, 2, f64::NAN), (0, 0, f64::INFINITY), (7, 5, f64::NEG_INFINITY)]
    {
        let mut heights = good.clone();
        heights[row * 8 + column] = value;
        let surface = ArealSurface { heights: &heights, points, periods: [1e-3, 1e-3] };
        let sliding = Sliding { speed: 0.1, angle: 0.0 };
        let setup =
            ArealSetup { rubber: &rubber, sliding, surface, thickness: None, memory_limit: None };
        let Some(ContactError::BadHeightOfSurface { column: c, row: r, .. }) =
            ArealContact::new(&setup).err()
        else {
            panic!("{column} {row} is accepted")
        };
        assert_eq!((c, r), (column, row));
    }
    let out_of_range: [&dyn Fn(&mut ArealSetup); 8] = [
        &|s| s.sliding.speed = f64::NAN,
        &|s| s.sliding.angle = f64::INFINITY,
        &|s| s.surface.periods[1] = 0.0,
        &|s| s.surface.periods[0] = f64::NAN,
        &|s| s.surface.points = [8, 7],
        &|s| s.surface.points = [48, 1],
        &|s| s.thickness = Some(0.0),
        &|s| s.thickness = Some(f64::NAN),
    ];
    for (index, change) in out_of_range.iter().enumerate() {
        let error = with(change);
        assert!(matches!(error, Some(ContactError::OutOfRange { .. })), "{index}: {error:?}");
    }
    let limit = memory_bytes(8, 6);
    assert_eq!(with(&|s| s.memory_limit = Some(limit)), None);
    let error = with(&|s| s.memory_limit = Some(limit - 1));
    assert_eq!(error, Some(ContactError::TooMuchMemory { needed: limit, limit: limit - 1 }));
    let mut areal = contact(&rubber, 0.1, 0.0, &good, points, [1e-3, 1e-3]);
    for pressure in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = areal.solve(pressure).unwrap_err();
        assert!(matches!(error, ContactError::OutOfRange { .. }), "{error}");
    }
    for (area, tolerance) in [(0.0, 0.1), (1.1, 0.1), (f64::NAN, 0.1), (0.5, 0.0), (0.5, 1.0)] {
        let error = areal.solve_for_area(area, tolerance).unwrap_err();
        assert!(matches!(error, ContactError::OutOfRange { .. }), "{error}");
    }
    // Full contact beyond the reach of double precision.
    let error = areal.solve(1e100).unwrap_err();
    assert!(matches!(error, ContactError::NotConverged { .. }), "{error}");
}

#[test]
fn four_thousand_points_square_stay_below_four_gibibytes() {
    assert!(memory_bytes(4096, 4096) < 4 << 30);
    assert_eq!(memory_bytes(usize::MAX, 2), u64::MAX);
}

#[test]
fn an_interrupt_ends_a_solve_and_is_no_answer() {
    use crate::numerics::Interrupt;
    let rubber = Rubber::table_2_1();
    let points = [64, 64];
    let heights = rough(points, 6, 0.3);
    let interrupt = Interrupt::default();
    let sliding = Sliding { speed: 0.1, angle: 0.0 };
    let surface = ArealSurface { heights: &heights, points, periods: [1e-3, 1e-3] };
    let setup =
        ArealSetup { rubber: &rubber, sliding, surface, thickness: None, memory_limit: None };
    let mut areal = ArealContact::new_interruptible(&setup, &interrupt).unwrap();
    areal.solve(1e5).unwrap();
    interrupt.set();
    assert_eq!(areal.solve(1e5), Err(ContactError::Interrupted));
    assert_eq!(areal.solve_for_area(0.1, 1e-2), Err(ContactError::Interrupted));
    assert!(ArealContact::new_interruptible(&setup, &interrupt).is_err());
}
