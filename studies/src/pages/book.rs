//! docs/results/pages.toml: the pages, and the products that they are made from.

use serde::Deserialize;
use std::path::PathBuf;

/// The pages and what they need.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Book {
    pub page: Vec<Page>,
    pub product: Vec<Product>,
}

/// A folder of docs/results.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Page {
    pub name: String,
    pub question: String,
    /// Names of the products that the page needs.
    #[serde(default)]
    pub needs: Vec<String>,
    /// Shipped files that the commands read without naming them.
    #[serde(default)]
    pub reads: Vec<String>,
    /// What docs/results/README.md says of a page whose inputs have changed since it was made.
    #[serde(default)]
    pub stale: Option<String>,
    pub commands: Vec<String>,
}

/// A file or folder that pages are made from.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Product {
    pub name: String,
    pub file: PathBuf,
    /// Files that the product is made from.
    pub from: Vec<PathBuf>,
    #[serde(default)]
    pub needs: Vec<String>,
    pub commands: Vec<String>,
}
