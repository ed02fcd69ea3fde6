//! JSON files with damage detection: the key `checksum` contains the BLAKE3 hash of the other contents.
//!
//! A file without this key, written by hand, is read without a check.

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// Name of the key.
const CHECKSUM: &str = "checksum";

/// Why sealed JSON cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SealError {
    /// The text is not JSON, or not JSON of the expected type.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// The contents have changed since they were written.
    #[error(
        "the file is damaged or was edited: it states the checksum {expected}, but its contents have {found}"
    )]
    Checksum {
        /// Checksum in the file.
        expected: String,
        /// Checksum of the contents.
        found: String,
    },
}

/// The JSON of a value with its checksum, indented.
pub fn to_vec(value: &impl Serialize) -> Result<Vec<u8>, serde_json::Error> {
    let mut value = serde_json::to_value(value)?;
    let sum = checksum(&value)?;
    if let Value::Object(keys) = &mut value {
        keys.insert(CHECKSUM.to_owned(), sum.into());
    }
    serde_json::to_vec_pretty(&value)
}

/// The value in JSON text, after checking its checksum if it has one.
pub fn from_slice<T: DeserializeOwned>(text: &[u8]) -> Result<T, SealError> {
    let mut value: Value = serde_json::from_slice(text)?;
    let stated = value
        .as_object_mut()
        .and_then(|keys| keys.shift_remove(CHECKSUM));
    if let Some(expected) = stated {
        let (expected, found) = (expected.as_str().unwrap_or_default(), checksum(&value)?);
        if expected != found {
            let expected = expected.to_owned();
            return Err(SealError::Checksum { expected, found });
        }
    }
    Ok(serde_json::from_value(value)?)
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
    fn a_file_without_a_checksum_is_read() {
        let text = serde_json::to_vec(&record()).unwrap();
        assert_eq!(from_slice::<Record>(&text).unwrap(), record());
    }
}
