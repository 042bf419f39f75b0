//! Parameters of the standards: profile parameters, mean profile depth, texture levels.

use super::warnings::left_out;
use super::{AVERAGE, Characterise, require_ascending};
use crate::artifact::{Row, Table};
use crate::requirement::{InvalidRecipe, require};
use crate::stages::keys;
use crate::surface::filter::{ProfileFilter, waviness};
use crate::surface::profile::{ProfileParameters, profile_parameters};
use crate::surface::texture::{DepthError, DepthOptions, mean_profile_depths, texture_bands};
use crate::surface::{LineScan, PowerSpectrum};
use crate::units::Units;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Profile parameters of each window: `profile_parameters.arrow`.
pub const PROFILE: Table<ProfileRow> = Table::new("characterise", "profile_parameters.arrow");
/// Mean profile depths of the segments: `profile_depth.arrow`.
pub const DEPTH: Table<DepthRow> = Table::new("characterise", "profile_depth.arrow");
/// Texture levels in third-octave bands, per window and averaged: `texture.arrow`.
pub const TEXTURE: Table<TextureRow> = Table::new("characterise", "texture.arrow");

/// Sections in a window where the recipe gives neither their length nor a cut-off, as in the
/// default evaluation length of the standards.
const SECTIONS: usize = 5;

/// The mean profile depth: what ISO 13473-1 leaves open or fixes by a number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ProfileDepth {
    /// Length of a segment in millimetres.
    pub segment_mm: f64,
    /// Largest share of drop-outs and spikes in a segment that counts.
    pub most_drop_outs: f64,
    /// Slope to both neighbours from which a height is a spike.
    pub spike_slope: f64,
    /// Cut-off in millimetres of the low-pass filter, applied forwards and backwards.
    pub low_pass_mm: f64,
    /// Cut-off in millimetres of the high-pass filter, usually 174.2, for windows that are long
    /// against it; slope suppression in each segment if not set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub high_pass_mm: Option<f64>,
}

impl Default for ProfileDepth {
    fn default() -> Self {
        let usual = DepthOptions::default();
        Self {
            // Round millimetres stay round.
            segment_mm: 100.0,
            most_drop_outs: usual.most_drop_outs,
            spike_slope: usual.spike_slope,
            low_pass_mm: 2.4,
            high_pass_mm: usual.high_pass.map(crate::units::Units::m_to_mm),
        }
    }
}

impl ProfileDepth {
    pub(super) fn check(&self) -> Result<(), InvalidRecipe> {
        let share = self.most_drop_outs;
        let key = "characterise.profile_depth.most_drop_outs";
        require((0.0..1.0).contains(&share), key, share, "from 0 to below 1")?;
        for (key, value) in [
            ("characterise.profile_depth.segment_mm", Some(self.segment_mm)),
            ("characterise.profile_depth.spike_slope", Some(self.spike_slope)),
            ("characterise.profile_depth.low_pass_mm", Some(self.low_pass_mm)),
            ("characterise.profile_depth.high_pass_mm", self.high_pass_mm),
        ] {
            let positive = value.is_none_or(|x| x > 0.0 && x.is_finite());
            require(positive, key, value.unwrap_or_default(), "positive and finite")?;
        }
        let low = Some(self.low_pass_mm);
        let keys = "characterise.profile_depth.(low_pass_mm, high_pass_mm)";
        require_ascending(keys, low, self.high_pass_mm)?;
        let keys = "characterise.profile_depth.(low_pass_mm, segment_mm)";
        require_ascending(keys, low, Some(self.segment_mm))
    }

    fn options(&self) -> DepthOptions {
        DepthOptions {
            segment: self.segment_mm.mm_to_m(),
            most_drop_outs: self.most_drop_outs,
            spike_slope: self.spike_slope,
            low_pass: self.low_pass_mm.mm_to_m(),
            high_pass: self.high_pass_mm.map(crate::units::Units::mm_to_m),
        }
    }
}

