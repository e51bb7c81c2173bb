//! History files: back to the bit, same bytes twice, nothing foreign accepted.

#![expect(clippy::disallowed_methods, reason = "looks at the disk with its own eyes")]

use billow_solver::output::outcome::{Failure, FailureKind};

use super::*;
use crate::run::fixture;

fn path_with(bytes: &[u8]) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn encoded(samples: usize) -> (Job, Deployment, Vec<u8>) {
    let job = fixture::job(3);
    let deployment = fixture::deployment(3, samples);
    let hash = content_hash(&deployment);
    let bytes = encode(&job, &deployment, &hash).unwrap();
    (job, deployment, bytes)
}

#[test]
fn a_history_comes_back_to_the_bit_and_is_the_same_bytes_twice() {
    for samples in [0, 1, 7, CHUNKED_FROM, 3 * CHUNK / 2] {
        let (job, deployment, bytes) = encoded(samples);
        assert_eq!(bytes, encode(&job, &deployment, &content_hash(&deployment)).unwrap());
        let (_folder, path) = path_with(&bytes);
        let stored = read(&path).unwrap();
        assert_eq!(stored.history, deployment.history);
        assert_eq!(stored.job, job.id);
        assert_eq!(stored.status, "done");
        assert_eq!(stored.content_hash, hash_of(&stored.history, &[], None));
        assert_eq!(stored.scene, serde_json::to_string(&job.scene).unwrap());
    }
}

#[test]
fn a_failed_run_keeps_its_history_and_says_when_and_where() {
    let job = fixture::job(1);
    let mut deployment = fixture::deployment(1, 5);
    deployment.stop = Stop::Failed(Failure {
        kind: FailureKind::EnergyDrift,
        time: 0.25,
        place: "gas volume".to_owned(),
    });
    let bytes = encode(&job, &deployment, "").unwrap();
    let (_folder, path) = path_with(&bytes);
    assert_eq!(read(&path).unwrap().status, "energy_drift");
    let file = File::open(&path).unwrap();
    assert_eq!(read_number::<f64>(&file, "stop_time").unwrap().to_bits(), 0.25_f64.to_bits());
    assert_eq!(read_text(&file, "stop_place").unwrap(), "gas volume");
}

#[test]
fn the_content_hash_sees_every_bit_and_nothing_else() {
    let deployment = fixture::deployment(3, 20);
    let hash = content_hash(&deployment);
    assert_eq!(hash.len(), 64);
    let mut other = deployment.clone();
    other.steps += 1;
    assert_eq!(content_hash(&other), hash);
    let mut history = History::new();
    let mut values = [0.0; COLUMNS.len()];
    history.push(&values);
    let zero = hash_of(&history, &[], None);
    values[5] = -0.0;
    let mut history = History::new();
    history.push(&values);
    assert_ne!(hash_of(&history, &[], None), zero);
}

#[test]
fn foreign_newer_truncated_and_incomplete_files_are_refused() {
    let (_, _, bytes) = encoded(600);
    let refused = |bytes: &[u8]| {
        let (_folder, path) = path_with(bytes);
        read(&path).unwrap_err().to_string()
    };
    assert!(refused(b"not HDF5 at all").contains("no HDF5 file"));
    for length in [100, bytes.len() / 2, bytes.len() - 1] {
        refused(&bytes[..length]);
    }
    let edited = |edit: &dyn Fn(&File)| {
        let (folder, path) = path_with(&bytes);
        let file = File::open_rw(&path).unwrap();
        edit(&file);
        file.close().unwrap();
        let problem = read(&path).unwrap_err().to_string();
        drop(folder);
        problem
    };
    let newer = edited(&|file| file.attr("version").unwrap().write_scalar(&(VERSION + 1)).unwrap());
    assert!(newer.contains("version 2, this program reads up to 1"), "{newer}");
    let half = edited(&|file| file.attr("complete").unwrap().write_scalar(&0_u8).unwrap());
    assert!(half.contains("not complete"), "{half}");
    let foreign = edited(&|file| file.delete_attr("format").unwrap());
    assert!(foreign.contains("no billow history"), "{foreign}");
    let missing = edited(&|file| file.group("history").unwrap().unlink("volume").unwrap());
    assert!(missing.contains("damaged"), "{missing}");
}
