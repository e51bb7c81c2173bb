//! The reference page of the scenes and parameters of maps.

use std::fmt::Write as _;

use super::scenes::SCENES;
use billow_study::input::value::brief_number;

/// docs/reference/stability.md: every scene of a map, and its parameters.
pub fn page() -> String {
    let mut page = "# Scenes of maps of stability\n\nGenerated. Scenes of a map file \
                    ([guide](../guide/stability.md)), the methods that can run them, and their parameters. \
                    Values are numbers in these units, without a unit.\n"
        .to_owned();
    for scene in SCENES {
        let methods: Vec<String> =
            scene.methods().iter().map(|method| format!("`{}`", method.name())).collect();
        let _ = write!(
            page,
            "\n## {}\n\n{}. Methods: {}.\n\n| parameter | unit | default | range | meaning |\n|---|---|---|---|---|\n",
            scene.name,
            scene.meaning,
            methods.join(", ")
        );
        for parameter in scene.parameters {
            let [low, high] = parameter.range.map(brief_number);
            let whole = if parameter.whole { ", whole" } else { "" };
            let _ = writeln!(
                page,
                "| `{}` | {} | {} | {low} to {high}{whole} | {} |",
                parameter.name,
                parameter.unit,
                brief_number(parameter.default),
                parameter.meaning
            );
        }
    }
    page
}
