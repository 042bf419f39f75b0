//! Nearly incompressible and far too steep: finite elements.

use crate::case::{Case, enter_refusal};
use crate::surfaces::{shortest_wave, table_2_1};
use asperity::contact::SlidingContact;
use asperity::contact::refine::{FINITE_ELEMENTS, OnGrid, RefineError, Refinement, Watched};
use asperity::fem::error::FemError;
use asperity::fem::profile::RigidProfile;
use asperity::fem::steady::{BlockOptions, SteadyContact, solution::SteadySolution};
use asperity::rubber::{Rheology, Rubber, RubberError};
use asperity::surface::Wave;

/// The residual that a solution of finite elements is promised to hold.
const FEM_RESIDUAL: f64 = 1e-8;

/// Ratio of bulk to shear modulus, by which incompressibility makes the stiffness ill-conditioned.
fn bulk_over_shear(nu: f64) -> f64 {
    2.0 * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu))
}

fn sine(amplitude: f64) -> RigidProfile {
    let wavelength = shortest_wave().wavelength;
    RigidProfile::from_waves(&[Wave { wavelength, amplitude, phase: 0.0 }], wavelength)
}

/// At small slopes the block is the half-space, whatever the Poisson ratio. Elements that lock
/// are too stiff by `1 / (1 - 2 nu)`: their friction would be off by a factor.
#[test]
fn a_poisson_ratio_of_0_499_does_not_lock() {
    let rubber = Rubber { poisson_ratio: 0.499, ..table_2_1() };
    // A slope and a pressure a fourth of those of physics.md section 4, so that what finite slopes
    // change is below the error of the mesh.
    let (amplitude, pressure, speed) = (1.5625e-7, 1.47e4, 0.01);
    let period = shortest_wave().wavelength;
    let heights = sine(amplitude).sample(4096);
    let mut half_space = SlidingContact::new(&rubber, speed, period, &heights).unwrap();
    let half_space = half_space.solve(pressure).unwrap().friction_coefficient;
    // Of first order in the elements, of which 14 of a hundred are in contact: locking would be a
    // factor of hundreds.
    for (columns, tolerance) in [(32, 2e-2), (64, 1e-2), (128, 5e-3)] {
        let mut case = Case::new(
            "nu = 0.499 in the FEM, small slope",
            format!("{columns} columns"),
            "friction of the half-space",
        );
        let options = BlockOptions { height_ratio: 1.5, ..BlockOptions::new(columns) };
        let mut contact =
            SteadyContact::new(&rubber, Rheology::NeoHookean, speed, sine(amplitude), options)
                .unwrap();
        let solution = contact.solve(pressure).unwrap();
        case.solved_to(FEM_RESIDUAL, solution.residual, solution.newton_steps as u64);
        case.conditioned(bulk_over_shear(rubber.poisson_ratio));
        case.agrees(solution.friction_coefficient, half_space, tolerance);
        case.enter();
    }
}

/// At the slope of the thesis there is no formula; 0.499 lies between 0.49 and 0.4999, by steps in
/// `1 - 2 nu` of ten each.
#[test]
fn a_poisson_ratio_of_0_499_is_a_small_step_from_0_49() {
    let friction = |case: &mut Case, nu: f64| {
        let rubber = Rubber { poisson_ratio: nu, ..table_2_1() };
        let profile = sine(shortest_wave().amplitude);
        let options = BlockOptions::new(32);
        let mut contact =
            SteadyContact::new(&rubber, Rheology::NeoHookean, 0.01, profile, options).unwrap();
        let solution = contact.solve(2e5).unwrap();
        println!(
            "{nu} {} {} {}",
            solution.friction_coefficient,
            solution.hysteretic_friction,
            solution.contact_area_fraction
        );
        case.solved_to(FEM_RESIDUAL, solution.residual, solution.newton_steps as u64);
        case.conditioned(bulk_over_shear(nu));
        solution.friction_coefficient
    };
    let mut case = Case::new(
        "nu = 0.499 in the FEM, rms slope 1.3",
        "32 columns",
        "friction from nu = 0.49 and 0.4999, linear in 1 - 2 nu",
    );
    let [low, middle, high] = [0.49, 0.499, 0.4999].map(|nu| friction(&mut case, nu));
    let (distance, whole) = (0.4999 - 0.499, 0.4999 - 0.49);
    let between = high + (low - high) * distance / whole;
    // Terms of second order in the distance, 2e-2 of compressibility squared.
    case.agrees(middle, between, 4e-4);
    case.enter();
}

