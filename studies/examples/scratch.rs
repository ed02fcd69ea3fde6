use hinge::*;
use rand::{RngExt, SeedableRng};
use std::path::Path;
fn volume(domain: &TrainingDomain) -> f64 {
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let b = domain.bounds();
    let mut between = |[f, t]: [f64; 2]| f + (t - f) * random.random::<f64>();
    let n = 200_000;
    let mut inside = 0;
    for _ in 0..n {
        let mut g = HingeConstants::PAPER.hinge(
            between(domain.w_lig.map(f64::ln)).exp(),
            between(domain.alpha),
        );
        if let Some(h) = domain.holes {
            g.fillet_ratio = between(h);
        }
        let x = domain.state(&g, b.map(&mut between));
        inside += usize::from(domain.contains(&g, &x));
    }
    inside as f64 / n as f64 * b.iter().map(|[f, t]| t - f).product::<f64>()
}
fn main() {
    for file in std::env::args().skip(1) {
        let db = dataset::Database::read(Path::new(&file)).unwrap();
        let states: Vec<_> = db
            .rows()
            .iter()
            .flat_map(|r| {
                let (g, x) = (r.design, r.sample.deformation());
                [(g, x), (g.mirrored(), x.mirrored())]
            })
            .collect();
        let new = TrainingDomain::covering(states.iter().copied()).unwrap();
        let old = &db.manifest().domain;
        let share = |d: &TrainingDomain| {
            states.iter().filter(|(g, x)| d.contains(g, x)).count() as f64 / states.len() as f64
        };
        println!(
            "{file} old {:.4} new {:.4}; states inside {:.3} {:.3}; {:?}",
            volume(old),
            volume(&new),
            share(old),
            share(&new),
            new.bounds()
        );
        println!(
            "  {}",
            serde_json::to_string(&new).unwrap().get(0..220).unwrap()
        );
    }
}
