//! The binary end to end.

mod determinism;
mod resume;
mod running;
mod storage;
mod support;
