//! What an instrument got wrong on a map: single points, and rows or columns that jump as a whole.
//!
//! | module | what it holds |
//! |---|---|
//! | `spikes` | points and small clusters far from their neighbourhood |
//! | `lines` | rows and columns at another level than their neighbours |
//! | `texture` | the shortest waves of a map, along rows and columns |

mod lines;
mod spikes;
mod texture;

pub use lines::{LONGEST_RUN, find_jumped_columns, find_jumped_rows};
pub use spikes::remove_spikes;
pub use texture::{map_quantisation, map_texture};
