//! Friction and contact area of the study of one sine wave.

use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};
use crate::report::{ReportError, Study};
use crate::stages;
use crate::stages::sinusoid::{Limit, Model, PointRow};

/// Share of the largest Deborah number at which the lines of the Hertz limits start.
const LIMIT_FROM: f64 = 0.1;

/// The figure of a run of a study.
pub(super) fn study(run: &RunView) -> Result<Option<Figure>, ReportError> {
    if run.stage_manifest(stages::sinusoid::STAGE.name())?.is_none() {
        return Ok(None);
    }
    Ok(Some(study_figure(&Study::read(run)?)))
}

/// Friction and contact area over the Deborah number: a colour for each root mean square slope, a line
/// for the neo-Hookean model, dashes for the half-space, circles for linear rheology; dotted on the right
/// the areas of Hertz' limit of fast sliding.
pub fn study_figure(study: &Study) -> Figure {
    let deborah = || Axis::logarithmic("Deborah number v/v*");
    let mut area = curves(study, |point| point.contact_area_fraction);
    area.extend(hertz_limits(study));
    let mut area = with_legend(study, area);
    area.push(Series::new("Hertz limit, fast", Colour::Black, Mark::Dotted(vec![])));
    Figure {
        caption:
            "Friction and contact area of one sine over the Deborah number for several root mean \
                  square slopes under three models; a line is interrupted where a contact has no \
                  solution. Dotted: the area of Hertz' limit of fast sliding."
                .into(),
        panels: vec![
            Panel {
                title: "Friction".into(),
                x: deborah(),
                y: Axis::from_zero("friction coefficient µ"),
                series: with_legend(study, curves(study, |point| point.friction_coefficient)),
            },
            Panel {
                title: "Contact area".into(),
                x: deborah(),
                y: Axis::logarithmic("contact area fraction Ac/A0"),
                series: area,
            },
        ],
    }
}

/// The points of each slope, with its colour.
fn slopes(study: &Study) -> impl Iterator<Item = (Colour, &[PointRow])> {
    let slopes = study.points.chunk_by(|a, b| a.aspect_ratio == b.aspect_ratio);
    slopes.enumerate().map(|(number, points)| (Colour::Nth(number), points))
}

/// All curves; where a point has no solution a line is interrupted.
fn curves(study: &Study, value: fn(&PointRow) -> Option<f64>) -> Vec<Series> {
    let curve = |colour, points: &[PointRow]| {
        let places = points.iter().map(|p| (p.deborah_number, value(p).unwrap_or(f64::NAN)));
        Series::unnamed(colour, mark(points[0].model, places.collect()))
    };
    slopes(study)
        .flat_map(|(colour, points)| {
            points.chunk_by(|a, b| a.model == b.model).map(move |points| curve(colour, points))
        })
        .collect()
}

fn mark(model: Model, points: Vec<(f64, f64)>) -> Mark {
    match model {
        Model::NeoHookean => Mark::Line(points),
        Model::HalfSpace => Mark::Dashed(points),
        Model::Linear => Mark::OpenCircles(points),
    }
}

fn hertz_limits(study: &Study) -> impl Iterator<Item = Series> {
    let fastest = study.points.iter().map(|point| point.deborah_number).fold(0.0, f64::max);
    let fast = study.asymptotes.iter().filter(|row| row.limit == Limit::Fast).enumerate();
    fast.map(move |(number, row)| {
        let line = [LIMIT_FROM * fastest, fastest].map(|x| (x, row.hertz_area_fraction));
        Series::unnamed(Colour::Nth(number), Mark::Dotted(line.to_vec()))
    })
}

/// The curves and what the legend says of them: entries without values of their own.
fn with_legend(study: &Study, curves: Vec<Series>) -> Vec<Series> {
    let models = [
        ("neo-Hooke", Mark::Line(vec![])),
        ("half-space", Mark::Dashed(vec![])),
        ("linear rheology", Mark::OpenCircles(vec![])),
    ];
    let models = models.map(|(name, mark)| Series::new(name, Colour::Black, mark));
    let slopes = slopes(study).map(|(colour, points)| {
        Series::new(format!("rms slope {:.2}", points[0].rms_slope), colour, Mark::Line(vec![]))
    });
    curves.into_iter().chain(models).chain(slopes).collect()
}
