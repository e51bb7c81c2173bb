//! Pictures as SVG text, PNG files and animations drawn from it, and models of shapes and decks for other
//! programs.

pub mod animation;
pub mod crease_pattern;
pub mod deck;
pub mod figure;
pub mod filmstrip;
pub mod font;
pub mod model;
pub mod page;
pub mod painter;
pub mod png;
pub mod projection;
