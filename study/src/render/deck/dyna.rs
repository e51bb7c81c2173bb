//! A deck for LS-DYNA as one keyword file, in kg, m, s.
//!
//! Membrane triangles (`ELFORM` 5) with the reference of each element (`AIRBAG_SHELL_REFERENCE_GEOMETRY`), `MAT_FABRIC`,
//! one uniform pressure (`AIRBAG_HYBRID`), contact of the film with itself (`CONTACT_AIRBAG_SINGLE_SURFACE`).

use std::fmt::Write as _;

use super::{Deck, MOLAR_GAS_CONSTANT, VACUUM, number};

/// Compression fraction from which the law keeps the compression stiffness.
const KEEPS_COMPRESSION: f64 = 0.5;
/// First curve of a mass flow rate; those of temperatures follow.
const FIRST_CURVE: usize = 101;
/// Time in which a flow begins or ends, s.
const RAMP: f64 = 1e-8;

/// A card: these fields, ten columns each.
fn card(text: &mut String, fields: &[f64]) {
    for field in fields {
        let _ = write!(text, "{:>10}", number(*field, 9));
    }
    text.push('\n');
}

/// A card of whole numbers, ten columns each.
fn integers(text: &mut String, fields: &[usize]) {
    for field in fields {
        let _ = write!(text, "{field:>10}");
    }
    text.push('\n');
}

/// A set: its number, then members, eight on a line.
fn set(
    text: &mut String,
    keyword: &str,
    title: &str,
    number: usize,
    members: impl Iterator<Item = usize>,
) {
    let _ = writeln!(text, "*{keyword}_TITLE\n{title}\n{number:>10}");
    let members: Vec<usize> = members.collect();
    for line in members.chunks(8) {
        integers(text, line);
    }
}

fn curve(text: &mut String, id: usize, title: &str, points: &[[f64; 2]]) {
    let _ = writeln!(text, "*DEFINE_CURVE_TITLE\n{title}\n{id:>10}{:>10}", 0);
    for [x, y] in points {
        let _ = writeln!(text, "{:>20}{:>20}", number(*x, 19), number(*y, 19));
    }
}

/// The keyword file.
pub fn keyword_file(deck: &Deck<'_>) -> String {
    let mut text = format!("*KEYWORD\n$ {}\n", deck.title);
    for line in deck.differences() {
        let _ = writeln!(text, "$ {line}");
    }
    let _ = writeln!(
        text,
        "$ Damping of the fabric {}, as in the job: a law that cuts compression may gain energy without more.\n\
         $ Time step, mass scaling, contact stiffness and the control of shells are those of the code.\n\
         $ Written from the manual; billow was not run beside LS-DYNA.",
        deck.film.film.numerical_damping
    );
    let _ = writeln!(text, "*TITLE\n{:.80}", deck.title);
    control(&mut text, deck);
    film(&mut text, deck);
    elements(&mut text, deck);
    supports(&mut text, deck);
    gas(&mut text, deck);
    contact(&mut text, deck);
    text.push_str("*END\n");
    text
}

/// End time and what is written.
fn control(text: &mut String, deck: &Deck<'_>) {
    let (end, interval) = (deck.duration(), deck.film.outputs.sample_interval);
    text.push_str("*CONTROL_TERMINATION\n");
    card(text, &[end]);
    text.push_str("*CONTROL_ENERGY\n");
    integers(text, &[2, 2, 2, 2]);
    for keyword in ["ABSTAT", "GLSTAT", "NODOUT"] {
        let _ = writeln!(text, "*DATABASE_{keyword}");
        card(text, &[interval]);
    }
    text.push_str("*DATABASE_BINARY_D3PLOT\n");
    card(text, &[deck.frame_interval()]);
    if !deck.followed.is_empty() {
        text.push_str("*DATABASE_HISTORY_NODE\n");
        let nodes: Vec<usize> = deck.followed.iter().map(|node| *node as usize + 1).collect();
        for line in nodes.chunks(8) {
            integers(text, line);
        }
    }
}

