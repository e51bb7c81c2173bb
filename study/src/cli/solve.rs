//! `billow solve`: solves one scene without a study.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use billow_solver::geometry::mesh_io::obj;

use super::options::{OutputOptions, QuietOption, SetOption};
use super::{Format, instruction_set, mesh_picture, output_error};
use crate::input::value::brief_number;
use crate::job::{JobId, Status};
use crate::platform::error::{Error, Result};
use crate::platform::files::{Disk, check_output_path, disk_error, write_output};
use crate::platform::stop::Stop;
use crate::print::{duration, print_rows};
use crate::scene::file::SceneFile;
use crate::scene::solve::{self, Ended, Pauses, Solved};
use crate::scene::{check, summary};
use crate::store::history_file;

/// Arguments of `billow solve`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scene file.
    pub scene: PathBuf,
    /// Judge the mesh and print what it is: pieces, volume, free edges, stretch, step. Runs nothing.
    #[arg(long, conflicts_with_all = ["out", "shape", "checkpoint", "resume"])]
    pub check: bool,
    /// With --check: draw the mesh, with a cross at each place that the judgement names, as .svg or .png.
    #[arg(long, value_name = "FILE", requires = "check")]
    pub picture: Option<PathBuf>,
    /// Join vertices nearer to each other than this distance, as in 0.1mm: --set mesh.weld.
    #[arg(long, value_name = "DISTANCE")]
    pub weld: Option<String>,
    /// Write the history to this HDF5 file.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Write the final shape to this OBJ file, with the vertex numbers of the scene's mesh.
    #[arg(long, value_name = "FILE")]
    pub shape: Option<PathBuf>,
    /// Store the whole state in this file; --resume continues from it with the same bits.
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Number of steps between two checkpoints, with contact up to 49 more [default: a checkpoint only at
    /// a stop].
    #[arg(long, value_name = "STEPS", requires = "checkpoint", value_parser = clap::value_parser!(u64).range(1..))]
    pub every: Option<u64>,
    /// Store a checkpoint after this number of steps, with contact up to 49 more, and stop.
    #[arg(long, value_name = "STEPS", requires = "checkpoint", value_parser = clap::value_parser!(u64).range(1..))]
    pub stop_after: Option<u64>,
    /// Continue from this checkpoint of the same scene.
    #[arg(long, value_name = "FILE")]
    pub resume: Option<PathBuf>,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Interval between two progress messages. Chosen: few lines for a run of minutes.
const PROGRESS_INTERVAL: Duration = Duration::from_secs(5);

/// Runs `billow solve`: the summary on stdout, with or without a result. Exit code 1 without a result.
///
/// # Errors
/// An invalid scene, a file that cannot be read or written, a run that stopped before its end.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let mut sets = args.set.set.clone();
    sets.extend(args.weld.iter().map(|distance| format!("mesh.weld={distance}")));
    let scene = SceneFile::load(&args.scene, &sets, instruction_set::selected()?);
    if let Some(path) = &args.picture {
        mesh_picture::write(path, &args.scene, &sets, &scene)?;
    }
    let scene = scene?;
    check_files(args, &scene)?;
    if !args.quiet.quiet {
        for note in &scene.notes {
            eprintln!("billow: {note}");
        }
    }
    if args.check {
        return print(&check::report(&scene), args, out);
    }
    if !args.quiet.quiet && args.resume.is_none() {
        forecast(&scene);
    }
    let solved = solve(args, &scene)?;
    let summary = summary::summary(&scene, &solved);
    print(&summary, args, out)?;
    write_files(args, &scene, &solved)?;
    if let (Status::Paused, Some(path), false) = (solved.status, &args.checkpoint, args.quiet.quiet)
    {
        let without = if args.out.is_some() { "; --out is written at the end" } else { "" };
        eprintln!("billow: paused; continue with --resume {}{without}", path.display());
    }
    if matches!(solved.status, Status::Done | Status::Paused) {
        return Ok(());
    }
    let stop = &summary["stop"];
    let location = stop["location"].as_str().unwrap_or_default();
    let time = stop["time"].as_f64().map_or_else(String::new, |time| format!(" at {time} s"));
    let next = stop["next"].as_array().into_iter().flatten().filter_map(|text| text.as_str());
    let next = next.fold(String::new(), |all, text| all + "\n  next: " + text);
    let file = args.scene.display();
    Err(Error::JobsFailed(format!("{file}: {}{time}: {location}{next}", solved.status)))
}

