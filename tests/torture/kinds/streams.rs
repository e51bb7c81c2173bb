//! stdin, stdout and stderr that are closed, full, or read by a program that ends.

use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::harness::check::{self, Truth};
use crate::harness::place::Place;
use crate::harness::program::{self, BILLOW};
use crate::harness::random::Random;
use crate::harness::studies;
use crate::harness::trial::{Fault, Kind, Trial};

/// Time after which a command counts as hanging.
const LIMIT: Duration = Duration::from_secs(10);

/// Redirections of the shell, and whether a command that prints cannot print all.
const STREAMS: [(&str, bool); 12] = [
    (">&-", false),
    ("2>&-", false),
    (">&- 2>&-", false),
    ("<&-", false),
    ("<&- >&- 2>&-", false),
    (">/dev/full", true),
    ("2>/dev/full", false),
    (">/dev/full 2>&1", true),
    (">/dev/full 2>&-", true),
    ("| true", false),
    ("2>&1 | true", false),
    ("2>&1 >/dev/null | head -c 1", false),
];

/// Commands, and their exit code.
const COMMANDS: [(&str, i32); 12] = [
    ("run s.json --threads 2", 0),
    ("run s.json --threads 2 --verbose", 0),
    ("run s.json --results fresh --json", 0),
    ("run results/s --again done", 0),
    ("plan s.json", 0),
    ("table results/s", 0),
    ("table results/s --columns wrong", 2),
    ("status results/s", 0),
    ("compare results/s --by N --base 5", 0),
    ("chart results/s --history z_rim", 0),
    ("doctor results/s", 0),
    ("solve absent.json", 2),
];

/// The kind.
pub struct Streams {
    template: Place,
    truth: Truth,
}

/// Runs the study once.
pub fn prepare(place: &Place) -> Result<Streams, String> {
    place.write_study(&studies::small());
    let truth = Truth::of_run(place)?;
    Ok(Streams { template: place.clone(), truth })
}

impl Kind for Streams {
    fn trials(&self) -> usize {
        STREAMS.len() * COMMANDS.len()
    }

    fn limit(&self) -> Duration {
        LIMIT
    }

    fn trial(&self, number: usize, _: &mut Random, place: &Place) -> Trial {
        let (streams, full) = STREAMS[number % STREAMS.len()];
        let (arguments, code) = COMMANDS[number / STREAMS.len()];
        let mut trial = Trial::new(format!("billow {arguments} {streams}"));
        place.copy_from(&self.template);
        // The exit code of the program goes to a file: that of a pipe is its reader's.
        let script = format!("{{ \"$0\" {arguments}; echo $? >code; }} {streams}");
        let mut command = Command::new("sh");
        command.args(["-c", &script, BILLOW]).current_dir(place.path());
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let finish = program::start_as_is(place, command).finish(LIMIT);
        trial.time(finish.wall);
        if finish.hung {
            trial.fault(Fault::Slow, "no end");
        }
        let found = fs::read_to_string(place.join("code")).unwrap_or_default();
        let found = found.trim().parse().unwrap_or(-1);
        // A message that cannot be written changes no exit code; an incomplete answer is an error.
        let expected = if full && code == 0 { 2 } else { code };
        if found == 101 || found > 128 {
            trial.fault(Fault::Abort, format!("exit code {found}"));
        } else if found != expected {
            trial.fault(Fault::WrongMessage, format!("exit code {found}, expected {expected}"));
        }
        let last = studies::run(place);
        last.check_refusal(&mut trial, "run", &[0]);
        check::compare(&mut trial, place, &self.truth);
        trial
    }
}