/// Profile parameters of one window after ISO 21920-2 or ISO 4287, of the roughness profile that
/// `lambda_s_mm` and `lambda_c_mm` leave.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProfileRow {
    /// Name of the window.
    pub scan: String,
    /// Length of a section.
    #[schemars(extend("unit" = "mm"))]
    pub section_length_mm: f64,
    /// Number of sections.
    pub sections: u64,
    /// Ra, mean absolute height.
    #[schemars(extend("unit" = "mm"))]
    pub ra_mm: f64,
    /// Rq, root mean square height.
    #[schemars(extend("unit" = "mm"))]
    pub rq_mm: f64,
    /// Rp, mean over the sections of the highest peak.
    #[schemars(extend("unit" = "mm"))]
    pub rp_mm: f64,
    /// Rv, mean over the sections of the largest depth, positive.
    #[schemars(extend("unit" = "mm"))]
    pub rv_mm: f64,
    /// Rz = Rp + Rv.
    #[schemars(extend("unit" = "mm"))]
    pub rz_mm: f64,
    /// Rt, total height over all sections.
    #[schemars(extend("unit" = "mm"))]
    pub rt_mm: f64,
    /// Rsk, skewness.
    #[schemars(extend("unit" = "1"))]
    pub rsk: f64,
    /// Rku, kurtosis.
    #[schemars(extend("unit" = "1"))]
    pub rku: f64,
    /// RSm, mean spacing of profile elements higher than a tenth of Rz on either side; absent
    /// where there is no complete one.
    #[schemars(extend("unit" = "mm"))]
    pub rsm_mm: Option<f64>,
    /// Rdq, root mean square slope by the seven-point formula; absent where gaps leave none.
    #[schemars(extend("unit" = "1"))]
    pub rdq: Option<f64>,
}

impl Row for ProfileRow {
    const SCHEMA: &'static str = "asperity.characterise.profile_parameters";
    const VERSION: u32 = 1;
}

/// Mean profile depth of one segment after ISO 13473-1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DepthRow {
    /// Name of the window.
    pub scan: String,
    /// Start of the segment in the window.
    #[schemars(extend("unit" = "mm"))]
    pub start_mm: f64,
    /// Share of interpolated points, drop-outs and spikes.
    #[schemars(extend("unit" = "1"))]
    pub interpolated_share: f64,
    /// Mean profile depth; absent where too many points were interpolated.
    #[schemars(extend("unit" = "mm"))]
    pub depth_mm: Option<f64>,
}

impl Row for DepthRow {
    const SCHEMA: &'static str = "asperity.characterise.profile_depth";
    const VERSION: u32 = 1;
}

/// Texture level of one third-octave band after ISO 13473-4.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TextureRow {
    /// Name of the window, or `average` over all windows.
    pub scan: String,
    /// Centre wavelength of the band.
    #[schemars(extend("unit" = "mm"))]
    pub wavelength_mm: f64,
    /// Texture level `20 lg(root mean square height / 1e-6 m)`.
    #[schemars(extend("unit" = "dB"))]
    pub level_db: f64,
    /// Mean square height of the band.
    #[schemars(extend("unit" = "mm^2"))]
    pub mean_square_mm2: f64,
}

impl Row for TextureRow {
    const SCHEMA: &'static str = "asperity.characterise.texture";
    const VERSION: u32 = 1;
}

/// Rows of the windows, and warnings: of windows without one, since they are flat or the cut-offs
/// and sections do not fit them, and of cut-offs and sections longer than a window.
pub(super) fn profile_rows(
    parameters: &Characterise,
    windows: &[LineScan],
) -> (Vec<ProfileRow>, Vec<String>) {
    let found: Vec<_> = windows.par_iter().map(|window| profile_row(parameters, window)).collect();
    let (mut rows, mut without) = (Vec::new(), Vec::new());
    for (window, row) in windows.iter().zip(found) {
        match row {
            Ok(row) => rows.push(row),
            Err(reason) => without.push((window.name.clone(), reason)),
        }
    }
    let told = left_out("windows", windows.len(), "profile parameters", &without);
    let keys = [
        ("lambda_c_mm", parameters.lambda_c_mm),
        ("section_length_mm", parameters.section_length_mm),
    ];
    let longer = |(key, mm): (&str, Option<f64>)| {
        let mm = mm?;
        let mm_of = |points: usize, window: &LineScan| (points as f64 * window.spacing).m_to_mm();
        // A window cut to whole points is up to one spacing shorter than what was asked for.
        let is_longer = |w: &&LineScan| mm >= mm_of(evaluated(parameters, w).len() + 1, w);
        let window = windows.iter().find(is_longer).filter(|_| !rows.is_empty())?;
        Some(format!(
            "characterise.{key} = {mm} is longer than what is evaluated of the window {}, {:.4} mm, \
             which is taken as one section",
            window.name,
            mm_of(evaluated(parameters, window).len(), window)
        ))
    };
    let longer: Vec<String> = keys.into_iter().filter_map(longer).collect();
    (rows, told.into_iter().chain(longer).collect())
}

