//! `kirigami dataset compare`: what a database is worth, beside a finer one of the same rays.

use crate::charts::{self, ParityChart};
use crate::picture;
use anyhow::{Context, Result, ensure};
use clap::Args;
use dataset::{COMPARED, ComparedRay, Database, compare, relative_rms};
use std::fmt::Write;
use std::path::PathBuf;
use train::ParityPoint;

/// Judge a database by a finer one of the same rays
///
/// Writes compare.md, compare.csv (one line a ray), tradeoff.md and a picture. Example: the default
/// tier by the reference tier, `kirigami dataset compare data/pet-0.5mm/hinges.parquet
/// data/pet-0.5mm/reference.parquet`
#[derive(Args)]
pub struct CompareCommand {
    /// The database that is judged (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// The database that it is judged by
    #[arg(value_name = "REFERENCE")]
    reference: PathBuf,
    /// Folder for the tables and the picture
    #[arg(long, value_name = "FOLDER", default_value = "runs/compare")]
    out: PathBuf,
}

/// Rays that are told one by one: those with the largest difference in W.
const WORST: usize = 8;

impl CompareCommand {
    pub fn run(&self) -> Result<()> {
        let judged = Database::read(&self.database)?;
        let reference = Database::read(&self.reference)?;
        let rays = compare(&judged, &reference);
        ensure!(
            !rays.is_empty(),
            "{} and {} have no ray in common",
            self.database.display(),
            self.reference.display()
        );
        std::fs::create_dir_all(&self.out)
            .with_context(|| format!("cannot make the folder {}", self.out.display()))?;
        let tiers = [&judged, &reference].map(|database| database.manifest().tier.clone());
        let summary = summary(&rays, &tiers)?;
        self.write("compare.csv", &csv(&rays)?)?;
        self.write("compare.md", &format!("{summary}{}", worst(&rays)?))?;
        self.write("tradeoff.md", &summary)?;
        let charts: Vec<_> = COMPARED
            .iter()
            .enumerate()
            .map(|(i, name)| (name, points(&rays, i)))
            .collect();
        let charts: Vec<_> = charts
            .iter()
            .map(|(name, points)| ParityChart {
                title: name.to_string(),
                points,
            })
            .collect();
        let axes = [tiers[1].as_str(), &tiers[0]];
        let picture = charts::parity(&charts, axes)?;
        picture::save(&picture, &self.out.join("compare"), 2000)?;
        println!("{summary}\nwritten to {}", self.out.display());
        Ok(())
    }

    fn write(&self, name: &str, text: &str) -> Result<()> {
        let path = self.out.join(name);
        std::fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))
    }
}

/// One line a quantity: the difference over all states, and how it is spread over the rays.
fn summary(rays: &[ComparedRay], [judged, reference]: &[String; 2]) -> Result<String> {
    let states = rays.iter().map(|ray| ray.states.len()).sum::<usize>();
    let cpu = [0, 1].map(|i| rays.iter().map(|ray| ray.cpu_s[i]).sum::<f64>() / rays.len() as f64);
    let mut text = format!(
        "## Tier {judged} by tier {reference}, over the whole box\n\n\
         {states} states of {} rays, {:.1} and {:.1} CPU s a ray. Differences are root mean squares relative \
         to that of the tier {reference}: over all states, and ray by ray. `kirigami dataset compare`.\n\n\
         | quantity | all states | median ray | 90 % of rays | worst ray |\n|---|---|---|---|---|\n",
        rays.len(),
        cpu[0],
        cpu[1],
    );
    let all = relative_rms(rays.iter().flat_map(|ray| &ray.states));
    let each: Vec<_> = rays.iter().map(|ray| relative_rms(&ray.states)).collect();
    for (i, name) in COMPARED.iter().enumerate() {
        let mut sorted: Vec<_> = each.iter().map(|ray| 100.0 * ray[i]).collect();
        sorted.sort_by(f64::total_cmp);
        let quantile = |share: f64| sorted[(share * (sorted.len() - 1) as f64).round() as usize];
        writeln!(
            text,
            "| {name} | {:.2} % | {:.2} % | {:.2} % | {:.2} % |",
            100.0 * all[i],
            quantile(0.5),
            quantile(0.9),
            quantile(1.0)
        )?;
    }
    Ok(text)
}

/// The rays that differ most in W.
fn worst(rays: &[ComparedRay]) -> Result<String> {
    let mut ranked: Vec<_> = rays
        .iter()
        .map(|ray| (relative_rms(&ray.states), ray))
        .collect();
    ranked.sort_by(|(x, _), (y, _)| y[0].total_cmp(&x[0]));
    let mut text = format!(
        "\nThe {} rays that differ most in W:\n\n| w_lig, mm | alpha, deg | eta_a | eta_s | theta, deg \
         | W, N mm | {} |\n|---|---|---|---|---|---|{}\n",
        WORST.min(ranked.len()),
        COMPARED.join(" | "),
        "---|".repeat(COMPARED.len())
    );
    for (differences, ray) in ranked.iter().take(WORST) {
        let [w_lig, alpha, eta_a, eta_s, theta] = place(ray);
        let differences = differences.map(|x| format!("{:.1} %", 100.0 * x));
        writeln!(
            text,
            "| {w_lig:.1} | {alpha:.0} | {eta_a:.2} | {eta_s:.2} | {theta:.0} | {:.1} | {} |",
            ray.end.sample.w,
            differences.join(" | ")
        )?;
    }
    Ok(text)
}

fn csv(rays: &[ComparedRay]) -> Result<String> {
    let mut text = format!(
        "w_lig_mm,alpha_deg,eta_a,eta_s,theta_deg,w_end_n_mm,cpu_s,reference_cpu_s,{}\n",
        COMPARED
            .map(|name| format!("difference_{name}"))
            .join(",")
            .to_lowercase()
    );
    for ray in rays {
        let place = place(ray).map(|x| format!("{x:.5}"));
        let differences = relative_rms(&ray.states).map(|x| format!("{x:.5}"));
        writeln!(
            text,
            "{},{:.4},{:.2},{:.2},{}",
            place.join(","),
            ray.end.sample.w,
            ray.cpu_s[0],
            ray.cpu_s[1],
            differences.join(",")
        )?;
    }
    Ok(text)
}

/// w_lig (mm), alpha (deg), and the end of a ray: eta_a, eta_s, theta (deg).
fn place(ray: &ComparedRay) -> [f64; 5] {
    let (design, sample) = (&ray.end.design, &ray.end.sample);
    let [eta_a, eta_s] = ray.end.eta();
    [
        design.w_lig,
        design.alpha.to_degrees(),
        eta_a,
        eta_s,
        sample.theta.to_degrees(),
    ]
}

fn points(rays: &[ComparedRay], quantity: usize) -> Vec<ParityPoint> {
    let states = rays.iter().flat_map(|ray| &ray.states);
    states
        .map(|state| ParityPoint {
            target: state.reference[quantity],
            predicted: state.value[quantity],
        })
        .collect()
}
