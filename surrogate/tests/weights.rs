//! Writing and reading the two files of a surrogate, and the errors of invalid files.

mod common;

use common::{cases, design, tiny, with_peak};
use hinge::HingeDeformation;
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use support::{Fault, sealed_json};
use surrogate::{FORMAT_VERSION, Order, Surrogate};
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

    fn load(&self) -> Result<Surrogate, Fault> {
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
        let numbers = numbers.iter().copied();
        numbers.map(f64::from_le_bytes).collect()
    }

    fn set(&mut self, name: &str, shape: &[usize], values: &[f64]) {
        let data = values.iter().flat_map(|value| value.to_le_bytes());
        let tensor = (Dtype::F64, shape.to_vec(), data.collect());
        self.tensors.insert(name.into(), tensor);
    }

    /// Changes the values of a tensor.
    fn change(&mut self, name: &str, change: impl FnOnce(&mut Vec<f64>)) {
        let (mut values, shape) = (self.values(name), self.tensors[name].1.clone());
        change(&mut values);
        self.set(name, &shape, &values);
    }

    fn replace(&mut self, from: &str, to: &str) {
        assert!(self.card.contains(from), "{from}");
        self.card = self.card.replace(from, to);
    }

    /// Fails unless the file is refused with its path and a text.
    #[track_caller]
    fn assert_refused(&self, part: &str) {
        let error = self.load().unwrap_err().to_string();
        let of_file = error.starts_with(&self.path().display().to_string());
        assert!(of_file && error.contains(part), "{error}");
    }

    /// Fails unless the file is refused for a tensor that is in no surrogate of its card.
    #[track_caller]
    fn assert_extra(&self, name: &str) {
        self.assert_refused(&format!("tensor `{name}` is not part of a known network"));
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
    let files = std::fs::read_dir(folder.path()).unwrap();
    let names: BTreeSet<_> = files.map(|file| file.unwrap().file_name()).collect();
    let expected = ["copy.json", "copy.safetensors"];
    assert_eq!(names, expected.map(Into::into).into());
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
    let apart = (wide - narrow).abs();
    assert!(0.0 < apart && apart < 1e-5 * wide, "{wide} {narrow}");
    file.tensors.get_mut("chi.0.bias").unwrap().0 = Dtype::I64;
    file.assert_refused("tensor `chi.0.bias` is I64");
}

#[test]
fn missing_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chi.safetensors");
    let error = Surrogate::load(&path).unwrap_err().to_string();
    assert!(error.starts_with(&format!("cannot read {}", path.display())), "{error}");
    std::fs::copy(cases().join("chi_tiny.safetensors"), &path).unwrap();
    let error = Surrogate::load(&path).unwrap_err().to_string();
    let expected = format!("{} is missing", path.with_extension("json").display());
    assert!(error.contains(&expected), "{error}");
    let nowhere = folder.path().join("none/chi.safetensors");
    let error = tiny().save(&nowhere).unwrap_err().to_string();
    assert!(error.starts_with("cannot write "), "{error}");
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
    file.assert_refused("tensor `chi_p.0.weight` is missing");
    let mut file = File::of("chi_domain");
    file.replace("\"peak_scale\": 0.31,", "");
    let scale = file.values("d_scale")[0];
    file.set("d_scale", &[1], &[scale]);
    file.assert_extra("chi_p.0.bias");
    let mut layers = tiny().layers();
    layers.chi_p = Some(layers.chi_d.clone());
    let error = Surrogate::from_parts(layers, tiny().card().clone()).unwrap_err();
    assert!(error.to_string().contains("chi_p"), "{error}");
}

