//! `kirigami material learn`: from a material file to weights of its hinge energy, with a known error.
//!
//! Rays of the campaign are solved in rounds, each with twice the rays of the one before. After each round several weights
//! of another material are fine-tuned on all rays. One network learns these rays and, at random states, the median of
//! the fine-tuned networks. It is tested at random states of rays that no training contains.

mod fine_tuning;
mod options;
mod region;
mod round;

use crate::commands::campaign::{collected, refuse_unfinished, solve_rays};
use crate::commands::init;
use crate::commands::material::learn::fine_tuning::FineTuning;
use crate::commands::material::learn::options::{percent, time};
use crate::commands::material::learn::region::{region, taught};
use crate::commands::material::learn::round::{HEADING, Round, csv};
use crate::replays::kept_solves::SolveArgs;
use crate::replays::spot_states::{self, Solved};
use crate::ui::exit::Unfinished;
use crate::ui::progress::duration;
use crate::ui::run_folder;
use ::train::{Backend, TrainingConfig, check_pretrained};
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use dataset::{Database, Gates, SplitPlan};
use fe_driver::{Campaign, RunOptions, Shard};
use hinge::{SheetMaterial, TrainingDomain};
use mesher::Tier;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use surrogate::Surrogate;

/// Solve hinge windows of a material and train its weights until they are accurate enough
///
/// Starts from weights of another material and solves rays in rounds: 25, 50, 100, ... After each round the weights are
/// fine-tuned, and one network learns the rays and the median of the fine-tuned networks. This network is compared with a spot
/// check: windows at random states of the campaign's region, never trained on. Stops when the root mean square errors of W
/// and of the forces there are small enough, or at the time limit (exit code 75: the same command continues). The folder
/// holds weights.safetensors, the database, the spot check, learn.csv, and the campaign and training that can be edited.
/// Example:
/// kirigami material learn configs/materials/polypropylene-0.8mm.toml --accuracy 1% --time 1h --out runs/polypropylene
#[derive(Args)]
pub struct LearnCommand {
    /// Material (TOML), as written by `material fit`
    #[arg(value_name = "MATERIAL")]
    material: PathBuf,
    /// Weights of another material, with which fine-tuning starts; once for each file. Several together have smaller errors
    /// than each. One alone is fine-tuned and kept
    #[arg(long, value_name = "WEIGHTS", default_values = PARENTS)]
    from: Vec<PathBuf>,
    /// Error of W at which the weights are accurate enough, relative to its root mean square
    #[arg(long, value_name = "PERCENT", default_value = "1%", value_parser = percent)]
    accuracy: f64,
    /// The same of the forces: root mean square of the errors of F_a, F_s and M
    #[arg(long, value_name = "PERCENT", default_value = "5%", value_parser = percent)]
    forces: f64,
    /// Start no ray after this time, with its unit: h, min or s; the spot check, running solves and trainings are finished
    #[arg(long, value_name = "TIME", default_value = "1h", value_parser = time)]
    time: Duration,
    /// Mesh tier of the windows
    #[arg(long, value_name = "TIER", default_value_t = Tier::Default)]
    tier: Tier,
    /// Number of rays of the first round
    #[arg(long, value_name = "N", default_value_t = 25, value_parser = clap::value_parser!(u16).range(6..))]
    rays: u16,
    /// Number of rays of the spot check, each with 4 states
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u16).range(3..))]
    spot_rays: u16,
    /// Seed of the states of the spot check. Errors that led to a choice are measured again with another seed
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    spot_seed: u64,
    /// Number of solves in parallel [default: one per processor]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
    /// Folder for the results; a folder of a stopped run is continued. Its weights are those of the last round of this command
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
}

