use super::*;

fn strains() -> Vec<f64> {
    (0..28).map(|k| 1e-4 * 10_f64.powf(f64::from(k) / 8.0)).collect()
}

fn sweep(law: &PayneLaw, temperature_c: f64) -> StrainSweep {
    let point = |strain: f64| StrainPoint {
        strain,
        storage_modulus: 12.0 * law.storage_factor(strain),
        loss_modulus: 1.8 * law.loss_factor(strain),
    };
    let points = strains().into_iter().map(point).collect();
    StrainSweep { temperature_c: Some(temperature_c), frequency_hz: Some(1.0), points }
}

const LAW: Kraus = Kraus {
    critical_strain: 0.012,
    exponent: 0.62,
    storage_limit: 0.18,
    loss_limit: 0.25,
    loss_peak: 0.3,
    highest_strain: 1.0,
};

fn law_of(kraus: Kraus) -> PayneLaw {
    Payne::new(vec![(None, PayneCurve::Kraus(kraus))]).unwrap().at(None)
}

#[test]
fn factors_are_one_at_rest_bounded_and_constant_beyond_the_measurement() {
    let kraus = Kraus { highest_strain: 0.2, ..LAW };
    let table = PayneTable::fit(&sweep(&law_of(kraus), 20.0)).unwrap().table;
    for curve in [PayneCurve::Kraus(kraus), PayneCurve::Table(table)] {
        let law = Payne::new(vec![(None, curve)]).unwrap().at(None);
        assert_eq!(law.factors(0.0), [1.0; 2]);
        let highest = law.highest_strain();
        let mut before = 1.0;
        for k in 0..2000 {
            let strain = 1e-7 * 10_f64.powf(f64::from(k) / 250.0);
            let [f, g] = law.factors(strain);
            assert!(f <= before && f > 0.1 && g > 0.2 && g < 2.0, "{strain} {f} {g}");
            before = f;
        }
        assert_eq!(law.factors(highest), law.factors(10.0 * highest));
        assert_eq!(law.factors(-0.01), law.factors(0.01));
        assert!(law.storage_factor(f64::NAN).is_nan());
        assert!(
            law.extrapolation(1.01 * highest).is_some() && law.extrapolation(highest).is_none()
        );
    }
    // By hand: half of the network is broken at the critical strain.
    let law = law_of(LAW);
    approx::assert_relative_eq!(law.storage_factor(0.012), 0.59, max_relative = 1e-14);
    approx::assert_relative_eq!(law.loss_factor(0.012), 0.25 + 0.375 + 0.3, max_relative = 1e-14);
}

#[test]
fn exact_sweeps_give_their_law() {
    let found = Kraus::fit(&sweep(&law_of(LAW), 20.0)).unwrap();
    assert!(found.rms.iter().all(|rms| *rms < 1e-8), "{found:?}");
    for (value, exact) in [
        (found.law.critical_strain, LAW.critical_strain),
        (found.law.exponent, LAW.exponent),
        (found.law.storage_limit, LAW.storage_limit),
        (found.law.loss_limit, LAW.loss_limit),
        (found.law.loss_peak, LAW.loss_peak),
        (found.storage_modulus, 12.0),
        (found.loss_modulus, 1.8),
    ] {
        approx::assert_relative_eq!(value, exact, max_relative = 1e-6);
    }
    // The loss factor of Kraus' own law cannot fall below 1, where the sweep has a quarter: the fit spoils both moduli.
    let own = found.rms_of_own_law.unwrap();
    assert!(own[0].max(own[1]) > 0.1, "{own:?}");
    let kraus = Kraus { loss_limit: 1.0, ..LAW };
    let found = Kraus::fit(&sweep(&law_of(kraus), 20.0)).unwrap();
    assert!(found.rms_of_own_law.unwrap().iter().all(|rms| *rms < 1e-8), "{found:?}");
    approx::assert_relative_eq!(found.law.loss_limit, 1.0, max_relative = 1e-6);
}

#[test]
fn the_table_meets_its_sweep() {
    let law = law_of(LAW);
    let found = PayneTable::fit(&sweep(&law, 20.0)).unwrap();
    // The two smallest strains are stiffer than the median of the half decade and count as at rest.
    assert!(found.left_out.is_empty() && found.monotone_rms < 1e-3, "{found:?}");
    let table = Payne::new(vec![(None, PayneCurve::Table(found.table))]).unwrap().at(None);
    for strain in strains() {
        // The modulus at rest is the median over half a decade, which is softer by f(1.8e-4) there.
        let ratio = law.storage_factor(strain) / law.storage_factor(1.8e-4);
        approx::assert_relative_eq!(table.storage_factor(strain), ratio.min(1.0), epsilon = 1e-3);
    }
}

#[test]
fn outliers_repeated_and_unsorted_strains_are_dealt_with() {
    let mut noisy = sweep(&law_of(LAW), 0.0);
    let exact = PayneTable::fit(&noisy).unwrap();
    // A point of another sweep next to the smallest strain, as exports have them, and one in the middle.
    noisy.points.push(StrainPoint { strain: 1.001e-4, storage_modulus: 9.0, loss_modulus: 1.2 });
    noisy.points[14].loss_modulus *= 0.8;
    noisy.points.push(noisy.points[20]);
    noisy.points.reverse();
    let found = PayneTable::fit(&noisy).unwrap();
    assert_eq!(found.left_out.len(), 2, "{:?}", found.left_out);
    approx::assert_relative_eq!(found.storage_modulus, exact.storage_modulus, max_relative = 1e-3);
    assert_eq!(found.table.rows().len(), 27);
}

