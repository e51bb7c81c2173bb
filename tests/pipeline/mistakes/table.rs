//! The mistakes, the files that have them, and parts of the messages.

/// A mistake.
pub(super) struct Mistake {
    /// What was done, in words.
    pub what: &'static str,
    /// The command line, words separated by blanks; `{job}` is the id of a finished job.
    pub command: &'static str,
    /// Parts of the message.
    pub parts: &'static [&'static str],
}

const fn mistake(
    what: &'static str,
    command: &'static str,
    parts: &'static [&'static str],
) -> Mistake {
    Mistake { what, command, parts }
}

/// Files with a mistake: name and content.
pub(super) const FILES: &[(&str, &str)] = &[
    ("comma.json", "{\n  \"design\": {\n    \"N\": 6\n    \"M\": 3\n  }\n}\n"),
    ("trailing.json", "{\n  \"design\": {\"N\": 6, \"M\": 3,}\n}\n"),
    (
        "brace.json",
        "{\n  \"design\": {\n    \"N\": 6,\n  \"gas\": {\n    \"species\": \"air\"\n  }\n}\n",
    ),
    ("quote.json", "{\n  \"design\": {\"fit\": \"height, \"N\": 6}\n}\n"),
    ("unit.json", "{\r\n\t\"design\": {\"height\": 1000 mm}\r\n}\r\n"),
    ("comment.json", "{\n  // six panels\n  \"design\": {\"N\": 6}\n}\n"),
    ("twice.json", "{\n  \"design\": {\"N\": 6, \"M\": 3, \"N\": 5}\n}\n"),
    ("python.json", "{'design': {'N': 6}}"),
    ("yaml.json", "design:\n  N: 6\n"),
    ("key.json", "{\n  \"film\": {\"thicknes\": \"25 um\"}\n}\n"),
    ("range.json", "{\n  \"design\": {\n    \"N\": 3\n  }\n}\n"),
    ("dimension.json", "{\"gas\": {\"mass_flow_rate\": \"5 g\"}}"),
    ("word.json", "{\"design\": {\"fit\": \"cones\"}}"),
    ("caps.json", "{\"solver\": {\"model\": \"Film\"}}"),
    ("strategy.json", "{\"strategies\": {\"late\": {}}, \"strategy\": \"lat\"}"),
    ("axis.json", "{\"grid\": {\"mass_flowrate\": [\"1 g/s\"]}}"),
    ("filter.json", "{\"grid\": {\"N\": [5, 6], \"filter\": \"n > 5\"}}"),
    ("empty.json", ""),
    ("png.json", "PAR1 and so on"),
    ("scene.json", "{\"format\": \"billow-scene\", \"mesh\": {\"positions\": \"spere.obj\"}}"),
    ("scene_key.json", "{\"format\": \"billow-scene\", \"mesh\": {\"position\": \"sphere.obj\"}}"),
    ("sphere.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
];

pub(super) const MISTAKES: &[Mistake] = &[
    // Study files.
    mistake(
        "a comma forgotten",
        "plan comma.json",
        &[
            "comma.json:3:11: design: ",
            "a comma is missing",
            "\n  3 |     \"N\": 6\n    |           ^\n",
            "next: write a comma here",
        ],
    ),
    mistake(
        "a comma too many",
        "plan trailing.json",
        &["trailing.json:2:28: design: ", "trailing comma", "next: remove it"],
    ),
    mistake(
        "a brace forgotten",
        "plan brace.json",
        &["brace.json:2:13: ", "this { is not closed", "next: add the missing }"],
    ),
    mistake(
        "a quote forgotten",
        "plan quote.json",
        &["quote.json:2:21: design", "no closing quote", "next: write the quote"],
    ),
    mistake(
        "a unit without quotes; tabs and Windows line ends",
        "plan unit.json",
        &["unit.json:2:23: design", "a number with a unit is a text", "next: write \"1000 mm\""],
    ),
    mistake(
        "a comment",
        "plan comment.json",
        &["comment.json:2:3: ", "comment", "next: remove it"],
    ),
    mistake(
        "a key given twice",
        "plan twice.json",
        &["twice.json:2:30: design", "\"N\" is given twice, first in line 2, column 14"],
    ),
    mistake(
        "Python's quotes",
        "plan python.json",
        &["python.json:1:2: ", "straight double quotes"],
    ),
    mistake("YAML for JSON", "plan yaml.json", &["yaml.json:1:1: ", "a file begins with {"]),
    mistake(
        "a misspelt key",
        "plan key.json",
        &[
            "key.json:2:24: film.thicknes = \"25 um\"",
            "did you mean thickness?",
            "allowed: youngs_modulus",
        ],
    ),
    mistake(
        "a value out of range",
        "plan range.json",
        &[
            "range.json:3:10: design.N = 3: is out of range",
            "allowed: a whole number, 4 to 1000",
            "next: write it as in \"N\": 6",
        ],
    ),
    mistake(
        "a unit of another dimension",
        "plan dimension.json",
        &["gas.mass_flow_rate = \"5 g\": is a mass, not a mass flow rate", "kg/s"],
    ),
    mistake(
        "a misspelt word",
        "plan word.json",
        &["design.fit = \"cones\"", "did you mean \"cone\"?", "allowed: cone, angles, height"],
    ),
    mistake(
        "a word in capitals",
        "plan caps.json",
        &["solver.model = \"Film\"", "did you mean \"film\"?"],
    ),
    mistake(
        "a misspelt strategy",
        "plan strategy.json",
        &["strategy = \"lat\"", "did you mean \"late\"?", "allowed: direct, late"],
    ),
    mistake(
        "a misspelt axis",
        "plan axis.json",
        &["grid.mass_flowrate", "did you mean mass_flow_rate?"],
    ),
    mistake(
        "a wrong name in a filter",
        "plan filter.json",
        &["no variable is called n", "did you mean N?", "^"],
    ),
    mistake(
        "an empty file",
        "plan empty.json",
        &["empty.json: is empty", "next: start from a file in studies/"],
    ),
    mistake(
        "the table in place of a study",
        "plan png.json",
        &["is a Parquet file", "next: name a study file"],
    ),
    // Files and folders.
    mistake(
        "a misspelt file",
        "plan gird.json",
        &["gird.json: cannot read the study file", "did you mean grid.json?"],
    ),
    mistake(
        "a file without its ending",
        "run grid",
        &["grid: cannot read the study file", "did you mean grid.json?"],
    ),
    mistake(
        "a folder in place of a study",
        "run results",
        &["results: cannot read the study file: it is a folder", "next: give the path"],
    ),
    mistake(
        "a misspelt results folder",
        "table gridd",
        &["gridd: neither a study file nor a results folder", "did you mean grid"],
    ),
    mistake(
        "the folder above the results",
        "status results",
        &["holds folders of results and is none itself", "allowed: results/broken, results/grid"],
    ),
    mistake(
        "several results and none named",
        "table",
        &["results of several studies", "allowed: results/broken, results/grid"],
    ),
    mistake(
        "a study in place of a scene",
        "solve grid.json",
        &["belongs to a study, not to a scene", "next: billow run grid.json"],
    ),
    mistake(
        "a scene in place of a study",
        "plan scene.json",
        &["is a scene, not a study", "next: billow solve scene.json"],
    ),
    mistake(
        "a misspelt mesh file",
        "solve scene.json",
        &["spere.obj: cannot read the file of mesh.positions", "did you mean sphere.obj?"],
    ),
    mistake(
        "a misspelt key of a scene",
        "solve scene_key.json",
        &["mesh.position", "did you mean positions?"],
    ),
    mistake(
        "a damaged table",
        "table broken",
        &["results/broken/summary.parquet: not a Parquet file", "next: run `billow run`"],
    ),
    mistake(
        "a file in place of a results folder",
        "run grid.json --results comma.json -q",
        &["comma.json: ", "next: it is a file and not a folder"],
    ),
    // The command line.
    mistake(
        "a misspelt command",
        "rnu grid.json",
        &[
            "command line: \"rnu\" is not a command; did you mean run?",
            "allowed: fold, plan",
            "next: billow run --help",
        ],
    ),
    mistake(
        "a misspelt option",
        "run grid.json --treads 2",
        &["run: unexpected argument --treads; did you mean --threads?", "next: billow run --help"],
    ),
    mistake(
        "an option of another command",
        "status grid --set N=6",
        &["status: unexpected argument --set", "next: --set is an option of: plan, advise, run"],
    ),
    mistake(
        "no study",
        "run",
        &["run: <STUDY> is missing", "allowed: billow run [OPTIONS] <STUDY>"],
    ),
    mistake(
        "a word for a number",
        "run grid.json --threads two",
        &["run: --threads = two: is not a whole number", "allowed: a whole number"],
    ),
    mistake(
        "a misspelt format",
        "table grid --format jsn",
        &["table: --format = jsn", "did you mean json?", "allowed: table, csv, json"],
    ),
    mistake(
        "two options that exclude each other",
        "table grid --json --format csv",
        &["--json cannot be used with --format"],
    ),
    mistake(
        "--set without a value",
        "plan grid.json --set N",
        &["--set N: has no `=`", "allowed: --set key=value"],
    ),
    mistake(
        "--set of a misspelt key",
        "plan grid.json --set thiknes=1",
        &["--set thiknes=1: ", "next: did you mean thickness?"],
    ),
    mistake(
        "--set of an unfinished list",
        "plan grid.json --set N=[5,6",
        &["--set N=[5,6: invalid JSON: this [ is not closed", "next: add the missing ]"],
    ),
    mistake(
        "--set of a misspelt key in a section",
        "plan grid.json --set film.thiknes=1",
        &["film.thiknes", "did you mean thickness?"],
    ),
    mistake(
        "a misspelt column",
        "table grid --columns peak_vzz",
        &["--columns = peak_vzz: no such column", "did you mean peak_vz?"],
    ),
    mistake(
        "a misspelt value in a condition",
        "table grid --where strategy=='dirct'",
        &["strategy is never 'dirct'; did you mean 'direct'?", "^"],
    ),
    mistake(
        "a misspelt status in a condition",
        "table grid --where status=='dnoe'",
        &["status is never 'dnoe'; did you mean 'done'?"],
    ),
    mistake(
        "a misspelt parameter",
        "compare grid --by stratgy --base direct",
        &["--by = stratgy", "did you mean strategy?", "allowed: "],
    ),
    mistake(
        "a misspelt value of a parameter",
        "compare grid --by strategy --base dirct",
        &["--base = dirct: not a value of strategy", "did you mean direct?"],
    ),
    mistake(
        "a misspelt history column",
        "chart grid --history z_cetre",
        &["--history = z_cetre: no such history column", "did you mean z_centre?"],
    ),
    mistake(
        "a job that does not exist",
        "job ffffff grid",
        &[
            "job = ffffff: no job has this id",
            "allowed: the first digits of one id: ",
            "next: billow table results/grid",
        ],
    ),
    mistake(
        "shapes of a model without shapes",
        "frames {job} grid",
        &["no frames in this file", "next: run it with solver.model \"film\""],
    ),
    mistake(
        "a misspelt case",
        "validate --case ptch",
        &["--case = ptch: unknown case", "did you mean patch?"],
    ),
    mistake(
        "a word that is no key",
        "keys xylophone",
        &["no key of a study file has \"xylophone\"", "next: billow keys prints every key"],
    ),
    mistake(
        "a shell that does not exist",
        "completions fsh",
        &["completions: <SHELL> = fsh", "did you mean fish?", "allowed: bash"],
    ),
    mistake(
        "zero threads",
        "run grid.json --threads 0",
        &["--threads = 0: zero threads cannot run a job", "allowed: 1 or more"],
    ),
];
