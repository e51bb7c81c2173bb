//! The keys of a study file and of a scene file: tables with one row a key, from which reading,
//! errors, defaults, `billow keys --schema`, `billow keys`, docs/reference/keys.md and the names of an
//! expression follow.

mod key;
pub mod listing;
pub mod numerical;
mod objects;
mod quantity;
mod row;
mod scene;
mod study;
mod study_objects;
mod table;
mod words;

pub use crate::platform::nearest::nearest;
pub use key::{Default, Key, KeyKind, Refusal};
pub use objects::{
    BODY_KEYS, MESH_KEYS, MOVE_KEYS, OUTPUT_KEYS, PLATE_KEYS, ROTATION_KEYS, SCENE_WINDOW_KEYS,
    SPIN_KEYS, START_KEYS, SUPPORT_KEYS,
};
pub(crate) use objects::{GRAVITY, NEAR};
pub use quantity::Quantity;
pub use row::{named, position};
pub use study::{KEYS, SECTIONS};
pub use study_objects::{
    CAPSULE_SUPPORT_KEYS, OPTIMISE_KEYS, RANGE_KEYS, SEARCH_KEYS, STRATEGY_KEYS, WINDOW_KEYS,
};
pub use table::{SCENE, STUDY, Table, find, index, short_name, shortened};
pub(crate) use words::{
    CAPS, CHIRALITIES, FITS, FORMULAS, INTEGRATORS, ISOTHERMAL, MODEL_KINDS, Named, PROFILES,
    RESIDUAL_GAS, SHAPES, SPECIES, SUPPORT_PLACES, pick,
};
pub use words::{
    MODELS, Model, ResidualGas, Word, default_integrator, ignored_by_integrator, model,
};

#[cfg(test)]
mod tests;
