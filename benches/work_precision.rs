//! Error against seconds of every solver: the cases of `asperity bench`, as one table.
//!
//! `cargo bench --bench work_precision`, or with names of cases after `--`. Without `--bench`, as
//! in `cargo test --benches`, only a few points are run.

use asperity::bench::measure::Effort;
use asperity::bench::{BenchError, report, select};

fn main() -> Result<(), BenchError> {
    let (flags, names): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument.starts_with("--"));
    let measured = flags.iter().any(|flag| flag == "--bench");
    let effort = if measured { Effort::Full } else { Effort::Quick };
    let cases = select(&names)?.into_iter().map(|case| case.run(effort, &|_| ()));
    println!("{}", report::markdown(&cases.collect::<Result<Vec<_>, BenchError>>()?));
    Ok(())
}
