//! History files: bits, same bytes twice, old names, refused files.

#![expect(clippy::disallowed_methods, reason = "tests read and write files directly")]

use billow_solver::output::events::{Event, EventKind};
use billow_solver::output::history::{COLUMNS, History};
use billow_solver::output::outcome::{AuditKind, Deployment, Failure, FailureKind, Stop};

use super::*;
use crate::job::{Job, Status};
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
fn a_history_is_read_back_bit_for_bit_and_written_twice_as_the_same_bytes() {
    for samples in [0, 1, 7, MIN_CHUNKED_SAMPLES, 3 * MAX_CHUNK_SAMPLES / 2] {
        let (job, deployment, bytes) = encoded(samples);
        assert_eq!(bytes, encode(&job, &deployment, &content_hash(&deployment)).unwrap());
        let (_folder, path) = path_with(&bytes);
        let stored = read(&path).unwrap();
        assert_eq!(stored.history, deployment.history);
        assert_eq!(stored.job, job.id);
        assert_eq!(stored.status, Status::Done);
        assert_eq!(stored.content_hash, hash_of(&stored.history, &[], None));
        assert_eq!(stored.scene, serde_json::to_string(&*job.scene).unwrap());
    }
}

#[test]
fn events_are_read_back_and_do_not_enter_the_content_hash() {
    let (job, mut deployment, bytes) = encoded(3);
    let (_folder, path) = path_with(&bytes);
    assert!(read(&path).unwrap().events.is_empty());
    let event = |time: f64, kind| Event { time, kind };
    deployment.events = vec![event(0.1 + 0.2, EventKind::Quiescent), event(0.5, EventKind::Active)];
    let hash = content_hash(&deployment);
    let (_folder, path) = path_with(&encode(&job, &deployment, &hash).unwrap());
    let stored = read(&path).unwrap();
    assert_eq!(stored.events, deployment.events);
    assert_eq!(stored.content_hash, hash_of(&stored.history, &[], None));
}

#[test]
fn a_failed_run_stores_its_history_and_when_and_where_it_stopped() {
    let job = fixture::job(1);
    let mut deployment = fixture::deployment(1, 5);
    deployment.stop = Stop::Failed(Failure::new(AuditKind::EnergyLedger, 0.25, "gas volume"));
    let bytes = encode(&job, &deployment, "").unwrap();
    let (_folder, path) = path_with(&bytes);
    assert_eq!(read(&path).unwrap().status, Status::Failed(FailureKind::EnergyDrift));
    let file = File::open(&path).unwrap();
    assert_eq!(read_number::<f64>(&file, "stop_time").unwrap().to_bits(), 0.25_f64.to_bits());
    assert_eq!(read_text(&file, "stop_location").unwrap(), "gas volume");
}

#[test]
fn the_content_hash_depends_on_every_bit_of_the_values_and_on_nothing_else() {
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
fn truncated_newer_incomplete_and_other_files_are_refused() {
    let (_, _, bytes) = encoded(600);
    let refused = |bytes: &[u8]| {
        let (_folder, path) = path_with(bytes);
        read(&path).unwrap_err().to_string()
    };
    assert!(refused(b"not HDF5 at all").contains("not an HDF5 file"));
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
    let versions = format!("version {}, this program reads version {VERSION}", VERSION + 1);
    assert!(newer.contains(&versions), "{newer}");
    let half = edited(&|file| file.attr("complete").unwrap().write_scalar(&0_u8).unwrap());
    assert!(half.contains("not complete"), "{half}");
    let other = edited(&|file| file.delete_attr("format").unwrap());
    assert!(other.contains("not a billow history"), "{other}");
    let missing = edited(&|file| file.group("history").unwrap().unlink("volume").unwrap());
    assert!(missing.contains("damaged"), "{missing}");
}
