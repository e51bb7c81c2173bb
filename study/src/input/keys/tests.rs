use super::listing::{FileKind, Parts, entries};
use super::*;
use crate::input::json::Json;
use crate::input::syntax::parse;
use crate::input::value::Value;

/// Every key of both kinds of file, those of objects included.
fn all_keys() -> impl Iterator<Item = &'static Key> {
    let keys = |file: FileKind| {
        let Parts { table, objects, .. } = file.parts();
        table.keys.iter().copied().chain(objects.iter().flat_map(|(_, keys)| *keys))
    };
    let both = [FileKind::Study, FileKind::Scene].into_iter().flat_map(keys);
    both.filter(|key| key.path != "gravity")
        .chain(RANGE_KEYS)
        .chain(SEARCH_KEYS)
        .chain(OPTIMISE_KEYS)
}

#[test]
fn every_example_and_default_is_allowed() {
    for key in all_keys() {
        let example = parse(key.example, "example").unwrap();
        let read = match key.kind {
            KeyKind::Vector(_) => key.read_components(&example).map(|_| Value::Null),
            _ => key.read(&example),
        };
        read.unwrap_or_else(|refusal| panic!("{}: {refusal:?}", key.path));
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
fn every_quantity_with_a_unit_has_a_plausible_range() {
    for key in all_keys() {
        let KeyKind::Quantity(quantity) = key.kind else { continue };
        if quantity.dimension == crate::input::units::Dimension::Number {
            continue;
        }
        let path = key.path;
        let [low, high] = quantity.plausible.unwrap_or_else(|| panic!("{path} has none"));
        assert!(quantity.min <= low && low < high && high <= quantity.max, "{path}");
        for json in [
            Some(parse(key.example, "example").unwrap()),
            match key.default {
                Default::Number(number) => Some(Json::Number(number)),
                _ => None,
            },
        ] {
            let value = json.and_then(|json| key.read(&json).ok());
            let number = value.and_then(|value| quantity.number(&value)).unwrap_or(0.0);
            assert!(quantity.is_plausible(number), "{path} = {number}");
        }
    }
}

#[test]
fn rows_name_only_keys_that_exist() {
    for key in all_keys() {
        assert!(key.excludes.iter().all(|path| index(path).is_some()), "{}", key.path);
    }
    for model in MODELS {
        assert_eq!(super::model(model.kind).name, model.name);
        for path in model.ignores {
            assert!(index(path).is_some(), "{} ignores {path}", model.name);
        }
    }
}

#[test]
fn no_key_is_listed_twice() {
    for file in [FileKind::Study, FileKind::Scene] {
        let mut paths: Vec<String> = entries(file).into_iter().map(|entry| entry.path).collect();
        let count = paths.len();
        paths.sort();
        paths.dedup();
        assert_eq!(paths.len(), count);
    }
}

#[test]
fn names_find_their_key() {
    assert_eq!(find("N"), index("design.N"));
    assert_eq!(find("film.thickness"), find("thickness"));
    assert_eq!(short_name(find("mass_flow_rate").unwrap()), "mass_flow_rate");
    assert_eq!(find("design"), None);
    for index in 0..KEYS.len() {
        assert_eq!(find(short_name(index)), Some(index));
    }
}

#[test]
fn spelling_does_not_change_a_number() {
    let read = |path: &str, json: &str| KEYS[index(path).unwrap()].read(&parse(json, "f").unwrap());
    assert_eq!(read("design.N", "8"), read("design.N", "8.0"));
    assert_eq!(read("design.height", "1"), read("design.height", "\"1000 mm\""));
    assert_eq!(
        read("gas.leak_area", "-0.0").map(|value| format!("{value:?}")),
        Ok("Number(0.0)".to_owned())
    );
}
