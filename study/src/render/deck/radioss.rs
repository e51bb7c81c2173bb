//! A deck for Radioss, in kg, m, s: `NAME_0000.rad` for its starter, `NAME_0001.rad` for its engine.
//!
//! Shells with the reference of each element (`/EREF`) and total strain (`Ismstr` 11), fabric (`LAW19`), one uniform
//! pressure (`/MONVOL/AIRBAG1`), contact of the film with itself (`/INTER/TYPE7`).

use std::fmt::Write as _;

use super::{Deck, VACUUM, wide};

/// Version of the input format.
const FORMAT: u32 = 2024;
/// Smallest part of the compression stiffness that the law keeps.
const MIN_COMPRESSION: f64 = 1e-3;
/// Damping ratio of the membrane where the law cuts compression. Such a law has no potential, and gained energy without
/// it: measured with the job of docs/guide/decks.md.
const DAMPING: f64 = 0.05;
/// A coefficient that is to be small, because 0 means a default.
const SMALL: f64 = 1e-6;

/// Damping ratio of the membrane.
fn damping(deck: &Deck<'_>) -> f64 {
    let film = &deck.film.film;
    let least = if film.compression < 1.0 { DAMPING } else { SMALL };
    film.numerical_damping.max(least)
}

/// Lines of nodes, ten each.
fn node_lines(text: &mut String, nodes: impl Iterator<Item = usize>) {
    let nodes: Vec<usize> = nodes.collect();
    for line in nodes.chunks(10) {
        for node in line {
            let _ = write!(text, "{node:>10}");
        }
        text.push('\n');
    }
}

/// The input of the starter.
pub fn starter_file(deck: &Deck<'_>) -> String {
    let mut text = format!("#RADIOSS STARTER\n# {}\n", deck.title);
    for line in deck.differences() {
        let _ = writeln!(text, "# {line}");
    }
    let (here, job) = (damping(deck), deck.film.film.numerical_damping);
    let _ = writeln!(text, "# Damping ratio of the membrane {here}; the job has {job}.");
    let _ = writeln!(text, "/BEGIN\n{}\n{FORMAT:>10}{:>10}", deck.name, 0);
    for _ in 0..2 {
        let _ = writeln!(text, "{:>20}{:>20}{:>20}", "kg", "m", "s");
    }
    let _ = writeln!(text, "/TITLE\n{:.100}", deck.title);
    film(&mut text, deck);
    elements(&mut text, deck);
    supports(&mut text, deck);
    gas(&mut text, deck);
    contact(&mut text, deck);
    outputs(&mut text, deck);
    text.push_str("/END\n");
    text
}

/// Law and section of the film.
fn film(text: &mut String, deck: &Deck<'_>) {
    let film = &deck.film.film;
    let (stiffness, ratio) = (film.youngs_modulus, film.poisson_ratio);
    let shear = deck.shear_modulus();
    let compression = film.compression.max(MIN_COMPRESSION);
    let damping = damping(deck);
    let _ = write!(
        text,
        "/MAT/LAW19/1\nfilm\n{}\n{}\n{}\n{}{:>20}{:>20}{:>10}\n",
        wide(&[film.density]),
        wide(&[stiffness, stiffness, ratio]),
        wide(&[shear, shear, shear]),
        wide(&[compression, 0.0]),
        0,
        0,
        0
    );
    let _ = write!(
        text,
        "/PROP/TYPE9/1\nfilm\n{:>10}{:>10}{:>10}{:>10}\n{}\n{:>10}{:>10}{}{:>20}{:>10}{:>10}{:>10}\n{}{:>10}{:>10}\n",
        0,
        11,
        0,
        0,
        wide(&[0.0, 0.0, 0.0, damping, SMALL]),
        1,
        1,
        wide(&[film.thickness]),
        0,
        0,
        0,
        0,
        wide(&[1.0, 0.0, 0.0, 0.0]),
        0,
        0
    );
}

/// Nodes, parts, elements and their reference.
fn elements(text: &mut String, deck: &Deck<'_>) {
    text.push_str("/NODE\n");
    for (number, position) in deck.nodes() {
        let _ = writeln!(text, "{number:>10}{}", wide(&position));
    }
    for (part, elements) in deck.parts() {
        let name = deck.part_name(part);
        let _ = writeln!(text, "/PART/{part}\n{name}\n{:>10}{:>10}{:>10}", 1, 1, 0);
        let _ = writeln!(text, "/SH3N/{part}");
        for element in &elements {
            let [a, b, c] = deck.film.shell.triangles[*element].map(|node| node + 1);
            let _ = writeln!(text, "{:>10}{a:>10}{b:>10}{c:>10}", element + 1);
        }
        let _ = writeln!(text, "/EREF/SH3N/{part}\nstress-free shape of {name}");
        for element in &elements {
            let [a, b, c] = [0, 1, 2].map(|corner| deck.reference_node(*element, corner));
            let _ = writeln!(text, "{:>10}{a:>10}{b:>10}{c:>10}", element + 1);
        }
    }
    text.push_str("/SURF/PART/1\nfilm\n");
    node_lines(text, deck.part_numbers());
    text.push_str("/GRNOD/NODE/1\nfilm\n");
    node_lines(text, 1..=deck.film.shell.positions.len());
}

