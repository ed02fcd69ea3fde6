//! What the pages of docs/results rest on: `docs/results/inputs.toml` has for every page the hashes of its weights, databases,
//! configurations and other files at the time when it was made. A page whose inputs have changed since is stale.

use super::book::{Book, Page};
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};
use surrogate::Surrogate;

/// Number of hexadecimal digits of a hash.
const DIGITS: usize = 16;
const HEAD: &str = "\
# What each page was made from: hashes of its weights, databases, configurations and other files. Written by `kirigami-studies pages`; a test compares them with the files that are shipped.
";

/// The hashes of the inputs of every page, by page and file.
#[derive(Default, Deserialize, Serialize)]
#[serde(transparent)]
pub(super) struct Inputs(BTreeMap<String, BTreeMap<String, String>>);

impl Inputs {
    pub fn read(file: &Path) -> Result<Self> {
        Ok(support::toml_file::read(file)?)
    }

    pub fn write(&self, file: &Path) -> Result<()> {
        let text = format!("{HEAD}\n{}", toml::to_string(self)?);
        support::whole_file::write(file, text.as_bytes())
            .with_context(|| format!("{} cannot be written", file.display()))
    }

    /// Records the present inputs of a page, in the checkout `root`.
    pub fn record(&mut self, book: &Book, page: &Page, root: &Path) -> Result<()> {
        let hashes = (book.inputs(page, root).into_iter()).map(|input| {
            let hash = hash(&root.join(&input))?;
            Ok((input, hash))
        });
        let hashes = hashes.collect::<Result<_>>()?;
        self.0.insert(page.name.clone(), hashes);
        Ok(())
    }

    /// The inputs of a page that have changed since it was made; all of a page that was never recorded.
    #[cfg(test)]
    pub fn changed(&self, book: &Book, page: &Page, root: &Path) -> Result<Vec<String>> {
        let mut now = Self::default();
        now.record(book, page, root)?;
        let recorded = self.0.get(&page.name).cloned().unwrap_or_default();
        let changed = now.0[&page.name].iter();
        let changed = changed.filter(|(input, hash)| recorded.get(*input) != Some(*hash));
        Ok(changed.map(|(input, _)| input.clone()).collect())
    }
}

impl Book {
    /// The shipped files that a page is made from: those in its commands, those that these read without being asked, and those
    /// of the products that it needs.
    fn inputs(&self, page: &Page, root: &Path) -> BTreeSet<String> {
        let mut inputs: BTreeSet<String> = page.reads.iter().cloned().collect();
        inputs.extend(shipped(&page.commands, root));
        let mut needs: Vec<&String> = page.needs.iter().collect();
        while let Some(name) = needs.pop() {
            for product in self.product.iter().filter(|product| product.name == *name) {
                let from = product.from.iter().map(|file| file.display().to_string());
                inputs.extend(shipped(&from.collect::<Vec<_>>(), root));
                inputs.extend(shipped(&product.commands, root));
                needs.extend(&product.needs);
            }
        }
        let named = inputs.iter().filter(|input| input.ends_with(".toml"));
        let named: Vec<String> = named.flat_map(|input| named_by(input, root)).collect();
        inputs.extend(named);
        inputs
    }
}

/// The words that name a shipped file.
fn shipped(commands: &[String], root: &Path) -> Vec<String> {
    let words = commands.iter().flat_map(|command| command.split(' '));
    words
        .filter(|word| word.starts_with("configs/") || word.starts_with("data/"))
        .filter(|word| root.join(word).is_file())
        .map(str::to_owned)
        .collect()
}

/// The shipped files that a configuration names, relative to itself.
fn named_by(input: &str, root: &Path) -> Vec<String> {
    let Ok(text) = std::fs::read_to_string(root.join(input)) else {
        return Vec::new();
    };
    let folder = Path::new(input).parent().unwrap_or(Path::new(""));
    let quoted = text.split('"').skip(1).step_by(2);
    let files = quoted.filter_map(|path| {
        let mut file = PathBuf::new();
        for part in folder.join(path).components() {
            match part {
                Component::ParentDir => _ = file.pop(),
                part => file.push(part),
            }
        }
        // What a command writes is there or not, as `make demo` was run or not.
        let is_shipped = !file.starts_with("runs") && root.join(&file).is_file();
        is_shipped.then(|| file.display().to_string())
    });
    files.collect()
}

/// Of weights what they compute, of configurations their keys, of other files their bytes.
fn hash(file: &Path) -> Result<String> {
    let bytes = match file.extension().and_then(|it| it.to_str()) {
        Some("safetensors") => Surrogate::load(file)?.hash().into_bytes(),
        Some("toml") => {
            let keys: toml::Table = support::toml_file::read(file)?;
            toml::to_string(&keys)?.into_bytes()
        }
        _ => std::fs::read(file).with_context(|| file.display().to_string())?,
    };
    let hash = blake3::hash(&bytes).to_hex();
    Ok(hash.chars().take(DIGITS).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_rests_on_the_shipped_files_or_says_that_it_does_not() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let results = root.join("docs/results");
        let book: Book = support::toml_file::read(&results.join("pages.toml")).unwrap();
        let inputs = Inputs::read(&results.join("inputs.toml")).unwrap();
        let named = std::fs::read_to_string(results.join("README.md")).unwrap();
        let named = named.split_whitespace().collect::<Vec<_>>().join(" ");
        for page in &book.page {
            let changed = inputs.changed(&book, page, &root).unwrap();
            match &page.stale {
                None => assert!(
                    changed.is_empty(),
                    "{}: {changed:?} changed since the page was made: `kirigami-studies pages {}`",
                    page.name,
                    page.name
                ),
                Some(said) => {
                    assert!(!changed.is_empty(), "{} is not stale", page.name);
                    assert!(named.contains(said), "docs/results/README.md: {said}");
                }
            }
        }
    }

    #[test]
    fn a_changed_input_makes_a_page_stale() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("data")).unwrap();
        let input = folder.path().join("data/a.csv");
        std::fs::write(&input, "1").unwrap();
        let page = || Page {
            name: "a".into(),
            question: String::new(),
            needs: vec!["b".into()],
            reads: Vec::new(),
            stale: None,
            commands: vec!["study --out docs".into()],
        };
        let product = super::super::book::Product {
            name: "b".into(),
            file: "runs/b".into(),
            from: vec!["data/a.csv".into(), "runs/c".into()],
            needs: Vec::new(),
            commands: Vec::new(),
        };
        let book = Book {
            page: vec![page()],
            product: vec![product],
        };
        let mut inputs = Inputs::default();
        let changed = |inputs: &Inputs| inputs.changed(&book, &page(), folder.path()).unwrap();
        assert_eq!(changed(&inputs), ["data/a.csv"]);
        inputs.record(&book, &page(), folder.path()).unwrap();
        let file = folder.path().join("inputs.toml");
        inputs.write(&file).unwrap();
        let inputs = Inputs::read(&file).unwrap();
        assert!(changed(&inputs).is_empty());
        std::fs::write(&input, "2").unwrap();
        assert_eq!(changed(&inputs), ["data/a.csv"]);
    }
}
