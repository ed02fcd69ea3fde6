//! `kirigami-studies universal`: one hinge energy for a family of hardening laws.
//!
//! A window has no other lengths than those of the hinge and the thickness t, and no other stresses than those of the
//! law, so that W / (E t^3) depends on (w_lig / t, alpha, eta_a, eta_s, theta), on the law over E, and on Poisson's ratio.

mod cases;
mod family_rays;
mod family_table;
mod judgement;
mod law;
mod split_of_laws;
mod states;
mod three_numbers;
mod trial;
mod universal_page;

use crate::charts;
use crate::universal::cases::{Case, Material, Measured, Network, TEST, VALIDATION, Way, inputs};
use crate::universal::family_rays::{FamilyRay, family_rays, family_sheet};
use crate::universal::family_table::SolvedRay;
use crate::universal::judgement::Errors;
use crate::universal::split_of_laws::SplitOfLaws;
use crate::universal::states::Film;
use crate::universal::trial::Trial;
use ::train::TrainingConfig;
use anyhow::{Context, Result, ensure};
use clap::Args;
use dataset::SplitPlan;
use fe_driver::{Campaign, KeptSolve};
use hinge::SheetMaterial;
use kirigami::replays::kept_solves::SolveArgs;
use kirigami::ui::{interrupt, picture, run_folder};
use mesher::Tier;
use std::path::{Path, PathBuf};
use surrogate::Surrogate;

/// Train one hinge energy over a family of hardening laws, and test it on materials that it has not seen
///
/// The laws have Poisson's ratio and three numbers of the hardening: yield strain, plateau and hardening modulus, the latter
/// two over yield stress and E. With --solve, the rays are solved, one law each, and stored in --folder; rays that are there
/// already are kept, and a stopped command continues. Without it, networks are trained on the stored rays and tested on
/// laws that are held out, on the film, on steel and on polypropylene, with no ray and with few rays of these. Writes
/// universal.csv, universal.md and a chart. Examples:
/// kirigami-studies universal --solve 300
/// kirigami-studies universal --out docs/results/universal
#[derive(Args)]
pub struct UniversalStudy {
    /// Solve the first N rays of the family, and the windows of three-numbers.md, instead of training
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    solve: Option<u64>,
    /// Folder of the tables of the solved rays, one for each tier (default.parquet)
    #[arg(long, value_name = "FOLDER", default_value = "data/universal")]
    folder: PathBuf,
    /// Number of rays for three-numbers.md, 0 for none
    #[arg(long, value_name = "N", default_value_t = 4)]
    three_numbers: usize,
    /// Campaign whose region, E and thickness the family has
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/campaigns/pet-0.5mm.toml"
    )]
    campaign: PathBuf,
    /// Mesh tier of the windows
    #[arg(long, value_name = "TIER", default_value_t = Tier::Default)]
    tier: Tier,
    /// Weights of the film
    #[arg(
        long,
        value_name = "WEIGHTS",
        default_value = "data/pet-0.5mm/medium.safetensors"
    )]
    film: PathBuf,
    /// Training configuration of the networks of the family
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/training/small.toml"
    )]
    training: PathBuf,
    /// Number of epochs of the networks of the family, chosen on laws held out
    #[arg(long, value_name = "N", default_value_t = 100)]
    epochs: usize,
    /// Training configuration for fine-tuning
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/training/fine-tuning.toml"
    )]
    tuned: PathBuf,
    /// Number of splits into laws and geometries for training and for testing
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u64).range(1..=64))]
    splits: u64,
    /// Folder for the tables, the chart, solutions and fits
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-universal")]
    out: PathBuf,
    #[command(flatten)]
    solve_args: SolveArgs,
}

/// Materials on which the networks are tested, with their solved rays.
const MATERIALS: [(&str, &str); 3] = [
    (
        "configs/materials/pet-0.5mm.toml",
        "data/pet-0.5mm/region.parquet",
    ),
    (
        "configs/materials/s235-1.5mm.toml",
        "data/s235-1.5mm/hinges.parquet",
    ),
    (
        "configs/materials/polypropylene-0.8mm.toml",
        "data/polypropylene-0.8mm/hinges.parquet",
    ),
];

