//! Time to evaluate 275 hinges (a 15 x 10 sheet) with shipped weights, 6-128-128-128-64.
//!
//! Divide by 275 for the time per hinge. The lower bound of each order is the time of its matrix
//! products: 1 (W), 2 (forces), 5 (tangent) and 8 (design) passes of 0.042 Mflop per hinge.

use hinge::{HingeDeformation, HingeDesign};
use std::path::Path;
use surrogate::{Order, Surrogate};

const HINGES: usize = 275;

fn main() {
    divan::main();
}

#[divan::bench(args = [Order::Value, Order::Forces, Order::Tangent, Order::Design])]
fn energy(bencher: divan::Bencher, order: Order) {
    let (surrogate, designs, deformations) = case();
    let prepared = surrogate.prepare(&designs);
    bencher.bench(|| surrogate.evaluate(&prepared, &deformations, order));
}

/// 100 000 hinges of shipped weights, which python/benchmarks/cost.py evaluates from Python.
#[divan::bench(args = [Order::Value, Order::Forces, Order::Tangent], sample_count = 10)]
fn shipped(bencher: divan::Bencher, order: Order) {
    let surrogate = medium();
    let design = surrogate.card().hinge.hinge(18.0, 1.2);
    let states = (0..100_000).map(|i| {
        let x = f64::from(i);
        let [a, s] = [2.1, 3.7].map(|rate| 0.3 * (rate * x).sin());
        HingeDeformation::from([a, s, 0.35 + 0.25 * (0.9 * x).sin()])
    });
    let states: Vec<HingeDeformation> = states.collect();
    let prepared = surrogate.prepare(&vec![design; states.len()]);
    bencher.bench(|| surrogate.evaluate(&prepared, &states, order));
}

#[divan::bench]
fn prepare(bencher: divan::Bencher) {
    let (surrogate, designs, _) = case();
    bencher.bench(|| surrogate.prepare(&designs));
}

#[divan::bench]
fn damage(bencher: divan::Bencher) {
    let (surrogate, designs, deformations) = case();
    bencher.bench(|| surrogate.damage(&designs, &deformations, true));
}

fn medium() -> Surrogate {
    let weights =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/pet-0.5mm/medium.safetensors");
    Surrogate::load(&weights).expect("shipped weights")
}

fn case() -> (Surrogate, Vec<HingeDesign>, Vec<HingeDeformation>) {
    let surrogate = medium();
    let spread = |index: usize, step: f64| (step * index as f64).sin();
    let designs = (0..HINGES).map(|index| {
        let w_lig = 15.0 + 9.0 * spread(index, 0.7);
        let alpha = 1.5 + 0.6 * spread(index, 1.3);
        surrogate.card().hinge.hinge(w_lig, alpha)
    });
    let designs: Vec<HingeDesign> = designs.collect();
    let states = designs.iter().enumerate().map(|(index, design)| {
        let eta_a = 0.2 * spread(index, 2.1);
        let eta_s = 0.2 * spread(index, 3.7);
        HingeDeformation::from_eta(eta_a, eta_s, 0.6 + 0.6 * spread(index, 0.9), design.w_lig)
    });
    let states = states.collect();
    (surrogate, designs, states)
}
