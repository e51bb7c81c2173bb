//! Shapes without physics: the fold pattern and its states, meshes, shells, vector fields over nodes,
//! and the text formats they are read from and written to.

pub mod field;
pub mod fold;
pub mod mesh;
pub mod mesh_io;
pub mod shell;
