//! The weight file `X.safetensors` and its card `X.json`.
//!
//! | tensor | shape |
//! |---|---|
//! | `chi.N.weight`, `chi.N.bias` | (out, in), (out) of layer N of the embedding |
//! | `chi_d.N.weight`, `chi_d.N.bias` | the same for the damage head |
//! | `chi_p.N.weight`, `chi_p.N.bias` | the same for the head of D_peak, if there is one |
//! | `feat_mean`, `feat_std` | (5) or (6), in the order of the features |
//! | `w_scale` | (1), N mm |
//! | `d_scale` | (1) or (2), dimensionless: of D, and of D_peak if there is a head for it |
//!
//! Tensors are written in float64; float32 is also read. Both files contain the scaling, so
//! that a card that does not belong to the weights is detected.

use crate::card::{Card, FORMAT_VERSION};
use crate::features::Standardisation;
use crate::model::{Layers, Surrogate};
use crate::network::{InvalidWeights, Layer, Tensor};
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensorError, SafeTensors};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use support::file_error::FileError;
use support::regular_file;
use support::sealed_json::{self, SealError};

/// Why a surrogate could not be read or written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum WeightsError {
    #[error("cannot read {0}")]
    Read(#[source] FileError),
    #[error("cannot write {0}")]
    Write(#[source] FileError),
    #[error(
        "{weights} has no card: {card} is missing; copy both files from the same place",
        weights = .weights.display(), card = .card.display()
    )]
    MissingCard { weights: PathBuf, card: PathBuf },
    #[error("{path} is not a card of a surrogate: {source}", path = .path.display())]
    Card { path: PathBuf, source: SealError },
    #[error(
        "{path} has the format version {found}, but this program reads version {FORMAT_VERSION} alone: train the weights \
         again, or use the program that wrote them",
        path = .path.display()
    )]
    UnknownVersion { path: PathBuf, found: u64 },
    #[error(
        "{path} is a database (Parquet), but weights (.safetensors) are expected; `kirigami train` makes weights from a \
         database",
        path = .path.display()
    )]
    Database { path: PathBuf },
    #[error("{path} is not a safetensors file: {source}", path = .path.display())]
    Malformed { path: PathBuf, source: SafeTensorError },
    #[error("{path}: tensor `{tensor}` is not part of a known network", path = .path.display())]
    Extra { path: PathBuf, tensor: String },
    #[error("{path}: tensor `{tensor}` is {found:?}, expected F64 or F32", path = .path.display())]
    Type { path: PathBuf, tensor: String, found: Dtype },
    #[error(
        "{path}: `{tensor}` differs from the value in the card; the two files are from different \
         trainings, so copy both from the same place",
        path = .path.display()
    )]
    OtherCard { path: PathBuf, tensor: &'static str },
    #[error(
        "{path} is not the file that its card describes (BLAKE3 {found}, not {expected}): it is damaged, or the card is \
         of another training; copy the two files together",
        path = .path.display()
    )]
    Hash { path: PathBuf, expected: String, found: String },
    #[error("{path}: {source}", path = .path.display())]
    Invalid { path: PathBuf, source: InvalidWeights },
}

impl Surrogate {
    /// Reads `X.safetensors` and its card `X.json`.
    pub fn load(weights: &Path) -> Result<Self, WeightsError> {
        load(weights)
    }

    /// Writes `X.safetensors` and its card `X.json`, each atomically.
    pub fn save(&self, weights: &Path) -> Result<(), WeightsError> {
        save(self, weights)
    }
}

fn load(weights: &Path) -> Result<Surrogate, WeightsError> {
    refuse_database(weights)?;
    let bytes =
        regular_file::read(weights).map_err(FileError::at(weights)).map_err(WeightsError::Read)?;
    let mut tensors = read_tensors(weights, &bytes)?;
    let mut card = Card::of(weights)?;
    let expected = card.weights_hash.take().unwrap_or_default();
    let found = blake3::hash(&bytes).to_hex().to_string();
    if found != expected {
        return Err(WeightsError::Hash { path: weights.to_owned(), expected, found });
    }
    let invalid = |source| WeightsError::Invalid { path: weights.to_owned(), source };
    let chi = take_layers(&mut tensors, "chi").map_err(invalid)?;
    let chi_d = take_layers(&mut tensors, "chi_d").map_err(invalid)?;
    let chi_p = card.peak_scale.map(|_| take_layers(&mut tensors, "chi_p"));
    let chi_p = chi_p.transpose().map_err(invalid)?;
    for (tensor, expected) in scaling(&card) {
        let found = take(&mut tensors, tensor).map_err(invalid)?;
        if found.shape != expected.shape {
            return Err(invalid(InvalidWeights::Shape {
                tensor: tensor.into(),
                expected: format!("{:?}", expected.shape),
                found: found.shape,
            }));
        }
        if found.values != expected.values {
            return Err(WeightsError::OtherCard { path: weights.to_owned(), tensor });
        }
    }
    if let Some((tensor, _)) = tensors.pop_first() {
        return Err(WeightsError::Extra { path: weights.to_owned(), tensor });
    }
    Surrogate::from_parts(Layers { chi, chi_d, chi_p }, card).map_err(invalid)
}

