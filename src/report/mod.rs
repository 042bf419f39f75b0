//! Friction tables, figures and the report of a run, for people.

mod figure;
pub mod figures;
pub mod html;
mod read;
mod rubber_figure;
mod sinusoid;
mod sinusoid_figure;
mod spreadsheet;
mod tables;

pub use figure::friction_figure;
pub use read::ReportError;
pub use rubber_figure::rubber_figure;
pub use sinusoid::Study;
pub use sinusoid_figure::study_figure;
pub use spreadsheet::workbook;
pub use tables::{
    About, FrictionTable, comparison_markdown, friction_tables, latex, long_table, markdown,
};
