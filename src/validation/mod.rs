//! Measured friction beside what is computed for it, with and without constants that are fitted.
//!
//! A set is a recipe with a section `[validation]`: its road, its rubber, and friction that was measured of both. Every
//! model, kind of surfaces and effect of its run makes a prediction of hysteretic friction and contact area, Persson's theory on
//! a measured spectrum another. What is missing to the measurement is a shear stress of the contact area, whose constants are
//! not in scans and moduli. So each prediction is judged several times:
//!
//! | case | shear stress |
//! |---|---|
//! | `hysteresis` | none; no constant is fitted |
//! | `given` | the law of the section `[adhesion]`; no constant is fitted |
//! | `own` | fitted to the set itself |
//! | `joint` | one law fitted to all sets together |
//! | `other` | fitted to all other sets: a prediction |
//!
//! | module | what it holds |
//! |---|---|
//! | `set` | a set and its predictions |
//! | `judge` | the cases, their misfits and their bands |
//! | `text` | the comparison as text |
//! | `figure` | the comparison as a figure |

mod figure;
mod judge;
mod set;
mod text;

pub use judge::{BandParts, Case, Constant, FittedLaw, Judged, JudgedPoint, Validated, judge};
pub use set::{Label, Prediction, Set, ValidationError};
