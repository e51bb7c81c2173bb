//! The binary end to end.

mod folding;
