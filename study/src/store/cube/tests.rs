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
use crate::platform::hash::bytes_hash;
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
    results.write_study(&study.name, study.file(), &journal).unwrap();
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
            file_hash: Some(bytes_hash(&bytes)),
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
fn every_history_stands_at_its_point_with_the_parameters_as_coordinates() {
    let varied = r#""strategies": {"rapid": {"inflow": [{"from": 0, "to": "5 ms"}]},
                                   "late": {"inflow": [{"from": "1 ms", "to": "6 ms"}]}},
        "grid": {"strategy": ["rapid", "late"], "mass_flow_rate": ["1 g/s", "2 g/s"]}"#;
    let folder = ran(varied, &|number| Some(invented(number)));
    let written = folder.write(&[]).unwrap();
    assert_eq!((written.points, written.times, written.histories), (4, 7, 4));
    let file = File::open(folder.path()).unwrap();
    assert_eq!(file.dataset("z_rim").unwrap().shape(), [4, 7]);
    assert_eq!(numbers(&file, "point"), [0.0, 1.0, 2.0, 3.0]);
    assert_eq!(texts(&file, "strategy").len(), 4);
    assert_eq!(attribute(&file, "mass_flow_rate", "units"), "kg/s");
    let coordinates = attribute(&file, "z_rim", "coordinates");
    assert_eq!(attribute(&file, "status", "coordinates"), coordinates);
    assert!(coordinates.contains("strategy") && coordinates.contains("mass_flow_rate"));
    let (rims, jobs) = (numbers(&file, "z_rim"), texts(&file, "job"));
    for (number, point) in folder.stored.points.iter().enumerate() {
        assert_eq!(jobs[number], point.job.id.as_str());
        let history = invented(number).history;
        assert_eq!(rims[7 * number..7 * (number + 1)], *history.column("z_rim"));
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
fn what_a_point_does_not_have_is_nan_and_its_status_says_why() {
    // M 2 is infeasible; the first job is shorter; the third one has a column of its own.
    let varied = r#""grid": {"M": [3, 2], "mass_flow_rate": ["1 g/s", "2 g/s", "3 g/s", "4 g/s"]}"#;
    let run = |number: usize| {
        let mut deployment = fixture::deployment(1, if number == 0 { 4 } else { 7 });
        match number {
            1 => {
                let failure = Failure::new(AuditKind::EnergyLedger, 0.004, "gas volume");
                deployment.stop = Stop::Failed(failure);
            }
            2 => deployment.tracks.push(Track {
                name: "smallest_gap".to_owned(),
                unit: "m",
                meaning: "smallest gap",
                values: vec![0.5; 7],
            }),
            3 => return None,
            _ => {}
        }
        Some(deployment)
    };
    let folder = ran(varied, &run);
    folder.write(&["z_rim", "smallest_gap"]).unwrap();
    let file = File::open(folder.path()).unwrap();
    let status = texts(&file, "status");
    assert_eq!(status[..5], ["done", "energy_drift", "done", "pending", "infeasible"]);
    let finite = |name: &str| -> Vec<bool> {
        numbers(&file, name).iter().map(|value| value.is_finite()).collect()
    };
    let expected = |points: [usize; 4]| {
        let has = |point: usize, time: usize| time < points.get(point).copied().unwrap_or(0);
        (0..8).flat_map(|point| (0..7).map(move |time| has(point, time))).collect::<Vec<bool>>()
    };
    assert_eq!(finite("z_rim"), expected([4, 0, 7, 0]));
    assert_eq!(finite("smallest_gap"), expected([0, 0, 7, 0]));
    assert_eq!(attribute(&file, "smallest_gap", "units"), "m");
    assert!(!file.link_exists("pressure"), "only two columns are asked for");
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
    let done = done(&folder.stored, &folder.stored.table()).unwrap();
    let series = Series::of(&folder.stored, &done, &["z_rim".to_owned()]).unwrap();
    check_size(2, &series).unwrap();
    let error = check_size(400_000_000, &series).unwrap_err().to_string();
    assert!(error.contains("2800000000 values over time (21 GiB)"), "{error}");
    assert!(error.contains("up to 2147483648 values (16 GiB)"), "{error}");
    // A damaged history ends the export, and the old file stays.
    folder.write(&["z_rim"]).unwrap();
    let (old, id) = (bytes_of(&folder.path()), &folder.stored.points[1].job.id);
    files::write_atomic(&Disk, &folder.stored.results.job_path(id), b"damaged").unwrap();
    folder.write(&["z_rim"]).unwrap_err();
    assert_eq!(bytes_of(&folder.path()), old);
    let found = Disk.list(folder.folder.path()).unwrap();
    assert!(!found.iter().any(|path| files::is_temporary(path)), "{found:?}");
}

#[test]
fn the_time_axis_has_every_sample_once() {
    // 3 * 0.1 is larger than 0.3 by one bit.
    let (long, short) = ([0.0, 0.1, 0.2, 3.0 * 0.1, 0.4], [0.0, 0.1, 0.2, 0.3]);
    let times = union(&short, &long);
    assert_eq!(times, [0.0, 0.1, 0.2, 0.3, 0.4]);
    let times = union(&times, &[0.0, 0.1, 0.25]);
    assert_eq!(times, [0.0, 0.1, 0.2, 0.25, 0.3, 0.4]);
    let series = Series { times, columns: Vec::new() };
    let placed = series.placed(&[0.0, 0.1, 0.2, 3.0 * 0.1], &[1.0, 2.0, 3.0, 4.0]);
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&placed), bits(&[1.0, 2.0, 3.0, f64::NAN, 4.0, f64::NAN]));
}
