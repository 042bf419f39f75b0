use super::block::TransientBlock;
use super::contact::{Contact, Multipliers};
use super::step::{Iterations, Load, State, Stepper};
use super::tangent::Tangent;
use super::*;
use crate::contact::SlidingContact;
use crate::fem::mesh::{Grading, Mesh};
use crate::fem::profile::RigidProfile;
use crate::rubber::{FiniteStrainRubber, MaxwellBranch, Rheology, Rubber};
use crate::surface::Wave;
use approx::assert_relative_eq;
use std::f64::consts::FRAC_PI_2;

const PERIOD: f64 = 0.0625e-3;

const LAWS: [Rheology; 4] = [
    Rheology::NeoHookean,
    Rheology::Linear,
    Rheology::Yeoh { c2_over_c1: -0.1, c3_over_c1: 0.01 },
    Rheology::ArrudaBoyce { locking_stretch: 2.0 },
];

/// A sine with its peak on a node.
fn sine(amplitude: f64) -> Wave {
    Wave { wavelength: PERIOD, amplitude, phase: FRAC_PI_2 }
}

fn profile(amplitude: f64) -> RigidProfile {
    RigidProfile::from_waves(&[sine(amplitude)], PERIOD)
}

fn mesh(columns: usize) -> Mesh {
    Mesh::graded(columns, PERIOD, 0.75 * PERIOD, Grading { first: 1.0, growth: 1.5 })
}

/// One branch that relaxes over a fraction of the period at 10 mm/s.
fn rubber() -> Rubber {
    Rubber {
        branches: vec![MaxwellBranch { modulus: 8e6, relaxation_time: 1e-3 }],
        ..Rubber::elastic(4e6, 0.49)
    }
}

fn contact(
    rubber: &Rubber,
    profile: RigidProfile,
    mesh: Mesh,
    options: TransientOptions,
) -> TransientContact {
    TransientContact::new(rubber, Rheology::NeoHookean, 0.01, profile, mesh, options).unwrap()
}

/// A drag just long enough for one averaged period.
fn short() -> TransientOptions {
    TransientOptions { drag_periods: 2, averaged_periods: 1, ..TransientOptions::default() }
}

/// Deterministic numbers between -1 and 1 without a pattern.
fn scattered(count: usize) -> impl Iterator<Item = f64> {
    (1..=count).map(|i| (12.9898 * i as f64).sin() * 43758.5453 % 1.0)
}

/// A block after one step under scattered displacements, and other displacements near them.
fn deformed(rheology: Rheology) -> (TransientBlock, Vec<f64>) {
    let mut mesh = mesh(4);
    mesh.skew = -0.2;
    let rubber = FiniteStrainRubber::new(&rubber(), rheology).unwrap();
    let mut block = TransientBlock::new(mesh, rubber);
    let size = 2 * 4 * (block.mesh().rows() + 1);
    let far = 0.1 * block.mesh().spacing();
    let first: Vec<f64> = scattered(size).map(|x| far * x).collect();
    let history = block.history(FlowRule::Trapezoidal, 1e-3);
    block.keep(&history, &first).unwrap();
    let second = first.iter().zip(scattered(2 * size).skip(size)).map(|(x, y)| x + far * y);
    let second = second.collect();
    (block, second)
}

#[test]
fn a_homogeneous_deformation_needs_only_edge_forces() {
    let (columns, skew) = (5, -0.4);
    let mut mesh = mesh(columns);
    mesh.skew = skew;
    for rheology in LAWS {
        let rubber = FiniteStrainRubber::new(&rubber(), rheology).unwrap();
        let block = TransientBlock::new(mesh.clone(), rubber);
        let history = block.history(FlowRule::Trapezoidal, 1e-3);
        let heights = mesh.node_heights();
        let nodes: Vec<f64> =
            heights.iter().flat_map(|z| [0.3 * z, -0.2 * z].repeat(columns)).collect();
        let elements = block.linearise(&history, &nodes).unwrap();
        let mut forces = vec![0.0; nodes.len()];
        for (index, element) in elements.iter().enumerate() {
            for (dof, force) in block.dofs(index).into_iter().zip(element.forces) {
                forces[dof] += force;
            }
        }
        let row = 2 * columns;
        let edge = forces[..row].iter().fold(0.0_f64, |most, f| most.max(f.abs()));
        let inner = &forces[row..forces.len() - row];
        // Round-off of some ten terms.
        assert!(inner.iter().all(|force| force.abs() < 1e-13 * edge), "{inner:?} {edge}");
    }
}

