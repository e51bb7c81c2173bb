//! Pictures, as SVG text, and PNG from it.

pub mod crease_pattern;
pub mod font;
pub mod png;
