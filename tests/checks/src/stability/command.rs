//! `billow-checks stability`: the map of where each method of integration fails.

use std::io::Write;
use std::path::{Path, PathBuf};

use billow_study::cli::options::ThreadsOption;
use billow_study::input::value::Value;
use billow_study::job::Status;
use billow_study::platform::error::{Error, Result};
use billow_study::platform::files::{Disk, Files, disk_error, write_output};
use billow_study::print::Format;
use billow_study::print::{count, print_rows};

use super::file::{self, Map};
use super::map::{Border, FinishedMap, Placed};
use super::picture;
use crate::cases::Rig;
use crate::output::{Options, chosen};

/// Columns of the file of cells, and of the borders.
const CELLS: &str = "map,method,x,y,status,expected,as_expected,time,audit,ledger_residual,steps";
const BORDERS: &str = "map,method,at,along,border,status,of_theory";

/// Arguments of `billow-checks stability`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A map file, as studies/stability.json.
    #[arg(value_name = "MAPS")]
    maps_file: PathBuf,
    /// Folder of the results [default: `results/MAPS` under the current folder].
    #[arg(long, value_name = "DIR")]
    results: Option<PathBuf>,
    /// Only these maps, comma-separated.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    maps: Vec<String>,
    #[command(flatten)]
    threads: ThreadsOption,
    #[command(flatten)]
    options: Options,
}

/// Runs `billow-checks stability`: prints the borders, writes them and every cell as CSV and a picture of each map, and
/// reports what is not as expected.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let all = file::read(&args.maps_file)?;
    let maps = chosen("--maps", &args.maps, &all, |map| &map.name)?;
    let usual = || Path::new("results").join(args.maps_file.file_stem().unwrap_or_default());
    let folder = args.results.clone().unwrap_or_else(usual);
    Disk.create_folder(&folder).map_err(|error| disk_error(&folder, &error))?;
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        write_output(&Disk, &path, bytes).map_err(|error| disk_error(&path, &error))
    };
    let (rig, pool) = (Rig::selected()?, args.threads.pool()?);
    let (mut cells, mut borders, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
    for map in maps {
        let finished = pool.install(|| FinishedMap::run(&rig, map));
        let done = finished.cells.iter().filter(|placed| placed.cell.status == Status::Done);
        let (done, all) = (done.count(), count(finished.cells.len(), "cell"));
        args.options.note(&format!("map {}: {all}, {done} done", map.name));
        cells.extend(finished.cells.iter().map(|placed| cell_row(map, placed)));
        borders.extend(finished.borders.iter().map(|border| border_row(map, border)));
        let wrong_borders = finished.borders.iter().filter(|border| border.is_wrong);
        wrong.extend(wrong_borders.map(|border| {
            let ratio = border.of_theory.unwrap_or(f64::NAN);
            format!("{}: {}: {ratio:.4} of the limit of theory", map.name, border.method.name())
        }));
        let wrong_cells = finished.cells.iter().filter(|placed| placed.is_wrong());
        wrong.extend(wrong_cells.map(|placed| unexpected(map, placed)));
        write(&format!("{}.svg", map.name), picture::of_map(&finished).as_bytes())?;
    }
    for (name, columns, rows) in [("cells.csv", CELLS, &cells), ("borders.csv", BORDERS, &borders)]
    {
        let mut text = Vec::new();
        print(columns, rows, Format::Csv, &mut text)?;
        write(name, &text)?;
    }
    print(BORDERS, &borders, args.options.format(), out)?;
    match wrong.as_slice() {
        [] => Ok(()),
        all => Err(Error::JobsFailed(format!(
            "{} not as expected:\n  {}\n  next: read the pictures; if the run is right, say so in \"expect\" of the map",
            count(all.len(), "outcome"),
            all.join("\n  ")
        ))),
    }
}

fn print(columns: &str, rows: &[Vec<Value>], format: Format, out: &mut dyn Write) -> Result<()> {
    print_rows(&columns.split(',').collect::<Vec<_>>(), rows, format, out)
}

fn border_row(map: &Map, border: &Border) -> Vec<Value> {
    let at = map.axes.get(1).zip(border.at).map(|((name, _), value)| format!("{name} {value}"));
    vec![
        map.name.as_str().into(),
        border.method.name().into(),
        at.into(),
        map.axes[0].0.as_str().into(),
        border.change.map(|(value, _)| value).into(),
        border.change.map(|(_, status)| status.name()).into(),
        border.of_theory.into(),
    ]
}

/// The names of what is expected of a cell.
fn expected(placed: &Placed) -> String {
    let names: Vec<&str> = placed.expected.iter().map(|expected| expected.name()).collect();
    names.join(" or ")
}

fn unexpected(map: &Map, placed: &Placed) -> String {
    let (method, status, place) =
        (placed.method.name(), placed.cell.status.name(), &placed.cell.place);
    let place = if place.is_empty() { String::new() } else { format!(" ({place})") };
    let at = map.at(&placed.at).join(", ");
    format!("{}: {method}, {at}: {status}{place}, expected {}", map.name, expected(placed))
}

fn cell_row(map: &Map, placed: &Placed) -> Vec<Value> {
    let mut at = map.at(&placed.at).into_iter();
    let cell = &placed.cell;
    vec![
        map.name.as_str().into(),
        placed.method.name().into(),
        at.next().into(),
        at.next().into(),
        cell.status.name().into(),
        expected(placed).into(),
        if placed.is_wrong() { "no" } else { "yes" }.into(),
        cell.time.into(),
        Some(cell.audit).filter(|audit| !audit.is_empty()).into(),
        cell.residual.into(),
        cell.steps.into(),
    ]
}