#[test]
fn stiffness_is_the_derivative_of_the_forces() {
    for rheology in LAWS {
        let (block, nodes) = deformed(rheology);
        for rule in [FlowRule::Trapezoidal, FlowRule::Exponential] {
            let history = block.history(rule, 2e-3);
            let elements = block.linearise(&history, &nodes).unwrap();
            let step = 1e-6 * block.mesh().spacing();
            for (index, element) in elements.iter().enumerate() {
                for (j, dof) in block.dofs(index).into_iter().enumerate() {
                    let forces = |change: f64| {
                        let mut nodes = nodes.clone();
                        nodes[dof] += change;
                        block.linearise(&history, &nodes).unwrap()[index].forces
                    };
                    let (after, before) = (forces(step), forces(-step));
                    for i in 0..8 {
                        let exact = element.stiffness[i][j];
                        let difference = (after[i] - before[i]) / (2.0 * step);
                        let scale = element.stiffness[i][i];
                        // Round-off 1e-16 over the step 1e-6, some hundredfold cancellation.
                        assert_relative_eq!(exact, difference, epsilon = 1e-7 * scale.abs());
                    }
                }
            }
        }
    }
}

#[test]
fn contact_stiffness_is_the_derivative_of_the_forces() {
    let n = 6;
    let mesh = mesh(n);
    let profile = profile(0.01867e-3);
    let multipliers =
        Multipliers { values: scattered(n).map(|x| 1e6 * (1.0 + x)).collect(), penalty: 1e13 };
    let edge: Vec<f64> = scattered(2 * n).map(|x| 0.2 * mesh.spacing() * x).collect();
    let at = |edge: &[f64]| Contact::at(&mesh, &profile, edge, &multipliers);
    let forces = |edge: &[f64]| {
        let mut forces = vec![0.0; 2 * n];
        at(edge).add_forces(-1.0, &mut forces);
        forces
    };
    let contact = at(&edge);
    assert!(contact.active.contains(&true) && contact.active.contains(&false));
    let mut stiffness = vec![vec![0.0; 2 * n]; 2 * n];
    for node in 0..n {
        let dofs = Contact::dofs(n, node);
        let penalty = contact.penalty_stiffness(node);
        for (row, i) in penalty.iter().zip(dofs) {
            row.iter().zip(dofs).for_each(|(k, j)| stiffness[i][j] += k);
        }
        let ends = [dofs[2], dofs[4]];
        for (row, i) in contact.curvature_stiffness(node).iter().zip(ends) {
            row.iter().zip(ends).for_each(|(k, j)| stiffness[i][j] += k);
        }
    }
    let largest = stiffness.iter().flatten().fold(0.0_f64, |most, k| most.max(k.abs()));
    let step = 1e-5 * mesh.spacing();
    for j in 0..2 * n {
        let moved = |change: f64| {
            let mut edge = edge.clone();
            edge[j] += change;
            forces(&edge)
        };
        let (after, before) = (moved(step), moved(-step));
        for i in 0..2 * n {
            let difference = (after[i] - before[i]) / (2.0 * step);
            // The error of a difference grows with the square of the step.
            assert_relative_eq!(stiffness[i][j], difference, epsilon = 1e-8 * largest);
        }
    }
}

