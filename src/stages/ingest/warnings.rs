//! What a user is told of the scans.

use super::read::LeftOutLine;
use super::{Ingest, Lines, MapRow, ReadFile, ScanFile};
use crate::scans::TextFormat;
use crate::scans::description::LengthUnit;
use crate::scans::text_shape::{repeated_inside, unit_name};
use crate::stages::keys;
use crate::surface::map::form::FormOfMap;
use crate::surface::{Conditioning, ConditioningReport, RawScan};
use crate::units::Units;

/// Where the description does not fit the files.
pub(super) fn of_description(
    ingest: &Ingest,
    files: &[ScanFile],
    read: &[ReadFile],
) -> Vec<String> {
    let mut warnings = Vec::new();
    if ingest.text.is_some() && read.iter().all(|file| !file.is_text) {
        warnings.push(
            "[ingest.text] describes no scan and does nothing: all files are those of \
             instruments, which state their own units and layout; heights that grow away from \
             the rubber are turned by ingest.invert_instrument_heights = true"
                .to_owned(),
        );
    }
    if ingest.invert_instrument_heights && read.iter().all(|file| file.is_text) {
        warnings.push(
            "ingest.invert_instrument_heights does nothing: no scan is the file of an \
             instrument; texts are turned by ingest.text.invert_z = true"
                .to_owned(),
        );
    }
    warnings.extend(channels(ingest, files, read));
    warnings.extend(repeated_heights(files, read));
    warnings.extend(stuck_sensors(files, read));
    warnings.extend(smooth_scans(files, read));
    warnings.extend(copies(files));
    let contradicted: Vec<_> =
        files.iter().zip(read).filter(|(_, read)| !read.contradictions.is_empty()).collect();
    if let Some((file, read)) = contradicted.first() {
        warnings.push(format!(
            "units of {} of {} files: in the first, {}, {} (ingest.text); the description counts, \
             change it if the file is right",
            contradicted.len(),
            files.len(),
            file.name,
            read.contradictions.join(", and ")
        ));
    }
    warnings
}

/// What became of the lines of maps that are kept.
pub(super) fn of_lines(
    ingest: &Ingest,
    lines: Lines,
    files: &[ScanFile],
    read: &[ReadFile],
) -> Vec<String> {
    if lines == Lines::None {
        return maps_alone(ingest, files, read);
    }
    let left_out: Vec<(&ScanFile, &LeftOutLine)> = files
        .iter()
        .zip(read)
        .flat_map(|(file, read)| read.left_out.iter().map(move |line| (file, line)))
        .collect();
    let Some((file, first)) = left_out.first() else { return Vec::new() };
    let kept: usize = read.iter().map(|read| read.scans.len()).sum();
    let others: Vec<&str> = left_out[1..].iter().map(|(_, line)| line.line.as_str()).collect();
    let more = match others.len() {
        0 => String::new(),
        _ if others.len() <= NAMED => format!("; the others are {}", others.join(", ")),
        count => {
            format!("; the others are {} and {} more", others[..NAMED].join(", "), count - NAMED)
        }
    };
    vec![format!(
        "{} of {} lines of height maps are left out: the first, {} of {}, because {}{}{more}",
        left_out.len(),
        kept + left_out.len(),
        first.line,
        file.path.display(),
        first.reason,
        keys::of_conditioning(&first.reason)
    )]
}

/// Lines that are left out and named.
const NAMED: usize = 8;

/// That no line scans are taken, what does nothing then, and which files are no maps.
fn maps_alone(ingest: &Ingest, files: &[ScanFile], read: &[ReadFile]) -> Vec<String> {
    let set = ingest.conditioning != Conditioning::default();
    let idle = if set { " and [ingest.conditioning] does nothing" } else { "" };
    let mut warnings = vec![format!(
        "the maps stand alone (realise.profiles = false): no line scans are taken of them, there are no tables of lines, and the stage approximate is left out{idle}"
    )];
    let lines: Vec<&ScanFile> = files
        .iter()
        .zip(read)
        .filter_map(|(file, read)| read.map.is_none().then_some(file))
        .collect();
    if let Some(first) = lines.first() {
        warnings.push(format!(
            "{} of {} files are no height maps and are left out, the first {}: set realise.profiles = true for their lines",
            lines.len(),
            files.len(),
            first.path.display()
        ));
    }
    warnings
}

