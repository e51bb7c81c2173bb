//! What the checks share beside the printer of billow: options, and entries chosen by name.

use billow_study::cli::options::{OutputOptions, QuietOption};
use billow_study::platform::error::{Error, Result};
use billow_study::platform::nearest::did_you_mean;
use billow_study::platform::output;
use billow_study::print::Format;

/// The options of every command.
#[derive(Debug, clap::Args)]
pub struct Options {
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

impl Options {
    /// The format of the output.
    pub fn format(&self) -> Format {
        self.output.format()
    }

    /// Says something on stderr, unless that is not wanted.
    pub fn note(&self, text: &str) {
        if !self.quiet.quiet {
            output::message(format_args!("billow-checks: {text}"));
        }
    }
}

/// The entries of a table that an option names, in the order of the table; all without names.
pub fn chosen<'a, T>(
    option: &str,
    names: &[String],
    table: &'a [T],
    name_of: fn(&T) -> &str,
) -> Result<Vec<&'a T>> {
    let known = || table.iter().map(name_of);
    for name in names {
        if !known().any(|known| known == name) {
            let near = did_you_mean(name, known()).unwrap_or_default();
            let allowed = known().collect::<Vec<_>>().join(", ");
            return Err(Error::invalid_option(option, name, "unknown name", allowed, near));
        }
    }
    let named = |entry: &&T| names.is_empty() || names.iter().any(|name| name == name_of(entry));
    Ok(table.iter().filter(named).collect())
}
