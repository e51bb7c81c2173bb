//! Pictures: the outcome of each cell of a map, all maps beside each other, and the shapes of a failing run.

mod look;
mod map;
mod overview;
mod strip;
mod words;

pub use map::map;
pub use overview::overview;
pub use strip::strip;
pub use words::border_text;
