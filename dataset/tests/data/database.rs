//! Collecting, writing and reading a database, and the errors on the way.

use crate::common::{collect, ray, rays, sample};
use dataset::{Database, Fidelity, Rejection, SolvedRay, Subset, samples};
use mesher::Tier;
use std::path::{Path, PathBuf};
use support::sealed_json;
use tempfile::TempDir;
use testkit::changed;

type Change = fn(&mut SolvedRay);

fn written() -> (TempDir, PathBuf, Database) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.parquet");
    let database = collect(rays()).unwrap();
    database.write(&path, false).unwrap();
    assert!(database.write(&path, false).unwrap_err().to_string().contains("already exists"));
    (folder, path, database)
}

fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_written_database_is_read_back_bit_exactly() {
    let (folder, path, database) = written();
    let read = Database::read(&path).unwrap();
    assert_eq!(read.rays(), database.rays());
    assert_eq!(read.manifest(), database.manifest());
    assert_eq!(samples(read.rays()).count(), 50);
    assert_eq!(files(folder.path()), ["film.json", "film.parquet"]);
    let manifest = read.manifest();
    assert_eq!((manifest.rays, manifest.partial_rays, manifest.geometries), (10, 1, 10));
    assert_eq!(manifest.domain.w_lig, [5.0, 14.0]);
    assert_eq!(manifest.cpu_s, 95.0);
    assert_eq!(manifest.units["F_a"], "N");
}

/// Holes of several radii are a range next to the paper's hole, in whose measures the domain is.
#[test]
fn holes_of_several_radii_are_a_range() {
    let one = collect(rays()).unwrap();
    assert_eq!(one.manifest().domain.holes, None);
    let several = changed(rays(), |ray| {
        let odd = ray.job.ends_with(['1', '3', '5', '7', '9']);
        ray.design.fillet_ratio = if odd { 0.3 } else { 0.05 };
    });
    let several = collect(several).unwrap();
    assert_eq!(several.manifest().domain.holes, Some([0.05, 0.3]));
    assert_eq!(several.manifest().hinge.fillet_ratio, 0.16);
    assert_ne!(several.manifest().domain, one.manifest().domain);
}

#[test]
fn rows_are_sorted_by_job_and_lambda_so_that_the_file_is_the_same() {
    let database = collect(rays()).unwrap();
    let mut shuffled = changed(rays(), |ray| ray.samples.reverse());
    shuffled.reverse();
    let again = collect(shuffled).unwrap();
    assert_eq!(database.manifest().hash, again.manifest().hash);
    let lambdas = database.rays()[0].samples.iter().map(|sample| sample.lambda);
    assert_eq!(lambdas.collect::<Vec<_>>(), [0.2, 0.4, 0.6, 0.8, 1.0]);
}

#[test]
fn the_parts_contain_every_ray_exactly_once() {
    let database = collect(rays()).unwrap();
    let parts = [Subset::Training, Subset::Validation, Subset::Test].map(|it| database.part(it));
    assert_eq!(parts.each_ref().map(Vec::len), [8, 1, 1]);
    let mut all = parts.concat();
    all.sort_by(|a, b| a.job.cmp(&b.job));
    assert_eq!(all, database.rays());
}

#[test]
fn rejected_rows_are_counted_and_printed() {
    let mut rays = rays();
    rays[0].samples[3].w = -1.0;
    rays[0].samples[4].energy_residual = 0.5;
    rays[1].samples[0].energy_residual = 0.5;
    rays[1].samples[1].m_theta = f64::NAN;
    let database = collect(rays).unwrap();
    assert_eq!(samples(database.rays()).count(), 46);
    let rejected: Vec<_> = database.manifest().rejected.iter().collect();
    assert_eq!(
        rejected,
        [(&Rejection::NotFinite, &1), (&Rejection::Negative, &1), (&Rejection::EnergyResidual, &2)]
    );
    let summary = database.to_string();
    assert!(
        summary.contains("rejected 2 rows: the energy is not the work of the forces"),
        "{summary}"
    );
    assert!(summary.contains("46 rows of 10 rays (1 partial)"), "{summary}");
}

#[test]
fn an_empty_database_is_an_error() {
    let message = |rays| collect(rays).unwrap_err().to_string();
    assert_eq!(message(vec![]), "no rows: run the campaign before collecting it");
    let bad = vec![SolvedRay { cpu_s: f64::NAN, ..ray(0) }];
    assert_eq!(message(bad), "no rows: 5 were rejected since a number is not finite");
}

