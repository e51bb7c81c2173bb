//! Reference numbers and bands of the cases: `tests/reference/*.json`, part of the program.

use std::sync::LazyLock;

use serde::de::DeserializeOwned;
use serde_json::Value;

static FILES: LazyLock<[Value; 6]> = LazyLock::new(|| {
    [
        include_str!("../../../reference/gas.json"),
        include_str!("../../../reference/film.json"),
        include_str!("../../../reference/dynamics.json"),
        include_str!("../../../reference/statics.json"),
        include_str!("../../../reference/contact.json"),
        include_str!("../../../reference/bending.json"),
    ]
    .map(|text| serde_json::from_str(text).expect("JSON in tests/reference"))
});

/// The value at a path, such as `tank_filling/band`, in one of the files.
fn find(path: &str) -> &'static Value {
    let pointer = format!("/{path}");
    let found = FILES.iter().find_map(|file| file.pointer(&pointer));
    found.unwrap_or_else(|| panic!("no {path} in tests/reference"))
}

fn read<T: DeserializeOwned>(path: &str) -> T {
    let read = T::deserialize(find(path));
    read.unwrap_or_else(|error| panic!("{path} in tests/reference: {error}"))
}

/// A number by its path.
pub fn number(path: &str) -> f64 {
    read(path)
}

/// The numbers of these keys of an entry.
pub fn entry<const N: usize>(path: &str, keys: [&str; N]) -> [f64; N] {
    keys.map(|key| number(&format!("{path}/{key}")))
}

/// The rows of a table, `path/rows`.
pub fn rows(path: &str) -> Vec<Vec<f64>> {
    read(&format!("{path}/rows"))
}

/// A list of numbers by its path.
pub fn numbers(path: &str) -> Vec<f64> {
    read(path)
}
