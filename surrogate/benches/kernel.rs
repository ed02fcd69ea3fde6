//! Time to evaluate 275 hinges (a 15 x 10 sheet) with the paper's network 5-256-256-256-128.
//!
//! Divide by 275 for the time per hinge. The lower bound of each order is the time of its matrix products:
//! 1 (W), 2 (forces), 5 (tangent) and 7 (design) passes of 0.33 Mflop per hinge.

use hinge::{HingeConstants, HingeDeformation, HingeDesign, TrainingDomain};
use surrogate::{
    Card, FORMAT_VERSION, Layer, Layers, Order, Standardisation, Surrogate, Tensor, TestErrors,
    UNITS, feature_names,
};

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
    let weights = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../data/pet-0.5mm/medium.safetensors"
    );
    let surrogate = Surrogate::load(std::path::Path::new(weights)).expect("shipped weights");
    let design = surrogate.card().hinge.hinge(18.0, 1.2);
    let states = (0..100_000).map(|i| {
        let x = f64::from(i);
        HingeDeformation::from([
            0.3 * (2.1 * x).sin(),
            0.3 * (3.7 * x).sin(),
            0.35 + 0.25 * (0.9 * x).sin(),
        ])
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
    bencher.bench(|| surrogate.damage(&designs, &deformations));
}

fn case() -> (Surrogate, Vec<HingeDesign>, Vec<HingeDeformation>) {
    let surrogate = Surrogate::from_parts(
        Layers {
            chi: layers(&[5, 256, 256, 256, 128]),
            chi_d: layers(&[5, 256, 256, 1]),
            chi_p: Some(layers(&[5, 256, 256, 1])),
        },
        card(),
    )
    .expect("the weights are finite and the shapes fit");
    let spread = |index: usize, step: f64| (step * index as f64).sin();
    let designs = (0..HINGES).map(|index| {
        HingeConstants::PAPER.hinge(
            15.0 + 10.0 * spread(index, 0.7),
            1.5 + 0.7 * spread(index, 1.3),
        )
    });
    let designs: Vec<HingeDesign> = designs.collect();
    let states = designs.iter().enumerate().map(|(index, design)| {
        let eta_a = 0.2 * spread(index, 2.1);
        let eta_s = 0.2 * spread(index, 3.7);
        HingeDeformation::from_eta(eta_a, eta_s, 0.6 + 0.6 * spread(index, 0.9), design.w_lig)
    });
    let deformations = states.collect();
    (surrogate, designs, deformations)
}

/// Deterministic weights within the bounds of Xavier's initialisation.
fn layers(widths: &[usize]) -> Vec<Layer> {
    let mut state = 0.37_f64;
    let mut uniform = || {
        state = 3.99 * state * (1.0 - state);
        2.0 * state - 1.0
    };
    let pairs = widths.windows(2);
    pairs
        .map(|pair| {
            let (inputs, outputs) = (pair[0], pair[1]);
            let bound = (6.0 / (inputs + outputs) as f64).sqrt();
            let mut tensor = |shape: Vec<usize>| {
                let length = shape.iter().product();
                let values = (0..length).map(|_| bound * uniform()).collect();
                Tensor { shape, values }
            };
            Layer {
                weight: tensor(vec![outputs, inputs]),
                bias: tensor(vec![outputs]),
            }
        })
        .collect()
}

fn card() -> Card {
    Card {
        format_version: FORMAT_VERSION,
        weights_hash: None,
        units: UNITS.into(),
        features: feature_names(false)
            .iter()
            .map(ToString::to_string)
            .collect(),
        standardisation: Standardisation {
            mean: [0.02, 0.0, 0.6, 2.64, 1.6].to_vec(),
            std: [0.1, 0.1, 0.35, 0.45, 0.45].to_vec(),
        },
        energy_scale: 85.0,
        damage_scale: 0.012,
        peak_scale: Some(0.3),
        damage_sharpness: 8.0,
        domain: TrainingDomain::from_box(
            [[-0.5, 0.25], [-0.35, 0.35], [0.0, 1.25]],
            [5.0, 25.0],
            [0.8, 2.3],
        ),
        hinge: HingeConstants::PAPER,
        material: "benchmark".into(),
        material_hash: None,
        settings_hash: None,
        tier: "none".into(),
        dataset_hash: "none".into(),
        fine_tuned_from: None,
        distillation: None,
        split_hash: "none".into(),
        training: Default::default(),
        training_rays: None,
        training_s: None,
        test_errors: TestErrors::default(),
        error_bins: Vec::new(),
        spot_check: None,
    }
}
