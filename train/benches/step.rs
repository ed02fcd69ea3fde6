//! Time of ten training steps (2560 rows in batches of 256), including set-up and one validation,
//! for the network sizes of `tiny.toml` and `paper.toml`.

use dataset::{Database, Row, SplitPlan};
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

/// 100 rays of 32 rows, 80 of them for training.
fn database() -> Database {
    let rows = (0..3200).map(|index| {
        let ray = (index / 32) as f64;
        let lambda = (index % 32 + 1) as f64 / 32.0;
        Row {
            job: format!("job-{ray:03}"),
            design: HingeConstants::PAPER
                .hinge(15.0 + 10.0 * ray.sin(), 1.5 + 0.7 * (1.7 * ray).sin()),
            sample: HingeSample {
                lambda,
                a: lambda * ray.cos(),
                s: lambda * (2.3 * ray).cos(),
                theta: lambda,
                w: 50.0 * lambda * lambda,
                f_a: lambda,
                f_s: lambda,
                m_theta: 100.0 * lambda,
                d: 0.01 * lambda,
                ..HingeSample::default()
            },
            material: "benchmark".into(),
            ..Row::default()
        }
    });
    Database::collect(rows.collect(), &SplitPlan::default())
        .expect("the rows are finite and of a hundred geometries")
}