#[test]
fn coarse_smooth_sweeps_keep_all_strains() {
    // A plateau in small steps and the fall in large ones: lines through the plateau say nothing of the end.
    let plateau = [1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 1e-1];
    let mixed = [1e-4, 2e-4, 3e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.02, 0.06, 0.2];
    for (strains, exponent, loss_peak) in
        [(&plateau[..], 0.62, 0.3), (&plateau, 0.4, 0.0), (&mixed, 0.7, 0.1), (&mixed, 0.5, 0.6)]
    {
        let law = law_of(Kraus { exponent, loss_peak, ..LAW });
        let mut coarse = sweep(&law, 20.0);
        coarse.points = strains
            .iter()
            .map(|strain| StrainPoint {
                strain: *strain,
                storage_modulus: 12.0 * law.storage_factor(*strain),
                loss_modulus: 1.8 * law.loss_factor(*strain),
            })
            .collect();
        let found = PayneTable::fit(&coarse).unwrap();
        assert_eq!(found.left_out, [], "{exponent} {loss_peak}");
        assert_eq!(found.table.rows().last().unwrap()[0], strains[strains.len() - 1]);
    }
}

#[test]
fn a_fit_with_a_flat_direction_ends() {
    // Six strains, the last far from the others, in six digits: conjugate gradients never meet their tolerance.
    let rows = [
        [0.001, 11.5368, 2.00922],
        [0.002, 10.9985, 2.05371],
        [0.005, 9.51248, 2.02558],
        [0.01, 7.723, 1.86489],
        [0.03, 4.79831, 1.40025],
        [0.3, 2.59757, 0.744816],
    ];
    let point = |[strain, storage_modulus, loss_modulus]: [f64; 3]| StrainPoint {
        strain,
        storage_modulus,
        loss_modulus,
    };
    let points = rows.map(point).to_vec();
    let sweep = StrainSweep { temperature_c: None, frequency_hz: None, points };
    let found = Kraus::fit(&sweep).unwrap();
    approx::assert_relative_eq!(found.law.critical_strain, 0.012, max_relative = 1e-3);
}

#[test]
fn factors_are_interpolated_over_temperature() {
    let hot = Kraus { storage_limit: 0.4, ..LAW };
    let payne = Payne::new(vec![
        (Some(50.0), PayneCurve::Kraus(hot)),
        (Some(10.0), PayneCurve::Kraus(LAW)),
    ])
    .unwrap();
    assert_eq!(payne.measured_c(), Some([10.0, 50.0]));
    let f = |celsius| payne.at(Some(celsius)).storage_factor(0.05);
    let [cold, warm] = [law_of(LAW), law_of(hot)].map(|law| law.storage_factor(0.05));
    assert_eq!([f(10.0), f(50.0), f(-5.0), f(90.0)], [cold, warm, cold, warm]);
    approx::assert_relative_eq!(f(20.0), 0.75 * cold + 0.25 * warm, max_relative = 1e-14);
    assert!(payne.extrapolation(60.0).is_some() && payne.extrapolation(30.0).is_none());
    let twice = vec![(Some(10.0), PayneCurve::Kraus(LAW)); 2];
    assert_eq!(Payne::new(twice), Err(PayneError::Temperatures));
    assert_eq!(Payne::new(vec![]), Err(PayneError::Empty));
}

#[test]
fn numbers_of_no_sweep_are_named() {
    let mut bad = sweep(&law_of(LAW), 20.0);
    bad.points[3].loss_modulus = -1.0;
    let message = PayneTable::fit(&bad).unwrap_err().to_string();
    assert!(message.contains("loss modulus at 20 °C is -1"), "{message}");
    bad.points.truncate(3);
    let message = Kraus::fit(&bad).unwrap_err().to_string();
    assert!(message.contains("has 3 strains"), "{message}");
    let table = |strain: &[f64], f: &[f64], g: &[f64]| {
        PayneTable::new(None, strain, f, g).unwrap_err().to_string()
    };
    assert!(table(&[0.1, 0.2], &[1.0], &[1.0, 0.9]).contains("2 strains, 1 storage"));
    assert!(table(&[0.2, 0.1], &[1.0, 0.9], &[1.0, 0.9]).contains("0.1 comes after 0.2"));
    assert!(table(&[0.1, 0.2], &[1.0, 1.2], &[1.0, 0.9]).contains("storage factor is 1.2"));
    let law = Kraus { loss_peak: f64::NAN, ..LAW };
    assert!(law.validate(Some(20.0)).unwrap_err().to_string().contains("loss_peak at 20 °C"));
}

#[test]
fn strains_of_shear_are_converted_by_energy() {
    // G γ² = 3 G ε².
    approx::assert_relative_eq!(3.0 * elongation_of_shear(0.3).powi(2), 0.09, max_relative = 1e-14);
    assert_eq!(elongation_of_tensor_shear(0.15), elongation_of_shear(0.3));
}
