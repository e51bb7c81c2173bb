use billow_solver::output::outcome::FailureKind;

use super::*;

/// A quantity with this exact value.
pub fn quantity(name: &str, exact: Option<f64>) -> Quantity {
    Quantity {
        name: name.to_owned(),
        unit: "s".to_owned(),
        meaning: name.to_owned(),
        exact,
        is_course: false,
    }
}

/// An audit that speaks against a run.
const MARKED: Ending = Ending::Marked("numerically_damped");

/// A run of film on a mesh of 48 n² elements that takes steps in proportion to n over the CFL number.
pub fn film(n: i64, cfl: f64, value: f64) -> Run {
    let size = n as f64;
    let steps = 1000.0 * size / cfl;
    Run {
        configuration: vec![
            ("model".to_owned(), Value::Text("film".to_owned())),
            ("subdivisions".to_owned(), Value::Integer(n)),
            ("cfl".to_owned(), Value::Number(cfl)),
        ],
        ending: Ending::Trusted,
        elements: 48.0 * size * size,
        steps,
        implicit: false,
        seconds: Some(1e-6 * size * size * steps),
        results: vec![Some(Outcome::Number(value))],
        mesh_errors: Vec::new(),
    }
}

/// A run of a model without a mesh.
pub fn piston(value: f64) -> Run {
    Run {
        configuration: vec![
            ("model".to_owned(), Value::Text("piston".to_owned())),
            ("subdivisions".to_owned(), Value::Null),
            ("cfl".to_owned(), Value::Null),
        ],
        elements: 0.0,
        steps: 500.0,
        ..film(4, 0.5, value)
    }
}

pub fn scene(exact: Option<f64>, runs: Vec<Run>) -> SceneRuns {
    SceneRuns {
        name: "capsule".to_owned(),
        meaning: "a made-up scene".to_owned(),
        quantities: vec![quantity("t_50_z_rim", exact)],
        per_simulated_second: true,
        runs,
        without_result: 0,
    }
}

/// Relative error 0.32/n² of the value 2.
fn second_order(n: i64) -> f64 {
    let size = n as f64;
    2.0 * (1.0 + 0.32 / (size * size))
}

#[test]
fn a_known_order_and_a_known_front_are_found() {
    let mut runs: Vec<Run> =
        [32, 4, 16, 8].into_iter().map(|n| film(n, 0.5, second_order(n))).collect();
    // Dearer than n 8 and no better.
    runs.push(film(8, 0.25, second_order(8)));
    // Cheaper than n 8 and worse than n 4.
    runs.push(film(8, 1.0, 2.1));
    runs.push(piston(2.4));
    // As cheap as n 4 and better, but no run can be trusted.
    runs.push(Run { ending: MARKED, ..film(4, 0.6, 2.0) });
    let diagram = Diagram::of(scene(Some(2.0), runs));
    let errors = &diagram.quantities[0];
    let front = |cost| -> Vec<usize> {
        (0..8).filter(|index| errors.points[*index].unwrap().on_front(cost)).collect()
    };
    assert_eq!(front(Cost::Work), [0, 1, 2, 3, 6]);
    assert_eq!(front(Cost::Seconds), [0, 1, 2, 3], "the piston takes as long as n 4");
    let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
    let meshes = &diagram.chains[0];
    assert_eq!((meshes.parameter.as_str(), meshes.of_meshes), ("subdivisions", true));
    assert_eq!(meshes.members, [1, 3, 2, 0], "coarse to fine");
    assert!(close(errors.orders[0].unwrap(), 2.0));
    for member in [3, 2, 0] {
        assert!(close(errors.points[member].unwrap().order.unwrap(), 2.0));
    }
    assert!(errors.points[1].unwrap().order.is_none(), "the coarsest mesh has none");
    assert!(close(errors.points[6].unwrap().error.median, 0.2));
    assert_eq!(diagram.members[6].work().to_bits(), 500.0_f64.to_bits());
    // The steps of n 8 are a chain of CFL numbers.
    let steps =
        diagram.chains.iter().find(|chain| chain.parameter == "cfl" && chain.members.len() == 3);
    assert_eq!(steps.unwrap().members, [5, 3, 4]);
    assert_eq!(diagram.lines()[0], (Some(0), vec![1, 3, 2, 0]));
    let drawn: usize = diagram.lines().iter().map(|(_, members)| members.len()).sum();
    assert_eq!(drawn, 8, "each member is drawn once");
}

