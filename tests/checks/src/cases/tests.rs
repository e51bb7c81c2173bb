use super::*;

fn pool(threads: usize) -> ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

#[expect(clippy::unnecessary_wraps, reason = "the signature of a case")]
fn passing(_: &Rig) -> Outcome {
    Ok(vec![Row::new("x", 1.0005, 1.0, 1e-3)])
}

fn failing(_: &Rig) -> Outcome {
    Err("no such thing".to_owned())
}

fn panicking(_: &Rig) -> Outcome {
    panic!("division by {}", 0)
}

fn case(name: &'static str, body: fn(&Rig) -> Outcome) -> Case {
    Case { name, compares: "nothing", seconds: 0.1, tier: Tier::Quick, body }
}

#[test]
fn every_case_gives_a_row_in_the_given_order() {
    let cases = [
        case("a", panicking),
        case("b", passing),
        case("c", failing),
        case("d", passing),
        case("e", |_| Ok(Vec::new())),
    ];
    let all: Vec<&Case> = cases.iter().collect();
    for threads in [1, 2] {
        let judged = run_all(&pool(threads), &all, &Rig::default(), &|_| ());
        let names: Vec<&str> = judged.iter().map(|j| j.name).collect();
        assert_eq!(names, ["a", "b", "c", "d", "e"]);
        let pass: Vec<bool> = judged.iter().map(Judged::pass).collect();
        assert_eq!(pass, [false, true, false, true, false]);
        assert_eq!(judged[0].rows[0].note, "panicked: division by 0");
        assert_eq!(judged[2].rows[0].note, "no such thing");
    }
}

#[test]
fn case_names_are_unique() {
    let mut names: Vec<&str> = CASES.iter().map(|case| case.name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), CASES.len());
}

#[test]
fn rows_pass_only_within_their_band() {
    assert!(Row::new("x", 0.999, 1.0, 1.1e-3).pass);
    assert!(!Row::new("x", 0.999, 1.0, 0.9e-3).pass);
    assert!(!Row::new("x", f64::NAN, 1.0, 1e9).pass);
    assert!(Row::at_most("x", 1e-13, 1e-12).pass && !Row::at_most("x", 2e-12, 1e-12).pass);
    assert!(!Row::at_most("x", f64::NAN, 1e-12).pass);
    assert!(Row::at_least("x", 1.9, 1.8).pass && !Row::at_least("x", 1.7, 1.8).pass);
    let inside = Row::within("x", 0.026, 0.025, 0.045);
    assert!(inside.pass && inside.reference == Some(0.035) && inside.note.contains("0.045"));
    for outside in [0.0249, 0.0451, f64::NAN] {
        assert!(!Row::within("x", outside, 0.025, 0.045).pass, "{outside}");
    }
    let slow = Row::new("x", 1.0, 1.0, 1e-3).with_least_order(1.7, 1.8);
    assert!(!slow.pass && slow.order == Some(1.7) && slow.note.contains("1.8"));
    assert!(!Row::new("x", 1.0, 1.0, 1e-3).with_least_order(f64::NAN, 1.8).pass);
    assert!(!Row::new("x", 2.0, 1.0, 1e-3).with_least_order(2.0, 1.8).pass);
}

/// The cases use the constants of `scene::paper`, their closed forms the numbers of
/// `tests/reference`: both are the same bits.
#[test]
fn the_papers_numbers_are_those_of_the_reference_files() {
    use billow_solver::integrators::dormand_prince::DEFAULT_TOLERANCE;
    use billow_solver::scene::DEFAULT_CFL;
    use billow_solver::scene::paper;
    use billow_solver::scene::{Film, Species, Stepping};

    let same = |value: f64, path: &str| {
        assert_eq!(value.to_bits(), reference::number(path).to_bits(), "{path}");
    };
    let film = Film::PAPER_ELASTIC;
    for file in ["film", "static_film"] {
        same(film.youngs_modulus, &format!("{file}/youngs_modulus"));
        same(film.poisson_ratio, &format!("{file}/poisson_ratio"));
        same(film.density, &format!("{file}/density"));
        same(film.thickness, &format!("{file}/thickness"));
    }
    same(film.temperature, "film/temperature");
    same(Species::NITROGEN.gas_constant, "nitrogen/gas_constant");
    same(Species::NITROGEN.cp, "nitrogen/cp");
    same(paper::BOTTOM_RADIUS, "end_state/bottom_radius");
    same(paper::TOP_RADIUS, "end_state/top_radius");
    same(paper::HEIGHT, "end_state/height");

    let scene = paper::capsule(5, 1.0);
    assert_eq!(scene.solver.stepping, Stepping::Adaptive(DEFAULT_TOLERANCE));
    let film = paper::free_film(billow_solver::geometry::shapes::strip(1, 1.0, 1.0), film);
    assert_eq!(film.solver.cfl.to_bits(), DEFAULT_CFL.to_bits());
}
