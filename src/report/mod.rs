//! Friction tables, figures and the report of a run, for people.
//!
//! | module | what it holds |
//! |---|---|
//! | `about` | what all tables and figures of a run have in common |
//! | `compare` | which of two runs has more friction |
//! | `figures` | the figures of a run, each made of its results alone |
//! | `html` | the report of a run: one HTML document that needs nothing else |
//! | `long_tables` | friction tables for other programs: all digits, every realisation |
//! | `read` | what figures and reports read of a run |
//! | `sinusoid` | the study of one sine wave as Markdown |
//! | `spreadsheet` | friction tables as a workbook |
//! | `tables` | friction tables in the layout of the published ones: contact area in the first column, one column per realisation, their average |

mod about;
mod compare;
pub mod figures;
pub mod html;
mod long_tables;
mod read;
mod sinusoid;
mod spreadsheet;
mod tables;

pub use about::About;
pub use compare::{Compared, Difference, Pairing, compare};
pub use figures::{friction_figure, rubber_fit_figure, study_figure};
pub use long_tables::{long_table, values_table};
pub use read::ReportError;
pub use sinusoid::Study;
pub use spreadsheet::workbook;
pub(crate) use tables::significant;
pub use tables::{FrictionTable, comparison_markdown, friction_tables, latex, markdown};
