//! `kirigami-studies pages`: runs the commands that write the pages of docs/results.
//!
//! The commands are listed in docs/results/pages.toml. A page is always written again; a product, from which pages are
//! made, only if its file is missing or older than its sources.

mod book;
mod inputs;

use anyhow::{Context, Result, ensure};
use book::{Book, Page, Product};
use clap::Args;
use inputs::Inputs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

/// Write the named pages of docs/results, and the page that joins their tables; without a name, list the pages and their questions
///
/// Run it in the root of the repository. A page takes minutes to hours; an interrupted one continues when it
/// is started again. Example: kirigami-studies pages window sheet
#[derive(Args)]
pub struct PagesCommand {
    /// Pages to make
    #[arg(value_name = "PAGE")]
    pages: Vec<String>,
    /// Pages, their commands and the products they need (TOML)
    #[arg(long, value_name = "FILE", default_value = "docs/results/pages.toml")]
    file: PathBuf,
    /// Record the present inputs of the named pages without making them: only for changes that change no figure, as of a format
    #[arg(long, requires = "pages")]
    accept: bool,
}

impl PagesCommand {
    pub fn run(&self) -> Result<()> {
        let book: Book = support::toml_file::read(&self.file)?;
        if self.pages.is_empty() {
            for page in &book.page {
                let stale = page
                    .stale
                    .as_ref()
                    .map_or("", |_| " (older than its inputs)");
                println!("{:<14}{}{stale}", page.name, page.question);
            }
            return Ok(());
        }
        let recorded = self.file.with_file_name("inputs.toml");
        let mut inputs = Inputs::read(&recorded)?;
        for page in book.chosen(&self.pages)? {
            if !self.accept {
                page.needs.iter().try_for_each(|name| book.make(name))?;
                page.commands
                    .iter()
                    .try_for_each(|command| shell(command))?;
            }
            inputs.record(&book, page, Path::new("."))?;
            inputs.write(&recorded)?;
        }
        if self.accept {
            return Ok(());
        }
        shell("kirigami-studies tradeoff")
    }
}

impl Book {
    fn chosen(&self, names: &[String]) -> Result<Vec<&Page>> {
        let page = |name: &String| {
            let page = self.page.iter().find(|page| page.name == *name);
            page.with_context(|| {
                format!("there is no page `{name}`; `kirigami-studies pages` lists all")
            })
        };
        names.iter().map(page).collect()
    }

    /// Makes a product, unless its file exists and is newer than its sources.
    fn make(&self, name: &str) -> Result<()> {
        let product = self.product.iter().find(|product| product.name == name);
        let product = product.with_context(|| format!("there is no product `{name}`"))?;
        product.needs.iter().try_for_each(|name| self.make(name))?;
        if product.is_current() {
            return Ok(());
        }
        let mut commands = product.commands.iter();
        commands.try_for_each(|command| shell(command))
    }
}

impl Product {
    fn is_current(&self) -> bool {
        let Some(made) = modified(&self.file) else {
            return false;
        };
        self.from
            .iter()
            .all(|from| modified(from).is_none_or(|from| from <= made))
    }
}

fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|it| it.modified()).ok()
}

/// Runs a command line of the book; the folder of this program is first on the PATH.
fn shell(command: &str) -> Result<()> {
    eprintln!("{command}");
    let own = std::env::current_exe()?;
    let beside = own.parent().unwrap_or(Path::new("")).to_owned();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::iter::once(beside).chain(std::env::split_paths(&path)))?;
    let status = Command::new("sh")
        .args(["-ec", command])
        .env("PATH", path)
        .status()?;
    ensure!(status.success(), "`{command}` ended with {status}");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_shipped_book_names_products_and_studies_that_exist() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/results/pages.toml");
        let book: Book = support::toml_file::read(&file).unwrap();
        let needs = book.page.iter().flat_map(|page| &page.needs);
        for name in needs.chain(book.product.iter().flat_map(|product| &product.needs)) {
            assert!(
                book.product.iter().any(|product| product.name == *name),
                "{name}"
            );
        }
        let pages = book.page.iter().map(|page| &page.commands);
        let commands = pages.chain(book.product.iter().map(|product| &product.commands));
        let studies = crate::Cli::command();
        for command in commands.flatten() {
            let study = command.strip_prefix("kirigami-studies ");
            if let Some(study) = study.and_then(|rest| rest.split(' ').next()) {
                assert!(studies.find_subcommand(study).is_some(), "{command}");
            }
        }
        assert!(book.chosen(&["no such page".into()]).is_err());
    }

    #[test]
    fn a_product_is_made_again_when_its_source_is_newer() {
        let folder = tempfile::tempdir().unwrap();
        let [source, made] = ["source", "made"].map(|name| folder.path().join(name));
        let product = Product {
            name: "made".into(),
            file: made.clone(),
            from: vec![source.clone()],
            needs: Vec::new(),
            commands: Vec::new(),
        };
        std::fs::write(&source, "").unwrap();
        assert!(!product.is_current());
        std::fs::write(&made, "").unwrap();
        assert!(product.is_current());
        let later = SystemTime::now() + std::time::Duration::from_secs(60);
        std::fs::File::open(&source)
            .unwrap()
            .set_modified(later)
            .unwrap();
        assert!(!product.is_current());
    }
}
