//! The header of an OpenCRG file.

use super::super::error::{FileProblem, Place, unexpected};
use super::super::metres_of;

/// Characters of a line that count.
const LONGEST_LINE: usize = 72;
/// More channels than any road has; each takes 4 bytes of a row or more.
const MOST_CHANNELS: usize = 1 << 16;
/// Largest distance of a long section from equal spacing, in spacings.
const LARGEST_DEVIATION: f64 = 1e-3;

/// How the numbers are written.
pub(super) enum Layout {
    Text { width: usize },
    Binary { bytes: usize },
}

pub(super) struct Channel {
    line: usize,
    name: String,
    unit: String,
}

/// The channels that are lines along the road.
pub(super) struct Sections {
    /// Their places among the channels.
    pub(super) places: Vec<usize>,
    /// Metres of the unit of their heights.
    pub(super) metres: f64,
    /// Positions across the road in m, where the names of the channels have them.
    across: Option<Vec<f64>>,
}

pub(super) struct Header {
    /// Such as `LRFI`.
    pub(super) code: String,
    pub(super) layout: Layout,
    pub(super) channels: Vec<Channel>,
    /// Keys of the section of the road with their lines.
    parameters: Vec<(usize, String, String)>,
    /// Step of a reference line that is given by its start and step.
    virtual_step: Option<f64>,
    comment: String,
}

impl Header {
    /// The header, the bytes after it and the number of their first line.
    pub(super) fn read(bytes: &[u8]) -> Result<(Self, &[u8], usize), FileProblem> {
        let mut parser = Parser::default();
        let mut rest = bytes;
        let mut number = 0;
        loop {
            number += 1;
            let end = rest.iter().position(|byte| *byte == b'\n').ok_or_else(|| {
                unexpected(
                    Place::Line(number),
                    "the header",
                    "not ended",
                    "a line that begins with $$",
                )
            })?;
            let line = String::from_utf8_lossy(&rest[..end.min(LONGEST_LINE)]);
            rest = &rest[end + 1..];
            if line.starts_with("$$") {
                return Ok((parser.finish(number)?, rest, number + 1));
            }
            parser.line(number, line.trim_end())?;
        }
    }

    /// # Errors
    /// A file without such channels, or with units that are not lengths.
    pub(super) fn sections(&self) -> Result<Sections, FileProblem> {
        let is_section =
            |channel: &Channel| channel.name.to_lowercase().starts_with("long section");
        let places: Vec<usize> =
            (0..self.channels.len()).filter(|&place| is_section(&self.channels[place])).collect();
        let Some(first) = places.first().map(|&place| &self.channels[place]) else {
            let expected = "channels named `long section`: the heights of the road";
            return Err(unexpected(Place::Line(1), "$KD_Definition", "another", expected));
        };
        let of_unit = |unit: &str| {
            let place = Place::Line(first.line);
            metres_of(unit).ok_or_else(|| {
                unexpected(place, "the unit of a long section", unit, "a length such as m")
            })
        };
        let metres = of_unit(&first.unit)?;
        let other =
            places.iter().map(|&place| &self.channels[place]).find(|c| c.unit != first.unit);
        if let Some(other) = other {
            let place = Place::Line(other.line);
            return Err(unexpected(place, "the unit of a long section", &other.unit, &first.unit));
        }
        let across =
            places.iter().map(|&place| position_across(&self.channels[place].name)).collect();
        Ok(Sections { places, metres, across })
    }

    fn parameter(&self, key: &str) -> Result<Option<f64>, FileProblem> {
        let mut all = self.parameters.iter().filter(|(_, name, _)| name == key);
        let Some((line, _, value)) = all.next() else {
            return Ok(None);
        };
        if let Some((line, _, other)) = all.find(|(_, _, other)| other != value) {
            let both = format!("{key} = {other} beside {value}");
            let what = "a second value of a parameter of $ROAD_CRG";
            return Err(unexpected(Place::Line(*line), what, both, "one value"));
        }
        let number = value.parse().ok().filter(|number: &f64| number.is_finite());
        let wrong =
            || unexpected(Place::Line(*line), "a parameter of $ROAD_CRG", value, "a number");
        number.map(Some).ok_or_else(wrong)
    }

    /// Distance of the rows along the road in m.
    pub(super) fn step_along(&self, rows: usize) -> Result<f64, FileProblem> {
        if let Some(step) = self.parameter("REFERENCE_LINE_INCREMENT")?.or(self.virtual_step) {
            return Ok(step);
        }
        let ends = (
            self.parameter("REFERENCE_LINE_START_U")?.unwrap_or(0.0),
            self.parameter("REFERENCE_LINE_END_U")?,
        );
        match ends {
            (start, Some(end)) if rows > 1 => Ok((end - start) / (rows - 1) as f64),
            _ => {
                let expected = "REFERENCE_LINE_INCREMENT in $ROAD_CRG";
                Err(unexpected(Place::Line(1), "the step along the road", "not there", expected))
            }
        }
    }

