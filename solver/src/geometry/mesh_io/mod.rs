//! Meshes and patterns as text, for other programs. Text in memory: this module opens no files.

pub mod fold;
pub mod obj;
pub mod obj_reader;