impl Card {
    /// Reads the card of `X.safetensors`, `X.json`, without the weights.
    pub fn of(weights: &Path) -> Result<Self, WeightsError> {
        #[derive(serde::Deserialize)]
        struct Version {
            format_version: u64,
        }
        refuse_database(weights)?;
        let path = card_path(weights);
        let text = regular_file::read(&path).map_err(|source| match source.kind() {
            io::ErrorKind::NotFound => {
                WeightsError::MissingCard { weights: weights.to_owned(), card: path.clone() }
            }
            _ => WeightsError::Read(FileError::at(&path)(source)),
        })?;
        let malformed = |source| WeightsError::Card { path: path.clone(), source };
        let version: Version =
            serde_json::from_slice(&text).map_err(SealError::from).map_err(malformed)?;
        if version.format_version != u64::from(FORMAT_VERSION) {
            return Err(WeightsError::UnknownVersion {
                path: path.clone(),
                found: version.format_version,
            });
        }
        sealed_json::from_slice(&text).map_err(malformed)
    }
}

fn refuse_database(weights: &Path) -> Result<(), WeightsError> {
    if weights.extension().is_some_and(|kind| kind == "parquet") {
        let path = weights.to_owned();
        return Err(WeightsError::Database { path });
    }
    Ok(())
}

fn save(surrogate: &Surrogate, weights: &Path) -> Result<(), WeightsError> {
    let mut tensors: Vec<(String, Tensor)> = Vec::new();
    let Layers { chi, chi_d, chi_p } = surrogate.layers();
    let networks = [("chi", chi), ("chi_d", chi_d)];
    for (name, layers) in networks.into_iter().chain(chi_p.map(|layers| ("chi_p", layers))) {
        for (index, Layer { weight, bias }) in layers.into_iter().enumerate() {
            tensors.push((format!("{name}.{index}.weight"), weight));
            tensors.push((format!("{name}.{index}.bias"), bias));
        }
    }
    for (name, tensor) in scaling(surrogate.card()) {
        tensors.push((name.into(), tensor));
    }
    let bytes: Vec<Vec<u8>> = tensors.iter().map(|(_, tensor)| to_bytes(tensor)).collect();
    let views: Result<Vec<_>, _> = tensors
        .iter()
        .zip(&bytes)
        .map(|((name, tensor), bytes)| {
            Ok((name, TensorView::new(Dtype::F64, tensor.shape.clone(), bytes)?))
        })
        .collect();
    let file = views
        .and_then(|views| safetensors::serialize(views, None))
        .map_err(|source| WeightsError::Malformed { path: weights.to_owned(), source })?;
    let path = card_path(weights);
    let stamped = Card {
        weights_hash: Some(blake3::hash(&file).to_hex().to_string()),
        ..surrogate.card().clone()
    };
    let mut card = sealed_json::to_vec(&stamped)
        .map_err(|source| WeightsError::Card { path: path.clone(), source: source.into() })?;
    card.push(b'\n');
    write(weights, &file)?;
    write(&path, &card)
}

fn card_path(weights: &Path) -> PathBuf {
    weights.with_extension("json")
}

fn read_tensors(path: &Path, bytes: &[u8]) -> Result<BTreeMap<String, Tensor>, WeightsError> {
    let file = SafeTensors::deserialize(bytes)
        .map_err(|source| WeightsError::Malformed { path: path.to_owned(), source })?;
    file.iter()
        .map(|(name, view)| match to_tensor(&view) {
            Some(tensor) => Ok((name.to_owned(), tensor)),
            None => Err(WeightsError::Type {
                path: path.to_owned(),
                tensor: name.to_owned(),
                found: view.dtype(),
            }),
        })
        .collect()
}

/// The values in float64; `None` if the type is neither F64 nor F32.
fn to_tensor(view: &TensorView) -> Option<Tensor> {
    let values = match view.dtype() {
        Dtype::F64 => {
            let (numbers, _) = view.data().as_chunks();
            numbers.iter().map(|&bytes| f64::from_le_bytes(bytes)).collect()
        }
        Dtype::F32 => {
            let (numbers, _) = view.data().as_chunks();
            let widen = |&bytes| f64::from(f32::from_le_bytes(bytes));
            numbers.iter().map(widen).collect()
        }
        _ => return None,
    };
    Some(Tensor { shape: view.shape().to_vec(), values })
}

fn to_bytes(tensor: &Tensor) -> Vec<u8> {
    let values = tensor.values.iter();
    values.flat_map(|value| value.to_le_bytes()).collect()
}

/// The tensors whose values the card also contains.
fn scaling(card: &Card) -> [(&'static str, Tensor); 4] {
    let Standardisation { mean, std } = &card.standardisation;
    let vector = |values: &[f64]| Tensor { shape: vec![values.len()], values: values.to_vec() };
    [
        ("feat_mean", vector(mean)),
        ("feat_std", vector(std)),
        ("w_scale", vector(&[card.energy_scale])),
        ("d_scale", vector(&card.damage_scales())),
    ]
}

/// Layers 0, 1, ... of a network, up to the highest number in the file.
fn take_layers(
    tensors: &mut BTreeMap<String, Tensor>,
    network: &str,
) -> Result<Vec<Layer>, InvalidWeights> {
    let layer_of = |name: &String| -> Option<usize> {
        let (layer, _) = name.strip_prefix(network)?.strip_prefix('.')?.split_once('.')?;
        layer.parse().ok()
    };
    let last = tensors.keys().filter_map(layer_of).max().unwrap_or(0);
    (0..=last)
        .map(|layer| {
            Ok(Layer {
                weight: take(tensors, &format!("{network}.{layer}.weight"))?,
                bias: take(tensors, &format!("{network}.{layer}.bias"))?,
            })
        })
        .collect()
}

fn take(tensors: &mut BTreeMap<String, Tensor>, name: &str) -> Result<Tensor, InvalidWeights> {
    tensors.remove(name).ok_or_else(|| InvalidWeights::Missing { tensor: name.into() })
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), WeightsError> {
    support::whole_file::write(path, bytes)
        .map_err(FileError::at(path))
        .map_err(WeightsError::Write)
}
