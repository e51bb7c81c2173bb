//! Charts of a study with a search: borders, and maps along the searched parameter.

use super::*;
use crate::chart::borders::Searched;
use crate::chart::kinds::ChartKind;
use crate::job::proportion::Proportion;
use crate::study::{Border, Level, SearchResult};

const REPLICATES: usize = 4;
/// The values of a search, kg/s.
const SCAN: [f64; 5] = [0.001, 0.002, 0.004, 0.008, 0.016];
const FOUND: SearchResult = SearchResult::Border { low: 0.002, high: 0.008, met_below: true };

fn border(strategy: &str, mass: f64, met: [usize; 5], outcome: SearchResult) -> Border {
    let level = |(value, met)| Level {
        value,
        met: Proportion { met, of: REPLICATES },
        uncertain: 0,
        not_judged: 0,
        open: 0,
    };
    Border {
        parameters: vec![
            ("strategy".to_owned(), Value::Text(strategy.to_owned())),
            ("residual_gas_mass".to_owned(), Value::Number(mass)),
        ],
        levels: SCAN.into_iter().zip(met).map(level).collect(),
        outcome,
        filtered: false,
    }
}

/// The searches of both strategies at two residual masses; one is not monotone.
fn borders() -> Vec<Border> {
    let twice = SearchResult::NotMonotone(vec![[0.001, 0.002], [0.004, 0.008]]);
    vec![
        border("direct", 0.0, [4, 4, 3, 0, 0], FOUND),
        border("direct", 1e-4, [4; 5], SearchResult::NoChange { met: true }),
        border("rapid", 0.0, [4, 0, 0, 4, 4], twice),
        border("rapid", 1e-4, [0; 5], SearchResult::NoChange { met: false }),
    ]
}

/// The runs of some searches.
fn runs(borders: &[Border]) -> Table {
    let mut points = Vec::new();
    for border in borders {
        for level in &border.levels {
            for seed in 1..=4 {
                let mut parameters = border.parameters.clone();
                parameters.push(("mass_flow_rate".to_owned(), Value::Number(level.value)));
                parameters.push(("seed".to_owned(), Value::Integer(seed)));
                let mut point = point(u32::try_from(points.len()).unwrap(), &[]);
                point.job.parameters = parameters.into();
                points.push(point);
            }
        }
    }
    with_records(&points, |_, _| {})
}

