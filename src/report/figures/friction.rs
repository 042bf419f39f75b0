//! Friction over contact area.

use super::{full_heading, grouped, heading};
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Points, Series};
use crate::report::About;
use crate::report::ReportError;
use crate::report::read::rows;
use crate::report::tables::significant;
use crate::stages::bem::Given;
use crate::stages::realise::SurfaceKind;
use crate::stages::tables::{COMPARISON, ComparisonRow, FRICTION, FrictionRow, Model};

const AREA: &str = "contact area fraction Ac/A0";
const PRESSURE: &str = "mean pressure p / MPa";
/// Distance between series at one area or pressure, as a share of it.
const BESIDE: f64 = 0.04;
pub(super) const FRICTION_LABEL: &str = "friction coefficient µ";

/// Friction of a run, see [`friction_figure`].
pub(super) fn friction(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let rows = rows(run, FRICTION)?;
    let about = About::of(run)?;
    Ok(rows.map(|rows| friction_figure(&rows, &about)))
}

/// Averaged friction over contact area, or over pressure where that is given: a panel for each kind of surfaces and speed,
/// in which the models are compared; rows of one model alone are one panel, in which the speeds are compared.
pub fn friction_figure(rows: &[FrictionRow], about: &About) -> Figure {
    let tables = grouped(rows, |row| (row.given, row.kind, super::speed_key(row.speed_mm_s)));
    let tables: Vec<Vec<&FrictionRow>> = tables.into_values().collect();
    let one_model = rows.iter().all(|row| row.model == rows[0].model);
    let panel = |title: String, given: Given, series: Vec<Series>| Panel {
        title,
        x: axis(given, rows.iter().filter(|row| row.given == given).map(abscissa)),
        y: Axis::from_zero(FRICTION_LABEL),
        series,
    };
    let panels = if one_model && tables.len() > 1 {
        let of_one = one_model_panels(&tables).into_iter().map(|(speed, tables)| {
            let own = speed.map_or(String::new(), |speed| format!("{speed} mm/s, "));
            let title = format!("Model {}, {own}{}", rows[0].model, about.material());
            panel(title, tables[0][0].given, of_one_model(&tables, speed))
        });
        of_one.collect()
    } else {
        let compared = tables.iter().map(|table| {
            let models = table.chunk_by(|a, b| a.model == b.model).flat_map(|model| {
                let (colour, dashed) = look(model[0].model);
                curve(model, model[0].model.name(), colour, dashed)
            });
            panel(full_heading(table[0], about), table[0].given, models.collect())
        });
        compared.collect()
    };
    let areal = rows.iter().any(|row| row.kind.method.is_areal());
    let sliding = about.sliding().filter(|_| areal);
    Figure {
        caption: format!(
            "Friction coefficient over contact area fraction or mean pressure, averaged over the realisations; bands are \
             95 % confidence intervals of the mean, pale points single realisations. Lines that would all be at one area \
             or pressure stand beside each other there.{}",
            sliding.map_or(String::new(), |text| format!(" {text}"))
        ),
        panels,
    }
}

/// The tables of one panel, whose title may name their speed.
fn of_one_model(tables: &[Rows], speed: Option<f64>) -> Vec<Series> {
    let place = only_place(&tables.concat());
    let of_table = tables.iter().enumerate().flat_map(|(number, table)| {
        let shortest = significant(table[0].shortest_wavelength_mm);
        let own = match speed {
            Some(_) => String::new(),
            None => format!(", {} mm/s", table[0].speed_mm_s),
        };
        let name = format!("{} from {shortest} mm{own}", table[0].kind);
        let series = curve(table, &name, Colour::Nth(number), false);
        beside(series, (number, tables.len()), place)
    });
    of_table.collect()
}

/// Rows of one kind of surfaces at one speed.
type Rows<'a> = Vec<&'a FrictionRow>;

/// The tables of each panel where there is one model: of all speeds, or where these are more than there are colours, of the
/// speed that is named.
fn one_model_panels<'a>(tables: &[Rows<'a>]) -> Vec<(Option<f64>, Vec<Rows<'a>>)> {
    let of_given = tables.chunk_by(|a, b| a[0].given == b[0].given);
    if of_given.clone().all(|tables| tables.len() <= Colour::COUNT) {
        return of_given.map(|tables| (None, tables.to_vec())).collect();
    }
    let key = |table: &Rows| (table[0].given, super::speed_key(table[0].speed_mm_s));
    let mut sorted = tables.to_vec();
    sorted.sort_by_key(key);
    let of_speed = sorted.chunk_by(|a, b| key(a) == key(b));
    of_speed.map(|tables| (Some(tables[0][0].speed_mm_s), tables.to_vec())).collect()
}

