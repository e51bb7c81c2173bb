//! `billow-checks stability`: the map of where each method of integration fails.

use std::io::Write;
use std::path::{Path, PathBuf};

use billow_study::cli::options::{OutputOptions, QuietOption, ThreadsOption};
use billow_study::cli::print::{count, print_rows};
use billow_study::cli::{Format, instruction_set, output_error};
use billow_study::input::value::{Value, brief_number};
use billow_study::platform::error::{Error, Result};
use billow_study::platform::files::{self, Disk, Files, disk_error};
use billow_study::platform::stop::Stop;

use super::file::{self, Map};
use super::map::{Border, Placed, Running, borders, placed};
use super::picture::{border_text, map as map_picture, overview, strip};
use super::stored::{self, Cells, MAP_FILE};
use crate::cases::Rig;
use crate::output::{chosen, draw};

/// Columns of the table.
const COLUMNS: [&str; 11] = [
    "map",
    "method",
    "x",
    "y",
    "status",
    "expected",
    "as_expected",
    "time",
    "audit",
    "ledger_residual",
    "steps",
];

/// Arguments of `billow-checks stability`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A map file, as studies/stability.json: runs the cells that are missing. Or the folder of its results: runs
    /// nothing.
    #[arg(value_name = "MAPS")]
    target: PathBuf,
    /// Folder of the results [default: `results/MAPS` under the current folder].
    #[arg(long, value_name = "DIR")]
    results: Option<PathBuf>,
    /// Only these maps, comma-separated.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    maps: Vec<String>,
    /// Draw no pictures.
    #[arg(long)]
    no_pictures: bool,
    #[command(flatten)]
    threads: ThreadsOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Runs `billow-checks stability`: prints the numbers of cells by method and status, the borders and what is not as
/// expected; as csv or json every cell.
///
/// # Errors
/// A map file that is invalid; a signal; a cell that is not as expected, or a border that is not that of theory; a file
/// that cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let only_read = args.target.is_dir();
    let path = if only_read { args.target.join(MAP_FILE) } else { args.target.clone() };
    let (bytes, all) = file::read(&path)?;
    let maps = chosen("--maps", &args.maps, &all, |map| &map.name)?;
    let folder = if only_read {
        args.target.clone()
    } else {
        let usual = || Path::new("results").join(args.target.file_stem().unwrap_or_default());
        args.results.clone().unwrap_or_else(usual)
    };
    let (mut cells, damaged) = stored::read(&folder);
    if damaged && !args.quiet.quiet {
        let folder = folder.display();
        eprintln!("billow-checks: the stored cells of {folder} are of another version or damaged");
    }
    let rig = Rig { instruction_set: instruction_set::selected()?, ..Rig::default() };
    if !only_read {
        Disk.create_folder(&folder).map_err(|error| disk_error(&folder, &error))?;
        let copy = folder.join(MAP_FILE);
        files::write_if_changed(&Disk, &copy, &bytes).map_err(|error| disk_error(&copy, &error))?;
        cells = run_missing(args, &maps, rig, &folder, cells)?;
    }
    report(args, &maps, &cells, rig, &folder, out)
}

/// Runs what is missing. Returns all finished cells.
fn run_missing(args: &Args, maps: &[&Map], rig: Rig, folder: &Path, cells: Cells) -> Result<Cells> {
    let stop = Stop::on_signals().map_err(|error| disk_error(Path::new("signals"), &error))?;
    let running = Running::new(rig, folder, &stop, cells);
    let pool = args.threads.pool()?;
    for map in maps {
        let before = running.cells().len();
        pool.install(|| running.run(map))?;
        if !args.quiet.quiet {
            let ran = running.cells().len() - before;
            eprintln!("billow-checks: map {}: {} run", map.name, count(ran, "cell"));
        }
    }
    Ok(running.cells())
}

