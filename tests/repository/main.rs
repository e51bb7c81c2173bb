//! The repository itself: its folders, its words, what its shipped studies are.

#![allow(clippy::disallowed_methods, reason = "reads the repository's own files")]

mod job_ids;
mod layers;
mod sources;
mod words;
