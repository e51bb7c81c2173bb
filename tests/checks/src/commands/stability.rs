//! `billow-checks stability`: the map of where each method of integration fails.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::cases::Rig;
use crate::stability::file::Map;
use crate::stability::map::{Border, Placed, Running, borders, placed};
use crate::stability::picture::{border_text, map as map_picture, overview, strip};
use crate::stability::read;
use crate::stability::stored::{self, Cells, MAP_FILE};
use billow_study::cli::options::{OutputOptions, QuietOption, ResultsOption, ThreadsOption};
use billow_study::cli::picture::{self, Picture};
use billow_study::cli::print::{count, print_rows};
use billow_study::cli::{Format, instruction_set, output_error};
use billow_study::input::value::{Value, brief_number};
use billow_study::platform::error::{Error, Result};
use billow_study::platform::files::{self, Disk, Files, disk_error};
use billow_study::platform::nearest::did_you_mean;
use billow_study::platform::stop::Stop;

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
    /// Only these maps, comma-separated.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    maps: Vec<String>,
    /// Print every cell, not only their numbers by method and status, the borders and what is not as expected.
    #[arg(long)]
    all: bool,
    /// Draw no pictures.
    #[arg(long)]
    no_pictures: bool,
    #[command(flatten)]
    results: ResultsOption,
    #[command(flatten)]
    threads: ThreadsOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Runs `billow-checks stability`.
