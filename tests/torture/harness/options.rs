//! The options of the command.

use std::path::PathBuf;

use crate::kinds;

/// What to try.
#[derive(Debug, Clone)]
pub struct Options {
    /// Kinds of trial, by name; empty for all.
    pub only: Vec<String>,
    /// Share of the trials of each kind.
    pub share: f64,
    /// One trial alone, by its number.
    pub number: Option<usize>,
    /// Seed of all random choices.
    pub seed: u64,
    /// Number of trials at the same time.
    pub threads: usize,
    /// Folder of the trials.
    pub folder: PathBuf,
    /// Keep the folders of good trials, too.
    pub keep: bool,
}

impl Options {
    /// Reads the arguments; `None` for a request of help.
    pub fn from_arguments(
        mut arguments: impl Iterator<Item = String>,
    ) -> Result<Option<Self>, String> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let mut options = Self {
            only: Vec::new(),
            share: 1.0,
            number: None,
            seed: 1,
            threads: cores,
            folder: PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("torture"),
            keep: false,
        };
        while let Some(option) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{option}: no value"));
            match option.as_str() {
                "--help" | "-h" => return Ok(None),
                "--keep" => options.keep = true,
                "--only" => options.only = kinds_of(&value()?)?,
                "--trials" => options.share = share_of(&value()?)?,
                "--number" => options.number = Some(whole(&option, &value()?)?),
                "--seed" => options.seed = whole(&option, &value()?)?,
                "--threads" => options.threads = whole(&option, &value()?)?,
                "--folder" => options.folder = PathBuf::from(value()?),
                other => return Err(format!("unknown option {other:?}")),
            }
        }
        if options.number.is_some() && options.only.len() != 1 {
            return Err("--number needs --only with one kind".to_owned());
        }
        if options.threads == 0 {
            return Err("--threads 0: at least 1 is needed".to_owned());
        }
        Ok(Some(options))
    }

    /// Text of the help.
    pub fn help(names: &[&str]) -> String {
        format!(
            "Torture billow: kills, signals, full disks, changed files, little memory, mutated input.\n\n\
             --only KIND,…    only these kinds: {}\n\
             --trials SHARE   share of the trials of each kind, above 0 up to 1 [default: 1]\n\
             --number N       only this trial of one kind\n\
             --seed N         seed of all random choices [default: 1]\n\
             --threads N      number of trials at the same time [default: number of cores]\n\
             --folder DIR     folder of the trials [default: torture in the target folder]\n\
             --keep           keep the folders of good trials, too",
            names.join(", ")
        )
    }
}

fn kinds_of(text: &str) -> Result<Vec<String>, String> {
    let names: Vec<String> = text.split(',').map(|name| name.trim().to_owned()).collect();
    match names.iter().find(|name| !kinds::NAMES.contains(&name.as_str())) {
        Some(name) => Err(format!("--only {name:?}: allowed are {}", kinds::NAMES.join(", "))),
        None => Ok(names),
    }
}

fn share_of(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(share) if share > 0.0 && share <= 1.0 => Ok(share),
        _ => Err(format!("--trials {text:?}: a number above 0 and up to 1 is needed")),
    }
}

fn whole<T: std::str::FromStr>(option: &str, text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{option} {text:?}: a whole number is needed"))
}
