//! The binary end to end.

mod broken_studies;
mod determinism;
mod folding;
mod planning;
mod resume;
mod running;
mod storage;
mod study_files;
mod support;
