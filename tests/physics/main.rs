//! Physics against numbers: analytic cases, properties, conservation.

#![allow(
    clippy::disallowed_methods,
    clippy::float_cmp,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "judges by tolerances, not by bits; counts are small"
)]

mod allocation;
mod capsule;
mod conservation;
mod contact_bits;
mod explicit_bits;
mod explicit_cases;
mod exports;
mod film_capsule;
mod film_rig;
mod fold_numbers;
mod fold_properties;
mod gas_cases;
mod geometry;
mod membrane_cases;
mod piston_cases;
mod quiescence;
mod rig;
mod rigid_planes;
mod shells;
mod statics;
