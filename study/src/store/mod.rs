//! What a study stores on disk: journal, history files, checkpoints, summary table;
//! the cube, which is all of them in one file; and the check of a results folder.

pub mod attempts;
pub mod checkpoint_file;
pub mod cube;
pub mod damaged;
pub mod doctor;
pub mod finished;
pub mod history_file;
pub mod journal;
pub mod results;
pub mod stored;
pub mod table;
