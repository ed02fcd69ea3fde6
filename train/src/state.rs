//! The state of a training between two epochs on disk. A resumed training continues bit-exactly.
//!
//! The file is a BLAKE3 hash followed by the hashed safetensors: the current networks, the networks
//! of the best epoch and the state of the optimiser as Burn's own records (bytes), and all other
//! data as JSON.

use crate::epoch::Epoch;
use crate::networks::Networks;
use burn::module::Module;
use burn::optim::ModuleOptimizer;
use burn::store::{ModuleRecord, RecordError};
use burn::tensor::Bytes;
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use support::file_error::FileError;
use surrogate::Card;

/// Format version of the file. A state is temporary, so no other version is read.
const FORMAT_VERSION: u32 = 3;

/// Why a training cannot be resumed or saved.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum StateError {
    #[error("cannot read {0}")]
    Read(#[source] FileError),
    #[error("cannot write {0}")]
    Write(#[source] FileError),
    #[error(
        "{path} is not a state of a training, or is damaged ({reason}); delete it and start again",
        path = .path.display()
    )]
    Malformed { path: PathBuf, reason: String },
    #[error(
        "{path} is the state of another training: the {what} is different; continue with the \
         original one, or discard it with --replace",
        path = .path.display()
    )]
    Other { path: PathBuf, what: &'static str },
    #[error("the backend cannot record the networks: {0}")]
    Record(#[from] RecordError),
}

/// The part of a state that is not tensors.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Progress {
    format_version: u32,
    pub card: Card,
    pub history: Vec<Epoch>,
}

impl Progress {
    pub fn new(card: &Card, history: &[Epoch]) -> Self {
        Self { format_version: FORMAT_VERSION, card: card.clone(), history: history.to_vec() }
    }
}

/// A state read from disk.
pub(crate) struct State {
    pub progress: Progress,
    path: PathBuf,
    records: [Vec<u8>; 3],
}

/// The names of the records.
const RECORDS: [&str; 3] = ["networks", "best", "optimiser"];

/// Writes a state atomically.
pub(crate) fn write(
    path: &Path,
    progress: &Progress,
    networks: &Networks,
    best: &Networks,
    optimiser: &ModuleOptimizer,
) -> Result<(), StateError> {
    let records = [
        networks.clone().into_record().into_bytes()?,
        best.clone().into_record().into_bytes()?,
        optimiser.into_bytes()?,
    ];
    let malformed = |reason: String| StateError::Malformed { path: path.to_owned(), reason };
    let progress = serde_json::to_string(progress).map_err(|error| malformed(error.to_string()))?;
    let views: Result<Vec<_>, _> = RECORDS
        .into_iter()
        .zip(&records)
        .map(|(name, record)| Ok((name, TensorView::new(Dtype::U8, vec![record.len()], record)?)))
        .collect();
    let metadata = Some([("progress".to_owned(), progress)].into());
    let body = views
        .and_then(|views| safetensors::serialize(views, metadata))
        .map_err(|error| malformed(error.to_string()))?;
    let mut bytes = blake3::hash(&body).as_bytes().to_vec();
    bytes.extend(body);
    support::whole_file::write(path, &bytes).map_err(FileError::at(path)).map_err(StateError::Write)
}

impl State {
    pub fn read(path: &Path) -> Result<Self, StateError> {
        let malformed = |reason: String| StateError::Malformed { path: path.to_owned(), reason };
        let bytes = support::regular_file::read(path)
            .map_err(FileError::at(path))
            .map_err(StateError::Read)?;
        let (hash, body) = bytes
            .split_first_chunk::<{ blake3::OUT_LEN }>()
            .ok_or_else(|| malformed("it is too short".into()))?;
        if blake3::hash(body) != *hash {
            return Err(malformed("its hash does not match".into()));
        }
        let tensors =
            SafeTensors::deserialize(body).map_err(|error| malformed(error.to_string()))?;
        let (_, metadata) =
            SafeTensors::read_metadata(body).map_err(|error| malformed(error.to_string()))?;
        let progress = metadata.metadata().as_ref().and_then(|map| map.get("progress"));
        let progress = progress.ok_or_else(|| malformed("it contains no progress".into()))?;
        let progress: Progress =
            serde_json::from_str(progress).map_err(|error| malformed(error.to_string()))?;
        if progress.format_version != FORMAT_VERSION {
            return Err(malformed(format!(
                "its format version is {}, not {FORMAT_VERSION}",
                progress.format_version
            )));
        }
        let mut records = RECORDS.map(|_| Vec::new());
        for (record, name) in records.iter_mut().zip(RECORDS) {
            let view = tensors.tensor(name).map_err(|error| malformed(error.to_string()))?;
            *record = view.data().to_vec();
        }
        Ok(Self { progress, path: path.to_owned(), records })
    }

    /// An error if the state has a different configuration, database, split or distillation, or
    /// different initial weights.
    pub fn check(&self, card: &Card) -> Result<(), StateError> {
        let saved = &self.progress.card;
        for (what, same) in [
            ("configuration", saved.training == card.training),
            ("database", saved.dataset_hash == card.dataset_hash),
            ("split", saved.split_hash == card.split_hash),
            ("network to start from", saved.fine_tuned_from == card.fine_tuned_from),
            ("distillation", saved.distillation == card.distillation),
        ] {
            if !same {
                let path = self.path.clone();
                return Err(StateError::Other { path, what });
            }
        }
        Ok(())
    }

    /// The current networks, the networks of the best epoch, and the optimiser. The arguments must
    /// have the same sizes.
    pub fn restore(
        self,
        networks: &Networks,
        optimiser: ModuleOptimizer,
    ) -> Result<(Networks, Networks, ModuleOptimizer), StateError> {
        let [current, best, adam] = self.records.map(Bytes::from_bytes_vec);
        let load = |record| networks.clone().try_load_record(ModuleRecord::from_bytes(record)?);
        Ok((load(current)?, load(best)?, optimiser.from_bytes(adam)?))
    }
}
