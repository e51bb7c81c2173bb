//! Shapes without physics: the fold pattern and its states, meshes and their topology, shells,
//! fields of nodes, and the texts they are read from and written to.

pub mod field;
pub mod fold;
pub mod mesh;
pub mod mesh_io;
pub mod refinement;
pub mod shapes;
pub mod shell;
pub mod topology;
