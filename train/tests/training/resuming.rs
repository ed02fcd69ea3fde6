//! A training that is stopped and continued.

use crate::closed_form::{config, database, energies, finished, rays};
use std::path::Path;
use support::Fault;
use train::{Start, Trained, Training, TrainingConfig};

/// A training of `epochs` epochs after `run` of them.
fn begun(epochs: usize, run: usize) -> Training {
    let database = database(rays(20));
    let mut training = Training::new(&database, &config(epochs), Start::Fresh).unwrap();
    for _ in 0..run {
        training.epoch().unwrap();
    }
    training
}

fn resumed(state: &Path, config: &TrainingConfig) -> Result<Training, Fault> {
    let database = database(rays(20));
    let start = Start::State { state, pretrained: None };
    Training::new(&database, config, start)
}

#[test]
fn a_resumed_training_is_bit_exact() {
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join("chi.state");
    let straight = finished(begun(5, 0));
    begun(5, 2).save(&state).unwrap();
    let database = database(rays(20));
    let start = Start::State { state: &state, pretrained: None };
    let training = Training::new(&database, &config(5), start).unwrap();
    assert_eq!(training.history().len(), 2);
    let resumed = finished(training);
    assert_eq!(energies(&straight.surrogate), energies(&resumed.surrogate));
    assert_eq!(energies(&straight.last), energies(&resumed.last));
    let losses = |trained: &Trained| -> Vec<_> {
        let epochs = trained.history.iter();
        epochs.map(|it| (it.training_loss, it.validation_loss, it.best)).collect()
    };
    assert_eq!(losses(&straight), losses(&resumed));
}

#[test]
fn a_damaged_or_foreign_state_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join("chi.state");
    begun(3, 1).save(&state).unwrap();
    let other = TrainingConfig { batch_size: 32, ..config(3) };
    let error = resumed(&state, &other).err().unwrap();
    assert!(error.to_string().contains("configuration"), "{error}");

    let bytes = std::fs::read(&state).unwrap();
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 1;
    let cases = [&bytes[..0], &bytes[..31], &bytes[..32], &bytes[..bytes.len() - 1], &flipped];
    for damaged in cases {
        std::fs::write(&state, damaged).unwrap();
        let error = resumed(&state, &config(3)).err().unwrap().to_string();
        let malformed = error.contains("is not a state of a training, or is damaged");
        assert!(malformed, "{} bytes: {error}", damaged.len());
    }
    std::fs::remove_file(&state).unwrap();
    let error = resumed(&state, &config(3)).err().unwrap().to_string();
    assert!(error.starts_with("cannot read "), "{error}");
}