#[test]
fn a_flat_profile_presses_uniformly() {
    let mesh = mesh(12);
    let flat = RigidProfile::from_waves(&[], PERIOD);
    let rubber = FiniteStrainRubber::new(&rubber(), Rheology::NeoHookean).unwrap();
    let block = TransientBlock::new(mesh.clone(), rubber);
    let stepper = Stepper {
        profile: flat,
        tangent: Tangent::new(&block).unwrap(),
        flow: FlowRule::Trapezoidal,
        // Small against what a pressure of 1e-12 of the load moves through the penalty.
        largest_violation: 1e-19,
    };
    let state = State {
        nodes: vec![0.0; 2 * 12 * (mesh.rows() + 1)],
        multipliers: Multipliers { values: vec![0.0; 12], penalty: 1e13 },
    };
    let load = Load { pressure: 1e6, displacement: 0.2 * PERIOD };
    let mut iterations = Iterations::default();
    let (state, contact, _) = stepper.advance(&block, state, load, 1e-4, &mut iterations).unwrap();
    for (pressure, gap) in contact.pressures.iter().zip(&contact.gaps) {
        // Newton ends at 1e-8 of the load but its last step squares that.
        assert_relative_eq!(*pressure, 1e6, max_relative = 1e-12);
        assert!(gap.abs() < 1e-12 * mesh.height(), "{gap}");
    }
    let upper = state.nodes.len() - 2 * 12;
    let heights = || state.nodes[upper + 1..].iter().step_by(2);
    assert!(heights().all(|z| (z - state.nodes[upper + 1]).abs() < 1e-12 * mesh.height()));
    assert_relative_eq!(contact.area_fraction, 1.0, max_relative = 1e-14);
    assert_eq!(contact.resultants().0, 0.0);
}

#[test]
fn an_elastic_block_slides_without_friction() {
    let elastic = Rubber::elastic(4e6, 0.49);
    let options = TransientOptions { steps_per_period: Some(40), ..short() };
    let solution = contact(&elastic, profile(0.01e-3), mesh(16), options).run(5e5, |_| ()).unwrap();
    let friction = &solution.friction_coefficient;
    // Forces oscillate as nodes pass the peak; five positions between two nodes average that out.
    assert!(friction.mean.abs() < 1e-3 && friction.range > 1e-3, "{friction:?}");
    assert_eq!(solution.energy.dissipated, 0.0);
}

#[test]
fn the_work_of_the_drag_is_dissipated_or_stored() {
    let imbalance = |steps: usize| {
        let options = TransientOptions {
            steps_per_period: Some(steps),
            drag_periods: 1,
            press_steps: steps,
            ..short()
        };
        let solution =
            contact(&rubber(), profile(0.005e-3), mesh(12), options).run(5e5, |_| ()).unwrap();
        let energy = solution.samples[solution.samples.len() - 1].energy;
        energy.imbalance() / energy.dissipated
    };
    let (coarse, fine) = (imbalance(24), imbalance(96));
    // At least first order: contact nodes change sides within a step.
    assert!(fine.abs() < 0.25 * coarse.abs() && fine.abs() < 2e-3, "{coarse} {fine}");
}

#[test]
fn flow_rules_agree_for_short_steps() {
    let friction = |flow, steps| {
        let options = TransientOptions { flow, steps_per_period: Some(steps), ..short() };
        let contact = contact(&rubber(), profile(0.005e-3), mesh(12), options);
        contact.run(3e5, |_| ()).unwrap().friction_coefficient.mean
    };
    let difference = |steps| {
        (friction(FlowRule::Exponential, steps) / friction(FlowRule::Trapezoidal, steps) - 1.0)
            .abs()
    };
    let (coarse, fine) = (difference(12), difference(48));
    assert!(fine < 0.25 * coarse && fine < 2e-3, "{coarse} {fine}");
}