/// The axis of what friction is given for.
pub(super) fn axis(given: Given, values: impl Iterator<Item = f64>) -> Axis {
    let label = match given {
        Given::Area => AREA,
        Given::Pressure => PRESSURE,
    };
    let (least, most) = values
        .fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    // Pressures of testers and tyres are decades apart now and then; areas are drawn as in the thesis.
    if given == Given::Pressure && most > 10.0 * least {
        Axis::logarithmic(label)
    } else {
        Axis::from_zero(label)
    }
}

/// What friction is given for.
pub(super) fn abscissa(row: &FrictionRow) -> f64 {
    abscissa_of(row.given, row.contact_area_fraction, row.pressure_mpa)
}

/// Contact area fraction or pressure in MPa.
pub(super) fn abscissa_of(given: Given, area: f64, pressure_mpa: f64) -> f64 {
    match given {
        Given::Area => area,
        Given::Pressure => pressure_mpa,
    }
}

/// Average, band and realisations of one table.
pub(super) fn curve(
    rows: &[&FrictionRow],
    name: &str,
    colour: Colour,
    dashed: bool,
) -> Vec<Series> {
    let count = rows[0].realisations.len();
    let average = rows.iter().map(|row| (abscissa(row), row.mean)).collect();
    let band: Vec<_> = rows
        .iter()
        .filter_map(|row| {
            let half = row.confidence_95?;
            Some((abscissa(row), (row.mean - half).max(0.0), row.mean + half))
        })
        .collect();
    let mut series = vec![];
    // A line of one point is not seen.
    let single = rows.len() == 1;
    if !band.is_empty() {
        let mark = if single { Mark::ErrorBars(band) } else { Mark::Band(band) };
        series.push(Series::unnamed(colour, mark));
    }
    let label = match (rows[0].half_space_realisations, count) {
        (Some(half_space), pairs) => {
            format!("{name}, {half_space} of the half-space and {pairs} pairs, 95 %")
        }
        (None, 0 | 1) => format!("{name}, 1 surface"),
        (None, count) => format!("{name}, mean of {count}, 95 %"),
    };
    let mark = match (single, dashed) {
        (true, _) => Mark::FilledCircles(average),
        (false, true) => Mark::Dashed(average),
        (false, false) => Mark::Line(average),
    };
    series.push(Series::new(label, colour, mark));
    if count > 1 {
        let points = rows
            .iter()
            .flat_map(|row| row.realisations.iter().map(|friction| (abscissa(row), *friction)));
        series.push(Series::unnamed(colour, Mark::Dots(points.collect())));
    }
    series
}

/// The area or pressure of all rows, if it is one.
pub(super) fn only_place(rows: &[&FrictionRow]) -> Option<f64> {
    let first = abscissa(rows.first()?);
    rows.iter().all(|row| abscissa(row) == first).then_some(first)
}

/// Series number so and so of so many, moved sideways where all are at one place and would hide each other.
pub(super) fn beside(
    series: Vec<Series>,
    (number, count): (usize, usize),
    place: Option<f64>,
) -> Vec<Series> {
    let Some(place) = place else { return series };
    let by = BESIDE * place * (number as f64 - 0.5 * (count as f64 - 1.0));
    let points =
        |points: Points| -> Points { points.into_iter().map(|(x, y)| (x + by, y)).collect() };
    let moved = |mark: Mark| match mark {
        Mark::FilledCircles(of) => Mark::FilledCircles(points(of)),
        Mark::Dots(of) => Mark::Dots(points(of)),
        Mark::ErrorBars(bars) => {
            Mark::ErrorBars(bars.into_iter().map(|(x, low, high)| (x + by, low, high)).collect())
        }
        other => other,
    };
    series.into_iter().map(|series| Series { mark: moved(series.mark), ..series }).collect()
}

