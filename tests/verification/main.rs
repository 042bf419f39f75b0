//! The contact solver against exact solutions, published numbers and slow oracles.

mod dissipation;
mod finite_deformation;
mod full_contact;
mod lemke;
mod limits;
mod oracle;
mod properties;
mod robustness;
mod scatter;
mod slider;
mod surfaces;
mod thesis_table_5_3;
mod thesis_table_a_7;
mod wanted_area;
mod westergaard;
