//! `billow fold`: computes one fold design and writes its crease pattern.

use std::io::Write;
use std::path::{Path, PathBuf};

use billow_solver::geometry::fold::{Caps, Chirality, Fit, FoldDesign, FoldError, FoldPattern};
use billow_solver::geometry::mesh::{Mesh, Shape};
use billow_solver::geometry::mesh_io::{fold as fold_text, obj};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use serde_json::json;

use super::options::{OutputOptions, QuietOption};
use super::{Format, output_error};
use crate::input::json::Json;
use crate::input::keys::{self, CAPS, CHIRALITIES, FITS, Named};
use crate::input::value::{Value, short_number};
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files::{Disk, Files, disk_error, write_output};
use crate::platform::memory;
use crate::print::print_rows;
use crate::render::crease_pattern;

mod answer;

/// Arguments of `billow fold`. A number without a unit is SI; a value can have a unit ("500 mm",
/// "30 deg").
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The given quantities: `cone` (top radius, height), `angles` (alpha1/phi and the half angle,
    /// or a nominal top radius and height), `height` (height, alpha1/phi).
    #[arg(long, value_parser = one_of(&FITS), default_value = "cone")]
    fit: Fit,
    /// N, number of panels of a ring, at least 4.
    #[arg(long, visible_alias = "N", value_name = "N")]
    panels: u32,
    /// M, number of storeys.
    #[arg(long, visible_alias = "M", value_name = "M")]
    storeys: u32,
    /// Radius of the bottom ring.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    bottom_radius: String,
    /// Radius of the top ring.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    top_radius: Option<String>,
    /// Height of the erected cone.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    height: Option<String>,
    /// Half angle of the cone at its apex.
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    half_angle: Option<String>,
    /// Angle ratio alpha1/phi.
    #[arg(long, value_name = "RATIO", allow_hyphen_values = true)]
    alpha1_over_phi: Option<String>,
    /// Direction of rotation of successive storeys.
    #[arg(long, value_parser = one_of(&CHIRALITIES), default_value = "same")]
    chirality: Chirality,
    /// Height of the stowed stack [default: 40 mm, or the largest height that this design can have,
    /// if that is less].
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    stowed_height: Option<String>,
    /// n, number of mesh subdivisions of each facet edge in the .obj shapes.
    #[arg(long, value_name = "n", default_value_t = 8)]
    subdivisions: u32,
    /// Shape of the caps; circular caps exist for the erected shape only.
    #[arg(long, value_parser = one_of(&CAPS), default_value = "polygon")]
    caps: Caps,
    /// Write `crease_pattern.fold`, `crease_pattern.svg`, and meshes with the same faces to this folder: `flat.obj`,
    /// `stowed.obj`, `erected.obj`, and `developed.obj`, the reference of the others. `billow solve` runs the
    /// `scene.json` beside them.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Draw glue flaps of this width in the .svg.
    #[arg(long, value_name = "WIDTH", requires = "out", allow_hyphen_values = true)]
    glue_flaps: Option<String>,
    /// Draw the .svg with a colour on each line as Origami Simulator reads it, and without texts.
    #[arg(long, requires = "out", conflicts_with = "glue_flaps")]
    origami_simulator: bool,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// A parser of the words of a key.
fn one_of<T: Copy + Send + Sync>(words: &'static [Named<T>]) -> impl TypedValueParser<Value = T> {
    let known = words.iter().map(|word| PossibleValue::new(word.name).help(word.meaning));
    PossibleValuesParser::new(known).map(|text| {
        let named = words.iter().find(|word| word.name == text);
        named.unwrap_or_else(|| unreachable!("the parser allows only these words")).value
    })
}

/// Runs `billow fold`. An infeasible design is an answer: it prints the reason and the nearest values.
///
/// # Errors
/// An invalid option; a file that cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let design = design(args)?;
    if args.out.is_some() {
        check_size(&design)?;
    }
    let answer = match solve(&design, args.stowed_height.is_none()) {
        Ok(pattern) => Ok(pattern),
        Err(FoldError::Infeasible { reason, nearest }) => Err((reason, nearest)),
        Err(FoldError::Invalid { key, problem }) => {
            return Err(refused(&option(key), "", &problem, ""));
        }
    };
    let flap = match (&args.glue_flaps, &answer) {
        (Some(text), Ok(pattern)) => Some(flap_width(text, pattern)?),
        _ => None,
    };
    match args.output.format() {
        Format::Json => {
            writeln!(out, "{:#}", answer::json(&design, &answer)).map_err(output_error)?;
        }
        format => {
            print_rows(&["quantity", "value", "unit"], &answer::rows(&answer), format, out)?;
        }
    }
    match (&args.out, answer) {
        (Some(folder), Ok(pattern)) => {
            let drawing = if args.origami_simulator {
                crease_pattern::for_origami_simulator(&pattern)
            } else {
                crease_pattern::svg(&pattern, flap)
            };
            write_files(&Disk, folder, &pattern, drawing, args.quiet.quiet)
        }
        (Some(folder), Err(_)) => {
            eprintln!("billow: infeasible design, nothing is written to {}", folder.display());
            Ok(())
        }
        (None, _) => Ok(()),
    }
}

