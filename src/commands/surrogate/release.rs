//! `kirigami surrogate release`: hinges deformed and unloaded by finite elements, and their law.

use crate::commands::solve_args::{SolveArgs, task_error};
use crate::commands::surrogate::trained_material;
use crate::ui::count::count;
use crate::ui::run_folder;
use anyhow::{Result, ensure};
use clap::Args;
use fe_driver::{DrawnStates, random_paths};
use mesher::Tier;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use support::document::Document;
use support::table::Table;
use surrogate::{FEWEST, Springback, Surrogate};
use verification::{first_guess, releases, verification_tier};

/// Deform hinges by finite elements, unload them, and learn their residual deformation
///
/// The states are drawn uniformly inside the training domain of the weights, one a hinge, with
/// holes of 0.16 ligament widths. Each hinge is deformed along the straight ray to its state and
/// unloaded until it is without forces; that takes two to three windows. Writes released.csv, the
/// deformation that stays and the stiffness about it, and springback.json, the law that a scene
/// names (surrogate.springback), with its errors at hinges that the fit has not seen. Example:
/// kirigami surrogate release data/polypropylene-3mm/medium.safetensors --material
/// configs/materials/polypropylene-3mm.toml --count 80
#[derive(Args)]
pub struct ReleaseCommand {
    /// Weights (safetensors with their card)
    #[arg(value_name = "WEIGHTS")]
    weights: PathBuf,
    /// Number of hinges; the law is tested on the last 30 of them, and not fitted to these
    #[arg(long, value_name = "N", default_value = "80", value_parser = count::<NonZeroUsize>)]
    count: NonZeroUsize,
    /// Seed of the random states
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
    /// Sheet material that the weights were trained on (TOML)
    #[arg(long, value_name = "FILE")]
    material: PathBuf,
    /// Mesh tier of the windows [default: the tier of the weights' database, or the finer tier that
    /// the database was corrected to]
    #[arg(long, value_name = "TIER")]
    tier: Option<Tier>,
    /// Folder for the table and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/release")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

/// Number of hinges that the law is tested on.
const UNSEEN: usize = 30;

impl ReleaseCommand {
    pub fn run(&self) -> Result<()> {
        let surrogate = Surrogate::load(&self.weights)?;
        let material = trained_material(&surrogate, &self.weights, &self.material)?;
        ensure!(
            self.count.get() >= UNSEEN + FEWEST,
            "--count {} leaves {} hinges to fit the law to, and it needs {FEWEST}: increase --count",
            self.count,
            self.count.get().saturating_sub(UNSEEN)
        );
        let tier = verification_tier(self.tier, &surrogate)?;
        let _held = run_folder::hold(&self.out)?;
        let windows = self.solve.service(&self.out)?;
        // A law knows one hole, the reference hole.
        let mut domain = surrogate.domain().clone();
        domain.holes = None;
        let drawn = DrawnStates {
            domain: &domain,
            constants: &surrogate.card().hinge,
            regime: tier.regime(),
        };
        let drawn = random_paths(drawn, self.count.get(), 1, self.seed);
        let hinges: Vec<_> = drawn.into_iter().map(|path| path.hinge).collect();
        let guess = |design: &_, reached: &_| first_guess(&material, design, reached);
        let found = releases(&windows, &hinges, &material, tier, guess).map_err(task_error)?;
        for reason in &found.failed {
            println!("not unloaded: {reason}");
        }
        ensure!(!found.rows.is_empty(), "no hinge was unloaded; see {}", self.out.display());
        let mut writer = csv::Writer::from_writer(Vec::new());
        for row in &found.rows {
            writer.serialize(row)?;
        }
        run_folder::write(&self.out, "released.csv", &writer.into_inner()?)?;
        println!(
            "{} of {} hinges were unloaded on tier {tier}: {} windows, {:.0} s of one core",
            found.rows.len(),
            hinges.len(),
            found.windows,
            found.cpu_seconds
        );
        let fitted = found.rows.len().saturating_sub(UNSEEN);
        let (fitted, unseen) = found.rows.split_at(fitted);
        let law = Springback::fit(fitted, unseen, &material, &tier.to_string())?;
        let path = self.out.join("springback.json");
        law.save(&path)?;
        print!("{}", card(&law));
        println!("written to {}", path.display());
        Ok(())
    }
}

/// The errors of a law for a person.
fn card(law: &Springback) -> Document {
    let hinges = law.hinges;
    let mut page = Document::default();
    let Some(errors) = &law.errors else {
        page.text(format!("law of {hinges} hinges, whose errors are not known"));
        return page;
    };
    page.text(format!(
        "law of {hinges} hinges, at {} others with the forces of their windows (root mean squares):",
        errors.hinges
    ));
    let mut table = Table::new(["", "eta_a", "eta_s", "theta, deg"]);
    for (name, [a, s, theta]) in
        [("springs back", errors.sprung), ("error of the residual", errors.rest)]
    {
        let [a, s, theta] =
            [format!("{a:.4}"), format!("{s:.4}"), format!("{:.2}", theta.to_degrees())];
        table.row([name, &a, &s, &theta]);
    }
    page.table(table);
    page.text(format!("error of the stiffness about it: {:.1} %", 100.0 * errors.stiffness));
    page
}
