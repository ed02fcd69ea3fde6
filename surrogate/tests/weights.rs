//! Writing and reading the two files of a surrogate, and the errors of invalid files.

mod common;

use common::{cases, design, tiny, with_peak};
use hinge::HingeDeformation;
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::PathBuf;
use support::sealed_json;
use surrogate::{FORMAT_VERSION, InvalidWeights, Order, Surrogate, WeightsError};
use tempfile::TempDir;

/// A copy of the files of a surrogate, to be changed and written.
struct File {
    folder: TempDir,
    tensors: BTreeMap<String, (Dtype, Vec<usize>, Vec<u8>)>,
    card: String,
}

impl File {
    fn new() -> Self {
        Self::of("chi_tiny")
    }

    fn of(name: &str) -> Self {
        let bytes = std::fs::read(cases().join(name).with_extension("safetensors")).unwrap();
        let file = SafeTensors::deserialize(&bytes).unwrap();
        let tensors = file.iter().map(|(name, view)| {
            let tensor = (view.dtype(), view.shape().to_vec(), view.data().to_vec());
            (name.to_owned(), tensor)
        });
        Self {
            folder: tempfile::tempdir().unwrap(),
            tensors: tensors.collect(),
            card: std::fs::read_to_string(cases().join(name).with_extension("json")).unwrap(),
        }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("chi.safetensors")
    }

    fn load(&self) -> Result<Surrogate, WeightsError> {
        let views = self.tensors.iter().map(|(name, (dtype, shape, data))| {
            let view = TensorView::new(*dtype, shape.clone(), data).unwrap();
            (name.clone(), view)
        });
        let bytes = safetensors::serialize(views, None).unwrap();
        let mut card: Value = serde_json::from_str(&self.card).unwrap();
        card["weights_hash"] = blake3::hash(&bytes).to_hex().to_string().into();
        let card = sealed_json::to_vec(&card).unwrap();
        std::fs::write(self.path(), bytes).unwrap();
        std::fs::write(self.folder.path().join("chi.json"), card).unwrap();
        Surrogate::load(&self.path())
    }

    fn values(&self, name: &str) -> Vec<f64> {
        let (numbers, _) = self.tensors[name].2.as_chunks();
        numbers
            .iter()
            .map(|&bytes| f64::from_le_bytes(bytes))
            .collect()
    }

    fn set(&mut self, name: &str, shape: &[usize], values: &[f64]) {
        let data = values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        self.tensors
            .insert(name.into(), (Dtype::F64, shape.to_vec(), data));
    }

    fn invalid(&self) -> InvalidWeights {
        match self.load().unwrap_err() {
            WeightsError::Invalid { source, path } => {
                assert_eq!(path, self.path());
                source
            }
            other => panic!("{other}"),
        }
    }
}

fn energy(surrogate: &Surrogate) -> f64 {
    let prepared = surrogate.prepare(&[design(18.0, 1.2)]);
    let state = HingeDeformation::from([1.0, -2.0, 0.7]);
    surrogate.evaluate(&prepared, &[state], Order::Value)[0].w
}

#[test]
fn a_saved_surrogate_is_loaded_bit_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("copy.safetensors");
    for surrogate in [tiny(), with_peak()] {
        surrogate.save(&path).unwrap();
        let copy = Surrogate::load(&path).unwrap();
        // As text, in which an error that is not known (NaN) is equal to itself.
        let [read, written] = [&copy, &surrogate].map(|it| format!("{:?}", it.card()));
        assert_eq!(read, written);
        assert_eq!(energy(&copy), energy(&surrogate));
    }
    let mut names: Vec<_> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    names.sort();
    assert_eq!(names, ["copy.json", "copy.safetensors"]);
}

#[test]
fn float32_weights_are_read() {
    let mut file = File::new();
    for name in ["chi.0.weight", "chi.1.bias"] {
        let narrow = file.values(name).into_iter().map(|value| value as f32);
        let data = narrow.flat_map(f32::to_le_bytes).collect();
        let shape = file.tensors[name].1.clone();
        file.tensors.insert(name.into(), (Dtype::F32, shape, data));
    }
    let (wide, narrow) = (energy(&tiny()), energy(&file.load().unwrap()));
    assert!(
        wide != narrow && (wide - narrow).abs() < 1e-5 * wide,
        "{wide} {narrow}"
    );
    file.tensors.get_mut("chi.0.bias").unwrap().0 = Dtype::I64;
    let error = file.load().unwrap_err();
    assert!(
        matches!(
            error,
            WeightsError::Type {
                found: Dtype::I64,
                ..
            }
        ),
        "{error}"
    );
}

#[test]
fn missing_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chi.safetensors");
    let error = Surrogate::load(&path).unwrap_err();
    assert!(matches!(error, WeightsError::Read(_)), "{error}");
    std::fs::copy(cases().join("chi_tiny.safetensors"), &path).unwrap();
    match Surrogate::load(&path).unwrap_err() {
        WeightsError::MissingCard { card, .. } => assert_eq!(card, path.with_extension("json")),
        other => panic!("{other}"),
    }
    let error = tiny()
        .save(&folder.path().join("none/chi.safetensors"))
        .unwrap_err();
    assert!(matches!(error, WeightsError::Write(_)), "{error}");
}