#[test]
fn the_uncertainty_of_a_coarse_reference_holds_its_mesh_error() {
    let runs = |mesh_error: Option<f64>| {
        let known = |n, value| Run { mesh_errors: vec![mesh_error], ..film(n, 0.5, value) };
        vec![known(4, 1.8), known(6, 1.88), Run { mesh_errors: vec![None], ..piston(2.02) }]
    };
    let errors = |mesh_error| Diagram::of(scene(None, runs(mesh_error))).quantities.remove(0);
    let unknown = errors(None);
    let difference = 1.0 - 1.8 / 1.88;
    assert!((unknown.uncertainty() - 0.5 * difference).abs() < 1e-12);
    assert!(unknown.points[0].unwrap().on_front(Cost::Work), "n 4 looks better than the piston");
    // The finest mesh is 8 % from finer ones: of errors of 4 and 7 % none is known to be smaller.
    let known = errors(Some(0.08));
    assert!((known.uncertainty() - 0.08).abs() < 1e-12);
    assert!(!known.points[0].unwrap().on_front(Cost::Work));
    assert!(known.points[2].unwrap().on_front(Cost::Work), "the cheapest");
    let small = errors(Some(0.001));
    assert_eq!(small.uncertainty().to_bits(), unknown.uncertainty().to_bits());
}

#[test]
fn without_an_exact_value_the_finest_trusted_mesh_is_the_reference() {
    let mut runs = Vec::new();
    for (n, values) in [(4, [2.3, 2.4, 2.5]), (8, [2.1, 2.2, 2.2]), (16, [2.0, 2.02, 2.04])] {
        runs.extend(values.map(|value| film(n, 0.5, value)));
    }
    runs.push(Run { ending: MARKED, ..film(32, 0.5, 9.0) });
    let diagram = Diagram::of(scene(None, runs));
    let errors = &diagram.quantities[0];
    let reference = errors.reference.as_ref().unwrap();
    assert_eq!((reference.member, reference.value), (Some(2), Some(2.02)));
    // Half the range 0.04 over 2.02; half of 2.2/2.02 − 1.
    let (spread, mesh): (f64, f64) = (0.02 / 2.02, 0.5 * (2.2 / 2.02 - 1.0));
    let expected = (spread * spread + mesh * mesh).sqrt();
    assert!((errors.uncertainty() - expected).abs() < 1e-12, "{}", errors.uncertainty());
    let coarse = errors.points[0].unwrap();
    let error = |value: f64| value / 2.02 - 1.0;
    for (found, value) in
        [(coarse.error.least, 2.3), (coarse.error.median, 2.4), (coarse.error.largest, 2.5)]
    {
        assert!((found - error(value)).abs() < 1e-12);
    }
    let finest = errors.points[2].unwrap();
    assert!(finest.is_reference && !finest.on_front(Cost::Work));
    assert!((finest.error.median - expected).abs() < 1e-12, "it stands at its uncertainty");
    // The error of n 8 is below twice the uncertainty, so that no order can be seen.
    assert_eq!(errors.orders[0], None);
}

#[test]
fn a_single_run_takes_its_spread_from_the_next_coarser_mesh() {
    let mut runs: Vec<Run> = [2.1, 2.12].map(|value| film(8, 0.5, value)).to_vec();
    runs.push(film(16, 0.5, 2.0));
    let diagram = Diagram::of(scene(None, runs));
    let (spread, mesh): (f64, f64) = (0.005, 0.5 * (2.11 / 2.0 - 1.0));
    let expected = (spread * spread + mesh * mesh).sqrt();
    assert!((diagram.quantities[0].uncertainty() - expected).abs() < 1e-12);
    let lone = Diagram::of(scene(None, vec![film(8, 0.5, 2.0)]));
    assert_eq!(lone.quantities[0].reference.as_ref().unwrap().uncertainty, None);
}

#[test]
fn errors_below_the_uncertainty_count_as_equal() {
    let mut runs = vec![film(32, 0.5, 2.0), film(16, 0.5, 2.08)];
    // Both within 2 %: the cheaper one is on the front.
    runs.extend([film(8, 0.5, 2.03), film(4, 0.5, 1.98)]);
    let diagram = Diagram::of(scene(None, runs));
    let points = &diagram.quantities[0].points;
    assert!((diagram.quantities[0].uncertainty() - 0.02).abs() < 1e-12);
    let front = [1, 2, 3].map(|index: usize| points[index].unwrap().on_front(Cost::Work));
    assert_eq!(front, [false, false, true]);
}

