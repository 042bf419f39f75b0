//! The hybrid method against all waves at finite deformation, at the same mean pressure.

use super::campaign::Campaign;
use super::finite_deformation::steady_friction;
use super::half_space::surface;
use super::{Case, Failure, Method, Prepared, Reference};
use asperity::fem::profile::RigidProfile;
use asperity::rubber::Rubber;
use asperity::stages::bem::CURVES;
use asperity::stages::hybrid::HYBRID;
use asperity::stages::realise::read_surfaces;
use asperity::surface::Wave;

const KNOB: &str = "columns per wave";
const WAVES: usize = 3;
/// Columns on the period for one on the shortest wave.
const SHORTEST_ON_PERIOD: u32 = 4;

pub(super) const CASES: &[Case] = &[Case {
    name: "hybrid",
    problem: "3 waves of Table 3.1, the pressure of area 0.03 on the half-space, 10 mm/s: friction",
    reference_text: "all waves at finite deformation, 128 columns on the shortest wave",
    reference: Reference::OverResolved { prepare: all_waves, value: 128, quick: 32 },
    methods: &[
        Method { name: "hybrid", knob: KNOB, values: &[16, 24, 32, 48, 64], prepare: hybrid },
        Method {
            name: "all waves at finite deformation",
            knob: KNOB,
            values: &[16, 24, 32, 48, 64],
            prepare: all_waves,
        },
    ],
}];

/// Section `[bem]`; the surface is solved at one area.
const HALF_SPACE: &str =
    "speeds_mm_s = [10.0]\narea_fractions = [0.03]\npoints_per_shortest_wavelength = 256";

/// The rule of the thesis, the steepest wave alone: the surface is its own.
const THESIS: &str = "rms_slope_threshold = 1.0\ntolerance = 1e-3\n[hybrid]\ncorrection = \"difference\"\n\
                      local_pressures = \"points\"";

/// The whole chain of stages, from the waves to the table of corrected friction.
fn hybrid(columns: u32) -> Result<Prepared, Failure> {
    let sections =
        format!("{HALF_SPACE}\n[micro]\ncolumns_per_shortest_wavelength = {columns}\n{THESIS}");
    let campaign = Campaign::new(&surface(WAVES), 1, &sections)?;
    Ok(Box::new(move || {
        campaign.run(|run| {
            let rows = run.rows(HYBRID)?;
            let friction = rows.first().and_then(|row| row.friction_coefficient);
            Ok(vec![friction.ok_or("no corrected friction: the microscale ended before it")?])
        })
    }))
}

fn all_waves(columns: u32) -> Result<Prepared, Failure> {
    let (waves, pressure) = realisation()?;
    let period = waves.iter().map(|wave| wave.wavelength).fold(0.0, f64::max);
    let rubber = Rubber::table_2_1();
    Ok(Box::new(move || {
        let profile = RigidProfile::from_waves(&waves, period);
        Ok(vec![steady_friction(&rubber, profile, SHORTEST_ON_PERIOD * columns, pressure)?])
    }))
}

/// The surface that the hybrid's stages draw, and its pressure in Pa.
fn realisation() -> Result<(Vec<Wave>, f64), Failure> {
    Campaign::new(&surface(WAVES), 1, HALF_SPACE)?.run(|run| {
        let surface = read_surfaces(run)?.into_iter().next().ok_or("no surface was drawn")?;
        let curves = run.rows(CURVES)?;
        let row = curves.first().ok_or("no contact was solved")?;
        Ok((surface.profile, 1e6 * row.pressure_mpa))
    })
}
