//! From a material file to weights of its hinge energy, with a known error.
//!
//! Rays of the campaign are solved in rounds, each with twice the rays of the one before. After
//! each round several weights of another material are fine-tuned on all rays. One network learns
//! these rays and, at random states, the median of the fine-tuned networks. It is tested at random
//! states of rays that no training contains.

mod conclusion;
mod fine_tuning;

use crate::{
    failure::Unfinished,
    new_project::{self, edited},
    progress::duration,
    run_folder,
    solves::{RayProgress, Solves, task_error},
};
use ::train::{ErrorInterval, TrainingConfig, check_pretrained};
use anyhow::{Context, Result, bail, ensure};
use conclusion::{MATERIAL, WEIGHTS, conclusion};
use dataset::{Database, Manifest, SplitPlan};
use fe_driver::{CalculiX, Campaign, random_paths};
use fine_tuning::FineTuning;
use hinge::{Regime, SheetMaterial, TrainingDomain};
use mesher::Tier;
use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};
use surrogate::Surrogate;
use toml_edit::{ArrayOfTables, DocumentMut};
use verification::{
    Accuracy, Learning, LearningEnd, LearningRound, LearningTask, distillation_states, spot_check,
};

/// Folders of the weights with which fine-tuning starts, and their names: networks of one training
/// with several seeds.
const FILM_PARENTS: &str = "data/pet-0.5mm";
const PLATE_PARENTS: &str = "data/polypropylene-3mm";
const PARENTS: [&str; 4] = ["medium", "medium-1", "medium-2", "medium-3"];
/// States on a ray of the spot check.
const STATES_PER_RAY: usize = 4;
/// Seed of these states.
const SPOT_SEED: u64 = 1;
/// The shipped training, and its copy in the folder. `kirigami init` writes another training to the
/// same folder.
const TRAINING_FILE: &str = "fine-tuning.toml";
const TRAINING: &str = include_str!("../../../configs/training/fine-tuning.toml");

/// What is learned, and how accurately.
pub struct MaterialLearning<'a> {
    /// The material (TOML).
    pub material: &'a Path,
    /// Weights of other materials, with which fine-tuning starts; the shipped ones if empty.
    pub from: &'a [PathBuf],
    /// The errors at which the weights are accurate enough.
    pub accuracy: Accuracy,
    /// No ray is started after this time.
    pub time: Duration,
    /// Mesh tier of the windows; `None` for the one of the thickness.
    pub tier: Option<Tier>,
    /// Number of rays of the first round.
    pub rays: usize,
    /// Number of rays of the spot check.
    pub spot_rays: usize,
    /// What solves them.
    pub solves: Solves<'a>,
    /// Folder of the results, which may hold a run that was stopped.
    pub out: &'a Path,
}

