//! Finite deformation, both routes: friction over the elements on the period.

use super::half_space::SPEED;
use super::{Case, Failure, Method, Prepared, Reference};
use asperity::fem::profile::RigidProfile;
use asperity::fem::steady::{BlockOptions, SteadyContact};
use asperity::fem::transient::{TransientContact, TransientOptions};
use asperity::rubber::{Rheology, Rubber};
use asperity::surface::Wave;

pub(super) const COLUMNS: &str = "columns";

pub(super) const CASES: &[Case] = &[Case {
    name: "finite-deformation",
    problem: "finite deformation, 1 wave of 0.0625 mm and amplitude 0.005 mm, 0.5 MPa, 10 mm/s: friction",
    reference_text: "steady route on 512 columns",
    reference: Reference::OverResolved { prepare: steady, value: 512, quick: 48 },
    methods: &[
        Method {
            name: "finite deformation, steady",
            knob: COLUMNS,
            values: &[12, 16, 24, 32, 48, 64, 96, 128, 192],
            prepare: steady,
        },
        // Steps in time are as many on a period as columns, so that both grow.
        Method {
            name: "finite deformation, transient",
            knob: COLUMNS,
            values: &[8, 12, 16, 24, 32, 48],
            prepare: transient,
        },
    ],
}];

/// Wavelength in m.
const PERIOD: f64 = 0.0625e-3;
/// A gentle slope of 0.36 rms: the drag of the transient route takes seconds at most.
const AMPLITUDE: f64 = 0.005e-3;
/// Mean pressure in Pa.
const PRESSURE: f64 = 5e5;
/// Shear of the mesh that keeps its elements upright, about half of that of the block.
const SKEW: f64 = -0.03;
/// Six periods, the last two averaged, instead of the twelve of the thesis: half the time, and
/// friction changes by less than the error of the meshes.
const DRAG_PERIODS: usize = 6;
const AVERAGED_PERIODS: usize = 2;

fn profile() -> RigidProfile {
    let wave = Wave { wavelength: PERIOD, amplitude: AMPLITUDE, phase: 0.0 };
    RigidProfile::from_waves(&[wave], PERIOD)
}

fn steady(columns: u32) -> Result<Prepared, Failure> {
    let rubber = Rubber::table_2_1();
    Ok(Box::new(move || Ok(vec![steady_friction(&rubber, profile(), columns, PRESSURE)?])))
}

/// Friction of the steady route, from scratch.
pub(super) fn steady_friction(
    rubber: &Rubber,
    profile: RigidProfile,
    columns: u32,
    pressure: f64,
) -> Result<f64, Failure> {
    let options = BlockOptions::of_profile(columns as usize, &profile);
    let mut contact = SteadyContact::new(rubber, Rheology::NeoHookean, SPEED, profile, options)?;
    Ok(contact.solve(pressure)?.friction_coefficient)
}

fn transient(columns: u32) -> Result<Prepared, Failure> {
    let rubber = Rubber::table_2_1();
    let options = TransientOptions {
        drag_periods: DRAG_PERIODS,
        averaged_periods: AVERAGED_PERIODS,
        ..TransientOptions::default()
    };
    Ok(Box::new(move || {
        let mut mesh = BlockOptions::new(columns as usize).mesh(PERIOD);
        mesh.skew = SKEW;
        let (law, options) = (Rheology::NeoHookean, options.clone());
        let contact = TransientContact::new(&rubber, law, SPEED, profile(), mesh, options)?;
        Ok(vec![contact.run(PRESSURE, |_| ())?.friction_coefficient.mean])
    }))
}
