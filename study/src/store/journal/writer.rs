//! Appends to a journal.

use std::io;
use std::path::{Path, PathBuf};

use super::{Death, Record, line};
use crate::job::JobId;
use crate::platform::error::Result;
use crate::platform::files::{Append, Files, disk_error};

/// Appends the records of one process. The first record creates its file.
pub struct Writer<'a> {
    files: &'a dyn Files,
    folder: PathBuf,
    open: Option<(PathBuf, Box<dyn Append>)>,
}

impl<'a> Writer<'a> {
    /// A writer into that folder.
    pub fn new(files: &'a dyn Files, folder: PathBuf) -> Self {
        Self { files, folder, open: None }
    }

    /// Appends records and syncs once. After an error the writer does not use its file again, because
    /// the last line may be torn; the next call creates a new file.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`]; none of these records then counts as written.
    pub fn append(&mut self, records: &[Record]) -> Result<()> {
        self.write(records.iter().map(line::ended_text))
    }

    /// Records that these jobs must run again, and syncs once.
    ///
    /// # Errors
    /// As [`Self::append`].
    pub fn invalidate(&mut self, jobs: &[JobId]) -> Result<()> {
        self.write(jobs.iter().map(line::invalidated_text))
    }

    /// Records that these jobs stored a checkpoint, and syncs once.
    ///
    /// # Errors
    /// As [`Self::append`].
    pub fn progress(&mut self, jobs: &[JobId]) -> Result<()> {
        self.write(jobs.iter().map(line::progressed_text))
    }

    /// Records that a process died while these jobs ran, and syncs once.
    ///
    /// # Errors
    /// As [`Self::append`].
    pub fn deaths(&mut self, deaths: &[Death]) -> Result<()> {
        self.write(deaths.iter().map(line::died_text))
    }

    /// Records the text of study.json, and syncs.
    ///
    /// # Errors
    /// As [`Self::append`].
    pub fn study(&mut self, text: &str) -> Result<()> {
        self.write(std::iter::once(line::study_text(text)))
    }

    fn write(&mut self, lines: impl Iterator<Item = serde_json::Result<String>>) -> Result<()> {
        let mut bytes = Vec::new();
        for line in lines {
            let line = line.map_err(|error| disk_error(&self.folder, &io::Error::other(error)))?;
            bytes.extend_from_slice(line.as_bytes());
            bytes.push(b'\n');
        }
        let (path, mut file) = match self.open.take() {
            Some(open) => open,
            None => self.create()?,
        };
        file.append(&bytes).map_err(|error| disk_error(&path, &error))?;
        self.open = Some((path, file));
        Ok(())
    }

    fn create(&self) -> Result<(PathBuf, Box<dyn Append>)> {
        let at_folder = |error: io::Error| disk_error(&self.folder, &error);
        self.files.create_folder(&self.folder).map_err(at_folder)?;
        let paths = self.files.list(&self.folder).map_err(at_folder)?;
        let last = paths
            .iter()
            .filter_map(|path| path.file_stem()?.to_str()?.parse::<u64>().ok())
            .max()
            .unwrap_or(0);
        for number in last + 1.. {
            let path = self.folder.join(format!("{number:06}.jsonl"));
            match self.files.create_append(&path) {
                Ok(mut file) => {
                    self.write_header(&path, file.as_mut())?;
                    return Ok((path, file));
                }
                // Another process took this number after the folder was listed.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(disk_error(&path, &error)),
            }
        }
        unreachable!("there are more numbers than files")
    }

    fn write_header(&self, path: &Path, file: &mut dyn Append) -> Result<()> {
        let mut text =
            line::header_text().map_err(|error| disk_error(path, &io::Error::other(error)))?;
        text.push('\n');
        file.append(text.as_bytes()).map_err(|error| disk_error(path, &error))?;
        self.files.sync_folder(&self.folder).map_err(|error| disk_error(&self.folder, &error))
    }
}