fn length_mm(window: &LineScan) -> f64 {
    (window.heights.len() as f64 * window.spacing).m_to_mm()
}

/// Why cut-offs and sections do not fit a window, if they do not.
fn misfit(parameters: &Characterise, window: &LineScan) -> Option<String> {
    /// Fewer points show no peak between two valleys.
    const FEWEST_POINTS: usize = 5;
    let (spacing_mm, length_mm) = (window.spacing.m_to_mm(), length_mm(window));
    let (evaluated, points) = (evaluated(parameters, window), section_points(parameters, window));
    match (parameters.lambda_c_mm, parameters.lambda_s_mm) {
        (Some(mm), _) if mm < 2.0 * spacing_mm => Some(format!(
            "characterise.lambda_c_mm = {mm} is below two spacings of {spacing_mm:.4} mm: no \
             roughness is left"
        )),
        (_, Some(mm)) if mm > length_mm / 3.0 => Some(format!(
            "characterise.lambda_s_mm = {mm} is longer than a third of its {length_mm:.4} mm"
        )),
        _ if evaluated.is_empty() => Some(format!(
            "the Gaussian filter needs half a cut-off at each end, which leaves nothing of its \
             {length_mm:.4} mm; set a shorter characterise.lambda_c_mm, or characterise.profile_filter = \
             \"gaussian_regression\", which filters up to the ends"
        )),
        _ if points < FEWEST_POINTS => Some(format!(
            "a section has {points} of at least {FEWEST_POINTS} points; set a longer \
             characterise.section_length_mm (lambda_c_mm where that is not set)"
        )),
        _ => None,
    }
}

/// The parameters of a window, or why it has none.
fn profile_row(parameters: &Characterise, window: &LineScan) -> Result<ProfileRow, String> {
    if let Some(reason) = misfit(parameters, window) {
        return Err(reason);
    }
    let points = section_points(parameters, window);
    let spacing = window.spacing;
    let roughness = &roughness(parameters, window)[evaluated(parameters, window)];
    let found = profile_parameters(roughness, spacing, points, parameters.profile_standard)
        .ok_or("it is flat, or one of its sections has no height at all")?;
    let ProfileParameters { ra, rq, rp, rv, rz, rt, rsk, rku, rsm, rdq, sections } = found;
    if rp < 0.0 || rv < 0.0 {
        return Err(format!(
            "its sections of {:.4} mm lie on one side of the mean line; set \
             characterise.lambda_c_mm to take long waves off, or a longer section_length_mm",
            (points as f64 * spacing).m_to_mm()
        ));
    }
    Ok(ProfileRow {
        scan: window.name.clone(),
        section_length_mm: (points as f64 * spacing).m_to_mm(),
        sections: sections as u64,
        ra_mm: ra.m_to_mm(),
        rq_mm: rq.m_to_mm(),
        rp_mm: rp.m_to_mm(),
        rv_mm: rv.m_to_mm(),
        rz_mm: rz.m_to_mm(),
        rt_mm: rt.m_to_mm(),
        rsk,
        rku,
        rsm_mm: rsm.map(crate::units::Units::m_to_mm),
        rdq,
    })
}

/// The points that count: those half the longer cut-off or more from both ends where the filter is the
/// Gaussian of ISO 16610-21, whose weights are one-sided there. Instruments have their run-up and
/// overrun for it (ISO 4288, ISO 21920-3). The regression filters hold up to the ends.
fn evaluated(parameters: &Characterise, window: &LineScan) -> Range<usize> {
    let cut_off_mm = match parameters.profile_filter {
        ProfileFilter::Gaussian => parameters.lambda_c_mm.or(parameters.lambda_s_mm),
        ProfileFilter::GaussianRegression | ProfileFilter::RobustGaussian => None,
    };
    // Round-off must not cost a point.
    let end = cut_off_mm.map_or(0, |mm| (mm / 2e3 / window.spacing * (1.0 - 1e-9)).ceil() as usize);
    match window.heights.len().checked_sub(2 * end) {
        Some(points) => end..end + points,
        None => 0..0,
    }
}

fn section_points(parameters: &Characterise, window: &LineScan) -> usize {
    let points = evaluated(parameters, window).len();
    match parameters.section_length_mm.or(parameters.lambda_c_mm) {
        // Round-off must not cost a point; a section longer than what counts is all of it.
        Some(mm) => ((mm.mm_to_m() / window.spacing * (1.0 + 1e-9)).floor() as usize)
            .clamp(1, points.max(1)),
        None => (points / SECTIONS).max(1),
    }
}

