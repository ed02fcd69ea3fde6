//! The state of a training between two epochs on disk. A resumed training continues bit-exactly.
//!
//! The file is a BLAKE3 hash followed by the hashed safetensors: the current networks, the networks
//! of the best epoch and the state of the optimiser as Burn's own records (bytes), and all other
//! data as JSON.

use crate::networks::Networks;
use burn::module::Module;
use burn::optim::ModuleOptimizer;
use burn::store::{ModuleRecord, RecordError};
use burn::tensor::Bytes;
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt::Display;
use std::path::{Path, PathBuf};
use support::{Fault, ensure, fault, unread, unwritten};
use surrogate::Card;

/// Format version of the file. A state is temporary, so no other version is read.
const FORMAT_VERSION: u32 = 3;

/// The part of a state that is not tensors.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TrainingProgress {
    format_version: u32,
    pub card: Card,
    pub history: Vec<Epoch>,
}

impl TrainingProgress {
    pub(crate) fn new(card: &Card, history: &[Epoch]) -> Self {
        Self { format_version: FORMAT_VERSION, card: card.clone(), history: history.to_vec() }
    }
}

/// A state read from disk.
pub(crate) struct TrainingState {
    pub progress: TrainingProgress,
    path: PathBuf,
    records: [Vec<u8>; 3],
}

/// The names of the records.
const RECORDS: [&str; 3] = ["networks", "best", "optimiser"];

fn unrecorded(error: RecordError) -> Fault {
    fault!("the backend cannot record the networks: {error}")
}

/// The error of a file that is no whole state, with the reason.
fn malformed(path: &Path) -> impl Fn(&dyn Display) -> Fault {
    move |reason| {
        let path = path.display();
        fault!(
            "{path} is not a state of a training, or is damaged ({reason}); delete it and start again"
        )
    }
}

/// Writes a state atomically.
pub(crate) fn write(
    path: &Path,
    progress: &TrainingProgress,
    networks: &Networks,
    best: &Networks,
    optimiser: &ModuleOptimizer,
) -> Result<(), Fault> {
    let records = [
        networks.clone().into_record().into_bytes().map_err(unrecorded)?,
        best.clone().into_record().into_bytes().map_err(unrecorded)?,
        optimiser.into_bytes().map_err(unrecorded)?,
    ];
    let malformed = malformed(path);
    let progress = serde_json::to_string(progress).map_err(|error| malformed(&error))?;
    let views: Result<Vec<_>, _> = RECORDS
        .into_iter()
        .zip(&records)
        .map(|(name, record)| Ok((name, TensorView::new(Dtype::U8, vec![record.len()], record)?)))
        .collect();
    let metadata = Some([("progress".to_owned(), progress)].into());
    let body = views
        .and_then(|views| safetensors::serialize(views, metadata))
        .map_err(|error| malformed(&error))?;
    let mut bytes = blake3::hash(&body).as_bytes().to_vec();
    bytes.extend(body);
    support::whole_file::write(path, &bytes).map_err(unwritten(path))
}

impl TrainingState {
    pub(crate) fn read(path: &Path) -> Result<Self, Fault> {
        let malformed = malformed(path);
        let bytes = support::regular_file::read(path).map_err(unread(path))?;
        let (hash, body) = bytes
            .split_first_chunk::<{ blake3::OUT_LEN }>()
            .ok_or_else(|| malformed(&"it is too short"))?;
        if blake3::hash(body) != *hash {
            return Err(malformed(&"its hash does not match"));
        }
        let tensors = SafeTensors::deserialize(body).map_err(|error| malformed(&error))?;
        let (_, metadata) = SafeTensors::read_metadata(body).map_err(|error| malformed(&error))?;
        let progress = metadata.metadata().as_ref().and_then(|map| map.get("progress"));
        let progress = progress.ok_or_else(|| malformed(&"it contains no progress"))?;
        let progress: TrainingProgress =
            serde_json::from_str(progress).map_err(|error| malformed(&error))?;
        if progress.format_version != FORMAT_VERSION {
            return Err(malformed(&format!(
                "its format version is {}, not {FORMAT_VERSION}",
                progress.format_version
            )));
        }
        let mut records = RECORDS.map(|_| Vec::new());
        for (record, name) in records.iter_mut().zip(RECORDS) {
            let view = tensors.tensor(name).map_err(|error| malformed(&error))?;
            *record = view.data().to_vec();
        }
        Ok(Self { progress, path: path.to_owned(), records })
    }

    /// An error if the state has a different configuration, database, split or distillation, or
    /// different initial weights.
    pub(crate) fn check(&self, card: &Card) -> Result<(), Fault> {
        let saved = &self.progress.card;
        for (what, same) in [
            ("configuration", saved.training == card.training),
            ("database", saved.dataset_hash == card.dataset_hash),
            ("split", saved.split_hash == card.split_hash),
            ("network to start from", saved.fine_tuned_from == card.fine_tuned_from),
            ("distillation", saved.distillation == card.distillation),
        ] {
            ensure!(
                same,
                "{} is the state of another training: the {what} is different; continue with \
                     the original one, or discard it with --replace",
                self.path.display()
            );
        }
        Ok(())
    }

    /// The current networks, the networks of the best epoch, and the optimiser. The arguments must
    /// have the same sizes.
    pub(crate) fn restore(
        self,
        networks: &Networks,
        optimiser: ModuleOptimizer,
    ) -> Result<(Networks, Networks, ModuleOptimizer), Fault> {
        let [current, best, adam] = self.records.map(Bytes::from_bytes_vec);
        let load = |record| networks.clone().try_load_record(ModuleRecord::from_bytes(record)?);
        let restored = || Ok((load(current)?, load(best)?, optimiser.from_bytes(adam)?));
        restored().map_err(unrecorded)
    }
}

// What an epoch of a training found.

/// The result of one pass over the training rows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Epoch {
    /// Number of the epoch: 1, 2, ..., `epochs`.
    pub epoch: usize,
    /// Maximum number of epochs.
    pub epochs: usize,
    /// The loss (15): mean over the batches, each with the weights before its step.
    pub training_loss: f64,
    /// The loss (15) on the validation part at the end of the epoch.
    pub validation_loss: f64,
    /// Relative errors of each network on the validation part: of W and the forces (their geometric
    /// mean), of D, and of D_peak; NaN if no validation row has a known target that is not zero.
    #[serde(deserialize_with = "numbers_or_null")]
    pub validation_errors: [f64; 3],
    /// Learning rate at the end of the epoch.
    pub learning_rate: f64,
    /// Whether one of the validation errors is smaller than in all earlier epochs.
    pub best: bool,
    /// Training time so far (s).
    pub elapsed_s: f64,
}

/// JSON has no NaN.
fn numbers_or_null<'de, D: Deserializer<'de>>(values: D) -> Result<[f64; 3], D::Error> {
    let values = <[Option<f64>; 3]>::deserialize(values)?;
    Ok(values.map(|value| value.unwrap_or(f64::NAN)))
}
