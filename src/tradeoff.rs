//! `kirigami tradeoff`: what speed costs in accuracy, on one page.

use anyhow::{Context, Result, ensure};
use clap::Args;
use std::path::PathBuf;

/// Join what the studies say of speed against accuracy into one page
///
/// Each study leaves a tradeoff.md in its folder: one row a choice, with its cost and its error.
/// The folders are chain, window, tiers, path, surrogate, trust and sheet, each where a study was told to write
/// by --out, for example: kirigami study window --out docs/results/window
#[derive(Args)]
pub struct TradeoffCommand {
    /// Folder that holds the folders of the studies
    #[arg(long, value_name = "FOLDER", default_value = "docs/results")]
    results: PathBuf,
    /// The page to write
    #[arg(long, value_name = "FILE", default_value = "docs/SPEED-ACCURACY.md")]
    out: PathBuf,
}

const HEADING: &str = "# Speed against accuracy

Each table is the output of the command that it names; `kirigami tradeoff` joins them. CPU times are comparable within
a table.
";

/// The folders of the studies, in the order of the page.
const STUDIES: [&str; 7] = [
    "chain",
    "window",
    "tiers",
    "path",
    "surrogate",
    "trust",
    "sheet",
];

impl TradeoffCommand {
    pub fn run(&self) -> Result<()> {
        let mut page = HEADING.to_owned();
        let mut found = 0;
        for study in STUDIES {
            let path = self.results.join(study).join("tradeoff.md");
            if path.exists() {
                let text = std::fs::read_to_string(&path)
                    .with_context(|| format!("cannot read {}", path.display()))?;
                page = format!("{page}\n{}\n", text.trim_end());
                found += 1;
            }
        }
        ensure!(
            found > 0,
            "{0} holds no tradeoff.md in the folders {1}: make them, for example by `kirigami study window --out \
             {0}/window`, `kirigami dataset compare A B --out {0}/tiers`",
            self.results.display(),
            STUDIES.join(", ")
        );
        hinge::files::write(&self.out, page.as_bytes())
            .with_context(|| format!("cannot write {}", self.out.display()))?;
        println!("{found} studies joined in {}", self.out.display());
        Ok(())
    }
}
