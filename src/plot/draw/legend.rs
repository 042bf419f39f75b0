//! The names of the series below the axes, in columns, where they cannot hide anything.

use super::super::panel::{Panel, Series};
use super::{Area, Drawn, FINE, FONT, LABEL, WIDTH, marks};
use plotters::prelude::*;

const LINE: u32 = 22 * FINE;
const MARGIN: u32 = 76 * FINE;
/// Width of the sample of a line or band.
const SAMPLE: u32 = 30 * FINE;
/// Width of a letter: plotters asks no font.
const LETTER: f64 = 7.6 * FINE as f64;
const MOST_COLUMNS: usize = 4;

pub(super) struct Legend<'a> {
    entries: Vec<(&'a str, &'a Series)>,
    columns: usize,
}

impl<'a> Legend<'a> {
    pub(super) fn of(panel: &'a Panel) -> Self {
        let named = panel.series.iter().filter_map(|s| Some((s.label.as_deref()?, s)));
        let entries: Vec<_> = named.collect();
        let longest = entries.iter().map(|entry| entry.0.chars().count()).max().unwrap_or(0);
        let width = f64::from(SAMPLE + 26 * FINE) + LETTER * longest as f64;
        let room = f64::from(WIDTH - MARGIN);
        let columns = ((room / width) as usize).clamp(1, MOST_COLUMNS).min(entries.len().max(1));
        Self { entries, columns }
    }

    pub(super) fn height(&self) -> u32 {
        LINE * self.entries.len().div_ceil(self.columns) as u32
    }

    pub(super) fn draw(&self, area: &Area) -> Drawn {
        let width = (WIDTH - MARGIN) / self.columns as u32;
        for (number, (label, series)) in self.entries.iter().enumerate() {
            let x = (MARGIN + width * (number % self.columns) as u32) as i32;
            let y = (LINE * (number / self.columns) as u32 + 8 * FINE) as i32;
            marks::sample(area, series, (x, y), SAMPLE as i32)?;
            let style = TextStyle::from((FONT, LABEL).into_font());
            let place = (x + (SAMPLE + 8 * FINE) as i32, y - 6 * FINE as i32);
            area.draw(&Text::new((*label).to_owned(), place, style))?;
        }
        Ok(())
    }
}
