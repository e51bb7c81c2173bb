//! The binary end to end.

mod determinism;
mod folding;
mod resume;
mod running;
mod storage;
mod support;
