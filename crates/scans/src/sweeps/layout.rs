//! Which column holds what: by the names of a header, or as the user describes them.

use super::grid::{Grid, Row};
use super::names::{Named, Quantity, Unit, named, unit};
use super::{Located, TableOptions};
use std::str::FromStr;

/// What a table is to hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    Sweeps,
    Factors,
    Strains,
}

impl Wanted {
    /// The quantities without which there is no table, each with its alternatives.
    fn needed(self) -> Vec<[Quantity; 2]> {
        use Quantity::{
            Frequency, Log10Shift, Loss, LossFactor, ShiftFactor, Storage, Strain, Temperature,
        };
        match self {
            Self::Sweeps => vec![[Frequency, Frequency], [Storage, Storage], [Loss, LossFactor]],
            Self::Factors => vec![[Temperature, Temperature], [Log10Shift, ShiftFactor]],
            Self::Strains => vec![[Strain, Strain], [Storage, Storage], [Loss, LossFactor]],
        }
    }

    /// The quantities that are read where they are there.
    fn optional(self) -> Vec<Quantity> {
        match self {
            Self::Strains => vec![Quantity::Temperature, Quantity::Frequency],
            Self::Sweeps | Self::Factors => vec![Quantity::Temperature],
        }
    }

    /// How a file should look.
    pub fn example(self) -> &'static str {
        match self {
            Self::Sweeps => {
                "give a header such as `frequency_hz,storage_mpa,loss_mpa,temperature_c` (also \
                 angular_frequency_rad_s, _pa, _kpa, _gpa, temperature_k; temperature may be left out), or say with \
                 --columns where they are: `--columns frequency_hz=1,storage_mpa=2,loss_mpa=3`"
            }
            Self::Factors => {
                "give a header such as `temperature_c,log10_shift` (or temperature_k, shift_factor)"
            }
            Self::Strains => {
                "give a header such as `temperature_c,frequency_hz,strain_percent,storage_mpa,loss_mpa` (also \
                 strain_fraction, loss_factor, _pa, _kpa; temperature and frequency may be left out)"
            }
        }
    }
}

/// A column that is read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    pub index: usize,
    pub quantity: Quantity,
    pub unit: Option<Unit>,
    /// The name in the file, or its number.
    pub name: String,
    pub symbol: Option<char>,
}

/// Where a table starts and what its columns are.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    pub columns: Vec<Column>,
    /// Number of the first row after header and units.
    pub first_row: usize,
    /// Cells of the header; 0 without one.
    pub width: usize,
    pub strain: bool,
}

impl Layout {
    pub fn column(&self, quantity: Quantity) -> Option<&Column> {
        self.columns.iter().find(|column| column.quantity == quantity)
    }
}

/// A column as the user describes it: `storage_mpa=3` or `storage_mpa=E' [MPa]`.
#[derive(Debug, Clone, PartialEq)]
pub struct DescribedColumn {
    key: String,
    quantity: Quantity,
    unit: Option<Unit>,
    place: String,
}

impl FromStr for DescribedColumn {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (key, place) = text.split_once('=').ok_or_else(|| {
            format!("`{text}` has no `=`: write for instance storage_mpa=3, with the number or the name of the column")
        })?;
        let (key, place) = (key.trim(), place.trim());
        let known = named(key).filter(|found| !found.quantity.has_unit() || found.unit.is_some());
        let Some(Named { quantity, unit, .. }) = known.filter(|_| !place.is_empty()) else {
            return Err(format!(
                "`{text}` names no quantity with its unit: choose from frequency_hz, angular_frequency_rad_s, \
                 storage_mpa, loss_mpa (or _pa, _kpa, _gpa), loss_factor, temperature_c, temperature_k"
            ));
        };
        Ok(Self { key: key.to_owned(), quantity, unit, place: place.to_owned() })
    }
}

/// The first table at or after a row.
///
/// # Errors
/// A header whose units or columns leave a question, with its line.
pub(super) fn next_layout(
    grid: &Grid,
    from: usize,
    wanted: Wanted,
    options: &TableOptions,
) -> Result<Option<Layout>, Located> {
    if !options.columns.is_empty() {
        return if from == 0 { described(grid, wanted, options).map(Some) } else { Ok(None) };
    }
    let mut rows = (from..grid.rows.len()).filter(|k| is_header(&grid.rows[*k], wanted));
    rows.next().map(|k| by_header(grid, k, wanted)).transpose()
}

fn is_header(row: &Row, wanted: Wanted) -> bool {
    missing(&found(row), wanted).is_none()
}

