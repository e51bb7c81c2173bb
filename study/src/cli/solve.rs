//! `billow solve`: one scene by itself.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use billow_solver::geometry::mesh_io::obj;

use super::instruction_set::instruction_set;
use super::print::print_rows;
use super::{Format, Global, output_error};
use crate::job::{JobId, Status};
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files::{Disk, check_output_path, disk_error, write_atomic};
use crate::platform::stop::Stop;
use crate::scene::file::SceneFile;
use crate::scene::solve::{self, Ended, Pauses, Solved};
use crate::scene::summary;
use crate::store::history_file;

/// Arguments of `billow solve`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scene file.
    pub scene: PathBuf,
    /// Write the history to this HDF5 file.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Write the shape at the end to this OBJ file, in the numbers of the scene's mesh.
    #[arg(long, value_name = "FILE")]
    pub shape: Option<PathBuf>,
    /// Store the whole state in this file, so that --resume goes on from it bit for bit.
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Steps between two checkpoints [default: only where the run is stopped].
    #[arg(long, value_name = "STEPS", requires = "checkpoint", value_parser = clap::value_parser!(u64).range(1..))]
    pub every: Option<u64>,
    /// Store a checkpoint after this many steps and end.
    #[arg(long, value_name = "STEPS", requires = "checkpoint", value_parser = clap::value_parser!(u64).range(1..))]
    pub stop_after: Option<u64>,
    /// Go on from this checkpoint of the same scene.
    #[arg(long, value_name = "FILE")]
    pub resume: Option<PathBuf>,
}

/// Runs `billow solve`: the summary on stdout, whatever the end; exit code 1 where it is no result.
///
/// # Errors
/// A scene that is none, a file that cannot be read or written, a run that stopped short.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    // One scene runs on one thread; the option is still checked.
    super::run::threads(global)?;
    let scene = SceneFile::load(&args.scene, &global.set, instruction_set()?)?;
    check_files(args, &scene)?;
    if !global.quiet {
        for note in &scene.notes {
            eprintln!("billow: {note}");
        }
    }
    let stop = Stop::on_signals().map_err(|error| disk_error(Path::new("signals"), &error))?;
    let pauses = Pauses {
        checkpoint: args.checkpoint.clone(),
        every: args.every,
        stop_after: args.stop_after,
        resume: args.resume.clone(),
    };
    let mut last = Instant::now();
    let solved = solve::solve(&scene, &pauses, &Disk, &stop, &mut |progress| {
        if !global.quiet && last.elapsed() >= Duration::from_secs(5) {
            last = Instant::now();
            eprintln!(
                "billow: {:.6} of {} s, top at {:.4} m, {:.1} Pa",
                progress.time, progress.end_time, progress.z_centre, progress.pressure
            );
        }
    })?;
    let summary = summary::summary(&scene, &solved);
    match global.format.filter(|_| !global.json).unwrap_or(Format::Json) {
        Format::Json => writeln!(out, "{summary:#}").map_err(output_error)?,
        format => print_rows(&["quantity", "value"], &summary::rows(&summary), format, out)?,
    }
    write_files(args, &scene, &solved)?;
    if let (Status::Paused, Some(path), false) = (solved.status, &args.checkpoint, global.quiet) {
        let without = if args.out.is_some() { "; --out is written when it is done" } else { "" };
        eprintln!("billow: paused; go on with --resume {}{without}", path.display());
    }
    if matches!(solved.status, Status::Done | Status::Paused) {
        return Ok(());
    }
    let place = summary["stop"]["place"].as_str().unwrap_or_default();
    let time = summary["stop"]["time"].as_f64();
    let time = time.map_or_else(String::new, |time| format!(" at {time} s"));
    Err(Error::JobsFailed(format!("{}: {}{time}: {place}", args.scene.display(), solved.status)))
}

/// What cannot be written, or what a state of rest has none of, is not asked for.
fn check_files(args: &Args, scene: &SceneFile) -> Result<()> {
    for path in [&args.out, &args.shape, &args.checkpoint].into_iter().flatten() {
        check_output_path(path).map_err(|error| disk_error(path, &error))?;
    }
    let pausing = args.checkpoint.is_some() || args.resume.is_some();
    let flag = match (&args.out, pausing) {
        (Some(_), _) => "--out",
        (None, true) => "--checkpoint, --resume",
        (None, false) => return Ok(()),
    };
    if !scene.film.solver.statics {
        return Ok(());
    }
    Err(Error::Input(InputError {
        file: flag.to_owned(),
        key: String::new(),
        value: String::new(),
        problem: "a state of rest has no history".to_owned(),
        allowed: "with solver.static, --shape alone".to_owned(),
        hint: String::new(),
    }))
}

fn write_files(args: &Args, scene: &SceneFile, solved: &Solved) -> Result<()> {
    let write = |path: &PathBuf, bytes: &[u8]| {
        write_atomic(&Disk, path, bytes).map_err(|error| disk_error(path, &error))
    };
    if let (Some(path), Ended::Motion(motion)) = (&args.out, &solved.end)
        && solved.status != Status::Paused
    {
        let deployment = &motion.1;
        let hash = history_file::content_hash(deployment);
        let id = JobId::from_digits(&scene.fingerprint[..32]);
        let id = id.unwrap_or_else(|| unreachable!("a fingerprint has 64 digits"));
        let bytes = history_file::encode_scene(&id, &scene.json.to_string(), deployment, &hash)
            .map_err(|problem| Error::Disk { path: path.clone(), problem })?;
        write(path, &bytes)?;
    }
    if let Some(path) = &args.shape {
        let places = match &solved.end {
            Ended::Motion(motion) => &motion.0.film.state.positions,
            Ended::Equilibrium(solution) => &solution.positions,
            Ended::NoEquilibrium(_) => return Ok(()),
        };
        let numbering = &scene.numbering;
        let vertices = numbering.node.iter().zip(&numbering.surface.vertices);
        let vertices: Vec<_> = vertices
            .map(|(node, start)| node.map_or(*start, |node| places.get(node as usize)))
            .collect();
        let title = format!("billow solve {}: {}", args.scene.display(), solved.status);
        write(path, obj::surface(&numbering.surface, &vertices, &title).as_bytes())?;
    }
    Ok(())
}
