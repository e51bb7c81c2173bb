use super::*;

fn pool(threads: usize) -> ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

#[expect(clippy::unnecessary_wraps, reason = "the signature of a case")]
fn passing(_: &Rig) -> Outcome {
    Ok(vec![Row::new("x", 1.0005, 1.0, 1e-3)])
}

fn failing(_: &Rig) -> Outcome {
    Err("no such thing".into())
}

fn panicking(_: &Rig) -> Outcome {
    panic!("division by {}", 0)
}

fn case(name: &'static str, body: fn(&Rig) -> Outcome) -> Case {
    Case { name, tier: Tier::Quick, body }
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
