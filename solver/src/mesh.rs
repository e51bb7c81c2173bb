//! Nodes and triangles of a fold pattern.
