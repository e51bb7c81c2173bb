//! `billow export`: writes all results of a study into one file, or the film of a job as a deck, for other programs.

use std::io::Write;
use std::path::{Path, PathBuf};

use billow_solver::models::film;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::inflow::Schedule;
use billow_solver::scene::{DEFAULT_CFL, ModelKind, Scene};
use clap::ValueEnum;

use super::options::{OutputOptions, ResultsOption};
use super::results::{self, StudyArgs, folder_of_job};
use crate::input::value::Value;
use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::{Disk, Files, disk_error, write_output};
use crate::platform::quote;
use crate::print::print_rows;
use crate::render::deck::{self, Deck};
use crate::store::cube::{self, Written};
use crate::store::history_file;
use crate::store::stored::Stored;

/// Extensions of the file.
const EXTENSIONS: [&str; 2] = ["nc", "h5"];

/// Arguments of `billow export`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// With --deck the job: the first digits of its id. Else the study.
    #[arg(value_name = "JOB|STUDY")]
    pub of: Option<String>,
    /// Study file, or folder of its results [default: the only folder under results].
    pub study: Option<String>,
    #[command(flatten)]
    results: ResultsOption,
    /// Write the cube of the study: every history over points and time, and every column of the table over
    /// the points, as one file that xarray opens (netCDF-4 in HDF5). FILE ends in .nc or .h5.
    #[arg(long, value_name = "FILE", required_unless_present = "deck")]
    pub out: Option<PathBuf>,
    /// Only these columns of the histories, comma-separated [default: all].
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',', conflicts_with = "deck")]
    pub columns: Vec<String>,
    /// Write the stowed film of a job as the input of another explicit finite element code, in kg, m, s: `radioss DIR`
    /// writes two files into a folder, `dyna FILE.k` one for LS-DYNA. What it leaves out is said in its first lines.
    #[arg(long, value_names = ["CODE", "PATH"], num_args = 2, conflicts_with = "out")]
    pub deck: Option<Vec<String>>,
    #[command(flatten)]
    output: OutputOptions,
}

/// A code that a deck is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Code {
    /// Radioss.
    Radioss,
    /// LS-DYNA.
    Dyna,
}

/// Runs `billow export`: prints one row for each file.
///
/// # Errors
/// As [`cube::write`]; a file name with another extension; a job that has no deck.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    match (&args.deck, &args.out) {
        (Some(of), _) => decks(args, of, out),
        (None, Some(path)) => cubes(args, path, out),
        (None, None) => unreachable!("clap asks for one of them"),
    }
}

fn study(args: &Args, path: Option<&String>) -> StudyArgs {
    StudyArgs { study: path.map(PathBuf::from), results: args.results.clone() }
}

fn cubes(args: &Args, path: &Path, out: &mut dyn Write) -> Result<()> {
    check_extension(path)?;
    if let Some(second) = &args.study {
        let allowed = "one study; a job with --deck";
        return Err(Error::invalid_option("STUDY", second, "a second argument", allowed, ""));
    }
    let stored = results::read(&results::folder(&study(args, args.of.as_ref()))?)?;
    let written = cube::write(&stored, &args.columns, path)?;
    let Written { points, times, variables, histories } = written;
    let number = |number: usize| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
    let mut row = vec![Value::Text(path.display().to_string())];
    row.extend([points, times, variables, histories].map(number));
    let names = ["file", "points", "times", "variables", "histories"];
    print_rows(&names, &[row], args.output.format(), out)
}

fn decks(args: &Args, of: &[String], out: &mut dyn Write) -> Result<()> {
    let [code, path] = of else { unreachable!("clap asks for two") };
    let Ok(code) = Code::from_str(code, true) else {
        let problem = "no code that billow writes decks for";
        return Err(Error::invalid_option("--deck", code, problem, "radioss DIR, dyna FILE.k", ""));
    };
    let path = Path::new(path);
    let Some(job) = &args.of else {
        let next = "billow table --runs --columns job,status lists the ids";
        return Err(Error::invalid_option(
            "JOB",
            "",
            "no job",
            "the first digits of a job id",
            next,
        ));
    };
    let root = folder_of_job(job, &study(args, args.study.as_ref()))?;
    let stored = results::read(&root)?;
    let id = stored.job(job)?;
    if stored.point(&id).is_none() {
        let (id, root) = (id.short(), quote::path(&root));
        eprintln!("note: job {id} is of an earlier run of {root}, not of its study as it ran last");
    }
    let files = written(&stored, &id, code, path)?;
    let ends_in_k = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("k"));
    if code == Code::Dyna && !ends_in_k {
        let (value, problem) = (path.display().to_string(), "is not a keyword file");
        let allowed = "a file name that ends in .k";
        return Err(Error::invalid_option("--deck dyna", &value, problem, allowed, ""));
    }
    if code == Code::Radioss {
        if path.is_file() {
            let (value, problem) = (path.display().to_string(), "is a file");
            let allowed = "a folder for the two files; it may be new";
            return Err(Error::invalid_option("--deck radioss", &value, problem, allowed, ""));
        }
        Disk.create_folder(path).map_err(|error| disk_error(path, &error))?;
    }
    let mut rows = Vec::new();
    for (file, text) in files {
        write_output(&Disk, &file, text.as_bytes()).map_err(|error| disk_error(&file, &error))?;
        let lines = i64::try_from(text.lines().count()).unwrap_or(i64::MAX);
        rows.push(vec![Value::Text(file.display().to_string()), Value::Integer(lines)]);
    }
    print_rows(&["file", "lines"], &rows, args.output.format(), out)
}

