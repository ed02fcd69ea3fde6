//! Solves the last states of `data/MATERIAL/visited.parquet` again, along the bent rays of the
//! campaigns (`ray`), along the mean of the visited paths (`mean`), or along rays with another
//! curvature (a number): prints F_a, F_s and M at the ends by path, ray and weights.
//!
//! Put it into `verification/examples`, and run `cargo run --release --example forces_by_path
//! polypropylene-3mm ray > ray.csv`. Solves are kept in runs/paths.

use dataset::Database;
use fe_driver::{CalculiX, DeformationPath, HingePath, SolveService, SolveStore, WindowProblem, WindowSolve};
use hinge::{HingeDeformation, HingeSample, SheetMaterial};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use surrogate::Surrogate;

const PIECES: usize = 10;

fn main() {
    let [name, along] = [1, 2].map(|i| std::env::args().nth(i).unwrap());
    let data = Path::new("data").join(&name);
    let database = Database::read(&data.join("visited.parquet")).unwrap();
    let material = SheetMaterial::load(Path::new(&format!("configs/materials/{name}.toml"))).unwrap();
    let law = Surrogate::load(&data.join("medium.safetensors")).unwrap();
    let calculix = CalculiX::find().unwrap();
    let part = |i: usize| i as f64 / PIECES as f64;
    // How far the visited paths sag below straight lines, over w theta^2.
    let mut sag = [0.0; PIECES + 1];
    for ray in database.rays() {
        let (w, end) = (ray.design.w_lig, *ray.samples.last().unwrap());
        let place = |x: &HingeSample| (x.theta / end.theta, (end.a * x.theta / end.theta - x.a) / (w * end.theta.powi(2)));
        let places: Vec<(f64, f64)> = std::iter::once((0.0, 0.0)).chain(ray.samples.iter().map(place)).collect();
        for (i, sag) in sag.iter_mut().enumerate() {
            let k = places.partition_point(|place| place.0 < part(i)).clamp(1, places.len() - 1);
            let ((x, from), (y, to)) = (places[k - 1], places[k]);
            *sag += (from + (to - from) * (part(i) - x) / (y - x)) / database.rays().len() as f64;
        }
    }
    let bent = |end: HingeDeformation, w: f64, sag: &dyn Fn(usize) -> f64| {
        let state = |i: usize| HingeDeformation { a: end.a * part(i) - w * end.theta.powi(2) * sag(i), ..end.at(part(i)) };
        DeformationPath::through(&(1..=PIECES).map(state).collect::<Vec<_>>()).unwrap()
    };
    let solves = database.rays().iter().map(|ray| {
        let (end, w) = (ray.samples.last().unwrap().deformation(), ray.design.w_lig);
        let path = match along.as_str() {
            "ray" => DeformationPath::ray(end, ray.solved_tier.regime(), w),
            "mean" => bent(end, w, &|i| sag[i]),
            number => {
                let c: f64 = number.parse().unwrap();
                bent(end, w, &|i| c * part(i) * (1.0 - part(i)))
            }
        };
        let problem = WindowProblem::new(HingePath { design: ray.design, path }, &material, ray.solved_tier);
        WindowSolve::new(problem, &calculix.versions())
    });
    let solves: Vec<WindowSolve> = solves.collect();
    let service = SolveService {
        store: SolveStore(Path::new("runs/paths").join(&name).join(&along)),
        solver: Box::new(calculix),
        workers: 1,
        limit: Duration::from_secs(3600),
        stop: &AtomicBool::new(false),
        progress: Box::new(|done, all| eprintln!("{done}/{all}")),
    };
    println!("hinge,who,F_a,F_s,M");
    for (hinge, (ray, window)) in database.rays().iter().zip(service.solve(&solves).unwrap()).enumerate() {
        let own = ray.samples.last().unwrap();
        let by_law = law.samples(&[ray.design], &[own.deformation()])[0];
        let solved = *window.complete().unwrap().last().unwrap();
        for (who, x) in [("path", *own), ("ray", solved), ("law", by_law)] {
            println!("{hinge},{who},{},{},{}", x.f_a, x.f_s, x.m_theta);
        }
    }
}
