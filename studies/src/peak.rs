//! `kirigami-studies peak`: how far the measure of tearing, D_peak, depends on the mesh, and on the fraction of the
//! ligament that it averages over.
//!
//! The mean of the plastic strain over the most strained fraction f of the ligament's half-disc volume, (pi/2) w^2 t,
//! divided by the fracture strain. D_peak is f = 1 %. The strain of the single most strained integration point, f = 0,
//! grows without limit at a crease that becomes sharper with the mesh.

use crate::charts::{self, StudyPanel};
use anyhow::{Result, bail};
use clap::Args;
use fe_driver::{DeformationPath, KeptSolution, KeptSolve};
use hinge::{HingeConstants, HingeDeformation, HingeSample, SheetMaterial};
use kirigami::replays::kept_solves::{Outcome, SolveArgs};
use kirigami::replays::routes::window;
use kirigami::ui::{picture, run_folder};
use mesher::Tier;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write;
use std::path::PathBuf;

/// Measure how the peak strain depends on the mesh and on the volume that it averages over
///
/// Three hinges, cut at 90 degrees, are rotated by 60 degrees on every structured mesh. Writes peak.csv, peak.md
/// and a chart. Example: kirigami-studies peak --finest small
#[derive(Args)]
pub struct PeakStudy {
    /// Sheet material (TOML)
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/materials/pet-0.5mm.toml"
    )]
    material: PathBuf,
    /// Finest mesh tier, to which the others are compared
    #[arg(long, value_name = "TIER", default_value_t = Tier::Reference)]
    finest: Tier,
    /// Folder for the tables, the chart and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-peak")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

/// Ligament widths (mm).
const WIDTHS: [f64; 3] = [5.0, 18.0, 25.0];

/// Rotation at the end of the rays (deg).
const THETA_DEG: f64 = 60.0;

/// Rotations at which the measures are compared (deg).
const STATES_DEG: [f64; 6] = [10.0, 20.0, 30.0, 40.0, 50.0, 60.0];

/// What the measures of a hinge are relative to.
struct Ligament {
    /// Volume of the half-disc (pi/2) w^2 t (mm^3).
    volume: f64,
    fracture_strain: f64,
}

