//! The deck of a job, for another code.

use std::io::Write;
use std::path::{Path, PathBuf};

use billow_solver::models::film;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::inflow::Schedule;
use billow_solver::scene::{DEFAULT_CFL, ModelKind, Scene};
use clap::ValueEnum;

use super::{Args, study};
use crate::cli::results::{self, folder_of_job};
use crate::input::value::Value;
use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::{Disk, Files, disk_error, write_output};
use crate::platform::quote;
use crate::print::print_rows;
use crate::render::deck::{self, Deck};
use crate::store::history_file;
use crate::store::stored::Stored;

/// A code that a deck is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Code {
    /// Radioss.
    Radioss,
    /// LS-DYNA.
    Dyna,
}

/// Writes the deck of a job: prints one row for each file.
///
/// # Errors
/// A job that has no deck; an option that is not of it; a file that cannot be written.
pub(super) fn write(args: &Args, of: &[String], out: &mut dyn Write) -> Result<()> {
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
