//! Pictures, as SVG text, and PNG from it.

pub mod crease_pattern;
pub mod figure;
pub mod font;
pub mod page;
pub mod png;
