//! `kirigami surrogate`: the card of exported weights, and their errors.

mod card;
mod errors;
mod release;
mod test;

pub(crate) use test::{print_errors, record};

use crate::ui::input_file;
use ::surrogate::Surrogate;
use anyhow::{Result, ensure};
use clap::Args;
use hinge::SheetMaterial;
use std::path::Path;

/// Show the card of exported weights, and measure their errors against finite elements
#[derive(Args)]
pub struct SurrogateCommand {
    #[command(subcommand)]
    action: Action,
}

/// The material of a file, on which the weights must have been trained.
fn trained_material(
    surrogate: &Surrogate,
    weights: &Path,
    material: &Path,
) -> Result<SheetMaterial> {
    input_file::require(material, "--material")?;
    let sheet = SheetMaterial::load(material)?;
    let card = surrogate.card();
    ensure!(
        card.material_hash.as_ref().is_none_or(|hash| *hash == sheet.law_hash()),
        "{} were trained on {}, but {} is another material law: pass the right file with --material",
        weights.display(),
        card.material,
        material.display()
    );
    Ok(sheet)
}

subcommands! {
    enum Action {
        Card(card::CardCommand),
        Test(test::TestCommand),
        Release(release::ReleaseCommand),
    }
}

impl SurrogateCommand {
    pub(crate) fn run(&self) -> Result<()> {
        self.action.run()
    }
}
