//! Friction tables and figures for people.

mod figure;
mod tables;

pub use figure::{FigureError, friction_figure};
pub use tables::{
    FrictionTable, comparison_markdown, data_frame, friction_tables, latex, markdown,
};
