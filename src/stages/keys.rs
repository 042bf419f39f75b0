//! What to change in a recipe after an error of the mechanics, which speak of quantities and know no key.
//!
//! Each function gives the words that follow the message of the error.

use crate::contact::curve::CurveError;
use crate::surface::ConditioningError;
use crate::surface::self_affine::SelfAffineError;
use crate::surface::texture::DepthError;
use crate::units::Units;

/// After an error of [`crate::surface::condition()`].
pub(super) fn of_conditioning(error: &ConditioningError) -> &'static str {
    match error {
        ConditioningError::Repeated { .. } => {
            "; mend the file, or set ingest.conditioning.repeated_positions = \"mean\" to take the mean of \
             their heights"
        }
        ConditioningError::TooShort { .. } => "; lower ingest.conditioning.window_length_mm",
        ConditioningError::Form { .. } => "; lower the order of ingest.conditioning.form",
        _ => "",
    }
}

/// After an error of [`crate::contact::friction_curve`].
pub(super) fn of_curve<E>(error: &CurveError<E>) -> &'static str {
    match error {
        CurveError::NotSmooth { .. } => "; raise bem.tolerance or use more points",
        _ => "",
    }
}

/// The same for a curve of an areal surface.
pub(super) fn of_areal_curve<E>(error: &CurveError<E>) -> &'static str {
    match error {
        CurveError::NotSmooth { .. } => {
            "; raise areal.tolerance or areal.points_per_shortest_wavelength, or leave small areas out of bem.area_fractions"
        }
        _ => "",
    }
}

/// After an error of [`crate::surface::self_affine::fit_self_affine`].
pub(super) fn of_self_affine(error: &SelfAffineError) -> &'static str {
    match error {
        SelfAffineError::TooFewLags { .. } => {
            "; lower characterise.self_affine_shortest_lag_mm, or raise self_affine_longest_lag_mm or \
             longest_lag_mm"
        }
        SelfAffineError::NotPositive { .. } => {
            "; characterise.self_affine_longest_lag_mm ends the fit before"
        }
        SelfAffineError::NotGrowing { .. } => {
            "; shorten the range, characterise.self_affine_shortest_lag_mm to self_affine_longest_lag_mm"
        }
        SelfAffineError::Correlation(_) => "",
    }
}

/// After an error of [`crate::surface::texture::mean_profile_depths`].
pub(super) fn of_depth(error: &DepthError) -> String {
    match error {
        DepthError::Spacing { .. } => ", or lower ingest.conditioning.lateral_resolution_um".into(),
        DepthError::LowPass { .. } => {
            "; raise characterise.profile_depth.low_pass_mm, 2.4 mm in ISO 13473-1".into()
        }
        DepthError::FewPoints { .. } => {
            "; raise characterise.profile_depth.segment_mm, 100 mm in ISO 13473-1".into()
        }
        DepthError::Short { segment, .. } => {
            format!(" (characterise.profile_depth.segment_mm = {})", segment.m_to_mm())
        }
        DepthError::NoHeights => String::new(),
    }
}
