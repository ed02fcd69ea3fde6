//! `kirigami-studies tradeoff`: the tables of all studies on speed and accuracy, joined in one page.

use anyhow::{Context, Result, ensure};
use clap::Args;
use std::path::PathBuf;

/// Join the speed and accuracy tables of the studies into one page
///
/// Each study writes a tradeoff.md to its folder: one row per choice, with its cost and its error.
/// The folders are levels, chain, window, tiers, path, surrogate, trust and sheet, each the --out of a study,
/// for example: kirigami-studies window --out docs/results/window
#[derive(Args)]
pub struct TradeoffCommand {
    /// Folder that contains the folders of the studies
    #[arg(long, value_name = "FOLDER", default_value = "docs/results")]
    results: PathBuf,
    /// Page to write
    #[arg(long, value_name = "FILE", default_value = "docs/SPEED-ACCURACY.md")]
    out: PathBuf,
}

const HEADING: &str = "# Speed against accuracy

The tables are those of the studies in docs/results; `kirigami-studies tradeoff` joins them. *Path dependence*, *Ensemble* and *The sheet's equilibrium* are of
settled studies, whose code is in the history: [results](results/README.md). CPU times are comparable within a table. Nearly all errors are of films that are
held flat; of plates there is the table of meshes in [plates](results/plates/tradeoff.md).
";

/// The folders of the studies, in the order of the page.
const STUDIES: [&str; 8] = [
    "levels",
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
            "{0} has no tradeoff.md in the folders {1}: run the studies, for example `kirigami-studies window --out \
             {0}/window` or `kirigami dataset compare A B --out {0}/tiers`",
            self.results.display(),
            STUDIES.join(", ")
        );
        support::whole_file::write(&self.out, page.as_bytes())
            .with_context(|| format!("cannot write {}", self.out.display()))?;
        println!(
            "tables of {found} studies written to {}",
            self.out.display()
        );
        Ok(())
    }
}
