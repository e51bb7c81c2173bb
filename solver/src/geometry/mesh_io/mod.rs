//! Shapes and patterns as text other programs read. Strings in memory: no files here.

pub mod fold;
pub mod obj;
pub mod obj_reader;
