//! The repository itself: its folders, its words, what its shipped studies are.

#![allow(clippy::disallowed_methods, reason = "reads the files of the repository")]

mod job_ids;
mod layers;
mod sources;
mod words;
