//! The program end to end: commands, files, messages, exit codes.

#![allow(clippy::disallowed_methods, reason = "tests read and damage files directly")]

mod accuracy;
mod chart;
mod checkpoints;
mod compare_and_answer;
mod contact_scenes;
mod doctor_and_rerun;
mod film_study;
mod fold;
mod frames;
mod inflow;
mod keys;
mod mangled_studies;
mod memory;
mod mesh_study;
mod monitor_and_blind_contact;
#[path = "../torture/mutate.rs"]
mod mutate;
mod optimise;
mod plan;
#[path = "../torture/random.rs"]
#[expect(dead_code, reason = "the other numbers are for `make torture`")]
mod random;
mod rank_and_borders;
mod refused;
mod replicate_tables;
mod report;
mod results_folder;
mod run_and_table;
mod samples;
mod scene_files;
mod search;
mod several_runs;
mod solve;
mod status_and_job;
mod streams;
mod study_files;
mod support;
mod torture_short;
mod units;
mod verdict;
mod work_precision;
