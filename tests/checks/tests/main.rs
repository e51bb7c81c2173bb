//! The checks themselves: their rows, files and messages, and the faults that they detect.

#![allow(clippy::disallowed_methods, reason = "tests read and damage files directly")]

mod commands;
mod fault_injection;
mod physics_version;
mod stability;
mod support;
mod validate;
