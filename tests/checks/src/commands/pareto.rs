//! `billow-checks pareto`: work-precision diagrams of the scenes with an exact answer.

use std::io::Write;
use std::path::{Path, PathBuf};

use billow_study::analysis::work_precision::{Cost, Diagram, SceneRuns, label};
use billow_study::chart::pareto as pictures;
use billow_study::cli::options::{OutputOptions, QuietOption};
use billow_study::cli::picture::{self, Picture};
use billow_study::cli::print::print_rows;
use billow_study::cli::{Format, instruction_set, output_error};
use billow_study::input::value::Value;
use billow_study::platform::error::{Error, Result};
use billow_study::platform::files::{Disk, Files, disk_error};
use billow_study::platform::nearest::did_you_mean;

use crate::cases::Rig;
use crate::cases::work_precision::SCENES;
use crate::exact_runs::from_stored;
use crate::exact_scenes::{self, ExactScene};

/// Arguments of `billow-checks pareto`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder of the results.
    #[arg(long, value_name = "DIR", default_value = "results/exact")]
    results: PathBuf,
    /// Only these scenes, comma-separated.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    scenes: Vec<String>,
    /// The cost of pictures and front: element-steps, or seconds of this machine.
    #[arg(long, value_enum, default_value_t = CostName::Work)]
    cost: CostName,
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

/// Runs `billow-checks pareto`: prints every configuration and draws the pictures.
///
/// # Errors
/// An unknown scene; a scene that fails; a file that cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    for name in &args.scenes {
        let known = || SCENES.iter().map(|scene| scene.name);
        if !known().any(|known| known == name) {
            let near = did_you_mean(name, known()).unwrap_or_default();
            let allowed = known().collect::<Vec<_>>().join(", ");
            return Err(Error::invalid_option("--scenes", name, "unknown scene", allowed, near));
        }
    }
    let diagrams: Vec<Diagram> = scenes(args)?.into_iter().map(Diagram::of).collect();
    let cost = match args.cost {
        CostName::Work => Cost::Work,
        CostName::Seconds => Cost::Seconds,
    };
    let format = args.output.format();
    print(&diagrams, cost, format, out)?;
    for path in draw(&args.results, &diagrams, cost)? {
        if format == Format::Table {
            writeln!(out, "{}", path.display()).map_err(output_error)?;
        }
    }
    Ok(())
}

/// The runs of the scenes that are wanted. What is not stored is run on one thread and stored.
///
/// # Errors
/// A scene that fails; a file that cannot be written.
fn scenes(args: &Args) -> Result<Vec<SceneRuns>> {
    let folder = &args.results;
    Disk.create_folder(folder).map_err(|error| disk_error(folder, &error))?;
    let mut stored = exact_scenes::read(folder);
    let rig = Rig { instruction_set: instruction_set::selected()?, ..Rig::default() };
    let mut found = Vec::new();
    let wanted =
        |name: &str| args.scenes.is_empty() || args.scenes.iter().any(|wanted| wanted == name);
    for scene in SCENES.iter().filter(|scene| wanted(scene.name)) {
        if let Some(known) = stored.iter().find(|known| known.name == scene.name) {
            found.push(from_stored(known));
            continue;
        }
        if !args.quiet.quiet {
            eprintln!("billow-checks: runs the scene {}", scene.name);
        }
        let run: ExactScene = (scene.body)(&rig)
            .map_err(|problem| Error::JobsFailed(format!("scene {}: {problem}", scene.name)))?;
        found.push(from_stored(&run));
        stored.push(run);
        exact_scenes::write(folder, &stored)?;
    }
    Ok(found)
}

/// Columns of the output.
const COLUMNS: [&str; 11] = [
    "scene",
    "quantity",
    "configuration",
    "front",
    "status",
    "error",
    "order",
    "element_steps",
    "seconds",
    "value",
    "reference",
];

/// Prints one row per configuration, by scene, quantity and cost.
fn print(diagrams: &[Diagram], cost: Cost, format: Format, out: &mut dyn Write) -> Result<()> {
    let mut rows: Vec<Vec<Value>> = Vec::new();
    for diagram in diagrams {
        for errors in &diagram.quantities {
            let mut of_quantity: Vec<_> = errors.points.iter().zip(&diagram.members).collect();
            let cost_of =
                |member: &_| billow_study::analysis::work_precision::Member::cost(member, cost);
            of_quantity.sort_by(|(_, a), (_, b)| {
                let cost = |member| cost_of(member).unwrap_or(f64::INFINITY);
                cost(a).total_cmp(&cost(b))
            });
            for (point, member) in of_quantity {
                let error =
                    point.filter(|point| !point.is_reference).map(|point| point.error.median);
                let exact = errors.reference.as_ref().and_then(|reference| reference.value);
                let number = |value: Option<f64>| value.map_or(Value::Null, Value::Number);
                rows.push(vec![
                    Value::Text(diagram.name.clone()),
                    Value::Text(errors.quantity.name.clone()),
                    Value::Text(label(&member.configuration, &[])),
                    Value::Bool(point.is_some_and(|point| point.on_front(cost))),
                    Value::Text(member.ending.name().to_owned()),
                    number(error),
                    number(point.and_then(|point| point.order)),
                    Value::Number(member.work()),
                    number(member.seconds),
                    number(point.and_then(|point| point.value)),
                    number(exact),
                ]);
            }
        }
    }
    print_rows(&COLUMNS, &rows, format, out)
}

/// Writes the pictures of the scenes and the overview. Returns their paths.
///
/// # Errors
/// A picture that cannot be written.
fn draw(folder: &Path, diagrams: &[Diagram], cost: Cost) -> Result<Vec<PathBuf>> {
    let folder = folder.join("charts");
    Disk.create_folder(&folder).map_err(|error| disk_error(&folder, &error))?;
    let ending = if cost == Cost::Seconds { "_seconds" } else { "" };
    let overview = ("pareto_exact".to_owned(), pictures::overview(diagrams, cost));
    let each = diagrams
        .iter()
        .map(|diagram| (format!("pareto_{}", diagram.name), pictures::scene(diagram, cost, None)));
    let mut written = Vec::new();
    for (name, svg) in std::iter::once(overview).chain(each) {
        for format in Picture::ALL {
            let path = folder.join(format!("{name}{ending}.{}", format.extension()));
            picture::write(&path, &svg)?;
            written.push(path);
        }
    }
    Ok(written)
}
