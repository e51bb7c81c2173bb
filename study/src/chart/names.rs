//! Plain names of quantities, for titles and axes: "peak upward ring velocity" for `peak_vz`.

use crate::render::figure::unit::Unit;

/// Plain names of measures, the columns of the table.
const MEASURES: &[(&str, &str)] = &[
    ("volume_ratio", "volume over static volume"),
    ("height_ratio", "height over static height"),
    ("t_50_z_rim", "time to 50 % of the height"),
    ("t_90_z_rim", "time to 90 % of the height"),
    ("t_50_volume", "time to 50 % of the volume"),
    ("t_90_volume", "time to 90 % of the volume"),
    ("t_deployed", "time to deployment"),
    ("t_settled", "time to rest"),
    ("peak_speed", "peak speed of the top ring"),
    ("peak_film_speed", "peak speed of any node"),
    ("peak_base_force", "peak force on the base"),
    ("peak_acceleration", "peak acceleration of the top ring"),
    ("peak_vz", "peak upward ring velocity"),
    ("peak_downward_vz", "peak downward ring velocity"),
    ("peak_pressure", "peak gas pressure"),
    ("largest_z_rim", "largest height of the top ring"),
    ("lowest_z_rim", "lowest height after the first peak"),
    ("t_peak_vz", "time of the peak upward velocity"),
    ("peak_kinetic_energy", "peak kinetic energy of the film"),
    ("overshoot", "overshoot of the height"),
    ("ringing_rms", "ringing velocity after deployment"),
    ("ringing_frequency", "frequency of ringing"),
    ("film_stress", "peak film stress"),
    ("peak_lid_force", "peak force on the lid"),
    ("smallest_margin", "smallest margin of the limits"),
    ("final_z_rim", "final height of the top ring"),
    ("final_volume", "final volume"),
    ("final_pressure", "final gas pressure"),
    ("final_temperature", "final gas temperature"),
];

/// Plain names of parameters; that of any other parameter is its name in words, or its path.
const PARAMETERS: &[(&str, &str)] = &[
    ("N", "number of panels"),
    ("M", "number of storeys"),
    ("alpha1_over_phi", "angle ratio α1/ϕ"),
    ("strategy", "inflation strategy"),
    ("subdivisions", "subdivisions of the mesh"),
];

/// The name of a quantity in a figure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Name {
    /// Plain name, in lower case.
    pub plain: String,
    /// Symbol in files and options; empty if the plain name shows it already.
    pub symbol: String,
}

impl Name {
    /// The name of a history column, or of a measure. Without a plain name its `meaning` up to the first comma stands
    /// for it; the name alone if that is long.
    pub fn of_quantity(name: &str, meaning: &str) -> Self {
        /// Most characters of a plain name. Chosen: with symbol and unit it fits along an axis.
        const LONGEST: usize = 44;
        Self::found(MEASURES, name).unwrap_or_else(|| {
            match meaning.split([',', ';', ':', '(']).next().unwrap_or_default().trim() {
                short if short.is_empty() || short.chars().count() > LONGEST => {
                    Self { plain: name.to_owned(), symbol: String::new() }
                }
                short => Self::new(short, name),
            }
        })
    }

    /// The name of a parameter. A parameter whose last name others have too is known by its path, which stays.
    pub fn of_parameter(name: &str) -> Self {
        Self::found(PARAMETERS, name).unwrap_or_else(|| {
            let plain = if name.contains('.') { name.to_owned() } else { name.replace('_', " ") };
            Self { plain, symbol: String::new() }
        })
    }

    fn found(names: &[(&str, &str)], name: &str) -> Option<Self> {
        Some(Self::new(names.iter().find(|(known, _)| *known == name)?.1, name))
    }

    /// A plain name and a symbol; a symbol that the plain name shows is not repeated.
    fn new(plain: &str, name: &str) -> Self {
        let shown = plain.contains('α')
            || (name.len() > 1 && plain.to_lowercase().contains(&name.replace('_', " ")));
        let symbol = if shown { "" } else { name };
        Self { plain: plain.to_owned(), symbol: symbol.to_owned() }
    }

    /// The label of an axis: plain name, symbol, unit.
    pub fn label(&self, unit: &Unit) -> String {
        unit.label(&capital(&self.with_symbol()))
    }

    /// Plain name and symbol.
    pub fn with_symbol(&self) -> String {
        // "… along z, vz": two symbols do not stand together.
        let ends_in_symbol = self.plain.rsplit(' ').next().is_some_and(|word| word.len() == 1);
        let gap = match self.symbol.as_str() {
            "" => "",
            _ if ends_in_symbol => ", ",
            _ => " ",
        };
        format!("{}{gap}{}", self.plain, self.symbol)
    }

    /// The short name before a value: the symbol of a count, else the plain name.
    pub fn before_value(&self) -> &str {
        if self.symbol.is_empty() { &self.plain } else { &self.symbol }
    }
}

/// A text with a capital first letter; a symbol or path keeps its case.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    match letters.next() {
        Some(first) if !text.split(' ').next().is_some_and(|word| word.contains(['_', '.'])) => {
            format!("{}{}", first.to_uppercase(), letters.as_str())
        }
        _ => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_have_name_symbol_and_unit() {
        let metre = Unit::of("m", 1.0);
        let flow = Unit::of("kg/s", 0.005);
        let quantity = Name::of_quantity;
        for (name, unit, label) in [
            (
                quantity("z_rim", "mean height of the top ring"),
                &metre,
                "Mean height of the top ring z_rim (m)",
            ),
            (quantity("pressure", "gas pressure"), &Unit::si("Pa"), "Gas pressure (Pa)"),
            (
                quantity("new_one", "largest of all, at a sample"),
                &metre,
                "Largest of all new_one (m)",
            ),
            (quantity("new_one", &"long ".repeat(20)), &metre, "new_one (m)"),
            (quantity("vz", "velocity along z"), &Unit::si("m/s"), "Velocity along z, vz (m/s)"),
            (Name::of_parameter("strategy"), &Unit::si("1"), "Inflation strategy"),
            (Name::of_parameter("mass_flow_rate"), &flow, "Mass flow rate (g/s)"),
            (Name::of_parameter("strategies.a.mass"), &metre, "strategies.a.mass (m)"),
            (Name::of_parameter("N"), &Unit::si("1"), "Number of panels N"),
        ] {
            assert_eq!(name.label(unit), label);
        }
        assert_eq!(Name::of_parameter("N").before_value(), "N");
    }
}
