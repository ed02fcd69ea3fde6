//! Databases of two meshes: some of the rays are there on a finer one too.

use crate::common::{collect, finer, on_tier, ray, rays, sample};
use dataset::{Database, Fidelity, FinerMesh, SolvedRay, Subset, samples};
use mesher::Tier;
use testkit::changed;

fn both() -> Database {
    collect([rays(), finer(4)].concat()).unwrap()
}

/// The column in which rays must not differ, but do.
fn mixed(rays: Vec<SolvedRay>) -> String {
    let error = collect(rays).unwrap_err().to_string();
    error.split([' ', '=']).nth(2).unwrap().to_owned()
}

#[test]
fn a_database_with_a_finer_mesh_is_written_and_read_back_bit_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.parquet");
    let database = both();
    database.write(&path, false).unwrap();
    let read = Database::read(&path).unwrap();
    assert_eq!(read.rays(), database.rays());
    assert_eq!(read.manifest(), database.manifest());
    let bytes = [&path, &path.with_extension("json")].map(|path| std::fs::read(path).unwrap());
    read.write(&path, true).unwrap();
    let again = [&path, &path.with_extension("json")].map(|path| std::fs::read(path).unwrap());
    assert_eq!(again, bytes);
}

#[test]
fn counts_split_and_domain_are_of_the_rays_alone() {
    // One of the rays on the finer mesh is partial, and one goes on beyond its end, where it would
    // widen the domain.
    let beyond = |rays, job: &str| {
        changed(rays, |ray: &mut SolvedRay| {
            ray.samples.extend((ray.job == job).then(|| sample(1.2)));
        })
    };
    let fine = beyond(finer(4), "reference-job-03");
    let database = collect([rays(), fine].concat()).unwrap();
    let (manifest, alone) = (database.manifest(), collect(rays()).unwrap());
    let wide = collect(beyond(rays(), "job-03")).unwrap();
    assert_ne!(wide.manifest().domain, alone.manifest().domain);
    let expected = FinerMesh { tier: Fidelity::Solved(Tier::Reference), rays: 4, cpu_s: 160.0 };
    assert_eq!(manifest.finer, Some(expected));
    assert_eq!(alone.manifest().finer, None);
    assert_eq!((manifest.rows, samples(database.rays()).count()), (71, 71));
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
fn the_parts_have_no_ray_of_the_finer_mesh() {
    let (database, alone) = (both(), collect(rays()).unwrap());
    for part in [Subset::Training, Subset::Validation, Subset::Test] {
        assert_eq!(database.part(part), alone.part(part));
    }
}

#[test]
fn the_finer_mesh_has_fewer_rays_or_longer_solves() {
    let finer_rays = |rays: Vec<SolvedRay>| {
        let database = collect(rays).unwrap();
        let finer = database.manifest().finer.clone().unwrap();
        assert_eq!(finer.tier, Fidelity::Solved(Tier::Reference));
        (finer.rays, database.on_both_meshes().len())
    };
    // A ray that failed on the other mesh has no use.
    let one_more = || on_tier(Tier::Reference, vec![ray(10)]);
    assert_eq!(finer_rays([rays(), finer(4), one_more()].concat()), (5, 4));
    assert_eq!(finer_rays([rays(), finer(10)].concat()), (10, 10));

    assert_eq!(mixed([rays(), one_more()].concat()), "tier");
    let third = on_tier(Tier::Tiny, rays().split_off(9));
    assert_eq!(mixed([rays(), finer(4), third].concat()), "tier");
    let as_long = changed(finer(10), |ray| ray.cpu_s = 9.5);
    assert_eq!(mixed([rays(), as_long].concat()), "tier");
}

#[test]
fn the_rays_of_both_meshes_are_straight_or_bend_alike() {
    let bend = |ray: &mut SolvedRay| {
        for x in &mut ray.samples {
            let end = x.theta / x.lambda;
            x.a -= 0.16 * ray.design.w_lig * end * end.abs() * x.lambda * (1.0 - x.lambda);
        }
    };
    let bent = |rays: Vec<SolvedRay>| changed(rays, bend);
    let bends = |rays| collect(rays).unwrap().manifest().bent_rays;
    assert!(!bends([rays(), finer(4)].concat()));
    let both = collect(bent([rays(), finer(4)].concat())).unwrap();
    assert!(both.manifest().bent_rays);
    assert_eq!(both.on_both_meshes().len(), 4);
    assert_eq!(mixed([rays(), bent(finer(4))].concat()), "a");
    assert_eq!(mixed([bent(rays()), finer(4)].concat()), "a");
}

#[test]
fn the_rays_of_a_mesh_have_the_same_settings_and_all_the_same_material() {
    type Change = fn(&mut SolvedRay);
    let settings: Change = |ray| ray.settings_hash = "07e4".into();
    for at in [0, 9, 10, 13] {
        let mut both = [rays(), finer(4)].concat();
        settings(&mut both[at]);
        assert_eq!(mixed(both), "settings_hash", "{at}");
    }
    let shared: [(Change, &str); 4] = [
        (|ray| ray.material = "steel".into(), "material"),
        (|ray| ray.material_hash = "57ee1".into(), "material_hash"),
        (|ray| ray.design.kerf = 0.1, "kerf"),
        (|ray| ray.design.r_win = 70.0, "r_win"),
    ];
    for (change, expected) in shared {
        assert_eq!(mixed([rays(), changed(finer(4), change)].concat()), expected);
    }
}