///
/// # Errors
/// A map file that is invalid; a signal; a cell that is not as expected, or a border that is not that of theory; a file
/// that cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let only_read = args.target.is_dir();
    let path = if only_read { args.target.join(MAP_FILE) } else { args.target.clone() };
    let (bytes, mut maps) = read::read(&path)?;
    choose(&mut maps, &args.maps)?;
    let folder = match &args.results.results {
        Some(folder) if !only_read => folder.clone(),
        _ if only_read => args.target.clone(),
        _ => {
            let name = args.target.file_stem().unwrap_or_default();
            Path::new("results").join(name)
        }
    };
    let (mut cells, damaged) = stored::read(&folder);
    if damaged && !args.quiet.quiet {
        eprintln!(
            "billow-checks: the stored cells of {} are of another version or damaged",
            folder.display()
        );
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

/// Keeps the maps of these names; all without names.
fn choose(maps: &mut Vec<Map>, names: &[String]) -> Result<()> {
    for name in names {
        let known: Vec<&str> = maps.iter().map(|map| map.name.as_str()).collect();
        if !known.contains(&name.as_str()) {
            let near = did_you_mean(name, known.iter().copied()).unwrap_or_default();
            return Err(Error::invalid_option(
                "--maps",
                name,
                "no map of the file",
                known.join(", "),
                near,
            ));
        }
    }
    maps.retain(|map| names.is_empty() || names.contains(&map.name));
    Ok(())
}

/// Runs what is missing. Returns all finished cells.
fn run_missing(args: &Args, maps: &[Map], rig: Rig, folder: &Path, cells: Cells) -> Result<Cells> {
    let stop = Stop::on_signals().map_err(|error| disk_error(Path::new("signals"), &error))?;
    let running = Running::new(rig, folder, &stop, cells);
    let pool = args.threads.pool()?;
    if !args.quiet.quiet {
        let cells: usize = maps.iter().map(|map| map.methods.len() * map.places().len()).sum();
        let known = running.cells().len();
        eprintln!(
            "billow-checks: {} with {}, and those of borders; {known} stored",
            count(maps.len(), "map"),
            count(cells, "cell")
        );
    }
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
    maps: &[Map],
    cells: &Cells,
    rig: Rig,
    folder: &Path,
    out: &mut dyn Write,
) -> Result<()> {
    let format = args.output.format();
    let (mut rows, mut lines, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
    let mut all = Vec::new();
    for map in maps {
        let (found, borders) = (placed(map, cells), borders(map, cells));
        rows.extend(found.iter().map(|placed| row(map, placed)));
        lines.extend(summary(map, &found));
        for border in &borders {
            let text = border_text(map, border);
            if border.wrong {
                let text = text.clone().unwrap_or_else(|| no_border(map, border));
                wrong.push(format!("{}: {text}: not the limit of theory", map.name));
            }
            lines.push(format!("  {}", text.unwrap_or_else(|| no_border(map, border))));
        }
        wrong.extend(
            found.iter().filter(|placed| placed.is_wrong()).map(|one| unexpected(map, one)),
        );
        if !args.no_pictures {
            let of_map = map_picture(map, &found, &borders);
            let pictures = [
                (map.name.clone(), Some(of_map)),
                (format!("{}_strip", map.name), strip(&rig, map, &found)),
            ];
            lines.extend(draw(pictures, folder)?);
        }
        all.push((map, found));
    }
    if !args.no_pictures && all.len() > 1 {
        lines.extend(draw([("overview".to_owned(), Some(overview(&all)))], folder)?);
    }
    if args.all || format != Format::Table {
        print_rows(&COLUMNS, &rows, format, out)?;
    }
    if format == Format::Table {
        for line in &lines {
            writeln!(out, "{line}").map_err(output_error)?;
        }
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
    let (other, at) = (map.axes.iter().rev(), border.at);
    let search = map.search.map(|search| map.axes[search.axis].parameter.name);
    let other = other.map(|axis| axis.parameter.name).find(|name| Some(*name) != search);
    let at =
        other.zip(at).map_or(String::new(), |(name, at)| format!(", {name} {}", brief_number(at)));
    format!("border {}{at}: none along {}", border.method.name(), search.unwrap_or_default())
}

fn unexpected(map: &Map, placed: &Placed) -> String {
    let at = map.axes.iter().zip(&placed.at);
    let at: Vec<String> =
        at.map(|(axis, value)| format!("{} {value}", axis.parameter.name)).collect();
    let (method, expected) = (placed.question.method.name(), placed.expected.join(" or "));
    let status = placed.cell.as_ref().map_or("", |cell| cell.status.as_str());
    let place = placed.cell.as_ref().map_or("", |cell| cell.place.as_str());
    let place = if place.is_empty() { String::new() } else { format!(" ({place})") };
    format!("{}: {method}, {}: {status}{place}, expected {expected}", map.name, at.join(", "))
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
    let text = |text: &str| Value::Text(text.to_owned());
    let axis = |index: usize| match (map.axes.get(index), placed.at.get(index)) {
        (Some(axis), Some(value)) => Value::Text(format!("{} {value}", axis.parameter.name)),
        _ => Value::Null,
    };
    let mut row = vec![text(&map.name), text(placed.question.method.name()), axis(0), axis(1)];
    let expected = Value::Text(placed.expected.join(" or "));
    let Some(cell) = &placed.cell else {
        row.extend([text("not run"), expected]);
        row.extend(vec![Value::Null; COLUMNS.len() - row.len()]);
        return row;
    };
    let or_null = |word: &str| if word.is_empty() { Value::Null } else { text(word) };
    let residual = cell.residual.map_or(Value::Null, Value::Number);
    row.extend([
        text(&cell.status),
        expected,
        text(if placed.is_wrong() { "no" } else { "yes" }),
        Value::Number(cell.time),
        or_null(&cell.audit),
        residual,
        Value::Integer(i64::try_from(cell.steps).unwrap_or(i64::MAX)),
    ]);
    row
}

/// Writes pictures under their names. Returns their paths as lines.
fn draw(
    pictures: impl IntoIterator<Item = (String, Option<String>)>,
    folder: &Path,
) -> Result<Vec<String>> {
    let folder = folder.join("charts");
    Disk.create_folder(&folder).map_err(|error| disk_error(&folder, &error))?;
    let mut lines = Vec::new();
    for (name, svg) in pictures {
        let Some(svg) = svg else { continue };
        for format in Picture::ALL {
            let path = folder.join(format!("{name}.{}", format.extension()));
            picture::write(&path, &svg)?;
            lines.push(format!("  {}", path.display()));
        }
    }
    Ok(lines)
}