/// Weights with which fine-tuning starts: networks of one training with several seeds.
const PARENTS: [&str; 4] = [
    "data/pet-0.5mm/medium.safetensors",
    "data/pet-0.5mm/medium-1.safetensors",
    "data/pet-0.5mm/medium-2.safetensors",
    "data/pet-0.5mm/medium-3.safetensors",
];
/// States on a ray of the spot check.
const STATES_PER_RAY: usize = 4;
/// The shipped training, and its copy in the folder. `kirigami init` writes another training to the same folder.
const TRAINING_FILE: &str = "fine-tuning.toml";
const TRAINING: &str = include_str!("../../../configs/training/fine-tuning.toml");

impl LearnCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let began = Instant::now();
        let material = SheetMaterial::load(&self.material)?;
        let loaded = self.from.iter().map(|file| Surrogate::load(file));
        let parents: Vec<Surrogate> = loaded.collect::<Result<_, _>>()?;
        let _held = run_folder::hold(&self.out)?;
        self.write_inputs(&material)?;
        let config: TrainingConfig = support::toml_file::read(&self.out.join(TRAINING_FILE))?;
        let config = config.with_sizes_of(&parents[0]);
        for (parent, file) in parents.iter().zip(&self.from) {
            ensure!(
                config.clone().with_sizes_of(parent) == config,
                "{}: its layers have other sizes than those of {}: all --from need the same",
                file.display(),
                self.from[0].display()
            );
            check_pretrained(parent, &config, Backend::default())
                .with_context(|| format!("{}", file.display()))?;
        }
        let campaign = self.campaign(&material)?;
        let fits = self.out.join("fits");
        let region = region(&campaign).context("the campaign has no region of rays")?;
        let fine_tuning = FineTuning {
            parents,
            config,
            taught: taught(&region, &campaign.design),
            fits,
        };
        let spot = self.spot_check(&campaign, &region)?;
        let solved = self.solved_before()?;
        println!("{HEADING}");
        let mut rounds: Vec<Round> = Vec::new();
        let mut counts = counts(usize::from(self.rays), campaign.count).peekable();
        while let Some(rays) = counts.next() {
            let left = self.time.saturating_sub(began.elapsed());
            let (round, weights) = self.round(rays, &campaign, &fine_tuning, &spot, left)?;
            println!("{round}");
            rounds.push(round);
            run_folder::write(&self.out, "learn.csv", &csv(&rounds)?)?;
            // The weights are those of all rays that an earlier command has solved.
            if counts.peek().is_some_and(|next| *next <= solved) {
                continue;
            }
            weights.save(&self.weights())?;
            if round.is_within(self.accuracy, self.forces) {
                println!(
                    "accurate enough after {}; weights written to {}",
                    duration(began.elapsed().as_secs_f64()),
                    self.weights().display()
                );
                return Ok(());
            }
            if let Some(next) = counts.peek()
                && began.elapsed() >= self.time
            {
                bail!(Unfinished::new(next - rays, "rays of the next round"));
            }
        }
        bail!(
            "all {} rays of {} are solved, and the errors are above --accuracy or --forces: increase `count` there, \
             or choose a finer tier",
            campaign.count,
            self.out.join("campaign.toml").display()
        )
    }

    /// Number of rays that earlier commands have solved.
    fn solved_before(&self) -> Result<usize> {
        let jobs = self.jobs();
        match jobs.exists() {
            true => Ok(fe_driver::status(&jobs)?.tally.closed()),
            false => Ok(0),
        }
    }

    /// The folder of the rays.
    fn jobs(&self) -> PathBuf {
        self.out.join("campaign")
    }

    fn weights(&self) -> PathBuf {
        self.out.join("weights.safetensors")
    }

    /// Writes material, campaign and training to a new folder. Those of a folder that is continued are kept.
    fn write_inputs(&self, material: &SheetMaterial) -> Result<()> {
        if !self.out.join(TRAINING_FILE).exists() {
            run_folder::write(&self.out, TRAINING_FILE, TRAINING)?;
        }
        if self.out.join("campaign.toml").exists() {
            return Ok(());
        }
        let name = self.out.file_name().unwrap_or_default().to_string_lossy();
        let text = init::material_text(&self.material)?;
        run_folder::write(&self.out, "material.toml", &text)?;
        let campaign = init::campaign(&name, material.thickness, self.tier)?;
        run_folder::write(&self.out, "campaign.toml", &campaign)
    }

    /// The campaign of the folder, which must be that of the material and the tier.
    fn campaign(&self, material: &SheetMaterial) -> Result<Campaign> {
        let campaign = Campaign::load(&self.out.join("campaign.toml"))?;
        let (out, given) = (self.out.display(), self.material.display());
        ensure!(
            campaign.material.law_hash() == material.law_hash(),
            "{out} is of another material law than {given}: choose another folder with --out"
        );
        ensure!(
            campaign.tier == self.tier,
            "{out} is solved on tier {}: pass --tier {}, or choose another folder with --out",
            campaign.tier,
            campaign.tier
        );
        Ok(campaign)
    }

    /// The states on which weights are tested, drawn uniformly inside the region of the campaign.
    fn spot_check(&self, campaign: &Campaign, region: &TrainingDomain) -> Result<Database> {
        let count = STATES_PER_RAY * usize::from(self.spot_rays);
        let (design, seed) = (&campaign.design, self.spot_seed);
        let probes = spot_states::drawn(region, design, count, STATES_PER_RAY, seed);
        let solve = SolveArgs::new(self.jobs, campaign.time_limit);
        let folder = self.out.join("spot-check");
        let Solved {
            rows, cpu_seconds, ..
        } = spot_states::solve(&probes, &campaign.material, campaign.tier, &solve, &folder)?;
        let states = rows.len();
        let database = Database::collect(rows, &Gates::default(), &SplitPlan::default())
            .context("the solver followed too few rays of the spot check: increase --spot-rays")?;
        database.write(&self.out.join("spot-check.parquet"), true)?;
        println!(
            "spot check: {} rays, {states} of {count} states on rays followed to their end, {cpu_seconds:.0} s of CPU time",
            probes.len()
        );
        Ok(database)
    }

    /// Solves the first `rays` rays of the campaign, fine-tunes and tests; the round and its weights.
    fn round(
        &self,
        rays: usize,
        campaign: &Campaign,
        fine_tuning: &FineTuning,
        spot: &Database,
        time_limit: Duration,
    ) -> Result<(Round, Surrogate)> {
        let jobs = self.jobs();
        let options = RunOptions {
            shard: Shard::WHOLE,
            workers: SolveArgs::new(self.jobs, campaign.time_limit).workers(),
            time_limit: Some(time_limit),
        };
        let first = Campaign {
            count: rays,
            ..campaign.clone()
        };
        let tally = solve_rays(&first, &jobs, &options)?;
        refuse_unfinished(&tally, &jobs).map_err(|error| match error.downcast::<Unfinished>() {
            Ok(Unfinished { left, .. }) => Unfinished::new(left, "rays of this round").into(),
            Err(error) => error,
        })?;
        let database = collected(&jobs)?;
        database.write(&self.out.join("hinges.parquet"), true)?;
        let (weights, training_s) = fine_tuning.network(rays, &database)?;
        let round = Round::new(&tally, &weights, training_s, spot.rows());
        let weights = weights.with_spot_check(round.errors(), round.inside());
        Ok((round, weights))
    }
}

/// Numbers of rays of the rounds: each twice the one before, the last with all.
fn counts(first: usize, all: usize) -> impl Iterator<Item = usize> {
    let doubled = std::iter::successors(Some(first), |count| Some(2 * count));
    doubled
        .take_while(move |count| *count < all)
        .chain(std::iter::once(all))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_double_and_end_with_all_rays() {
        let all = |first, all| counts(first, all).collect::<Vec<_>>();
        assert_eq!(all(25, 160), [25, 50, 100, 160]);
        assert_eq!(all(25, 50), [25, 50]);
        assert_eq!(all(25, 6), [6]);
    }
}
