//! The laws against their energies and limits.

use super::*;
use approx::assert_relative_eq;

const LAWS: [Rheology; 2] = [Rheology::NeoHookean, Rheology::Linear];

fn rubber(rheology: Rheology) -> FiniteStrainRubber {
    FiniteStrainRubber::new(&Rubber::table_2_1(), rheology).unwrap()
}

/// The measure of a law at a right Cauchy-Green tensor.
fn measure(law: Rheology, c: &Symmetric) -> Measure {
    law.measure(&[c[0] - 1.0, c[1] - 1.0, c[2]]).unwrap()
}

/// Shear and volumetric part of the second Piola-Kirchhoff stress.
fn stresses(
    rubber: &FiniteStrainRubber,
    spring: &Spring,
    measure: &Measure,
    internal: &Symmetric,
) -> [Symmetric; 2] {
    let strain = measure.value();
    let tensors = [&strain, internal, &difference(&strain, internal)];
    [
        measure.derivative(&rubber.shear_stress(spring, tensors)),
        measure.derivative(&rubber.volumetric_stress(spring, tensors)),
    ]
}

/// A strongly deformed state and one of its past.
fn states() -> [(Symmetric, Symmetric); 3] {
    [
        ([1.3, 0.9, 0.2], IDENTITY),
        ([0.6, 2.1, -0.4], [0.8, 1.5, 0.1]),
        ([4.0, 0.5, 1.1], [2.5, 0.9, -0.7]),
    ]
}

/// Derivative of a function of a symmetric tensor by central differences, as the tensor that
/// contracted with a change gives the change of the function.
fn derivative(function: impl Fn(&Symmetric) -> f64, at: &Symmetric) -> Symmetric {
    [0, 1, 2].map(|i| {
        let step = 1e-6;
        let shifted = |by: f64| {
            let mut c = *at;
            c[i] += by;
            function(&c)
        };
        let slope = (shifted(step) - shifted(-step)) / (2.0 * step);
        // The shear component stands twice in a contraction.
        if i == 2 { 0.5 * slope } else { slope }
    })
}

#[test]
fn stress_is_the_derivative_of_the_energy() {
    for law in LAWS {
        let rubber = rubber(law);
        for (c, past) in states() {
            let spring = rubber.branches[2];
            let internal = measure(law, &past).value();
            let energy =
                |c: &Symmetric| rubber.energy(&spring, &measure(law, c).value(), &internal);
            let slope = derivative(energy, &c);
            let [shear, volumetric] = stresses(&rubber, &spring, &measure(law, &c), &internal);
            for i in 0..3 {
                let stress = shear[i] + volumetric[i];
                // Differences of energies of 1e9 Pa.
                assert_relative_eq!(stress, 2.0 * slope[i], max_relative = 1e-6, epsilon = 10.0);
            }
        }
    }
}

#[test]
fn heat_is_what_the_energy_loses_by_flow() {
    for law in LAWS {
        let rubber = rubber(law);
        for (c, past) in states() {
            let spring = rubber.branches[2];
            let (strain, internal) = (measure(law, &c).value(), measure(law, &past).value());
            let slope = derivative(|internal| rubber.energy(&spring, &strain, internal), &internal);
            let flow = [0, 1, 2].map(|i| (strain[i] - internal[i]) / spring.relaxation_time);
            let [shear, volumetric] = rubber.dissipation(&spring, &strain, &internal);
            let lost = -contract(&slope, &flow);
            assert_relative_eq!(shear + volumetric, lost, max_relative = 1e-6);
            assert!(shear > 0.0);
        }
    }
}

#[test]
fn a_turned_body_has_the_turned_stress() {
    // The law knows the deformation through C = FᵀF alone, so P = F S turns with F.
    let f = [1.2, 0.5, -0.3, 0.9];
    let (sine, cosine) = 0.7_f64.sin_cos();
    let turned = [
        cosine * f[0] - sine * f[2],
        cosine * f[1] - sine * f[3],
        sine * f[0] + cosine * f[2],
        sine * f[1] + cosine * f[3],
    ];
    let cauchy_green = |f: [f64; 4]| {
        [f[0] * f[0] + f[2] * f[2], f[1] * f[1] + f[3] * f[3], f[0] * f[1] + f[2] * f[3]]
    };
    for law in LAWS {
        let rubber = rubber(law);
        let stress = |f| {
            let measure = measure(law, &cauchy_green(f));
            stresses(&rubber, &rubber.equilibrium, &measure, &[0.0; 3])
        };
        for (a, b) in stress(f).into_iter().flatten().zip(stress(turned).into_iter().flatten()) {
            assert_relative_eq!(a, b, max_relative = 1e-12);
        }
    }
}

#[test]
fn small_strains_obey_hooke() {
    for law in LAWS {
        let rubber = rubber(law);
        let spring = rubber.equilibrium;
        let strain = [2e-7, -3e-7, 1e-7];
        let c = [0, 1, 2].map(|i| IDENTITY[i] + 2.0 * strain[i]);
        let [shear, volumetric] = stresses(&rubber, &spring, &measure(law, &c), &[0.0; 3]);
        let trace = strain[0] + strain[1];
        for i in 0..3 {
            let hooke = 2.0 * spring.shear * strain[i] + spring.volumetric * trace * IDENTITY[i];
            // Second order of the strain, and the round-off of 1 + strain.
            assert_relative_eq!(shear[i] + volumetric[i], hooke, max_relative = 1e-4);
        }
    }
}

#[test]
fn tiny_strains_keep_their_digits() {
    for law in LAWS {
        let rubber = rubber(law);
        let spring = rubber.branches[4];
        let tiny = [2e-14, -3e-14, 1e-14];
        let measure = law.measure(&tiny).unwrap();
        let [shear, volumetric] = stresses(&rubber, &spring, &measure, &[0.0; 3]);
        assert_relative_eq!(volumetric[0], -0.5 * spring.volumetric * 1e-14, max_relative = 1e-12);
        for i in 0..3 {
            assert_relative_eq!(shear[i], spring.shear * tiny[i], max_relative = 1e-12);
        }
    }
}

#[test]
fn the_kirchhoff_stress_of_the_linear_law_is_linear_in_the_true_strain() {
    let rubber = rubber(Rheology::Linear);
    let spring = rubber.equilibrium;
    let stretches: [f64; 2] = [0.3, 2.1];
    let measure = measure(Rheology::Linear, &[stretches[0].powi(2), stretches[1].powi(2), 0.0]);
    let [shear, volumetric] = stresses(&rubber, &spring, &measure, &[0.0; 3]);
    let volume = (stretches[0] * stretches[1]).ln();
    for (i, stretch) in stretches.iter().enumerate() {
        let kirchhoff = stretch * stretch * (shear[i] + volumetric[i]);
        let linear = 2.0 * spring.shear * stretch.ln() + spring.volumetric * volume;
        assert_relative_eq!(kirchhoff, linear, max_relative = 1e-12);
    }
    assert_eq!((shear[2], volumetric[2]), (0.0, 0.0));
}

#[test]
fn incompressible_rubber_is_refused() {
    let incompressible = Rubber::elastic(1e6, 0.5);
    let error = FiniteStrainRubber::new(&incompressible, Rheology::NeoHookean).unwrap_err();
    assert!(error.to_string().contains("poisson_ratio is 0.5"), "{error}");
}