#[test]
fn courses_are_compared_over_their_common_time() {
    let course = |scale: f64| {
        let times: Vec<f64> = (0..=10).map(f64::from).collect();
        let values: Vec<f64> = times.iter().map(|time| scale * time).collect();
        Some(Outcome::Course(Arc::new(Course::new(&times, &values).unwrap())))
    };
    let mut scene = scene(None, vec![film(4, 0.5, 0.0), film(8, 0.5, 0.0), film(16, 0.5, 0.0)]);
    scene.quantities[0].is_course = true;
    for (run, scale) in scene.runs.iter_mut().zip([1.2, 1.1, 1.0]) {
        run.results = vec![course(scale)];
    }
    let diagram = Diagram::of(scene);
    let errors = &diagram.quantities[0];
    assert_eq!(errors.reference.as_ref().unwrap().value, None);
    assert!((errors.uncertainty() - 0.05).abs() < 1e-12);
    assert!((errors.points[0].unwrap().error.median - 0.2).abs() < 1e-12);
    assert!(diagram.largest().reference.is_none(), "courses have no part in the largest error");
}

/// A run with another integrator of the mesh n 8, in a configuration that names it.
fn with_integrator(name: &str, cfl: f64, value: f64) -> Run {
    let mut run = film(8, cfl, value);
    run.configuration.push(("integrator".to_owned(), Value::Text(name.to_owned())));
    run
}

#[test]
fn a_failed_configuration_is_a_member_and_a_failed_run_beside_others_is_none() {
    let limit = Ending::Failed(Status::Failed(FailureKind::StepLimit));
    let failed = |n| Run { ending: limit, results: vec![None], ..film(n, 0.5, 0.0) };
    let runs = vec![film(4, 0.5, 2.2), film(8, 0.5, 2.1), failed(8), failed(16)];
    let diagram = Diagram::of(scene(Some(2.0), runs));
    let endings: Vec<&str> = diagram.members.iter().map(|one| one.ending.name()).collect();
    assert_eq!(endings, ["done", "done", "step_limit"]);
    // Of two runs with n 8 one failed; two runs of the scene have not ended.
    assert_eq!((diagram.without_result, diagram.members[1].runs), (1, 1));
    assert!(diagram.quantities[0].points[2].is_none(), "there is no error without a result");
    assert!(diagram.largest().points[2].is_none());
    assert!(diagram.members[2].work() > diagram.members[1].work(), "its steps have a cost");
}

#[test]
fn implicit_steps_are_on_the_front_of_seconds_alone() {
    let quick = |run: Run| Run { seconds: Some(1e-3), implicit: true, steps: 10.0, ..run };
    let explicit = with_integrator("explicit", 0.5, 2.1);
    let implicit = quick(with_integrator("implicit", 0.5, 2.05));
    let errors = Diagram::of(scene(Some(2.0), vec![explicit, implicit.clone()])).quantities;
    let front = |cost| [0, 1].map(|member: usize| errors[0].points[member].unwrap().on_front(cost));
    assert_eq!(front(Cost::Work), [true, false]);
    assert_eq!(front(Cost::Seconds), [false, true]);
    // Among themselves their steps compare.
    let alone = Diagram::of(scene(Some(2.0), vec![implicit])).quantities;
    assert!(alone[0].points[0].unwrap().on_front(Cost::Work));
}

#[test]
fn on_one_mesh_the_uncertainty_is_that_of_the_step() {
    let known = |cfl, value| Run {
        mesh_errors: vec![Some(0.1)],
        ..with_integrator("explicit", cfl, value)
    };
    let mut runs = vec![known(0.5, 2.04), known(0.25, 2.01), known(0.25, 1.99)];
    runs.push(with_integrator("hybrid", 0.5, 2.02));
    let errors = Diagram::of(scene(None, runs.clone())).quantities.remove(0);
    assert_eq!(errors.reference.as_ref().unwrap().member, Some(1), "the most steps of the mesh");
    let (spread, step): (f64, f64) = (0.01 / 2.0, 0.5 * (2.04 / 2.0 - 1.0));
    let expected = (spread * spread + step * step).sqrt();
    assert!((errors.uncertainty() - expected).abs() < 1e-12, "{}", errors.uncertainty());
    // A model without a mesh does not share its error.
    let mut meshless = piston(2.1);
    meshless.configuration.push(("integrator".to_owned(), Value::Null));
    runs.push(meshless);
    let errors = Diagram::of(scene(None, runs)).quantities.remove(0);
    assert!(errors.uncertainty() > 0.1, "{}", errors.uncertainty());
}
