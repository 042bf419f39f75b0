//! ERD, the road profile of the Engineering Research Division of UMTRI, with its numbers as text.
//!
//! The first line is `ERDFILEV2.00`. The second has, between commas: number of channels, number
//! of samples (or -1), records, bytes, a key for the kind of numbers (5 is text), the step of x.
//! Keywords of eight letters follow up to `END`, then a line of one number per channel for each
//! sample.

use super::bytes::count;
use super::error::{FileProblem, Place, unexpected};
use super::{Grid, ScanFile, metres_of, spacing};

/// Name of what [`ScanFile::instrument`] says of the channels of a file that has several of heights.
pub const CHANNELS: &str = "channels of heights";

/// Reads an ERD file. The profile is the channel asked for, by its number from 1, else the first of a
/// length.
pub(super) fn read(bytes: &[u8], chosen: Option<usize>) -> Result<ScanFile, FileProblem> {
    let (text, _) = encoding_rs::WINDOWS_1252.decode_without_bom_handling(bytes);
    let lines: Vec<&str> = text.lines().collect();
    let layout = Layout::read(lines.get(1).copied().unwrap_or_default())?;
    let end =
        lines.iter().position(|line| line.trim().eq_ignore_ascii_case("END")).ok_or_else(|| {
            unexpected(Place::Line(lines.len()), "the header", "not ended", "a line END")
        })?;
    let keywords = Keywords { lines: lines.get(2..end).unwrap_or_default() };
    let (place, x_unit) = keywords.find("XUNITS").unwrap_or((2, String::new()));
    let x_metres = metres_of(&x_unit).ok_or_else(|| {
        let expected = "a length, such as m or ft";
        unexpected(Place::Line(place), "the unit of x (XUNITS)", &x_unit, expected)
    })?;
    let spacing = spacing(Place::Line(2), layout.step * x_metres)?;
    let (place, units) = keywords.find("UNITSNAM").unwrap_or((2, String::new()));
    let profiles = profiles(&units, layout.channels);
    let names = keywords.find("SHORTNAM").map(|(_, names)| names).unwrap_or_default();
    let (profile, metres) = choose(&profiles, chosen).ok_or_else(|| match chosen {
        Some(number) => unexpected(
            Place::Line(place),
            "the channel asked for",
            number,
            format!("a channel of heights: {}", listed(&profiles, &names)),
        ),
        None => unexpected(
            Place::Line(place),
            "the units (UNITSNAM)",
            &units,
            "a length, such as mm or in",
        ),
    })?;
    let heights = layout.heights(&lines, end + 1, profile, metres)?;
    let mut instrument: Vec<(String, String)> =
        [("TITLE", "title"), ("DATE", "created"), ("INSTRUMT", "model")]
            .into_iter()
            .filter_map(|(key, name)| Some((name.to_owned(), keywords.find(key)?.1)))
            .collect();
    if !names.is_empty() {
        instrument.push(("channel".into(), columns_of_eight(&names, profile)));
    }
    if profiles.len() > 1 {
        instrument.push((CHANNELS.into(), listed(&profiles, &names)));
    }
    Ok(ScanFile {
        format: "ERD".into(),
        detected: format!(
            "the first line is `{}`: road profile as text, channel {} of {} read",
            lines.first().copied().unwrap_or_default().trim(),
            profile + 1,
            layout.channels
        ),
        grid: Grid::Profile { spacing },
        heights,
        instrument,
    })
}

/// The channels that hold lengths: their places from 0, and metres of their units.
fn profiles(units: &str, channels: usize) -> Vec<(usize, f64)> {
    let unit = |place| Some((place, metres_of(&columns_of_eight(units, place))?));
    (0..channels).filter_map(unit).collect()
}

/// The channel asked for, by its number from 1, or the first.
fn choose(profiles: &[(usize, f64)], chosen: Option<usize>) -> Option<(usize, f64)> {
    match chosen {
        Some(number) => profiles.iter().find(|(place, _)| place + 1 == number).copied(),
        None => profiles.first().copied(),
    }
}

