//! Convergence with the mesh: the limit of each measure, and the table of mesh errors.

mod calibrate;
pub mod command;
mod fit;
pub mod held_back;
mod lots;
mod regression;
mod runs;

#[cfg(test)]
mod tests;
