//! Folders show the flow: a room imports only from rooms below it, and no files import each other in a loop.
//!
//! `make layers` prints what each room imports. Tests inside a file (`mod tests`) and files of tests are left
//! out. A file may name items of the `mod.rs` above it, which is its name space.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{Attribute, Expr, Ident, ItemMod, ItemUse, Macro, Token, UseTree};

use crate::sources::{files, text};

/// Rooms of every crate, from the ground up.
const ROOMS: [(&str, &[&str]); 3] = [
    (
        "solver",
        &[
            "platform",
            "geometry",
            "scene",
            "mechanics",
            "factorisation",
            "bending",
            "collision",
            "output",
            "system",
            "integrators",
            "statics",
            "models",
        ],
    ),
    (
        "study",
        &[
            "platform",
            "input",
            "surrogate",
            "job",
            "accuracy",
            "scene",
            "study",
            "store",
            "run",
            "cluster",
            "analysis",
            "print",
            "render",
            "chart",
            "report",
            "cli",
        ],
    ),
    ("tests/checks", &["output", "cases", "exact", "stability", "bench", "convergence"]),
];

/// Modules by path (`collision::contact::ccd`), and the paths each one names.
type Modules = BTreeMap<Vec<String>, BTreeSet<Vec<String>>>;

/// The module a file is, from its path below `src`.
fn module(path: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        path.with_extension("").iter().map(|name| name.to_string_lossy().into_owned()).collect();
    if names.last().is_some_and(|name| name == "mod") {
        names.pop();
    }
    names
}

fn is_test(path: &Path) -> bool {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    name == "tests" || name.ends_with("_tests") || name == "fixture"
}

/// Collects the paths of a file, without its tests.
#[derive(Default)]
struct Paths(Vec<Vec<String>>);

impl Paths {
    /// Adds the paths of a use tree below a path.
    fn add_tree(&mut self, tree: &UseTree, mut path: Vec<String>) {
        match tree {
            UseTree::Path(part) => {
                path.push(part.ident.to_string());
                return self.add_tree(&part.tree, path);
            }
            UseTree::Group(group) => {
                return group.items.iter().for_each(|item| self.add_tree(item, path.clone()));
            }
            UseTree::Name(name) => path.push(name.ident.to_string()),
            UseTree::Rename(name) => path.push(name.ident.to_string()),
            UseTree::Glob(_) => {}
        }
        self.0.push(path);
    }
}

impl Visit<'_> for Paths {
    fn visit_item_mod(&mut self, module: &ItemMod) {
        let is_test = |attribute: &Attribute| {
            attribute.path().is_ident("cfg")
                && attribute.parse_args::<Ident>().is_ok_and(|name| name == "test")
        };
        if !module.attrs.iter().any(is_test) {
            visit::visit_item_mod(self, module);
        }
    }

    fn visit_item_use(&mut self, item: &ItemUse) {
        self.add_tree(&item.tree, Vec::new());
    }

    fn visit_path(&mut self, path: &syn::Path) {
        self.0.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }

    /// The arguments of a macro, where it is called as a function.
    fn visit_macro(&mut self, call: &Macro) {
        let arguments = call.parse_body_with(Punctuated::<Expr, Token![,]>::parse_terminated);
        arguments.iter().flatten().for_each(|argument| self.visit_expr(argument));
    }
}

/// A named path as a path from the crate's root.
fn from_root(path: &[String], module: &[String], is_folder: bool) -> Vec<String> {
    let mut base: Vec<String> = module.to_vec();
    if !is_folder && path[0] == "self" {
        return module.to_vec();
    }
    let mut rest = path;
    if rest[0] == "crate" {
        return rest[1..].to_vec();
    }
    while let Some(first) = rest.first() {
        match first.as_str() {
            "super" => {
                base.pop();
            }
            "self" => {}
            _ => break,
        }
        rest = &rest[1..];
    }
    base.extend(rest.iter().cloned());
    base
}

fn read(sources: &[(Vec<String>, bool, String)]) -> Modules {
    let known: BTreeSet<&Vec<String>> = sources.iter().map(|(module, _, _)| module).collect();
    let mut modules = Modules::new();
    for (module, is_folder, source) in sources {
        let imports = modules.entry(module.clone()).or_default();
        let mut paths = Paths::default();
        paths.visit_file(&syn::parse_file(source).expect("Rust"));
        let relative = |path: &&Vec<String>| matches!(path[0].as_str(), "crate" | "super" | "self");
        for path in paths.0.iter().filter(relative) {
            let mut target = from_root(path, module, *is_folder);
            while !target.is_empty() && !known.contains(&target) {
                target.pop();
            }
            if target != *module && !target.is_empty() {
                imports.insert(target);
            }
        }
    }
    modules
}

fn crate_modules(name: &str) -> Modules {
    let folder = format!("{name}/src");
    let sources: Vec<_> = files(&folder, ".rs")
        .into_iter()
        .filter(|path| !is_test(path))
        .map(|path| {
            let below = path.strip_prefix(&folder).expect("below src");
            let is_folder = path.file_name().is_some_and(|name| name == "mod.rs");
            (module(below), is_folder, text(&path))
        })
        .collect();
    read(&sources)
}

