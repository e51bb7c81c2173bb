//! Parameter studies of inflatable capsules. One JSON study file becomes jobs; every job gives one
//! history file and one table row.
//!
//! ```text
//! study file → Study → generation of Jobs → Scene → Deployment → history file + row → table
//!                ↑______ next_jobs(study, finished rows) ______|
//! ```
//!
//! **Reading order.** [`input::syntax`] (the JSON), [`study`] (its meaning), [`study::plan`] (the
//! jobs), [`run::runner`] (running them), [`store::history_file`] and [`store::table`] (what is stored).
//!
//! **Folders.** Each uses only those below it:
//!
//! | folder | holds |
//! |---|---|
//! | [`cli`] | the command line |
//! | [`mod@print`] | rows, answers and notes as people read them |
//! | [`chart`] | charts of stored results |
//! | [`render`] | pictures: SVG and PNG |
//! | [`analysis`] | comparisons, statistics, the answer of a study |
//! | [`cluster`] | gives the jobs of a study to a cluster |
//! | [`run`] | runs jobs in parallel |
//! | [`store`] | what a study stores on disk |
//! | [`study`] | a study: axes, points, jobs |
//! | [`scene`] | one scene without a study: its file, its run, its summary |
//! | [`surrogate`] | Gaussian process regression: what a measure is between the points that ran |
//! | [`accuracy`] | what is known about the error of a result |
//! | [`job`] | one job: its id, its row |
//! | [`input`] | keys, units, expressions, the JSON of a file |
//! | [`platform`] | files, signals, errors |

/// Prints a line on stderr, as the standard macro of this name does, which ends the program when stderr
/// is closed or full. This one loses the line instead.
macro_rules! eprintln {
    ($($part:tt)*) => {
        $crate::platform::output::message(format_args!($($part)*))
    };
}

pub mod accuracy;
pub mod analysis;
pub mod chart;
pub mod cli;
pub mod cluster;
pub mod input;
pub mod job;
pub mod platform;
pub mod print;
pub mod render;
pub mod report;
pub mod run;
pub mod scene;
pub mod store;
pub mod study;
pub mod surrogate;
