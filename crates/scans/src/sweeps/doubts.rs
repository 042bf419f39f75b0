//! What in measured sweeps looks like a mistake of units or columns, in words.

use super::SweepTable;
use asperity_core::rubber::HOTTEST_C;
use asperity_core::rubber::fit::{ModulusKind, Sweep, SweepPoint};
use asperity_core::rubber::payne::StrainSweep;
use std::f64::consts::TAU;

/// Stiffer than any rubber glass, some 3 GPa, by far; in Pa.
const STIFFEST: f64 = 2e10;
/// Softer than the stiffest sweep of any solid rubber; in Pa.
const SOFTEST: f64 = 5e4;
/// By how much a storage modulus may fall over a sweep, relative; it cannot but for scatter.
const FALL: f64 = 0.2;

/// Warnings, each with what to do.
pub fn doubts(table: &SweepTable, kind: ModulusKind) -> Vec<String> {
    let sweeps = &table.sweeps;
    [
        units(sweeps),
        falling(sweeps).or_else(|| lossy(sweeps)),
        kelvin(table),
        radians(table),
        symbol(table, kind),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Warnings of strain sweeps, each with what to do.
pub fn strain_doubts(sweeps: &[StrainSweep]) -> Vec<String> {
    let lossy = |sweep: &&StrainSweep| {
        sweep.points.iter().all(|point| point.loss_modulus > point.storage_modulus)
    };
    let doubt = |sweep: &StrainSweep| {
        let at = sweep.temperature_c.map_or(String::new(), |celsius| format!(" at {celsius} °C"));
        format!(
            "the loss modulus is larger than the storage modulus at every strain{at}, as of no filled rubber above its glass \
             transition: check the columns, are they exchanged?"
        )
    };
    sweeps.iter().filter(lossy).map(doubt).collect()
}

fn points(sweeps: &[Sweep]) -> impl Iterator<Item = &SweepPoint> {
    sweeps.iter().flat_map(|sweep| &sweep.points)
}

fn units(sweeps: &[Sweep]) -> Option<String> {
    let most = points(sweeps).map(|point| point.storage_modulus).fold(0.0, f64::max);
    if most > STIFFEST {
        return Some(format!(
            "the storage modulus reaches {:.3e} MPa and rubber glass has some 3e3 MPa: check the unit, are the \
             moduli in Pa?",
            most / 1e6
        ));
    }
    (most < SOFTEST).then(|| {
        format!(
            "the storage modulus is {:.3e} MPa at most and soft rubber has some 0.1 MPa: check the unit, are the \
             moduli in MPa?",
            most / 1e6
        )
    })
}

/// E' of a passive material never falls with frequency, whatever its spectrum.
fn falling(sweeps: &[Sweep]) -> Option<String> {
    let falls = |sweep: &&Sweep| {
        let mut points = sweep.points.clone();
        points.sort_by(|a, b| a.angular_frequency.total_cmp(&b.angular_frequency));
        let third = points.len() / 3;
        let mean = |points: &[SweepPoint]| {
            points.iter().map(|point| point.storage_modulus).sum::<f64>() / points.len() as f64
        };
        third > 0 && mean(&points[points.len() - third..]) < (1.0 - FALL) * mean(&points[..third])
    };
    let falling: Vec<&Sweep> = sweeps.iter().filter(falls).collect();
    let first = falling.first()?;
    let at = first.temperature_c.map_or(String::new(), |celsius| format!(" at {celsius} °C"));
    Some(format!(
        "the storage modulus falls with frequency{at}{}, which that of a passive material cannot: check the columns, \
         are storage and loss modulus exchanged?",
        if falling.len() > 1 {
            format!(" and in {} more", falling.len() - 1)
        } else {
            String::new()
        }
    ))
}

fn lossy(sweeps: &[Sweep]) -> Option<String> {
    let all = points(sweeps).all(|point| point.loss_modulus > point.storage_modulus);
    all.then(|| {
        "the loss modulus is larger than the storage modulus at every point, as of a melt and of no rubber: check the \
         columns, are they exchanged?"
            .into()
    })
}

fn kelvin(table: &SweepTable) -> Option<String> {
    let temperatures = || table.sweeps.iter().filter_map(|sweep| sweep.temperature_c);
    let lowest = temperatures().fold(f64::INFINITY, f64::min);
    (table.in_celsius && lowest > HOTTEST_C && lowest.is_finite()).then(|| {
        format!(
            "all temperatures are {lowest} °C or more: are they in K? Then say so by the unit, as in temperature_k"
        )
    })
}

/// Ladders of frequencies hold powers of ten. If those in Hz hold none, but 2π times some, they are
/// most likely rad/s.
fn radians(table: &SweepTable) -> Option<String> {
    let decimal = |value: f64| (value.log10() - value.log10().round()).abs() < 1e-4;
    let hertz = |point: &SweepPoint| point.angular_frequency / TAU;
    let mut decades: Vec<i32> = points(&table.sweeps)
        .map(|point| hertz(point) / TAU)
        .filter(|value| decimal(*value))
        .map(|value| value.log10().round() as i32)
        .collect();
    decades.sort_unstable();
    decades.dedup();
    let plain = points(&table.sweeps).any(|point| decimal(hertz(point)));
    let example = TAU * 10_f64.powi(*decades.first()?);
    (table.in_hertz && decades.len() > 2 && !plain).then(|| {
        format!(
            "the frequencies in Hz, such as {example:.6}, are 2π times powers of ten: are they angular frequencies in \
             rad/s? Then say so by the unit, as in angular_frequency_rad_s"
        )
    })
}

fn symbol(table: &SweepTable, kind: ModulusKind) -> Option<String> {
    let (said, modulus, other) = match (table.symbol?, kind) {
        ('G', ModulusKind::Youngs) => ("youngs", "shear moduli G", "shear"),
        ('E', ModulusKind::Shear) => ("shear", "Young's moduli E", "youngs"),
        _ => return None,
    };
    Some(format!(
        "--kind is {said} and the header names {modulus}: a mistake here is a factor of three; if the header is right, \
         give --kind {other}"
    ))
}

#[cfg(test)]
mod tests {
    use super::super::{TableOptions, parse_sweeps};
    use super::*;

    fn of(text: &str) -> Vec<String> {
        doubts(&parse_sweeps(text, &TableOptions::default(), 1.0).unwrap(), ModulusKind::Youngs)
    }

    fn sweep(header: &str, row: impl Fn(f64) -> [f64; 4]) -> String {
        let rows = (0..7).map(|k| row(10_f64.powf(f64::from(k) / 2.0 - 1.0)));
        let rows = rows.map(|[f, s, l, t]| format!("{f},{s},{l},{t}\n"));
        format!("{header}\n{}", rows.collect::<String>())
    }

    const HEADER: &str = "frequency_hz,storage_mpa,loss_mpa,temperature_c";

    #[test]
    fn mistakes_are_doubted_and_right_sweeps_are_not() {
        let storage = |f: f64| 5.0 * f.powf(0.1);
        let right = |f: f64| [f, storage(f), 0.2 * storage(f), 20.0];
        assert_eq!(of(&sweep(HEADER, right)), [""; 0]);
        let cases: [(String, &str); 7] = [
            (sweep(HEADER, |f| [f, 1e6 * storage(f), 1e5, 20.0]), "in Pa?"),
            (sweep(&HEADER.replace("_mpa", "_pa"), right), "in MPa?"),
            (sweep(HEADER, |f| [f, 1e3 / storage(f), storage(f), 20.0]), "exchanged"),
            (sweep(HEADER, |f| [f, 0.2 * storage(f), storage(f), 20.0]), "at every point"),
            (sweep(HEADER, |f| [f, storage(f), 1.0, 293.15]), "in K?"),
            (
                (0..5).fold(HEADER.to_owned(), |text, k| {
                    let f = 10_f64.powi(k - 1) * TAU;
                    format!("{text}\n{f:.6},{},1,20", storage(f))
                }),
                "rad/s?",
            ),
            (sweep("f/Hz,G'/MPa,G''/MPa,T/°C", right), "--kind shear"),
        ];
        for (text, part) in cases {
            let doubts = of(&text);
            assert!(doubts.len() == 1 && doubts[0].contains(part), "{text}{doubts:?}");
        }
    }
}
