//! The binary end to end.

mod broken_studies;
mod planning;
mod study_files;
