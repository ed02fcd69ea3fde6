//! Writing a database whose rays arrive one after the other. The rows of one group of the Parquet
//! file are in memory at a time; of all other rows 24 bytes, and of every ray its id, from which
//! domain and split are computed at the end.

use crate::database_files::{publish, refuse_existing};
use crate::digest::{Digest, by_job_and_lambda};
use crate::error::DatasetError;
use crate::manifest::Manifest;
use crate::parquet::{Hashing, Table};
use crate::rows::Row;
use crate::split::SplitPlan;
use crate::summary::Contents;
use std::fmt;
use std::path::Path;
use support::fault::unwritten;
use support::whole_file::Unnamed;

/// A database that was written while its rays arrived.
#[derive(Clone, Debug)]
pub struct Collected {
    manifest: Manifest,
    contents: Contents,
}

impl Collected {
    /// Writes `X.parquet` and its manifest `X.json` of rays, each the rows of one job. The jobs
    /// must come in the order of their ids. The files are those that
    /// [`Database::collect`](crate::Database::collect) and
    /// [`Database::write`](crate::Database::write) give, and appear only when they are complete.
    ///
    /// An existing file is an error unless `replace` is true.
    pub fn write<E: From<DatasetError>>(
        rays: impl IntoIterator<Item = Result<Vec<Row>, E>>,
        plan: &SplitPlan,
        path: &Path,
        replace: bool,
    ) -> Result<Self, E> {
        refuse_existing(path, replace)?;
        let mut file =
            Unnamed::next_to(path).map_err(unwritten(path)).map_err(DatasetError::from)?;
        let failed = |error: DatasetError| unwritten(path)(error).into();
        let mut digest = Digest::default();
        let mut contents = Contents::default();
        let mut hashing = Hashing::new(file.file());
        let mut table = Table::new(&mut hashing).map_err(failed)?;
        for ray in rays {
            let mut ray = digest.accepted(ray?);
            ray.sort_by(by_job_and_lambda);
            digest.add(&ray)?;
            contents.add(&ray);
            table.add(ray).map_err(failed)?;
        }
        table.finish().map_err(failed)?;
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
    use crate::rows::tests::rows;

    #[test]
    fn rays_that_arrive_one_by_one_give_the_files_of_all_rows_together() {
        let folder = tempfile::tempdir().unwrap();
        let [together, apart] = ["together", "apart"].map(|name| folder.path().join(name));
        let plan = SplitPlan::default();
        let mut rows = rows(40);
        rows[57].sample.w = -1.0;
        let database = Database::collect(rows.clone(), &plan).unwrap();
        database.write(&together.with_extension("parquet"), false).unwrap();

        let path = apart.with_extension("parquet");
        let write = |rows: &[Row], replace| {
            let rays = rows.chunks(10).map(|ray| {
                let backwards = ray.iter().rev().cloned();
                Ok::<_, DatasetError>(backwards.collect())
            });
            Collected::write(rays, &plan, &path, replace)
        };
        let collected = write(&rows, false).unwrap();
        for extension in ["parquet", "json"] {
            let read = |path: &Path| std::fs::read(path.with_extension(extension)).unwrap();
            assert_eq!(read(&apart), read(&together), "{extension}");
        }
        assert_eq!(collected.to_string(), database.to_string());

        let refusal = |rows: &[Row], replace| write(rows, replace).unwrap_err().to_string();
        assert!(refusal(&rows, false).contains("already exists"));
        // A ray that is given twice, or no ray that can be used, leaves the old files.
        let twice = [&rows[..20], &rows[10..]].concat();
        assert!(refusal(&twice, true).contains("occurs twice"));
        assert!(refusal(&[], true).starts_with("no rows: "));
        assert_eq!(Database::read(&path).unwrap().rows(), database.rows());
        assert_eq!(folder.path().read_dir().unwrap().count(), 4);
    }
}