fn design(args: &Args) -> Result<FoldDesign> {
    let given =
        |key: &str, text: &Option<String>| text.as_deref().map(|text| value(key, text)).transpose();
    Ok(FoldDesign {
        fit: args.fit,
        panels: args.panels,
        storeys: args.storeys,
        bottom_radius: value("bottom_radius", &args.bottom_radius)?,
        top_radius: given("top_radius", &args.top_radius)?,
        height: given("height", &args.height)?,
        half_angle: given("half_angle", &args.half_angle)?,
        alpha1_over_phi: given("alpha1_over_phi", &args.alpha1_over_phi)?,
        chirality: args.chirality,
        stowed_height: given("stowed_height", &args.stowed_height)?
            .unwrap_or(DEFAULT_STOWED_HEIGHT),
        subdivisions: args.subdivisions,
        caps: args.caps,
    })
}

/// Default height of the stowed stack, m.
const DEFAULT_STOWED_HEIGHT: f64 = 0.04;

/// Solves a design. With `lower`, the stack may be lower than in the design if that height is
/// infeasible.
fn solve(design: &FoldDesign, lower: bool) -> std::result::Result<FoldPattern, FoldError> {
    let with_height =
        |stowed_height| FoldPattern::new(&FoldDesign { stowed_height, ..design.clone() });
    match FoldPattern::new(design) {
        Err(FoldError::Infeasible { nearest, .. }) if lower => {
            match nearest.iter().find(|near| near.key == "stowed_height") {
                Some(near) => with_height(near.value),
                // No stowed height is feasible: a tiny one gives the nearest values of the other keys.
                None => with_height(1e-6 * design.bottom_radius),
            }
        }
        solved => solved,
    }
}

/// A key of the design from its option, with the rules of a study file: a number is SI, a text has a unit,
/// and both must be in the range of the key.
fn value(key: &str, text: &str) -> Result<f64> {
    let json = match text.trim().parse::<f64>() {
        Ok(number) => Json::Number(number),
        Err(_) => Json::Text(text.to_owned()),
    };
    let known = keys::find(&format!("design.{key}")).map(|index| &keys::KEYS[index]);
    let refuse = |problem: &str, allowed: &str| Err(refused(&option(key), text, problem, allowed));
    match known.map(|known| known.read(&json)) {
        Some(Ok(Value::Number(number))) if number.is_finite() => Ok(number),
        Some(Err(refusal)) => refuse(&refusal.problem, &refusal.allowed),
        _ => refuse("is not a finite number", ""),
    }
}

/// Width of the glue flaps, m. Their ends are cut at 45°, so a flap needs an edge longer than twice its
/// width; the limit 0.4 of the shortest edge keeps a margin.
fn flap_width(text: &str, pattern: &FoldPattern) -> Result<f64> {
    let width = value("top_radius", text).map_err(|error| match error {
        Error::Input(error) => {
            Error::Input(InputError { file: "--glue-flaps".to_owned(), ..error })
        }
        other => other,
    })?;
    let top = pattern.lengths(pattern.design.storeys - 1);
    let limit = 0.4 * top.de.min(top.ad);
    if width > limit {
        let allowed = format!("up to {limit:.4} m, 0.4 of the shortest edge");
        return Err(refused("--glue-flaps", text, "is too wide", &allowed));
    }
    Ok(width)
}