fn supports(text: &mut String, deck: &Deck<'_>) {
    for (index, support) in deck.supports().enumerate() {
        let (number, name) = (index + 2, support.name);
        let _ = writeln!(text, "/GRNOD/NODE/{number}\n{name}");
        node_lines(text, support.nodes.iter().map(|node| *node as usize + 1));
        let [x, y, z] = support.directions.map(u8::from);
        let _ = writeln!(text, "/BCS/{number}\n{name}\n   {x}{y}{z} 000{:>10}{number:>10}", 0);
    }
    for (index, (axis, acceleration)) in ["X", "Y", "Z"].iter().zip(&deck.film.gravity).enumerate()
    {
        if acceleration.abs() > 0.0 {
            let scale = wide(&[1.0, *acceleration]);
            let _ = writeln!(
                text,
                "/GRAV/{}\ngravity\n{:>10}{axis:>10}{:>10}{:>10}{:>10}{:>10}{scale}",
                index + 1,
                1,
                0,
                0,
                1,
                0
            );
        }
    }
    text.push_str("/FUNCT/1\nconstant\n");
    let _ = writeln!(text, "{}\n{}", wide(&[0.0, 1.0]), wide(&[1e6, 1.0]));
}

/// The control volume with its inflow and leak.
fn gas(text: &mut String, deck: &Deck<'_>) {
    let supply = deck.supply();
    let (inflows, [mass, cp]) = (deck.inflows(), deck.molar_mass_and_cp());
    let _ = writeln!(
        text,
        "/MAT/GAS/MASS/2\ngas\n{}\n{}\n{}",
        wide(&[mass]),
        wide(&[cp, 0.0, 0.0, 0.0, 0.0]),
        wide(&[0.0])
    );
    for (index, inflow) in inflows.iter().enumerate() {
        let number = index + 2;
        let _ = writeln!(text, "/FUNCT/{number}\nmass of inflow {}, kg", index + 1);
        for point in &inflow.mass {
            let _ = writeln!(text, "{}", wide(point));
        }
        let scales = wide(&[1.0, inflow.temperature]);
        let _ = writeln!(
            text,
            "/PROP/INJECT1/{number}\ninflow {}\n{:>10}{:>10}{}",
            index + 1,
            1,
            0,
            wide(&[1.0])
        );
        let _ = writeln!(text, "{:>10}{number:>10}{:>10}{:>10}{scales}", 2, 1, "");
    }
    let pressure = supply.ambient_pressure.max(VACUUM);
    let _ = writeln!(
        text,
        "/MONVOL/AIRBAG1/1\ngas\n{:>10}{:>10}{}\n{}\n{:>10}{:>10}{}{:>10}{:>10}",
        1,
        "",
        wide(&[deck.heat_transfer()]),
        wide(&[0.0; 5]),
        2,
        "",
        wide(&[SMALL, pressure, deck.film.film.temperature]),
        0,
        0
    );
    let _ = writeln!(text, "{:>10}", inflows.len());
    for index in 0..inflows.len() {
        let _ = writeln!(text, "{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}", index + 2, 0, 0, 0, 0, 0);
    }
    let area = supply.leak_area * supply.discharge_coefficient;
    let _ = writeln!(text, "{:>10}{:>10}", u8::from(area > 0.0), 0);
    if area > 0.0 {
        let none = format!("{:>10}{:>10}{:>10}{:>10}{}", 0, 0, 0, "", wide(&[0.0, 0.0, 0.0]));
        let _ = writeln!(
            text,
            "{:>10}{:>10}{}{:>20}{:>20}\n{}{:>10}{:>10}\n{none}\n{none}",
            0,
            1,
            wide(&[area, 0.0]),
            "",
            "leak",
            wide(&[0.0, 0.0, 0.0, 0.0]),
            "",
            0
        );
    }
}

/// Contact of the film with itself.
fn contact(text: &mut String, deck: &Deck<'_>) {
    let Some(contact) = &deck.film.contact else { return };
    let gap = contact.distance.unwrap_or(0.0);
    let zeros = format!("{:>10}", 0).repeat(5);
    let _ = writeln!(
        text,
        "/INTER/TYPE7/1\nfilm on film\n{:>10}{:>10}{zeros}{:>10}{:>10}{:>10}\n{}\n{}{:>10}{:>10}\n{}\n       000{:>20}{:>10}{}",
        1,
        1,
        0,
        0,
        0,
        wide(&[0.0, 0.0, 0.0]),
        wide(&[0.0, 0.0, 0.0, 0.0]),
        0,
        0,
        wide(&[0.0, contact.friction, gap, 0.0, 0.0]),
        "",
        0,
        wide(&[0.0, 0.0, 0.0])
    );
    let _ = writeln!(
        text,
        "{:>10}{:>10}{}{:>10}{:>10}{:>10}{}{:>10}",
        0,
        0,
        wide(&[0.0]),
        0,
        0,
        0,
        wide(&[0.0]),
        0
    );
}

fn outputs(text: &mut String, deck: &Deck<'_>) {
    text.push_str("/TH/MONV/1\ngas\nDEF       \n         1\n/TH/PART/2\nfilm\nDEF       \n");
    node_lines(text, deck.part_numbers());
    if deck.followed.is_empty() {
        return;
    }
    text.push_str("/TH/NODE/3\nfollowed\nDEF       \n");
    for node in deck.followed {
        let _ = writeln!(text, "{:>10}{:>10}{:>10}node_{}", node + 1, 0, "", node + 1);
    }
}

/// The input of the engine.
pub fn engine_file(deck: &Deck<'_>) -> String {
    let (end, interval) = (deck.duration(), deck.film.outputs.sample_interval);
    let frame = deck.frame_interval();
    format!(
        "/RUN/{}/1\n{end:e}\n/VERS/{FORMAT}\n/TFILE/4\n{interval:e}\n/PRINT/-1000\n/MON/ON\n/ANIM/DT\n0 {frame:e}\n/ANIM/VECT/VEL\n\
         /ANIM/SHELL/TENS/STRESS/MEMB\n",
        deck.name
    )
}