impl MaterialLearning<'_> {
    /// Solves rays and trains weights in rounds, until they are accurate enough. Prints every
    /// round; an error if they are not.
    pub fn run(&self) -> Result<()> {
        let began = Instant::now();
        let material = SheetMaterial::load(self.material)?;
        let tier = self.tier.unwrap_or(match Regime::usual(material.thickness) {
            Regime::Film => Tier::Default,
            Regime::Plate => Tier::Plate,
        });
        let from = match self.from {
            [] => shipped_parents(tier.regime()),
            named => named.to_vec(),
        };
        let loaded = from.iter().map(|file| Surrogate::load(file));
        let parents: Vec<Surrogate> = loaded.collect::<Result<_, _>>()?;
        let _held = run_folder::hold(self.out)?;
        self.write_inputs(&material, tier)?;
        let config: TrainingConfig = support::toml_file::read(&self.out.join(TRAINING_FILE))?;
        let config = config.with_sizes_of(&parents[0]);
        for (parent, file) in parents.iter().zip(&from) {
            ensure!(
                config.clone().with_sizes_of(parent) == config,
                "{}: its layers have other sizes than the layers of {}: all --from need the same",
                file.display(),
                from[0].display()
            );
            check_pretrained(parent, &config).with_context(|| format!("{}", file.display()))?;
        }
        let campaign = self.campaign(&material, tier)?;
        let region = campaign.region().context("the campaign has no region of rays")?;
        let fine_tuning = FineTuning {
            parents,
            config,
            distillation: distillation_states(campaign.drawn(&region)),
            fits: self.out.join("fits"),
            stop: self.solves.stop,
        };
        let spot = self.spot_check(&campaign, &region)?;
        let task = LearningTask {
            campaign: &campaign,
            folder: &self.out.join("campaign"),
            solver: &CalculiX::find()?,
            workers: self.solves.workers,
            first_rays: self.rays,
            spot: spot.rays(),
            accuracy: self.accuracy,
            deadline: began.checked_add(self.time),
            stop: self.solves.stop,
        };
        let learning = Learning::new(task)?;
        let (end, rounds, domain) = self.rounds(learning, &fine_tuning)?;
        let domains = (domain.as_ref(), &region);
        println!("{}", conclusion(rounds.last(), self.accuracy, self.out, domains));
        match end {
            LearningEnd::Accurate => {
                let took = duration(began.elapsed().as_secs_f64());
                println!("accurate enough after {took}");
                Ok(())
            }
            LearningEnd::Unfinished { left, what } => bail!(Unfinished { left, what }),
            LearningEnd::AllRays => bail!(
                "all {} rays of {} are solved, and the errors are above --accuracy or --forces, or too few states of \
                 the spot check are in the training domain: increase `count` there, or choose a finer tier",
                campaign.rays(),
                self.out.join("campaign.toml").display()
            ),
        }
    }

    /// Solves, trains and tests round after round. Returns why they ended, the rounds, and the
    /// training domain of the saved weights.
    fn rounds(
        &self,
        mut learning: Learning,
        fine_tuning: &FineTuning,
    ) -> Result<(LearningEnd, Vec<LearningRound>, Option<TrainingDomain>)> {
        let (mut rounds, mut domain) = (Vec::new(), None);
        loop {
            let mut bar: Option<RayProgress> = None;
            let solved = learning.solve(&mut |now| {
                let rays = now.tally.closed() + now.tally.to_run();
                bar.get_or_insert_with(|| RayProgress::new(rays)).show(now);
            })?;
            let (rays, database) = match solved {
                Ok(solved) => solved,
                Err(end) => return Ok((end, rounds, domain)),
            };
            if let Some(bar) = bar {
                bar.0.finish();
            }
            database.write(&self.out.join("hinges.parquet"), true)?;
            let (weights, training_s) = fine_tuning.network(rays, &database)?;
            let (round, weights) = learning.test(weights, training_s)?;
            if round.is_latest {
                weights.save(&self.out.join(WEIGHTS))?;
                domain = Some(weights.domain().clone());
            }
            rounds.push(round);
            let table = LearningRound::table(&rounds);
            println!("{table}\n");
            run_folder::write(self.out, "learn.csv", &table.csv())?;
        }
    }

    /// Writes material, campaign and training to a new folder. The files of a folder that is
    /// continued are kept.
    fn write_inputs(&self, material: &SheetMaterial, tier: Tier) -> Result<()> {
        if !self.out.join(TRAINING_FILE).exists() {
            run_folder::write(self.out, TRAINING_FILE, TRAINING)?;
        }
        if self.out.join("campaign.toml").exists() {
            return Ok(());
        }
        let name = self.out.file_name().unwrap_or_default().to_string_lossy();
        let text = new_project::material_text(self.material, material.thickness)?;
        run_folder::write(self.out, MATERIAL, &text)?;
        let mut campaign: DocumentMut =
            new_project::campaign(&name, material.thickness, tier.regime())?.parse()?;
        edited::set(&mut campaign["tier"], tier.to_string());
        // The rounds have one mesh, and a spot check and trainings of their own.
        for key in ["finer_tier", "spot_rays", "training"] {
            campaign.remove(key);
        }
        let boxes = campaign["rays"].as_array_of_tables_mut();
        for rays in boxes.into_iter().flat_map(ArrayOfTables::iter_mut) {
            rays.remove("finer");
        }
        run_folder::write(self.out, "campaign.toml", &campaign.to_string())
    }

    /// The campaign of the folder, which must have the same material and tier.
    fn campaign(&self, material: &SheetMaterial, tier: Tier) -> Result<Campaign> {
        let campaign = Campaign::load(&self.out.join("campaign.toml"))?;
        let (out, given) = (self.out.display(), self.material.display());
        ensure!(
            campaign.material.law_hash() == material.law_hash(),
            "{out} is of another material law than {given}: choose another folder with --out"
        );
        ensure!(
            campaign.tier == tier,
            "{out} is solved on tier {}: pass --tier {}, or choose another folder with --out",
            campaign.tier,
            campaign.tier
        );
        Ok(campaign)
    }

    /// The states on which weights are tested, drawn uniformly inside the region of the campaign.
    fn spot_check(&self, campaign: &Campaign, region: &TrainingDomain) -> Result<Database> {
        let count = STATES_PER_RAY * self.spot_rays;
        let paths = random_paths(campaign.drawn(region), count, STATES_PER_RAY, SPOT_SEED);
        let mut windows = self.solves.service(&self.out.join("spot-check"))?;
        windows.limit = campaign.time_limit;
        let check = spot_check(&windows, &paths, &campaign.material, campaign.tier);
        let check = check.map_err(task_error)?;
        for unsolved in &check.unsolved {
            println!("not solved: {unsolved}");
        }
        let database = Database::collect(check.rays, &SplitPlan::default())
            .context("the solver followed too few rays of the spot check: increase --spot-rays")?;
        let Manifest { rays, rows, cpu_s, .. } = database.manifest();
        ensure!(
            *rays >= ErrorInterval::LEAST_RAYS,
            "{rows} states on {rays} rays are too few to assess weights, which need {} rays: increase --spot-rays",
            ErrorInterval::LEAST_RAYS
        );
        database.write(&self.out.join("spot-check.parquet"), true)?;
        println!(
            "spot check: {} rays, {rows} of {count} states on rays followed to their end, {cpu_s:.0} s of CPU time",
            paths.len()
        );
        Ok(database)
    }
}

/// The shipped weights of a regime with which fine-tuning starts.
fn shipped_parents(regime: Regime) -> Vec<PathBuf> {
    let folder = Path::new(match regime {
        Regime::Film => FILM_PARENTS,
        Regime::Plate => PLATE_PARENTS,
    });
    let file = |name: &str| folder.join(name).with_extension("safetensors");
    PARENTS.map(file).to_vec()
}
