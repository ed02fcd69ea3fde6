//! Training on an energy that is known in closed form.
//!
//! ```text
//! W = w (20 u^2 + 10 v^2 + 3 t^2 + 4 u t + 3 v t cos(alpha) + t^4 (1 + sin(alpha)) / 4)
//! D = (t^2 + u^2) / 100,      u = a / w,  v = s / w,  t = theta,  w = w_lig
//! ```
//!
//! It is positive and keeps the mirror symmetry.

use dataset::{Database, Gates, Row, SplitPlan};
use hinge::{HingeDeformation, HingeDesign, HingeSample};
use surrogate::{Order, Surrogate};
use train::{Backend, Epoch, TrainError, Trained, TrainingConfig, train};

fn sample(design: &HingeDesign, eps: HingeDeformation, lambda: f64) -> HingeSample {
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
        ..HingeSample::default()
    }
}

/// Ten increments of each of `jobs` rays, spread over the features by irrational steps.
fn rows(jobs: usize) -> Vec<Row> {
    let mut rows = Vec::new();
    for job in 0..jobs {
        let spread = |step: f64| (step * (job + 1) as f64).fract();
        let design = HingeDesign {
            w_lig: 5.0 + 20.0 * spread(0.754_877_666),
            alpha: 0.8 + 0.77 * spread(0.569_840_291),
            fillet_ratio: 0.16,
            kerf: 0.2,
            r_win: 100.0,
        };
        let eta_a = 0.6 * spread(0.414_213_562) - 0.3;
        let eta_s = 0.5 * spread(0.732_050_808) - 0.25;
        let end =
            HingeDeformation::from_eta(eta_a, eta_s, 1.2 * spread(0.236_067_977), design.w_lig);
        for increment in 1..=10 {
            let lambda = 0.1 * f64::from(increment);
            rows.push(Row {
                job: format!("job-{job:03}"),
                design,
                sample: sample(&design, end.at(lambda), lambda),
                failure: String::new(),
                material: "closed form".into(),
                tier: "exact".into(),
                solved_tier: "exact".into(),
                gmsh: "none".into(),
                ccx: "none".into(),
                cpu_s: 0.0,
            });
        }
    }
    rows
}

fn database(rows: Vec<Row>) -> Database {
    Database::collect(rows, &Gates::default(), &SplitPlan::default()).unwrap()
}

fn config(epochs: usize) -> TrainingConfig {
    TrainingConfig {
        seed: 4,
        embedding: vec![32, 32, 16],
        damage: vec![32, 32],
        mirror: true,
        epochs,
        batch_size: 64,
        learning_rate: 5e-3,
        learning_rate_end: 1e-5,
        gradient_norm_max: 1.0,
        energy_weight: 0.5,
        damage_weight: 0.5,
    }
}

fn trained(epochs: usize, backend: Backend) -> Trained {
    train(&database(rows(60)), &config(epochs), backend, &mut |_| {}).unwrap()
}

/// The energies of a surrogate at some states.
fn energies(surrogate: &Surrogate) -> Vec<f64> {
    let (designs, deformations): (Vec<_>, Vec<_>) = rows(7)
        .iter()
        .map(|row| (row.design, row.sample.deformation()))
        .unzip();
    let prepared = surrogate.prepare(&designs);
    let energies = surrogate.evaluate(&prepared, &deformations, Order::Value);
    energies.iter().map(|energy| energy.w).collect()
}