/// What the filters leave: waves longer than lambda_s, shorter than lambda_c.
fn roughness(parameters: &Characterise, window: &LineScan) -> Vec<f64> {
    let filtered = |heights: &[f64], mm: f64| {
        waviness(heights, window.spacing, mm.mm_to_m(), parameters.profile_filter)
    };
    let primary = match parameters.lambda_s_mm {
        // The filters bridge gaps; what was missing stays missing.
        Some(mm) => filtered(&window.heights, mm)
            .into_iter()
            .zip(&window.heights)
            .map(|(line, z)| if z.is_nan() { f64::NAN } else { line })
            .collect(),
        None => window.heights.clone(),
    };
    match parameters.lambda_c_mm {
        Some(mm) => filtered(&primary, mm).iter().zip(&primary).map(|(w, z)| z - w).collect(),
        None => primary,
    }
}

/// Rows of the segments, and warnings where there are none or some have no depth.
pub(super) fn depth_rows(
    parameters: &Characterise,
    windows: &[LineScan],
) -> (Vec<DepthRow>, Vec<String>) {
    let options = parameters.profile_depth.options();
    let rows = |window: &LineScan| {
        let depths = mean_profile_depths(&window.heights, window.spacing, &options)?;
        let row = |segment: crate::surface::texture::SegmentDepth| DepthRow {
            scan: window.name.clone(),
            start_mm: segment.start.m_to_mm(),
            interpolated_share: segment.interpolated,
            depth_mm: segment
                .depth
                .filter(|depth| depth.is_finite())
                .map(crate::units::Units::m_to_mm),
        };
        Ok(depths.into_iter().map(row).collect())
    };
    let found: Vec<Result<Vec<DepthRow>, DepthError>> = windows.par_iter().map(rows).collect();
    let reasons = windows.iter().zip(&found).filter_map(|(window, found)| {
        let error = found.as_ref().err()?;
        Some((window.name.clone(), format!("{error}{}", keys::of_depth(error))))
    });
    // Scans of a few centimetres are not made for the mean profile depth: of windows shorter than half
    // a segment nothing is said unless the recipe has a key of it.
    let depth = &parameters.profile_depth;
    let is_meant = *depth != ProfileDepth::default()
        || windows.iter().any(|window| length_mm(window) >= depth.segment_mm / 2.0);
    let reasons: Vec<_> = reasons.filter(|_| is_meant).collect();
    let refused = left_out("windows", windows.len(), "mean profile depth", &reasons);
    let rows: Vec<DepthRow> = found.into_iter().flatten().flatten().collect();
    let told = without_depth(depth, &rows);
    (rows, refused.into_iter().chain(told).collect())
}

/// A warning of segments of which too little is known.
fn without_depth(depth: &ProfileDepth, rows: &[DepthRow]) -> Option<String> {
    let limit = 100.0 * depth.most_drop_outs;
    let without = |row: &&DepthRow| row.depth_mm.is_none();
    let told = |row: &DepthRow| {
        let (name, share) = (&row.scan, 100.0 * row.interpolated_share);
        let reason = format!(
            "{share:.1} % of its points are drop-outs and spikes, the limit is {limit:.1} % \
             (characterise.profile_depth.most_drop_outs); points that cleaning made missing count \
             as drop-outs"
        );
        (format!("{name} from {:.1} mm on", row.start_mm), reason)
    };
    let without: Vec<_> = rows.iter().filter(without).map(told).collect();
    left_out("segments", rows.len(), "mean profile depth", &without)
}

/// Bands in which a spectrum of a gappy scan came out without power have no level and no row.
pub(super) fn texture_rows(
    names: &[&str],
    spectra: &[PowerSpectrum],
    mean: &PowerSpectrum,
) -> Vec<TextureRow> {
    let named = names.iter().copied().zip(spectra).chain([(AVERAGE, mean)]);
    let rows = |(scan, spectrum): (&str, &PowerSpectrum)| -> Vec<TextureRow> {
        let bands = texture_bands(spectrum).into_iter().filter(|band| band.mean_square > 0.0);
        let row = |band: crate::surface::texture::TextureBand| TextureRow {
            scan: scan.to_owned(),
            wavelength_mm: band.wavelength.m_to_mm(),
            level_db: band.level(),
            mean_square_mm2: band.mean_square.m2_to_mm2(),
        };
        bands.map(row).collect()
    };
    named.flat_map(rows).collect()
}