/// Colour of a model and whether its line is dashed, the same in all figures that compare models.
fn look(model: Model) -> (Colour, bool) {
    let (number, dashed) = match model {
        Model::Bem => (0, false),
        Model::Hybrid => (1, true),
        Model::Fem => (2, false),
        Model::Multilevel => (4, false),
        Model::Persson => (3, true),
        Model::KlueppelHeinrich => (5, true),
    };
    (Colour::Nth(number), dashed)
}

/// Published friction as circles beside the computed line and its band.
pub(super) fn comparison(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let Some(all) = rows(run, COMPARISON)? else {
        return Ok(None);
    };
    let tables = all.chunk_by(|a, b| a.published_table == b.published_table);
    let panels = tables.map(|rows| {
        let line = |value: fn(&ComparisonRow) -> f64| -> Vec<_> {
            rows.iter().map(|row| (row.contact_area_fraction, value(row))).collect()
        };
        let band = rows.iter().filter_map(|row| {
            let half = row.confidence_95?;
            Some((row.contact_area_fraction, (row.computed - half).max(0.0), row.computed + half))
        });
        Panel {
            title: format!(
                "{}: {}",
                rows[0].published_table,
                heading(SurfaceKind::sines(rows[0].waves), rows[0].speed_mm_s)
            ),
            x: Axis::from_zero(AREA),
            y: Axis::from_zero(FRICTION_LABEL),
            series: vec![
                Series::new("95 % interval", Colour::Nth(0), Mark::Band(band.collect())),
                Series::new("computed mean", Colour::Nth(0), Mark::Line(line(|row| row.computed))),
                Series::new(
                    "published mean",
                    Colour::Black,
                    Mark::OpenCircles(line(|row| row.published)),
                ),
            ],
        }
    });
    Ok(Some(Figure {
        caption: "Computed friction with the 95 % confidence interval of its mean beside the \
                  published averages that the recipe names."
            .into(),
        panels: panels.collect(),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn about() -> About {
        About {
            rubber: "x".into(),
            temperature_c: None,
            tolerance: None,
            angle_deg: None,
            thickness_mm: None,
        }
    }

    fn row(model: Model, speed_mm_s: f64) -> FrictionRow {
        FrictionRow {
            model,
            kind: SurfaceKind::sines(8),
            speed_mm_s,
            given: Given::Area,
            contact_area_fraction: 0.05,
            shortest_wavelength_mm: 0.06,
            windows: 9,
            realisations: vec![],
            half_space_realisations: None,
            mean: 0.6,
            standard_deviation: None,
            confidence_95: None,
            scan_error: None,
            interpolation_error: 0.0,
            discretisation_error: None,
            left_out_error: 0.0,
            microscale_error: None,
            model_error: None,
            error_estimate: None,
            pressure_mpa: 0.3,
            shortest_reliable_wavelength_mm: None,
        }
    }

    #[test]
    fn models_are_compared_at_each_speed_and_speeds_of_one_model_in_one_panel() {
        let titles = |rows: &[FrictionRow]| -> Vec<String> {
            friction_figure(rows, &about()).panels.into_iter().map(|panel| panel.title).collect()
        };
        let one = [row(Model::Bem, 10.0), row(Model::Bem, 50.0)];
        assert_eq!(titles(&one), ["Model bem, rubber x"]);
        assert_eq!(titles(&one[..1]), ["8 waves from 0.06000 mm, 10 mm/s, rubber x"]);
        let two = [one.as_slice(), &[row(Model::Hybrid, 10.0), row(Model::Hybrid, 50.0)]].concat();
        assert_eq!(
            titles(&two),
            [
                "8 waves from 0.06000 mm, 10 mm/s, rubber x",
                "8 waves from 0.06000 mm, 50 mm/s, rubber x"
            ]
        );
        assert!(titles(&[]).is_empty());
        // Not more lines in a panel than colours.
        let many: Vec<FrictionRow> = [8, 9, 10, 11]
            .into_iter()
            .flat_map(|waves| {
                [10.0, 50.0].map(|speed| FrictionRow {
                    kind: SurfaceKind::sines(waves),
                    ..row(Model::Bem, speed)
                })
            })
            .collect();
        assert_eq!(titles(&many[..6]), ["Model bem, rubber x"]);
        assert_eq!(titles(&many), ["Model bem, 10 mm/s, rubber x", "Model bem, 50 mm/s, rubber x"]);
    }
}