#[test]
fn an_energy_in_closed_form_is_learned() {
    let mut reported: Vec<Epoch> = Vec::new();
    let database = database(rows(200));
    let trained = train(&database, &config(100), Backend::default(), &mut |epoch| {
        reported.push(*epoch);
    })
    .unwrap();
    let errors = trained.test_errors;
    assert_eq!(errors.rows, 400);
    assert!(errors.energy.relative_rmse < 0.02, "{errors:?}");
    assert!(errors.energy.median < 0.03, "{errors:?}");
    for force in [errors.f_a, errors.f_s, errors.m_theta, errors.damage] {
        assert!(force.relative_rmse < 0.05, "{errors:?}");
    }
    assert_eq!(reported, trained.history);
    assert_eq!(reported.len(), 100);
    let least = |epochs: &[Epoch]| {
        epochs
            .iter()
            .map(|epoch| epoch.validation_loss)
            .fold(f64::INFINITY, f64::min)
    };
    let last_best = reported.iter().rfind(|epoch| epoch.best).unwrap();
    assert_eq!(last_best.validation_loss, least(&reported));
    assert!(last_best.validation_loss < 0.01 * reported[0].validation_loss);

    let card = trained.surrogate.card();
    assert_eq!(card.dataset_hash, database.manifest().hash);
    assert_eq!(card.split_hash, database.manifest().split_hash);
    assert_eq!(card.test_errors, errors);
    assert_eq!(card.training["batch_size"], 64);
    assert_eq!(card.hinge.r_win, 100.0);
    assert!(
        card.domain.alpha[1] > 2.0,
        "mirror images belong to the domain"
    );
    assert_eq!(trained.parity.energy.len(), errors.rows);
}

#[test]
fn a_seed_gives_the_same_weights_and_another_gives_others() {
    let first = energies(&trained(2, Backend::default()).surrogate);
    assert_eq!(first, energies(&trained(2, Backend::default()).surrogate));
    let other = TrainingConfig {
        seed: 5,
        ..config(2)
    };
    let other = train(&database(rows(60)), &other, Backend::default(), &mut |_| {}).unwrap();
    assert_ne!(first, energies(&other.surrogate));
}

#[test]
fn backends_agree_on_the_first_steps() {
    let all: Vec<Vec<f64>> = Backend::ALL
        .iter()
        .map(|&backend| energies(&trained(1, backend).surrogate))
        .collect();
    for energies in &all[1..] {
        for (left, right) in energies.iter().zip(&all[0]) {
            assert!(
                (left - right).abs() <= 1e-4 * left.abs().max(1.0),
                "{left} and {right}"
            );
        }
    }
}

#[test]
fn a_surrogate_survives_the_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chi.safetensors");
    let trained = trained(1, Backend::default());
    trained.surrogate.save(&path).unwrap();
    let loaded = Surrogate::load(&path).unwrap();
    assert_eq!(loaded.card(), trained.surrogate.card());
    assert_eq!(energies(&loaded), energies(&trained.surrogate));
}

#[test]
fn rows_with_nothing_to_learn_are_refused() {
    let refusal = |change: fn(&mut Row)| {
        let mut rows = rows(12);
        rows.iter_mut().for_each(change);
        // Mirroring would give a constant alpha a spread.
        let config = TrainingConfig {
            mirror: false,
            ..config(1)
        };
        train(&database(rows), &config, Backend::default(), &mut |_| {}).unwrap_err()
    };
    let error = refusal(|row| row.design.alpha = 1.0);
    assert!(
        matches!(
            error,
            TrainError::ConstantFeature {
                feature: "alpha",
                ..
            }
        ),
        "{error}"
    );
    let error = refusal(|row| row.sample.theta = 0.7);
    assert!(
        matches!(
            error,
            TrainError::ConstantFeature {
                feature: "theta",
                ..
            }
        ),
        "{error}"
    );
    let error = refusal(|row| row.sample.d = 0.0);
    assert!(
        matches!(error, TrainError::NoScale { target: "D", .. }),
        "{error}"
    );
}

#[test]
fn a_loss_beyond_float32_says_so() {
    let mut rows = rows(12);
    for row in &mut rows {
        row.sample.f_a *= 1e-60;
    }
    let error = train(&database(rows), &config(2), Backend::default(), &mut |_| {}).unwrap_err();
    assert!(
        matches!(error, TrainError::Diverged { epoch: 1, .. }),
        "{error}"
    );
}
