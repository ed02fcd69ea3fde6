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
use crate::network::{DenseLayer, Tensor, missing, other_shape};
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};
use support::{
    Fault, ensure, fault, refuse, regular_file, sealed_json, unread, unwritten, whole_file,
};

impl Surrogate {
    /// Reads `X.safetensors` and its card `X.json`.
    pub fn load(weights: &Path) -> Result<Self, Fault> {
        refuse_database(weights)?;
        let bytes = regular_file::read(weights).map_err(unread(weights))?;
        let mut tensors = read_tensors(weights, &bytes)?;
        let mut card = Card::of(weights)?;
        let expected = card.weights_hash.take().unwrap_or_default();
        let found = blake3::hash(&bytes).to_hex().to_string();
        ensure!(
            found == expected,
            "{} is not the file that its card describes (BLAKE3 {found}, not {expected}): it is damaged, or the card is of another \
     training; copy the two files together",
            weights.display()
        );
        from_tensors(&mut tensors, card).map_err(|fault| fault!("{}: {fault}", weights.display()))
    }

    /// Writes `X.safetensors` and its card `X.json`, each atomically.
    pub fn save(&self, weights: &Path) -> Result<(), Fault> {
        let mut tensors: Vec<(String, Tensor)> = Vec::new();
        let Layers { chi, chi_d, chi_p } = self.layers();
        let networks = [("chi", chi), ("chi_d", chi_d)];
        for (name, layers) in networks.into_iter().chain(chi_p.map(|layers| ("chi_p", layers))) {
            for (index, DenseLayer { weight, bias }) in layers.into_iter().enumerate() {
                tensors.push((format!("{name}.{index}.weight"), weight));
                tensors.push((format!("{name}.{index}.bias"), bias));
            }
        }
        for (name, tensor) in scaling(self.card()) {
            tensors.push((name.into(), tensor));
        }
        let bytes: Vec<Vec<u8>> = tensors.iter().map(|(_, tensor)| to_bytes(tensor)).collect();
        let views = std::iter::zip(&tensors, &bytes).map(|((name, tensor), bytes)| {
            Ok((name, TensorView::new(Dtype::F64, tensor.shape.clone(), bytes)?))
        });
        let views: Result<Vec<_>, _> = views.collect();
        let file = views
            .and_then(|views| safetensors::serialize(views, None))
            .map_err(|error| malformed(weights, error))?;
        let path = card_path(weights);
        let stamped = Card {
            weights_hash: Some(blake3::hash(&file).to_hex().to_string()),
            ..self.card().clone()
        };
        let mut card = sealed_json::to_vec(&stamped).map_err(|error| no_card(&path, error))?;
        card.push(b'\n');
        whole_file::write(weights, &file).map_err(unwritten(weights))?;
        whole_file::write(&path, &card).map_err(unwritten(&path))
    }
}

/// The surrogate of the tensors of a file, all of which must belong to it.
fn from_tensors(tensors: &mut BTreeMap<String, Tensor>, card: Card) -> Result<Surrogate, Fault> {
    let chi = take_layers(tensors, "chi")?;
    let chi_d = take_layers(tensors, "chi_d")?;
    let chi_p = card.peak_scale.map(|_| take_layers(tensors, "chi_p")).transpose()?;
    for (tensor, expected) in scaling(&card) {
        let found = take(tensors, tensor)?;
        if found.shape != expected.shape {
            return Err(other_shape(tensor, &format!("{:?}", expected.shape), &found.shape));
        }
        ensure!(
            found.values == expected.values,
            "`{tensor}` differs from the value in the card; the two files are from different \
                 trainings, so copy both from the same place"
        );
    }
    if let Some((tensor, _)) = tensors.pop_first() {
        refuse!("tensor `{tensor}` is not part of a known network");
    }
    Surrogate::from_parts(Layers { chi, chi_d, chi_p }, card)
}

impl Card {
    /// Reads the card of `X.safetensors`, `X.json`, without the weights.
    pub fn of(weights: &Path) -> Result<Self, Fault> {
        #[derive(serde::Deserialize)]
        struct Version {
            format_version: u64,
        }
        refuse_database(weights)?;
        let path = &card_path(weights);
        let text = regular_file::read(path).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => fault!(
                "{} has no card: {} is missing; copy both files from the same place",
                weights.display(),
                path.display()
            ),
            _ => unread(path)(error),
        })?;
        let Version { format_version } =
            serde_json::from_slice(&text).map_err(|error| no_card(path, error))?;
        ensure!(
            format_version == u64::from(FORMAT_VERSION),
            "{} has the format version {format_version}, but this program reads only version {FORMAT_VERSION}: train the weights \
     again, or use the program that wrote them",
            path.display()
        );
        sealed_json::from_slice(&text).map_err(|error| no_card(path, error))
    }
}

fn refuse_database(weights: &Path) -> Result<(), Fault> {
    ensure!(
        weights.extension().is_none_or(|kind| kind != "parquet"),
        "{} is a database (Parquet), but weights (.safetensors) are expected; `kirigami train` makes weights from a database",
        weights.display()
    );
    Ok(())
}

fn no_card(path: &Path, error: impl Display) -> Fault {
    fault!("{} is not a card of a surrogate: {error}", path.display())
}

fn malformed(path: &Path, error: impl Display) -> Fault {
    fault!("{} is not a safetensors file: {error}", path.display())
}

fn card_path(weights: &Path) -> PathBuf {
    weights.with_extension("json")
}

fn read_tensors(path: &Path, bytes: &[u8]) -> Result<BTreeMap<String, Tensor>, Fault> {
    let file = SafeTensors::deserialize(bytes).map_err(|error| malformed(path, error))?;
    file.iter()
        .map(|(name, view)| match to_tensor(&view) {
            Some(tensor) => Ok((name.to_owned(), tensor)),
            None => Err(fault!(
                "{}: tensor `{name}` is {:?}, expected F64 or F32",
                path.display(),
                view.dtype()
            )),
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
) -> Result<Vec<DenseLayer>, Fault> {
    let layer_of = |name: &String| -> Option<usize> {
        let (layer, _) = name.strip_prefix(network)?.strip_prefix('.')?.split_once('.')?;
        layer.parse().ok()
    };
    let last = tensors.keys().filter_map(layer_of).max().unwrap_or(0);
    (0..=last)
        .map(|layer| {
            Ok(DenseLayer {
                weight: take(tensors, &format!("{network}.{layer}.weight"))?,
                bias: take(tensors, &format!("{network}.{layer}.bias"))?,
            })
        })
        .collect()
}

fn take(tensors: &mut BTreeMap<String, Tensor>, name: &str) -> Result<Tensor, Fault> {
    tensors.remove(name).ok_or_else(|| missing(name))
}