/// Name of a measure of the peak strain, and its value in a sample, over the fracture strain. All but the first two
/// are computed from the histogram of strains and have the error of its bins.
type Measure = (&'static str, fn(&HingeSample, &Ligament) -> f64);

const MEASURES: [Measure; 6] = [
    ("single point", |x, ligament| {
        x.strain_max.unwrap_or(f64::NAN) / ligament.fracture_strain
    }),
    ("1 %, exact", |x, _| x.d_peak.unwrap_or(f64::NAN)),
    ("0.3 %", |x, ligament| of_histogram(x, 0.003, ligament)),
    ("1 %", |x, ligament| of_histogram(x, 0.01, ligament)),
    ("3 %", |x, ligament| of_histogram(x, 0.03, ligament)),
    ("10 %", |x, ligament| of_histogram(x, 0.1, ligament)),
];

/// Mean strain of the most strained `fraction` of the ligament, over the fracture strain. Within a bin, volume is
/// taken as spread evenly over the strains.
fn of_histogram(x: &HingeSample, fraction: f64, ligament: &Ligament) -> f64 {
    let Some(histogram) = x.strain_volumes else {
        return f64::NAN;
    };
    let bins: Vec<_> = histogram.bins().collect();
    let volume = fraction * ligament.volume;
    let (mut left, mut sum) = (volume, 0.0);
    for (lower, upper, own) in bins.into_iter().rev().filter(|(.., own)| *own > 0.0) {
        let part = own.min(left);
        let upper = if upper.is_finite() { upper } else { lower };
        sum += part * (upper - 0.5 * part / own * (upper - lower));
        left -= part;
    }
    sum / volume / ligament.fracture_strain
}

/// A hinge on one mesh.
struct Rung {
    w_lig: f64,
    tier: Tier,
    solution: KeptSolution,
}

impl PeakStudy {
    pub fn run(&self) -> Result<()> {
        let material = SheetMaterial::load(&self.material)?;
        let _held = run_folder::hold(&self.out)?;
        let rungs = self.rungs(&material)?;
        run_folder::write(&self.out, "peak.csv", &csv(&rungs, &material))?;
        let page = self.page(&rungs, &material)?;
        run_folder::write(&self.out, "peak.md", &page)?;
        let chart = charts::studies(
            &self.panels(&rungs, &material),
            "rms difference from the finest, %",
        )?;
        picture::save(&chart, &self.out.join("peak"), 1600)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    fn rungs(&self, material: &SheetMaterial) -> Result<Vec<Rung>> {
        let tiers = Tier::ALL.into_iter().filter(|tier| *tier <= self.finest);
        let tiers: Vec<Tier> = tiers.filter(|tier| *tier != Tier::Paper).collect();
        let cases: Vec<(f64, Tier)> = WIDTHS
            .into_iter()
            .flat_map(|w_lig| tiers.iter().map(move |tier| (w_lig, *tier)))
            .collect();
        let end = HingeDeformation {
            theta: THETA_DEG.to_radians(),
            ..HingeDeformation::default()
        };
        let window = |(w_lig, tier): &(f64, Tier)| {
            let design = HingeConstants::PAPER.hinge(*w_lig, FRAC_PI_2);
            window(design, DeformationPath::straight(end), material, *tier)
        };
        let solves: Vec<KeptSolve> = cases.iter().map(window).collect();
        let outcomes = self
            .solve
            .solve(&solves.iter().collect::<Vec<_>>(), &self.out)?;
        let rung = |((w_lig, tier), outcome): ((f64, Tier), Outcome)| match outcome {
            Ok(solution) => Ok(Rung {
                w_lig,
                tier,
                solution,
            }),
            Err(reason) => bail!("the hinge of {w_lig} mm on {tier} was not solved: {reason}"),
        };
        cases.into_iter().zip(outcomes).map(rung).collect()
    }

    fn page(&self, rungs: &[Rung], material: &SheetMaterial) -> Result<String> {
        let names = MEASURES.map(|(name, _)| name).join(" | ");
        let mut page = format!(
            "# Peak strain and mesh\n\nMean plastic strain of the most strained fraction of the ligament's volume, over \
             the fracture strain, in pure rotations of {}. `1 %, exact` is D_peak; the other fractions are computed from \
             the histogram of strains, `single point` is the maximum over the integration points.\n",
            material.name
        );
        for w_lig in WIDTHS {
            write!(
                page,
                "\n## {w_lig} mm\n\n| tier | {names} |\n|---|{}\n",
                "---|".repeat(MEASURES.len())
            )?;
            let of_hinge = || rungs.iter().filter(|rung| rung.w_lig == w_lig);
            for rung in of_hinge() {
                let values = rung.measures(45.0, material).map(|v| format!("{v:.4}"));
                writeln!(
                    page,
                    "| {}, at 45 deg | {} |",
                    rung.tier,
                    values.join(" | ")
                )?;
            }
            let finest = of_hinge().next_back();
            for rung in of_hinge() {
                let off = finest.map_or([f64::NAN; 6], |finest| rung.off(finest, material));
                let off = off.map(|x| format!("{:.1} %", 100.0 * x));
                writeln!(
                    page,
                    "| {} against {}, rms to 60 deg | {} |",
                    rung.tier,
                    self.finest,
                    off.join(" | ")
                )?;
            }
        }
        Ok(page)
    }

    /// A panel for each measure, a line for each hinge.
    fn panels(&self, rungs: &[Rung], material: &SheetMaterial) -> Vec<StudyPanel> {
        let tiers: Vec<Tier> = rungs
            .iter()
            .filter(|rung| rung.w_lig == WIDTHS[0])
            .map(|rung| rung.tier)
            .collect();
        let panel = |(i, (title, _)): (usize, Measure)| StudyPanel {
            title,
            values: tiers.iter().map(Tier::to_string).collect(),
            lines: rungs
                .chunks(tiers.len())
                .map(|hinge| {
                    let off = |rung: &Rung| 100.0 * rung.off(&hinge[tiers.len() - 1], material)[i];
                    let points = hinge
                        .iter()
                        .enumerate()
                        .map(|(k, rung)| (k as f64, off(rung)));
                    (format!("{} mm", hinge[0].w_lig), points.collect())
                })
                .collect(),
        };
        MEASURES.into_iter().enumerate().map(panel).collect()
    }
}

/// One row per hinge, mesh, rotation and measure.
fn csv(rungs: &[Rung], material: &SheetMaterial) -> String {
    let mut text = "w_lig_mm,tier,theta_deg,measure,value\n".to_owned();
    for rung in rungs {
        for theta_deg in STATES_DEG {
            let values = rung.measures(theta_deg, material);
            for ((name, _), value) in MEASURES.iter().zip(values) {
                let Rung { w_lig, tier, .. } = rung;
                text += &format!("{w_lig},{tier},{theta_deg},\"{name}\",{value:.6}\n");
            }
        }
    }
    text
}

impl Rung {
    /// The measures at a rotation, interpolated between the samples.
    fn measures(&self, theta_deg: f64, material: &SheetMaterial) -> [f64; 6] {
        let ligament = Ligament {
            volume: 0.5 * PI * self.w_lig.powi(2) * material.thickness,
            fracture_strain: material.fracture_strain,
        };
        let samples = &self.solution.samples;
        let theta = theta_deg.to_radians().min(samples[samples.len() - 1].theta);
        let after = samples.partition_point(|x| x.theta < theta).max(1);
        let [x, y] = [&samples[after - 1], &samples[after]];
        let part = (theta - x.theta) / (y.theta - x.theta);
        MEASURES.map(|(_, measure)| {
            let [x, y] = [x, y].map(|sample| measure(sample, &ligament));
            x + part * (y - x)
        })
    }

    /// Root mean square of the differences from `finest`, relative to the root mean square of `finest`.
    fn off(&self, finest: &Rung, material: &SheetMaterial) -> [f64; 6] {
        let (mut off, mut all) = ([0.0; 6], [0.0; 6]);
        for theta_deg in STATES_DEG {
            let [x, y] = [self, finest].map(|rung| rung.measures(theta_deg, material));
            for i in 0..6 {
                off[i] += (x[i] - y[i]).powi(2);
                all[i] += y[i].powi(2);
            }
        }
        std::array::from_fn(|i| (off[i] / all[i]).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hinge::StrainVolumes;

    #[test]
    fn the_mean_of_a_histogram_is_within_a_bin_of_the_exact_one() {
        let points: Vec<(f64, f64)> = (1..=1000).map(|i| (1e-3 * f64::from(i), 1.0)).collect();
        let x = HingeSample {
            strain_volumes: Some(StrainVolumes::of(points)),
            ..HingeSample::default()
        };
        let ligament = Ligament {
            volume: 1000.0,
            fracture_strain: 2.0,
        };
        for (fraction, exact) in [(0.01, 0.9955), (0.1, 0.9505), (0.5, 0.7505), (1.0, 0.5005)] {
            let found = 2.0 * of_histogram(&x, fraction, &ligament);
            assert!((found / exact - 1.0).abs() < 0.03, "{fraction} {found}");
        }
        assert!(of_histogram(&HingeSample::default(), 0.01, &ligament).is_nan());
    }
}
