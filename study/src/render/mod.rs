//! Pictures as SVG text, and PNG files drawn from it.

pub mod crease_pattern;
pub mod figure;
pub mod filmstrip;
pub mod font;
pub mod page;
pub mod painter;
pub mod png;
pub mod projection;