fn found(row: &Row) -> Vec<(usize, Named)> {
    row.cells.iter().enumerate().filter_map(|(k, cell)| Some((k, named(cell)?))).collect()
}

/// The first quantity that is needed and not there.
fn missing(found: &[(usize, Named)], wanted: Wanted) -> Option<Quantity> {
    let there = |quantity| found.iter().any(|(_, named)| named.quantity == quantity);
    let needed = wanted.needed();
    needed.into_iter().find(|any| !any.iter().any(|q| there(*q))).map(|any| any[0])
}

/// What is wrong with a file that has no header: the row that comes nearest to one.
pub(super) fn no_header(grids: &[Grid], wanted: Wanted) -> Located {
    let rows = grids.iter().flat_map(|grid| grid.rows.iter());
    let nearest = rows
        .map(|row| (found(row), row))
        .filter(|(found, _)| !found.is_empty())
        .max_by_key(|(found, row)| (found.len(), std::cmp::Reverse(row.line)));
    let example = wanted.example();
    match nearest.and_then(|(found, row)| Some((missing(&found, wanted)?, row.line))) {
        Some((quantity, line)) => {
            (Some(line), format!("there is no column of the {}: {example}", quantity.what()))
        }
        None => {
            let first = grids.first().and_then(|grid| grid.rows.first()).map(|row| row.line);
            (first, format!("there is no header that names the columns: {example}"))
        }
    }
}

fn by_header(grid: &Grid, header: usize, wanted: Wanted) -> Result<Layout, Located> {
    let row = &grid.rows[header];
    let found = found(row);
    let below = grid.rows.get(header + 1).map(|units| below(row, units, grid.blanks));
    let units = below.as_ref().filter(|units| are_units(units, &found));
    let first_row = header + 1 + usize::from(units.is_some());
    let mut columns: Vec<(u8, Column)> = Vec::new();
    for (index, named) in &found {
        let below = units.and_then(|units| units.cells.get(*index)).map(String::as_str);
        let below = below.filter(|text| !text.trim_matches(['[', ']', '-']).is_empty());
        let unit_below = below.and_then(|text| unit(text, named.quantity));
        let name = row.cells[*index].clone();
        if let (Some(above), Some(below)) = (named.unit, unit_below)
            && above != below
        {
            let problem = format!(
                "the column `{name}` is in {} and the row below says {}: correct one of them",
                above.name(),
                below.name()
            );
            return Err((Some(row.line), problem));
        }
        let unit = named.unit.or(unit_below);
        if named.rank > 0 && unit.is_none() && named.quantity == Quantity::Temperature {
            continue;
        }
        let column =
            Column { index: *index, quantity: named.quantity, unit, name, symbol: named.symbol };
        columns.push((named.rank, column));
    }
    let columns = chosen(columns, wanted).map_err(|problem| (Some(row.line), problem))?;
    for column in columns.iter().filter(|column| column.quantity.has_unit()) {
        if column.unit.is_none() {
            let problem = format!(
                "the column `{}` has no unit that is known: units are never guessed; {}",
                column.name,
                wanted.example()
            );
            return Err((Some(row.line), problem));
        }
    }
    let strain = found.iter().any(|(_, named)| named.quantity == Quantity::Strain);
    // Names at runs of blanks fall into several cells.
    let width = if grid.blanks { 0 } else { row.cells.len() };
    Ok(Layout { columns, first_row, width, strain })
}

/// The row below a header, at runs of blanks with its last cells below the last names: a number of
/// the point, which comes first, has no unit.
fn below(header: &Row, units: &Row, blanks: bool) -> Row {
    let absent = header.cells.len().saturating_sub(units.cells.len());
    let padding = if blanks { absent } else { 0 };
    let cells = vec![String::new(); padding].into_iter().chain(units.cells.iter().cloned());
    Row { cells: cells.collect(), ..*units }
}

/// Whether a row after a header states units: at least one, and no number in a column.
fn are_units(row: &Row, found: &[(usize, Named)]) -> bool {
    let cell = |index: usize| row.cells.get(index).map_or("", String::as_str);
    let number = |text: &str| text.replace(',', ".").parse::<f64>().is_ok();
    let some = found.iter().any(|(index, named)| unit(cell(*index), named.quantity).is_some());
    some && !found.iter().any(|(index, _)| number(cell(*index)))
}

