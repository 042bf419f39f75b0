//! ERD, the road profile of the Engineering Research Division of UMTRI, with its numbers as text.
//!
//! The first line is `ERDFILEV2.00`. The second has, between commas: number of channels, number
//! of samples (or -1), records, bytes, a key for the kind of numbers (5 is text), the step of x.
//! Keywords of eight letters follow up to `END`, then a line of one number per channel for each
//! sample.

use super::bytes::{count, holds};
use super::error::{FileProblem, Place, of_line, shorten, unexpected};
use super::heights::{Checked, Heights};
use super::{Grid, OpenScan, metres_of, spacing};
use crate::Source;
use crate::last_number::LastNumber;
use crate::lines::Lines;
use encoding_rs::WINDOWS_1252;
use std::io::Read;

/// Name of what [`ScanFile::instrument`](super::ScanFile::instrument) says of the channels of a file that has several of
/// heights.
pub const CHANNELS: &str = "channels of heights";

/// Reads the header of an ERD file. The profile is the channel asked for, by its number from 1, else the first
/// of a length.
pub(super) fn open(source: Source<'_>, chosen: Option<usize>) -> Result<OpenScan<'_>, FileProblem> {
    let length = source.length();
    let mut lines = Lines::new(source.from(0));
    let first = text_line(&mut lines)?.unwrap_or_default();
    let layout = Layout::read(&text_line(&mut lines)?.unwrap_or_default())?;
    let keywords = Keywords::read(&mut lines)?;
    let (place, x_unit) = keywords.find("XUNITS").unwrap_or((2, ""));
    let x_metres = metres_of(x_unit).ok_or_else(|| {
        let expected = "a length, such as m or ft";
        unexpected(Place::Line(place), "the unit of x (XUNITS)", x_unit, expected)
    })?;
    let spacing = spacing(Place::Line(2), layout.step * x_metres)?;
    let (place, units) = keywords.find("UNITSNAM").unwrap_or((2, ""));
    let profiles = profiles(units, layout.channels);
    let names = keywords.find("SHORTNAM").map(|(_, names)| names).unwrap_or_default();
    let (profile, metres) = choose(&profiles, chosen).ok_or_else(|| match chosen {
        Some(number) => unexpected(
            Place::Line(place),
            "the channel asked for",
            number,
            format!("a channel of heights: {}", listed(&profiles, names)),
        ),
        None => unexpected(
            Place::Line(place),
            "the units (UNITSNAM)",
            units,
            "a length, such as mm or in",
        ),
    })?;
    if let Some(samples) = layout.samples {
        // A digit each, and a blank or line end between them.
        let numbers = samples as u64 * layout.channels as u64;
        holds(length, first.len(), 2 * numbers - 1, "the profile")?;
    }
    let mut instrument: Vec<(String, String)> =
        [("TITLE", "title"), ("DATE", "created"), ("INSTRUMT", "model")]
            .into_iter()
            .filter_map(|(key, name)| Some((name.to_owned(), keywords.find(key)?.1.to_owned())))
            .collect();
    if !names.is_empty() {
        instrument.push(("channel".into(), columns_of_eight(names, profile)));
    }
    if profiles.len() > 1 {
        instrument.push((CHANNELS.into(), listed(&profiles, names)));
    }
    Ok(OpenScan {
        format: "ERD".into(),
        detected: format!(
            "the first line is `{}`: road profile as text, channel {} of {} read",
            first.trim(),
            profile + 1,
            layout.channels
        ),
        grid: Grid::Profile { spacing },
        instrument,
        declared: layout.samples.map(|samples| (samples as u64, Place::Line(2))),
        heights: Checked::new(Samples {
            lines,
            layout,
            profile,
            metres,
            read: 0,
            numbers: LastNumber::default(),
        }),
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

/// The next line, `None` at the end.
fn text_line(lines: &mut Lines<impl Read>) -> Result<Option<String>, FileProblem> {
    if !lines.advance().map_err(|error| of_line(error, lines.number() + 1, "a line end"))? {
        return Ok(None);
    }
    let (text, _) = WINDOWS_1252.decode_without_bom_handling(lines.line());
    Ok(Some(text.into_owned()))
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
        /// Fields of the line that are looked at.
        const FIELDS: usize = 6;
        let place = || Place::Line(2);
        let cells: Vec<&str> = line.split(',').map(str::trim).take(FIELDS).collect();
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
}

/// A line of one number per channel for each sample.
struct Samples<R> {
    lines: Lines<R>,
    layout: Layout,
    profile: usize,
    metres: f64,
    read: usize,
    numbers: LastNumber,
}

impl<R: Read> Samples<R> {
    /// The height of a line, `None` for a blank one.
    fn height(&mut self, line: &str) -> Result<Option<f64>, FileProblem> {
        let place = || Place::Line(self.lines.number());
        let words = line.split(|c: char| c == ',' || c.is_whitespace());
        let (mut cells, mut height, mut last) = (0, "", "");
        for word in words.filter(|word| !word.is_empty()) {
            if cells == self.profile {
                height = word;
            }
            (cells, last) = (cells + 1, word);
        }
        if cells == 0 {
            return Ok(None);
        }
        if cells != self.layout.channels {
            return Err(unexpected(place(), "the number of cells", cells, self.layout.channels));
        }
        let value: f64 =
            height.parse().map_err(|_| unexpected(place(), "a height", height, "a number"))?;
        if self.lines.is_ended() || !line.ends_with(last) {
            self.numbers.note(last);
        } else if self.profile + 1 == cells && self.numbers.is_cut(last) {
            let (line, text) = (self.lines.number(), shorten(last));
            return Err(FileProblem::CutNumber { line, text });
        }
        Ok(Some(value * self.metres))
    }
}

impl<R: Read> Heights for Samples<R> {
    fn read(&mut self, part: &mut Vec<f64>) -> Result<(), FileProblem> {
        const POINTS: usize = 1 << 13;
        while part.len() < POINTS {
            let Some(line) = text_line(&mut self.lines)? else {
                return match self.layout.samples {
                    Some(samples) if samples != self.read => {
                        let place = Place::Line(self.lines.number());
                        Err(unexpected(place, "the number of samples", self.read, samples))
                    }
                    _ => Ok(()),
                };
            };
            let Some(height) = self.height(&line)? else { continue };
            self.read += 1;
            if let Some(samples) = self.layout.samples.filter(|samples| self.read > *samples) {
                let (place, found) = (Place::Line(self.lines.number()), self.read);
                let found = format!("{found} or more");
                return Err(unexpected(place, "the number of samples", found, samples));
            }
            part.push(height);
        }
        Ok(())
    }
}

/// Values of the keywords that are read, with the numbers of their lines.
struct Keywords {
    found: Vec<(&'static str, usize, String)>,
}

impl Keywords {
    /// Reads lines of a keyword of eight letters and its value up to the line `END`.
    fn read(lines: &mut Lines<impl Read>) -> Result<Self, FileProblem> {
        const READ: [&str; 6] = ["XUNITS", "UNITSNAM", "TITLE", "DATE", "INSTRUMT", "SHORTNAM"];
        /// Names of 1024 channels.
        const LONGEST: usize = 1 << 14;
        let mut found: Vec<(&'static str, usize, String)> = Vec::new();
        while let Some(line) = text_line(lines)? {
            if line.trim().eq_ignore_ascii_case("END") {
                return Ok(Self { found });
            }
            let (name, value) = line.split_at_checked(8).unwrap_or((&line, ""));
            let keyword = READ.into_iter().find(|key| name.trim().eq_ignore_ascii_case(key));
            let Some(keyword) = keyword else { continue };
            // The first of several counts. A UNITSNAM keeps its blanks: they separate names of
            // eight letters.
            if !found.iter().any(|(known, ..)| *known == keyword) {
                let value = value.trim_end().chars().take(LONGEST).collect();
                found.push((keyword, lines.number(), value));
            }
        }
        Err(unexpected(Place::Line(lines.number()), "the header", "not ended", "a line END"))
    }

    /// Number of the line and value.
    fn find(&self, keyword: &str) -> Option<(usize, &str)> {
        let found = self.found.iter().find(|(known, ..)| *known == keyword);
        found.map(|(_, line, value)| (*line, value.as_str()))
    }
}

/// The name at a place of a list in columns of eight letters.
fn columns_of_eight(names: &str, place: usize) -> String {
    names.chars().skip(8 * place).take(8).collect::<String>().trim().to_owned()
}
