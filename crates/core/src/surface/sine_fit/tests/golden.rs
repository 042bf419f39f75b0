//! Amplitudes of an earlier revision.

use super::*;

/// Values of the revision before the second rule, which were the same bit for bit where they were computed.
#[test]
fn the_rule_of_the_thesis_gives_what_it_gave() {
    let positive = measured(1, 1, 100e-3, 1.3e-5).into_iter().filter(|s| s.value > 1e-12);
    let noise = synthetic(&scales(&amplitudes_mm()), noisy(0.3, 3));
    let golden: [(Vec<CorrelationSample>, &[u64]); 2] = [
        (
            positive.collect(),
            &[
                0x3ef6_761b_78db_639f,
                0x3eff_a7b1_36bc_222b,
                0x3f07_45d8_6545_1599,
                0x3f18_8d01_9b9b_3256,
                0x3f2c_5cbb_398b_e66c,
                0,
            ],
        ),
        (
            noise,
            &[
                0x3ef4_c399_d189_ad29,
                0x3ef8_64a0_c771_6db0,
                0x3f00_4f05_8ac9_7e6e,
                0x3f0f_e83e_ae95_17d4,
                0x3f07_194e_f0ee_826d,
                0x3f2c_5fe8_7a71_e0fd,
                0x3f2d_708e_ae9f_36f5,
                0x3f3e_0ceb_8dbc_395f,
            ],
        ),
    ];
    for (samples, bits) in golden {
        let fit = fit_sines(&samples, &ladder(bits.len())).unwrap();
        let by_rule = fit_sines_by(FitRule::Thesis, &samples, &ladder(bits.len())).unwrap();
        assert_eq!(fit, by_rule);
        for (amplitude, expected) in amplitudes(&fit).iter().zip(bits) {
            println!("{:016x} {expected:016x}", amplitude.to_bits());
            // The last digits are those of the sines and logarithms of this machine.
            assert_relative_eq!(*amplitude, f64::from_bits(*expected), max_relative = 1e-9);
        }
    }
}
