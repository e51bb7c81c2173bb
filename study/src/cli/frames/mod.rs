//! `billow frames`: draws the shapes of one job side by side or in motion, or writes them for other programs.

use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};

use billow_solver::output::frames::Frame;
use clap::ValueEnum;

use super::options::{OutputOptions, QuietOption};
use super::picture::{self, Picture, refused};
use super::results::{StudyArgs, folder_of_job};
use crate::chart::parameters::Parameter;
use crate::input::value::Value;
use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::{Disk, Files, disk_error, write_output};
use crate::print::{Format, print_rows};
use crate::render::filmstrip::{Colour, Filmstrip};
use crate::render::projection::View;
use crate::store::history_file::{self, StoredFrames};
use crate::store::stored::Stored;

mod choose;
mod motion;
mod values;

use choose::{by_displacement, nearest};
use motion::{Film, Model};

/// Arguments of `billow frames`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The job: the first digits of its id; or a history file (.h5).
    pub job: String,
    #[command(flatten)]
    study: StudyArgs,
    /// Number of frames, from the first to the last, with about equal motion between them; a single
    /// frame is the last one.
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub count: usize,
    /// Draw the frames nearest to these times, comma-separated: s, or with a unit, as in
    /// "10 ms, 0.5".
    #[arg(
        long,
        value_name = "TIMES",
        value_delimiter = ',',
        conflicts_with = "count",
        allow_hyphen_values = true
    )]
    pub times: Vec<String>,
    /// Meaning of the colours [default: storey; none for a mesh without storeys].
    #[arg(long, value_enum)]
    pub colour: Option<ColourArg>,
    /// Shade smoothly between folds, and draw no lines of the mesh.
    #[arg(long)]
    pub smooth: bool,
    /// Title of the picture [default: study, job and parameters].
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// Direction of view: azimuth and elevation, degrees.
    #[arg(
        long,
        value_name = "AZIMUTH,ELEVATION",
        default_value = "30,20",
        allow_hyphen_values = true
    )]
    pub view: String,
    /// File to write: a picture, .svg or .png; the last shape, or the one at --times, as .obj or .stl; every stored shape in
    /// motion as .glb (glTF) [default: both pictures, `charts/frames_JOB` in the folder of the results, or beside the
    /// history file].
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Write the motion in slow motion, 25 pictures a second: .gif, or .webm where ffmpeg is installed.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["out", "count", "times"])]
    pub animate: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Meaning of the colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ColourArg {
    /// The storey of a capsule.
    Storey,
    /// The state of the film: taut, wrinkled, slack.
    Regime,
    /// The largest principal stress, on one scale in all shapes.
    Stress,
    /// The speed, on one scale in all shapes.
    Speed,
    /// One colour.
    None,
}

/// A run whose shapes are drawn.
struct Source {
    /// History file.
    path: PathBuf,
    /// Title of the picture.
    title: String,
    /// Default path of the pictures, without the extension.
    out: PathBuf,
}

/// Runs `billow frames`: prints one row per picture.
///
/// # Errors
/// An unknown job, or one without frames; an invalid option; a file that cannot be read or written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let view = view(&args.view)?;
    let source = source(args)?;
    let model = Model::asked(args)?;
    let film = args.animate.as_deref().map(Film::of).transpose()?;
    let pictures =
        if model.is_some() || film.is_some() { Vec::new() } else { pictures(args, &source)? };
    let stored = history_file::read_frames(&source.path)?.ok_or_else(|| Error::Disk {
        path: source.path.clone(),
        problem:
            "no frames in this file: its model has no shape (piston), or outputs.frames is 0\n  \
                  next: run it with solver.model \"film\" and outputs.frames above 0"
                .to_owned(),
    })?;
    let history = history_file::read(&source.path)?.history;
    let (motion, one) = (film.is_some() || model == Some(Model::Glb), model.is_some());
    let numbers = if motion {
        (0..stored.times().len()).collect()
    } else if one && args.times.is_empty() {
        vec![stored.times().len() - 1]
    } else if args.times.is_empty() {
        by_displacement(args.count, &displacements(&stored)?)?
    } else {
        nearest(&args.times, stored.times(), args.quiet.quiet)?
    };
    let mut frames: Vec<Frame> =
        numbers.iter().map(|number| stored.frame(*number)).collect::<Result<_>>()?;
    let title = args.title.clone().unwrap_or(source.title);
    if let (Some(model), Some(path)) = (model, &args.out) {
        let bytes = model.bytes(&stored, &frames, &title);
        let bytes = bytes.map_err(|problem| Error::Disk { path: path.clone(), problem })?;
        write_output(&Disk, path, &bytes).map_err(|error| disk_error(path, &error))?;
        return printed(std::slice::from_ref(path), &frames, args.output.format(), out);
    }
    if film.is_some() {
        frames = motion::slow(&frames);
    }
    let colour = colour(args.colour, &stored, &frames)?;
    let most = if film.is_some() { usize::MAX } else { values::MAX_WITH_VALUES };
    let (values, meaning) = values::below(&frames, &history, most);
    let notes: Vec<String> = meaning.into_iter().collect();
    let strip = Filmstrip {
        title: &title,
        triangles: stored.triangles(),
        storeys: stored.storeys(),
        frames: &frames,
        view,
        colour,
        smooth: args.smooth,
        values: &values,
        marks: &[],
        notes: &notes,
    };
    if let (Some(film), Some(path)) = (film, &args.animate) {
        film.write(&strip, path)?;
        return printed(std::slice::from_ref(path), &frames, args.output.format(), out);
    }
    let svg = strip.svg();
    if args.out.is_none()
        && let Some(folder) = source.out.parent().filter(|folder| !folder.as_os_str().is_empty())
    {
        Disk.create_folder(folder).map_err(|error| disk_error(folder, &error))?;
    }
    for path in &pictures {
        picture::write(path, &svg)?;
    }
    printed(&pictures, &frames, args.output.format(), out)
}

