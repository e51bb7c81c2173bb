//! The words that keys may hold: one row a word, with the value it stands for and its meaning. Key
//! values, errors, schema and reference follow from these tables.

use billow_solver::geometry::fold::{Caps, Chirality, Fit};
use billow_solver::integrators;
use billow_solver::scene::motion::Profile;
use billow_solver::scene::{IntegratorKind, ModelKind, Species, SupportLocation};

use crate::input::value::Value;

/// The key of the model. Models compute the same physics with different simplifications.
pub const MODEL: &str = "solver.model";
/// The key of the integrator of film.
pub const INTEGRATOR: &str = "solver.integrator";
/// How residual gas enters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ResidualGas {
    /// Let in from release on.
    #[default]
    Burst,
    /// Inside from the start.
    Stored,
    /// Inside from the start, at ambient pressure.
    Ambient,
}

/// One word that a key may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Word {
    /// The word.
    pub name: &'static str,
    /// What it stands for; empty where the word says it.
    pub meaning: &'static str,
}

/// A word that says its meaning.
pub(super) const fn plain(name: &'static str) -> Word {
    Word { name, meaning: "" }
}

pub(super) const fn explained(name: &'static str, meaning: &'static str) -> Word {
    Word { name, meaning }
}

/// A word and the value it stands for.
#[derive(Debug, Clone, Copy)]
pub struct Named<T> {
    /// The word.
    pub name: &'static str,
    /// What it stands for.
    pub value: T,
    /// Meaning; empty where the word says it.
    pub meaning: &'static str,
}

const fn word<T>(name: &'static str, value: T, meaning: &'static str) -> Named<T> {
    Named { name, value, meaning }
}

/// The words of a table, for a key.
pub(super) const fn words<T: Copy, const N: usize>(table: &[Named<T>; N]) -> [Word; N] {
    let mut words = [plain(""); N];
    let mut index = 0;
    while index < N {
        words[index] = explained(table[index].name, table[index].meaning);
        index += 1;
    }
    words
}

/// The value that a word of a table stands for; `None` for any other value.
pub(crate) fn pick<T: Copy>(table: &[Named<T>], value: &Value) -> Option<T> {
    let Value::Text(text) = value else { return None };
    table.iter().find(|row| row.name == text).map(|row| row.value)
}

/// A model of `solver.model`.
#[derive(Debug, Clone, Copy)]
pub struct Model {
    /// The model.
    pub kind: ModelKind,
    /// Value of the key.
    pub name: &'static str,
    /// Meaning.
    pub meaning: &'static str,
    /// Keys of a study that change no result of this model.
    pub ignores: &'static [&'static str],
    /// Whether it moves film: it has an integrator, and shapes to store.
    pub has_film: bool,
    /// Whether it takes a fraction of its stable step; if not, its step is fixed or follows its error.
    pub has_stable_step: bool,
}

/// The model of a kind. A kind without a row does not compile.
pub const fn model(kind: ModelKind) -> Model {
    match kind {
        ModelKind::Piston => Model {
            kind,
            name: "piston",
            meaning: "one moving mass on one gas volume",
            ignores: &[
                "design.subdivisions",
                "film.compression",
                "film.bending",
                "film.yield_moment",
                "creases.length_scale",
                "creases.rest_angle",
                "film.loss_factor",
                "film.loss_frequency",
                "film.numerical_damping",
                "contact.distance",
                "contact.friction",
                "contact.adhesion",
                "solver.cfl",
                INTEGRATOR,
                "outputs.frames",
                "seed",
                "imperfection_amplitude",
            ],
            has_film: false,
            has_stable_step: false,
        },
        ModelKind::Storeys => Model {
            kind,
            name: "storeys",
            meaning: "rings of film that rise, turn and widen, on one gas volume",
            ignores: &[
                "design.subdivisions",
                "film.compression",
                "film.bending",
                "film.yield_moment",
                "creases.length_scale",
                "creases.rest_angle",
                "contact.distance",
                "contact.friction",
                "contact.adhesion",
                "solver.stepping.adaptive",
                "solver.stepping.fixed",
                INTEGRATOR,
                "outputs.frames",
            ],
            has_film: false,
            has_stable_step: true,
        },
        ModelKind::Film => Model {
            kind,
            name: "film",
            meaning: "the whole film, with contact",
            ignores: &["solver.stepping.adaptive", "solver.stepping.fixed"],
            has_film: true,
            has_stable_step: true,
        },
    }
}

/// Every model, in the order of the documentation.
pub const MODELS: [Model; 3] =
    [model(ModelKind::Piston), model(ModelKind::Storeys), model(ModelKind::Film)];

/// Keys that change no result of film with the integrator of this name.
pub fn ignored_by_integrator(name: &str) -> &'static [&'static str] {
    match INTEGRATORS.iter().find(|row| row.name == name).map(|row| row.value) {
        Some(IntegratorKind::Implicit) => &["film.numerical_damping"],
        Some(IntegratorKind::Explicit | IntegratorKind::Hybrid) | None => &[],
    }
}

