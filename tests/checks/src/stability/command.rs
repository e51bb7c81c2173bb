//! `billow-checks stability`: the map of where each method of integration fails.

use std::io::Write;
use std::path::{Path, PathBuf};

use billow_study::cli::options::ThreadsOption;
use billow_study::cli::print::{count, print_rows};
use billow_study::cli::{Format, output_error};
use billow_study::input::value::{Value, brief_number};
use billow_study::platform::error::{Error, Result};
use billow_study::platform::files::{Disk, Files, disk_error};
use billow_study::platform::stop::Stop;

use super::file::{self, Map};
use super::map::{Border, Cells, FinishedMap, Placed};
use super::picture;
use crate::cases::Rig;
use crate::output::{Options, chosen, draw};

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
    /// A map file, as studies/stability.json. Runs the cells that are missing in the results.
    #[arg(value_name = "MAPS")]
    maps_file: PathBuf,
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
    options: Options,
}

/// Runs `billow-checks stability`: prints the numbers of cells by method and status, the borders and what is not as
/// expected; as csv or json every cell.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let all = file::read(&args.maps_file)?;
    let maps = chosen("--maps", &args.maps, &all, |map| &map.name)?;
    let usual = || Path::new("results").join(args.maps_file.file_stem().unwrap_or_default());
    let folder = args.results.clone().unwrap_or_else(usual);
    Disk.create_folder(&folder).map_err(|error| disk_error(&folder, &error))?;
    let stop = Stop::on_signals().map_err(|error| disk_error(Path::new("signals"), &error))?;
    let rig = Rig::selected()?;
    let (cells, damaged) = Cells::open(rig, folder.join("cells.json"), &stop);
    if damaged {
        let folder = folder.display();
        args.options
            .note(&format!("the stored cells of {folder} are of another version or damaged"));
    }
    let pool = args.threads.pool()?;
    let mut finished = Vec::new();
    for map in maps {
        let before = cells.len();
        finished.push(pool.install(|| cells.run(map))?);
        args.options.note(&format!(
            "map {}: {} run",
            map.name,
            count(cells.len() - before, "cell")
        ));
    }
    report(args, &finished, &folder, out)
}

/// Prints cells and borders, draws the pictures, and reports what is not as expected.
fn report(args: &Args, maps: &[FinishedMap<'_>], folder: &Path, out: &mut dyn Write) -> Result<()> {
    let format = args.options.format();
    let (mut rows, mut lines, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
    for finished in maps {
        let map = finished.map;
        rows.extend(finished.cells.iter().map(|placed| row(map, placed)));
        lines.extend(summary(finished));
        for border in &finished.borders {
            let text = border_text(map, border);
            if border.is_wrong {
                wrong.push(format!("{}: {text}: not the limit of theory", map.name));
            }
            lines.push(format!("  {text}"));
        }
        let unexpected_cells = finished.cells.iter().filter(|placed| placed.is_wrong());
        wrong.extend(unexpected_cells.map(|placed| unexpected(map, placed)));
    }
    if format == Format::Table {
        for line in &lines {
            writeln!(out, "{line}").map_err(output_error)?;
        }
    } else {
        print_rows(&COLUMNS, &rows, format, out)?;
    }
    if !args.no_pictures {
        let of_map =
            |finished: &FinishedMap<'_>| (finished.map.name.clone(), picture::of_map(finished));
        draw(folder, maps.iter().map(of_map), format == Format::Table, out)?;
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

/// A border in words.
fn border_text(map: &Map, border: &Border) -> String {
    let axis = map.horizontal();
    let (along, method) = (&map.axes[axis].0, border.method.name());
    let at = border
        .at
        .map_or(String::new(), |at| format!(", {} {}", map.axes[1 - axis].0, brief_number(at)));
    let Some(value) = border.value else {
        return format!("border {method}{at}: none along {along}");
    };
    let theory =
        border.of_theory.map_or(String::new(), |ratio| format!(", {ratio:.4} of 2/omega_max"));
    format!("border {method}{at}: {along} {} ({}){theory}", brief_number(value), border.status)
}

fn unexpected(map: &Map, placed: &Placed) -> String {
    let (method, expected) = (placed.method.name(), placed.expected.join(" or "));
    let (status, place) = (&placed.cell.status, &placed.cell.place);
    let place = if place.is_empty() { String::new() } else { format!(" ({place})") };
    let at = map.at(&placed.at).join(", ");
    format!("{}: {method}, {at}: {status}{place}, expected {expected}", map.name)
}

/// The numbers of cells by status, of each method.
fn summary(finished: &FinishedMap<'_>) -> Vec<String> {
    let map = finished.map;
    let mut lines = vec![format!("{}: {}", map.name, count(finished.cells.len(), "cell"))];
    for (method, cells) in map.methods.iter().zip(finished.cells.chunks(map.places().len())) {
        let mut numbers: Vec<(&str, usize)> = Vec::new();
        for placed in cells {
            let status = placed.cell.status.as_str();
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
    let cell = &placed.cell;
    let audit = (!cell.audit.is_empty()).then_some(cell.audit.as_str());
    vec![
        map.name.as_str().into(),
        placed.method.name().into(),
        at.next().into(),
        at.next().into(),
        cell.status.as_str().into(),
        placed.expected.join(" or ").into(),
        if placed.is_wrong() { "no" } else { "yes" }.into(),
        cell.time.into(),
        audit.into(),
        cell.residual.into(),
        cell.steps.into(),
    ]
}
