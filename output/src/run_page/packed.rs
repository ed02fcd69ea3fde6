//! Lists of numbers in the data of the page.

use base64::{Engine, engine::general_purpose::STANDARD};

/// Numbers as base64 of little-endian 32-bit floats; NaN is a number that is not known.
pub(super) fn packed(numbers: impl IntoIterator<Item = f64>) -> String {
    let bytes = numbers.into_iter().flat_map(|x| (x as f32).to_le_bytes());
    STANDARD.encode(bytes.collect::<Vec<u8>>())
}
