//! How a failing run of a map looks.
//!
//! ```text
//! colour = log10 of the mean speed of the nodes of an element
//! ```

use billow_solver::models::run::Model as _;
use billow_solver::output::audit_kind::AuditKind;
use billow_solver::output::frames::Frame;

use super::words::{rough, short_time, two_digits};
use crate::cases::Rig;
use crate::stability::cell::{self, Cell, Shape};
use crate::stability::file::Map;
use crate::stability::map::Placed;
use billow_study::input::value::brief_number;
use billow_study::render::filmstrip::{Colour, Filmstrip, Quantity};
use billow_study::render::projection::View;

/// Shapes of a strip.
const SHAPES: u64 = 6;
/// Decades of speed that colours show. Chosen: below, film is at rest beside the fastest node.
const DECADES: f64 = 6.0;
/// Largest displacement of a sheet over its size, below which it is drawn larger, and its size then. Chosen.
const INVISIBLE: f64 = 0.02;
const VISIBLE: f64 = 0.1;

/// The strip of the first failing run that the map names, as SVG; `None` without one that has shapes.
pub fn strip(rig: &Rig, map: &Map, cells: &[Placed]) -> Option<String> {
    let (placed, found) = chosen(map, cells)?;
    let (film, shapes) = cell::shapes(rig, &placed.question, found, SHAPES)?;
    if shapes.is_empty() {
        return None;
    }
    let (triangles, storeys) = film.surface();
    let values: Vec<Vec<String>> = shapes.iter().map(texts).collect();
    let mut frames: Vec<Frame> = shapes.into_iter().map(|shape| shape.frame).collect();
    let colour = speeds(&triangles, &frames).map_or(Colour::Regime, Colour::Quantity);
    // The ledger is judged after the run: shapes go on to its end.
    let what =
        if found.audit == AuditKind::EnergyLedger.name() { "failed from" } else { "ended at" };
    let mut notes = vec![format!("{what} {} s: {}", brief_number(found.time), found.place)];
    if map.scene.name == "sheet"
        && let Some(factor) = enlarge(&mut frames)
    {
        notes.push(format!("displacements {} times as large", brief_number(factor)));
    }
    let at = map.axes.iter().zip(&placed.at);
    let at: Vec<String> = at
        .map(|(axis, value)| {
            format!("{} {} ({})", axis.parameter.name, brief_number(*value), axis.parameter.unit)
        })
        .collect();
    let method = placed.question.method.name();
    let title = format!("{}: {method}, {}: {}", map.name, at.join(", "), found.status);
    let strip = Filmstrip {
        title: &title,
        triangles: &triangles,
        storeys: &storeys,
        frames: &frames,
        view: View::new(30.0_f64.to_radians(), 20.0_f64.to_radians()),
        colour,
        values: &values,
        notes: &notes,
    };
    Some(strip.svg())
}

/// The cell whose run is shown.
fn chosen<'a>(map: &Map, cells: &'a [Placed]) -> Option<(&'a Placed, &'a Cell)> {
    let choice = map.strip.as_ref()?;
    let mut found = cells.iter().filter_map(|placed| Some((placed, placed.cell.as_ref()?)));
    found.find(|(placed, cell)| !cell.is_done() && cell.steps > 0 && choice.holds(&placed.question))
}

/// Time, largest speed and ledger residual of a shape.
fn texts(shape: &Shape) -> Vec<String> {
    let speed = |v: &[f32; 3]| v.map(f64::from).iter().map(|x| x * x).sum::<f64>().sqrt();
    let fastest = shape.frame.velocities.iter().map(speed).fold(0.0, f64::max);
    let fastest = format!("fastest node {} m/s", brief_number(two_digits(fastest)));
    vec![
        short_time(shape.frame.time),
        fastest,
        format!("ledger residual {}", rough(shape.residual)),
    ]
}

/// The speed of each element; `None` for film at rest.
fn speeds(triangles: &[[u32; 3]], frames: &[Frame]) -> Option<Quantity> {
    let of_element = |frame: &Frame, triangle: &[u32; 3]| {
        let of_node = |node: &u32| {
            let velocity = frame.velocities.get(*node as usize).copied().unwrap_or_default();
            velocity.map(f64::from).iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        triangle.iter().map(of_node).sum::<f64>() / 3.0
    };
    let of_frame = |frame: &Frame| -> Vec<f64> {
        triangles.iter().map(|triangle| of_element(frame, triangle)).collect()
    };
    let all: Vec<Vec<f64>> = frames.iter().map(of_frame).collect();
    let fastest = all.iter().flatten().copied().fold(0.0, f64::max);
    if !(fastest > 0.0 && fastest.is_finite()) {
        return None;
    }
    let high = libm::ceil(libm::log10(fastest));
    let moving = all.iter().flatten().copied().filter(|speed| *speed > 0.0);
    let low = libm::floor(libm::log10(moving.fold(fastest, f64::min)));
    let low = low.max(high - DECADES).min(high - 1.0);
    // Film at rest has the lowest colour.
    let scaled = |speed: &f64| libm::log10(speed.max(f64::MIN_POSITIVE));
    let values = all.iter().map(|speeds| speeds.iter().map(scaled).collect()).collect();
    Some(Quantity { label: "log10 of the speed in m/s".to_owned(), values, range: [low, high] })
}

/// Draws displacements from the first shape larger where they are not visible. Returns the factor.
fn enlarge(frames: &mut [Frame]) -> Option<f64> {
    let start = frames.first()?.positions.clone();
    let distance = |a: &[f32; 3], b: &[f32; 3]| {
        let squares = a.iter().zip(b).map(|(a, b)| f64::from(a - b) * f64::from(a - b));
        squares.sum::<f64>().sqrt()
    };
    let size = start.iter().map(|x| distance(x, &start[0])).fold(0.0, f64::max);
    let moved = frames.iter().flat_map(|frame| frame.positions.iter().zip(&start));
    let largest = moved.map(|(x, start)| distance(x, start)).fold(0.0, f64::max);
    if largest <= 0.0 || largest > INVISIBLE * size {
        return None;
    }
    let factor = VISIBLE * size / largest;
    // Positions in single precision cannot show less.
    if factor > 1e5 {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, reason = "positions are single precision")]
    let single = factor as f32;
    for frame in frames {
        for (x, start) in frame.positions.iter_mut().zip(&start) {
            for (x, start) in x.iter_mut().zip(start) {
                *x = start + single * (*x - start);
            }
        }
    }
    Some(factor)
}
