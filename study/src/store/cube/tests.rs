//! Cubes of small studies, read back with HDF5.

use std::path::PathBuf;

use billow_solver::output::history::Track;
use billow_solver::output::outcome::{AuditKind, Deployment, Failure, Stop};
use hdf5::File;
use hdf5::types::VarLenUnicode;

use super::*;
use crate::job::executor::Outcome;
use crate::job::row::Cells;
use crate::platform::files::{Disk, Files};
use crate::run::fixture;
use crate::store::history_file;
use crate::store::journal::{Journal, Record};
use crate::store::results::Results;
use crate::store::stored::planned;
use crate::study::{MAX_POINTS, Study};

/// Results of a study whose jobs `run` computes; `None` for a job that has not run.
struct Folder {
    folder: tempfile::TempDir,
    stored: Stored<'static>,
}

fn ran(varied: &str, run: &dyn Fn(usize) -> Option<Deployment>) -> Folder {
    let text = format!(
        r#"{{"design": {{"fit": "height", "N": 6, "M": 3, "bottom_radius": 0.5, "height": 1, "alpha1_over_phi": 1}},
            "gas": {{"mass_flow_rate": "2 g/s"}},
            "solver": {{"model": "piston", "end_time": "6 ms"}}, {varied}}}"#
    );
    let study = Study::from_text(&text, "cube.json", "cube", &[], MAX_POINTS).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let results = Results::new(&Disk, folder.path());
    let mut journal = Journal::default();
    results.write_study(&study.name, &study.resolved(), &journal).unwrap();
    let points = planned(&study, &journal);
    for (number, point) in points.iter().enumerate() {
        if point.infeasible.is_some() {
            continue;
        }
        let Some(deployment) = run(number) else { continue };
        let hash = history_file::content_hash(&deployment);
        let bytes = history_file::encode(&point.job, &deployment, &hash).unwrap();
        results.write_job(&point.job.id, &bytes).unwrap();
        let outcome = Outcome::Ran { deployment: Box::new(deployment), seconds: 0.5, steps: 100 };
        let record = Record {
            job: point.job.id.clone(),
            cells: Cells::of(&point.job, &outcome, Some(&hash)).unwrap(),
            file_hash: Some(history_file::bytes_hash(&bytes)),
            file_stamp: None,
        };
        journal.records.insert(record.job.clone(), record);
    }
    let units = study.display_units().clone();
    Folder { folder, stored: Stored { results, study, units, journal, points } }
}

impl Folder {
    fn path(&self) -> PathBuf {
        self.folder.path().join("cube.nc")
    }

    fn write(&self, columns: &[&str]) -> Result<Written> {
        let columns: Vec<String> = columns.iter().map(|name| (*name).to_owned()).collect();
        write(&self.stored, &columns, &self.path())
    }
}

fn invented(number: usize) -> Deployment {
    fixture::deployment(u32::try_from(number).unwrap(), 7)
}

fn numbers(file: &File, name: &str) -> Vec<f64> {
    file.dataset(name).unwrap().read_raw::<f64>().unwrap()
}

fn texts(file: &File, name: &str) -> Vec<String> {
    let texts = file.dataset(name).unwrap().read_raw::<VarLenUnicode>().unwrap();
    texts.iter().map(ToString::to_string).collect()
}

fn attribute(file: &File, name: &str, attribute: &str) -> String {
    let attribute = file.dataset(name).unwrap().attr(attribute).unwrap();
    attribute.read_scalar::<VarLenUnicode>().unwrap().to_string()
}

