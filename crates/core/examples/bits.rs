//! Prints results bit by bit.
use asperity_core::contact::SlidingContact;
use asperity_core::fem::mesh::{Grading, Mesh};
use asperity_core::fem::profile::RigidProfile;
use asperity_core::fem::steady::{BlockOptions, SteadyContact};
use asperity_core::fem::transient::{TransientContact, TransientOptions};
use asperity_core::multiscale::{LawEnd, LocalLaw, SoftContact};
use asperity_core::rubber::{Rheology, Rubber};
use asperity_core::surface::{Wave, wave};

fn show(name: &str, values: &[f64]) {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for v in values {
        for byte in v.to_bits().to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    println!("{name} {hash:016x} {:?}", &values[..values.len().min(3)]);
}

fn main() {
    let rubber = Rubber::table_2_1();
    let waves: Vec<Wave> =
        [(1e-3, 5e-5, 0.1), (5e-4, 4e-5, 1.0), (2.5e-4, 2.939e-5, 2.0), (1.25e-4, 2.6e-5, 4.0)]
            .map(|(wavelength, amplitude, phase)| Wave { wavelength, amplitude, phase })
            .to_vec();
    for n in [1000, 4096] {
        let heights = wave::sample(&waves, 1e-3, n);
        for speed in [0.01, -0.3] {
            let mut contact = SlidingContact::new(&rubber, speed, 1e-3, &heights).unwrap();
            show("full", &[contact.smallest_full_contact_pressure()]);
            for p in [1e4, 1e6, 1e9] {
                let s = contact.solve(p).unwrap();
                let mut v = vec![
                    s.friction_coefficient,
                    s.hysteretic_friction,
                    s.contact_area_fraction,
                    s.mean_separation,
                    s.residual,
                ];
                v.extend(&s.pressure);
                v.extend(&s.separation);
                show("sliding", &v);
            }
            let law =
                LocalLaw::new(2e-5, &[1e5, 1e6, 1e7], &[1.5e-5, 1e-5, 5e-6], LawEnd::FullContact)
                    .unwrap();
            let mut soft = SoftContact::new(&rubber, speed, 1e-3, &heights, law).unwrap();
            let s = soft.solve(3e5).unwrap();
            let mut v = vec![s.friction_coefficient, s.mean_separation, s.residual];
            v.extend(&s.pressure);
            show("soft", &v);
        }
    }
    let period = 6.25e-5;
    let wave = |amplitude| Wave { wavelength: period, amplitude, phase: 0.0 };
    for law in [Rheology::NeoHookean, Rheology::Linear] {
        let amplitude = if law == Rheology::Linear { 1e-6 } else { 1.867e-5 };
        let profile = || RigidProfile::from_waves(&[wave(amplitude)], period);
        let mut contact =
            SteadyContact::new(&rubber, law, 0.01, profile(), BlockOptions::new(64)).unwrap();
        for p in [1e5, 3e5, 6e5] {
            let s = contact.solve(p).unwrap();
            show(
                "steady",
                &[
                    s.friction_coefficient,
                    s.hysteretic_friction,
                    s.contact_area_fraction,
                    s.mean_separation,
                    s.shear,
                    s.residual,
                ],
            );
        }
        let mesh = Mesh::graded(16, period, 0.75 * period, Grading { first: 1.0, growth: 1.5 });
        let options = TransientOptions {
            drag_periods: 2,
            averaged_periods: 1,
            ..TransientOptions::default()
        };
        let profile = RigidProfile::from_waves(&[wave(1e-6)], period);
        let contact = TransientContact::new(&rubber, law, 0.01, profile, mesh, options).unwrap();
        let s = contact.run(1e5, |_| ()).unwrap();
        let last = s.samples.last().unwrap();
        show(
            "transient",
            &[
                s.friction_coefficient.mean,
                last.energy.stored,
                last.energy.dissipated,
                last.mean_separation,
                last.friction_coefficient,
            ],
        );
    }
}
