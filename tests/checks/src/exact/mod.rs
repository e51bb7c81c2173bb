//! `billow-checks pareto`: work-precision diagrams of scenes with an exact answer.
//!
//! ```text
//! seconds = wall time on one thread over the simulated time
//! ```
//! The scenes run the code of the cases of the same names at several meshes and steps. Relaxation and set-up before
//! the motion do not count.

use std::io::Write;
use std::path::PathBuf;

use billow_study::analysis::work_precision::{Cost, Diagram, SceneRuns};
use billow_study::chart::work_precision as pictures;
use billow_study::cli::chart::work_precision::print_front;
use billow_study::cli::picture::{self, Picture};
use billow_study::platform::error::{Error, Result};
use billow_study::platform::files::{Disk, Files, disk_error};

use crate::cases::Rig;
use crate::output::{Options, chosen};

mod scenes;

/// A scene: its name, and the function that runs it at every mesh and step, with every integrator that can.
type Scene = (&'static str, fn(&Rig) -> crate::cases::Result<SceneRuns>);

/// Every scene.
const SCENES: [Scene; 3] = [
    ("injected_piston", scenes::injected_piston),
    ("breathing_sphere", scenes::breathing_sphere),
    ("stretched_disc", scenes::stretched_disc),
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

/// Runs `billow-checks pareto`: runs the scenes on one thread, prints the front, in CSV and JSON every configuration,
/// and draws the pictures over element-steps and over seconds.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let rig = Rig::selected()?;
    let mut diagrams = Vec::new();
    for (name, body) in chosen("--scenes", &args.scenes, &SCENES, |(name, _)| name)? {
        args.options.note(&format!("runs the scene {name}"));
        let runs =
            body(&rig).map_err(|problem| Error::JobsFailed(format!("scene {name}: {problem}")))?;
        diagrams.push(Diagram::of(runs));
    }
    let folder = args.out.join("charts");
    Disk.create_folder(&folder).map_err(|error| disk_error(&folder, &error))?;
    for (cost, ending) in [(Cost::Work, ""), (Cost::Seconds, "_seconds")] {
        let scenes =
            diagrams.iter().map(|diagram| (&*diagram.name, pictures::scene(diagram, cost)));
        for (name, svg) in scenes.chain([("exact", pictures::overview(&diagrams, cost))]) {
            for format in Picture::ALL {
                let name = format!("pareto_{name}{ending}.{}", format.extension());
                picture::write(&folder.join(name), &svg)?;
            }
        }
    }
    print_front(&diagrams, Cost::Work, args.options.format(), out)
}
