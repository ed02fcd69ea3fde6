//! Reading and writing a database: `X.parquet` and its manifest `X.json`.
//!
//! Renaming the manifest, which holds the hash of its Parquet file, commits the database. The
//! Parquet file is written before as `X.parquet.next` and renamed afterwards; after a kill between
//! the two the next reader renames it.

use crate::database::Database;
use crate::digest::Digest;
use crate::manifest::{FORMAT_VERSION, Manifest};
use crate::parquet::{self, Hashing, ParquetTable};
use crate::split::SplitPlan;
use crate::summary::Contents;
use fe_driver::SolvedRay;
use std::fmt::{self, Display};
use std::io::Write;
use std::path::{Path, PathBuf};
use support::whole_file::{self, Unnamed};
use support::{Fault, ensure, fault, refuse, regular_file, sealed_json, unread, unwritten};

impl Database {
    /// Reads `X.parquet` and its manifest `X.json`; an error if the hash of the file is not that in
    /// the manifest.
    pub fn read(path: &Path) -> Result<Self, Fault> {
        let (manifest, parquet) = match finish(path)? {
            Some(finished) => finished,
            None => read_files(path)?,
        };
        let rays =
            parquet::decode(&parquet).map_err(|error| fault!("{}: {error}", path.display()))?;
        match manifest.disagrees(&rays) {
            None => Ok(Self { rays, parquet, manifest }),
            Some(what) => refuse!(
                "{} and its manifest do not belong together: {what}; copy the two files again, or \
                 collect the campaign again",
                path.display()
            ),
        }
    }

    /// Writes `X.parquet` and its manifest `X.json`, each atomically.
    ///
    /// An existing file is an error unless `replace` is true.
    pub fn write(&self, path: &Path, replace: bool) -> Result<(), Fault> {
        refuse_existing(path, replace)?;
        let mut file = Unnamed::next_to(path).map_err(unwritten(path))?;
        let written = file.file().write_all(&self.parquet);
        written.map_err(unwritten(path))?;
        publish(file, &self.manifest, path)
    }
}

/// Writes the manifest of a Parquet file, and gives both their names.
pub(crate) fn publish(parquet: Unnamed, manifest: &Manifest, path: &Path) -> Result<(), Fault> {
    let next = next_path(path);
    parquet.name(&next).map_err(unwritten(&next))?;
    let mut json = sealed_json::to_vec(manifest).map_err(no_manifest(path))?;
    json.push(b'\n');
    let place = manifest_path(path);
    whole_file::write(&place, &json).map_err(unwritten(&place))?;
    whole_file::rename(&next, path).map_err(unwritten(path))
}

/// The database whose Parquet file has not got its name yet, which it gets now if the folder can be
/// written; `None` if there is none.
fn finish(path: &Path) -> Result<Option<(Manifest, Vec<u8>)>, Fault> {
    let next = next_path(path);
    if !next.exists() {
        return Ok(None);
    }
    let manifest = read_manifest(&manifest_path(path))?;
    let parquet = read_bytes(&next)?;
    if parquet::hash(&parquet) != manifest.hash {
        return Ok(None);
    }
    let _ = whole_file::rename(&next, path);
    Ok(Some((manifest, parquet)))
}

/// The manifest and the bytes of the Parquet file, which has the hash in the manifest.
fn read_files(path: &Path) -> Result<(Manifest, Vec<u8>), Fault> {
    let parquet = read_bytes(path)?;
    if let Some(what) = other_kind(&parquet) {
        refuse!(
            "{} {what}: a database is a Parquet file (.parquet) with its manifest",
            path.display()
        );
    }
    let manifest = read_manifest(&manifest_path(path))?;
    let found = parquet::hash(&parquet);
    ensure!(
        found == manifest.hash,
        "{} does not match its manifest (its BLAKE3 hash is {found}, not {}); copy both files \
             from the same place, or collect the campaign again",
        path.display(),
        manifest.hash
    );
    Ok((manifest, parquet))
}

/// An error if `X.parquet` or its manifest exists, unless `replace` is true.
pub(crate) fn refuse_existing(path: &Path, replace: bool) -> Result<(), Fault> {
    let files = [path.to_owned(), manifest_path(path)];
    match files.into_iter().find(|path| !replace && path.exists()) {
        Some(path) => refuse!(
            "{} already exists; choose another name, or replace it with `--replace`",
            path.display()
        ),
        None => Ok(()),
    }
}

fn manifest_path(path: &Path) -> PathBuf {
    path.with_extension("json")
}

/// Where the Parquet file is before the manifest has its name.
fn next_path(path: &Path) -> PathBuf {
    path.with_added_extension("next")
}