#[test]
fn an_incompressible_block_is_refused() {
    let rubber = Rubber { poisson_ratio: 0.5, ..table_2_1() };
    let options = BlockOptions::new(32);
    let new = SteadyContact::new(&rubber, Rheology::NeoHookean, 0.01, sine(1e-6), options);
    let error = new.err().unwrap();
    let name = rubber.name.clone();
    let expected = RubberError::NotCompressible { rubber: name, value: 0.5, limit: 0.4999 };
    assert_eq!(error, FemError::Rubber(expected));
    enter_refusal("nu = 0.5 in the FEM", "32 columns", error);
}

/// What the drag of the profile says about friction, and what the heat in the rubber says.
fn drag_and_heat(case: &mut Case, steepness: f64, columns: usize, pressure: f64) -> [f64; 2] {
    let profile = sine(steepness * shortest_wave().wavelength);
    let rubber = table_2_1();
    let options = BlockOptions::new(columns);
    let mut contact =
        SteadyContact::new(&rubber, Rheology::NeoHookean, 0.01, profile, options).unwrap();
    let solution = contact.solve(pressure).unwrap();
    case.solved_to(FEM_RESIDUAL, solution.residual, solution.newton_steps as u64);
    case.conditioned(bulk_over_shear(rubber.poisson_ratio));
    [solution.friction_coefficient, solution.hysteretic_friction]
}

#[test]
fn steep_profiles_drag_as_much_as_they_heat() {
    for steepness in [0.3, 1.0] {
        let mut case = Case::new(
            "steep sine in the FEM",
            format!("128 columns, 1 MPa, amplitude over wavelength {steepness}"),
            "friction from the drag and from the heat",
        );
        let [drag, heat] = drag_and_heat(&mut case, steepness, 128, 1e6);
        // Of ten to twenty elements in contact, first order in their number: three parts in a hundred on
        // half the columns.
        case.agrees(drag, heat, 1e-2);
        case.enter();
    }
}

/// The shear stress of the linear law has a largest value: the path says where it ended.
#[test]
fn a_path_of_the_linear_law_that_ends_is_refused() {
    let profile = sine(shortest_wave().amplitude);
    let (rubber, options) = (table_2_1(), BlockOptions::new(32));
    let mut contact =
        SteadyContact::new(&rubber, Rheology::Linear, 0.01, profile, options).unwrap();
    let error = contact.solve(5e6).unwrap_err();
    let FemError::PathEnded { wanted: 5e6, columns: 32, .. } = error else { panic!("{error}") };
    enter_refusal("one wave under the linear law in the FEM", "32 columns, 5 MPa", error);
}

/// A tip that touches one element is solved to the residual and still worthless: the accuracy that
/// it is asked for is refused.
#[test]
fn a_tip_of_one_element_has_no_accuracy() {
    let refinement = Refinement {
        tolerance: 1e-2,
        watched: Watched::Friction,
        orders: FINITE_ELEMENTS,
        first: 16,
        most: 64,
    };
    let profile = || sine(shortest_wave().wavelength);
    let solve = |columns: usize| {
        let options = BlockOptions::of_profile(columns, &profile());
        SteadyContact::new(&table_2_1(), Rheology::NeoHookean, 0.01, profile(), options)?
            .solve(1e5)
            .map(|solution| Some((columns, solution)))
    };
    let view = |(columns, solution): &(usize, SteadySolution)| OnGrid {
        points: *columns,
        friction_coefficient: solution.friction_coefficient,
        contact_area_fraction: solution.contact_area_fraction,
    };
    let error = refinement.run(solve, view).unwrap_err();
    assert!(matches!(error, RefineError::NotReached { tolerance: 1e-2, .. }), "{error}");
    enter_refusal(
        "tip of one element in the FEM, accuracy 1e-2",
        "16 to 64 columns, 0.1 MPa, amplitude over wavelength 1",
        error,
    );
}
