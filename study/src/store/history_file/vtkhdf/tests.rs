//! Frames: bits, the layout that VTK reads, refused files.

#![expect(clippy::disallowed_methods, reason = "tests read and write files directly")]

use std::thread::sleep;
use std::time::Duration;

use hdf5::types::TypeDescriptor;
use proptest::prelude::*;

use super::super::{content_hash, encode, read_frames, read_number};
use super::*;
use crate::run::fixture;

fn encoded(frames: Option<Frames>) -> Vec<u8> {
    let deployment =
        billow_solver::output::outcome::Deployment { frames, ..fixture::deployment(3, 5) };
    encode(&fixture::job(3), &deployment, &content_hash(&deployment)).unwrap()
}

fn path_with(bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn read_back(bytes: &[u8]) -> Result<Option<Frames>> {
    let (_folder, path) = path_with(bytes);
    let Some(stored) = read_frames(&path)? else { return Ok(None) };
    let frames = (0..stored.times().len()).map(|number| stored.frame(number));
    Ok(Some(Frames {
        triangles: stored.triangles().to_vec(),
        storeys: stored.storeys().to_vec(),
        frames: frames.collect::<Result<_>>()?,
    }))
}

#[test]
fn a_file_without_frames_gives_none() {
    assert_eq!(read_back(&encoded(None)).unwrap(), None);
}

#[test]
fn the_layout_is_that_of_vtkhdf() {
    let (_folder, path) = path_with(&encoded(Some(fixture::frames(1, 3))));
    let file = File::open(&path).unwrap();
    let group = file.group("VTKHDF").unwrap();
    let kind = group.attr("Type").unwrap();
    assert_eq!(kind.dtype().unwrap().to_descriptor().unwrap(), TypeDescriptor::FixedAscii(16));
    assert_eq!(kind.read_scalar::<FixedAscii<16>>().unwrap().as_str(), "UnstructuredGrid");
    assert_eq!(group.attr("Version").unwrap().read_raw::<i64>().unwrap(), [2, 0]);
    let integers = |name: &str| group.dataset(name).unwrap().read_raw::<i64>().unwrap();
    assert_eq!(integers("NumberOfPoints"), [4]);
    assert_eq!(integers("NumberOfCells"), [2]);
    assert_eq!(integers("NumberOfConnectivityIds"), [6]);
    assert_eq!(integers("Offsets"), [0, 3, 6]);
    assert_eq!(integers("Connectivity"), [0, 1, 2, 1, 3, 2]);
    assert_eq!(group.dataset("Types").unwrap().read_raw::<u8>().unwrap(), [5, 5]);
    let points = group.dataset("Points").unwrap();
    assert_eq!(points.shape(), [12, 3]);
    assert_eq!(points.chunk().unwrap(), [4, 3], "one chunk per frame");
    assert_eq!(points.dtype().unwrap().size(), 4);

    let steps = group.group("Steps").unwrap();
    assert_eq!(read_number::<i64>(&steps, "NSteps").unwrap(), 3);
    let times = steps.dataset("Values").unwrap().read_raw::<f64>().unwrap();
    assert_eq!(times, [0.0, 0.1, 0.2]);
    for (name, expected) in [
        ("NumberOfParts", [1, 1, 1]),
        ("PartOffsets", [0; 3]),
        ("PointOffsets", [0, 4, 8]),
        ("CellOffsets", [0; 3]),
        ("ConnectivityIdOffsets", [0; 3]),
        ("CellDataOffsets/storey", [0; 3]),
        ("CellDataOffsets/regime", [0, 2, 4]),
    ] {
        assert_eq!(integers(&format!("Steps/{name}")), expected, "{name}");
    }
    let cells = group.group("CellData").unwrap();
    assert_eq!(cells.dataset("storey").unwrap().read_raw::<u32>().unwrap(), [0, 1]);
    let regimes = cells.dataset("regime").unwrap();
    assert_eq!(regimes.read_raw::<u8>().unwrap(), [0, 1, 1, 2, 2, 0]);
    assert_eq!(regimes.chunk().unwrap(), [2]);
}

#[test]
fn no_time_of_day_is_stored() {
    let first = encoded(Some(fixture::frames(1, 3)));
    // HDF5 stores creation times in seconds.
    sleep(Duration::from_millis(1_100));
    assert!(first == encoded(Some(fixture::frames(1, 3))));
}

#[test]
fn the_content_hash_depends_on_every_frame() {
    let hash = |frames: Option<Frames>| {
        content_hash(&billow_solver::output::outcome::Deployment {
            frames,
            ..fixture::deployment(3, 5)
        })
    };
    let frames = || fixture::frames(1, 3);
    let edited = |edit: &dyn Fn(&mut Frames)| {
        let mut frames = frames();
        edit(&mut frames);
        hash(Some(frames))
    };
    let hashes = [
        hash(None),
        hash(Some(frames())),
        edited(&|frames| frames.triangles[1][0] = 0),
        edited(&|frames| frames.storeys[0] = 2),
        edited(&|frames| frames.frames[2].time = 0.3),
        edited(&|frames| frames.frames[2].positions[3][2] = 0.0),
        edited(&|frames| frames.frames[0].regimes[0] = Regime::Taut),
        edited(&|frames| drop(frames.frames.pop())),
        edited(&|frames| frames.frames[1].velocities[2][0] = 9.0),
        edited(&|frames| frames.frames[1].stresses[1][0] = 9.0),
        edited(&|frames| frames.frames[1].gaps[0] = 9.0),
        edited(&|frames| frames.frames.iter_mut().for_each(|frame| frame.gaps.clear())),
    ];
    for (index, hash) in hashes.iter().enumerate() {
        assert!(!hashes[..index].contains(hash), "{index}");
    }
    assert_eq!(hash(Some(frames())), hashes[1]);
}

#[test]
fn fields_are_stored_for_vtk_and_frames_without_contact_have_no_gaps() {
    let (_folder, path) = path_with(&encoded(Some(fixture::frames(1, 3))));
    let group = File::open(&path).unwrap().group("VTKHDF").unwrap();
    let velocity = group.dataset("PointData/velocity").unwrap();
    assert_eq!((velocity.shape(), velocity.chunk().unwrap()), (vec![12, 3], vec![4, 3]));
    assert_eq!(group.dataset("PointData/gap").unwrap().shape(), [12]);
    for (name, expected) in [
        ("PointDataOffsets/velocity", [0, 4, 8]),
        ("PointDataOffsets/gap", [0, 4, 8]),
        ("CellDataOffsets/principal_stress_1", [0, 2, 4]),
        ("CellDataOffsets/principal_stress_2", [0, 2, 4]),
    ] {
        let offsets = group.dataset(&format!("Steps/{name}")).unwrap().read_raw::<i64>().unwrap();
        assert_eq!(offsets, expected, "{name}");
    }
    let stress = group.dataset("CellData/principal_stress_1").unwrap();
    assert_eq!(stress.read_raw::<f32>().unwrap(), [2e6, 0.0, 2e6, 0.0, 2e6, 0.0]);

    let mut free = fixture::frames(1, 3);
    free.frames.iter_mut().for_each(|frame| frame.gaps.clear());
    let bytes = encoded(Some(free.clone()));
    assert_eq!(read_back(&bytes).unwrap().unwrap(), free);
    let (_folder, path) = path_with(&bytes);
    let group = File::open(&path).unwrap().group("VTKHDF").unwrap();
    assert!(!group.link_exists("PointData/gap") && group.link_exists("PointData/velocity"));
}

#[test]
fn damaged_frames_are_refused_with_the_name_of_the_file() {
    let bytes = encoded(Some(fixture::frames(1, 3)));
    let edited = |edit: &dyn Fn(&Group)| {
        let (_folder, path) = path_with(&bytes);
        let file = File::open_rw(&path).unwrap();
        edit(&file.group("VTKHDF").unwrap());
        file.close().unwrap();
        read_back(&std::fs::read(&path).unwrap()).unwrap_err().to_string()
    };
    let set = |group: &Group, name: &str, values: &[f64]| {
        // HDF5 converts.
        group.dataset(name).unwrap().write_raw(values).unwrap();
    };
    for (problem, edit) in [
        ("", &(|group: &Group| group.unlink("Points").unwrap()) as &dyn Fn(&Group)),
        ("", &|group| group.unlink("Steps").unwrap()),
        ("an element with an unknown node", &|group| {
            set(group, "Connectivity", &[0.0, 1.0, 2.0, 1.0, 4.0, 2.0]);
        }),
        ("invalid number of nodes", &|group| set(group, "NumberOfPoints", &[-4.0])),
        ("the size of the frames", &|group| set(group, "NumberOfPoints", &[5.0])),
        ("frames out of order", &|group| set(group, "Steps/Values", &[0.0, 0.2, 0.1])),
        ("frame 2 has unknown regimes", &|group| {
            set(group, "CellData/regime", &[0.0, 1.0, 1.0, 2.0, 2.0, 3.0]);
        }),
        ("PointData/velocity has another size", &|group| {
            group.unlink("PointData/velocity").unwrap();
            let points = group.group("PointData").unwrap();
            points.new_dataset::<f32>().shape((11, 3)).create("velocity").unwrap();
        }),
        ("frame 1 has non-finite positions", &|group| {
            let mut points = [0.0; 36];
            points[20] = f64::NAN;
            set(group, "Points", &points);
        }),
    ] {
        let message = edited(edit);
        assert!(message.contains("a.h5: damaged history file: "), "{message}");
        assert!(message.contains(problem) && message.contains("next: "), "{problem}: {message}");
    }
    for length in [bytes.len() / 3, bytes.len() - 1] {
        let (_folder, path) = path_with(&bytes[..length]);
        assert!(read_frames(&path).is_err());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn frames_are_read_back_bit_for_bit(
        bits in prop::collection::vec(prop::array::uniform3(any::<f32>()), 4 * 5),
        codes in prop::collection::vec(0_usize..3, 2 * 5),
        steps in prop::collection::vec(0.0..1.0_f64, 5),
        storeys in prop::collection::vec(any::<u32>(), 2),
    ) {
        let finite = |point: &[f32; 3]| point.map(|x| if x.is_finite() { x } else { -0.0 });
        let mut time = 0.0;
        let frame = |number: usize| {
            time += steps[number];
            Frame {
                time,
                positions: bits[4 * number..4 * number + 4].iter().map(finite).collect(),
                regimes: codes[2 * number..2 * number + 2].iter().map(|code| REGIMES[*code]).collect(),
                velocities: bits[4 * number..4 * number + 4].iter().map(finite).collect(),
                stresses: vec![[1.0, -0.0]; 2],
                gaps: Vec::new(),
            }
        };
        let frames: Vec<Frame> = (0..5).map(frame).collect();
        let frames = Frames { storeys, frames, ..fixture::frames(0, 0) };
        let back = read_back(&encoded(Some(frames.clone()))).unwrap().unwrap();
        let bits = |frames: &Frames| -> Vec<u32> { coordinates(frames).map(f32::to_bits).collect() };
        prop_assert_eq!(bits(&back), bits(&frames));
        prop_assert_eq!(back, frames);
    }
}
