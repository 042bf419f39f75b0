//! What `asperity solve fem` requires of a mesh, and its warnings about a coarse one.

use crate::cli::CliError;
use crate::cli::output::significant;
use asperity::fem::profile::RigidProfile;
use asperity::units::Units;

/// Columns on the shortest wave without --columns: friction is then within about half a percent
/// of the limit for usual areas.
const DEFAULT_COLUMNS_PER_WAVE: f64 = 64.0;
/// Largest default number of columns: more take minutes and gigabytes.
pub(super) const MOST_DEFAULT_COLUMNS: usize = 8192;
/// Number of columns from which a contact takes minutes.
const MANY_COLUMNS: usize = 4096;
/// Fewer columns on the shortest wave leave contacts of one or two nodes, whose friction is
/// that of the mesh.
pub(super) const LEAST_COLUMNS_PER_WAVE: f64 = 8.0;
/// Columns on the shortest wave below which friction is off by 10 % and more.
const FEW_COLUMNS_PER_WAVE: f64 = 16.0;
/// Fewer samples cannot tell a wave from a longer one.
const LEAST_SAMPLES_PER_WAVE: f64 = 3.0;
/// Relative difference of heat and work from which the user is warned; converged meshes have 1e-3.
const COARSE: f64 = 0.05;
/// Absolute difference of friction below which there is no warning, for friction close to zero.
const LEAST_DIFFERENCE: f64 = 1e-4;

/// The default number of columns for a profile.
///
/// # Errors
/// [`CliError::Input`] if that is more than can be solved in reasonable time.
pub(super) fn usual_columns(profile: &RigidProfile) -> Result<usize, CliError> {
    let waves = profile.shortest_waves();
    let columns = (DEFAULT_COLUMNS_PER_WAVE * waves).max(128.0) as usize;
    if columns <= MOST_DEFAULT_COLUMNS {
        return Ok(columns);
    }
    Err(CliError::input(format!(
        "the period is {} mm long and holds {waves} of the shortest waves: \
         {DEFAULT_COLUMNS_PER_WAVE} columns on each are {columns}, more than the {MOST_DEFAULT_COLUMNS} that \
         are chosen without being asked for; choose wavelengths whose ratios are simple fractions, leave out the shortest or \
         the longest, or insist with --columns N",
        significant(profile.period().m_to_mm())
    )))
}

/// Compares a mesh with the profile; returns warnings.
///
/// # Errors
/// [`CliError::Input`] if samples or mesh do not resolve the profile at all.
pub(super) fn check(profile: &RigidProfile, columns: usize) -> Result<Vec<String>, CliError> {
    let waves = profile.steep_waves();
    if let Some(samples) = profile.samples() {
        let per_wave = samples as f64 / waves;
        if per_wave < LEAST_SAMPLES_PER_WAVE {
            return Err(CliError::input(format!(
                "the profile is not resolved by its {samples} points: {per_wave:.1} on the shortest wave that \
                 matters for its slope, needed are {LEAST_SAMPLES_PER_WAVE} or more; sample it more \
                 densely, or smooth it"
            )));
        }
    }
    let per_wave = columns as f64 / waves;
    if per_wave < LEAST_COLUMNS_PER_WAVE {
        return Err(CliError::input(format!(
            "{columns} columns are {per_wave:.1} on the shortest wave that matters for the slope, needed are \
             {LEAST_COLUMNS_PER_WAVE} or more: give --columns {} at least, better {}",
            LEAST_COLUMNS_PER_WAVE * waves,
            DEFAULT_COLUMNS_PER_WAVE * waves
        )));
    }
    let mut warnings = Vec::new();
    if per_wave < FEW_COLUMNS_PER_WAVE {
        warnings.push(format!(
            "{per_wave:.1} columns on the shortest wave that matters for the slope are few: friction may be \
             off by 10 % and more, {} --columns are usual",
            DEFAULT_COLUMNS_PER_WAVE * waves
        ));
    }
    if columns >= MANY_COLUMNS {
        warnings.push(format!(
            "the period of {} mm has {columns} columns: this takes minutes",
            significant(profile.period().m_to_mm())
        ));
    }
    Ok(warnings)
}

/// A warning if friction by the work of the drag and by the heat of the branches differ, or if the
/// profile reaches into the rubber between the nodes.
pub(super) fn coarse(friction: f64, heat: f64, mean_separation: f64) -> Option<String> {
    let difference = (friction - heat).abs();
    if difference > COARSE * friction.abs().max(heat.abs()) && difference > LEAST_DIFFERENCE {
        return Some(format!(
            "friction is {} by the work of the drag and {} by the heat of the branches: the mesh is \
             too coarse for reliable figures",
            significant(friction),
            significant(heat)
        ));
    }
    (mean_separation < 0.0).then(|| {
        "the mean separation is negative, the profile reaches into the rubber between the nodes: \
         the mesh is too coarse for reliable figures"
            .into()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_next_to_nothing_is_no_reason_to_warn_and_never_a_division_by_it() {
        assert_eq!(coarse(0.5, 0.49, 1.0), None);
        assert_eq!(coarse(0.0, 0.0, 1.0), None);
        assert_eq!(coarse(1e-9, -3e-6, 1.0), None);
        let none = coarse(0.0, 0.2, 1.0).unwrap();
        assert!(
            none.contains("is 0 by the work") && none.contains("0.200000 by the heat"),
            "{none}"
        );
        assert!(coarse(-0.1, 0.2, 1.0).unwrap().contains("-0.100000"));
        assert!(coarse(0.5, 0.49, -1e-9).unwrap().contains("separation is negative"));
    }
}
