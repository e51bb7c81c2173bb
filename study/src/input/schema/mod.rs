//! The JSON Schemas (2020-12) of the study file and the scene file, built from the tables of keys.
//!
//! A schema says what each key may hold. The program itself checks which values are allowed together
//! (a fit and what it needs, a key given or varied).

mod parts;
mod scene;
mod study;

pub use scene::scene_schema;
pub use study::study_schema;
