//! Checks of every law of a spring against its energy, its symmetries and its limits.
//!
//! `check_law!` makes all of them for one law. They go through [`FiniteStrainRubber`], as the elements do.

use super::*;
use approx::assert_relative_eq;

/// All checks of a law, as the tests of a module.
macro_rules! check_law {
    ($law:ident, $rheology:expr) => {
        check_law!($law, $rheology =>
            stress_is_the_derivative_of_the_energy,
            the_tangent_is_the_derivative_of_the_stress,
            the_tangent_in_products_is_the_tangent,
            the_second_stress_changes_by_the_derivative_of_the_measure,
            heat_is_what_the_energy_loses_by_flow,
            heat_is_not_negative,
            a_rotated_body_has_the_rotated_stress,
            nothing_is_stored_at_rest,
            small_strains_are_linear_viscoelastic,
            tiny_strains_keep_their_digits,
        );
    };
    ($law:ident, $rheology:expr => $($check:ident,)*) => {
        mod $law {
            use super::*;
            $(
                #[test]
                fn $check() {
                    super::$check(&rubber($rheology));
                }
            )*
        }
    };
}

check_law!(neo_hookean, Rheology::NeoHookean);
check_law!(linear, Rheology::Linear);
check_law!(yeoh, YEOH);
check_law!(yeoh_with_an_end, Rheology::Yeoh { c2_over_c1: -0.1, c3_over_c1: 1e-3 });
check_law!(arruda_boyce, ARRUDA_BOYCE);

/// Softer at first, stiffer later, without a maximum of the shear stress.
const YEOH: Rheology = Rheology::Yeoh { c2_over_c1: -0.1, c3_over_c1: 0.01 };
const ARRUDA_BOYCE: Rheology = Rheology::ArrudaBoyce { locking_stretch: 2.0 };

fn rubber(rheology: Rheology) -> FiniteStrainRubber {
    FiniteStrainRubber::new(&Rubber::table_2_1(), rheology).unwrap()
}

/// The measure of a law at a right Cauchy-Green tensor.
fn measure(rubber: &FiniteStrainRubber, c: &Symmetric) -> Measure {
    rubber.rheology.measure(&[c[0] - 1.0, c[1] - 1.0, c[2]]).unwrap()
}

/// Shear part and volumetric part of the conjugate stress.
fn conjugate_stresses(
    rubber: &FiniteStrainRubber,
    spring: &Spring,
    strain: &Symmetric,
    internal: &Symmetric,
) -> [Symmetric; 2] {
    let tensors = [strain, internal, &difference(strain, internal)];
    [rubber.shear_stress(spring, tensors), rubber.volumetric_stress(spring, tensors)]
}

/// Shear part and volumetric part of the second Piola-Kirchhoff stress.
fn stresses(
    rubber: &FiniteStrainRubber,
    spring: &Spring,
    measure: &Measure,
    internal: &Symmetric,
) -> [Symmetric; 2] {
    conjugate_stresses(rubber, spring, &measure.value(), internal)
        .map(|stress| measure.derivative(&stress))
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
        // The shear component occurs twice in a contraction.
        if i == 2 { 0.5 * slope } else { slope }
    })
}

/// Change of a function of a symmetric tensor with its component `j`, by central differences.
fn change(function: impl Fn(&Symmetric) -> Symmetric, at: &Symmetric, j: usize) -> Symmetric {
    let step = 1e-6;
    let shifted = |by: f64| {
        let mut tensor = *at;
        tensor[j] += by;
        function(&tensor)
    };
    let (after, before) = (shifted(step), shifted(-step));
    [0, 1, 2].map(|i| (after[i] - before[i]) / (2.0 * step))
}

