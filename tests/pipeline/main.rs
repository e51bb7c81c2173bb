//! The binary end to end.

mod broken_studies;
mod folding;
mod planning;
mod study_files;