/// Prints cells and borders, draws the pictures, and reports what is not as expected.
fn report(
    args: &Args,
    maps: &[&Map],
    cells: &Cells,
    rig: Rig,
    folder: &Path,
    out: &mut dyn Write,
) -> Result<()> {
    let format = args.output.format();
    let (mut rows, mut lines, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
    let (mut pictures, mut all) = (Vec::new(), Vec::new());
    for map in maps.iter().copied() {
        let (found, borders) = (placed(map, cells), borders(map, cells));
        rows.extend(found.iter().map(|placed| row(map, placed)));
        lines.extend(summary(map, &found));
        for border in &borders {
            let text = border_text(map, border).unwrap_or_else(|| no_border(map, border));
            if border.wrong {
                wrong.push(format!("{}: {text}: not the limit of theory", map.name));
            }
            lines.push(format!("  {text}"));
        }
        let unexpected_cells = found.iter().filter(|placed| placed.is_wrong());
        wrong.extend(unexpected_cells.map(|placed| unexpected(map, placed)));
        if !args.no_pictures {
            pictures.push((map.name.clone(), map_picture(map, &found, &borders)));
            let strip = strip(&rig, map, &found);
            pictures.extend(strip.map(|svg| (format!("{}_strip", map.name), svg)));
        }
        all.push((map, found));
    }
    if !args.no_pictures && all.len() > 1 {
        pictures.push(("overview".to_owned(), overview(&all)));
    }
    if format == Format::Table {
        for line in &lines {
            writeln!(out, "{line}").map_err(output_error)?;
        }
    } else {
        print_rows(&COLUMNS, &rows, format, out)?;
    }
    if !pictures.is_empty() {
        draw(folder, pictures, format == Format::Table, out)?;
    }
    match wrong.as_slice() {
        [] => Ok(()),
        all => Err(Error::JobsFailed(format!(
            "{} not as expected:\n  {}\n  next: read the pictures; if the run is right, say so in \"expect\" of the map",
            count(all.len(), "outcome"),
            all.join("\n  ")
        ))),
    }
}

fn no_border(map: &Map, border: &Border) -> String {
    let axis = map.horizontal();
    let other = map.axes.get(1 - axis).map(|axis| axis.parameter.name);
    let at = other.zip(border.at);
    let at = at.map_or(String::new(), |(name, at)| format!(", {name} {}", brief_number(at)));
    let along = map.axes[axis].parameter.name;
    format!("border {}{at}: none along {along}", border.method.name())
}

fn unexpected(map: &Map, placed: &Placed) -> String {
    let (method, expected) = (placed.question.method.name(), placed.expected.join(" or "));
    let (status, place) = placed.cell.as_ref().map_or(("", ""), |cell| (&cell.status, &cell.place));
    let place = if place.is_empty() { String::new() } else { format!(" ({place})") };
    let at = map.at(&placed.at).join(", ");
    format!("{}: {method}, {at}: {status}{place}, expected {expected}", map.name)
}

/// The numbers of cells by status, of each method.
fn summary(map: &Map, found: &[Placed]) -> Vec<String> {
    let mut lines = vec![format!("{}: {}", map.name, count(found.len(), "cell"))];
    for (method, cells) in map.methods.iter().zip(found.chunks(map.places().len())) {
        let mut numbers: Vec<(&str, usize)> = Vec::new();
        for placed in cells {
            let status = placed.cell.as_ref().map_or("not run", |cell| cell.status.as_str());
            match numbers.iter_mut().find(|(known, _)| *known == status) {
                Some((_, number)) => *number += 1,
                None => numbers.push((status, 1)),
            }
        }
        let texts: Vec<String> =
            numbers.iter().map(|(status, number)| format!("{number} {status}")).collect();
        lines.push(format!("  {}: {}", method.name(), texts.join(", ")));
    }
    lines
}

fn row(map: &Map, placed: &Placed) -> Vec<Value> {
    let mut at = map.at(&placed.at).into_iter();
    let mut row: Vec<Value> = vec![
        map.name.as_str().into(),
        placed.question.method.name().into(),
        at.next().into(),
        at.next().into(),
    ];
    let cell = placed.cell.as_ref();
    row.push(cell.map_or("not run", |cell| &cell.status).into());
    row.push(placed.expected.join(" or ").into());
    if let Some(cell) = cell {
        let audit = (!cell.audit.is_empty()).then_some(cell.audit.as_str());
        row.extend([
            if placed.is_wrong() { "no" } else { "yes" }.into(),
            cell.time.into(),
            audit.into(),
            cell.residual.into(),
            cell.steps.into(),
        ]);
    }
    row
}
