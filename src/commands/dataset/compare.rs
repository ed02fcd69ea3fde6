//! `kirigami dataset compare`: differences of a mesh from a finer one on the same rays.

use crate::commands::compared_states;
use crate::ui::{output_file, run_folder};
use anyhow::{Result, ensure};
use clap::Args;
use dataset::{COMPARED, ComparedRay, ComparedState, Database, LeftOut, compare, left_out};
use std::path::PathBuf;
use support::document::Document;
use support::table::{Cell, Columns};
use verification::{SCALE, each_relative, spread_table};

/// Compare the rays of a database with the same rays on its finer mesh, or in another database
///
/// Writes compare.md, compare.csv (one row per ray) and a chart, and prints the differences
/// that a training leaves, which corrects the rays to the finer mesh. Example: kirigami dataset
/// compare data/polypropylene-3mm/hinges.parquet
#[derive(Args)]
pub struct CompareCommand {
    /// Database to evaluate (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Reference database (Parquet with its manifest) [default: the finer mesh of DATABASE]
    #[arg(value_name = "REFERENCE")]
    reference: Option<PathBuf>,
    /// Folder for the tables and the chart
    #[arg(long, value_name = "FOLDER", default_value = "runs/compare")]
    out: PathBuf,
}

impl CompareCommand {
    pub fn run(&self) -> Result<()> {
        let database = Database::read(&self.database)?;
        let reference = (self.reference.as_ref()).map(|file| Database::read(file));
        let reference = reference.transpose()?;
        let (rays, finer) = match &reference {
            Some(reference) => (compare(&database, reference), reference.manifest().tier.clone()),
            None => {
                let finer = database.manifest().finer.as_ref();
                let finer = finer.map_or(String::new(), |finer| finer.tier.clone());
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
        let tiers = [database.manifest().tier.clone(), finer];
        let mut page = summary(&rays, &states, &tiers);
        match left_out(&rays) {
            Ok(checked) => page.append(correction(&checked)),
            // The comparison is valid without it.
            Err(reason) => {
                eprintln!("cannot evaluate what a correction would leave: {reason}")
            }
        }
        let csv = columns().table(&ranked(&rays, &states)).csv();
        run_folder::write(&self.out, "compare.csv", &csv)?;
        run_folder::write(&self.out, "compare.md", &page.markdown())?;
        let axes = [tiers[1].as_str(), &tiers[0]];
        compared_states::draw(&groups(&states), axes, &self.out.join("compare"))?;
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
    let count = rays.iter().map(|ray| ray.rows.len()).sum::<usize>();
    let cpu = [0, 1].map(|i| rays.iter().map(|ray| ray.cpu_s[i]).sum::<f64>() / rays.len() as f64);
    let mut page = Document::default();
    page.heading(2, format!("Tier {tier} against tier {reference}, over all common states"));
    page.text(format!(
        "{count} states of {} rays, {:.1} and {:.1} CPU s per ray. Differences are root mean squares relative \
         to the root mean square of the tier {reference}: {SCALE}. `kirigami dataset compare`.",
        rays.len(),
        cpu[0],
        cpu[1],
    ));
    page.table(spread_table(&groups(states), "ray"));
    page
}

/// The remaining differences when every ray is corrected by the others.
pub fn correction(checked: &LeftOut) -> Document {
    let note = match &checked.uncorrected()[..] {
        [] => String::new(),
        left => format!(
            " Not corrected, because that does not reduce the differences: {}.",
            left.join(", ")
        ),
    };
    let mut page = Document::default();
    page.text(format!(
        "Remaining differences when each of the {} rays is corrected by the others.{note}",
        checked.states.len()
    ));
    page.table(spread_table(&groups(&checked.states), "ray"));
    page
}

fn groups(states: &[Vec<ComparedState>]) -> Vec<&[ComparedState]> {
    states.iter().map(Vec::as_slice).collect()
}

/// A ray with its relative differences.
type Ranked<'a> = (&'a ComparedRay<'a>, [f64; 6]);

/// The rays with their differences, those with the largest in W first.
fn ranked<'a>(rays: &'a [ComparedRay<'a>], states: &[Vec<ComparedState>]) -> Vec<Ranked<'a>> {
    let mut ranked: Vec<Ranked> = rays.iter().zip(each_relative(&groups(states))).collect();
    ranked.sort_by(|(_, x), (_, y)| y[0].total_cmp(&x[0]));
    ranked
}

/// A ray a row.
fn columns<'a>() -> Columns<'a, Ranked<'a>> {
    let mut columns = Columns::new();
    for (i, (name, decimals)) in PLACE.into_iter().enumerate() {
        columns =
            columns.column(name, move |(ray, _): &Ranked| Cell::fixed(place(ray)[i], decimals));
    }
    columns = columns
        .column("W, N mm", |(ray, _)| Cell::fixed(ray.end().sample.w, 1))
        .column("CPU s", |(ray, _)| Cell::fixed(ray.cpu_s[0], 1))
        .column("CPU s of the reference", |(ray, _)| Cell::fixed(ray.cpu_s[1], 1));
    for (i, name) in COMPARED.into_iter().enumerate() {
        columns = columns.column(name, move |(_, differences)| Cell::percent(differences[i], 1));
    }
    columns
}

/// The names of [`place`], and their decimals on a page.
const PLACE: [(&str, usize); 5] =
    [("w_lig, mm", 1), ("alpha, deg", 0), ("eta_a", 2), ("eta_s", 2), ("theta, deg", 0)];

/// w_lig (mm), alpha (deg), and the end of the ray: eta_a, eta_s, theta (deg).
fn place(ray: &ComparedRay) -> [f64; 5] {
    let end = ray.end();
    let (design, sample) = (&end.design, &end.sample);
    let [eta_a, eta_s] = end.eta();
    [design.w_lig, design.alpha.to_degrees(), eta_a, eta_s, sample.theta.to_degrees()]
}