#[test]
fn every_history_stands_at_its_point_of_the_grid() {
    let varied = r#""strategies": {"rapid": {"inflow": [{"from": 0, "to": "5 ms"}]},
                                   "late": {"inflow": [{"from": "1 ms", "to": "6 ms"}]}},
        "replicates": {"seed": 2},
        "grid": {"strategy": ["rapid", "late"],
                 "zip": [{"mass_flow_rate": ["1 g/s", "2 g/s", "3 g/s"], "film.thickness": [2e-5, 2e-5, 3e-5]}]}"#;
    let folder = ran(varied, &|number| Some(invented(number)));
    let written = folder.write(&[]).unwrap();
    let named = |name: &str, length: usize| (name.to_owned(), length);
    let dimensions =
        [named("strategy", 2), named("mass_flow_rate", 3), named("seed", 2), named("time", 7)];
    let mut found = written.dimensions.clone();
    found[..2].sort_by(|a, b| b.0.cmp(&a.0));
    assert_eq!(found, dimensions);
    assert_eq!((written.no_product, folder.stored.points.len() >= written.jobs), (None, true));

    let file = File::open(folder.path()).unwrap();
    let rim = file.dataset("z_rim").unwrap();
    let lengths: Vec<usize> = written.dimensions.iter().map(|(_, length)| *length).collect();
    assert_eq!(rim.shape(), lengths);
    assert_eq!(texts(&file, "strategy").len(), 2);
    assert_eq!(numbers(&file, "thickness"), [2e-5, 2e-5, 3e-5]);
    assert_eq!(attribute(&file, "thickness", "units"), "m");
    assert_eq!(attribute(&file, "mass_flow_rate", "units"), "kg/s");
    assert_eq!(attribute(&file, "z_rim", "coordinates"), "thickness");
    assert_eq!(attribute(&file, "status", "coordinates"), "thickness");
    assert_eq!(texts(&file, "status"), vec!["done"; 12]);

    // Each position has the history of its job.
    let (rims, jobs) = (numbers(&file, "z_rim"), texts(&file, "job"));
    for (number, point) in folder.stored.points.iter().enumerate() {
        let position = jobs.iter().position(|job| *job == point.job.id.as_str()).unwrap();
        let stored = fixture::deployment(u32::try_from(number).unwrap(), 7);
        assert_eq!(rims[7 * position..7 * (position + 1)], *stored.history.column("z_rim"));
    }
    for name in file.member_names().unwrap() {
        for label in ["units", "long_name"] {
            assert!(file.dataset(&name).unwrap().attr(label).is_ok(), "{name} without {label}");
        }
    }
    let text = file.attr("study").unwrap().read_scalar::<VarLenUnicode>().unwrap();
    assert_eq!(text.as_bytes(), bytes_of(&folder.stored.results.study_path()));
    // A column of the table with the name of a history column.
    assert!(file.link_exists("ledger_residual") && file.link_exists("ledger_residual_of_job"));
}

fn bytes_of(path: &Path) -> Vec<u8> {
    Disk.read(path).unwrap()
}

#[test]
fn points_without_values_are_nan_and_their_status_says_why() {
    // The filter removes 3 g/s with M 3; M 2 is infeasible.
    let varied = r#""grid": {"M": [3, 2], "mass_flow_rate": ["1 g/s", "2 g/s", "3 g/s"],
                             "filter": "M == 2 or mass_flow_rate < '2.5 g/s'"}"#;
    let run = |number: usize| {
        let mut deployment = fixture::deployment(1, if number == 0 { 4 } else { 7 });
        if number == 1 {
            let failure = Failure::new(AuditKind::EnergyLedger, 0.004, "gas volume");
            deployment.stop = Stop::Failed(failure);
        }
        Some(deployment)
    };
    let folder = ran(varied, &run);
    folder.write(&["z_rim"]).unwrap();
    let file = File::open(folder.path()).unwrap();
    assert_eq!(
        texts(&file, "status"),
        ["done", "energy_drift", NOT_PLANNED, "infeasible", "infeasible", "infeasible"]
    );
    let rims = numbers(&file, "z_rim");
    assert_eq!(rims.len(), 6 * 4);
    assert!(rims[..4].iter().all(|value| value.is_finite()));
    assert!(rims[4..].iter().all(|value| value.is_nan()));
    assert!(texts(&file, "verdict")[2..].iter().all(String::is_empty));
    assert!(!file.link_exists("pressure"), "only z_rim is asked for");
}

