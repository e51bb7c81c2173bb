//! The values of the keys of a file, and the parts of a scene that studies and scene files give by the same keys.
//! `sections` reads them from the tree of the file.

use std::collections::BTreeMap;
use std::sync::Arc;

use billow_solver::geometry::fold::{Caps, FoldDesign};
use billow_solver::scene::{
    Contact, Creases, Design, Film, GasSupply, HeatTransfer, InflowWindow, IntegratorKind,
    MeshDesign, Species, Support, Vent,
};

use crate::input::json::Json;
use crate::input::keys::{
    CAPS, CHIRALITIES, FITS, INTEGRATORS, ISOTHERMAL, Key, Named, SPECIES, STRATEGY_KEYS, Table,
    WINDOW_KEYS, pick, position,
};
use crate::input::plausible::Implausible;
use crate::input::source::{Source, shown};
use crate::input::value::Value;
use crate::platform::error::InputError;
use crate::platform::nearest::nearest;

/// Where a strategy stands among the values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Strategy {
    /// Position of the first value of [`STRATEGY_KEYS`]; the windows follow.
    pub(super) start: usize,
    /// Number of its inflow windows.
    pub windows: usize,
}

/// The value of every key of a table, in its order; `Null` where absent. In a study, the values of its
/// strategies follow.
#[derive(Debug, Clone)]
pub(crate) struct Settings {
    pub(super) table: &'static Table,
    pub(super) values: Vec<Value>,
    /// Paths and keys of the values beyond the table: those of strategies and their inflow windows.
    pub(super) rows: Vec<(String, &'static Key)>,
    /// The inflation strategies of a study, by name.
    pub strategies: BTreeMap<String, Strategy>,
    /// What holds the capsule of a study.
    pub supports: Vec<Support>,
    /// The tables of inflow windows of strategies.
    pub tables: Arc<FlowTables>,
    /// The film of a study with a mesh in place of a fold design, by the subdivisions of its triangles; else empty.
    pub meshes: Arc<BTreeMap<u32, MeshDesign>>,
}

/// Windows of the tables of a study, by strategy and inflow window; their times count from the start of the window.
pub(crate) type FlowTables = BTreeMap<(String, usize), Vec<InflowWindow>>;

/// Overpressure at which a vent is fully open over that at which it begins to open, by default. Chosen: that of common
/// relief valves (10 % accumulation).
const FULL_OVER_OPENING: f64 = 1.1;

impl Settings {
    /// Every key at its default.
    pub fn new(table: &'static Table) -> Self {
        let values = table.keys.iter().map(|key| key.default_value()).collect();
        let (rows, strategies, supports) = (Vec::new(), BTreeMap::new(), Vec::new());
        Self {
            table,
            values,
            rows,
            strategies,
            supports,
            tables: Arc::default(),
            meshes: Arc::default(),
        }
    }

    /// The value of a key, by its position in the table.
    pub fn at(&self, index: usize) -> &Value {
        &self.values[index]
    }