#[test]
fn cards_of_other_versions_shapes_and_trainings_are_errors() {
    let with_card = |from: &str, to: &str| {
        let mut file = File::new();
        file.replace(from, to);
        file.load().unwrap_err()
    };
    let version = u64::from(FORMAT_VERSION);
    for other in [0, version - 1, version + 1] {
        let stated = |version: u64| format!("\"format_version\": {version}");
        let error = with_card(&stated(version), &stated(other)).to_string();
        assert!(error.contains(&format!("has the format version {other}")), "{error}");
    }
    let peak = "\"peak_scale\": 0.3, \"damage_scale\"";
    for (from, to, expected) in [
        ("\"energy_scale\": 85.0", "\"energy_scale\": 86.0", "`w_scale` differs from the value"),
        ("\"damage_scale\"", peak, "chi_p.0.weight"),
        ("\"material\"", "\"materiel\"", "materiel"),
        ("[0.375,", "[-0.375,", "half_range > 0"),
        ("mm, N, MPa, N mm, rad", "m, N, Pa, N m, rad", "units"),
        ("\"theta\", \"log", "\"theta_deg\", \"log", "features"),
    ] {
        let error = with_card(from, to).to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn any_broken_safetensors_is_an_error() {
    let file = File::new();
    file.load().unwrap();
    let bytes = std::fs::read(file.path()).unwrap();
    for length in [0, 1, 7, 8, 9, 100, bytes.len() / 2, bytes.len() - 1] {
        std::fs::write(file.path(), &bytes[..length]).unwrap();
        let error = Surrogate::load(&file.path()).unwrap_err().to_string();
        assert!(error.contains("is not a safetensors file"), "{length}: {error}");
    }
}

#[test]
fn missing_and_unknown_tensors_are_named() {
    for name in ["chi.0.bias", "chi.1.weight", "chi_d.2.weight", "feat_std", "d_scale"] {
        let mut file = File::new();
        file.tensors.remove(name);
        file.assert_refused(&format!("tensor `{name}` is missing"));
    }
    let mut file = File::new();
    file.set("chi.x.weight", &[1], &[1.0]);
    file.assert_extra("chi.x.weight");
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
        file.assert_refused(&format!("`{name}` has the shape {shape:?}, expected {wanted}"));
    }
}

#[test]
fn weights_that_are_not_finite_name_tensor_and_index() {
    for value in [f64::NAN, f64::INFINITY] {
        for (name, tensor, index) in
            [("chi_tiny", "chi.1.weight", 13), ("chi_domain", "chi_p.2.bias", 0)]
        {
            let mut file = File::of(name);
            file.change(tensor, |values| values[index] = value);
            file.assert_refused(&format!("tensor `{tensor}` contains {value} at index {index}"));
        }
    }
}

#[test]
fn scales_that_are_not_positive_are_errors() {
    for (name, key, from, bad) in
        [("w_scale", "energy_scale", "85.0", 0.0), ("d_scale", "damage_scale", "0.012", -0.012)]
    {
        let mut file = File::new();
        file.set(name, &[1], &[bad]);
        file.replace(&format!("\"{key}\": {from}"), &format!("\"{key}\": {bad:?}"));
        file.assert_refused(&format!("{bad} violates 0 < "));
    }
    let mut file = File::new();
    file.set("feat_std", &[5], &[0.1, 0.1, 0.0, 0.45, 0.45]);
    file.replace("[0.1, 0.1, 0.35", "[0.1, 0.1, 0.0");
    file.assert_refused("feat_std of theta");
}

#[test]
fn zero_and_huge_weights_stay_finite() {
    let scaled = |factor: f64| {
        let mut file = File::new();
        for name in ["chi.0.weight", "chi.1.weight", "chi.2.weight"] {
            file.change(name, |values| values.iter_mut().for_each(|x| *x *= factor));
        }
        energy(&file.load().unwrap())
    };
    assert_eq!(scaled(0.0), 0.0);
    assert!(scaled(1e100).is_finite());
}

#[test]
fn the_damage_of_huge_weights_stays_finite() {
    let state = HingeDeformation::from([1.0, -2.0, 0.7]);
    for factor in [0.0, 1e100, -1e100] {
        let mut file = File::of("chi_domain");
        file.change("chi_p.2.bias", |bias| bias[0] *= factor);
        let surrogate = file.load().unwrap();
        let damage = surrogate.damage(&[design(18.0, 1.2)], &[state], true)[0];
        let peak = damage.d_peak.unwrap();
        assert!(peak >= 0.0 && peak.is_finite());
        assert!(damage.peak_gradient.to_array().iter().all(|slope| slope.is_finite()));
    }
}

/// Saved files state each other's hashes: no damage of either is read as other numbers, and no card
/// of another training.
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
    let exchanged = Surrogate::load(&one).unwrap_err().to_string();
    assert!(exchanged.contains("is not the file that its card describes"), "{exchanged}");
    for (path, text) in [&one, &card(&one)].into_iter().zip(&whole) {
        for i in (0..text.len()).step_by(1 + text.len() / 150) {
            std::fs::write(&one, &whole[0]).unwrap();
            std::fs::write(card(&one), &whole[1]).unwrap();
            let mut damaged = text.clone();
            damaged[i] ^= 1 << (i % 8);
            std::fs::write(path, damaged).unwrap();
            if let Ok(read) = Surrogate::load(&one) {
                assert_eq!(read.hash(), surrogate.hash(), "byte {i} of {path:?}");
            }
        }
    }
}