/// The channels that hold lengths by number and name: `1 LElev., 2 RElev.`.
fn listed(profiles: &[(usize, f64)], names: &str) -> String {
    let of = |(place, _): &(usize, f64)| {
        format!("{} {}", place + 1, columns_of_eight(names, *place)).trim_end().to_owned()
    };
    profiles.iter().map(of).collect::<Vec<_>>().join(", ")
}

struct Layout {
    channels: usize,
    /// `None` where the file leaves it open.
    samples: Option<usize>,
    step: f64,
}

impl Layout {
    fn read(line: &str) -> Result<Self, FileProblem> {
        const MOST_CHANNELS: u64 = 1024;
        let place = || Place::Line(2);
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let cell = |place_in_line: usize, what| {
            let text = cells.get(place_in_line).copied().unwrap_or_default();
            text.parse::<f64>().map_err(|_| unexpected(place(), what, text, "a number"))
        };
        let whole = |place_in_line, what| {
            let value = cell(place_in_line, what)?;
            if value.fract() != 0.0 || value.abs() > 1e15 {
                return Err(unexpected(place(), what, value, "a whole number"));
            }
            Ok(value as i64)
        };
        let channels = whole(0, "the number of channels")?;
        let channels = u64::try_from(channels)
            .ok()
            .filter(|channels| (1..=MOST_CHANNELS).contains(channels))
            .ok_or_else(|| unexpected(place(), "the number of channels", channels, "1 to 1024"))?;
        let samples = whole(1, "the number of samples")?;
        let samples = match u64::try_from(samples) {
            Ok(samples) => Some(count(place(), channels, samples)?.1),
            Err(_) => None,
        };
        match whole(4, "the kind of numbers")? {
            5 => {}
            kind => {
                return Err(FileProblem::Unsupported {
                    place: place(),
                    what: format!("numbers of kind {kind}, in a second file"),
                    advice: "save the profile as text (kind 5)",
                });
            }
        }
        Ok(Self { channels: channels as usize, samples, step: cell(5, "the step of x")? })
    }

    fn heights(
        &self,
        lines: &[&str],
        start: usize,
        channel: usize,
        metres: f64,
    ) -> Result<Vec<f64>, FileProblem> {
        let mut heights = Vec::new();
        for (index, line) in lines.iter().enumerate().skip(start) {
            let place = || Place::Line(index + 1);
            let words = line.split(|c: char| c == ',' || c.is_whitespace());
            let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
            if words.is_empty() {
                continue;
            }
            if words.len() != self.channels {
                return Err(unexpected(place(), "the number of cells", words.len(), self.channels));
            }
            let value: f64 = words[channel]
                .parse()
                .map_err(|_| unexpected(place(), "a height", words[channel], "a number"))?;
            heights.push(value * metres);
        }
        match self.samples {
            Some(samples) if samples != heights.len() => {
                let place = Place::Line(lines.len());
                Err(unexpected(place, "the number of samples", heights.len(), samples))
            }
            _ => Ok(heights),
        }
    }
}

/// Lines of a keyword of eight letters and its value.
struct Keywords<'a> {
    lines: &'a [&'a str],
}

impl Keywords<'_> {
    /// Number of the line and value.
    fn find(&self, keyword: &str) -> Option<(usize, String)> {
        self.lines.iter().enumerate().find_map(|(index, line)| {
            let (name, value) = line.split_at_checked(8).unwrap_or((line, ""));
            // A UNITSNAM keeps its blanks: they separate names of eight letters.
            (name.trim().eq_ignore_ascii_case(keyword))
                .then(|| (index + 3, value.trim_end().to_owned()))
        })
    }
}

/// The name at a place of a list in columns of eight letters.
fn columns_of_eight(names: &str, place: usize) -> String {
    names.chars().skip(8 * place).take(8).collect::<String>().trim().to_owned()
}
