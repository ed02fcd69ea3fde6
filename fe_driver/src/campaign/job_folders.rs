//! Where the folders of jobs are: `jobs/<first two digits of the id>/<id>/`, so that no folder has 10^5 entries.
//!
//! Earlier versions wrote `jobs/<id>/`. [`gather`] moves such folders, one rename each: a kill between two of them leaves
//! jobs in both places, and both are read. A job that has a work folder is not moved, because a run of another shard or on
//! another host, perhaps of an earlier version, may be solving it. If such a run solves a job that was moved before, in a
//! folder of the old place, the one in the new place counts.

use crate::campaign::job::JobFolder;
use crate::record_file::{FileError, entries};
use std::collections::BTreeSet;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use support::whole_file;

/// Number of digits in the name of a folder of jobs.
const DIGITS: usize = 2;

/// The folder of a job below `jobs`.
pub(crate) fn job_folder(jobs: &Path, id: &str) -> JobFolder {
    let (place, flat) = (place(jobs, id), jobs.join(id));
    JobFolder(match !place.exists() && flat.exists() {
        true => flat,
        false => place,
    })
}

/// Where the folder of a job belongs.
fn place(jobs: &Path, id: &str) -> PathBuf {
    let digits = id.get(..DIGITS).unwrap_or(id);
    jobs.join(digits).join(id)
}

/// The ids of all jobs below `jobs`.
pub(crate) fn ids(jobs: &Path) -> Result<BTreeSet<String>, FileError> {
    let mut ids = BTreeSet::new();
    for name in names(jobs)? {
        match name.len() {
            DIGITS => ids.extend(names(&jobs.join(name))?),
            _ => {
                ids.insert(name);
            }
        }
    }
    Ok(ids)
}

/// Moves the folders of jobs from the place of earlier versions to theirs.
pub(crate) fn gather(jobs: &Path) -> Result<(), FileError> {
    let mut moved = BTreeSet::new();
    for id in names(jobs)?.into_iter().filter(|name| name.len() > DIGITS) {
        let (flat, place) = (jobs.join(&id), place(jobs, &id));
        match JobFolder(flat.clone()).has_work() {
            Ok(false) => {}
            Ok(true) => continue,
            // Another host has moved it.
            Err(error) if error.source.kind() == io::ErrorKind::NotFound => continue,
            Err(error) => return Err(error),
        }
        let folder = place.parent().unwrap_or(jobs);
        whole_file::create_folder(folder).map_err(FileError::at(folder))?;
        match std::fs::rename(&flat, &place) {
            Ok(()) => {
                moved.insert(folder.to_owned());
            }
            Err(error)
                if [
                    io::ErrorKind::NotFound,
                    io::ErrorKind::DirectoryNotEmpty,
                    io::ErrorKind::AlreadyExists,
                ]
                .contains(&error.kind()) => {}
            Err(error) => return Err(FileError::at(&flat)(error)),
        }
    }
    if !moved.is_empty() {
        moved.insert(jobs.to_owned());
    }
    // The new entries first: after a loss of power a job may be in both places, but not in none.
    moved.iter().rev().try_for_each(|folder| {
        let synced = File::open(folder).and_then(|folder| folder.sync_all());
        synced.map_err(FileError::at(folder))
    })
}

/// The names of the folders below a folder; none if it does not exist.
fn names(folder: &Path) -> Result<Vec<String>, FileError> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let entries = entries(folder)?.into_iter();
    let folders = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()));
    Ok(folders
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder `jobs` with the folders of jobs, each with a file that names it.
    fn jobs(folders: &[&str]) -> tempfile::TempDir {
        let jobs = tempfile::tempdir().unwrap();
        for folder in folders {
            let path = jobs.path().join(folder);
            std::fs::create_dir_all(&path).unwrap();
            std::fs::write(path.join("job.json"), folder).unwrap();
        }
        jobs
    }

    fn read(jobs: &Path, id: &str) -> String {
        std::fs::read_to_string(job_folder(jobs, id).0.join("job.json")).unwrap()
    }

    #[test]
    fn jobs_of_earlier_versions_are_moved_once_and_found_before_and_after() {
        let folder = jobs(&["0a11", "0a22", "ff33", "ff/ff44", "ff/ff33"]);
        let jobs = folder.path();
        let ids_before = ids(jobs).unwrap();
        assert_eq!(
            Vec::from_iter(&ids_before),
            ["0a11", "0a22", "ff33", "ff44"]
        );
        assert_eq!(read(jobs, "0a11"), "0a11");
        for _ in 0..2 {
            gather(jobs).unwrap();
            assert_eq!(ids(jobs).unwrap(), ids_before);
            assert!(!jobs.join("0a11").exists() && jobs.join("0a/0a22/job.json").exists());
            assert_eq!(read(jobs, "0a11"), "0a11");
            assert_eq!(read(jobs, "ff44"), "ff/ff44");
            // Of a job in both places the one in the new place counts, and nothing is deleted.
            assert_eq!(read(jobs, "ff33"), "ff/ff33");
            assert!(jobs.join("ff33/job.json").exists());
        }
        assert!(job_folder(jobs, "0b55").0.ends_with("0b/0b55"));
    }

    #[test]
    fn a_job_that_another_run_may_be_solving_is_not_moved() {
        let folder = jobs(&["0a11/work-elsewhere", "0a11", "0a22"]);
        let jobs = folder.path();
        gather(jobs).unwrap();
        assert!(jobs.join("0a11").exists() && jobs.join("0a/0a22").exists());
        assert_eq!(read(jobs, "0a11"), "0a11");
        std::fs::remove_dir_all(jobs.join("0a11/work-elsewhere")).unwrap();
        gather(jobs).unwrap();
        assert_eq!(read(jobs, "0a11"), "0a11");
        assert!(!jobs.join("0a11").exists());
    }
}