/// Says on stderr what the run will take.
fn forecast(scene: &SceneFile) {
    let Some([step, steps, seconds]) = check::forecast(scene) else { return };
    eprintln!(
        "billow: forecast: {} elements, {} steps of {} s, about {} of core time",
        scene.film.shell.triangles.len(),
        brief_number(steps),
        brief_number(step),
        duration(libm::ceil(seconds))
    );
}

fn print(summary: &serde_json::Value, args: &Args, out: &mut dyn Write) -> Result<()> {
    match args.output.format_or(Format::Json) {
        Format::Json => writeln!(out, "{summary:#}").map_err(output_error),
        format => print_rows(&["quantity", "value"], &summary::rows(summary), format, out),
    }
}

/// Solves the scene; prints the progress on stderr.
fn solve(args: &Args, scene: &SceneFile) -> Result<Solved> {
    let stop = Stop::on_signals().map_err(|error| disk_error(Path::new("signals"), &error))?;
    let pauses = Pauses {
        checkpoint: args.checkpoint.clone(),
        every: args.every,
        stop_after: args.stop_after,
        resume: args.resume.clone(),
    };
    let mut last = Instant::now();
    solve::solve(scene, &pauses, &Disk, &stop, &mut |progress| {
        if !args.quiet.quiet && last.elapsed() >= PROGRESS_INTERVAL {
            last = Instant::now();
            eprintln!(
                "billow: t {:.6} of {} s, height {:.4} m, pressure {:.1} Pa",
                progress.time, progress.end_time, progress.height, progress.pressure
            );
        }
    })
}

/// Refuses output files that cannot be written, and files that a static equilibrium does not have.
fn check_files(args: &Args, scene: &SceneFile) -> Result<()> {
    for path in [&args.out, &args.shape, &args.checkpoint].into_iter().flatten() {
        check_output_path(path).map_err(|error| disk_error(path, &error))?;
    }
    let pausing = args.checkpoint.is_some() || args.resume.is_some();
    let option = match (&args.out, pausing) {
        (Some(_), _) => "--out",
        (None, true) => "--checkpoint, --resume",
        (None, false) => return Ok(()),
    };
    if !scene.film.solver.statics {
        return Ok(());
    }
    let problem = "a static equilibrium has no history";
    Err(Error::invalid_option(option, "", problem, "with solver.static only --shape", ""))
}

fn write_files(args: &Args, scene: &SceneFile, solved: &Solved) -> Result<()> {
    let write = |path: &PathBuf, bytes: &[u8]| {
        write_output(&Disk, path, bytes).map_err(|error| disk_error(path, &error))
    };
    if let (Some(path), Ended::Motion(motion)) = (&args.out, &solved.end)
        && solved.status != Status::Paused
    {
        let deployment = &motion.1;
        let hash = history_file::content_hash(deployment);
        let id = JobId::from_digits(&scene.fingerprint[..32]);
        let id = id.unwrap_or_else(|| unreachable!("a fingerprint has 64 hexadecimal digits"));
        let bytes = history_file::encode_scene(&id, &scene.json.to_string(), deployment, &hash)
            .map_err(|problem| Error::Disk { path: path.clone(), problem })?;
        write(path, &bytes)?;
    }
    if let Some(path) = &args.shape {
        let positions = match &solved.end {
            Ended::Motion(motion) => &motion.0.view().state.positions,
            Ended::Equilibrium(equilibrium) => &equilibrium.positions,
            Ended::NoEquilibrium(_) => return Ok(()),
        };
        let numbering = &scene.numbering;
        let vertices = numbering.node.iter().zip(&numbering.surface.vertices);
        let vertices: Vec<_> = vertices
            .map(|(node, start)| {
                node.map_or(*start, |node| positions.get(node as usize)) + numbering.origin
            })
            .collect();
        let title = format!("billow solve {}: {}", args.scene.display(), solved.status);
        write(path, obj::surface(&numbering.surface, &vertices, &title).as_bytes())?;
    }
    Ok(())
}