/// Maps that have no window.
pub(super) fn maps_left_out(left_out: &[MapRow], kept: &[MapRow]) -> Option<String> {
    let kept = kept.chunk_by(|a, b| a.map == b.map).count();
    let reasons: Vec<&str> = left_out.iter().filter_map(|row| row.rejected.as_deref()).collect();
    (!reasons.is_empty()).then(|| {
        format!(
            "{} of {} height maps are left out: {}",
            left_out.len(),
            left_out.len() + kept,
            reasons.join("; ")
        )
    })
}

/// Channels of ERD files of which one was taken without being asked for, or that no file has.
fn channels(ingest: &Ingest, files: &[ScanFile], read: &[ReadFile]) -> Option<String> {
    if ingest.erd_channel.is_some() {
        let none = read.iter().all(|file| !file.is_erd);
        return none.then(|| "ingest.erd_channel does nothing: no scan is an ERD file".to_owned());
    }
    let several =
        files.iter().zip(read).filter_map(|(file, read)| Some((file, read.channels.as_ref()?)));
    let several: Vec<_> = several.collect();
    let (file, channels) = several.first()?;
    Some(format!(
        "{} of {} files have several channels of heights, of which the first is taken: in {} these are \
         {channels}; choose by ingest.erd_channel",
        several.len(),
        files.len(),
        file.name
    ))
}

/// A height that seems to stand for missing ones in a scan, in words with its count and share, as
/// the file has it; `None` for `format` means the file of an instrument.
pub(super) fn repeated(scan: &RawScan, format: Option<&TextFormat>) -> Option<String> {
    let found = repeated_inside(&scan.heights);
    let mark = found.first()?;
    let unit = format.and_then(|format| format.z_unit).unwrap_or(LengthUnit::Mm);
    let sign = if format.is_some_and(|format| format.invert_z) { -1.0 } else { 1.0 };
    // Nine digits and more are round-off of the conversion to metres. Adding 0 takes the sign off 0.
    let typed = sign * mark.height / unit.metres(1.0) + 0.0;
    let typed: f64 = format!("{typed:.9e}").parse().unwrap_or(typed);
    let points = scan.heights.len();
    Some(format!(
        "the height {typed} {} is there {} times in {points} points ({:.1} %), any other {} times at \
         most",
        unit_name(unit),
        mark.count,
        100.0 * mark.count as f64 / points as f64,
        mark.others
    ))
}

/// Points that a sensor that stood still must make: this share of a scan, and so many.
const STUCK_SHARE: f64 = 0.05;
const STUCK_POINTS: usize = 50;

/// The longest stretch of one height, in words, if it is so long that no road has made it; the coarsest steps of an instrument
/// repeat a height some ten times.
pub(super) fn stuck(scan: &RawScan) -> Option<String> {
    let heights = &scan.heights;
    let mut longest = 0..0;
    let mut start = 0;
    for i in 1..=heights.len() {
        if i == heights.len() || heights[i] != heights[start] {
            if i - start > longest.len() && heights[start].is_finite() {
                longest = start..i;
            }
            start = i;
        }
    }
    let least = STUCK_POINTS.max((STUCK_SHARE * heights.len() as f64).ceil() as usize);
    let [first, last] = [longest.start, longest.end.max(1) - 1].map(|i| scan.positions.get(i));
    (longest.len() >= least).then(|| {
        let [first, last] = [first, last].map(|x| x.copied().unwrap_or(f64::NAN).m_to_mm());
        format!(
            "{} of {} points ({:.0} %), from {first:.3} to {last:.3} mm, have one and the same height",
            longest.len(),
            heights.len(),
            100.0 * longest.len() as f64 / heights.len() as f64
        )
    })
}

