//! `billow pareto`: work-precision diagrams of a study.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use billow_solver::output::events::EventKind;

use super::options::{OutputOptions, QuietOption, SetOption, UnitsOption};
use super::picture::{self, Picture};
use super::target::StudyArgs;
use super::{Format, opened, output_error};
use crate::analysis::work_precision::peer::Peer;
use crate::analysis::work_precision::table::{COURSES, Histories, scenes};
use crate::analysis::work_precision::{Cost, Course, Diagram, SceneRuns};
use crate::chart::pareto as pictures;
use crate::input::keys::numerical::MESH_PARAMETER;
use crate::input::study_file::MAX_FILE_SIZE;
use crate::platform::error::{Error, Result};
use crate::platform::files::{self, Disk, Files, disk_error};
use crate::platform::nearest::did_you_mean;
use crate::store::history_file::StoredHistory;
use crate::store::results::Results;
use crate::store::stored::Stored;

mod print;

/// Arguments of `billow pareto`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Only these scenes of the study, comma-separated.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    scenes: Vec<String>,
    /// Only these quantities, comma-separated, for example `t_90_z_rim,volume`; of one scene
    /// `end_state:final_volume`.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    measures: Vec<String>,
    /// The cost of pictures and front: element-steps, or seconds of this machine.
    #[arg(long, value_enum, default_value_t = CostName::Work)]
    cost: CostName,
    /// Print every configuration, not the front alone.
    #[arg(long)]
    all: bool,
    /// File of a peer, another program, whose points stand on the pictures of seconds.
    #[arg(long, value_name = "FILE")]
    peer: Option<PathBuf>,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// The cost of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum CostName {
    /// Element-steps; the same on every machine.
    Work,
    /// Wall time of this machine.
    Seconds,
}

/// Runs `billow pareto`: prints the front and draws the pictures.
///
/// # Errors
/// Results or a peer that cannot be read; an unknown scene or quantity; a picture that cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let peer = args.peer.as_deref().map(read_peer).transpose()?;
    let (stored, table, _) =
        opened::open_stored(&args.study, &args.set.set, &UnitsOption::default(), None)?;
    let results = stored.results.clone();
    let read = |job: &str| histories(&stored, job, args.quiet.quiet);
    // The meshes of solver.meshes are configurations here.
    let mut replicates = stored.study.replicates();
    replicates.retain(|name| name != MESH_PARAMETER);
    let of_study = scenes(&stored.study.name, &table, &replicates, &read);
    let chosen = chosen(of_study, &args.scenes)?;
    let mut diagrams: Vec<Diagram> = chosen.into_iter().map(Diagram::of).collect();
    keep_measures(&mut diagrams, &args.measures)?;
    let cost = match args.cost {
        CostName::Work => Cost::Work,
        CostName::Seconds => Cost::Seconds,
    };
    let format = args.output.format();
    print::front(&diagrams, cost, args.all, format, out)?;
    let written = draw(&results, &diagrams, cost, peer.as_ref())?;
    if format == Format::Table {
        writeln!(out).map_err(output_error)?;
        for path in &written {
            writeln!(out, "{}", path.display()).map_err(output_error)?;
        }
        if let Some(peer) = &peer {
            print::peer(peer, &diagrams, out)?;
        }
        if !args.quiet.quiet {
            print::notes(&diagrams, cost);
        }
    }
    Ok(())
}

/// The scenes of the study with these names; every one without names.
///
/// # Errors
/// A name that the study does not have.
fn chosen(mut scenes: Vec<SceneRuns>, names: &[String]) -> Result<Vec<SceneRuns>> {
    let known: Vec<String> = scenes.iter().map(|scene| scene.name.clone()).collect();
    check("--scenes", "not a scene of the study", names, &known)?;
    scenes.retain(|scene| names.is_empty() || names.contains(&scene.name));
    Ok(scenes)
}

/// Checks that each name is known.
///
/// # Errors
/// The first one that is not.
fn check(option: &str, problem: &str, names: &[String], known: &[String]) -> Result<()> {
    for name in names {
        if !known.contains(name) {
            let near = did_you_mean(name, known.iter().map(String::as_str)).unwrap_or_default();
            return Err(Error::invalid_option(option, name, problem, known.join(", "), near));
        }
    }
    Ok(())
}