fn read_manifest(path: &Path) -> Result<Manifest, Fault> {
    #[derive(serde::Deserialize)]
    struct Version {
        format_version: u64,
    }
    let bytes = read_bytes(path)?;
    let Version { format_version } = serde_json::from_slice(&bytes).map_err(no_manifest(path))?;
    ensure!(
        format_version == u64::from(FORMAT_VERSION),
        "{} has the format version {format_version}, but this program reads only version \
             {FORMAT_VERSION}: collect the campaign again, or use the program that wrote it",
        path.display()
    );
    sealed_json::from_slice(&bytes).map_err(no_manifest(path))
}

/// Maps the error of the manifest `path`, for use in `map_err`.
fn no_manifest<E: Display>(path: &Path) -> impl FnOnce(E) -> Fault {
    move |error| fault!("{} is not a manifest of a database: {error}", path.display())
}

/// What a file is that does not begin like a Parquet file.
fn other_kind(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [b'P', b'A', b'R', b'1', ..] => None,
        // Safetensors: the length of the header in eight bytes, then the header, a JSON object.
        [_, _, _, _, _, _, _, 0, b'{', ..] => Some("holds weights"),
        _ => Some("is no Parquet file"),
    }
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, Fault> {
    regular_file::read(path).map_err(unread(path))
}

// Writing a database whose rays arrive one after the other. The rows of one group of the Parquet
// file are in memory at a time; of all other rows 24 bytes, and of every ray its id, from which
// domain and split are computed at the end.

/// A database that was written while its rays arrived.
#[derive(Debug)]
pub struct Collected {
    manifest: Manifest,
    contents: Contents,
}

impl Collected {
    /// Writes `X.parquet` and its manifest `X.json` of rays, which must come in the order of their
    /// jobs. The files are those that
    /// [`Database::collect`](crate::Database::collect) and
    /// [`Database::write`](crate::Database::write) give, and appear only when they are complete.
    ///
    /// An existing file is an error unless `replace` is true.
    pub fn write<E: From<Fault>>(
        rays: impl IntoIterator<Item = Result<SolvedRay, E>>,
        plan: &SplitPlan,
        path: &Path,
        replace: bool,
    ) -> Result<Self, E> {
        refuse_existing(path, replace)?;
        let mut file = Unnamed::next_to(path).map_err(unwritten(path))?;
        let mut digest = Digest::default();
        let mut contents = Contents::default();
        let mut hashing = Hashing::new(file.file());
        let mut table = ParquetTable::new(&mut hashing).map_err(unwritten(path))?;
        for ray in rays {
            let ray = digest.accepted(ray?);
            if ray.samples.is_empty() {
                continue;
            }
            digest.add(&ray)?;
            contents.add(&ray);
            table.add(ray).map_err(unwritten(path))?;
        }
        table.finish().map_err(unwritten(path))?;
        let manifest = digest.manifest(hashing.hash(), plan)?;
        publish(file, &manifest, path)?;
        Ok(Self { manifest, contents })
    }
}

impl fmt::Display for Collected {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.contents.summary(&self.manifest, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::database::Database;
    use crate::rays::tests::{finer, rays};

    #[test]
    fn rays_that_arrive_one_by_one_give_the_files_of_all_together() {
        let folder = tempfile::tempdir().unwrap();
        let [together, apart] = ["together", "apart"].map(|name| folder.path().join(name));
        let plan = SplitPlan::default();
        let mut rays = [rays(40), finer(rays(4))].concat();
        rays[5].samples[7].w = -1.0;
        let database = Database::collect(rays.clone(), &plan).unwrap();
        database.write(&together.with_extension("parquet"), false).unwrap();

        let path = apart.with_extension("parquet");
        rays.sort_by(|left, right| left.job.cmp(&right.job));
        let write = |rays: &[SolvedRay], replace| {
            let backwards = rays.iter().cloned().map(|mut ray| {
                ray.samples.reverse();
                Ok::<_, Fault>(ray)
            });
            Collected::write(backwards, &plan, &path, replace)
        };
        let collected = write(&rays, false).unwrap();
        for extension in ["parquet", "json"] {
            let read = |path: &Path| std::fs::read(path.with_extension(extension)).unwrap();
            assert_eq!(read(&apart), read(&together), "{extension}");
        }
        assert_eq!(collected.to_string(), database.to_string());

        let refusal = |rays: &[SolvedRay], replace| write(rays, replace).unwrap_err().to_string();
        assert!(refusal(&rays, false).contains("already exists"));
        // A ray that is given twice, or no ray that can be used, leaves the old files.
        let twice = [&rays[..2], &rays[1..]].concat();
        assert!(refusal(&twice, true).contains("occurs twice"));
        assert!(refusal(&[], true).starts_with("no rows: "));
        assert_eq!(Database::read(&path).unwrap().rays(), database.rays());
        assert_eq!(folder.path().read_dir().unwrap().count(), 4);
    }
}
