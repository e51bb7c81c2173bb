//! The binary end to end.

#![allow(clippy::disallowed_methods, reason = "looks at the disk with its own eyes")]

mod bench;
mod broken_studies;
mod charts;
mod comparing;
mod contact;
mod contact_audit;
mod determinism;
mod film_study;
mod folding;
mod frames;
mod instruction_sets;
mod keeping;
mod mutations;
mod old_results;
mod physics_version;
mod planning;
mod reading;
mod reference;
mod reference_columns;
mod reference_commands;
mod resume;
mod running;
mod scene_files;
mod solving;
mod storage;
mod study_files;
mod support;
mod validating;