fn film(text: &mut String, deck: &Deck<'_>) {
    let film = &deck.film.film;
    let (stiffness, ratio) = (film.youngs_modulus, film.poisson_ratio);
    let shear = deck.shear_modulus();
    let no_compression = if film.compression < KEEPS_COMPRESSION { 1.0 } else { 0.0 };
    text.push_str("*MAT_FABRIC_TITLE\nfilm\n");
    card(text, &[1.0, film.density, stiffness, stiffness, 0.0, ratio]);
    card(text, &[shear, shear, shear, no_compression, 0.0, 0.0, 0.0, film.numerical_damping]);
    card(text, &[0.0; 8]);
    card(text, &[0.0; 8]);
    card(text, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    text.push_str("*SECTION_SHELL_TITLE\nfilm\n");
    card(text, &[1.0, 5.0, 1.0, 1.0]);
    card(text, &[film.thickness; 4]);
}

/// Nodes, parts, elements and their reference.
fn elements(text: &mut String, deck: &Deck<'_>) {
    text.push_str("*NODE\n");
    for (node, position) in deck.nodes() {
        let _ = write!(text, "{node:>8}");
        for coordinate in position {
            let _ = write!(text, "{:>16}", number(coordinate, 15));
        }
        text.push('\n');
    }
    for (part, _) in deck.parts() {
        let _ = writeln!(text, "*PART\n{}", deck.part_name(part));
        integers(text, &[part as usize, 1, 1]);
    }
    let line = |text: &mut String, element: usize, part: u32, [a, b, c]: [usize; 3]| {
        let _ = writeln!(text, "{:>8}{part:>8}{a:>8}{b:>8}{c:>8}{c:>8}", element + 1);
    };
    text.push_str("*ELEMENT_SHELL\n");
    for (part, elements) in deck.parts() {
        for element in elements {
            let nodes = deck.film.shell.triangles[element].map(|node| node as usize + 1);
            line(text, element, part, nodes);
        }
    }
    text.push_str("*AIRBAG_SHELL_REFERENCE_GEOMETRY\n");
    for (part, elements) in deck.parts() {
        for element in elements {
            let nodes = [0, 1, 2].map(|corner| deck.reference_node(element, corner));
            line(text, element, part, nodes);
        }
    }
    set(text, "SET_PART_LIST", "film", 1, deck.part_numbers());
}

fn supports(text: &mut String, deck: &Deck<'_>) {
    for (index, support) in deck.supports().enumerate() {
        let number = index + 1;
        set(
            text,
            "SET_NODE_LIST",
            support.name,
            number,
            support.nodes.iter().map(|node| *node as usize + 1),
        );
        let [x, y, z] = support.directions.map(usize::from);
        text.push_str("*BOUNDARY_SPC_SET\n");
        integers(text, &[number, 0, x, y, z, 0, 0, 0]);
    }
    for (axis, acceleration) in ["X", "Y", "Z"].iter().zip(deck.film.gravity.iter()) {
        if acceleration.abs() > 0.0 {
            // The acceleration of the frame of reference, against gravity.
            let _ = writeln!(text, "*LOAD_BODY_{axis}\n{:>10}{:>10}", 1, number(-acceleration, 9));
        }
    }
    curve(text, 1, "constant", &[[0.0, 1.0], [1e6, 1.0]]);
}

/// The control volume with its inflow and leak.
fn gas(text: &mut String, deck: &Deck<'_>) {
    let (supply, inflows) = (deck.supply(), deck.inflows());
    let [mass, cp] = deck.molar_mass_and_cp();
    let (pressure, temperature) = (supply.ambient_pressure.max(VACUUM), deck.film.film.temperature);
    let density = pressure / (supply.species.gas_constant * temperature);
    for (index, inflow) in inflows.iter().enumerate() {
        let title = format!("inflow {}, kg/s", index + 1);
        curve(text, FIRST_CURVE + index, &title, &rate(&inflow.mass));
        let title = format!("temperature of inflow {}, K", index + 1);
        curve(
            text,
            FIRST_CURVE + inflows.len() + index,
            &title,
            &[[0.0, inflow.temperature], [1e6, inflow.temperature]],
        );
    }
    text.push_str("*AIRBAG_HYBRID\n");
    card(text, &[1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    card(text, &[temperature, pressure, density, MOLAR_GAS_CONSTANT, 1.0, deck.heat_transfer()]);
    let leaks = supply.leak_area > 0.0;
    let coefficient = if leaks { supply.discharge_coefficient } else { 0.0 };
    card(text, &[coefficient, 0.0, supply.leak_area, 0.0, 0.0, 0.0, 0.0, 0.0]);
    integers(text, &[0, 0, inflows.len(), 0, 0, 0]);
    for (index, _) in inflows.iter().enumerate() {
        let first = if index == 0 { 1.0 } else { 0.0 };
        let _ = write!(
            text,
            "{:>10}{:>10}{:>10}",
            FIRST_CURVE + index,
            FIRST_CURVE + inflows.len() + index,
            ""
        );
        card(text, &[mass, first, cp * mass, 0.0, 0.0]);
        card(text, &[0.0]);
    }
}

/// Mass flow rates over time of a course of masses.
fn rate(mass: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for pair in mass.windows(2) {
        let [[from, before], [to, after]] = [pair[0], pair[1]];
        let rate = (after - before) / (to - from);
        let from = if points.is_empty() { from } else { from + RAMP };
        points.extend([[from, rate], [to, rate]]);
    }
    points
}

fn contact(text: &mut String, deck: &Deck<'_>) {
    let Some(contact) = &deck.film.contact else { return };
    let gap = contact.distance.unwrap_or(0.0);
    text.push_str("*CONTACT_AIRBAG_SINGLE_SURFACE\n");
    card(text, &[1.0, 0.0, 2.0, 0.0]);
    card(text, &[contact.friction, contact.friction]);
    card(text, &[1.0, 1.0, gap, gap, 1.0, 1.0, 1.0, 1.0]);
    card(text, &[2.0]);
}