/// Name of the integrator of a study that names none.
pub fn default_integrator() -> &'static str {
    integrators::entry(IntegratorKind::default()).name
}

const fn integrator(kind: IntegratorKind) -> Named<IntegratorKind> {
    let entry = integrators::entry(kind);
    word(entry.name, kind, entry.meaning)
}

/// Values of `solver.integrator`.
pub(crate) const INTEGRATORS: [Named<IntegratorKind>; 3] = [
    integrator(IntegratorKind::Explicit),
    integrator(IntegratorKind::Implicit),
    integrator(IntegratorKind::Hybrid),
];

const fn model_kind(Model { kind, name, meaning, .. }: Model) -> Named<ModelKind> {
    word(name, kind, meaning)
}

/// Values of `solver.model`.
pub(crate) const MODEL_KINDS: [Named<ModelKind>; 3] =
    [model_kind(MODELS[0]), model_kind(MODELS[1]), model_kind(MODELS[2])];

/// Values of `design.fit`.
pub(crate) const FITS: [Named<Fit>; 3] = [
    word("cone", Fit::Cone, "top_radius and height; phi follows"),
    word(
        "angles",
        Fit::Angles,
        "half_angle (or top_radius and height) and alpha1_over_phi; the cone follows",
    ),
    word("height", Fit::Height, "height and alpha1_over_phi; half angle and top radius follow"),
];

/// Values of `design.chirality`.
pub(crate) const CHIRALITIES: [Named<Chirality>; 2] = [
    word("same", Chirality::Same, "all storeys turn in one direction"),
    word("alternate", Chirality::Alternate, "successive storeys turn in opposite directions"),
];

/// Values of `design.caps`; a study has the first alone.
pub(crate) const CAPS: [Named<Caps>; 2] = [
    word("polygon", Caps::Polygon, "N-gons sewn to the ring fold lines"),
    word("circular", Caps::Circular, "discs; erected shape only"),
];

/// Shape of a scene's capsule at the start: whether it is erected.
pub(crate) const SHAPES: [Named<bool>; 2] =
    [word("stowed", false, "folded to its stack"), word("erected", true, "rolled onto its cone")];

/// How residual gas enters.
pub(crate) const RESIDUAL_GAS: [Named<ResidualGas>; 3] = [
    word(
        "burst",
        ResidualGas::Burst,
        "let in at burst_rate from release on, at inflow temperature",
    ),
    word("stored", ResidualGas::Stored, "inside from the start, at film temperature"),
    word(
        "ambient",
        ResidualGas::Ambient,
        "inside from the start, at film temperature and ambient_pressure: the mass follows from the stowed volume",
    ),
];

/// How a prescribed motion grows.
pub(crate) const PROFILES: [Named<Profile>; 2] = [
    word("linear", Profile::Linear, "constant velocity"),
    word("smooth", Profile::Smooth, "3 s^2 - 2 s^3: starts and ends at rest"),
];

/// A named gas. Specific gas constant R and specific heat cp, J/(kg K).
const fn gas(name: &'static str, gas_constant: f64, cp: f64) -> Named<Species> {
    word(name, Species::constant(gas_constant, cp), "")
}

/// The named species: ideal gases, R = 8.314462618 J/(mol K) over the molar mass (CODATA 2018), cp
/// at 300 K and low pressure (NIST-JANAF; air: dry air).
pub(crate) const SPECIES: [Named<Species>; 6] = [
    gas("nitrogen", 296.803_052, 1_038.810_68),
    gas("air", 287.055, 1_005.0),
    gas("helium", 2_077.264, 5_193.16),
    gas("argon", 208.132, 520.33),
    word("carbon_dioxide", Species::CARBON_DIOXIDE, ""),
    gas("hydrogen", 4_124.48, 14_310.0),
];

/// Formulas that people write for these names.
pub(crate) const FORMULAS: [(&str, &str); 5] = [
    ("N2", "nitrogen"),
    ("He", "helium"),
    ("Ar", "argon"),
    ("CO2", "carbon_dioxide"),
    ("H2", "hydrogen"),
];

/// Words of `gas.heat_transfer`, with the coefficient each stands for, W/(m² K).
pub(crate) const ISOTHERMAL: &str = "isothermal";
pub(crate) const HEAT_TRANSFER_WORDS: &[(&str, f64)] =
    &[("adiabatic", 0.0), (ISOTHERMAL, f64::INFINITY)];

/// The places a support of a study acts on, in the order of a scene's supports.
pub(crate) const SUPPORT_PLACES: [Named<SupportLocation>; 4] = [
    word("bottom_ring", SupportLocation::BottomRing, ""),
    word("top_ring", SupportLocation::TopRing, ""),
    word("bottom_cap", SupportLocation::BottomCap, ""),
    word("top_cap", SupportLocation::TopCap, ""),
];
