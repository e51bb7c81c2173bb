//! The repository itself: its folders, its words, its shipped studies, its generated pages.

#![allow(clippy::disallowed_methods, reason = "reads the files of the repository")]

mod commands_page;
mod job_ids;
mod layers;
mod reference;
mod sources;
mod words;
