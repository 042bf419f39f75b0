//! The table of growth.

use super::{Row, Series};
use crate::bench::report::significant;
use std::fmt::Write;

/// One table: every job, and after each series its exponents.
pub fn markdown(series: &[Series]) -> String {
    let mut text = String::from(
        "| over | size | seconds | memory, MB | grid points | solve, s | operator applications | pair of FFTs, s | solve over FFTs |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for series in series {
        let _ = writeln!(text, "| **{}** ({}) | | | | | | | | |", series.over, series.fixed);
        series.rows.iter().for_each(|row| text += &job(series, row));
        let memory = series.memory_exponent.map_or_else(not_measured, |a| format!("{a:.2}"));
        let time = series.time_exponent;
        let _ = writeln!(text, "| {} | exponent | {time:.2} | {memory} | | | | | |", series.over);
    }
    text
}

fn job(series: &Series, row: &Row) -> String {
    let Row { size, sample } = row;
    let memory =
        sample.memory_bytes.map_or_else(not_measured, |bytes| significant(bytes as f64 / 1e6));
    let solve = match &sample.solve {
        None => "| | | |".into(),
        Some(solve) => format!(
            "{} | {} | {:.1} | {} | {:.1}",
            solve.points,
            significant(solve.seconds),
            solve.operator_applications,
            significant(solve.transform_pair_seconds),
            solve.seconds / solve.floor_seconds()
        ),
    };
    let seconds = significant(sample.seconds);
    format!("| {} | {size} | {seconds} | {memory} | {solve} |\n", series.over)
}

fn not_measured() -> String {
    "not measured".into()
}
