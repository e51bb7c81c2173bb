//! Reads what other processes append to the journals while this one runs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::line::{self, Entry};
use super::{Record, is_journal};
use crate::job::JobId;
use crate::platform::error::Result;
use crate::platform::files::{Files, disk_error};

/// The journals of a folder, read on from where they ended when it was made.
pub struct Follower<'a> {
    files: &'a dyn Files,
    folder: PathBuf,
    /// How far each journal has been read, bytes.
    read: BTreeMap<PathBuf, u64>,
    /// The jobs that have ended since.
    ended: BTreeMap<JobId, Record>,
}

impl<'a> Follower<'a> {
    /// Follows the journals of a folder from their ends of now on. Made before the journals are read, so that no line is
    /// in neither.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn new(files: &'a dyn Files, folder: &Path) -> Result<Self> {
        let mut follower = Self {
            files,
            folder: folder.to_owned(),
            read: BTreeMap::new(),
            ended: BTreeMap::new(),
        };
        for (path, size) in follower.sizes()? {
            follower.read.insert(path, size);
        }
        Ok(follower)
    }

    /// The jobs that have ended since it was made, with their last records, also those of this process.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn ended(&mut self) -> Result<&BTreeMap<JobId, Record>> {
        for (path, size) in self.sizes()? {
            let start = self.read.get(&path).copied().unwrap_or(0);
            if size <= start {
                continue;
            }
            let length = usize::try_from(size - start).unwrap_or(usize::MAX);
            let bytes = self.files.read_part(&path, start, length);
            let bytes = bytes.map_err(|error| disk_error(&path, &error))?;
            let complete = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
            for line in bytes[..complete].split_inclusive(|byte| *byte == b'\n') {
                // The reader of the whole journal names its header and damaged lines.
                match line::parse(line) {
                    Ok(Entry::Ended(record)) => {
                        self.ended.insert(record.job.clone(), *record);
                    }
                    Ok(Entry::Invalidated(id)) => {
                        self.ended.remove(&id);
                    }
                    Ok(_) | Err(_) => {}
                }
            }
            self.read.insert(path, start + complete as u64);
        }
        Ok(&self.ended)
    }

    fn sizes(&self) -> Result<Vec<(PathBuf, u64)>> {
        let at = |path: &Path, error: &std::io::Error| disk_error(path, error);
        let mut paths = self.files.list(&self.folder).map_err(|error| at(&self.folder, &error))?;
        paths.retain(|path| is_journal(path));
        let size = |path: PathBuf| match self.files.stamp(&path) {
            Ok(stamp) => Ok((path, stamp.size)),
            Err(error) => Err(at(&path, &error)),
        };
        paths.into_iter().map(size).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Status;
    use crate::job::row::Cells;
    use crate::platform::files::Disk;
    use crate::store::journal::Writer;

    fn record(number: u32) -> Record {
        let job = JobId::from_digits(&format!("{number:032x}")).unwrap();
        Record { job, cells: Cells::new(Status::Done), file_hash: None, file_stamp: None }
    }

    #[test]
    fn what_others_append_is_seen_once_and_what_was_there_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let mut first = Writer::new(&Disk, folder.path().to_owned());
        first.append(&[record(1)]).unwrap();
        let mut follower = Follower::new(&Disk, folder.path()).unwrap();
        assert!(follower.ended().unwrap().is_empty());
        first.append(&[record(2)]).unwrap();
        let mut second = Writer::new(&Disk, folder.path().to_owned());
        second.append(&[record(3), record(4)]).unwrap();
        let ids = |follower: &mut Follower<'_>| -> Vec<JobId> {
            follower.ended().unwrap().keys().cloned().collect()
        };
        assert_eq!(ids(&mut follower), [record(2).job, record(3).job, record(4).job]);
        second.invalidate(&[record(3).job]).unwrap();
        assert_eq!(ids(&mut follower), [record(2).job, record(4).job]);
    }

    #[test]
    fn half_a_line_waits_for_its_end() {
        let folder = tempfile::tempdir().unwrap();
        let text = line::header_text().unwrap() + "\n" + &line::ended_text(&record(1)).unwrap();
        let path = folder.path().join("000001.jsonl");
        let mut follower = Follower::new(&Disk, folder.path()).unwrap();
        let mut file = Disk.create_append(&path).unwrap();
        file.append(text.as_bytes()).unwrap();
        assert!(follower.ended().unwrap().is_empty());
        file.append(b"\n").unwrap();
        assert_eq!(follower.ended().unwrap().len(), 1);
    }
}
