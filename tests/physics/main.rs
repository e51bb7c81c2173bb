//! Physics against numbers: analytic cases, properties, conservation.

#![allow(
    clippy::disallowed_methods,
    clippy::float_cmp,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "judges by tolerances, not by bits; counts are small"
)]

mod exports;
mod fold_numbers;
mod fold_properties;
mod geometry;
