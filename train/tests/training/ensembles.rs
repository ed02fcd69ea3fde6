//! Several networks of one database, and a network that learns their median.

use crate::closed_form::{config, database, energies, finished, rays};
use dataset::samples;
use hinge::{HingeDeformation, HingeDesign, HingeSample};
use surrogate::Surrogate;
use train::{Distillation, Parity, Start, Training, TrainingConfig, TrainingData, train};

#[test]
fn an_outlier_is_an_error_that_names_job_and_target() {
    type Change = fn(&mut HingeSample);
    let changes: [(Change, &str); 3] = [
        (|sample| sample.f_s = -1e6, "F_s"),
        (|sample| sample.w = 1e6, "W"),
        (|sample| sample.d_peak = Some(1e6), "D_peak"),
    ];
    for (change, name) in changes {
        let mut rays = rays(20);
        // Every second ray has an outlier, so that the training part contains some.
        rays.iter_mut().step_by(2).for_each(|ray| change(&mut ray.samples[0]));
        let error = train(&database(rays), &config(1), &mut |_| {}).unwrap_err().to_string();
        assert!(
            error.starts_with("job job-") && error.contains(&format!(": {name} = ")),
            "{error}"
        );
    }
}

/// Two networks of one database, and the states on rays that they were not trained on.
fn ensemble() -> ([Surrogate; 2], Vec<(HingeDesign, HingeDeformation)>) {
    let members = [1, 2].map(|seed| {
        let config = TrainingConfig { seed, ..config(20) };
        let trained = train(&database(rays(20)), &config, &mut |_| {});
        trained.unwrap().surrogate
    });
    let others = rays(120).split_off(20);
    let states = samples(&others).map(|(ray, sample)| (ray.design, sample.deformation()));
    (members, states.collect())
}

#[test]
fn a_network_learns_the_median_of_several() {
    let (members, states) = ensemble();
    let database = database(rays(20));
    let distillation = Distillation::new(&members, &states);
    let student = |distillation: Option<&Distillation>| {
        let data = TrainingData { database: &database, distillation };
        let start = Start::Weights(&members[0]);
        finished(Training::new(data, &config(40), start).unwrap()).surrogate
    };
    let [distilled, alone] = [Some(&distillation), None].map(student);
    // On rays of neither.
    let unseen = rays(220).split_off(120);
    let predicted = |network: &Surrogate| -> Vec<f64> {
        let parity = Parity::new(network, &unseen);
        parity.points(0).map(|[_, predicted]| predicted).collect()
    };
    // The median of two is their mean.
    let [one, other] = [0, 1].map(|member| predicted(&members[member]));
    assert_eq!(members.len(), 2);
    let mean = std::iter::zip(one, other).map(|(one, other)| 0.5 * (one + other));
    let mean: Vec<f64> = mean.collect();
    let distance = |network: &Surrogate| {
        let squares = std::iter::zip(&mean, predicted(network));
        let squares = squares.map(|(mean, found)| (mean - found).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let [distilled_distance, alone_distance] = [&distilled, &alone].map(distance);
    assert!(distilled_distance < 0.3 * alone_distance, "{distilled_distance} and {alone_distance}");
    let record = distilled.card().distillation.as_ref().unwrap();
    let hashes = members.iter().map(Surrogate::hash);
    assert!(hashes.eq(record.teachers.iter().map(|teacher| teacher.weights.clone())));
    assert_eq!(alone.card().distillation, None);
    // The median is not evidence: domain, scales and test errors are of the rays alone.
    assert_eq!(distilled.card().domain, alone.card().domain);
    assert_eq!(distilled.card().energy_scale, alone.card().energy_scale);
    assert_eq!(distilled.card().test_errors.rows, alone.card().test_errors.rows);
}

#[test]
fn a_training_with_a_distillation_continues_only_with_it() {
    let (members, states) = ensemble();
    let database = database(rays(20));
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join("chi.state");
    let begun = |members: &[Surrogate], states: &[_], start| {
        let distillation = Distillation::new(members, states);
        let data = TrainingData { database: &database, distillation: Some(&distillation) };
        Training::new(data, &config(2), start)
    };
    let mut training = begun(&members, &states, Start::Fresh).unwrap();
    training.epoch().unwrap();
    training.save(&state).unwrap();
    let resumed = Start::State { state: &state, pretrained: None };
    let fewer = &states[1..];
    let straight = finished(begun(&members, &states, Start::Fresh).unwrap());
    let continued = finished(begun(&members, &states, resumed).unwrap());
    assert_eq!(energies(&straight.surrogate), energies(&continued.surrogate));
    for other in [begun(&members[..1], &states, resumed), begun(&members, fewer, resumed)] {
        let error = other.err().unwrap().to_string();
        assert!(error.contains("the distillation is different"), "{error}");
    }
}
