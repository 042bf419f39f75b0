//! Friction tables and figures for people.

pub(crate) mod figure;
mod sinusoid;
mod sinusoid_figure;
mod tables;

pub use figure::{FigureError, friction_figure};
pub use sinusoid::Study;
pub use sinusoid_figure::study_figure;
pub use tables::{
    FrictionTable, comparison_markdown, data_frame, friction_tables, latex, markdown,
};
