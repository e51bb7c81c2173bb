//! Physics against numbers: analytic cases, properties, conservation.

#![allow(
    clippy::disallowed_methods,
    clippy::float_cmp,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "judges by tolerances, not by bits; counts are small"
)]

mod capsule;
mod conservation;
mod exports;
mod fold_numbers;
mod fold_properties;
mod gas_cases;
mod geometry;
mod piston_cases;
mod rig;
