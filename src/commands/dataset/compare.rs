//! `kirigami dataset compare`: differences of a mesh from a finer one on the same rays.

use anyhow::{Result, ensure};
use app::{output_file, run_folder, train::correction};
use clap::Args;
use dataset::{ComparedRay, ComparedState, Database, compare, left_out};
use std::path::PathBuf;
use support::document::Document;
use verification::{SCALE, spread_table};

/// Compare the rays of a database with the same rays on its finer mesh, or in another database
///
/// Prints the differences, also those that a training leaves, which corrects the rays to the finer
/// mesh, and writes them to compare.md. Example: kirigami dataset
/// compare data/polypropylene-3mm/hinges.parquet
#[derive(Args)]
pub(crate) struct CompareRaysCommand {
    /// Database to evaluate (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Reference database (Parquet with its manifest) [default: the finer mesh of DATABASE]
    #[arg(value_name = "REFERENCE")]
    reference: Option<PathBuf>,
    /// Folder of compare.md
    #[arg(long, value_name = "FOLDER", default_value = "runs/compare")]
    out: PathBuf,
}

impl CompareRaysCommand {
    pub(super) fn run(&self) -> Result<()> {
        let database = Database::read(&self.database)?;
        let reference = (self.reference.as_ref()).map(|file| Database::read(file));
        let reference = reference.transpose()?;
        let (rays, finer) = match &reference {
            Some(reference) => {
                (compare(&database, reference), reference.manifest().tier.to_string())
            }
            None => {
                let finer = database.manifest().finer.as_ref();
                let finer = finer.map_or(String::new(), |finer| finer.tier.to_string());
                (database.on_both_meshes(), finer)
            }
        };
        ensure!(
            !rays.is_empty(),
            "{} has no ray on a finer mesh, or in common with the reference",
            self.database.display()
        );
        let states: Vec<_> = rays.iter().map(ComparedRay::states).collect();
        output_file::create_folder(&self.out)?;
        let tiers = [database.manifest().tier.to_string(), finer];
        let mut page = summary(&rays, &states, &tiers);
        match left_out(&rays) {
            Ok(checked) => page.append(correction(&checked)),
            // The comparison is valid without it.
            Err(reason) => {
                eprintln!("cannot evaluate what a correction would leave: {reason}")
            }
        }
        run_folder::write(&self.out, "compare.md", &page.markdown())?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }
}

/// One row per quantity: the difference over all states, and its distribution over the rays.
fn summary(
    rays: &[ComparedRay],
    states: &[Vec<ComparedState>],
    [tier, reference]: &[String; 2],
) -> Document {
    let count = states.iter().map(Vec::len).sum::<usize>();
    let cpu = |of: fn(&ComparedRay) -> f64| rays.iter().map(of).sum::<f64>() / rays.len() as f64;
    let mut page = Document::default();
    page.heading(2, format!("Tier {tier} against tier {reference}, over all common states"));
    page.text(format!(
        "{count} states of {} rays, {:.1} and {:.1} CPU s per ray. Differences are root mean squares relative \
         to the root mean square of the tier {reference}: {SCALE}. `kirigami dataset compare`.",
        rays.len(),
        cpu(|it| it.ray.cpu_s),
        cpu(|it| it.reference_cpu_s),
    ));
    page.table(spread_table(&groups(states), "ray"));
    page
}

fn groups(states: &[Vec<ComparedState>]) -> Vec<&[ComparedState]> {
    states.iter().map(Vec::as_slice).collect()
}
