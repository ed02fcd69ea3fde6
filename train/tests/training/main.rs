//! Training on an energy that is known in closed form.

mod closed_form;
mod ensembles;
mod fine_tuning;
mod resuming;

use crate::closed_form::{config, database, energies, rays, sample, states, trained};
use dataset::{SolvedRay, Subset};
use hinge::{HingeDeformation, HingeDesign, HingeSample};
use std::f64::consts::FRAC_PI_2;
use surrogate::{Order, Surrogate};
use testkit::changed;
use train::{Epoch, Parity, Start, Training, TrainingConfig, train};

#[test]
fn an_energy_in_closed_form_is_learned() {
    let mut reported: Vec<Epoch> = Vec::new();
    let database = database(rays(200));
    let trained = train(&database, &config(100), &mut |epoch| {
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
    assert!(card.domain.alpha[1] > 2.0, "mirror images belong to the domain");
    assert_eq!(trained.parity.states.len(), errors.rows);
}

/// The validation rays have no damage, and their D_peak is not known.
#[test]
fn a_damage_head_without_a_known_error_is_that_of_the_last_epoch() {
    let whole = database(rays(30));
    let validation = &whole.manifest().split.validation;
    let undamaged = |ray: &mut SolvedRay| {
        if validation.contains(&ray.job) {
            let none = |x: HingeSample| HingeSample { d: 0.0, d_peak: None, ..x };
            ray.samples.iter_mut().for_each(|sample| *sample = none(*sample));
        }
    };
    let database = database(changed(whole.rays().to_vec(), undamaged));
    let config = config(3);
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join("state");
    let mut training = Training::new(&database, &config, Start::Fresh).unwrap();
    training.epoch().unwrap();
    training.save(&state).unwrap();
    let start = Start::State { state: &state, pretrained: None };
    let mut training = Training::new(&database, &config, start).unwrap();
    while !training.is_finished() {
        training.epoch().unwrap();
    }
    let trained = training.finish().unwrap();
    for epoch in &trained.history {
        let [energy, d, d_peak] = epoch.validation_errors;
        assert!(energy > 0.0 && d.is_nan() && d_peak.is_nan(), "{epoch:?}");
    }
    let test = database.part(Subset::Test);
    let predicted = |surrogate: &Surrogate| {
        let parity = Parity::new(surrogate, &test);
        [4, 5].map(|quantity| parity.points(quantity).collect::<Vec<_>>())
    };
    assert_eq!(predicted(&trained.surrogate), predicted(&trained.last));
    assert!(trained.test_errors.damage_peak.relative_rmse > 0.0);
}

#[test]
fn mirror_images_give_the_same_energy_and_damage() {
    let surrogate = trained(2).surrogate;
    let (designs, states) = states();
    let images: Vec<_> = designs.iter().map(HingeDesign::mirrored).collect();
    let mirrored: Vec<_> = states.iter().map(HingeDeformation::mirrored).collect();
    let close = |left: f64, right: f64| (left - right).abs() <= 1e-12 * left.abs().max(1.0);

    let evaluate = |designs: &[HingeDesign], states: &[HingeDeformation]| {
        surrogate.evaluate(&surrogate.prepare(designs), states, Order::Forces)
    };
    for (hinge, image) in evaluate(&designs, &states).iter().zip(evaluate(&images, &mirrored)) {
        assert!(hinge.w > 0.0 && close(hinge.w, image.w));
        let [f_a, f_s, m_theta] = image.forces;
        for (force, image) in hinge.forces.into_iter().zip([f_a, -f_s, m_theta]) {
            assert!(close(force, image), "{force} and {image}");
        }
    }
    let damages = surrogate.damage(&designs, &states, true);
    for (hinge, image) in damages.iter().zip(surrogate.damage(&images, &mirrored, true)) {
        assert!(close(hinge.d, image.d));
    }
}

#[test]
fn equal_seeds_give_equal_weights_and_different_seeds_different_ones() {
    let first = energies(&trained(2).surrogate);
    assert_eq!(first, energies(&trained(2).surrogate));
    let other = TrainingConfig { seed: 5, ..config(2) };
    let other = train(&database(rays(60)), &other, &mut |_| {}).unwrap();
    assert_ne!(first, energies(&other.surrogate));
}

#[test]
fn a_trained_surrogate_round_trips_through_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chi.safetensors");
    let trained = trained(1);
    trained.surrogate.save(&path).unwrap();
    let loaded = Surrogate::load(&path).unwrap();
    assert_eq!(loaded.card(), trained.surrogate.card());
    assert_eq!(energies(&loaded), energies(&trained.surrogate));
}

#[test]
fn constant_features_and_zero_targets_are_errors() {
    let refusal = |change: fn(&mut SolvedRay)| {
        let rays = changed(rays(12), change);
        train(&database(rays), &config(1), &mut |_| {}).unwrap_err().to_string()
    };
    let error = refusal(|ray| ray.design.alpha = FRAC_PI_2);
    assert!(error.starts_with("the feature `alpha` is "), "{error}");
    let error = refusal(|ray| ray.samples.iter_mut().for_each(|x| x.theta = 0.7));
    assert!(error.starts_with("the feature `theta` is "), "{error}");
    let error = refusal(|ray| ray.samples.iter_mut().for_each(|x| x.d = 0.0));
    assert!(error.starts_with("the root mean square of D "), "{error}");
}

#[test]
fn a_loss_that_overflows_float32_is_an_error() {
    let rays = changed(rays(12), |ray| ray.samples.iter_mut().for_each(|x| x.f_a *= 1e-60));
    let error = train(&database(rays), &config(2), &mut |_| {}).unwrap_err().to_string();
    assert!(error.contains("not finite in epoch 1;"), "{error}");
}

#[test]
fn a_database_without_compression_and_without_d_peak_can_be_trained_on() {
    let tension = changed(rays(20), |ray| {
        for x in &mut ray.samples {
            let end = HingeDeformation { a: x.a.abs(), ..x.deformation() };
            *x = HingeSample { d_peak: None, ..sample(&ray.design, end, x.lambda) };
        }
    });
    let trained = train(&database(tension), &config(2), &mut |_| {}).unwrap();
    let card = trained.surrogate.card();
    assert!(card.domain.bounds()[0][0] >= -0.1);
    assert_eq!(card.peak_scale, None);
    let mut peaks = trained.parity.points(5);
    assert!(peaks.all(|[_, predicted]| predicted.is_nan()));
    assert!(trained.test_errors.energy.relative_rmse.is_finite());
}