fn refused(option: &str, value: &str, problem: &str, allowed: &str) -> Error {
    Error::invalid_option(option, value, problem, allowed, "see `billow fold --help`")
}

/// The option of a design key.
fn option(key: &str) -> String {
    match key {
        "N" => "--panels".to_owned(),
        "M" => "--storeys".to_owned(),
        key => format!("--{}", key.replace('_', "-")),
    }
}

/// Most elements of a shape in an .obj file. Chosen: larger files fill the memory, and no program opens
/// them.
const MAX_OBJ_ELEMENTS: u64 = 4_000_000;
/// Memory of an element in the meshes and texts of all shapes, bytes. Measured: 330 to 400.
const OBJ_ELEMENT: u64 = 450;

/// Refuses shapes that are too large for a file, or for the memory of this process.
fn check_size(design: &FoldDesign) -> Result<()> {
    let elements = design.elements();
    let needed = OBJ_ELEMENT * elements;
    let limit = memory::smallest(&memory::limits(), 1);
    let (problem, allowed) = if elements > MAX_OBJ_ELEMENTS {
        (String::new(), format!("2 N (M + 1) n² up to {MAX_OBJ_ELEMENTS} elements"))
    } else if let Some(limit) = limit.filter(|limit| needed > limit.usable_alone()) {
        let usable = memory::size(limit.usable_alone());
        (
            format!(": about {} of memory needed", memory::size(needed)),
            format!("up to {usable}, what the program leaves of {limit}"),
        )
    } else {
        return Ok(());
    };
    let problem = format!("gives shapes with {elements} elements{problem}");
    Err(refused("--subdivisions", &design.subdivisions.to_string(), &problem, &allowed))
}

/// A scene that inflates the stowed shape, held by its bottom ring, for `billow solve`.
fn scene(stowed_height: f64) -> String {
    let held: f64 = short_number(HELD_HEIGHT * stowed_height).parse().unwrap_or_default();
    let json = json!({
        "mesh": {"positions": "stowed.obj", "reference": "developed.obj"},
        "gas": {"windows": [{"mass_flow_rate": "5 g/s"}]},
        "supports": [{"on": "box", "max": [null, null, held], "fix": "xyz"}],
        "solver": {"end_time": "0.3 s"},
        "outputs": {"frames": 20},
    });
    format!("{json:#}\n")
}

/// Height over that of the stack up to which nodes are held. Chosen: far below a layer, far above rounding.
const HELD_HEIGHT: f64 = 1e-4;

fn write_files(
    files: &dyn Files,
    folder: &Path,
    pattern: &FoldPattern,
    drawing: String,
    quiet: bool,
) -> Result<()> {
    let design = &pattern.design;
    let title = format!("billow: N {} panels, M {} storeys", design.panels, design.storeys);
    let mesh = |shape| {
        Mesh::new(pattern, design.subdivisions, shape)
            .map_err(|error| refused("--caps", "circular", &error.to_string(), "polygon"))
    };
    let shape = |shape, name: &str| -> Result<String> {
        Ok(obj::mesh(&mesh(shape)?, &format!("{title}, {name}")))
    };
    let mut texts = vec![("erected.obj", shape(Shape::Erected, "erected")?)];
    if design.caps == Caps::Circular {
        eprintln!("billow: circular caps cannot be folded; only the erected shape is written");
    } else {
        let flat = mesh(Shape::Flat)?;
        texts.extend([
            ("crease_pattern.fold", fold_text::crease_pattern(pattern, &title)),
            ("crease_pattern.svg", drawing),
            ("flat.obj", obj::mesh(&flat, &format!("{title}, flat folded"))),
            ("stowed.obj", shape(Shape::Stowed(design.stowed_height), "stowed")?),
            ("developed.obj", obj::developed(pattern, &flat, &format!("{title}, developed"))),
            ("scene.json", scene(design.stowed_height)),
        ]);
    }
    files.create_folder(folder).map_err(|error| disk_error(folder, &error))?;
    for (name, text) in &texts {
        let path = folder.join(name);
        write_output(files, &path, text.as_bytes()).map_err(|error| disk_error(&path, &error))?;
    }
    if !quiet {
        let names: Vec<&str> = texts.iter().map(|(name, _)| *name).collect();
        eprintln!("billow: wrote {} to {}", names.join(", "), folder.display());
    }
    Ok(())
}