#[test]
fn inconsistent_rays_are_an_error() {
    let changes: [(Change, &str); 6] = [
        (|ray| ray.material = "steel".into(), "material"),
        (|ray| ray.material_hash = "57ee1".into(), "material_hash"),
        (|ray| ray.settings_hash = "07e4".into(), "settings_hash"),
        (|ray| ray.tier = Fidelity::Solved(Tier::Tiny), "tier"),
        (|ray| ray.design.kerf = 0.1, "kerf"),
        (|ray| ray.design.r_win = 70.0, "r_win"),
    ];
    for (change, expected) in changes {
        let mut rays = rays();
        change(&mut rays[0]);
        let error = collect(rays).unwrap_err().to_string();
        assert!(error.starts_with(&format!("job job-09: {expected} = ")), "{error}");
    }
    let twice = [rays(), vec![ray(3)]].concat();
    let error = collect(twice).unwrap_err().to_string();
    assert_eq!(error, "job job-03 occurs twice; was it collected twice?");
    let mut rays = rays();
    rays[6].samples.push(sample(0.4));
    let error = collect(rays).unwrap_err().to_string();
    assert_eq!(error, "job job-03: lambda = 0.4 occurs twice");
}

#[test]
fn a_file_that_does_not_match_its_manifest_is_an_error() {
    let (_folder, path, _) = written();
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[100] ^= 1;
    std::fs::write(&path, bytes).unwrap();
    let error = Database::read(&path).unwrap_err().to_string();
    assert!(error.contains("does not match its manifest"), "{error}");
}

#[test]
fn a_missing_malformed_or_newer_manifest_is_an_error() {
    let (_folder, path, _) = written();
    let manifest = path.with_extension("json");
    let text = std::fs::read_to_string(&manifest).unwrap();
    for version in [3, 9] {
        let other =
            text.replace("\"format_version\": 4", &format!("\"format_version\": {version}"));
        std::fs::write(&manifest, other).unwrap();
        let error = Database::read(&path).unwrap_err().to_string();
        assert!(error.contains(&format!("has the format version {version}, ")), "{error}");
    }
    std::fs::write(&manifest, &text[..100]).unwrap();
    let read = || Database::read(&path).unwrap_err().to_string();
    assert!(read().contains("is not a manifest of a database"));
    std::fs::remove_file(&manifest).unwrap();
    assert!(read().starts_with("cannot read "));
}

#[test]
fn a_material_law_without_a_hash_is_not_known() {
    let law = |rays| collect(rays).unwrap().to_string();
    let unknown = changed(rays(), |ray| ray.material_hash.clear());
    assert!(law(unknown).contains("material law not known"));
    assert!(law(rays()).contains("material law f11f"));
}

/// The error of reading these bytes with a manifest that contains their hash.
fn vouched(path: &Path, bytes: &[u8]) -> String {
    let hash = |bytes: &[u8]| blake3::hash(bytes).to_hex().to_string();
    let [expected, found] = [&std::fs::read(path).unwrap()[..], bytes].map(hash);
    std::fs::write(path, bytes).unwrap();
    let manifest = path.with_extension("json");
    let text = std::fs::read_to_string(&manifest).unwrap();
    let text: serde_json::Value = serde_json::from_str(&text.replace(&expected, &found)).unwrap();
    std::fs::write(&manifest, sealed_json::to_vec(&text).unwrap()).unwrap();
    Database::read(path).unwrap_err().to_string()
}

#[test]
fn a_malformed_file_is_an_error_even_if_its_hash_is_correct() {
    let (_folder, path, database) = written();
    let bytes = std::fs::read(&path).unwrap();
    let length = bytes.len();
    let mut headless = bytes.clone();
    headless[..200].fill(0);
    let mut tail = bytes.clone();
    tail[length - 8..length - 4].fill(0xff);
    let truncated = [12, length / 2, length - 1].map(|length| bytes[..length].to_vec());
    for broken in truncated.into_iter().chain([tail]) {
        let error = vouched(&path, &broken);
        assert!(error.starts_with(&format!("{}: the ", path.display())), "{error}");
        database.write(&path, true).unwrap();
    }
    // Without the first bytes of a Parquet file the manifest is not read.
    let table = b"job,a,s\n1,2,3\n".to_vec();
    for other in [vec![], b"PAR".to_vec(), vec![0; 4096], table, headless] {
        std::fs::write(&path, other).unwrap();
        let error = Database::read(&path).unwrap_err().to_string();
        assert!(error.contains("a database is a Parquet file"), "{error}");
    }
}

#[test]
fn a_single_geometry_is_an_error() {
    let one = changed(rays(), |other| other.design = ray(9).design);
    for rays in [one, vec![ray(0)]] {
        let error = collect(rays).unwrap_err().to_string();
        assert!(error.starts_with("1 geometries cannot be split"), "{error}");
    }
}

#[test]
fn the_rays_of_a_shipped_database_give_its_hash_and_its_split() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/polypropylene-3mm");
    let shipped = Database::read(&folder.join("hinges.parquet")).unwrap();
    let manifest = shipped.manifest();
    let again = Database::collect(shipped.rays().to_vec(), &manifest.split_plan).unwrap();
    let found = again.manifest();
    assert_eq!([&found.hash, &found.split_hash], [&manifest.hash, &manifest.split_hash]);
    assert_eq!((found.tier, &found.finer), (manifest.tier, &manifest.finer));
}
