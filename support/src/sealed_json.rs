//! JSON files with damage detection: the key `checksum` contains the BLAKE3 hash of the other
//! contents.

use crate::{Fault, FileError, said, whole_file};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::Path;

/// Name of the key.
const CHECKSUM: &str = "checksum";

/// The JSON of a value with its checksum, indented; an earlier checksum is replaced.
pub fn to_vec(value: &impl Serialize) -> Result<Vec<u8>, serde_json::Error> {
    let mut value = serde_json::to_value(value)?;
    if let Value::Object(keys) = &mut value {
        keys.shift_remove(CHECKSUM);
    }
    let sum = checksum(&value)?;
    if let Value::Object(keys) = &mut value {
        keys.insert(CHECKSUM.to_owned(), sum.into());
    }
    serde_json::to_vec_pretty(&value)
}

/// Writes the JSON of a value with its checksum.
pub fn write(path: &Path, value: &impl Serialize) -> Result<(), FileError> {
    let text = to_vec(value).map_err(FileError::at(path))?;
    whole_file::write(path, &text).map_err(FileError::at(path))
}

/// The value in JSON text, after checking its checksum, which it must have.
pub fn from_slice<T: DeserializeOwned>(text: &[u8]) -> Result<T, Fault> {
    read(text)?.ok_or_else(|| {
        fault!(
            "the file has no checksum: a part of it was deleted, or it was not written by kirigami"
        )
    })
}

/// The value in JSON text that people may write too, after checking its checksum if it has one.
pub fn from_slice_by_hand<T: DeserializeOwned>(text: &[u8]) -> Result<T, Fault> {
    match read(text)? {
        Some(value) => Ok(value),
        None => serde_json::from_slice(text).map_err(said),
    }
}

/// The value in JSON text, after checking its checksum; `None` if it has none.
fn read<T: DeserializeOwned>(text: &[u8]) -> Result<Option<T>, Fault> {
    let mut value: Value = serde_json::from_slice(text).map_err(said)?;
    let stated = value.as_object_mut().and_then(|keys| keys.shift_remove(CHECKSUM));
    let Some(expected) = stated else {
        return Ok(None);
    };
    let (expected, found) =
        (expected.as_str().unwrap_or_default(), checksum(&value).map_err(said)?);
    ensure!(
        expected == found,
        "the file is damaged or was edited: it states the checksum {expected}, but its contents have {found}"
    );
    serde_json::from_value(value).map(Some).map_err(said)
}

fn checksum(value: &Value) -> Result<String, serde_json::Error> {
    let text = serde_json::to_vec(value)?;
    Ok(blake3::hash(&text).to_hex().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Record {
        name: String,
        values: Vec<f64>,
    }

    fn record() -> Record {
        let values = vec![0.1, -3e-300, 1.0 / 3.0, 17.0];
        let name = "a".into();
        Record { name, values }
    }

    #[test]
    fn every_flipped_bit_is_noticed_or_changes_nothing() {
        let text = to_vec(&record()).unwrap();
        assert_eq!(from_slice::<Record>(&text).unwrap(), record());
        for bit in 0..8 * text.len() {
            let mut damaged = text.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            if let Ok(read) = from_slice::<Record>(&damaged) {
                assert_eq!(read, record(), "bit {bit}");
            }
        }
    }

    #[test]
    fn only_a_file_written_by_hand_may_lack_its_checksum() {
        let text = serde_json::to_vec(&record()).unwrap();
        let error = from_slice::<Record>(&text).unwrap_err();
        assert!(error.to_string().contains("no checksum"), "{error}");
        assert_eq!(from_slice_by_hand::<Record>(&text).unwrap(), record());
    }
}