impl UniversalStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let campaign = Campaign::load(&self.campaign)?;
        let film = Film {
            weights: Surrogate::load(&self.film)?,
            sheet: campaign.material.clone(),
        };
        match self.solve {
            Some(count) => self.solve_rays(&campaign, &film, count as usize),
            None => self.judge(&film),
        }
    }

    /// The table of the solved rays.
    fn table(&self) -> PathBuf {
        self.folder.join(format!("{}.parquet", self.tier))
    }

    fn solve_rays(&self, campaign: &Campaign, film: &Film, count: usize) -> Result<()> {
        let sheet = family_sheet(campaign);
        let rays = family_rays(campaign, count);
        let mut solved = self.kept_rays(&rays, film)?;
        let is_new = |ray: &&FamilyRay| solved.iter().all(|it| it.index != ray.index);
        let new: Vec<&FamilyRay> = rays.iter().filter(is_new).collect();
        let windows: Vec<KeptSolve> = (new.iter())
            .map(|ray| ray.window(&ray.law.material(&sheet), self.tier))
            .collect();
        let windows: Vec<&KeptSolve> = windows.iter().collect();
        let outcomes = self.solve_args.solve(&windows, &self.out)?;
        solved.extend(new.iter().zip(&outcomes).filter_map(|(ray, outcome)| {
            let solution = outcome.as_ref().ok()?;
            Some(SolvedRay::new(ray, solution, &sheet, film))
        }));
        ensure!(!solved.is_empty(), "no ray reached its end");
        solved.sort_by_key(|ray| ray.index);
        std::fs::create_dir_all(&self.folder)
            .with_context(|| format!("cannot create the folder {}", self.folder.display()))?;
        family_table::write(&self.table(), &solved)?;
        let cpu_seconds: f64 = solved.iter().map(|ray| ray.cpu_seconds).sum();
        println!(
            "{} rays, {cpu_seconds:.0} CPU s: {}",
            solved.len(),
            self.table().display()
        );
        if self.three_numbers == 0 {
            return Ok(());
        }
        let rays = &rays[..self.three_numbers.min(rays.len())];
        let materials: Vec<SheetMaterial> = MATERIALS
            .iter()
            .map(|(file, _)| SheetMaterial::load(Path::new(file)))
            .collect::<Result<_, _>>()?;
        let args = &self.solve_args;
        let page = three_numbers::page(rays, &materials, &sheet, self.tier, args, &self.out)?;
        run_folder::write(&self.out, "three-numbers.md", &page)?;
        print!("{page}");
        Ok(())
    }

    /// The rays of the table that is continued, none if there is no table.
    fn kept_rays(&self, rays: &[FamilyRay], film: &Film) -> Result<Vec<SolvedRay>> {
        let table = self.table();
        if !table.exists() {
            return Ok(Vec::new());
        }
        let kept = family_table::read(&table, film)?;
        for solved in &kept {
            let ray = rays.get(solved.index);
            ensure!(
                ray.is_none_or(|ray| solved.is_of(ray, &film.sheet)),
                "ray {} of {} is another than that of the family: choose another --folder",
                solved.index,
                table.display()
            );
        }
        Ok(kept)
    }

    fn judge(&self, film: &Film) -> Result<()> {
        let read = |path| support::toml_file::read::<TrainingConfig>(path);
        let (training, tuned) = (read(&self.training)?, read(&self.tuned)?);
        let rays = family_table::read(&self.table(), film)?;
        let materials: Vec<Material> = MATERIALS
            .iter()
            .map(|(file, rays)| Material::read(Path::new(file), Path::new(rays), film))
            .collect::<Result<_>>()?;
        let stop = interrupt::stop_flag()?;
        let mut measured = Measured::new();
        for seed in 0..self.splits {
            let split = SplitOfLaws::new(&rays, seed);
            let config = TrainingConfig {
                seed,
                mirror: false,
                epochs: self.epochs,
                ..training.clone()
            };
            split.run(&config, &materials, &film.sheet.name, stop, &mut measured)?;
            for material in &materials {
                let plan = SplitPlan {
                    seed,
                    validation: VALIDATION,
                    test: TEST,
                };
                let of_all = split.with_others(&config, material, &materials, stop)?;
                let case = Case {
                    target: material.sheet.name.clone(),
                    way: Way::Family(Network::WorksOfAll),
                    laws: split.training.len(),
                    own_rays: 0,
                };
                let errors = Errors::of(&material.states, &of_all.at(&inputs(&material.states))?);
                measured.entry(case).or_default().push(errors);
                let trial = Trial {
                    material,
                    database: material.database.split(&plan)?,
                    film,
                    energy: &of_all,
                    tuned: &tuned,
                    fits: self.out.join("fits"),
                };
                trial.run(seed, stop, &mut measured)?;
            }
            self.write(&rays, &materials, &measured)?;
        }
        println!("see {}", self.out.join("universal.md").display());
        Ok(())
    }

    fn write(&self, rays: &[SolvedRay], materials: &[Material], measured: &Measured) -> Result<()> {
        let write = |name: &str, text: &str| run_folder::write(&self.out, name, text);
        write("universal.csv", &universal_page::csv(measured))?;
        let page = universal_page::markdown(rays, materials, measured, self.splits);
        write("universal.md", &page)?;
        let chart = charts::against_rays(&universal_page::curves(measured))?;
        picture::save(&chart, &self.out.join("universal"), 1600)?;
        Ok(())
    }
}