#[test]
fn a_small_slope_has_the_friction_of_the_half_space() {
    let wave = sine(0.01 * PERIOD);
    let heights = crate::surface::wave::sample(&[wave], PERIOD, 1024);
    let rubber = rubber();
    let pressure = 1.5e5;
    let exact = SlidingContact::new(&rubber, 0.01, PERIOD, &heights)
        .unwrap()
        .solve(pressure)
        .unwrap()
        .friction_coefficient;
    let errors = [12, 24].map(|columns| {
        let options = TransientOptions {
            drag_periods: 3,
            flow: FlowRule::Exponential,
            steps_per_period: Some(48),
            ..short()
        };
        let contact = contact(&rubber, profile(0.01 * PERIOD), mesh(columns), options);
        contact.run(pressure, |_| ()).unwrap().friction_coefficient.mean / exact - 1.0
    });
    // The mesh, and the square of the slope, 0.4 %, by which the theories differ.
    assert!(errors[1].abs() < errors[0].abs() && errors[0].abs() < 0.01, "{errors:?}");
}

#[test]
fn the_time_of_pressing_in_does_not_change_the_steady_part() {
    let friction = [2e-3, 2e-2].map(|press_time| {
        let options = TransientOptions { press_time: Some(press_time), drag_periods: 7, ..short() };
        let contact = contact(&rubber(), profile(0.005e-3), mesh(12), options);
        contact.run(3e5, |_| ()).unwrap().friction_coefficient.mean
    });
    // A dead load creeps with the retardation time τ (E_inf + E_1) / E_inf. The six periods
    // before are twelve of it: e^-12 is left.
    assert_relative_eq!(friction[0], friction[1], max_relative = 1e-4);
}

#[test]
fn the_end_of_the_series_is_the_end_of_the_drag() {
    let contact = contact(&rubber(), profile(0.005e-3), mesh(12), short());
    let mut seen = Vec::new();
    let solution = contact.run(3e5, |sample| seen.push(*sample)).unwrap();
    assert_eq!(seen, solution.samples);
    assert_eq!(seen.len(), solution.counts.steps + 1);
    let last = seen[seen.len() - 1];
    assert_relative_eq!(last.displacement, 2.0 * PERIOD, max_relative = 1e-9);
    assert_eq!(last.pressure, 3e5);
}

#[test]
fn too_much_pressure_stops_with_the_series_so_far() {
    // Rubber of 4 MPa cannot carry this on a few steep peaks of a coarse mesh.
    let contact = contact(&rubber(), profile(0.02e-3), mesh(8), short());
    let error = contact.run(1e9, |_| ()).unwrap_err();
    let TransientError::Stopped { time, pressure, ref samples, .. } = error else {
        panic!("{error}");
    };
    let last = samples[samples.len() - 1];
    assert_eq!((last.time, last.pressure), (time, pressure));
    assert!(pressure < 1e9 && error.to_string().contains("more columns"), "{error}");
}

#[test]
fn bad_numbers_are_named() {
    let new = |speed: f64, mesh: Mesh, options: TransientOptions| {
        let rubber = rubber();
        TransientContact::new(&rubber, Rheology::Linear, speed, profile(1e-6), mesh, options)
            .map(|_| ())
            .unwrap_err()
            .to_string()
    };
    assert!(new(0.0, mesh(8), short()).contains("speed"));
    assert!(new(f64::NAN, mesh(8), short()).contains("speed"));
    assert!(new(0.01, mesh(2), short()).contains("columns"));
    let mut long = mesh(8);
    long.period *= 2.0;
    assert!(new(0.01, long, short()).contains("period"));
    let options = TransientOptions { drag_periods: 1, averaged_periods: 2, ..short() };
    assert!(new(0.01, mesh(8), options).contains("the length of the drag"));
    let options = TransientOptions { penetration_tolerance: 0.0, ..short() };
    assert!(new(0.01, mesh(8), options).contains("the tolerance of the penetration"));
    let contact = contact(&rubber(), profile(1e-6), mesh(8), short());
    assert!(contact.run(-1.0, |_| ()).unwrap_err().to_string().contains("pressure"));
}