fn largest(tensor: &Symmetric) -> f64 {
    tensor.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// Shares of a change of strain that internal tensors take part in.
const FRACTIONS: [f64; 3] = [0.0, 0.4, 1.0];

fn stress_is_the_derivative_of_the_energy(rubber: &FiniteStrainRubber) {
    for (c, past) in states() {
        let spring = rubber.branches[2];
        let internal = measure(rubber, &past).value();
        let energy = |c: &Symmetric| rubber.energy(&spring, &measure(rubber, c).value(), &internal);
        let slope = derivative(energy, &c);
        let [shear, volumetric] = stresses(rubber, &spring, &measure(rubber, &c), &internal);
        for i in 0..3 {
            let stress = shear[i] + volumetric[i];
            // Differences of energies of 1e9 Pa.
            assert_relative_eq!(stress, 2.0 * slope[i], max_relative = 1e-6, epsilon = 10.0);
        }
    }
}

fn the_tangent_is_the_derivative_of_the_stress(rubber: &FiniteStrainRubber) {
    for ((c, past), fraction) in states().into_iter().flat_map(|s| FRACTIONS.map(|f| (s, f))) {
        let spring = rubber.branches[2];
        let (strain, internal) = (measure(rubber, &c).value(), measure(rubber, &past).value());
        let tangents = [
            rubber.shear_tangent(&spring, &strain, &internal, fraction),
            rubber.volumetric_tangent(&spring, &strain, &internal, fraction),
        ];
        for (part, tangent) in tangents.into_iter().enumerate() {
            let tangent = tangent.unwrap();
            let stress = |moved: &Symmetric| {
                let past = [0, 1, 2].map(|i| internal[i] + fraction * (moved[i] - strain[i]));
                conjugate_stresses(rubber, &spring, moved, &past)[part]
            };
            for j in 0..3 {
                let column = tangent.map(|row| row[j]);
                let slope = change(stress, &strain, j);
                // Third derivatives times the square of the step, and round-off over the step.
                let scale = largest(&slope).max(spring.shear);
                assert!(
                    largest(&difference(&column, &slope)) < 1e-8 * scale,
                    "{column:?} {slope:?}"
                );
            }
        }
    }
}

fn the_tangent_in_products_is_the_tangent(rubber: &FiniteStrainRubber) {
    for ((c, past), fraction) in states().into_iter().flat_map(|s| FRACTIONS.map(|f| (s, f))) {
        let spring = rubber.branches[2];
        let (strain, internal) = (measure(rubber, &c).value(), measure(rubber, &past).value());
        let rheology = rubber.rheology;
        let ((g, now), (g_i, then)) =
            (rheology.metric(&strain).unwrap(), rheology.metric(&internal).unwrap());
        assert_eq!(rheology.volume(&strain), now);
        let ratio = now / then;
        let tensors = [&strain, &internal, &difference(&strain, &internal)];
        let Hardening { slope, curvature, by_strain, by_internal } = rubber.hardening(tensors);
        let shear = rubber.shear_tangent(&spring, &strain, &internal, fraction).unwrap();
        let volumetric = rubber.volumetric_tangent(&spring, &strain, &internal, fraction).unwrap();
        for (j, unit) in UNITS.iter().enumerate() {
            let (congruent, past) = (sandwich(&g, unit), sandwich(&g_i, unit));
            let growth = contract(&g, unit) - fraction * contract(&g_i, unit);
            let half = 0.5 * spring.volumetric;
            let change = contract(&by_strain, unit) - fraction * contract(&by_internal, unit);
            for i in 0..3 {
                let hardened = curvature * by_strain[i] * change;
                let expected =
                    spring.shear * (slope * (congruent[i] - fraction * past[i]) + hardened);
                let round_off = 1e-12 * spring.shear * hardened.abs();
                assert_relative_eq!(
                    shear[i][j],
                    expected,
                    max_relative = 1e-12,
                    epsilon = round_off
                );
                let expected = half * (ratio * growth * g[i] - (ratio - 1.0) * congruent[i]);
                let round_off = 1e-12 * spring.volumetric;
                assert_relative_eq!(
                    volumetric[i][j],
                    expected,
                    max_relative = 1e-12,
                    epsilon = round_off
                );
            }
        }
    }
}

fn the_second_stress_changes_by_the_derivative_of_the_measure(rubber: &FiniteStrainRubber) {
    for (c, past) in states() {
        let spring = rubber.branches[2];
        let internal = measure(rubber, &past).value();
        let here = measure(rubber, &c);
        let strain = here.value();
        let conjugate = conjugate_stresses(rubber, &spring, &strain, &internal)[0];
        let tangent = rubber.shear_tangent(&spring, &strain, &internal, 0.0).unwrap();
        for (j, unit) in UNITS.iter().enumerate() {
            let moved = here.derivative(unit);
            let conjugate_change = tangent.map(|row| (0..3).map(|k| row[k] * moved[k]).sum());
            let exact = here.stress_change(&conjugate, &conjugate_change, unit);
            let stress =
                |c: &Symmetric| stresses(rubber, &spring, &measure(rubber, c), &internal)[0];
            let slope = change(stress, &c, j);
            let scale = largest(&slope).max(spring.shear);
            assert!(largest(&difference(&exact, &slope)) < 1e-8 * scale, "{exact:?} {slope:?}");
        }
    }
}

fn heat_is_what_the_energy_loses_by_flow(rubber: &FiniteStrainRubber) {
    for (c, past) in states() {
        let spring = rubber.branches[2];
        let (strain, internal) = (measure(rubber, &c).value(), measure(rubber, &past).value());
        let slope = derivative(|internal| rubber.energy(&spring, &strain, internal), &internal);
        let flow = [0, 1, 2].map(|i| (strain[i] - internal[i]) / spring.relaxation_time);
        let [shear, volumetric] = rubber.dissipation(&spring, &strain, &internal);
        let lost = -contract(&slope, &flow);
        assert_relative_eq!(shear + volumetric, lost, max_relative = 1e-6);
        assert!(shear > 0.0);
    }
}

/// Both parts together where the strain of the spring is small, and the shear part everywhere.
fn heat_is_not_negative(rubber: &FiniteStrainRubber) {
    let spring = rubber.branches[2];
    for (past, _) in states() {
        for k in 0..200 {
            let scattered = |n: usize| ((n * k) as f64 + 0.5).sin();
            let direction = [scattered(1), scattered(7), scattered(13)];
            for size in [1e-6, 1e-3, 0.02, 0.3] {
                let c = [0, 1, 2].map(|i| past[i] + size * direction[i]);
                let Some(here) = rubber.rheology.measure(&difference(&c, &IDENTITY)) else {
                    continue;
                };
                if determinant(&c) <= 0.0 {
                    continue;
                }
                let internal = measure(rubber, &past).value();
                let [shear, volumetric] = rubber.dissipation(&spring, &here.value(), &internal);
                assert!(shear >= 0.0, "{c:?} {past:?}: {shear}");
                assert!(size > 0.1 || shear + volumetric >= 0.0, "{c:?} {past:?}: {volumetric}");
            }
        }
    }
}

fn a_rotated_body_has_the_rotated_stress(rubber: &FiniteStrainRubber) {
    // The law knows the deformation through C = FᵀF alone, so P = F S rotates with F.
    let f = [1.2, 0.5, -0.3, 0.9];
    let (sine, cosine) = 0.7_f64.sin_cos();
    let rotated = [
        cosine * f[0] - sine * f[2],
        cosine * f[1] - sine * f[3],
        sine * f[0] + cosine * f[2],
        sine * f[1] + cosine * f[3],
    ];
    let cauchy_green = |f: [f64; 4]| {
        [f[0] * f[0] + f[2] * f[2], f[1] * f[1] + f[3] * f[3], f[0] * f[1] + f[2] * f[3]]
    };
    let stress = |f| {
        let measure = measure(rubber, &cauchy_green(f));
        stresses(rubber, &rubber.equilibrium, &measure, &[0.0; 3])
    };
    for (a, b) in stress(f).into_iter().flatten().zip(stress(rotated).into_iter().flatten()) {
        assert_relative_eq!(a, b, max_relative = 1e-12);
    }
}

/// Neither in the undeformed spring nor in one whose branch has relaxed.
fn nothing_is_stored_at_rest(rubber: &FiniteStrainRubber) {
    let spring = rubber.branches[2];
    for (c, _) in states().into_iter().chain([(IDENTITY, IDENTITY)]) {
        let strain = measure(rubber, &c).value();
        let tensors = [&strain, &strain, &[0.0; 3]];
        let stresses =
            [rubber.shear_stress(&spring, tensors), rubber.volumetric_stress(&spring, tensors)];
        assert!(stresses.iter().flatten().all(|t| *t == 0.0), "{stresses:?}");
        let round_off = 1e-14 * (spring.shear + spring.volumetric);
        assert!(rubber.energy(&spring, &strain, &strain).abs() < round_off);
        let [shear, volumetric] = rubber.driving_force(&spring, &strain, &strain);
        assert!(largest(&shear).max(largest(&volumetric)) < round_off);
    }
}

/// `T = 2 μ (ε - ε_i) + Λ tr(ε - ε_i) 1`, which with the flow rule is the generalised Maxwell model.
fn small_strains_are_linear_viscoelastic(rubber: &FiniteStrainRubber) {
    for (spring, past) in
        [(rubber.equilibrium, [0.0; 3]), (rubber.branches[1], [-1e-7, 1.5e-7, 2e-7])]
    {
        let strain = [2e-7, -3e-7, 1e-7];
        let c = [0, 1, 2].map(|i| IDENTITY[i] + 2.0 * strain[i]);
        let internal = measure(rubber, &[0, 1, 2].map(|i| IDENTITY[i] + 2.0 * past[i])).value();
        let [shear, volumetric] = stresses(rubber, &spring, &measure(rubber, &c), &internal);
        let elastic = difference(&strain, &past);
        let trace = elastic[0] + elastic[1];
        for i in 0..3 {
            let hooke = 2.0 * spring.shear * elastic[i] + spring.volumetric * trace * IDENTITY[i];
            // Second order of the strain, and the round-off of 1 + strain.
            assert_relative_eq!(shear[i] + volumetric[i], hooke, max_relative = 1e-4);
        }
    }
}

fn tiny_strains_keep_their_digits(rubber: &FiniteStrainRubber) {
    let spring = rubber.branches[4];
    let tiny = [2e-14, -3e-14, 1e-14];
    let measure = rubber.rheology.measure(&tiny).unwrap();
    let [shear, volumetric] = stresses(rubber, &spring, &measure, &[0.0; 3]);
    assert_relative_eq!(volumetric[0], -0.5 * spring.volumetric * 1e-14, max_relative = 1e-12);
    for i in 0..3 {
        assert_relative_eq!(shear[i], spring.shear * tiny[i], max_relative = 1e-12);
    }
}

/// All that the elements ask a law, at one state.
fn answers(rubber: &FiniteStrainRubber, c: &Symmetric, past: &Symmetric) -> Vec<f64> {
    let spring = rubber.branches[2];
    let (strain, internal) = (measure(rubber, c).value(), measure(rubber, past).value());
    let mut all = conjugate_stresses(rubber, &spring, &strain, &internal).concat();
    for fraction in FRACTIONS {
        let shear = rubber.shear_tangent(&spring, &strain, &internal, fraction).unwrap();
        let volumetric = rubber.volumetric_tangent(&spring, &strain, &internal, fraction).unwrap();
        all.extend([shear.concat(), volumetric.concat()].concat());
    }
    all.extend(rubber.driving_force(&spring, &strain, &internal).concat());
    all
}

/// Without constants a law is neo-Hooke, to the last bit.
#[test]
fn laws_that_do_not_stiffen_are_neo_hooke() {
    let neo_hooke = rubber(Rheology::NeoHookean);
    for law in [
        Rheology::Yeoh { c2_over_c1: 0.0, c3_over_c1: 0.0 },
        Rheology::ArrudaBoyce { locking_stretch: 1e9 },
    ] {
        let stiffening = rubber(law);
        for (c, past) in states() {
            assert_eq!(answers(&stiffening, &c, &past), answers(&neo_hooke, &c, &past), "{law:?}");
        }
    }
    let differs = rubber(ARRUDA_BOYCE);
    let (c, past) = states()[2];
    assert!(answers(&differs, &c, &past)[0] != answers(&neo_hooke, &c, &past)[0]);
}

/// Heat of branches along random paths that end where they began: never negative in its shear part, and what is put in
/// less what is stored.
#[test]
fn work_on_random_paths_is_heat_or_stored() {
    for law in [YEOH, ARRUDA_BOYCE, Rheology::NeoHookean] {
        let rubber = rubber(law);
        let spring = Spring { volumetric: 0.0, relaxation_time: 0.1, ..rubber.branches[2] };
        for path in 0..5 {
            let phase = |n: usize| ((n * (path + 3)) as f64 * 12.9898).sin() * 3.0;
            // Shear and isochoric stretch, with no volumetric part to store or lose.
            let strain = |t: f64| -> Symmetric {
                let stretch = (0.8 * (t + phase(1)).sin() * (2.0 * t + phase(2)).cos()).exp();
                let gamma = 1.5 * (3.0 * t + phase(3)).sin();
                [stretch * stretch - 1.0, (gamma * gamma + 1.0) / (stretch * stretch) - 1.0, gamma]
            };
            let steps = 20_000;
            let dt = std::f64::consts::TAU / f64::from(steps);
            let mut internal = [0.0; 3];
            let (mut work, mut heat) = (0.0, 0.0);
            let start = rubber.energy(&spring, &strain(0.0), &internal);
            for n in 0..steps {
                let (now, next) = (strain(f64::from(n) * dt), strain(f64::from(n + 1) * dt));
                let middle = [0, 1, 2].map(|i| 0.5 * (now[i] + next[i]));
                let decay = (-0.5 * dt / spring.relaxation_time).exp();
                let relaxed = |from: &Symmetric, to: &Symmetric| {
                    [0, 1, 2].map(|i| to[i] + decay * (from[i] - to[i]))
                };
                let half = relaxed(&internal, &middle);
                let [shear, _] = rubber.dissipation(&spring, &middle, &half);
                assert!(shear >= 0.0, "{law:?}: {shear}");
                heat += dt * shear;
                let [stress, _] = conjugate_stresses(&rubber, &spring, &middle, &half);
                work += 0.5 * contract(&stress, &difference(&next, &now));
                internal = relaxed(&half, &middle);
            }
            let stored = rubber.energy(&spring, &strain(TAU_TIME), &internal) - start;
            assert_relative_eq!(work, heat + stored, max_relative = 1e-3);
        }
    }
}

/// Duration of the random paths.
const TAU_TIME: f64 = std::f64::consts::TAU;

#[test]
fn constants_that_are_none_are_named() {
    let refusal = |law| {
        let rubber = Rubber { finite_strain: law, ..Rubber::table_2_1() };
        assert!(FiniteStrainRubber::new(&Rubber::table_2_1(), law).is_err());
        rubber.validate().unwrap_err().to_string()
    };
    for stretch in [1.0, 0.0, -3.0, f64::NAN, f64::INFINITY] {
        let error = refusal(Rheology::ArrudaBoyce { locking_stretch: stretch });
        assert!(
            error.contains(&format!("locking_stretch is {stretch}, it must be above 1")),
            "{error}"
        );
    }
    let error = refusal(Rheology::Yeoh { c2_over_c1: f64::NAN, c3_over_c1: 0.0 });
    assert!(error.contains("c2_over_c1 is NaN"), "{error}");
    let error = refusal(Rheology::Yeoh { c2_over_c1: 0.0, c3_over_c1: f64::INFINITY });
    assert!(error.contains("c3_over_c1 is inf"), "{error}");
}

#[test]
fn incompressible_rubber_is_refused() {
    let incompressible = Rubber::elastic(1e6, 0.5);
    let error = FiniteStrainRubber::new(&incompressible, Rheology::NeoHookean).unwrap_err();
    assert!(error.to_string().contains("poisson_ratio is 0.5"), "{error}");
}
