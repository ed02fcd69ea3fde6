//! Training on an energy that is known in closed form.
//!
//! ```text
//! W = w (20 u^2 + 10 v^2 + 3 t^2 + 4 u t + 3 v t cos(alpha) + t^4 (1 + sin(alpha)) / 4)
//! D = (t^2 + u^2) / 100,      u = a / w,  v = s / w,  t = theta,  w = w_lig
//! ```
//!
//! The energy is positive and has the mirror symmetry.

use dataset::{Database, Gates, Part, Row, SplitPlan};
use hinge::{HingeDeformation, HingeDesign, HingeSample};
use std::path::Path;
use surrogate::{Order, Surrogate};
use train::{
    Backend, EnsembleCheck, Epoch, Lesson, Parity, ParityPoint, Precision, Start, StateError,
    TrainError, Trained, Training, TrainingConfig, TrainingData, disagreements, train,
};

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
        d_peak: Some(0.2 * t * t),
        ..HingeSample::default()
    }
}

/// Ten increments of each of `jobs` rays, distributed over the features by irrational steps.
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
                material_hash: String::new(),
                settings_hash: String::new(),
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
        precision: Precision::F32,
        learning_rate: 5e-3,
        learning_rate_end: 1e-5,
        gradient_norm_max: 1.0,
        energy_weight: 0.5,
        damage_weight: 0.5,
        damage_sharpness: 8.0,
        patience: None,
        frozen_layers: 0,
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
    assert_eq!(errors.rows, 200);
    assert!(errors.energy.relative_rmse < 0.02, "{errors:?}");
    assert!(errors.energy.median < 0.03, "{errors:?}");
    for force in [errors.f_a, errors.f_s, errors.m_theta, errors.damage] {
        assert!(force.relative_rmse < 0.05, "{errors:?}");
    }
    assert_eq!(reported, trained.history);
    assert_eq!(reported.len(), 100);
    let mut minimum = [f64::INFINITY; 3];
    for epoch in &reported {
        let errors = epoch.validation_errors;
        let better = (0..3).any(|k| errors[k] < minimum[k]);
        assert_eq!(epoch.best, better, "{epoch:?}");
        minimum = [0, 1, 2].map(|k| errors[k].min(minimum[k]));
    }
    assert!(minimum[0] < 0.1 * reported[0].validation_errors[0]);

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

/// The validation rows have no damage, and their D_peak is not known.
#[test]
fn a_damage_head_without_a_known_error_is_that_of_the_last_epoch() {
    let whole = database(rows(30));
    let validation = &whole.manifest().split.validation;
    let mut rows = whole.rows().to_vec();
    for row in rows.iter_mut().filter(|row| validation.contains(&row.job)) {
        row.sample.d = 0.0;
        row.sample.d_peak = None;
    }
    let database = database(rows);
    let config = config(3);
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join("state");
    let mut training = Training::new(&database, &config, Backend::default(), Start::Fresh).unwrap();
    training.epoch().unwrap();
    training.save(&state).unwrap();
    let start = Start::State {
        state: &state,
        parent: None,
    };
    let mut training = Training::new(&database, &config, Backend::default(), start).unwrap();
    while !training.is_finished() {
        training.epoch().unwrap();
    }
    let trained = training.finish().unwrap();
    for epoch in &trained.history {
        let [energy, d, d_peak] = epoch.validation_errors;
        assert!(energy > 0.0 && d.is_nan() && d_peak.is_nan(), "{epoch:?}");
    }
    let test = database.part(Part::Test);
    let predicted = |surrogate: &Surrogate| {
        let parity = Parity::of(surrogate, &test);
        (parity.damage, parity.damage_peak)
    };
    assert_eq!(predicted(&trained.surrogate), predicted(&trained.last));
    assert!(trained.test_errors.damage_peak.relative_rmse > 0.0);
}

#[test]
fn mirror_images_give_the_same_energy_and_damage() {
    let surrogate = trained(2, Backend::default()).surrogate;
    let (designs, states): (Vec<_>, Vec<_>) = rows(7)
        .iter()
        .map(|row| (row.design, row.sample.deformation()))
        .unzip();
    let images: Vec<_> = designs.iter().map(HingeDesign::mirrored).collect();
    let mirrored: Vec<_> = states.iter().map(HingeDeformation::mirrored).collect();
    let close = |left: f64, right: f64| (left - right).abs() <= 1e-12 * left.abs().max(1.0);

    let evaluate = |designs: &[HingeDesign], states: &[HingeDeformation]| {
        surrogate.evaluate(&surrogate.prepare(designs), states, Order::Forces)
    };
    for (hinge, image) in evaluate(&designs, &states)
        .iter()
        .zip(evaluate(&images, &mirrored))
    {
        assert!(hinge.w > 0.0 && close(hinge.w, image.w));
        let [f_a, f_s, m_theta] = image.forces;
        for (force, image) in hinge.forces.into_iter().zip([f_a, -f_s, m_theta]) {
            assert!(close(force, image), "{force} and {image}");
        }
    }
    let damages = surrogate.damage(&designs, &states);
    for (hinge, image) in damages.iter().zip(surrogate.damage(&images, &mirrored)) {
        assert!(close(hinge.d, image.d));
    }
}

