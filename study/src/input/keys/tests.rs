use super::*;

#[test]
fn every_example_and_default_is_allowed() {
    for key in KEYS.iter().chain(STRATEGY_KEYS).chain(WINDOW_KEYS) {
        let example = crate::input::study_file::parse(key.example, "example").unwrap();
        key.read(&example).unwrap_or_else(|refusal| panic!("{}: {refusal:?}", key.path));
        let default = match key.default {
            Default::Number(number) => Json::Number(number),
            Default::Integer(number) => Json::Integer(number),
            Default::Word(word) => Json::Text(word.to_owned()),
            Default::Absent(meaning) => {
                assert!(!meaning.is_empty());
                continue;
            }
            Default::Required => continue,
        };
        assert_eq!(key.read(&default).as_ref(), Ok(&key.default_value()), "{}", key.path);
    }
}

#[test]
fn names_find_their_key() {
    assert_eq!(find("N"), index("design.N"));
    assert_eq!(find("film.thickness"), find("thickness"));
    assert_eq!(short_name(find("mass_flow_rate").unwrap()), "mass_flow_rate");
    assert_eq!(find("design"), None);
    for at in 0..KEYS.len() {
        assert_eq!(find(short_name(at)), Some(at));
    }
}

#[test]
fn numbers_are_the_same_however_written() {
    let read = |path: &str, json: &str| {
        KEYS[index(path).unwrap()].read(&crate::input::study_file::parse(json, "f").unwrap())
    };
    assert_eq!(read("design.N", "8"), read("design.N", "8.0"));
    assert_eq!(read("design.height", "1"), read("design.height", "\"1000 mm\""));
    assert_eq!(
        read("gas.leak_area", "-0.0").map(|value| format!("{value:?}")),
        Ok("Number(0.0)".to_owned())
    );
    for (path, json, problem) in [
        ("design.N", "6.5", "is not a whole number"),
        ("design.N", "\"6\"", "is a text; write the number without quotes"),
        ("design.N", "3", "is out of range"),
        ("design.height", "true", "is true or false, not a length"),
        ("design.height", "\"5 kg\"", "is a mass, not a length"),
        ("design.height", "0", "is out of range"),
        ("design.fit", "\"cones\"", "did you mean \"cone\"?"),
        ("design.caps", "\"circular\"", "circular caps belong to the erected shape"),
    ] {
        let refusal = read(path, json).unwrap_err();
        assert!(refusal.problem.contains(problem), "{path} {json}: {refusal:?}");
    }
}

#[test]
fn a_slip_of_the_finger_is_recognised() {
    let known = || KEYS.iter().map(Key::leaf);
    assert_eq!(nearest("thicknes", known()), Some("thickness"));
    assert_eq!(nearest("mass_flowrate", known()), Some("mass_flow_rate"));
    assert_eq!(nearest("colour", known()), None);
}
