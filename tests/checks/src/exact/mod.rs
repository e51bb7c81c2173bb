//! `billow-checks pareto`: work-precision diagrams of scenes with an exact answer, or none but their finest mesh.
//!
//! ```text
//! seconds = wall time on one thread over the simulated time;  of a scene at rest, the wall time
//! ```
//! The scenes run the code of the cases of the same names at several meshes and steps. Relaxation and set-up before
//! the motion do not count.

use std::io::Write;
use std::path::PathBuf;

use billow_study::analysis::work_precision::{Cost, Diagram, Member, SceneRuns, label};
use billow_study::chart::work_precision as pictures;
use billow_study::cli::Format;
use billow_study::cli::print::print_rows;
use billow_study::input::value::Value;
use billow_study::platform::error::{Error, Result};

use crate::cases::Rig;
use crate::output::{Options, chosen, draw};

mod airbag;
mod meter;
mod piston;
mod vibrations;

/// A scene: its name, and the function that runs it at every mesh and step, with every integrator that can.
type Scene = (&'static str, fn(&Rig) -> crate::cases::Result<SceneRuns>);

/// Every scene.
const SCENES: [Scene; 4] = [
    ("injected_piston", piston::injected_piston),
    ("breathing_sphere", vibrations::breathing_sphere),
    ("square_airbag", airbag::square_airbag),
    ("stretched_disc", vibrations::stretched_disc),
];

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

/// Arguments of `billow-checks pareto`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder of the pictures.
    #[arg(long, value_name = "DIR", default_value = "results/exact")]
    out: PathBuf,
    /// Only these scenes, comma-separated.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    scenes: Vec<String>,
    #[command(flatten)]
    options: Options,
}

/// Runs `billow-checks pareto`: runs the scenes on one thread, prints every configuration and draws the pictures over
/// element-steps and over seconds.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let rig = Rig::selected()?;
    let mut diagrams = Vec::new();
    for (name, body) in chosen("--scenes", &args.scenes, &SCENES, |(name, _)| name)? {
        args.options.note(&format!("runs the scene {name}"));
        let runs =
            body(&rig).map_err(|problem| Error::JobsFailed(format!("scene {name}: {problem}")))?;
        diagrams.push(Diagram::of(runs));
    }
    let format = args.options.format();
    print_rows(&COLUMNS, &rows(&diagrams), format, out)?;
    let mut drawn = Vec::new();
    for (cost, ending) in [(Cost::Work, ""), (Cost::Seconds, "_seconds")] {
        drawn.push((format!("pareto_exact{ending}"), pictures::overview(&diagrams, cost)));
        drawn.extend(diagrams.iter().map(|diagram| {
            (format!("pareto_{}{ending}", diagram.name), pictures::scene(diagram, cost))
        }));
    }
    draw(&args.out, drawn, format == Format::Table, out)
}

/// One row per configuration, by scene, quantity and element-steps.
fn rows(diagrams: &[Diagram]) -> Vec<Vec<Value>> {
    let mut rows = Vec::new();
    for diagram in diagrams {
        for errors in &diagram.quantities {
            let mut members: Vec<_> = errors.points.iter().zip(&diagram.members).collect();
            members.sort_by(|(_, a), (_, b)| a.work().total_cmp(&b.work()));
            let exact = errors.reference.as_ref().and_then(|reference| reference.value);
            rows.extend(members.into_iter().map(|(point, member): (_, &Member)| {
                let error = point.filter(|point| !point.is_reference);
                vec![
                    diagram.name.as_str().into(),
                    errors.quantity.name.as_str().into(),
                    label(&member.configuration, &[]).into(),
                    point.is_some_and(|point| point.on_front(Cost::Work)).into(),
                    member.ending.name().into(),
                    error.map(|point| point.error.median).into(),
                    point.and_then(|point| point.order).into(),
                    member.work().into(),
                    member.seconds.into(),
                    point.and_then(|point| point.value).into(),
                    exact.into(),
                ]
            }));
        }
    }
    rows
}