/// Imports that run from a room to one above it, or out of any room.
fn upward(modules: &Modules, rooms: &[&str]) -> Vec<String> {
    let floor = |room: &str| rooms.iter().position(|known| *known == room);
    let mut found = Vec::new();
    for (module, imports) in
        modules.iter().filter(|(module, _)| module[0] != "lib" && module[0] != "main")
    {
        let Some(floor_here) = floor(&module[0]) else {
            found.push(format!("{} is in no room", module.join("::")));
            continue;
        };
        for import in imports {
            if floor(&import[0]).is_none_or(|other| other > floor_here) {
                found.push(format!("{} imports {}", module.join("::"), import.join("::")));
            }
        }
    }
    found
}

/// A loop of imports between files, if there is one. The folder a file lies in is no import.
fn circle(modules: &Modules) -> Option<Vec<String>> {
    fn visit<'a>(
        module: &'a Vec<String>,
        modules: &'a Modules,
        state: &mut BTreeMap<&'a Vec<String>, bool>,
        visited: &mut Vec<&'a Vec<String>>,
    ) -> Option<Vec<String>> {
        match state.get(module) {
            Some(true) => return None,
            Some(false) => {
                let start = visited.iter().position(|known| *known == module).unwrap_or(0);
                return Some(visited[start..].iter().map(|module| module.join("::")).collect());
            }
            None => {}
        }
        state.insert(module, false);
        visited.push(module);
        for import in modules.get(module).into_iter().flatten() {
            let name_space = module.starts_with(import);
            if !name_space && let Some(found) = visit(import, modules, state, visited) {
                return Some(found);
            }
        }
        visited.pop();
        state.insert(module, true);
        None
    }
    let mut state = BTreeMap::new();
    modules.keys().find_map(|module| visit(module, modules, &mut state, &mut Vec::new()))
}

#[test]
fn layers_rooms_import_only_from_rooms_below() {
    for (name, rooms) in ROOMS {
        let modules = crate_modules(name);
        assert!(modules.values().map(BTreeSet::len).sum::<usize>() > 100, "imports are read");
        for room in rooms {
            let below: BTreeSet<&str> = modules
                .iter()
                .filter(|(module, _)| module[0] == *room)
                .flat_map(|(_, imports)| imports.iter().map(|import| import[0].as_str()))
                .filter(|other| other != room)
                .collect();
            println!("{name:>7} {room:<12} imports {below:?}");
        }
        assert_eq!(upward(&modules, rooms), Vec::<String>::new(), "{name}");
    }
}

/// What the monitor must not use, because it checks contact.
const UNSHARED_WITH_MONITOR: [&str; 2] = ["broad_phase", "contact"];

#[test]
fn layers_the_monitor_shares_no_code_with_contact() {
    let modules = crate_modules("solver");
    let is_in = |module: &[String], folder: &str| {
        module.len() > 1 && module[0] == "collision" && module[1] == folder
    };
    let of_monitor: Vec<_> =
        modules.iter().filter(|(module, _)| is_in(module, "monitor")).collect();
    assert!(of_monitor.len() > 5, "the monitor's files are read");
    for (module, imports) in of_monitor {
        for import in imports {
            let shared = UNSHARED_WITH_MONITOR.iter().any(|folder| is_in(import, folder));
            assert!(!shared, "{} imports {}", module.join("::"), import.join("::"));
        }
    }
}

#[test]
fn layers_no_files_import_each_other_in_a_loop() {
    for (name, _) in ROOMS {
        assert_eq!(circle(&crate_modules(name)), None, "{name}");
    }
}

#[test]
fn layers_upward_imports_and_loops_are_found() {
    let file = |module: &str, source: &str| {
        let names = module.split("::").map(str::to_owned).collect();
        (names, module.ends_with("mod"), source.to_owned())
    };
    let sound = [
        file("low::a", "use super::b::B; // crate::high::c"),
        file(
            "low::b",
            "fn text() { \"crate::high::c\"; }\n#[cfg(test)]\nmod tests { use crate::high::c::C; }",
        ),
        file("high::c", "use crate::{low::{a::A, b}, high::d};"),
        file("high::d", ""),
    ];
    let modules = read(&sound);
    assert_eq!(upward(&modules, &["low", "high"]), Vec::<String>::new());
    assert_eq!(circle(&modules), None);
    let path = |module: &str| module.split("::").map(str::to_owned).collect::<Vec<_>>();
    let of_c: Vec<_> = modules[&path("high::c")].iter().cloned().collect();
    assert_eq!(of_c, [path("high::d"), path("low::a"), path("low::b")]);

    let mut looped = sound.clone();
    looped[1].2 = "use super::a::A;".to_owned();
    assert_eq!(circle(&read(&looped)), Some(vec!["low::a".to_owned(), "low::b".to_owned()]));
    let mut upside = sound;
    upside[0].2 = "use crate::{low::b, high::{d::D}};".to_owned();
    assert_eq!(upward(&read(&upside), &["low", "high"]), ["low::a imports high::d"]);
}
