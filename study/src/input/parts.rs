//! The parts of a scene that study files and scene files give by the same keys.

use billow_solver::geometry::fold::{Caps, FoldDesign};
use billow_solver::scene::{
    Contact, Film, GasSupply, HeatTransfer, InflowWindow, IntegratorKind, Species,
};

use crate::input::keys::{CAPS, CHIRALITIES, FITS, INTEGRATORS, ISOTHERMAL, SPECIES};
use crate::input::plausible::Implausible;
use crate::input::settings::Settings;
use crate::input::source::{Source, shown};
use crate::input::value::{Value, brief_number};
use crate::platform::error::InputError;

impl Settings {
    /// The fold design.
    ///
    /// # Errors
    /// When the file does not give a key that it must give, as in all of these.
    pub fn design(&self, source: &Source) -> Result<FoldDesign, InputError> {
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
        Ok(Film {
            youngs_modulus: self.needed("film.youngs_modulus", source)?,
            poisson_ratio: self.needed("film.poisson_ratio", source)?,
            density: self.needed("film.density", source)?,
            thickness: self.needed("film.thickness", source)?,
            compression: self.needed("film.compression", source)?,
            numerical_damping: self.needed("film.numerical_damping", source)?,
            temperature: self.needed("film.temperature", source)?,
            loss_factor: self.needed("film.loss_factor", source)?,
            loss_frequency: self.needed("film.loss_frequency", source)?,
        })
    }

    /// The gas with this mass at the start and these inflow windows.
    pub fn gas(
        &self,
        initial_mass: f64,
        windows: Vec<InflowWindow>,
        source: &Source,
    ) -> Result<GasSupply, InputError> {
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
        })
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
        Ok(Species { gas_constant, cp })
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
}

/// Warns of a window, between these times (s), that starts or ends after the run. `end` is the key that gives
/// its end, with its value.
pub(crate) fn warn_of_end(
    path: &str,
    [from, to]: [f64; 2],
    end: (&str, String),
    end_time: f64,
    source: &Source,
) {
    let part = if from >= end_time {
        "the window".to_owned()
    } else if to > end_time {
        let part = brief_number(100.0 * (to - end_time) / (to - from));
        format!("the part after it, {part} % of its gas,")
    } else {
        return;
    };
    let (key, value) = if from >= end_time { ("from", format!("{} s", shown(from))) } else { end };
    let problem = format!("is after solver.end_time ({} s): {part} is ignored", shown(end_time));
    let next = "change it, or raise solver.end_time".to_owned();
    source.warn_point(&format!("{path}.{key}"), &value, Implausible { problem, next });
}
