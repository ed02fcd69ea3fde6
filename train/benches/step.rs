//! Time of ten training steps (2560 rows in batches of 256), including set-up and one validation,
//! for the network sizes of `tiny.toml` and `paper.toml`.

use dataset::{Database, SolvedRay, SplitPlan};
use hinge::{HingeConstants, HingeSample};
use train::{TrainingConfig, train};

fn main() {
    divan::main();
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn tiny(bencher: divan::Bencher) {
    ten_steps(bencher, &[64, 64, 32]);
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn paper(bencher: divan::Bencher) {
    ten_steps(bencher, &[256, 256, 256, 128]);
}

fn ten_steps(bencher: divan::Bencher, embedding: &[usize]) {
    let database = database();
    let config = TrainingConfig {
        seed: 0,
        embedding: embedding.to_vec(),
        epochs: 1,
        batch_size: 256,
        learning_rate: 1e-3,
        frozen_layers: 0,
    };
    bencher.bench(|| train(&database, &config, &mut |_| {}));
}

/// 100 rays of 32 samples, 80 of them for training.
fn database() -> Database {
    let ray = |index: u32| {
        let x = f64::from(index);
        let sample = |k: u32| {
            let lambda = f64::from(k) / 32.0;
            HingeSample {
                lambda,
                a: lambda * x.cos(),
                s: lambda * (2.3 * x).cos(),
                theta: lambda,
                w: 50.0 * lambda * lambda,
                f_a: lambda,
                f_s: lambda,
                m_theta: 100.0 * lambda,
                d: 0.01 * lambda,
                ..HingeSample::default()
            }
        };
        SolvedRay {
            job: format!("job-{index:03}"),
            design: HingeConstants::PAPER.hinge(15.0 + 10.0 * x.sin(), 1.5 + 0.7 * (1.7 * x).sin()),
            samples: (1..=32).map(sample).collect(),
            material: "benchmark".into(),
            ..SolvedRay::default()
        }
    };
    Database::collect((0..100).map(ray).collect(), &SplitPlan::default())
        .expect("the samples are finite and of a hundred geometries")
}
