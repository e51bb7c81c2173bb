//! What a reader should know of a study's answers, said on stderr beside them.

use crate::study::Study;

/// Keys that decide nothing on the piston, the only model yet: it has no mesh, no film that can be
/// compressed or touch itself, and no imperfection.
const PISTON_IGNORES: [&str; 6] = [
    "design.subdivisions",
    "film.compression",
    "contact.distance",
    "contact.friction",
    "contact.adhesion",
    "seed",
];

/// Says what the model's answers are worth, and which axes it ignores.
pub fn print(study: &Study) {
    eprintln!(
        "model piston: how fast, not whether (it cannot lock, its speeds are upper bounds); README, \
         Models"
    );
    let ignored: Vec<&str> =
        study.parameter_paths().filter(|path| PISTON_IGNORES.contains(path)).collect();
    if !ignored.is_empty() {
        eprintln!(
            "note: the piston ignores {}; jobs that differ in nothing else give equal results",
            ignored.join(", ")
        );
    }
}
