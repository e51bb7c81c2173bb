//! Forces and energies of film and gas: material, material loss, membrane, pressure, gas, supports.

pub mod closure;
pub mod energy_term;
pub mod film_model;
pub mod forces;
pub mod gas;
pub mod material;
pub mod material_loss;
pub mod resultants;
pub mod supports;
pub(crate) mod tensor;