#[test]
fn a_corner_of_the_box_of_all_states_may_be_outside_the_covered_states() {
    let [boxed, filled] = [tiny(), with_peak()];
    let state = |eta_a, theta| HingeDeformation::from_eta(eta_a, 0.0, theta, 18.0);
    let inside =
        |surrogate: &Surrogate, state| surrogate.domain().contains(&design(18.0, 1.2), &state);
    let corner = state(0.2, 0.02);
    assert!(inside(&boxed, state(-0.3, 0.6)) && inside(&filled, state(-0.3, 0.6)));
    assert!(inside(&boxed, corner) && !inside(&filled, corner));
}

#[test]
fn a_head_without_a_scale_and_a_scale_without_a_head_are_errors() {
    let mut file = File::of("chi_domain");
    file.tensors.retain(|name, _| !name.starts_with("chi_p."));
    let tensor = "chi_p.0.weight".into();
    assert_eq!(file.invalid(), InvalidWeights::Missing { tensor });
    let mut file = File::of("chi_domain");
    file.card = file.card.replace("\"peak_scale\": 0.31,", "");
    let scale = file.values("d_scale")[0];
    file.set("d_scale", &[1], &[scale]);
    match file.load().unwrap_err() {
        WeightsError::Extra { tensor, .. } => assert_eq!(tensor, "chi_p.0.bias"),
        other => panic!("{other}"),
    }
    let mut layers = tiny().layers();
    layers.chi_p = Some(layers.chi_d.clone());
    let error = Surrogate::from_parts(layers, tiny().card().clone()).unwrap_err();
    assert!(error.to_string().contains("chi_p"), "{error}");
}

#[test]
fn cards_of_other_versions_shapes_and_trainings_are_errors() {
    let with_card = |from: &str, to: &str| {
        let mut file = File::new();
        assert!(file.card.contains(from), "{from}");
        file.card = file.card.replace(from, to);
        file.load().unwrap_err()
    };
    let version = u64::from(FORMAT_VERSION);
    for found in [0, version - 1, version + 1] {
        let error = with_card(
            &format!("\"format_version\": {version}"),
            &format!("\"format_version\": {found}"),
        );
        assert!(
            matches!(error, WeightsError::UnknownVersion { found: it, .. } if it == found),
            "{error}"
        );
    }
    let error = with_card("\"damage_scale\"", "\"peak_scale\": 0.3, \"damage_scale\"");
    assert!(error.to_string().contains("chi_p.0.weight"), "{error}");
    let error = with_card("\"material\"", "\"materiel\"");
    assert!(error.to_string().contains("materiel"), "{error}");
    let error = with_card("\"energy_scale\": 85.0", "\"energy_scale\": 86.0");
    assert!(
        matches!(
            error,
            WeightsError::OtherCard {
                tensor: "w_scale",
                ..
            }
        ),
        "{error}"
    );
    let error = with_card("[0.375,", "[-0.375,");
    assert!(error.to_string().contains("half_range > 0"), "{error}");
    let error = with_card("\"mm, N, MPa, N mm, rad\"", "\"m, N, Pa, N m, rad\"");
    assert!(error.to_string().contains("units"), "{error}");
    let error = with_card("\"theta\", \"log", "\"theta_deg\", \"log");
    assert!(error.to_string().contains("features"), "{error}");
}

#[test]
fn any_broken_safetensors_is_an_error() {
    let file = File::new();
    file.load().unwrap();
    let bytes = std::fs::read(file.path()).unwrap();
    for length in [0, 1, 7, 8, 9, 100, bytes.len() / 2, bytes.len() - 1] {
        std::fs::write(file.path(), &bytes[..length]).unwrap();
        let error = Surrogate::load(&file.path()).unwrap_err();
        assert!(
            matches!(error, WeightsError::Malformed { .. }),
            "{length}: {error}"
        );
    }
}

#[test]
fn missing_and_unknown_tensors_are_named() {
    for name in [
        "chi.0.bias",
        "chi.1.weight",
        "chi_d.2.weight",
        "feat_std",
        "d_scale",
    ] {
        let mut file = File::new();
        file.tensors.remove(name);
        assert_eq!(
            file.invalid(),
            InvalidWeights::Missing {
                tensor: name.into()
            }
        );
    }
    let mut file = File::new();
    file.set("chi.x.weight", &[1], &[1.0]);
    match file.load().unwrap_err() {
        WeightsError::Extra { tensor, .. } => assert_eq!(tensor, "chi.x.weight"),
        other => panic!("{other}"),
    }
}