/// Keeps the quantities with these names; every one without names. A name with its scene before it, as
/// `end_state:final_volume`, chooses in that scene alone. Scenes without any of them are left out.
///
/// # Errors
/// A name that no scene has.
fn keep_measures(diagrams: &mut Vec<Diagram>, names: &[String]) -> Result<()> {
    let of_scene = |diagram: &Diagram, quantity: &str| format!("{}:{quantity}", diagram.name);
    let mut known: Vec<String> = Vec::new();
    for diagram in diagrams.iter() {
        for errors in &diagram.quantities {
            let name = &errors.quantity.name;
            for text in [name.clone(), of_scene(diagram, name)] {
                if !known.contains(&text) {
                    known.push(text);
                }
            }
        }
    }
    let (single, of_all): (Vec<&String>, Vec<&String>) =
        names.iter().partition(|name| name.contains(':'));
    // The scene may be one that --scenes leaves out.
    let scene = |name: &str| name.split(':').next().unwrap_or_default().to_owned();
    let drawn = |name: &String| diagrams.iter().any(|diagram| diagram.name == scene(name));
    let checked: Vec<String> = of_all
        .iter()
        .map(|name| (*name).clone())
        .chain(single.iter().filter(|name| drawn(name)).map(|name| (*name).clone()))
        .collect();
    known.sort_by_key(|name| name.contains(':'));
    check("--measures", "not a quantity of these scenes", &checked, &known)?;
    for diagram in diagrams.iter_mut() {
        let prefix = of_scene(diagram, "");
        let here: Vec<&str> = single.iter().filter_map(|name| name.strip_prefix(&prefix)).collect();
        if here.is_empty() && of_all.is_empty() {
            continue;
        }
        diagram.quantities.retain(|errors| {
            let name = errors.quantity.name.as_str();
            here.contains(&name) || of_all.iter().any(|known| *known == name)
        });
    }
    diagrams.retain(|diagram| !diagram.quantities.is_empty());
    Ok(())
}

/// What the history of a job says; `None` with a message where it cannot be read.
fn histories(stored: &Stored<'_>, job: &str, quiet: bool) -> Option<Histories> {
    let id = crate::job::JobId::from_digits(job)?;
    match stored.results.read_history(&id, stored.record(&id)) {
        Ok(history) => Some(of_history(&history)),
        Err(error) => {
            if !quiet {
                eprintln!("billow: {error}");
            }
            None
        }
    }
}

fn of_history(history: &StoredHistory) -> Histories {
    let times = history.history.column("time");
    let course = |(name, _, _): (&str, &str, &str)| {
        Course::new(times, history.history.column(name)).map(Arc::new)
    };
    Histories {
        courses: COURSES.map(course),
        simulated: times.last().copied().unwrap_or(0.0),
        implicit: history.events.iter().any(|event| event.kind == EventKind::Implicit),
    }
}

/// Reads the file of a peer.
///
/// # Errors
/// A file that cannot be read, or does not describe a peer.
fn read_peer(path: &Path) -> Result<Peer> {
    let refuse = |problem: String| {
        let allowed =
            "a file as results/pareto/published/peer.json; docs/guide/pareto.md lists its members";
        Error::invalid_option("--peer", &path.display().to_string(), problem, allowed, "")
    };
    let bytes =
        files::read_at_most(path, MAX_FILE_SIZE).map_err(|error| disk_error(path, &error))?;
    let bytes = bytes.ok_or_else(|| refuse("is too large".to_owned()))?;
    Peer::from_text(&bytes).map_err(refuse)
}

/// Writes the pictures of the scenes and the overview. Returns their paths.
///
/// # Errors
/// A picture that cannot be written.
fn draw(
    results: &Results<'_>,
    diagrams: &[Diagram],
    cost: Cost,
    peer: Option<&Peer>,
) -> Result<Vec<PathBuf>> {
    let folder = results.charts_path();
    Disk.create_folder(&folder).map_err(|error| disk_error(&folder, &error))?;
    let ending = if cost == Cost::Seconds { "_seconds" } else { "" };
    let mut written = Vec::new();
    let mut write = |name: &str, svg: &str| -> Result<()> {
        for format in Picture::ALL {
            let path = folder.join(format!("{name}{ending}.{}", format.extension()));
            picture::write(&path, svg)?;
            written.push(path);
        }
        Ok(())
    };
    write("pareto", &pictures::overview(diagrams, cost))?;
    for diagram in diagrams {
        write(&file_name(&diagram.name), &pictures::scene(diagram, cost, peer))?;
    }
    Ok(written)
}

/// File name of the picture of a scene.
fn file_name(scene: &str) -> String {
    let plain = |symbol: char| if symbol.is_alphanumeric() || symbol == '.' { symbol } else { '_' };
    format!("pareto_{}", scene.chars().map(plain).collect::<String>())
}