#[test]
fn equal_seeds_give_equal_weights_and_different_seeds_different_ones() {
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
fn a_trained_surrogate_round_trips_through_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chi.safetensors");
    let trained = trained(1, Backend::default());
    trained.surrogate.save(&path).unwrap();
    let loaded = Surrogate::load(&path).unwrap();
    assert_eq!(loaded.card(), trained.surrogate.card());
    assert_eq!(energies(&loaded), energies(&trained.surrogate));
}

#[test]
fn constant_features_and_zero_targets_are_errors() {
    let refusal = |change: fn(&mut Row)| {
        let mut rows = rows(12);
        rows.iter_mut().for_each(change);
        // With mirror images, alpha would not be constant.
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
fn a_loss_that_overflows_float32_is_an_error() {
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

/// A training of `epochs` epochs after `run` of them.
fn begun(epochs: usize, run: usize, backend: Backend) -> Training {
    let database = database(rows(20));
    let mut training = Training::new(&database, &config(epochs), backend, Start::Fresh).unwrap();
    for _ in 0..run {
        training.epoch().unwrap();
    }
    training
}

fn finished(mut training: Training) -> Trained {
    while !training.is_finished() {
        training.epoch().unwrap();
    }
    training.finish().unwrap()
}

fn resumed(state: &Path, config: &TrainingConfig) -> Result<Training, TrainError> {
    let database = database(rows(20));
    let start = Start::State {
        state,
        parent: None,
    };
    Training::new(&database, config, Backend::default(), start)
}

#[test]
fn a_resumed_training_is_bit_exact() {
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join("chi.state");
    for &backend in Backend::ALL {
        let straight = finished(begun(5, 0, backend));
        begun(5, 2, backend).save(&state).unwrap();
        let database = database(rows(20));
        let start = Start::State {
            state: &state,
            parent: None,
        };
        let training = Training::new(&database, &config(5), backend, start).unwrap();
        assert_eq!(training.history().len(), 2);
        let resumed = finished(training);
        assert_eq!(energies(&straight.surrogate), energies(&resumed.surrogate));
        assert_eq!(energies(&straight.last), energies(&resumed.last));
        let losses = |trained: &Trained| -> Vec<_> {
            let epochs = trained.history.iter();
            epochs
                .map(|it| (it.training_loss, it.validation_loss, it.best))
                .collect()
        };
        assert_eq!(losses(&straight), losses(&resumed));
    }
}

#[test]
fn a_damaged_or_foreign_state_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join("chi.state");
    begun(3, 1, Backend::default()).save(&state).unwrap();
    let other = TrainingConfig {
        batch_size: 32,
        ..config(3)
    };
    let error = resumed(&state, &other).err().unwrap();
    assert!(error.to_string().contains("configuration"), "{error}");

    let bytes = std::fs::read(&state).unwrap();
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 1;
    let cases = [
        &bytes[..0],
        &bytes[..31],
        &bytes[..32],
        &bytes[..bytes.len() - 1],
        &flipped,
    ];
    for damaged in cases {
        std::fs::write(&state, damaged).unwrap();
        let error = resumed(&state, &config(3)).err().unwrap();
        let malformed = matches!(error, TrainError::State(StateError::Malformed { .. }));
        assert!(malformed, "{} bytes: {error}", damaged.len());
    }
    std::fs::remove_file(&state).unwrap();
    let error = resumed(&state, &config(3)).err().unwrap();
    assert!(
        matches!(error, TrainError::State(StateError::Read { .. })),
        "{error}"
    );
}

/// The rows in a sheet of `factor` times the thickness, whose material is `stiffness` times as stiff.
fn similar(rows: Vec<Row>, factor: f64, stiffness: f64) -> Vec<Row> {
    let (areas, volumes) = (factor.powi(2) * stiffness, factor.powi(3) * stiffness);
    let row = |row: Row| Row {
        design: row.design.scaled(factor),
        sample: HingeSample {
            a: factor * row.sample.a,
            s: factor * row.sample.s,
            w: volumes * row.sample.w,
            f_a: areas * row.sample.f_a,
            f_s: areas * row.sample.f_s,
            m_theta: volumes * row.sample.m_theta,
            ..row.sample
        },
        ..row
    };
    rows.into_iter().map(row).collect()
}

/// The training of `epochs` epochs in float64 on the rows of a sheet of another thickness and stiffness, which starts from
/// `parent`.
fn tuned(parent: &Surrogate, epochs: usize) -> (Database, Training) {
    let database = database(similar(rows(30), 0.4, 3.0));
    let config = TrainingConfig {
        precision: Precision::F64,
        learning_rate: 1e-3,
        ..config(epochs)
    };
    let start = Start::Weights(parent);
    let training = Training::new(&database, &config, Backend::default(), start).unwrap();
    (database, training)
}

#[test]
fn fine_tuning_starts_with_the_function_of_the_given_weights() {
    let parent = trained(40, Backend::default()).surrogate;
    let (database, training) = tuned(&parent, 1);
    let start = training.finish().unwrap().surrogate;
    let scaled = parent.clone().scaled(0.4);
    assert_ne!(start.card().standardisation, scaled.card().standardisation);
    let hash = start.card().fine_tuned_from.clone();
    assert_eq!(hash, Some(parent.hash()));

    let predicted = |surrogate: &Surrogate| {
        let parity = Parity::of(surrogate, &database.part(Part::Training));
        [
            parity.energy,
            parity.f_a,
            parity.f_s,
            parity.m_theta,
            parity.damage,
            parity.damage_peak,
        ]
    };
    let (expected, found) = (predicted(&scaled), predicted(&start));
    let factor = |points: &[ParityPoint]| {
        let product: f64 = points.iter().map(|it| it.target * it.predicted).sum();
        product / points.iter().map(|it| it.predicted.powi(2)).sum::<f64>()
    };
    let [energy, d, d_peak] = [0, 4, 5].map(|k| factor(&expected[k]));
    assert!((energy / 3.0 - 1.0).abs() < 0.1, "{energy}");
    let factors = [energy, energy, energy, energy, d, d_peak];
    for ((expected, found), factor) in expected.iter().zip(&found).zip(factors) {
        let size = expected
            .iter()
            .map(|it| it.predicted.abs())
            .fold(0.0, f64::max);
        for (expected, found) in expected.iter().zip(found) {
            let difference = (factor * expected.predicted - found.predicted).abs();
            assert!(difference < 1e-10 * factor * size, "{difference}");
        }
    }
}

#[test]
fn a_fine_tuned_network_is_closer_than_one_from_scratch() {
    let parent = trained(40, Backend::default()).surrogate;
    let (database, training) = tuned(&parent, 10);
    let scratch = train(&database, &config(10), Backend::default(), &mut |_| {}).unwrap();
    let tuned = finished(training);
    for k in 0..4 {
        let [tuned, scratch] = [&tuned, &scratch].map(|it| it.test_errors.percents()[k]);
        assert!(tuned < 0.5 * scratch, "{k}: {tuned} and {scratch}");
    }
}

#[test]
fn weights_of_the_same_law_keep_their_domain_and_sizes() {
    let of_law = |rows: Vec<Row>, law: &str| {
        let with_law = |row| Row {
            material_hash: law.into(),
            ..row
        };
        database(rows.into_iter().map(with_law).collect())
    };
    let whole = of_law(rows(40), "film");
    let parent = train(&whole, &config(1), Backend::default(), &mut |_| {})
        .unwrap()
        .surrogate;
    let few: Vec<Row> = whole.part(Part::Training).into_iter().take(80).collect();
    let start = |rows: &Database| {
        let other = TrainingConfig {
            embedding: vec![4],
            damage: vec![4],
            ..config(1)
        };
        let config = other.with_sizes_of(&parent);
        let training = Training::new(rows, &config, Backend::default(), Start::Weights(&parent));
        training.unwrap().finish().unwrap().surrogate
    };
    let domain = |surrogate: &Surrogate| surrogate.card().domain.clone();
    assert_eq!(
        domain(&start(&of_law(few.clone(), "film"))),
        domain(&parent)
    );
    let other = domain(&start(&of_law(few.clone(), "steel")));
    assert_ne!(other, domain(&parent));
    // Rows beyond the domain enlarge it.
    assert_ne!(domain(&start(&of_law(rows(120), "film"))), domain(&parent));
    // The same law in another thickness: the ligaments scale with it.
    let thin = domain(&start(&of_law(similar(few, 0.4, 1.0), "film")));
    assert_eq!(thin, domain(&parent.clone().scaled(0.4)));
    assert_ne!(thin, domain(&parent));
}

#[test]
fn frozen_layers_are_not_trained() {
    let parent = trained(2, Backend::default()).surrogate;
    let database = database(rows(20));
    let config = TrainingConfig {
        frozen_layers: 1,
        ..config(2)
    };
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join("chi.state");
    let begun = |start| Training::new(&database, &config, Backend::default(), start).unwrap();
    let start = Start::Weights(&parent);
    let initial = begun(start).finish().unwrap().last.layers();
    let mut training = begun(start);
    training.epoch().unwrap();
    training.save(&state).unwrap();
    // Also of a training that is resumed.
    let resumed = |parent| Start::State {
        state: &state,
        parent,
    };
    let last = finished(begun(resumed(Some(&parent)))).last.layers();
    let without = Training::new(&database, &config, Backend::default(), resumed(None));
    assert!(matches!(
        without.err(),
        Some(TrainError::State(StateError::Other { what, .. })) if what.contains("start from")
    ));
    for (initial, last) in [
        (&initial.chi, &last.chi),
        (&initial.chi_d, &last.chi_d),
        (
            initial.chi_p.as_ref().unwrap(),
            last.chi_p.as_ref().unwrap(),
        ),
    ] {
        assert_eq!(initial[0], last[0]);
        assert_ne!(initial[1], last[1]);
    }
}

#[test]
fn unsuitable_initial_weights_are_errors() {
    let base = trained(1, Backend::default()).surrogate;
    let database = database(rows(20));
    let refusal = |parent: &Surrogate, config: &TrainingConfig| {
        let start = Start::Weights(parent);
        let training = Training::new(&database, config, Backend::default(), start);
        training.err().unwrap()
    };
    let wider = TrainingConfig {
        embedding: vec![32, 32, 32],
        ..config(1)
    };
    let error = refusal(&base, &wider);
    assert!(matches!(error, TrainError::OtherSizes { .. }), "{error}");
    let sharper = TrainingConfig {
        damage_sharpness: 9.0,
        ..config(1)
    };
    let error = refusal(&base, &sharper);
    assert!(
        matches!(error, TrainError::OtherSharpness { .. }),
        "{error}"
    );
    let plain = TrainingConfig {
        mirror: false,
        ..config(1)
    };
    let plain = train(&database, &plain, Backend::default(), &mut |_| {}).unwrap();
    let error = refusal(&plain.surrogate, &config(1));
    assert!(matches!(error, TrainError::NotSymmetric), "{error}");
}

#[test]
fn a_training_that_no_longer_improves_stops_after_the_patience() {
    let config = TrainingConfig {
        patience: Some(2),
        learning_rate: 1e-30,
        learning_rate_end: 1e-30,
        ..config(50)
    };
    let trained = train(
        &database(rows(20)),
        &config,
        Backend::default(),
        &mut |_| {},
    )
    .unwrap();
    assert_eq!(trained.history.len(), 3);
}

#[test]
fn equal_members_of_an_ensemble_agree_and_different_ones_deviate() {
    let rows = rows(20);
    let database = database(rows.clone());
    let member = |seed| {
        let config = TrainingConfig { seed, ..config(3) };
        train(&database, &config, Backend::default(), &mut |_| {})
            .unwrap()
            .surrogate
    };
    let first = member(1);
    let same = EnsembleCheck::of(&disagreements(&[first.clone(), first.clone()], &rows));
    assert!(same.deviation < 1e-12 && same.error > 0.0, "{same:?}");
    let different = EnsembleCheck::of(&disagreements(&[first, member(2)], &rows));
    assert!(different.deviation > 0.01, "{different:?}");
    assert!(different.error_in_top_tenth > 0.0 && different.error_in_top_tenth < 1.0);
}

#[test]
fn an_outlier_is_an_error_that_names_job_and_target() {
    type Change = fn(&mut Row);
    let changes: [(Change, &str); 3] = [
        (|row| row.sample.f_s = -1e6, "F_s"),
        (|row| row.sample.w = 1e6, "W"),
        (|row| row.sample.d_peak = Some(1e6), "D_peak"),
    ];
    for (change, name) in changes {
        let mut rows = rows(20);
        // Every second ray has an outlier, so that the training part contains some.
        rows.iter_mut().step_by(20).for_each(change);
        let error =
            train(&database(rows), &config(1), Backend::default(), &mut |_| {}).unwrap_err();
        match error {
            TrainError::Outlier { target, job, .. } => {
                assert_eq!(target, name);
                assert!(job.starts_with("job-"), "{job}");
            }
            other => panic!("{other}"),
        }
    }
}

#[test]
fn a_database_without_compression_and_without_d_peak_can_be_trained_on() {
    let mut tension = rows(20);
    for row in &mut tension {
        let end = HingeDeformation {
            a: row.sample.a.abs(),
            ..row.sample.deformation()
        };
        row.sample = HingeSample {
            d_peak: None,
            ..sample(&row.design, end, row.sample.lambda)
        };
    }
    let trained = train(
        &database(tension),
        &config(2),
        Backend::default(),
        &mut |_| {},
    )
    .unwrap();
    let card = trained.surrogate.card();
    assert!(card.domain.bounds()[0][0] >= -0.1);
    assert_eq!(card.peak_scale, None);
    assert!(trained.parity.damage_peak.is_empty());
    assert!(trained.test_errors.energy.relative_rmse.is_finite());
}

/// Two networks of one database, and the states on rays that they were not trained on.
fn ensemble() -> ([Surrogate; 2], Vec<(HingeDesign, HingeDeformation)>) {
    let members = [1, 2].map(|seed| {
        let config = TrainingConfig { seed, ..config(20) };
        let trained = train(
            &database(rows(20)),
            &config,
            Backend::default(),
            &mut |_| {},
        );
        trained.unwrap().surrogate
    });
    let others = rows(120).split_off(200);
    let states = others
        .iter()
        .map(|row| (row.design, row.sample.deformation()));
    (members, states.collect())
}

#[test]
fn a_network_learns_the_mean_of_several() {
    let (members, states) = ensemble();
    let database = database(rows(20));
    let lesson = Lesson::new(&members, &states);
    let student = |lesson: Option<&Lesson>| {
        let data = TrainingData {
            database: &database,
            lesson,
        };
        let start = Start::Weights(&members[0]);
        finished(Training::new(data, &config(40), Backend::default(), start).unwrap()).surrogate
    };
    let [taught, alone] = [Some(&lesson), None].map(student);
    // On rays of neither.
    let unseen = rows(220).split_off(1200);
    let parities = |networks: &[Surrogate]| {
        let parities: Vec<Parity> = networks.iter().map(|it| Parity::of(it, &unseen)).collect();
        Parity::mean(&parities)
    };
    let mean = parities(&members);
    let distance = |network: &Surrogate| {
        let found = parities(std::slice::from_ref(network));
        let pairs = mean.energy.iter().zip(&found.energy);
        pairs
            .map(|(mean, found)| (mean.predicted - found.predicted).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let [taught_distance, alone_distance] = [&taught, &alone].map(distance);
    assert!(
        taught_distance < 0.3 * alone_distance,
        "{taught_distance} and {alone_distance}"
    );
    let record = taught.card().lesson.as_ref().unwrap();
    let hashes = members.iter().map(Surrogate::hash);
    assert!(hashes.eq(record.teachers.iter().map(|it| it.weights.clone())));
    assert_eq!(alone.card().lesson, None);
    // The lesson is not evidence: domain, scales and test errors are of the rows alone.
    assert_eq!(taught.card().domain, alone.card().domain);
    assert_eq!(taught.card().energy_scale, alone.card().energy_scale);
    assert_eq!(
        taught.card().test_errors.rows,
        alone.card().test_errors.rows
    );
}

#[test]
fn a_training_with_a_lesson_continues_only_with_that_lesson() {
    let (members, states) = ensemble();
    let database = database(rows(20));
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join("chi.state");
    let begun = |members: &[Surrogate], states: &[_], start| {
        let lesson = Lesson::new(members, states);
        let data = TrainingData {
            database: &database,
            lesson: Some(&lesson),
        };
        Training::new(data, &config(2), Backend::default(), start)
    };
    let mut training = begun(&members, &states, Start::Fresh).unwrap();
    training.epoch().unwrap();
    training.save(&state).unwrap();
    let resumed = Start::State {
        state: &state,
        parent: None,
    };
    let fewer = &states[1..];
    let straight = finished(begun(&members, &states, Start::Fresh).unwrap());
    let continued = finished(begun(&members, &states, resumed).unwrap());
    assert_eq!(
        energies(&straight.surrogate),
        energies(&continued.surrogate)
    );
    for other in [
        begun(&members[..1], &states, resumed),
        begun(&members, fewer, resumed),
    ] {
        assert!(matches!(
            other.err(),
            Some(TrainError::State(StateError::Other { what: "lesson", .. }))
        ));
    }
}
