//! Names the commit the program is built from.

use std::process::Command;

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

fn main() {
    let commit = git(&["rev-parse", "--short=12", "HEAD"]).map_or_else(
        || "unknown".to_owned(),
        |commit| {
            let changed = git(&["status", "--porcelain", "--untracked-files=no"]);
            if changed.is_none_or(|list| list.is_empty()) { commit } else { commit + "+" }
        },
    );
    println!("cargo::rustc-env=BILLOW_COMMIT={commit}");
    // Changed code is rebuilt anyway; asking git again then keeps the "+" true.
    for path in ["build.rs", "src", "../solver/src"] {
        println!("cargo::rerun-if-changed={path}");
    }
    // The log of HEAD changes with every commit and checkout; HEAD itself names only the branch.
    for name in ["HEAD", "logs/HEAD"] {
        if let Some(path) = git(&["rev-parse", "--path-format=absolute", "--git-path", name])
            && std::path::Path::new(&path).exists()
        {
            println!("cargo::rerun-if-changed={path}");
        }
    }
}
