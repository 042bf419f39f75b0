//! Friction tables, figures and the report of a run, for people.

pub mod figures;
pub mod html;
mod read;
mod sinusoid;
mod spreadsheet;
mod tables;

pub use figures::{friction_figure, rubber_fit_figure, study_figure};
pub use read::ReportError;
pub use sinusoid::Study;
pub use spreadsheet::workbook;
pub use tables::{
    About, FrictionTable, comparison_markdown, friction_tables, latex, long_table, markdown,
};