/// One column for each quantity, those that are needed and the temperature.
fn chosen(columns: Vec<(u8, Column)>, wanted: Wanted) -> Result<Vec<Column>, String> {
    let mut quantities: Vec<Quantity> = Vec::new();
    for any in wanted.needed() {
        let there = |quantity: &&Quantity| columns.iter().any(|(_, c)| c.quantity == **quantity);
        quantities.extend(any.iter().find(there));
    }
    for quantity in wanted.optional() {
        if !quantities.contains(&quantity) {
            quantities.push(quantity);
        }
    }
    let mut chosen = Vec::new();
    for quantity in quantities {
        let of_it = || columns.iter().filter(|(_, column)| column.quantity == quantity);
        let Some(rank) = of_it().map(|(rank, _)| *rank).min() else { continue };
        let best: Vec<&Column> =
            of_it().filter(|(r, _)| *r == rank).map(|(_, column)| column).collect();
        if best.len() > 1 {
            let names: Vec<String> =
                best.iter().map(|column| format!("`{}`", column.name)).collect();
            return Err(format!(
                "there are {} columns of the {} ({}): leave one, or choose with --columns",
                best.len(),
                quantity.what(),
                names.join(", ")
            ));
        }
        chosen.extend(best.into_iter().cloned());
    }
    Ok(chosen)
}

/// Refuses a column that is described as two quantities.
fn each_has_its_own(columns: &[DescribedColumn]) -> Result<(), Located> {
    for (i, column) in columns.iter().enumerate() {
        let place = column.place.trim();
        if let Some(first) = columns[..i].iter().find(|other| other.place.trim() == place) {
            return Err((
                None,
                format!(
                    "--columns gives {} and {} one column, {place}: each has its own",
                    first.key, column.key
                ),
            ));
        }
    }
    Ok(())
}

/// The table that the user describes.
fn described(grid: &Grid, wanted: Wanted, options: &TableOptions) -> Result<Layout, Located> {
    let columns = &options.columns;
    let of = |quantity| columns.iter().filter(move |column| column.quantity == quantity).count();
    for any in wanted.needed() {
        if any.iter().all(|quantity| of(*quantity) == 0) {
            let what = any[0].what();
            return Err((None, format!("--columns does not say where the {what} is: add it")));
        }
    }
    if let Some(twice) = columns.iter().find(|column| of(column.quantity) > 1) {
        let what = twice.quantity.what();
        return Err((None, format!("--columns names the {what} more than once: keep one of them")));
    }
    each_has_its_own(columns)?;
    let is_name = |column: &&DescribedColumn| column.place.parse::<usize>().is_err();
    let names: Vec<&str> =
        columns.iter().filter(is_name).map(|column| column.place.as_str()).collect();
    let position =
        |row: &Row, name: &str| row.cells.iter().position(|cell| bare(cell) == bare(name));
    let header =
        grid.rows.iter().position(|row| names.iter().all(|name| position(row, name).is_some()));
    let header = match (names.first(), header) {
        (None, _) => None,
        (Some(_), Some(header)) => Some(header),
        (Some(name), None) => {
            return Err((
                None,
                format!(
                    "no line has the column names of --columns, such as `{name}`: check them, or give the numbers of the columns"
                ),
            ));
        }
    };
    let index = |column: &DescribedColumn| match (column.place.parse::<usize>(), header) {
        (Ok(0), _) => {
            Err((None, format!("--columns {}=0: the first column is number 1", column.key)))
        }
        (Ok(number), _) => Ok(number - 1),
        (Err(_), Some(header)) => Ok(position(&grid.rows[header], &column.place).unwrap_or(0)),
        (Err(_), None) => Ok(0),
    };
    let column = |described: &DescribedColumn| {
        Ok(Column {
            index: index(described)?,
            quantity: described.quantity,
            unit: described.unit,
            name: described.key.clone(),
            symbol: None,
        })
    };
    let columns: Vec<Column> = columns.iter().map(column).collect::<Result<_, Located>>()?;
    let numeric = |row: &Row| {
        let number = |column: &Column| {
            let cell = row.cells.get(column.index).map_or("", String::as_str);
            cell.replace(',', ".").parse::<f64>().is_ok()
        };
        !row.comment && columns.iter().all(number)
    };
    let from = header.map_or(0, |header| header + 1);
    let first_row = (from..grid.rows.len()).find(|k| numeric(&grid.rows[*k]));
    let Some(first_row) = first_row else {
        let places: Vec<String> =
            columns.iter().map(|column| format!("{}", column.index + 1)).collect();
        return Err((
            None,
            format!(
                "no line has numbers in the columns {} that --columns names: check the numbers of the columns \
                 and --separator",
                places.join(", ")
            ),
        ));
    };
    Ok(Layout { columns, first_row, width: 0, strain: false })
}

fn bare(name: &str) -> String {
    name.trim().trim_start_matches('#').trim().to_lowercase()
}
