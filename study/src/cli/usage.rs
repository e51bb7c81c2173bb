//! Invalid command lines: what the argument parser refuses, as a message of this program.

use std::error::Error as _;
use std::num::{IntErrorKind, ParseFloatError, ParseIntError};

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command};

use crate::platform::error::{Error, InputError};
use crate::platform::nearest::nearest;
use crate::platform::quote;

/// The error of a command line that the parser of a program refuses.
pub fn error(refused: &clap::Error, mut program: Command) -> Error {
    program.build();
    let words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    let words: Vec<String> = words.collect();
    let command = words.iter().find_map(|word| program.find_subcommand(word));
    let usage = Usage { program: &program, command, refused };
    Error::Input(match refused.kind() {
        ErrorKind::InvalidSubcommand => usage.unknown_command(),
        ErrorKind::UnknownArgument => usage.unknown_argument(),
        ErrorKind::MissingRequiredArgument => usage.missing(),
        ErrorKind::ArgumentConflict => usage.conflict(),
        ErrorKind::InvalidValue | ErrorKind::ValueValidation => usage.invalid_value(),
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand | ErrorKind::MissingSubcommand => {
            eprintln!("{}", refused.render());
            usage.error("no command is given", usage.commands())
        }
        _ => {
            let text = refused.render().to_string();
            let first = text.lines().next().unwrap_or_default();
            let problem = first.strip_prefix("error: ").unwrap_or(first).to_owned();
            usage.error(&problem, usage.synopsis())
        }
    })
}

/// A refused command line.
struct Usage<'a> {
    program: &'a Command,
    /// The command that was found.
    command: Option<&'a Command>,
    refused: &'a clap::Error,
}

