//! Trainings that start with the weights of another material.

use crate::closed_form::{config, database, finished, rays, trained};
use dataset::{Database, SolvedRay, Subset};
use hinge::HingeSample;
use surrogate::Surrogate;
use testkit::changed;
use train::{Parity, Start, Training, TrainingConfig, train};

/// The rays in a sheet of `factor` times the thickness, whose material is `stiffness` times as
/// stiff.
fn similar(rays: Vec<SolvedRay>, factor: f64, stiffness: f64) -> Vec<SolvedRay> {
    let (areas, volumes) = (factor.powi(2) * stiffness, factor.powi(3) * stiffness);
    let scaled = |x: HingeSample| HingeSample {
        a: factor * x.a,
        s: factor * x.s,
        w: volumes * x.w,
        f_a: areas * x.f_a,
        f_s: areas * x.f_s,
        m_theta: volumes * x.m_theta,
        ..x
    };
    changed(rays, |ray| {
        ray.design = ray.design.scaled(factor);
        ray.samples.iter_mut().for_each(|sample| *sample = scaled(*sample));
    })
}

/// The training of `epochs` epochs on the rays of a sheet of another thickness and stiffness, which
/// starts from `pretrained`.
fn tuned(pretrained: &Surrogate, epochs: usize) -> (Database, Training) {
    let database = database(similar(rays(30), 0.4, 3.0));
    let config = TrainingConfig { learning_rate: 1e-3, ..config(epochs) };
    let start = Start::Weights(pretrained);
    let training = Training::new(&database, &config, start).unwrap();
    (database, training)
}

#[test]
fn fine_tuning_starts_with_the_function_of_the_given_weights() {
    let pretrained = trained(40).surrogate;
    let (database, training) = tuned(&pretrained, 1);
    let start = training.finish().unwrap().surrogate;
    let scaled = pretrained.clone().scaled(0.4);
    assert_ne!(start.card().standardisation, scaled.card().standardisation);
    let hash = start.card().fine_tuned_from.clone();
    assert_eq!(hash, Some(pretrained.hash()));

    let predicted = |surrogate: &Surrogate| {
        let parity = Parity::new(surrogate, &database.part(Subset::Training));
        [0, 1, 2, 3, 4, 5].map(|quantity| parity.points(quantity).collect::<Vec<_>>())
    };
    let (expected, found) = (predicted(&scaled), predicted(&start));
    let factor = |points: &[[f64; 2]]| {
        let products = points.iter().map(|[target, predicted]| target * predicted);
        let squares = points.iter().map(|[_, predicted]| predicted.powi(2));
        products.sum::<f64>() / squares.sum::<f64>()
    };
    let [energy, d, d_peak] = [0, 4, 5].map(|k| factor(&expected[k]));
    assert!((energy / 3.0 - 1.0).abs() < 0.1, "{energy}");
    let factors = [energy, energy, energy, energy, d, d_peak];
    for ((expected, found), factor) in expected.iter().zip(&found).zip(factors) {
        let size = expected.iter().map(|[_, predicted]| predicted.abs()).fold(0.0, f64::max);
        for (expected, found) in expected.iter().zip(found) {
            let difference = (factor * expected[1] - found[1]).abs();
            assert!(difference < 1e-5 * factor * size, "{difference}");
        }
    }
}

#[test]
fn a_fine_tuned_network_is_closer_than_one_from_scratch() {
    let pretrained = trained(40).surrogate;
    let (database, training) = tuned(&pretrained, 10);
    let scratch = train(&database, &config(10), &mut |_| {}).unwrap();
    let tuned = finished(training);
    for k in 0..4 {
        let [tuned, scratch] = [&tuned, &scratch].map(|it| it.test_errors.percents()[k]);
        assert!(tuned < 0.5 * scratch, "{k}: {tuned} and {scratch}");
    }
}

#[test]
fn weights_of_the_same_law_keep_their_domain_and_sizes() {
    let of_law = |rays, law: &str| database(changed(rays, |ray| ray.material_hash = law.into()));
    let whole = of_law(rays(40), "film");
    let pretrained = train(&whole, &config(1), &mut |_| {}).unwrap().surrogate;
    let mut few = whole.part(Subset::Training);
    few.truncate(8);
    let start = |data: &Database| {
        let other = TrainingConfig { embedding: vec![4], ..config(1) };
        let config = other.with_sizes_of(&pretrained);
        let training = Training::new(data, &config, Start::Weights(&pretrained));
        training.unwrap().finish().unwrap().surrogate
    };
    let domain = |surrogate: &Surrogate| surrogate.card().domain.clone();
    assert_eq!(domain(&start(&of_law(few.clone(), "film"))), domain(&pretrained));
    let other = domain(&start(&of_law(few.clone(), "steel")));
    assert_ne!(other, domain(&pretrained));
    // Rays beyond the domain enlarge it.
    assert_ne!(domain(&start(&of_law(rays(120), "film"))), domain(&pretrained));
    // The same law in another thickness: the ligaments scale with it.
    let thin = domain(&start(&of_law(similar(few, 0.4, 1.0), "film")));
    assert_eq!(thin, domain(&pretrained.clone().scaled(0.4)));
    assert_ne!(thin, domain(&pretrained));
}

#[test]
fn frozen_layers_are_not_trained() {
    let pretrained = trained(2).surrogate;
    let database = database(rays(20));
    let config = TrainingConfig { frozen_layers: 1, ..config(2) };
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join("chi.state");
    let begun = |start| Training::new(&database, &config, start).unwrap();
    let start = Start::Weights(&pretrained);
    let initial = begun(start).finish().unwrap().last.layers();
    let mut training = begun(start);
    training.epoch().unwrap();
    training.save(&state).unwrap();
    // Also of a training that is resumed.
    let resumed = |pretrained| Start::State { state: &state, pretrained };
    let last = finished(begun(resumed(Some(&pretrained)))).last.layers();
    let without = Training::new(&database, &config, resumed(None)).err().unwrap().to_string();
    assert!(without.contains("start from is different"), "{without}");
    for (initial, last) in [
        (&initial.chi, &last.chi),
        (&initial.chi_d, &last.chi_d),
        (initial.chi_p.as_ref().unwrap(), last.chi_p.as_ref().unwrap()),
    ] {
        assert_eq!(initial[0], last[0]);
        assert_ne!(initial[1], last[1]);
    }
}

#[test]
fn unsuitable_initial_weights_are_errors() {
    let base = trained(1).surrogate;
    let database = database(rays(20));
    let refusal = |pretrained: &Surrogate, config: &TrainingConfig| {
        let start = Start::Weights(pretrained);
        let training = Training::new(&database, config, start);
        training.err().unwrap().to_string()
    };
    let wider = TrainingConfig { embedding: vec![32, 32, 32], ..config(1) };
    let error = refusal(&base, &wider);
    assert!(error.contains("have the layers [[32, 32, 16]"), "{error}");
    let mut card = base.card().clone();
    card.damage_sharpness = 9.0;
    let sharper = Surrogate::from_parts(base.layers(), card).unwrap();
    let error = refusal(&sharper, &config(1));
    assert!(error.contains("`damage_sharpness = 9`"), "{error}");
    let mut layers = base.layers();
    layers.chi[0].bias.values[0] += 0.1;
    let plain = Surrogate::from_parts(layers, base.card().clone()).unwrap();
    let error = refusal(&plain, &config(1));
    assert!(error.contains("do not have the mirror symmetry"), "{error}");
}
