//! `billow fold`: one fold design, its numbers and its crease pattern.

use std::io::Write;
use std::path::{Path, PathBuf};

use billow_solver::fold::{Caps, Chirality, Fit, FoldDesign, FoldError, FoldPattern, Nearest};
use billow_solver::mesh::{Mesh, Shape};
use billow_solver::mesh_io::{fold as fold_text, obj};
use clap::ValueEnum;
use serde_json::{Value as Json, json};

use super::print::print_rows;
use super::{Format, Global, output_error};
use crate::error::{Error, InputError, Result};
use crate::files::{Disk, Files, disk_error, write_atomic};
use crate::render::crease_pattern;
use crate::units::{self, Dimension};
use crate::value::Value;

/// Arguments of `billow fold`. A number is SI; a value may carry its unit ("500 mm", "30 deg").
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Which quantities are given: `cone` (top radius, height), `angles` (alpha1/phi and the half
    /// angle, or a nominal top radius and height), `height` (height, alpha1/phi).
    #[arg(long, value_enum, default_value = "cone")]
    fit: FitArg,
    /// N, panels round a ring, at least 4.
    #[arg(long, visible_alias = "N", value_name = "N")]
    panels: u32,
    /// M, storeys.
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
    /// Half top angle.
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    half_angle: Option<String>,
    /// alpha1/phi.
    #[arg(long, value_name = "RATIO", allow_hyphen_values = true)]
    alpha1_over_phi: Option<String>,
    /// Turn of successive storeys.
    #[arg(long, value_enum, default_value = "same")]
    chirality: ChiralityArg,
    /// Height of the stowed stack [default: 40 mm, or the highest this design can be packed to].
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    stowed_height: Option<String>,
    /// n, mesh subdivisions of every facet edge in the .obj shapes.
    #[arg(long, value_name = "n", default_value_t = 8)]
    subdivisions: u32,
    /// Shape of the caps; circular ones for the erected shape only.
    #[arg(long, value_enum, default_value = "polygon")]
    caps: CapsArg,
    /// Folder to write `crease_pattern.fold`, `crease_pattern.svg`, `flat.obj`, `stowed.obj`,
    /// `developed.obj` and `erected.obj` to.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Draw glue flaps of this width in the .svg.
    #[arg(long, value_name = "WIDTH", requires = "out", allow_hyphen_values = true)]
    glue_flaps: Option<String>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum FitArg {
    Cone,
    Angles,
    Height,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ChiralityArg {
    Same,
    Alternate,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum CapsArg {
    Polygon,
    Circular,
}

/// Runs `billow fold`.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let design = design(args)?;
    if args.out.is_some() {
        check_size(&design)?;
    }
    let flap =
        args.glue_flaps.as_deref().map(|text| quantity("--glue-flaps", text, Dimension::Length));
    let flap = flap.transpose()?;
    if let Some(width) = flap
        && width <= 0.0
    {
        return Err(bad("--glue-flaps", &width.to_string(), "is not above 0", "a width above 0"));
    }
    let solved = match solve(&design, args.stowed_height.is_none()) {
        Ok(pattern) => Ok(pattern),
        Err(FoldError::Infeasible { reason, nearest }) => Err((reason, nearest)),
        Err(FoldError::Invalid { key, problem }) => {
            return Err(bad(&flag(key), "", &problem, ""));
        }
    };
    match (global.format(), &solved) {
        (Format::Json, Ok(pattern)) => print_json(&feasible_json(pattern), out)?,
        (Format::Json, Err((reason, nearest))) => {
            print_json(&infeasible_json(&design, reason, nearest), out)?;
        }
        (format, Ok(pattern)) => {
            print_rows(&["quantity", "value", "unit"], &rows(pattern), format, out)?;
        }
        (format, Err((reason, nearest))) => {
            print_rows(
                &["quantity", "value", "unit"],
                &infeasible_rows(reason, nearest),
                format,
                out,
            )?;
        }
    }
    match (&args.out, solved) {
        (Some(folder), Ok(pattern)) => write_files(&Disk, folder, &pattern, flap, global),
        (Some(folder), Err(_)) => {
            eprintln!("billow: infeasible, so nothing is written to {}", folder.display());
            Ok(())
        }
        (None, _) => Ok(()),
    }
}

fn design(args: &Args) -> Result<FoldDesign> {
    let length = |flag: &str, text: &str| quantity(flag, text, Dimension::Length);
    let given = |flag: &str, text: &Option<String>, dimension| {
        text.as_deref().map(|text| quantity(flag, text, dimension)).transpose()
    };
    Ok(FoldDesign {
        fit: match args.fit {
            FitArg::Cone => Fit::Cone,
            FitArg::Angles => Fit::Angles,
            FitArg::Height => Fit::Height,
        },
        panels: args.panels,
        storeys: args.storeys,
        bottom_radius: length("--bottom-radius", &args.bottom_radius)?,
        top_radius: given("--top-radius", &args.top_radius, Dimension::Length)?,
        height: given("--height", &args.height, Dimension::Length)?,
        half_angle: given("--half-angle", &args.half_angle, Dimension::Angle)?,
        alpha1_over_phi: given("--alpha1-over-phi", &args.alpha1_over_phi, Dimension::Number)?,
        chirality: match args.chirality {
            ChiralityArg::Same => Chirality::Same,
            ChiralityArg::Alternate => Chirality::Alternate,
        },
        stowed_height: given("--stowed-height", &args.stowed_height, Dimension::Length)?
            .unwrap_or(STOWED_HEIGHT),
        subdivisions: args.subdivisions,
        caps: match args.caps {
            CapsArg::Polygon => Caps::Polygon,
            CapsArg::Circular => Caps::Circular,
        },
    })
}

/// Height of the stowed stack where none is asked for, m.
const STOWED_HEIGHT: f64 = 0.04;

/// Solves a design; `lower` allows a stack lower than the design's, where that one cannot be packed.
fn solve(design: &FoldDesign, lower: bool) -> std::result::Result<FoldPattern, FoldError> {
    let stowed_at =
        |stowed_height| FoldPattern::new(&FoldDesign { stowed_height, ..design.clone() });
    match FoldPattern::new(design) {
        Err(FoldError::Infeasible { nearest, .. }) if lower => {
            match nearest.iter().find(|near| near.key == "stowed_height") {
                Some(near) => stowed_at(near.value),
                // No height will do, so that of the stack shall keep no nearest value back.
                None => stowed_at(1e-6 * design.bottom_radius),
            }
        }
        solved => solved,
    }
}

/// A flag's value: a plain number is SI, a text carries its unit.
fn quantity(flag: &str, text: &str, dimension: Dimension) -> Result<f64> {
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(bad(flag, text, "is not a finite number", "")),
        Err(_) => units::parse(text, dimension)
            .map_err(|error| bad(flag, text, &error.problem, &error.allowed)),
    }
}

fn bad(flag: &str, value: &str, problem: &str, allowed: &str) -> Error {
    Error::Input(InputError {
        file: "fold".to_owned(),
        key: flag.to_owned(),
        value: value.to_owned(),
        problem: problem.to_owned(),
        allowed: allowed.to_owned(),
        hint: "see `billow fold --help`".to_owned(),
    })
}

/// The flag of a design key.
fn flag(key: &str) -> String {
    match key {
        "N" => "--panels".to_owned(),
        "M" => "--storeys".to_owned(),
        key => format!("--{}", key.replace('_', "-")),
    }
}

fn feasible_json(pattern: &FoldPattern) -> Json {
    let angles = &pattern.angles;
    let lengths = |storey| {
        let l = pattern.lengths(storey);
        json!({ "AB": l.ab, "DE": l.de, "AD": l.ad, "AE": l.ae })
    };
    let design = &pattern.design;
    json!({
        "feasible": true,
        "reason": null,
        "nearest": null,
        "fit": design.fit,
        "N": design.panels,
        "M": design.storeys,
        "chirality": design.chirality,
        "caps": design.caps,
        "alpha1_over_phi": angles.alpha1 / angles.phi,
        "phi": angles.phi,
        "alpha1": angles.alpha1,
        "alpha2": angles.alpha2,
        "beta1": angles.beta1,
        "beta2": angles.beta2,
        "gamma1": angles.gamma1,
        "gamma2": angles.gamma2,
        "theta1": angles.theta1,
        "theta2": angles.theta2,
        "ring_ratio": angles.ring_ratio,
        "half_angle": pattern.half_angle,
        "bottom_radius": pattern.bottom_radius,
        "top_radius": pattern.top_radius,
        "height": pattern.height,
        "closure_defect": pattern.closure_defect(),
        "lengths": lengths(0),
        "storeys": (0..design.storeys).map(|storey| json!({
            "bottom_radius": pattern.ring_radius(storey),
            "polygon_radius": pattern.polygon_radius(storey),
            "opening_radius": pattern.opening_radius(storey),
            "lengths": lengths(storey),
        })).collect::<Vec<_>>(),
        "flat_twist": pattern.flat_twist(),
        "erected_twist": pattern.erected_twist(),
        "stowed_height": design.stowed_height,
        "stowed_volume": pattern.stowed_volume(design.stowed_height),
        "stowed_strain": pattern.stowed_strain(design.stowed_height),
        "erected_volume": pattern.erected_volume(),
        "film_area": pattern.film_area(),
    })
}

fn infeasible_json(design: &FoldDesign, reason: &str, nearest: &[Nearest]) -> Json {
    let mut answer = json!({
        "feasible": false,
        "reason": reason,
        "nearest": nearest
            .iter()
            .map(|near| (near.key.to_owned(), whole(near.value)))
            .collect::<serde_json::Map<_, _>>(),
        "fit": design.fit,
        "N": design.panels,
        "M": design.storeys,
        "bottom_radius": design.bottom_radius,
    });
    // What no pattern defines is there, and null.
    for key in [
        "phi",
        "alpha1",
        "alpha2",
        "beta1",
        "beta2",
        "gamma1",
        "gamma2",
        "theta1",
        "theta2",
        "ring_ratio",
        "half_angle",
        "top_radius",
        "height",
        "closure_defect",
        "lengths",
    ] {
        answer[key] = Json::Null;
    }
    answer
}

/// A whole number without its ".0".
fn whole(value: f64) -> Json {
    #[expect(clippy::cast_possible_truncation, reason = "whole and small, just checked")]
    if value.fract().abs() > 0.0 || value.abs() >= 1e9 { json!(value) } else { json!(value as i64) }
}

fn print_json(answer: &Json, out: &mut dyn Write) -> Result<()> {
    serde_json::to_writer_pretty(&mut *out, answer)
        .map_err(std::io::Error::from)
        .and_then(|()| writeln!(out))
        .map_err(output_error)
}

fn rows(pattern: &FoldPattern) -> Vec<Vec<Value>> {
    let row = |name: &str, value: f64, unit: &str| {
        vec![Value::Text(name.into()), Value::Number(value), Value::Text(unit.into())]
    };
    let angles = &pattern.angles;
    let lengths = pattern.lengths(0);
    let mut rows = vec![vec![Value::Text("feasible".into()), Value::Bool(true), Value::Null]];
    for (name, angle) in [
        ("phi", angles.phi),
        ("alpha1", angles.alpha1),
        ("alpha2", angles.alpha2),
        ("beta1", angles.beta1),
        ("beta2", angles.beta2),
        ("gamma1", angles.gamma1),
        ("gamma2", angles.gamma2),
        ("theta1", angles.theta1),
        ("theta2", angles.theta2),
        ("half_angle", pattern.half_angle),
        ("flat_twist", pattern.flat_twist()),
        ("erected_twist", pattern.erected_twist()),
    ] {
        rows.push(row(name, angle.to_degrees(), "deg"));
    }
    let stowed = pattern.design.stowed_height;
    rows.extend([
        row("alpha1_over_phi", angles.alpha1 / angles.phi, "1"),
        row("ring_ratio", angles.ring_ratio, "1"),
        row("closure_defect", pattern.closure_defect(), "1"),
        row("bottom_radius", pattern.bottom_radius, "m"),
        row("top_radius", pattern.top_radius, "m"),
        row("height", pattern.height, "m"),
        row("AB", lengths.ab, "m"),
        row("DE", lengths.de, "m"),
        row("AD", lengths.ad, "m"),
        row("AE", lengths.ae, "m"),
        row("opening_radius", pattern.opening_radius(pattern.design.storeys - 1), "m"),
        row("stowed_height", stowed, "m"),
        row("stowed_volume", pattern.stowed_volume(stowed), "m3"),
        row("stowed_strain", pattern.stowed_strain(stowed), "1"),
        row("erected_volume", pattern.erected_volume(), "m3"),
        row("film_area", pattern.film_area(), "m2"),
    ]);
    rows
}

fn infeasible_rows(reason: &str, nearest: &[Nearest]) -> Vec<Vec<Value>> {
    let mut rows = vec![
        vec![Value::Text("feasible".into()), Value::Bool(false), Value::Null],
        vec![Value::Text("reason".into()), Value::Text(reason.into()), Value::Null],
    ];
    for near in nearest {
        rows.push(vec![
            Value::Text(format!("nearest {}", near.key)),
            Value::Number(near.value),
            Value::Null,
        ]);
    }
    rows
}

/// Most elements of a shape written as .obj: more would fill the memory and no program opens it.
const MOST_ELEMENTS: u64 = 4_000_000;

fn check_size(design: &FoldDesign) -> Result<()> {
    let [panels, storeys, n] = [design.panels, design.storeys, design.subdivisions].map(u64::from);
    let elements = 2 * panels * (storeys + 1) * n * n;
    if elements <= MOST_ELEMENTS {
        return Ok(());
    }
    let problem = format!("makes shapes of {elements} elements");
    let allowed = format!("fewer: 2 N (M + 1) n² up to {MOST_ELEMENTS}");
    Err(bad("--subdivisions", &n.to_string(), &problem, &allowed))
}

fn write_files(
    files: &dyn Files,
    folder: &Path,
    pattern: &FoldPattern,
    flap: Option<f64>,
    global: &Global,
) -> Result<()> {
    let design = &pattern.design;
    let title = format!("billow: N {} panels, M {} storeys", design.panels, design.storeys);
    let shape = |shape, name: &str| -> Result<String> {
        let mesh = Mesh::new(pattern, design.subdivisions, shape)
            .map_err(|error| bad("--caps", "circular", &error.to_string(), "polygon"))?;
        Ok(obj::mesh(&mesh, &format!("{title}, {name}")))
    };
    let mut texts = vec![("erected.obj", shape(Shape::Erected, "erected")?)];
    if design.caps == Caps::Circular {
        eprintln!("billow: circular caps cannot be folded: only the erected shape is written");
    } else {
        texts.extend([
            ("crease_pattern.fold", fold_text::crease_pattern(pattern, &title)),
            ("crease_pattern.svg", crease_pattern::svg(pattern, flap)),
            ("flat.obj", shape(Shape::Flat, "flat folded")?),
            ("stowed.obj", shape(Shape::Stowed(design.stowed_height), "stowed")?),
            ("developed.obj", obj::developed(pattern, &format!("{title}, developed"))),
        ]);
    }
    files.create_folder(folder).map_err(|error| disk_error(folder, &error))?;
    for (name, text) in &texts {
        let path = folder.join(name);
        write_atomic(files, &path, text.as_bytes()).map_err(|error| disk_error(&path, &error))?;
    }
    if !global.quiet {
        let names: Vec<&str> = texts.iter().map(|(name, _)| *name).collect();
        eprintln!("billow: wrote {} to {}", names.join(", "), folder.display());
    }
    Ok(())
}