#[test]
fn wrong_shapes_name_the_tensor_and_both_shapes() {
    let cases: [(&str, &[usize], &str); 5] = [
        ("chi.1.weight", &[4, 16], "[any, 8]"),
        ("chi.0.bias", &[2, 4], "[8]"),
        ("chi.0.weight", &[40], "[any, 5]"),
        ("chi_d.2.weight", &[2, 3], "[1, 6]"),
        ("feat_mean", &[5, 1], "[5]"),
    ];
    for (name, shape, wanted) in cases {
        let mut file = File::new();
        let values = file.values(name);
        file.set(name, shape, &values);
        match file.invalid() {
            InvalidWeights::Shape {
                tensor,
                expected,
                found,
            } => {
                assert_eq!((tensor.as_str(), expected.as_str()), (name, wanted));
                assert_eq!(found, shape);
            }
            other => panic!("{other}"),
        }
    }
}

#[test]
fn weights_that_are_not_finite_name_tensor_and_index() {
    for value in [f64::NAN, f64::INFINITY] {
        let mut file = File::new();
        let mut values = file.values("chi.1.weight");
        values[13] = value;
        file.set("chi.1.weight", &[8, 8], &values);
        let message = file.invalid().to_string();
        assert!(
            message.contains("`chi.1.weight`") && message.contains("index 13"),
            "{message}"
        );
    }
}

#[test]
fn scales_that_are_not_positive_are_errors() {
    for (name, key, from, bad) in [
        ("w_scale", "energy_scale", "85.0", 0.0),
        ("d_scale", "damage_scale", "0.012", -0.012),
    ] {
        let mut file = File::new();
        file.set(name, &[1], &[bad]);
        let replacement = format!("\"{key}\": {bad:?}");
        file.card = file
            .card
            .replace(&format!("\"{key}\": {from}"), &replacement);
        assert!(matches!(file.invalid(), InvalidWeights::NotPositive { .. }));
    }
    let mut file = File::new();
    file.set("feat_std", &[5], &[0.1, 0.1, 0.0, 0.45, 0.45]);
    file.card = file.card.replace("[0.1, 0.1, 0.35", "[0.1, 0.1, 0.0");
    assert!(file.invalid().to_string().contains("feat_std of theta"));
}

#[test]
fn zero_and_huge_weights_stay_finite() {
    let scaled = |factor: f64| {
        let mut file = File::new();
        for name in ["chi.0.weight", "chi.1.weight", "chi.2.weight"] {
            let values: Vec<f64> = file
                .values(name)
                .iter()
                .map(|value| factor * value)
                .collect();
            let shape = file.tensors[name].1.clone();
            file.set(name, &shape, &values);
        }
        energy(&file.load().unwrap())
    };
    assert_eq!(scaled(0.0), 0.0);
    assert!(scaled(1e100).is_finite());
}

#[test]
fn the_head_of_d_peak_is_checked_like_that_of_d() {
    let with = |factor: f64| {
        let mut file = File::of("chi_domain");
        let bias = file.values("chi_p.2.bias")[0];
        file.set("chi_p.2.bias", &[1], &[factor * bias]);
        file
    };
    for factor in [f64::NAN, f64::INFINITY] {
        let error = with(factor).invalid();
        assert!(
            matches!(&error, InvalidWeights::NotFinite { tensor, .. } if tensor == "chi_p.2.bias"),
            "{error}"
        );
    }
    let state = HingeDeformation::from([1.0, -2.0, 0.7]);
    for factor in [0.0, 1e100, -1e100] {
        let surrogate = with(factor).load().unwrap();
        let damage = surrogate.damage(&[design(18.0, 1.2)], &[state])[0];
        assert!(
            damage
                .d_peak
                .is_some_and(|peak| peak >= 0.0 && peak.is_finite())
        );
        assert!(damage.peak_gradient.iter().all(|slope| slope.is_finite()));
    }
}

/// Saved files state each other's hashes: no damage of either is read as other numbers, and no card of another training.
#[test]
fn damaged_and_exchanged_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let [one, other] =
        ["one", "other"].map(|name| folder.path().join(name).with_extension("safetensors"));
    let surrogate = tiny();
    surrogate.save(&one).unwrap();
    // Another training on the same rows: the same scaling, other weights.
    let mut layers = surrogate.layers();
    layers.chi[0].weight.values[0] *= 1.5;
    let trained = Surrogate::from_parts(layers, surrogate.card().clone()).unwrap();
    trained.save(&other).unwrap();
    let card = |weights: &PathBuf| weights.with_extension("json");
    let whole = [&one, &card(&one)].map(|path| std::fs::read(path).unwrap());
    std::fs::copy(card(&other), card(&one)).unwrap();
    assert!(matches!(
        Surrogate::load(&one),
        Err(WeightsError::Hash { .. })
    ));
    for (path, text) in [&one, &card(&one)].into_iter().zip(&whole) {
        for i in (0..text.len()).step_by(1 + text.len() / 150) {
            std::fs::write(&one, &whole[0]).unwrap();
            std::fs::write(card(&one), &whole[1]).unwrap();
            let mut damaged = text.clone();
            damaged[i] ^= 1 << (i % 8);
            std::fs::write(path, damaged).unwrap();
            if let Ok(read) = Surrogate::load(&one) {
                assert_eq!(
                    read.hash(),
                    surrogate.hash(),
                    "byte {i} of {}",
                    path.display()
                );
            }
        }
    }
}
