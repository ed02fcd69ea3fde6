//! Changes of a TOML text that keep its comments.

use scene::rounded;
use toml_edit::{Array, DocumentMut, Item, Value};

/// Replaces a value and keeps its comment.
pub fn set(item: &mut Item, value: impl Into<Value>) {
    if let Some(old) = item.as_value_mut() {
        let decor = old.decor().clone();
        *old = value.into();
        *old.decor_mut() = decor;
    }
}

/// Multiplies a number, or each number of a list, and keeps its comment.
pub(super) fn scale(item: &mut Item, factor: f64) {
    map(item, |number| rounded(factor * number));
}

/// Replaces a number, or each number of a list, and keeps its comment.
pub(super) fn map(item: &mut Item, new: impl Fn(f64) -> f64) {
    let scaled = |value: &Value| new(value.as_float().unwrap_or(f64::NAN));
    match item.as_array() {
        Some(list) => {
            let list: Array = list.iter().map(scaled).collect();
            set(item, list);
        }
        None => {
            if let Some(value) = item.as_value().map(scaled) {
                set(item, value);
            }
        }
    }
}

/// Replaces the comment at the head of a file.
pub(super) fn heading(document: &mut DocumentMut, comment: &str) {
    if let Some(mut first) = document.as_table_mut().iter_mut().next().map(|(key, _)| key) {
        first.leaf_decor_mut().set_prefix(comment);
    }
}