#[test]
fn jobs_of_different_lengths_share_one_time_axis() {
    let varied = r#""grid": {"solver.end_time": ["3 ms", "6 ms"]}"#;
    let run = |number: usize| Some(fixture::deployment(1, if number == 0 { 4 } else { 7 }));
    let folder = ran(varied, &run);
    folder.write(&[]).unwrap();
    let file = File::open(folder.path()).unwrap();
    assert_eq!(numbers(&file, "time").len(), 7);
    let pressure = numbers(&file, "pressure");
    assert!(pressure[..4].iter().chain(&pressure[7..]).all(|value| value.is_finite()));
    assert!(pressure[4..7].iter().all(|value| value.is_nan()));

    let varied = r#""grid": {"outputs.sample_interval": ["1 ms", "2 ms"]}"#;
    let error = ran(varied, &run).write(&[]).unwrap_err().to_string();
    assert!(error.contains("outputs.sample_interval: its jobs have several values"), "{error}");
    assert!(error.contains("0.001 s, 0.002 s") && error.contains("--set"), "{error}");
}

#[test]
fn a_column_that_one_job_has_is_nan_in_the_others() {
    let varied = r#""grid": {"mass_flow_rate": ["1 g/s", "2 g/s"]}"#;
    let folder = ran(varied, &|number| {
        let mut deployment = fixture::deployment(1, 7);
        if number == 1 {
            deployment.tracks.push(Track {
                name: "smallest_gap".to_owned(),
                unit: "m",
                meaning: "smallest gap",
                values: vec![0.5; 7],
            });
        }
        Some(deployment)
    });
    folder.write(&[]).unwrap();
    let file = File::open(folder.path()).unwrap();
    let gaps = numbers(&file, "smallest_gap");
    assert!(gaps[..7].iter().all(|gap| gap.is_nan()));
    assert_eq!(gaps[7..], [0.5; 7]);
    assert_eq!(attribute(&file, "smallest_gap", "units"), "m");
}

#[test]
fn a_study_of_single_points_has_the_dimension_point() {
    let varied =
        r#""grid": {"points": [{"mass_flow_rate": "1 g/s"}, {"mass_flow_rate": "3 g/s"}]}"#;
    let folder = ran(varied, &|number| Some(invented(number)));
    let written = folder.write(&["z_rim"]).unwrap();
    assert_eq!(written.no_product, Some(NoProduct::SinglePoints));
    assert_eq!(written.dimensions[0], ("point".to_owned(), 2));
    let file = File::open(folder.path()).unwrap();
    assert_eq!(numbers(&file, "mass_flow_rate"), [0.001, 0.003]);
    assert_eq!(attribute(&file, "z_rim", "coordinates"), "mass_flow_rate");
}

#[test]
fn what_cannot_be_a_cube_is_refused_and_nothing_is_written() {
    let varied = r#""grid": {"mass_flow_rate": ["1 g/s", "2 g/s"]}"#;
    let none = ran(varied, &|_| None);
    let error = none.write(&[]).unwrap_err().to_string();
    assert!(error.contains("no job is done") && error.contains("billow run"), "{error}");
    let folder = ran(varied, &|number| Some(invented(number)));
    let error = folder.write(&["z_rin"]).unwrap_err().to_string();
    assert!(error.contains("did you mean z_rim?"), "{error}");
    let table = folder.stored.table();
    let mut layout = Layout::of(&folder.stored.study, &table).unwrap();
    let done = done(&folder.stored, &table, &layout).unwrap();
    let series = Series::of(&folder.stored, &done, &["z_rim".to_owned()]).unwrap();
    check_size(&layout, &series).unwrap();
    layout.dimensions[0].1 = 400_000_000;
    let error = check_size(&layout, &series).unwrap_err().to_string();
    assert!(error.contains("2800000000 values over time (21 GiB)"), "{error}");
    assert!(error.contains("up to 2147483648 values (16 GiB)"), "{error}");
    // A damaged history ends the export, and the old file stays.
    folder.write(&["z_rim"]).unwrap();
    let (old, id) = (bytes_of(&folder.path()), &folder.stored.points[1].job.id);
    files::write_atomic(&Disk, &folder.stored.results.job_path(id), b"damaged").unwrap();
    folder.write(&["z_rim"]).unwrap_err();
    assert_eq!(bytes_of(&folder.path()), old);
    let left = Disk.list(folder.folder.path()).unwrap();
    assert!(!left.iter().any(|path| files::is_temporary(path)), "{left:?}");
}