/// Prints one row for each file.
fn printed(paths: &[PathBuf], frames: &[Frame], format: Format, out: &mut dyn Write) -> Result<()> {
    let time = |frame: Option<&Frame>| frame.map_or(Value::Null, |f| Value::Number(f.time));
    let row = |path: &PathBuf| {
        vec![
            Value::Text(path.display().to_string()),
            Value::Integer(i64::try_from(frames.len()).unwrap_or(i64::MAX)),
            time(frames.first()),
            time(frames.last()),
        ]
    };
    let rows: Vec<Vec<Value>> = paths.iter().map(row).collect();
    print_rows(&["file", "frames", "from", "to"], &rows, format, out)
}

/// Displacement of the film from each frame to the next: root mean square over the nodes, m.
fn displacements(stored: &StoredFrames) -> Result<Vec<f64>> {
    let mut displacements = Vec::with_capacity(stored.times().len());
    let mut before = stored.frame(0)?;
    for number in 1..stored.times().len() {
        let frame = stored.frame(number)?;
        let square = |(a, b): (&[f32; 3], &[f32; 3])| {
            (0..3).map(|k| f64::from(a[k] - b[k]) * f64::from(a[k] - b[k])).sum::<f64>()
        };
        let sum: f64 = before.positions.iter().zip(&frame.positions).map(square).sum();
        displacements.push((sum / frame.positions.len().max(1) as f64).sqrt());
        before = frame;
    }
    Ok(displacements)
}

/// The meaning of the colours: the one asked for, or storeys if the film has some.
fn colour(asked: Option<ColourArg>, stored: &StoredFrames, frames: &[Frame]) -> Result<Colour> {
    let capsule = stored.storeys().iter().any(|storey| *storey > 0);
    Ok(match asked {
        Some(ColourArg::Storey) if !capsule => {
            let problem = "this film is not a capsule and has no storeys";
            return Err(refused("--colour", "storey", problem, "regime, stress, speed, none"));
        }
        Some(ColourArg::Regime) => Colour::Regime,
        Some(ColourArg::Stress) => Colour::Quantity(values::stress(frames)),
        Some(ColourArg::Speed) => Colour::Quantity(values::speed(frames, stored.triangles())),
        Some(ColourArg::Storey) | None if capsule => Colour::Storey,
        Some(ColourArg::Storey | ColourArg::None) | None => Colour::Plain,
    })
}

fn source(args: &Args) -> Result<Source> {
    let path = Path::new(&args.job);
    if path.is_file() || path.extension().is_some_and(|extension| extension == "h5") {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let out = path.with_file_name(format!("{stem}_frames"));
        return Ok(Source { path: path.to_owned(), title: stem.into_owned(), out });
    }
    let root = folder_of_job(&args.job, &args.study)?;
    let stored = super::results::read(&root)?;
    let id = stored.job(&args.job)?;
    Ok(Source {
        path: stored.history_path(&id)?,
        title: title(&stored, &id),
        out: stored.results.charts_path().join(format!("frames_{}", id.short())),
    })
}

/// Study, job and its parameters with their units, as charts name them.
fn title(stored: &Stored<'_>, id: &JobId) -> String {
    let mut title = format!("{}, job {}", stored.study.name, id.short());
    let table = stored.table();
    let row = table.column("job").and_then(|jobs| {
        jobs.cells.iter().position(|cell| *cell == Value::Text(id.as_str().to_owned()))
    });
    let all: Vec<usize> = (0..table.rows()).collect();
    for column in table.parameters() {
        if let Some(row) = row {
            let _ = write!(title, ", {}", Parameter::new(column, &all).named(row));
        }
    }
    title
}

/// Files to write: the one asked for, or one per format.
fn pictures(args: &Args, source: &Source) -> Result<Vec<PathBuf>> {
    let Some(path) = &args.out else {
        let path = |format: Picture| {
            let mut path = source.out.clone().into_os_string();
            path.push(format!(".{}", format.extension()));
            PathBuf::from(path)
        };
        return Ok(Picture::ALL.map(path).to_vec());
    };
    if Picture::of(path).is_err() {
        let value = path.display().to_string();
        let allowed = "a file name that ends in .svg, .png, .obj, .stl or .glb; --animate writes .gif and .webm";
        return Err(refused("--out", &value, "not a format of shapes", allowed));
    }
    Ok(vec![path.clone()])
}

fn view(text: &str) -> Result<View> {
    let wrong = |problem: &str| {
        let allowed = "azimuth,elevation in degrees, as 30,20; elevation -90 to 90";
        refused("--view", text, problem, allowed)
    };
    let parts: Vec<&str> = text.split(',').collect();
    let [azimuth, elevation] = parts.as_slice() else {
        return Err(wrong("not two numbers"));
    };
    let degrees = |part: &str| part.trim().parse::<f64>().ok().filter(|angle| angle.is_finite());
    let (Some(azimuth), Some(elevation)) = (degrees(azimuth), degrees(elevation)) else {
        return Err(wrong("not two numbers"));
    };
    if elevation.abs() > 90.0 {
        return Err(wrong("the elevation is out of range"));
    }
    Ok(View::new(azimuth.to_radians(), elevation.to_radians()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_is_two_angles() {
        assert_eq!(
            view(" -30, 20.5").unwrap(),
            View::new(-30_f64.to_radians(), 20.5_f64.to_radians())
        );
        for wrong in ["30", "30,20,10", "30,91", "north,up", "inf,0"] {
            assert!(view(wrong).unwrap_err().to_string().contains("--view"), "{wrong}");
        }
    }
}
