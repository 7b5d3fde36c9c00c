//! Files that appear whole or not at all: written beside their place under another name, then renamed.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// A file under way. Dropped before [`commit`](Self::commit) it leaves nothing behind.
pub struct AtomicFile {
    place: PathBuf,
    temporary: PathBuf,
    file: Option<BufWriter<File>>,
}

impl AtomicFile {
    /// Starts a file that shall replace what is at `place`.
    pub fn create(place: &Path) -> Result<Self, Failure> {
        let mut name = OsString::from(".");
        name.push(place.file_name().unwrap_or_default());
        name.push(format!(".{}.tmp", std::process::id()));
        let temporary = place.with_file_name(name);
        // One of this name was left by a process of the same number that was killed.
        let _ = fs::remove_file(&temporary);
        let file = OpenOptions::new().write(true).create_new(true).open(&temporary);
        match file {
            Ok(file) => {
                let file = Some(BufWriter::with_capacity(1 << 16, file));
                Ok(AtomicFile { place: place.to_owned(), temporary, file })
            }
            Err(error) => Err(Failure::in_file(place, error)),
        }
    }

    /// Fills the file.
    pub fn fill(&mut self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
        match &mut self.file {
            Some(file) => write(file).map_err(|error| Failure::in_file(&self.place, error)),
            None => Ok(()),
        }
    }

    /// Puts the file in its place.
    pub fn commit(mut self) -> Result<(), Failure> {
        self.finish().map_err(|error| Failure::in_file(&self.place, error))
    }

    fn finish(&mut self) -> io::Result<()> {
        if let Some(file) = self.file.take() {
            let result = file
                .into_inner()
                .map_err(|error| error.into_error())
                .and_then(|_| fs::rename(&self.temporary, &self.place));
            if result.is_err() {
                let _ = fs::remove_file(&self.temporary);
            }
            return result;
        }
        Ok(())
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if self.file.take().is_some() {
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_appears_before_the_commit_and_nothing_stays_of_a_failure() {
        let folder = std::env::temp_dir().join(format!("wellspaced-atomic-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let names = || {
            let mut names: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
            names.sort();
            names
        };
        let place = folder.join("mesh.vtu");
        fs::write(&place, "old").unwrap();

        let mut file = AtomicFile::create(&place).unwrap();
        let failure = file.fill(|out| {
            out.write_all(b"new")?;
            Err(io::Error::other("disk on fire"))
        });
        assert!(failure.unwrap_err().message().ends_with("mesh.vtu: disk on fire"));
        assert_eq!(names().len(), 2);
        drop(file);
        assert_eq!(names(), ["mesh.vtu"]);
        assert_eq!(fs::read_to_string(&place).unwrap(), "old");

        let mut file = AtomicFile::create(&place).unwrap();
        file.fill(|out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read_to_string(&place).unwrap(), "old");
        file.commit().unwrap();
        assert_eq!(fs::read_to_string(&place).unwrap(), "new");
        assert_eq!(names(), ["mesh.vtu"]);

        assert!(AtomicFile::create(&folder.join("none/mesh.vtu")).is_err());
        fs::remove_dir_all(&folder).unwrap();
    }
}
