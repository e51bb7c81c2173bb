//! Files of the repository, and Rust source without comments and texts.

use std::fs;
use std::path::{Path, PathBuf};

/// The repository's root.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace").to_path_buf()
}

/// Every file below a folder of the repository whose name ends so, in order; paths from the root.
pub fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let root = root();
    let mut found = Vec::new();
    let mut folders = vec![root.join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of the repository") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                // Neither what was built nor the Python environment of the readers.
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                if name != "target" && !name.starts_with('.') {
                    folders.push(path);
                }
            } else if path.to_string_lossy().ends_with(ending) {
                found.push(path.strip_prefix(&root).expect("below the root").to_path_buf());
            }
        }
    }
    found.sort();
    found
}

/// The text of a file, by its path from the root.
pub fn text(path: &Path) -> String {
    fs::read_to_string(root().join(path))
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Rust source with comments, texts and characters replaced by spaces; lines keep their numbers.
pub fn code(source: &str) -> String {
    let bytes: Vec<char> = source.chars().collect();
    let mut out = String::with_capacity(source.len());
    let mut index = 0;
    let blank = |symbol: char| if symbol == '\n' { '\n' } else { ' ' };
    while index < bytes.len() {
        let end = skipped(&bytes[index..]);
        if end == 0 {
            out.push(bytes[index]);
            index += 1;
        } else {
            out.extend(bytes[index..index + end].iter().map(|symbol| blank(*symbol)));
            index += end;
        }
    }
    out
}

/// Length of the comment, text or character that begins here; 0 for code.
fn skipped(rest: &[char]) -> usize {
    match rest {
        ['/', '/', ..] => rest.iter().position(|symbol| *symbol == '\n').unwrap_or(rest.len()),
        ['r', '#', '"', ..] => {
            let end = rest.windows(2).skip(3).position(|two| two == ['"', '#']);
            end.map_or(rest.len(), |end| end + 5)
        }
        ['"', ..] => text_end(rest, '"'),
        ['\'', '\\', ..] => text_end(rest, '\''),
        ['\'', _, '\'', ..] => 3,
        _ => 0,
    }
}

fn text_end(rest: &[char], quote: char) -> usize {
    let mut index = 1;
    while index < rest.len() && rest[index] != quote {
        index += if rest[index] == '\\' { 2 } else { 1 };
    }
    (index + 1).min(rest.len())
}

#[test]
fn comments_and_texts_are_blanked() {
    let source = "a /* b // \" */ // c\n\"d \\\" e\" 'f' '\\'' r#\"g \" h\"# i";
    let kept: String = code(source).split_whitespace().collect();
    assert_eq!(kept, "a/*bi");
}