impl Usage<'_> {
    /// The texts of a part of the refusal.
    fn parts(&self, kind: ContextKind) -> Vec<String> {
        match self.refused.get(kind) {
            Some(ContextValue::String(text)) => vec![text.clone()],
            Some(ContextValue::Strings(texts)) => texts.clone(),
            Some(ContextValue::StyledStr(text)) => vec![text.to_string()],
            Some(ContextValue::StyledStrs(texts)) => {
                texts.iter().map(ToString::to_string).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The first text of a part of the refusal; empty without one.
    fn part(&self, kind: ContextKind) -> String {
        self.parts(kind).into_iter().next().unwrap_or_default()
    }

    /// The program with its command, as a user writes it.
    fn called(&self) -> String {
        let name = self.command.map_or("", Command::get_name);
        format!("{} {name}", self.program.get_name()).trim_end().to_owned()
    }

    /// The names of the commands.
    fn commands(&self) -> String {
        let names = self.program.get_subcommands().filter(|command| !command.is_hide_set());
        names.map(Command::get_name).collect::<Vec<_>>().join(", ")
    }

    /// The arguments of the command on one line.
    fn synopsis(&self) -> String {
        let command = self.command.unwrap_or(self.program).clone();
        let usage = command.bin_name(self.called()).render_usage().to_string();
        let usage = usage.strip_prefix("Usage: ").unwrap_or(&usage);
        usage.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    fn error(&self, problem: &str, allowed: String) -> InputError {
        InputError {
            file: self.command.map_or("command line", Command::get_name).to_owned(),
            key: String::new(),
            value: String::new(),
            problem: problem.to_owned(),
            allowed,
            hint: format!("{} --help", self.called()),
        }
    }

    fn unknown_command(&self) -> InputError {
        let given = self.part(ContextKind::InvalidSubcommand);
        let names = self.program.get_subcommands().map(Command::get_name);
        let near = nearest(&given, names);
        let mut error = self.error(
            &suggested(&format!("\"{}\" is not a command", quote::echo(&given)), near),
            self.commands(),
        );
        "command line".clone_into(&mut error.file);
        let name = self.program.get_name();
        error.hint = near.map_or(format!("{name} --help"), |near| format!("{name} {near} --help"));
        error
    }

    /// An option, or a word too many.
    fn unknown_argument(&self) -> InputError {
        let given = self.part(ContextKind::InvalidArg);
        let name = given.split(['=', ' ']).next().unwrap_or_default();
        let Some(long) = name.strip_prefix('-') else {
            let problem = format!("unexpected argument \"{}\"", quote::echo(&given));
            return self.error(&problem, self.synopsis());
        };
        let long = long.strip_prefix('-').unwrap_or(long);
        let known = options(self.command.unwrap_or(self.program));
        let near = nearest(long, known.iter().map(|name| name.trim_start_matches('-')));
        let problem = format!("unexpected argument {}", quote::echo(name));
        let near = near.map(|near| format!("--{near}"));
        let mut error = self.error(&suggested(&problem, near.as_deref()), known.join(", "));
        let others = self.program.get_subcommands().filter(|command| {
            near.is_none() && options(command).iter().any(|option| option == name)
        });
        let others: Vec<&str> = others.map(Command::get_name).collect();
        if !others.is_empty() {
            error.hint = format!("{name} is an option of: {}", others.join(", "));
        }
        error
    }

    fn missing(&self) -> InputError {
        let missing = self.parts(ContextKind::InvalidArg);
        let verb = if missing.len() == 1 { "is" } else { "are" };
        self.error(&format!("{} {verb} missing", missing.join(" and ")), self.synopsis())
    }

    fn conflict(&self) -> InputError {
        let (given, prior) =
            (self.part(ContextKind::InvalidArg), self.parts(ContextKind::PriorArg));
        let given = given.split(' ').next().unwrap_or_default();
        let prior: Vec<&str> = prior.iter().filter_map(|prior| prior.split(' ').next()).collect();
        if prior.is_empty() || prior == [given] {
            return self.error(&format!("{given} is given twice"), format!("{given} once"));
        }
        let others = prior.join(" or ");
        self.error(
            &format!("{given} cannot be used with {others}"),
            format!("either {given} or {others}, not both"),
        )
    }

    /// A value that an option or argument does not take.
    fn invalid_value(&self) -> InputError {
        let argument = self.part(ContextKind::InvalidArg);
        let (name, value) =
            (argument.split(' ').next().unwrap_or_default(), self.part(ContextKind::InvalidValue));
        let words = self.parts(ContextKind::ValidValue);
        let (problem, allowed) = if value.is_empty() {
            ("has no value".to_owned(), words.join(", "))
        } else if words.is_empty() {
            problem_of(self.refused)
        } else {
            let near = nearest(&value, words.iter().map(String::as_str));
            (suggested("is not one of its values", near), words.join(", "))
        };
        let known = self.command.into_iter().flat_map(Command::get_arguments);
        let meaning = known.filter(|known| is_named(known, name)).find_map(Arg::get_help);
        let mut error = self.error(&problem, allowed);
        (error.key, error.value) = (name.to_owned(), value);
        if let (true, Some(meaning)) = (error.allowed.is_empty(), meaning) {
            error.allowed = meaning.to_string();
        }
        error
    }
}

/// A problem with the question after the nearest name.
fn suggested(problem: &str, near: Option<&str>) -> String {
    near.map_or_else(|| problem.to_owned(), |near| format!("{problem}; did you mean {near}?"))
}

/// Problem and allowed values of a value that could not be read.
fn problem_of(refused: &clap::Error) -> (String, String) {
    let whole = "a whole number".to_owned();
    let Some(source) = refused.source() else {
        return ("is not a value of it".to_owned(), String::new());
    };
    if let Some(error) = source.downcast_ref::<ParseIntError>() {
        return match error.kind() {
            IntErrorKind::PosOverflow | IntErrorKind::NegOverflow => {
                ("is out of range".to_owned(), whole)
            }
            _ => ("is not a whole number of 0 or more".to_owned(), whole),
        };
    }
    if source.is::<ParseFloatError>() {
        return ("is not a number".to_owned(), "a number, SI".to_owned());
    }
    // The text of the parser for a range: "70 is not in 1..=64".
    let text = source.to_string();
    match text.split_once(" is not in ") {
        Some((_, range)) => {
            let range = match range.split_once("..=") {
                // The largest number of the type.
                Some((least, most)) if most.len() >= 10 => format!("{least} or more"),
                _ => range.replace("..=", " to "),
            };
            ("is out of range".to_owned(), format!("{whole}, {range}"))
        }
        None if text.contains("invalid digit") => ("is not a whole number".to_owned(), whole),
        None => (text, String::new()),
    }
}

/// The options of a command.
fn options(command: &Command) -> Vec<String> {
    let visible = command.get_arguments().filter(|argument| !argument.is_hide_set());
    visible.filter_map(Arg::get_long).map(|long| format!("--{long}")).collect()
}

/// Whether the parser calls an argument by this name.
fn is_named(argument: &Arg, name: &str) -> bool {
    let long = name.strip_prefix("--");
    (long.is_some() && argument.get_long() == long)
        || name.trim_matches(['<', '>', '[', ']', '.']) == argument.get_id().as_str().to_uppercase()
}
