//! No avoided word in sources, scripts or documents: `words.txt` is the list. Documents keep their limits of length.

use std::path::PathBuf;

use crate::sources::{files, text};

/// One line of the list.
struct Avoided {
    words: Vec<String>,
    instead: String,
    allowed: Vec<Vec<String>>,
}

/// Words in lower case and the line each stands on; everything that is no letter, digit or sign separates.
fn words(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        // Code in a document is quoted, as a text in code is.
        let text = text.replace(['`', '\''], "\"");
        let separated = text.split(|c: char| !(c.is_alphanumeric() || c == '-' || c == '"'));
        for word in separated.filter(|word| !word.is_empty()) {
            found.push((line, word.to_lowercase()));
        }
    }
    found
}

/// A word without the quotes and dashes round it.
fn bare(word: &str) -> &str {
    word.trim_matches(['"', '-'])
}

fn phrase(text: &str) -> Vec<String> {
    words(text).into_iter().map(|(_, word)| word).collect()
}

fn list(text: &str) -> Vec<Avoided> {
    let lines = text.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty());
    lines
        .map(|line| {
            let mut parts = line.split('|').map(str::trim);
            let words = phrase(parts.next().unwrap_or(""));
            let instead = parts.next().unwrap_or("").to_owned();
            let contexts = parts.next().unwrap_or("").split(';').map(phrase);
            Avoided { words, instead, allowed: contexts.filter(|own| !own.is_empty()).collect() }
        })
        .collect()
}

/// Lines on which an avoided phrase stands outside its allowed contexts.
fn findings(avoided: &Avoided, text: &[(usize, String)]) -> Vec<usize> {
    let matches = |at: usize, phrase: &[String]| {
        text.get(at..at + phrase.len()).is_some_and(|here| {
            here.iter().zip(phrase).all(|((_, word), wanted)| {
                // A quoted word of a context must be quoted in the text.
                bare(word) == bare(wanted) && (!wanted.contains('"') || word.contains('"'))
            })
        })
    };
    let length = avoided.words.len();
    let allowed = |at: usize| {
        avoided.allowed.iter().any(|context| {
            let shifts = context.len().saturating_sub(length);
            (0..=shifts).any(|shift| at >= shift && matches(at - shift, context))
        })
    };
    let found = (0..text.len()).filter(|at| matches(*at, &avoided.words) && !allowed(*at));
    found.map(|at| text[at].0).collect()
}

/// Sources, scripts and documents of the repository.
fn looked_at() -> Vec<PathBuf> {
    let endings = [".rs", ".md", ".toml", ".sh", ".py", ".js", ".html", "Makefile", ".ci/run"];
    let folders = ["solver", "study", "studies", "scenes", "tests", "docs", "python", ".ci"];
    let pages = [
        "README.md",
        "DESIGN.md",
        "CONTRIBUTING.md",
        "results/README.md",
        "results/paper/README.md",
        "results/pareto/README.md",
        "results/stability/README.md",
        "Cargo.toml",
        "Makefile",
    ];
    let below = folders.into_iter().flat_map(|folder| files(folder, ""));
    let all = below.chain(pages.into_iter().map(PathBuf::from));
    all.filter(|path| {
        let name = path.to_string_lossy();
        let ours = !name.contains("repository/words") && !name.ends_with(".min.js");
        endings.iter().any(|ending| name.ends_with(ending)) && ours
    })
    .collect()
}

#[test]
fn words_that_are_avoided_are_nowhere() {
    let list = list(include_str!("words.txt"));
    let paths = looked_at();
    assert!(list.len() > 30 && paths.len() > 300, "{} phrases, {} files", list.len(), paths.len());
    let mut found = Vec::new();
    for path in paths {
        let words = words(&text(&path));
        for avoided in &list {
            for line in findings(avoided, &words) {
                let (phrase, instead) = (avoided.words.join(" "), &avoided.instead);
                found.push(format!("{}:{line}: \"{phrase}\"; use {instead}", path.display()));
            }
        }
    }
    assert!(found.is_empty(), "{} findings\n{}", found.len(), found.join("\n"));
}

#[test]
fn words_are_matched_whole_and_contexts_allow_them() {
    let list = list("way | displacement | the same way\nwithdrawn | invalidated | \"withdrawn\"\n");
    let lines = |of: usize, text: &str| findings(&list[of], &words(text));
    assert_eq!(lines(0, "always\nown_way\nThe same way\na Way"), [2, 4]);
    assert_eq!(lines(1, "withdrawn\n\"withdrawn\""), [1]);
}

/// Most characters of a line of prose.
const MAX_LINE: usize = 120;
/// Most lines of a document, by the start of its path; the first row that fits decides.
const MAX_LINES: [(&str, usize); 6] = [
    ("README.md", 90),
    ("DESIGN.md", 110),
    ("CONTRIBUTING.md", 110),
    ("docs/guide/", 120),
    ("docs/theory/", 120),
    ("docs/decisions/0", 40),
];

#[test]
fn documents_keep_their_limits() {
    let mut found = Vec::new();
    for path in looked_at() {
        let name = path.to_string_lossy().into_owned();
        if path.extension().is_none_or(|kind| kind != "md") || name.starts_with("docs/reference") {
            continue;
        }
        let page = text(&path);
        let most = MAX_LINES.iter().find(|(start, _)| name.starts_with(start));
        let count = page.lines().count();
        if let Some((_, most)) = most.filter(|(_, most)| count > *most) {
            found.push(format!(
                "{name}: {count} lines; at most {most}: say it shorter, or on another page"
            ));
        }
        let mut is_code = false;
        for (number, line) in (1..).zip(page.lines()) {
            is_code ^= line.starts_with("```");
            // A row of a table and a picture cannot be broken.
            let is_prose = !is_code && !line.starts_with(['|', '!']);
            if is_prose && line.chars().count() > MAX_LINE {
                found.push(format!("{name}:{number}: more than {MAX_LINE} characters"));
            }
        }
    }
    assert!(found.is_empty(), "{} findings\n{}", found.len(), found.join("\n"));
}
