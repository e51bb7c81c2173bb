//! Tests of the solver: closed forms, conservation, equal bits, properties.

#![allow(
    clippy::disallowed_methods,
    clippy::float_cmp,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "results are compared within tolerances, not by bits; counts are small"
)]

mod allocation;
mod bits;
mod checkpoints;
mod closures;
mod conservation;
#[path = "../memory/counting.rs"]
#[expect(dead_code, reason = "the bytes in use are for the tests of the memory of a job")]
mod counting;
mod equal_meshes;
mod every_model;
mod explicit_cases;
mod exports;
mod faults;
mod film_capsule;
mod film_rig;
mod fold_numbers;
mod fold_properties;
mod gas_cases;
mod geometry;
mod implicit;
mod membrane_cases;
mod piston_capsule;
mod piston_cases;
mod prelude;
mod quiescence;
mod rig;
mod rigid_planes;
mod spring;
mod statics;
mod system;
