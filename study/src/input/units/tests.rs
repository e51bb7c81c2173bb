use proptest::prelude::*;

use super::*;

fn si(text: &str, dimension: Dimension) -> f64 {
    parse(text, dimension).unwrap_or_else(|error| panic!("{text}: {error:?}"))
}

#[test]
fn decimal_units_convert_bit_for_bit() {
    for (text, dimension, value) in [
        ("40 mm", Dimension::Length, 0.04),
        ("25.4 um", Dimension::Length, 25.4e-6),
        ("25.4 µm", Dimension::Length, 25.4e-6),
        ("25.4μm", Dimension::Length, 25.4e-6),
        ("1 mil", Dimension::Length, 25.4e-6),
        ("3 in", Dimension::Length, 0.0762),
        ("5 g/s", Dimension::MassFlowRate, 0.005),
        ("0.05 g", Dimension::Mass, 5e-5),
        ("3.45 GPa", Dimension::Pressure, 3.45e9),
        ("1 atm", Dimension::Pressure, 101_325.0),
        ("1013.25 mbar", Dimension::Pressure, 101_325.0),
        ("7 bar", Dimension::Pressure, 7e5),
        ("1400 kg/m3", Dimension::Density, 1400.0),
        ("1400 kg/m^3", Dimension::Density, 1400.0),
        ("1400 kg/m³", Dimension::Density, 1400.0),
        ("1.4 g/cm3", Dimension::Density, 1400.0),
        ("1400 kg m^-3", Dimension::Density, 1400.0),
        ("0.3 W/m2K", Dimension::HeatTransfer, 0.3),
        ("0.3 W/m2 K", Dimension::HeatTransfer, 0.3),
        ("0.3 W/(m2 K)", Dimension::HeatTransfer, 0.3),
        ("0.3 W/(m²·K)", Dimension::HeatTransfer, 0.3),
        ("0.3 W/m2/K", Dimension::HeatTransfer, 0.3),
        ("296.8 J/kgK", Dimension::SpecificHeat, 296.8),
        ("1.5 s", Dimension::Time, 1.5),
        ("20 ms", Dimension::Time, 0.02),
        ("0.1 min", Dimension::Time, 6.0),
        ("18 kg/h", Dimension::MassFlowRate, 0.005),
        ("293 K", Dimension::Temperature, 293.0),
        ("20 degC", Dimension::Temperature, 293.15),
        ("-100.5 °C", Dimension::Temperature, 172.65),
        ("1.6 m/s2", Dimension::Acceleration, 1.6),
        ("5 %", Dimension::Number, 0.05),
        ("1 mm2", Dimension::Area, 1e-6),
        ("2 l", Dimension::Volume, 0.002),
        ("10 1/s", Dimension::Frequency, 10.0),
        ("1e-3 kg", Dimension::Mass, 1e-3),
        ("2.5E+1 mm", Dimension::Length, 0.025),
        ("5 g s-1", Dimension::MassFlowRate, 0.005),
        ("5 g·s⁻¹", Dimension::MassFlowRate, 0.005),
        ("5 gram/sec", Dimension::MassFlowRate, 0.005),
        ("0.6 lb/min", Dimension::MassFlowRate, 0.272_155_422 / 60.0),
        ("25.4 micron", Dimension::Length, 25.4e-6),
        ("1420 kg m-3", Dimension::Density, 1420.0),
        ("1.42 g/cc", Dimension::Density, 1420.0),
        ("760 Torr", Dimension::Pressure, 101_325.0),
        ("750 mmHg", Dimension::Pressure, 99_991.790_561_25),
        ("14.7 psi", Dimension::Pressure, 101_352.932_209_574_91),
        ("500 ksi", Dimension::Pressure, 3_447_378_646.584_180_5),
        ("20 C", Dimension::Temperature, 293.15),
        ("68 °F", Dimension::Temperature, 527.67 * 5.0 / 9.0),
        ("30 deg", Dimension::Angle, std::f64::consts::FRAC_PI_6),
        ("180°", Dimension::Angle, std::f64::consts::PI),
    ] {
        assert_eq!(si(text, dimension).to_bits(), f64::to_bits(value), "{text}");
    }
}

#[test]
fn texts_that_are_not_quantities_are_refused() {
    for text in [
        "",
        " ",
        "mm",
        "5",
        "5 furlong",
        "5 mm mm mm",
        "5 m^",
        "5 m^-",
        "5 m99",
        "- mm",
        ". mm",
        "5 /",
        "5 m/",
        "5 (m",
        "1e999 mm",
        "1e99999999999999999999 mm",
        "NaN mm",
        "inf m",
        "5 mm/",
        "5 degC/s",
        "0x5 mm",
        "5 m m m m m m m",
        "5 \u{0}m",
        "5 ²",
        "5,0 mm",
        "1'000 mm",
        "5 SLPM",
        "5 m-",
    ] {
        assert!(parse(text, Dimension::Length).is_err(), "{text:?}");
    }
}

#[test]
fn every_usual_unit_is_read() {
    for dimension in Dimension::all() {
        for unit in dimension.units() {
            assert!(si(&format!("1 {unit}"), dimension) > 0.0, "{unit}");
        }
    }
}

proptest! {
    /// A prefix and a shifted decimal point give the same number, bit for bit.
    #[test]
    fn prefixes_shift_the_point(digits in 1_u64..10_000_000_000_000_000, shift in -20_i32..20) {
        let written = format!("{digits}e{shift}");
        for (unit, dimension, exponent) in [
            ("mm", Dimension::Length, -3),
            ("GPa", Dimension::Pressure, 9),
            ("mg/s", Dimension::MassFlowRate, -6),
            ("cm2", Dimension::Area, -4),
        ] {
            let direct: f64 = format!("{digits}e{}", shift + exponent).parse().unwrap();
            prop_assert_eq!(si(&format!("{written} {unit}"), dimension).to_bits(), direct.to_bits());
        }
    }

    /// A number printed with its unit and read again is the same number.
    #[test]
    fn units_round_trip(value in 1e-6_f64..1e6) {
        for dimension in Dimension::all().filter(|d| *d != Dimension::Number) {
            let text = format!("{value} {}", dimension.si());
            prop_assert_eq!(si(&text, dimension).to_bits(), value.to_bits());
        }
    }
}