/// Calls `draw` with the source of some searches.
fn searched<T>(borders: &[Border], criterion: &str, draw: impl Fn(&Source<'_>) -> T) -> T {
    let (table, replicates) = (runs(borders), ["seed".to_owned()]);
    let search = Searched {
        parameter: "mass_flow_rate",
        criterion,
        replicates: &replicates,
        replicate_count: REPLICATES,
        borders,
    };
    draw(&Source { search: Some(search), ..source(&table) })
}

/// The chart of borders and its texts.
fn drawn(borders: &[Border], criterion: &str) -> (String, Vec<String>) {
    let svg = searched(borders, criterion, |source| borders::svg(source, None, &[]).unwrap());
    let texts = check::figure(&svg);
    (svg, texts)
}

#[test]
fn borders_are_intervals_arrows_and_letters_between_the_ends_of_the_search() {
    let (svg, texts) = drawn(&borders(), "safe");
    shows(
        &texts,
        &[
            "Largest safe mass flow rate over residual gas mass",
            "study made_up: 4 searches, 80 runs",
            "Mass flow rate (g/s)",
            "Residual gas mass (g)",
            "Inflation strategy",
            "interval of the border (1)",
            "safe at every value that is decided: a border, if any, lies beyond (1)",
            "safe at no value that is decided: a border, if any, lies beyond (1)",
            "not monotone: changes more than once (1)",
            "safe up to the border",
            "value searched: some runs safe",
            "ends of the search",
            "M",
            // The axis is logarithmic, as the search.
            "2",
            "5",
        ],
    );
    assert_eq!(svg.matches("fill-opacity=\"0.3\"").count(), 3, "two columns and their legend");
    searched(&borders(), "safe", |source| {
        let over = borders::svg(source, Some("strategy"), &[]).unwrap();
        assert!(contains(&check::figure(&over), "rapid"));
        let error = borders::svg(source, Some("mass_flow_rate"), &[]).unwrap_err().to_string();
        assert!(error.contains("along which the study searches"), "{error}");
        let (charts, _) = kinds::standard(source);
        assert_eq!(charts[0].0, ChartKind::Borders(None, Vec::new()));
        assert_eq!(charts[1].0.file_name(), "peak_vz-over-mass_flow_rate");
    });
    let table = runs(&borders());
    let error = borders::svg(&source(&table), None, &[]).unwrap_err().to_string();
    assert!(error.contains("the study has no search"), "{error}");
}

#[test]
fn a_single_search_is_a_number_line() {
    let (svg, texts) = drawn(&borders()[..1], "safe");
    let expected = ["Largest safe mass flow rate", "Mass flow rate (g/s)", "2 to 8 g/s", "5"];
    shows(&texts, &expected);
    // The column lies: its corners are farther apart along x than along y.
    let column = svg.lines().find(|line| line.contains("fill-opacity=\"0.3\"")).unwrap();
    let corners = column.split('"').nth(1).unwrap().split(' ');
    let corners: Vec<Vec<f64>> =
        corners.map(|c| c.split(',').map(|number| number.parse().unwrap()).collect()).collect();
    let extent = |axis: usize| (corners[0][axis] - corners[2][axis]).abs();
    assert!(extent(0) > extent(1), "{column}");
    let (_, texts) = drawn(&borders()[2..3], "safe");
    shows(&texts, &["M"]);
}

#[test]
fn searches_that_change_one_factor_at_a_time_stand_under_their_names() {
    let with_thickness = |mut border: Border, thickness: f64| {
        border.parameters.push(("thickness".to_owned(), Value::Number(thickness)));
        border
    };
    let all = [
        with_thickness(border("direct", 0.0, [4, 4, 3, 0, 0], FOUND), 3e-5),
        with_thickness(border("rapid", 0.0, [4, 4, 3, 0, 0], FOUND), 3e-5),
        with_thickness(border("direct", 1e-4, [4, 4, 3, 0, 0], FOUND), 3e-5),
        with_thickness(border("direct", 0.0, [4, 4, 3, 0, 0], FOUND), 4e-5),
    ];
    let (_, texts) = drawn(&all, "safe");
    assert!(contains(&texts, "Largest safe mass flow rate"), "{texts:?}");
    shows(&texts, &["base", "inflation strategy rapid", "residual gas mass 0.1 g"]);
    assert!(
        texts.iter().any(|text| text.starts_with("Base: inflation strategy direct")),
        "{texts:?}"
    );
    // Two changes in one search: no names.
    let mut both = all.to_vec();
    both.push(with_thickness(border("rapid", 1e-4, [4, 4, 3, 0, 0], FOUND), 4e-5));
    let (_, texts) = drawn(&both, "safe");
    assert!(!contains(&texts, "base"), "{texts:?}");
}

#[test]
fn a_search_without_a_change_has_an_arrow_only_where_the_border_is_known_to_lie() {
    let met = SearchResult::NoChange { met: true };
    // No search says on which side the criterion is met.
    let none = SearchResult::NoChange { met: false };
    let all = [border("direct", 0.0, [4; 5], met.clone()), border("rapid", 0.0, [0; 5], none)];
    let (_, texts) = drawn(&all, "safe");
    shows(
        &texts,
        &[
            "A",
            "N",
            "safe at every value that is decided (1)",
            "safe at no value that is decided (1)",
        ],
    );
    // The last value is not decided: the border may lie below it.
    let open_end = [
        border("direct", 0.0, [4, 4, 3, 0, 0], FOUND),
        border("rapid", 0.0, [4, 4, 4, 4, 3], met.clone()),
    ];
    let (_, texts) = drawn(&open_end, "safe");
    shows(&texts, &["A", "safe at every value that is decided (1)", "interval of the border (1)"]);
    let closed_end = [open_end[0].clone(), border("rapid", 0.0, [3, 4, 4, 4, 4], met)];
    let (_, texts) = drawn(&closed_end, "safe");
    assert!(!contains(&texts, "A"), "an arrow: {texts:?}");
    assert!(
        contains(&texts, "safe at every value that is decided: a border, if any, lies beyond (1)"),
        "{texts:?}"
    );
}

#[test]
fn the_legend_reads_a_limit_as_a_limit_and_a_verdict_as_a_word() {
    let (_, texts) = drawn(&borders(), "peak_vz < 40 m/s");
    shows(
        &texts,
        &[
            "Largest mass flow rate with peak_vz < 40 m/s over residual gas mass",
            "peak_vz < 40 m/s up to the border",
            "value searched: each run meets peak_vz < 40 m/s",
            "value searched: some runs meet peak_vz < 40 m/s",
        ],
    );
    let one_outcome = [borders()[1].clone(), borders()[3].clone()];
    let (_, texts) = drawn(&one_outcome, "deployed");
    shows(
        &texts,
        &[
            "Mass flow rate at the border between deployed and not deployed over",
            "value searched: each run deployed",
            "deployed here",
        ],
    );
}

#[test]
fn a_map_along_the_searched_parameter_has_the_values_of_every_search() {
    // Each search has 16 values near its border: 37 values in all.
    let mut found = [border("direct", 0.0, [4, 4, 3, 0, 0], FOUND), borders()[0].clone()];
    found[1].parameters[0].1 = Value::Text("rapid".to_owned());
    for (number, border) in found.iter_mut().enumerate() {
        for step in 1..=16 {
            let mut level = border.levels[2];
            level.value = 0.004 + 1e-4 * (f64::from(step) + 0.5 * number as f64);
            border.levels.push(level);
        }
        border.levels.sort_by(|a, b| a.value.total_cmp(&b.value));
    }
    searched(&found, "deployed", |source| {
        let axes = kinds::outcome_axes(source).unwrap();
        assert!(axes.contains(&"mass_flow_rate".to_owned()), "{axes:?}");
        let svg = map::svg(source, "verdict", ["mass_flow_rate", "strategy"]).unwrap();
        let texts = check::figure(&svg);
        let choice = "at the 5 of 37 values of mass flow rate that every search has";
        assert!(texts.iter().any(|text| text.contains(choice)), "{texts:?}");
        // Without their search the values do not fit.
        let plain = Source { search: None, ..source.clone() };
        let error = map::svg(&plain, "verdict", ["mass_flow_rate", "strategy"]).unwrap_err();
        assert!(error.to_string().contains("37 values along one axis"), "{error}");
        let axes = kinds::outcome_axes(&plain).unwrap();
        assert!(!axes.contains(&"mass_flow_rate".to_owned()), "others: {axes:?}");
    });
}
