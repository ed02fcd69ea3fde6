//! Databases of two meshes: some of the rays are there on a finer one too.

use crate::common::{collect, finer, on_tier, row, rows};
use dataset::{Collected, Database, DatasetError, Fidelity, FinerMesh, Row, SplitPlan, Subset};
use mesher::Tier;

fn both() -> Database {
    collect([rows(), finer(4)].concat()).unwrap()
}

/// The column in which rows must not differ, but do.
fn mixed(rows: Vec<Row>) -> String {
    let error = collect(rows).unwrap_err().to_string();
    error.split([' ', '=']).nth(2).unwrap().to_owned()
}

#[test]
fn a_database_with_a_finer_mesh_is_written_and_read_back_bit_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.parquet");
    let database = both();
    database.write(&path, false).unwrap();
    let read = Database::read(&path).unwrap();
    assert_eq!(read.rows(), database.rows());
    assert_eq!(read.manifest(), database.manifest());
    let bytes = [&path, &path.with_extension("json")].map(|path| std::fs::read(path).unwrap());
    read.write(&path, true).unwrap();
    let again = [&path, &path.with_extension("json")].map(|path| std::fs::read(path).unwrap());
    assert_eq!(again, bytes);
}

#[test]
fn the_rays_of_both_meshes_may_arrive_one_by_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.parquet");
    let database = both();
    let rays = database.rows().chunk_by(|left, right| left.job == right.job);
    let rays = rays.map(|ray| Ok::<_, DatasetError>(ray.to_vec()));
    let collected = Collected::write(rays, &SplitPlan::default(), &path, false).unwrap();
    let read = Database::read(&path).unwrap();
    assert_eq!(read.rows(), database.rows());
    assert_eq!(read.manifest(), database.manifest());
    assert_eq!(collected.to_string(), database.to_string());
}

#[test]
fn counts_split_and_domain_are_of_the_rays_alone() {
    // One of the rays on the finer mesh is partial, and one goes on beyond its end, where it would
    // widen the domain.
    let beyond = row(3, 1.2);
    let further = on_tier(Tier::Reference, std::slice::from_ref(&beyond));
    let database = collect([rows(), finer(4), further].concat()).unwrap();
    let (manifest, alone) = (database.manifest(), collect(rows()).unwrap());
    let wide = collect([rows(), vec![beyond]].concat()).unwrap();
    assert_ne!(wide.manifest().domain, alone.manifest().domain);
    let expected = FinerMesh { tier: Fidelity::Solved(Tier::Reference), rays: 4, cpu_s: 160.0 };
    assert_eq!(manifest.finer, Some(expected));
    assert_eq!(alone.manifest().finer, None);
    assert_eq!((manifest.rows, database.rows().len()), (71, 71));
    let alone = alone.manifest();
    assert_eq!(manifest.rays, alone.rays);
    assert_eq!(manifest.partial_rays, alone.partial_rays);
    assert_eq!(manifest.geometries, alone.geometries);
    assert_eq!(manifest.cpu_s, alone.cpu_s);
    assert_eq!(manifest.tier, alone.tier);
    assert_eq!(manifest.settings_hashes, alone.settings_hashes);
    assert_eq!(manifest.domain, alone.domain);
    assert_eq!(manifest.split, alone.split);
    assert_eq!(manifest.split_hash, alone.split_hash);
}

#[test]
fn the_parts_have_no_row_of_the_finer_mesh() {
    let (database, alone) = (both(), collect(rows()).unwrap());
    for part in [Subset::Training, Subset::Validation, Subset::Test] {
        assert_eq!(database.part(part), alone.part(part));
    }
}

#[test]
fn the_finer_mesh_has_fewer_rays_or_longer_solves() {
    let finer_rays = |rows: Vec<Row>| {
        let database = collect(rows).unwrap();
        let finer = database.manifest().finer.clone().unwrap();
        assert_eq!(finer.tier, Fidelity::Solved(Tier::Reference));
        (finer.rays, database.on_both_meshes().len())
    };
    // A ray that failed on the other mesh has no use.
    let one_more = || on_tier(Tier::Reference, &[row(10, 1.0)]);
    assert_eq!(finer_rays([rows(), finer(4), one_more()].concat()), (5, 4));
    assert_eq!(finer_rays([rows(), finer(10)].concat()), (10, 10));

    assert_eq!(mixed([rows(), one_more()].concat()), "tier");
    let third = on_tier(Tier::Tiny, &rows()[..5]);
    assert_eq!(mixed([rows(), finer(4), third].concat()), "tier");
    let as_long = finer(10).into_iter().map(|row| Row { cpu_s: 9.5, ..row });
    assert_eq!(mixed(rows().into_iter().chain(as_long).collect()), "tier");
}

#[test]
fn the_rays_of_both_meshes_are_straight_or_bend_alike() {
    let bend = |mut row: Row| {
        let (lambda, end) = (row.sample.lambda, row.sample.theta / row.sample.lambda);
        row.sample.a -= 0.16 * row.design.w_lig * end * end.abs() * lambda * (1.0 - lambda);
        row
    };
    let bent = |rows: Vec<Row>| rows.into_iter().map(bend).collect::<Vec<_>>();
    let bends = |rows| collect(rows).unwrap().manifest().bent_rays;
    assert!(!bends([rows(), finer(4)].concat()));
    let both = collect(bent([rows(), finer(4)].concat())).unwrap();
    assert!(both.manifest().bent_rays);
    assert_eq!(both.on_both_meshes().len(), 4);
    assert_eq!(mixed([rows(), bent(finer(4))].concat()), "a");
    assert_eq!(mixed([bent(rows()), finer(4)].concat()), "a");
}

#[test]
fn the_rows_of_a_ray_are_of_one_mesh() {
    for change in [Tier::Default, Tier::Reference].map(Fidelity::Solved) {
        let mut both = [rows(), finer(4)].concat();
        let other = both.iter_mut().find(|row| row.tier != change).unwrap();
        other.tier = change;
        let column = mixed(both);
        assert!(["tier", "settings_hash"].contains(&&*column), "{column}");
    }
}

#[test]
fn the_rows_of_a_mesh_have_the_same_settings_and_those_of_both_the_same_material() {
    type Change = fn(&mut Row);
    let settings: Change = |row| row.settings_hash = "07e4".into();
    for at in [0, 49, 50, 69] {
        let mut both = [rows(), finer(4)].concat();
        settings(&mut both[at]);
        assert_eq!(mixed(both), "settings_hash", "{at}");
    }
    let shared: [(Change, &str); 4] = [
        (|row| row.material = "steel".into(), "material"),
        (|row| row.material_hash = "57ee1".into(), "material_hash"),
        (|row| row.design.kerf = 0.1, "kerf"),
        (|row| row.design.r_win = 70.0, "r_win"),
    ];
    for (change, expected) in shared {
        let mut fine = finer(4);
        fine.iter_mut().for_each(change);
        assert_eq!(mixed([rows(), fine].concat()), expected);
    }
}