    /// The text of a key; `None` where it has none.
    pub fn text(&self, path: &str) -> Option<&str> {
        match self.value(path) {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Sets a key, and removes the values of the keys it excludes.
    pub fn set(&mut self, index: usize, value: Value) {
        self.values[index] = value;
        for path in self.key(index).excludes {
            if let Some(excluded) = self.table.index(path) {
                self.values[excluded] = Value::Null;
            }
        }
    }

    /// Time until which the lid holds the capsule, s.
    pub fn release_time(&self, strategy: Strategy) -> f64 {
        let index = strategy.start + const { position(STRATEGY_KEYS, "release_time") };
        self.values[index].number().unwrap_or(0.0)
    }

    /// Gas inside from the start, kg.
    pub fn preinflation_mass(&self, strategy: Strategy) -> f64 {
        let index = strategy.start + const { position(STRATEGY_KEYS, "preinflation_mass") };
        self.values[index].number().unwrap_or(0.0)
    }

    /// A value of an inflow window of a strategy; `None` where the study or the strategy decides.
    pub fn of_window(&self, strategy: Strategy, window: usize, key: usize) -> Option<f64> {
        let start = strategy.start + STRATEGY_KEYS.len();
        self.values[start + window * WINDOW_KEYS.len() + key].number()
    }

    /// Position of the value that a dotted path names, or a last part that only one key has.
    pub fn find(&self, name: &str) -> Option<usize> {
        let row = || self.rows.iter().position(|(path, _)| path == name);
        self.table.find(name).or_else(|| Some(self.table.keys.len() + row()?))
    }

    /// The key of a value.
    pub fn key(&self, index: usize) -> &'static Key {
        let table = &self.table.keys;
        table.get(index).copied().unwrap_or_else(|| self.rows[index - table.len()].1)
    }

    /// The shortest name of a value.
    pub fn name(&self, index: usize) -> String {
        match index.checked_sub(self.table.keys.len()) {
            Some(row) => self.rows[row].0.clone(),
            None => self.table.short_name(index).to_owned(),
        }
    }

    /// Name of the strategy.
    pub fn strategy_name(&self) -> &str {
        self.text("strategy").unwrap_or_default()
    }

    /// Refuses a strategy that the study does not have.
    pub fn check_strategy(&self, name: &str, key: &str, source: &Source) -> Result<(), InputError> {
        if self.strategies.contains_key(name) {
            return Ok(());
        }
        let known: Vec<&str> = self.strategies.keys().map(String::as_str).collect();
        let near = nearest(name, known.iter().copied());
        let near = near.map_or_else(String::new, |near| format!("; did you mean {near:?}?"));
        Err(source
            .error(
                key,
                Json::Text(name.to_owned()),
                format!("is not a strategy of this study{near}"),
                known.join(", "),
            )
            .with_hint("name one of these, or define it under strategies"))
    }

    /// The value of a key by its path.
    ///
    /// # Panics
    /// When the table has no such key. This is a mistake in code.
    pub fn value(&self, path: &str) -> &Value {
        &self.values[self.position(path)]
    }

    fn position(&self, path: &str) -> usize {
        self.table.index(path).unwrap_or_else(|| unreachable!("no key has the path {path}"))
    }

    /// A number; `None` where the key has no value.
    pub fn number(&self, path: &str) -> Option<f64> {
        self.value(path).number()
    }

    /// A number that the file must give, or has by default.
    pub fn needed(&self, path: &str, source: &Source) -> Result<f64, InputError> {
        self.number(path).ok_or_else(|| self.missing(path, source))
    }

    /// A whole number that the file must give, or has by default.
    pub fn whole(&self, path: &str, source: &Source) -> Result<u64, InputError> {
        match self.value(path) {
            Value::Integer(number) => Ok(u64::try_from(*number).unwrap_or_default()),
            _ => Err(self.missing(path, source)),
        }
    }

    /// A whole number of 32 bits. Every such key allows less than 2^32.
    pub fn count(&self, path: &str, source: &Source) -> Result<u32, InputError> {
        self.whole(path, source).map(|number| u32::try_from(number).unwrap_or_default())
    }

    /// True or false; `None` where the key has no value.
    pub fn flag(&self, path: &str) -> Option<bool> {
        match self.value(path) {
            Value::Bool(flag) => Some(*flag),
            _ => None,
        }
    }

    /// What the word of a key stands for; `None` where it has none.
    pub fn picked<T: Copy>(&self, path: &str, words: &[Named<T>]) -> Option<T> {
        pick(words, self.value(path))
    }

    /// What the word of a key stands for, which the file must give, or has by default.
    pub fn word<T: Copy>(
        &self,
        path: &str,
        words: &[Named<T>],
        source: &Source,
    ) -> Result<T, InputError> {
        self.picked(path, words).ok_or_else(|| self.missing(path, source))
    }

    /// The film: that of a mesh, or the fold design.
    pub fn design(&self, source: &Source) -> Result<Design, InputError> {
        if self.meshes.is_empty() {
            return self.fold_design(source).map(Design::Capsule);
        }
        let mesh = self.meshes.get(&self.count("design.subdivisions", source)?);
        mesh.map(|mesh| Design::Mesh(mesh.clone()))
            .ok_or_else(|| self.missing("design.subdivisions", source))
    }

    /// A design on a mesh with these subdivisions; as it is where film from a mesh has no such mesh.
    pub fn on_mesh(&self, design: &Design, n: u32) -> Design {
        match design {
            Design::Capsule(design) => FoldDesign { subdivisions: n, ..design.clone() }.into(),
            Design::Mesh(mesh) => Design::Mesh(self.meshes.get(&n).unwrap_or(mesh).clone()),
        }
    }

    /// The fold design.
    ///
    /// # Errors
    /// When the file does not give a key that it must give, as in all of these.
    pub fn fold_design(&self, source: &Source) -> Result<FoldDesign, InputError> {
        Ok(FoldDesign {
            fit: self.word("design.fit", &FITS, source)?,
            panels: self.count("design.N", source)?,
            storeys: self.count("design.M", source)?,
            bottom_radius: self.needed("design.bottom_radius", source)?,
            top_radius: self.number("design.top_radius"),
            height: self.number("design.height"),
            half_angle: self.number("design.half_angle"),
            alpha1_over_phi: self.number("design.alpha1_over_phi"),
            stowed_height: self.needed("design.stowed_height", source)?,
            subdivisions: self.count("design.subdivisions", source)?,
            chirality: self.word("design.chirality", &CHIRALITIES, source)?,
            caps: self.picked("design.caps", &CAPS).unwrap_or(Caps::Polygon),
        })
    }

    /// The film.
    pub fn film(&self, source: &Source) -> Result<Film, InputError> {
        let (creases, yield_moment) = (self.creases(source)?, self.number("film.yield_moment"));
        let bends = creases.map(|_| "creases").or(yield_moment.map(|_| "film.yield_moment"));
        if let Some(name) = bends.filter(|_| self.flag("film.bending") != Some(true)) {
            let problem = format!("is false, but the file has {name}");
            let allowed = format!("true, for film with {name}");
            return Err(source.error("film.bending", false, problem, allowed));
        }
        Ok(Film {
            youngs_modulus: self.needed("film.youngs_modulus", source)?,
            poisson_ratio: self.needed("film.poisson_ratio", source)?,
            density: self.needed("film.density", source)?,
            thickness: self.needed("film.thickness", source)?,
            compression: self.needed("film.compression", source)?,
            bending: self.flag("film.bending").unwrap_or(false),
            creases,
            yield_moment,
            numerical_damping: self.needed("film.numerical_damping", source)?,
            temperature: self.needed("film.temperature", source)?,
            loss_factor: self.needed("film.loss_factor", source)?,
            loss_frequency: self.needed("film.loss_frequency", source)?,
        })
    }

    /// The stiffness of the fold lines; `None` where they turn freely.
    fn creases(&self, source: &Source) -> Result<Option<Creases>, InputError> {
        let rest_angle = self.number("creases.rest_angle");
        let length_scale = match rest_angle {
            Some(_) => Some(self.needed("creases.length_scale", source)?),
            None => self.number("creases.length_scale"),
        };
        Ok(length_scale.map(|length_scale| Creases { length_scale, rest_angle }))
    }

    /// The gas with this mass at the start and these inflow windows: in order of time, those without inflow before the
    /// end of the run left out, and cut there, so that equal physics gives an equal job.
    pub fn gas(
        &self,
        initial_mass: f64,
        mut windows: Vec<InflowWindow>,
        source: &Source,
    ) -> Result<GasSupply, InputError> {
        let end_time = self.number("solver.end_time").unwrap_or(f64::INFINITY);
        for window in &mut windows {
            window.to = window.to.min(end_time);
        }
        windows.retain(|window| window.mass_flow_rate > 0.0 && window.from < window.to);
        windows.sort_by(|a, b| {
            a.from
                .total_cmp(&b.from)
                .then(a.to.total_cmp(&b.to))
                .then(a.mass_flow_rate.total_cmp(&b.mass_flow_rate))
                .then(a.temperature.total_cmp(&b.temperature))
        });
        Ok(GasSupply {
            species: self.species(source)?,
            initial_mass,
            windows,
            ambient_pressure: self.needed("gas.ambient_pressure", source)?,
            heat_transfer: match self.value("gas.heat_transfer") {
                Value::Text(word) if word == ISOTHERMAL => HeatTransfer::Isothermal,
                // The other word is adiabatic.
                value => HeatTransfer::Coefficient(value.number().unwrap_or(0.0)),
            },
            leak_area: self.needed("gas.leak_area", source)?,
            discharge_coefficient: self.needed("gas.discharge_coefficient", source)?,
            vent: self.vent(end_time, source)?,
        })
    }

    /// The vent, where it has an area: cut at the end of the run, so that equal physics gives an equal job.
    fn vent(&self, end_time: f64, source: &Source) -> Result<Option<Vent>, InputError> {
        let Some(area) = self.number("gas.vent_area").filter(|area| *area > 0.0) else {
            let others = ["gas.vent_from", "gas.vent_to", "gas.vent_opens_at", "gas.vent_full_at"];
            let given = others.into_iter().find(|key| self.number(key).is_some_and(|x| x > 0.0));
            if let Some(key) = given {
                let problem = "has no effect: the vent has no area".to_owned();
                let next = "give gas.vent_area".to_owned();
                let value = shown(self.number(key).unwrap_or_default());
                source.warn_point(key, &value, Implausible { problem, next });
            }
            return Ok(None);
        };
        let opens_at = self.number("gas.vent_opens_at").unwrap_or(0.0);
        let (from, to) = (self.number("gas.vent_from").unwrap_or(0.0), self.number("gas.vent_to"));
        let full_at = self.number("gas.vent_full_at");
        if let Some(to) = to.filter(|to| *to <= from) {
            let allowed = "a time after gas.vent_from";
            return Err(source.error("gas.vent_to", shown(to), "closes before it opens", allowed));
        }
        if let Some(full_at) = full_at.filter(|full_at| *full_at <= opens_at) {
            let problem = "is not above gas.vent_opens_at";
            let allowed = "an overpressure above it";
            return Err(source.error("gas.vent_full_at", shown(full_at), problem, allowed));
        }
        // A vent that never opens within the run is none.
        Ok((from < end_time).then(|| Vent {
            area,
            from,
            to: to.unwrap_or(end_time).min(end_time),
            opens_at,
            full_at: full_at.unwrap_or(FULL_OVER_OPENING * opens_at),
        }))
    }

    /// The species of the gas: a named one, or one by its constants. A constant given in addition to a
    /// name replaces that of the named gas.
    ///
    /// # Errors
    /// When a constant is missing, or cp is not above the gas constant.
    pub fn species(&self, source: &Source) -> Result<Species, InputError> {
        const CP: &str = "gas.species.cp";
        let named = self.picked("gas.species", &SPECIES);
        let constant = |path, of: fn(Species) -> f64| match (self.number(path), named) {
            (Some(given), _) => Ok(given),
            (None, Some(gas)) => Ok(of(gas)),
            (None, None) => self.needed(path, source),
        };
        let gas_constant = constant("gas.species.gas_constant", |gas| gas.gas_constant)?;
        let cp = constant(CP, |gas| gas.cp)?;
        if cp <= gas_constant {
            return Err(source.error(
                CP,
                shown(cp),
                "leaves no heat capacity at constant volume, cp - R",
                format!("above the gas constant, {gas_constant} J/(kg K)"),
            ));
        }
        // A cp that is given is constant.
        let vibrates = named.filter(|_| self.number(CP).is_none());
        let gas = vibrates.unwrap_or(Species::constant(gas_constant, cp));
        Ok(Species { gas_constant, ..gas })
    }

    /// Contact of film with film.
    pub fn contact(&self, source: &Source) -> Result<Contact, InputError> {
        Ok(Contact {
            distance: self.number("contact.distance"),
            friction: self.needed("contact.friction", source)?,
            adhesion: self.needed("contact.adhesion", source)?,
        })
    }

    /// The integrator of film.
    pub fn integrator(&self, source: &Source) -> Result<IntegratorKind, InputError> {
        self.word("solver.integrator", &INTEGRATORS, source)
    }

    /// The error of a key that the file does not give.
    pub fn missing(&self, path: &str, source: &Source) -> InputError {
        let key = self.table.keys[self.position(path)];
        let mut error = missing_key(key, source);
        if self.table.structured.iter().any(|(path, _)| *path == "grid") {
            error.hint = format!("give it here, or vary {} under grid", key.leaf());
        }
        error
    }
}

fn missing_key(key: &Key, source: &Source) -> InputError {
    source
        .error(key.path, "", "missing", key.allowed())
        .with_hint(format!("give it, as in {}", key.sample()))
}
