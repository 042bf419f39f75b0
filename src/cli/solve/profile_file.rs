//! A periodic profile in a text file of two columns.

use asperity::files::{Located, cells, read_located};
use asperity::units::Units;
use std::path::Path;

use super::shape::Shape;
use crate::cli::values;
use asperity::scans::description::LengthUnit;

/// Largest deviation of a position from equal spacing, in spacings: positions printed with few
/// digits pass, a missing or a doubled point does not.
const SPACING_TOLERANCE: f64 = 0.05;

/// Reads one period of a profile.
///
/// # Errors
/// A message with the file and the line.
pub(super) fn read_profile(path: &Path, unit: LengthUnit) -> Result<Shape, String> {
    read_located(path, |text| parse_profile(text, unit))
}

/// One line of the file.
struct Point {
    line: usize,
    x: f64,
    z: f64,
}

fn parse_profile(text: &str, unit: LengthUnit) -> Result<Shape, Located> {
    let mut points = Vec::new();
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let data = line.split('#').next().unwrap_or_default();
        if !data.trim().is_empty() {
            let (x, z) = parse_point(data).map_err(|problem| (Some(index + 1), problem))?;
            points.push(Point { line: index + 1, x, z });
        }
    }
    let spacing = equal_spacing(&points)?;
    let heights: Vec<f64> = points.iter().map(|point| unit.metres(point.z)).collect();
    let repeats = heights.first() == heights.last();
    let repeats = repeats.then(|| {
        "the last height of the profile equals the first; if this is the end of the period, \
         delete it: the period ends one spacing after the last point"
            .into()
    });
    Ok(Shape {
        period: unit.metres(spacing * points.len() as f64),
        warning: repeats.or_else(|| cliff(&heights)),
        heights,
        waves: Vec::new(),
    })
}

fn parse_point(data: &str) -> Result<(f64, f64), String> {
    let cells = cells(data);
    let [x, z] = cells[..] else {
        return Err(format!(
            "{} columns instead of the 2 columns x and z with decimal points",
            cells.len()
        ));
    };
    let number = |name: &str, cell: &str| match values::finite(cell) {
        Ok(value) => Ok(value),
        Err(problem) => Err(format!(
            "{name}: {problem}; start lines of text with #, fill or cut missing points first"
        )),
    };
    Ok((number("x", x)?, number("z", z)?))
}

/// Steps of a profile from its last point to its first one, over the largest inside, from which on it is one that
/// does not close.
const CLIFF: f64 = 3.0;

/// A warning for a profile that ends where it does not begin.
fn cliff(heights: &[f64]) -> Option<String> {
    let (first, last) = (heights.first()?, heights.last()?);
    let inside = heights.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    let closing = (first - last).abs();
    (closing > CLIFF * inside).then(|| {
        format!(
            "the profile ends {:.6} mm from the height that it begins with, {:.0} times its largest step: as a period it has \
             a cliff there; take the slope off, or cut it where it closes",
            closing.m_to_mm(),
            closing / inside
        )
    })
}

/// The distance of neighbouring points, in the unit of the file.
fn equal_spacing(points: &[Point]) -> Result<f64, Located> {
    let [first, .., last] = points else {
        return Err((None, format!("has {} points, a profile needs 8 or more", points.len())));
    };
    let spacing = (last.x - first.x) / (points.len() - 1) as f64;
    if let Some(pair) = points.windows(2).find(|pair| pair[1].x <= pair[0].x) {
        let problem = format!("x = {} does not grow from {}", pair[1].x, pair[0].x);
        return Err((Some(pair[1].line), problem));
    }
    for (index, point) in points.iter().enumerate() {
        let expected = first.x + index as f64 * spacing;
        if (point.x - expected).abs() > SPACING_TOLERANCE * spacing {
            let problem = format!(
                "x = {} where equal spacing of {spacing} has {expected}: resample the profile, or \
                 look for a missing point",
                point.x
            );
            return Err((Some(point.line), problem));
        }
    }
    Ok(spacing)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Shape, Located> {
        parse_profile(text, LengthUnit::Um)
    }

    #[test]
    fn any_usual_separator_is_read() {
        for separator in [" ", "\t", ",", ";", " , ", ";\t", "   "] {
            let text = format!(
                "\u{feff}# x z\r\n-1{separator}2\r\n\r\n 0{separator}-2.5e0 # valley\r\n1{separator}+3\r\n"
            );
            let shape = parse(&text).unwrap();
            assert_eq!(shape.heights, [2.0 / 1e6, -2.5 / 1e6, 3.0 / 1e6], "{separator:?}");
            assert_eq!(shape.period, 3.0 / 1e6);
            assert_eq!(shape.warning, None);
        }
    }

    #[test]
    fn mistakes_are_named_by_line() {
        let cases = [
            ("", None, "has 0 points"),
            ("0 1", None, "has 1 points"),
            ("x,z\n0,1\n1,2", Some(1), "x: `x` is not a number; start lines of text with #"),
            ("0,1\n1,\n2,2", Some(2), "z: `` is not a number"),
            ("0 1\n1 NaN\n2 2", Some(2), "`NaN` is not a finite number"),
            ("0,5;1,5", Some(1), "4 columns instead of the 2 columns x and z"),
            ("0\n1\n", Some(1), "1 columns"),
            ("0 1\n0 2\n1 3", Some(2), "x = 0 does not grow from 0"),
            ("2 1\n1 2\n0 3", Some(2), "x = 1 does not grow from 2"),
            ("0 1\n1 2\n#\n3 3\n4 1", Some(2), "equal spacing"),
        ];
        for (text, line, part) in cases {
            let (found, message) = parse(text).unwrap_err();
            assert_eq!(found, line, "{text:?}: {message}");
            assert!(message.contains(part), "{text:?}: {message}");
        }
    }

    #[test]
    fn rounded_positions_are_equidistant_and_a_repeated_end_is_pointed_out() {
        let spacing = 16.0 / 4096.0;
        let height = |i: usize| if i == 4095 { 0.0 } else { i as f64 };
        let text: String =
            (0..4096).map(|i| format!("{:.4} {}\n", i as f64 * spacing, height(i))).collect();
        let shape = parse(&text).unwrap();
        assert!((shape.period - 16e-6).abs() < 1e-4 * 16e-6);
        assert!(shape.warning.unwrap().contains("delete it"));
    }
}