/// Interquartile range in m below which heights are those of no road, on a length in m and more: worn asphalt has
/// some hundred times more.
const SMOOTH: f64 = 1e-7;
const LENGTH_OF_SMOOTH: f64 = 2e-3;

/// The middle half of the heights of a scan that is smoother than any road, in words.
pub(super) fn smooth(scan: &RawScan) -> Option<String> {
    let length = scan.positions.last()? - scan.positions.first()?;
    let mut heights: Vec<f64> = scan.heights.iter().copied().filter(|z| z.is_finite()).collect();
    heights.sort_by(f64::total_cmp);
    let [low, high] = [1, 3].map(|quarter| heights.get(quarter * heights.len() / 4).copied());
    let range = high? - low?;
    (length.abs() >= LENGTH_OF_SMOOTH && range > 0.0 && range < SMOOTH).then(|| {
        format!(
            "half of the heights lie within {:.2e} um on {:.1} mm of track",
            range.m_to_um(),
            length.abs().m_to_mm()
        )
    })
}

/// Says so where a scan is smoother than any road.
fn smooth_scans(files: &[ScanFile], read: &[ReadFile]) -> Option<String> {
    let found: Vec<_> = files.iter().zip(read).filter(|(_, read)| read.smooth.is_some()).collect();
    let (file, read) = found.first()?;
    Some(format!(
        "{} of {} files are smoother than any road: in the first, {}, {}; are the heights in another unit than {}?",
        found.len(),
        files.len(),
        file.name,
        read.smooth.as_deref().unwrap_or_default(),
        if read.is_text { "ingest.text.z_unit says" } else { "the file says" }
    ))
}

/// Says so where a scan stands still.
fn stuck_sensors(files: &[ScanFile], read: &[ReadFile]) -> Option<String> {
    let found: Vec<_> = files.iter().zip(read).filter(|(_, read)| read.stuck.is_some()).collect();
    let (file, read) = found.first()?;
    Some(format!(
        "{} of {} files stand still: in the first, {}, {}: a sensor that stopped or a plate? Leave the stretch out with \
         ingest.text.cut_start_mm and cut_end_mm, or the file",
        found.len(),
        files.len(),
        file.name,
        read.stuck.as_deref().unwrap_or_default()
    ))
}

/// Says so where two files are one.
fn copies(files: &[ScanFile]) -> Option<String> {
    let copy = |(i, file): (usize, &ScanFile)| {
        let first = files[..i].iter().find(|other| other.digest == file.digest)?;
        Some((first.name.clone(), file.name.clone()))
    };
    let found: Vec<(String, String)> = files.iter().enumerate().filter_map(copy).collect();
    let (first, second) = found.first()?;
    Some(format!(
        "{} of {} files are copies of others and count twice: {second} has the bytes of {first}; leave one out",
        found.len(),
        files.len()
    ))
}

/// Says so where a height is repeated as if it stood for missing ones.
fn repeated_heights(files: &[ScanFile], read: &[ReadFile]) -> Option<String> {
    let found: Vec<_> =
        files.iter().zip(read).filter(|(_, read)| read.repeated.is_some()).collect();
    let (file, read) = found.first()?;
    let way_out = match read.is_text {
        true => "list it in ingest.text.missing if it marks points without a return",
        false => {
            "if it marks points without a return, export the file with a mark for them, or as text \
             with ingest.text.missing"
        }
    };
    Some(format!(
        "{} of {} files repeat one height as if it were a mark of missing points: in the first, {}, {}; \
         {way_out}",
        found.len(),
        files.len(),
        file.name,
        read.repeated.as_deref().unwrap_or_default()
    ))
}

/// What the scans themselves give reason for.
pub(super) fn of_scans(reports: &[&ConditioningReport]) -> Vec<String> {
    [rejected(reports), jumps(reports), far(reports)].into_iter().flatten().collect()
}

