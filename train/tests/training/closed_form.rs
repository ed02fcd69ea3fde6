//! Training on an energy that is known in closed form.
//!
//! ```text
//! W = w (20 u^2 + 10 v^2 + 3 t^2 + 4 u t + 3 v t cos(alpha) + t^4 (1 + sin(alpha)) / 4)
//! D = (t^2 + u^2) / 100,      u = a / w,  v = s / w,  t = theta,  w = w_lig
//! ```
//!
//! The energy is positive and has the mirror symmetry.

use dataset::{Database, SolvedRay, SplitPlan, samples};
use hinge::{HingeConstants, HingeDeformation, HingeDesign, HingeSample};
use surrogate::{Order, Surrogate};
use train::{Trained, Training, TrainingConfig, train};

pub fn sample(design: &HingeDesign, eps: HingeDeformation, lambda: f64) -> HingeSample {
    let w = design.w_lig;
    let [u, v] = eps.eta(w);
    let t = eps.theta;
    let (sin, cos) = design.alpha.sin_cos();
    HingeSample {
        lambda,
        a: eps.a,
        s: eps.s,
        theta: t,
        w: w * (20.0 * u * u
            + 10.0 * v * v
            + 3.0 * t * t
            + 4.0 * u * t
            + 3.0 * v * t * cos
            + 0.25 * t.powi(4) * (1.0 + sin)),
        f_a: 40.0 * u + 4.0 * t,
        f_s: 20.0 * v + 3.0 * t * cos,
        m_theta: w * (6.0 * t + 4.0 * u + 3.0 * v * cos + t.powi(3) * (1.0 + sin)),
        d: 0.01 * (t * t + u * u),
        d_peak: Some(0.2 * t * t),
        ..HingeSample::default()
    }
}

/// Ten increments of each of `jobs` rays, distributed over the features by irrational steps.
pub fn rays(jobs: usize) -> Vec<SolvedRay> {
    let ray = |job: usize| {
        let spread = |step: f64| (step * (job + 1) as f64).fract();
        let design = HingeConstants::PAPER
            .hinge(5.0 + 20.0 * spread(0.754_877_666), 0.8 + 0.77 * spread(0.569_840_291));
        let eta_a = 0.6 * spread(0.414_213_562) - 0.3;
        let eta_s = 0.5 * spread(0.732_050_808) - 0.25;
        let end =
            HingeDeformation::from_eta(eta_a, eta_s, 1.2 * spread(0.236_067_977), design.w_lig);
        let at = |lambda: f64| sample(&design, end.at(lambda), lambda);
        SolvedRay {
            job: format!("job-{job:03}"),
            design,
            samples: (1..=10).map(|k| at(0.1 * f64::from(k))).collect(),
            material: "closed form".into(),
            ..SolvedRay::default()
        }
    };
    (0..jobs).map(ray).collect()
}

/// The designs and the deformations of seven rays.
pub fn states() -> (Vec<HingeDesign>, Vec<HingeDeformation>) {
    samples(&rays(7)).map(|(ray, sample)| (ray.design, sample.deformation())).unzip()
}

pub fn database(rays: Vec<SolvedRay>) -> Database {
    Database::collect(rays, &SplitPlan::default()).unwrap()
}

pub fn config(epochs: usize) -> TrainingConfig {
    TrainingConfig {
        seed: 4,
        embedding: vec![32, 32, 16],
        epochs,
        batch_size: 64,
        learning_rate: 5e-3,
        frozen_layers: 0,
    }
}

pub fn trained(epochs: usize) -> Trained {
    train(&database(rays(60)), &config(epochs), &mut |_| {}).unwrap()
}

/// The energies of a surrogate at some states.
pub fn energies(surrogate: &Surrogate) -> Vec<f64> {
    let (designs, deformations) = states();
    let prepared = surrogate.prepare(&designs);
    let energies = surrogate.evaluate(&prepared, &deformations, Order::Value);
    energies.iter().map(|energy| energy.w).collect()
}

pub fn finished(mut training: Training) -> Trained {
    while !training.is_finished() {
        training.epoch().unwrap();
    }
    training.finish().unwrap()
}
