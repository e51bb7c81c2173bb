//! The program end to end: commands, files, messages, exit codes.

#![allow(clippy::disallowed_methods, reason = "tests read and damage files directly")]

mod accuracy;
mod bench;
mod chart;
mod checkpoints;
mod command_options;
mod compare_and_answer;
mod contact_scenes;
mod determinism;
mod doctor_and_rerun;
mod edge_of_physics;
mod fault_injection;
mod film_study;
mod fold;
mod frames;
mod index;
mod instruction_sets;
mod interruption;
mod invalid_studies;
mod keys;
mod memory;
mod mistakes;
mod monitor_and_blind_contact;
mod monitor_detects_faults;
mod old_results;
mod pareto;
mod physics_version;
mod plan;
mod rank_and_borders;
mod remedies;
mod replicate_tables;
mod results_folder;
mod run_and_table;
mod scene_files;
mod search;
mod solve;
mod stability;
mod status_why_show;
mod streams;
mod study_files;
mod support;
mod torture_short;
mod units;
mod validate;
mod verdict;