    /// Distance of the long sections across the road in m.
    pub(super) fn step_across(&self, sections: &Sections) -> Result<f64, FileProblem> {
        if let Some(step) = self.parameter("LONG_SECTION_V_INCREMENT")? {
            return Ok(step);
        }
        let last = sections.places.len() - 1;
        if let Some(across) = &sections.across {
            let step = (across[last] - across[0]) / last as f64;
            let off = |(i, v): (usize, &f64)| {
                (v - across[0] - i as f64 * step).abs() > LARGEST_DEVIATION * step.abs()
            };
            if across.iter().enumerate().any(off) {
                return Err(FileProblem::Unsupported {
                    place: Place::Line(self.channels[sections.places[0]].line),
                    what: "a grid of long sections at unequal distances".into(),
                    advice: "export it with equal ones (crg_wgt_cut or the interpolation of the software)",
                });
            }
            return Ok(step.abs());
        }
        match (self.parameter("LONG_SECTION_V_RIGHT")?, self.parameter("LONG_SECTION_V_LEFT")?) {
            (Some(right), Some(left)) => Ok((left - right) / last as f64),
            _ => {
                let expected = "LONG_SECTION_V_INCREMENT in $ROAD_CRG";
                Err(unexpected(Place::Line(1), "the step across the road", "not there", expected))
            }
        }
    }

    pub(super) fn description(&self) -> Vec<(String, String)> {
        let comment = ("comment".to_owned(), self.comment.clone());
        [comment].into_iter().filter(|(_, text)| !text.is_empty()).collect()
    }
}

/// The position in a name such as `long section at v = -1.500`.
fn position_across(name: &str) -> Option<f64> {
    let (_, position) = name.split_once('=')?;
    position.trim().parse().ok().filter(|position: &f64| position.is_finite())
}

#[derive(Default)]
struct Parser {
    section: String,
    code: Option<(usize, String)>,
    channels: Vec<Channel>,
    parameters: Vec<(usize, String, String)>,
    virtual_step: Option<f64>,
    comment: String,
}

impl Parser {
    fn line(&mut self, number: usize, line: &str) -> Result<(), FileProblem> {
        if let Some(section) = line.strip_prefix('$') {
            let name = section.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next();
            self.section = name.unwrap_or_default().to_uppercase();
            if self.section == "ROAD_CRG_FILE" {
                return Err(FileProblem::Unsupported {
                    place: Place::Line(number),
                    what: "a grid in other files ($ROAD_CRG_FILE)".into(),
                    advice: "give the file that holds the grid",
                });
            }
            return Ok(());
        }
        if line.starts_with(['*', '!']) {
            return Ok(());
        }
        match self.section.as_str() {
            "CT" if self.comment.is_empty() => line.trim().clone_into(&mut self.comment),
            "ROAD_CRG" => {
                let (key, value) = uncommented(line).split_once('=').unwrap_or((line, ""));
                if self.parameters.len() < MOST_CHANNELS && !key.trim().is_empty() {
                    let (key, value) = (key.trim().to_uppercase(), value.trim().to_owned());
                    self.parameters.push((number, key, value));
                }
            }
            "KD_DEFINITION" => self.definition(number, uncommented(line))?,
            _ => {}
        }
        Ok(())
    }

    fn definition(&mut self, number: usize, line: &str) -> Result<(), FileProblem> {
        if let Some(code) = line.strip_prefix("#:") {
            self.code = Some((number, code.trim().to_uppercase()));
        } else if let Some(channel) = line.strip_prefix("D:") {
            let (name, unit) = channel.rsplit_once(',').unwrap_or((channel, ""));
            if self.channels.len() == MOST_CHANNELS {
                let (place, limit) = (Place::Line(number), MOST_CHANNELS as u64);
                let what = "the number of channels";
                return Err(FileProblem::TooLarge { place, what, size: limit + 1, limit });
            }
            let (name, unit) = (name.trim().to_owned(), unit.trim().to_owned());
            self.channels.push(Channel { line: number, name, unit });
        } else if let Some(line) = line.strip_prefix("U:reference line u,") {
            // Unit, start and step of a channel that is not stored.
            self.virtual_step = line.rsplit(',').next().and_then(|step| step.trim().parse().ok());
        }
        Ok(())
    }

    fn finish(self, line: usize) -> Result<Header, FileProblem> {
        let (place, code) = match self.code {
            Some((line, code)) => (Place::Line(line), code),
            None => (Place::Line(line), "not there".into()),
        };
        let layout = match code.as_str() {
            "LRFI" => Layout::Text { width: 10 },
            "LDFI" => Layout::Text { width: 20 },
            "KRBI" => Layout::Binary { bytes: 4 },
            "KDBI" => Layout::Binary { bytes: 8 },
            _ => {
                let expected = "#:LRFI, #:LDFI (text), #:KRBI or #:KDBI (binary)";
                return Err(unexpected(place, "the format of the numbers", code, expected));
            }
        };
        let Self { channels, parameters, virtual_step, comment, .. } = self;
        Ok(Header { code, layout, channels, parameters, virtual_step, comment })
    }
}

/// A line without the comment at its end.
fn uncommented(line: &str) -> &str {
    line.split_once('!').map_or(line, |(text, _)| text).trim_end()
}
