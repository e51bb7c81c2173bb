use super::*;

#[test]
fn every_case_gives_a_row_in_the_given_order() {
    let case = |name, body| Case { name, long: false, body };
    let passing = |_: &Rig| Ok(vec![Row::new("x", 1.0005, 1.0, 1e-3)]);
    let cases = [
        case("a", |_| panic!("division by {}", 0)),
        case("b", passing),
        case("c", |_| Err("no such thing".into())),
        case("d", passing),
        case("e", |_| Ok(Vec::new())),
    ];
    let all: Vec<&Case> = cases.iter().collect();
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let judged = run_all(&pool, &all, &Rig::default(), &|_| ());
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
    let all = [
        (Row::new("x", 0.999, 1.0, 1.1e-3), true),
        (Row::new("x", 0.999, 1.0, 0.9e-3), false),
        (Row::new("x", f64::NAN, 1.0, 1e9), false),
        (Row::at_most("x", 1e-13, 1e-12), true),
        (Row::at_most("x", 2e-12, 1e-12), false),
        (Row::at_most("x", f64::NAN, 1e-12), false),
        (Row::at_least("x", 1.9, 1.8), true),
        (Row::at_least("x", 1.7, 1.8), false),
        (Row::within("x", 0.026, 0.025, 0.045), true),
        (Row::within("x", 0.0249, 0.025, 0.045), false),
        (Row::within("x", 0.0451, 0.025, 0.045), false),
        (Row::within("x", f64::NAN, 0.025, 0.045), false),
        (Row::new("x", 1.0, 1.0, 1e-3).with_least_order(1.9, 1.8), true),
        (Row::new("x", 1.0, 1.0, 1e-3).with_least_order(1.7, 1.8), false),
        (Row::new("x", 1.0, 1.0, 1e-3).with_least_order(f64::NAN, 1.8), false),
        (Row::new("x", 2.0, 1.0, 1e-3).with_least_order(2.0, 1.8), false),
    ];
    for (row, pass) in all {
        assert_eq!(row.pass, pass, "{row:?}");
    }
}
