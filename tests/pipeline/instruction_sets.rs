//! `BILLOW_SIMD`: every command that simulates reads it, and refuses an unknown value.

use std::fs;
use std::path::Path;

use crate::support::{ran, stderr};

#[test]
fn every_simulating_command_refuses_an_unknown_instruction_set() {
    let folder = ran();
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    for file in ["sphere.json", "sphere.obj"] {
        fs::copy(scenes.join(file), folder.path().join(file)).unwrap();
    }
    for arguments in [
        &["run", "grid.json"][..],
        &["run", "results/grid", "--again", "done"],
        &["solve", "sphere.json"],
    ] {
        let output = folder.billow(arguments).env("BILLOW_SIMD", "neon").output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
        let message = stderr(&output);
        assert!(message.contains("BILLOW_SIMD = neon: unknown instruction set"), "{message}");
        assert!(message.contains("allowed: scalar"), "{message}");
    }
}