/// What the maps give reason for.
pub(super) fn of_maps(windows: &[MapRow], form: FormOfMap) -> Vec<String> {
    let mut warnings = Vec::new();
    let maps: Vec<&MapRow> = windows.chunk_by(|a, b| a.map == b.map).map(|own| &own[0]).collect();
    let rejected: Vec<&MapRow> = windows.iter().filter(|row| row.rejected.is_some()).collect();
    if let Some(first) = rejected.first() {
        warnings.push(format!(
            "{} of {} windows of maps were rejected, the first, {}, because {}",
            rejected.len(),
            windows.len(),
            first.window,
            first.rejected.as_deref().unwrap_or_default()
        ));
    }
    let jumped: Vec<&&MapRow> =
        maps.iter().filter(|row| row.jumped_rows + row.jumped_columns > 0).collect();
    if let Some(first) = jumped.first() {
        warnings.push(format!(
            "{} of {} maps have rows or columns that jumped as a whole, the first, {}, {} rows and {} columns: a contact rests on \
             such steps; look at ingest/cleaning.md, set ingest.maps.level_jumps = \"missing\" to leave them out",
            jumped.len(),
            maps.len(),
            first.map,
            first.jumped_rows,
            first.jumped_columns
        ));
    }
    let tilted = |row: &&&MapRow| {
        let rise = |slope: Option<f64>, points: u64, um: f64| {
            slope.unwrap_or(0.0).abs() * points as f64 * um
        };
        let rise_um = rise(row.tilt_x, row.points_x, row.spacing_x_um)
            + rise(row.tilt_y, row.points_y, row.spacing_y_um);
        rise_um > MUCH_TILT_UM
    };
    if let (FormOfMap::Mean, Some(first)) = (form, maps.iter().find(tilted)) {
        warnings.push(format!(
            "map {} is tilted by {:.4} along x and {:.4} along y, and ingest.maps.form = \"mean\" leaves that: it is the rise of \
             every period of the surface; take \"plane\"",
            first.map,
            first.tilt_x.unwrap_or_default(),
            first.tilt_y.unwrap_or_default()
        ));
    }
    warnings
}

/// Rise in µm of a map over its sides that is told of.
const MUCH_TILT_UM: f64 = 10.0;

fn rejected(reports: &[&ConditioningReport]) -> Option<String> {
    let windows = reports.iter().flat_map(|report| &report.windows);
    let total = windows.clone().count();
    let rejected: Vec<_> = windows.filter(|window| window.rejected.is_some()).collect();
    let first = rejected.first()?;
    let reason = first.rejected.as_deref().unwrap_or_default();
    Some(format!(
        "{} of {total} windows were rejected, the first, {}, because {reason}",
        rejected.len(),
        first.name
    ))
}

/// Says so where level jumps that were kept make most of the shortest waves of a scan.
fn jumps(reports: &[&ConditioningReport]) -> Option<String> {
    let decided_by_jumps = |report: &&&ConditioningReport| {
        report.faults.iter().any(|fault| {
            fault.fault == "level jumps"
                && fault.decision == "kept"
                && fault.high_frequency_ratio.is_some_and(|ratio| ratio < 0.5)
        })
    };
    let concerned: Vec<_> = reports.iter().filter(decided_by_jumps).collect();
    let first = concerned.first()?;
    Some(format!(
        "level jumps make more than half of the shortest waves of {} of {} scans, the first {}; \
         look at ingest/faults.arrow, consider ingest.conditioning.level_jumps = \"missing\"",
        concerned.len(),
        reports.len(),
        first.scan
    ))
}

/// Says so where heights are left that no road has.
fn far(reports: &[&ConditioningReport]) -> Option<String> {
    let far: Vec<_> = reports.iter().filter_map(|report| Some((report, report.far?))).collect();
    let (first, heights) = far.first()?;
    Some(format!(
        "{} of {} scans keep heights more than ten interquartile ranges outside their quartiles; the \
         first, {}, {} between {:.1} and {:.1} mm: a reference plate or a mark of missing points? \
         look at ingest/cleaning.md, consider ingest.text.cut_start_mm and cut_end_mm, \
         ingest.conditioning.valid_range_mm or ingest.text.missing",
        far.len(),
        reports.len(),
        first.scan,
        heights.count,
        heights.first_mm,
        heights.last_mm
    ))
}
