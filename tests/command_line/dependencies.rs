//! The crates of others: their licences, where they are from, and the Rust that they need.

use serde_json::Value;
use std::collections::BTreeSet;
use std::process::Command;

/// Licences of crates in the program, all of which allow what MIT and Apache-2.0 allow, if their
/// texts are passed on.
const LICENCES: [&str; 14] = [
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "CDLA-Permissive-2.0",
    "ISC",
    "MIT",
    "MPL-2.0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// Crates that name a file in place of a licence, which is one of those above.
const BY_FILE: [&str; 1] = ["cfg_block"];

/// The packages that a build for Linux needs.
fn packages() -> Vec<Value> {
    let metadata = Command::new(env!("CARGO"))
        .args(["metadata", "--offline", "--locked", "--format-version=1"])
        .args(["--filter-platform", "x86_64-unknown-linux-gnu"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&metadata.stdout).unwrap();
    let nodes = metadata["resolve"]["nodes"].as_array().unwrap();
    let needed: BTreeSet<&str> = nodes.iter().filter_map(|node| node["id"].as_str()).collect();
    let packages = metadata["packages"].as_array().unwrap().iter();
    packages.filter(|package| needed.contains(package["id"].as_str().unwrap())).cloned().collect()
}

/// Whether a licence expression can be met by the list: `and` of alternatives.
fn is_allowed(expression: &str) -> bool {
    let expression = expression.replace(['(', ')'], "").replace('/', " OR ");
    expression.split(" AND ").all(|any| any.split(" OR ").any(|it| LICENCES.contains(&it.trim())))
}

/// The version of a Rust as numbers.
fn version(text: &str) -> Vec<u32> {
    text.split('.').map(|number| number.parse().unwrap()).collect()
}

#[test]
fn dependencies_have_allowed_licences_one_source_and_no_newer_rust() {
    let oldest = version(env!("CARGO_PKG_RUST_VERSION"));
    let packages = packages();
    assert!(packages.len() > 100);
    for package in packages {
        let text = |key: &str| package[key].as_str();
        let name = text("name").unwrap();
        let licence = text("license").map_or(BY_FILE.contains(&name), is_allowed);
        assert!(licence, "{name}: {:?}", text("license"));
        let registry = "registry+https://github.com/rust-lang/crates.io-index";
        assert!(text("source").is_none_or(|source| source == registry), "{name}: {package}");
        let rust = text("rust_version").map(version);
        assert!(
            rust.is_none_or(|rust| rust[..2.min(rust.len())] <= oldest[..]),
            "{name} needs a newer Rust"
        );
    }
}
