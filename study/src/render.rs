//! Pictures, as SVG text.

pub mod crease_pattern;