/// The files of a deck, with their text.
fn written(
    stored: &Stored<'_>,
    id: &JobId,
    code: Code,
    path: &Path,
) -> Result<Vec<(PathBuf, String)>> {
    let refused = |problem: &str| {
        let (problem, allowed) = problem.split_once("; allowed: ").unwrap_or((problem, "film"));
        Error::invalid_option("JOB", id.short(), problem, allowed, "")
    };
    // A scene with a mesh is known by its study, and is not read from JSON.
    let scene: Scene = match stored.point(id) {
        Some(point) if point.infeasible.is_some() => {
            return Err(refused("no fold pattern fits it; allowed: a job with a fold pattern"));
        }
        Some(point) if point.job.id == *id => (*point.job.scene).clone(),
        _ => serde_json::from_value(stored.scene(id)?)
            .map_err(|error| refused(&format!("it is not in the study any more: {error}")))?,
    };
    if scene.solver.model != ModelKind::Film {
        return Err(refused("its model has no mesh; allowed: solver.model film"));
    }
    let contact = Some(FilmContact::of(&scene.contact));
    let (film, rings) = film::at_start(InstructionSet::detect(), &scene, DEFAULT_CFL, contact)
        .map_err(|error| refused(&error.to_string()))?;
    let (storeys, followed) = rings.map_or_else(Default::default, |rings| {
        let mut followed = vec![rings.top_centre];
        followed.extend(rings.top_ring);
        (rings.storeys, followed)
    });
    let (title, name) = (stored.label(id), format!("job_{}", id.short()));
    let gas = gas_at_release(stored, id, &scene)?;
    let (title, name, storeys, followed) = (&*title, &*name, &*storeys, &*followed);
    let deck = Deck { title, name, film: &film, storeys, followed, gas };
    let deck = deck.checked().map_err(|problem| refused(&problem))?;
    Ok(match code {
        Code::Dyna => vec![(path.to_owned(), deck::keyword_file(&deck))],
        Code::Radioss => vec![
            (path.join(format!("{name}_0000.rad")), deck::starter_file(&deck)),
            (path.join(format!("{name}_0001.rad")), deck::engine_file(&deck)),
        ],
    })
}

/// Mass (kg) and temperature (K) of the gas when the lid releases the capsule: of the history where the job has run, else
/// what has flowed in, at film temperature.
fn gas_at_release(stored: &Stored<'_>, id: &JobId, scene: &Scene) -> Result<[f64; 2]> {
    let (release, schedule) = (scene.release_time, Schedule::of(&scene.gas));
    if stored.record(id).is_some_and(|record| record.file_hash.is_some()) {
        let history = history_file::read(&stored.history_path(id)?)?.history;
        let times = history.column("time");
        let at = times.partition_point(|time| *time <= release).saturating_sub(1);
        let column = |name: &str| history.column(name).get(at).copied();
        if let (Some(mass), Some(temperature)) = (column("gas_mass"), column("temperature")) {
            // What flows in between the sample and the release.
            let more = schedule.mass_until(release) - schedule.mass_until(times[at]);
            return Ok([mass + more, temperature]);
        }
    }
    Ok([scene.gas.initial_mass + schedule.mass_until(release), scene.film.temperature])
}

fn check_extension(path: &Path) -> Result<()> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    if extension.is_some_and(|extension| EXTENSIONS.contains(&extension.as_str())) {
        return Ok(());
    }
    let value = path.display().to_string();
    let allowed = "a file name that ends in .nc or .h5";
    Err(Error::invalid_option("--out", &value, "not a format of cubes", allowed, ""))
}
