//! `kirigami-studies universal`: one hinge energy for a family of hardening laws.
//!
//! A window has no other lengths than those of the hinge and the thickness t, and no other stresses than those of the
//! law, so that W / (E t^3) depends on (w_lig / t, alpha, eta_a, eta_s, theta), on the law over E, and on Poisson's ratio.

mod causes;
mod family_rays;
mod family_table;
mod judgement;
mod law;
mod states;
mod universal_page;

use crate::charts;
use crate::universal::family_rays::{FamilyRay, family_rays, family_sheet};
use crate::universal::family_table::SolvedRay;
use crate::universal::judgement::{Errors, best_factor, scaled};
use crate::universal::states::{Film, SolvedState, training_data};
use ::train::{EnergySlopes, LawEnergy, LawForm, LawState, TrainingConfig};
use anyhow::{Context, Result, ensure};
use clap::Args;
use dataset::{Database, Part, Row, SplitPlan};
use fe_driver::{Campaign, KeptSolve};
use hinge::SheetMaterial;
use kirigami::commands::train::kept_fit;
use kirigami::replays::kept_solves::{Outcome, SolveArgs};
use kirigami::ui::{interrupt, picture, run_folder};
use mesher::Tier;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use surrogate::Surrogate;

/// Train one hinge energy over a family of hardening laws, and test it on materials that it has not seen
///
/// The laws have three numbers: yield strain, plateau and hardening modulus, the latter two over yield stress and E. With
/// --solve, the rays are solved, one law each, and stored in --rays. A stopped command continues. Without it, networks
/// are trained on the stored rays and tested on laws that are held out, on the film, on steel and on polypropylene, with
/// no ray and with few rays of these. Writes universal.csv, universal.md and a chart. Examples:
/// kirigami-studies universal --solve 200
/// kirigami-studies universal --out docs/results/universal
#[derive(Args)]
pub struct UniversalStudy {
    /// Solve the first N rays of the family, and the windows of causes.md, instead of training
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    solve: Option<u64>,
    /// Table of the solved rays (Parquet)
    #[arg(
        long,
        value_name = "FILE",
        default_value = "data/universal/rays.parquet"
    )]
    rays: PathBuf,
    /// Number of rays for causes.md, 0 for none
    #[arg(long, value_name = "N", default_value_t = 4)]
    causes: usize,
    /// Campaign whose region, E and thickness the family has
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/campaigns/pet-0.5mm.toml"
    )]
    campaign: PathBuf,
    /// Mesh tier of the windows
    #[arg(long, value_name = "TIER", default_value_t = Tier::Small)]
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
    #[arg(long, value_name = "N", default_value_t = 200)]
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

/// Numbers of rays of the family in training; all that are not held out are added.
const LAWS: [usize; 2] = [20, 40];
/// Number of rays of each other material in training.
const OTHER_RAYS: usize = 100;
/// Numbers of rays of a material.
const OWN_RAYS: [usize; 3] = [10, 25, 50];
/// Fraction of the laws that is held out, and fractions of the geometries of a material.
const TEST: f64 = 0.2;
const VALIDATION: f64 = 0.1;
/// States of a ray of the family that are trained on.
const STATES_OF_RAY: usize = 16;

/// What the networks are tested on when the laws are held out.
const HELD_OUT: &str = "laws held out";

/// A network of the family.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Network {
    /// The three numbers of the law are features.
    Numbers,
    /// The same; a factor of the film's energy.
    TimesFilm,
    /// The works of the law are multiplied by weights that depend on the hinge alone.
    Works,
    /// The same, trained also on rays of the other materials.
    WorksOfAll,
    /// The film's energy times ratios of works, with such weights.
    WorksTimesFilm,
}

/// The networks that are trained on the family alone.
const NETWORKS: [Network; 4] = [
    Network::Numbers,
    Network::TimesFilm,
    Network::Works,
    Network::WorksTimesFilm,
];

/// A way to the energy of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Way {
    /// The film's, over E t^3.
    Film,
    Family(Network),
    /// The film's times a factor of the material's rays.
    FilmTimes,
    /// A network times a factor of the material's rays.
    FamilyTimes(Network),
    /// A network, fine-tuned on the material's rays.
    FamilyTuned(Network),
    /// The film's weights, fine-tuned on the material's rays.
    FilmTuned,
}

/// A material with its solved rays.
struct Material {
    sheet: SheetMaterial,
    database: Database,
    states: Vec<SolvedState>,
}

/// What was measured: on what, which way, with how many rays of the family and of the material.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Case {
    target: String,
    way: Way,
    laws: usize,
    own_rays: usize,
}

/// The errors of each case, one for each split.
type Measured = BTreeMap<Case, Vec<Errors>>;

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

    fn solve_rays(&self, campaign: &Campaign, film: &Film, count: usize) -> Result<()> {
        let sheet = family_sheet(campaign);
        let rays = family_rays(campaign, count);
        let windows: Vec<KeptSolve> = rays
            .iter()
            .map(|ray| ray.window(&ray.law.material(&sheet), self.tier))
            .collect();
        let windows: Vec<&KeptSolve> = windows.iter().collect();
        let outcomes = self.solve_args.solve(&windows, &self.out)?;
        let solved = solved_rays(&rays, &outcomes, &sheet, film);
        ensure!(!solved.is_empty(), "no ray reached its end");
        if let Some(folder) = self.rays.parent() {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("cannot create the folder {}", folder.display()))?;
        }
        family_table::write(&self.rays, &solved)?;
        let cpu_seconds: f64 = solved.iter().map(|ray| ray.cpu_seconds).sum();
        println!(
            "{} of {count} rays reached their ends, {cpu_seconds:.0} CPU s: {}",
            solved.len(),
            self.rays.display()
        );
        if self.causes == 0 {
            return Ok(());
        }
        let rays = &rays[..self.causes.min(rays.len())];
        let materials: Vec<SheetMaterial> = MATERIALS
            .iter()
            .map(|(file, _)| SheetMaterial::load(Path::new(file)))
            .collect::<Result<_, _>>()?;
        let args = &self.solve_args;
        let page = causes::page(rays, &materials, &sheet, self.tier, args, &self.out)?;
        run_folder::write(&self.out, "causes.md", &page)?;
        print!("{page}");
        Ok(())
    }

    fn judge(&self, film: &Film) -> Result<()> {
        let read = |path| support::toml_file::read::<TrainingConfig>(path);
        let (training, tuned) = (read(&self.training)?, read(&self.tuned)?);
        let rays = family_table::read(&self.rays, film)?;
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
            let of_film = split.run(&config, &materials, &film.sheet.name, stop, &mut measured)?;
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
                let (network, energy) = match material.sheet.name == film.sheet.name {
                    true => (Network::WorksOfAll, &of_all),
                    false => (Network::WorksTimesFilm, &of_film),
                };
                let trial = Trial {
                    material,
                    database: material.database.split(&plan)?,
                    film,
                    network,
                    energy,
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

/// The rays that reached their ends.
fn solved_rays(
    rays: &[FamilyRay],
    outcomes: &[Outcome],
    sheet: &SheetMaterial,
    film: &Film,
) -> Vec<SolvedRay> {
    let solved = rays.iter().zip(outcomes).enumerate();
    let solved = solved.filter_map(|(index, (ray, outcome))| {
        let solution = outcome.as_ref().ok()?;
        let state = |sample| SolvedState::new(&ray.ray.design, sample, sheet, ray.law, film);
        Some(SolvedRay {
            index,
            cpu_seconds: solution.cpu_seconds.unwrap_or(0.0),
            states: solution.samples.iter().map(state).collect(),
        })
    });
    solved.collect()
}

/// Laws for training, in the order of the family, and laws that are held out.
struct SplitOfLaws<'a> {
    training: Vec<&'a SolvedRay>,
    held_out: Vec<SolvedState>,
}

impl<'a> SplitOfLaws<'a> {
    fn new(rays: &'a [SolvedRay], seed: u64) -> Self {
        let mut order: Vec<&SolvedRay> = rays.iter().collect();
        order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
        let (held_out, training) = order.split_at((TEST * rays.len() as f64).ceil() as usize);
        let mut training = training.to_vec();
        training.sort_by_key(|ray| ray.index);
        let held_out = held_out.iter().flat_map(|ray| ray.states.clone());
        Self {
            training,
            held_out: held_out.collect(),
        }
    }

    /// The states of the first `laws` rays.
    fn states(&self, laws: usize) -> impl Iterator<Item = &SolvedState> {
        let rays = self.training[..laws].iter();
        rays.flat_map(|ray| thinned(&ray.states))
    }

    /// Trains networks on the family alone, and tests them on the laws held out and on the materials. Returns the last one
    /// of [`NETWORKS`], trained on all laws of the split.
    fn run(
        &self,
        config: &TrainingConfig,
        materials: &[Material],
        film: &str,
        stop: &AtomicBool,
        measured: &mut Measured,
    ) -> Result<LawEnergy> {
        let mut last = None;
        for laws in counts(&LAWS, self.training.len()) {
            let data = training_data(self.states(laws));
            for network in NETWORKS {
                refuse_stop(stop)?;
                eprintln!("split {}, {laws} laws, {network:?}", config.seed);
                let energy = LawEnergy::fit(&data, network.form(), config, None)?;
                let targets = materials.iter();
                let targets = targets.map(|it| (it.sheet.name.as_str(), &it.states));
                let targets = targets.filter(|(name, _)| *name != film || !network.knows_film());
                for (target, states) in targets.chain([(HELD_OUT, &self.held_out)]) {
                    let case = Case {
                        target: target.into(),
                        way: Way::Family(network),
                        laws,
                        own_rays: 0,
                    };
                    let errors = Errors::of(states, &energy.at(&inputs(states))?);
                    measured.entry(case).or_default().push(errors);
                }
                last = Some(energy);
            }
        }
        last.context("there is no law to train on")
    }

    /// The network that is trained on all laws of the split and on rays of all materials but one.
    fn with_others(
        &self,
        config: &TrainingConfig,
        without: &Material,
        materials: &[Material],
        stop: &AtomicBool,
    ) -> Result<LawEnergy> {
        refuse_stop(stop)?;
        let name = &without.sheet.name;
        eprintln!("split {}, all but {name}", config.seed);
        let others = materials.iter().filter(|it| it.sheet.name != *name);
        let others = others.flat_map(|it| it.rays().take(OTHER_RAYS).flat_map(thinned));
        let data = training_data(self.states(self.training.len()).chain(others));
        Ok(LawEnergy::fit(&data, LawForm::Works, config, None)?)
    }
}

impl Network {
    fn form(self) -> LawForm {
        match self {
            Self::Numbers => LawForm::Alone,
            Self::TimesFilm => LawForm::Factor,
            Self::Works | Self::WorksOfAll => LawForm::Works,
            Self::WorksTimesFilm => LawForm::WorksOfKnown,
        }
    }

    /// Whether the film is known to the network, so that it is no test.
    fn knows_film(self) -> bool {
        matches!(self, Self::TimesFilm | Self::WorksTimesFilm)
    }
}

impl Material {
    /// The states of each ray.
    fn rays(&self) -> impl Iterator<Item = &[SolvedState]> {
        let mut left = self.states.as_slice();
        let rows = self.database.rows();
        rows.chunk_by(|left, right| left.job == right.job)
            .map(move |rows| left.split_off(..rows.len()).unwrap_or_default())
    }

    fn read(sheet: &Path, rays: &Path, film: &Film) -> Result<Self> {
        let (sheet, database) = (SheetMaterial::load(sheet)?, Database::read(rays)?);
        let windows = database.manifest().hinge;
        let similar = windows.r_win / sheet.thickness * film.sheet.thickness;
        ensure!(
            (similar / film.weights.card().hinge.r_win - 1.0).abs() < 1e-9,
            "{}: the windows are not similar to those of the film: r_win = {} mm",
            rays.display(),
            windows.r_win
        );
        let states = SolvedState::of_rows(database.rows(), &sheet, film);
        Ok(Self {
            sheet,
            database,
            states,
        })
    }
}

/// A split of the rays of a material.
struct Trial<'a> {
    material: &'a Material,
    database: Database,
    film: &'a Film,
    network: Network,
    /// The network, without a ray of the material.
    energy: &'a LawEnergy,
    tuned: &'a TrainingConfig,
    /// Folder of the fine-tuned weights of the film.
    fits: PathBuf,
}

impl Trial<'_> {
    fn run(&self, seed: u64, stop: &AtomicBool, measured: &mut Measured) -> Result<()> {
        let name = &self.material.sheet.name;
        let is_film = *name == self.film.sheet.name;
        let mut keep = |way, own_rays, errors| {
            let case = Case {
                target: name.clone(),
                way,
                laws: 0,
                own_rays,
            };
            measured.entry(case).or_default().push(errors);
        };
        let (network, energy) = (self.network, self.energy);
        if !is_film {
            let all = &self.material.states;
            keep(Way::Film, 0, Errors::of(all, &films(all)));
        }
        let test = self.states(&self.database.part(Part::Test));
        let before = energy.at(&inputs(&test))?;
        keep(Way::FamilyTuned(network), 0, Errors::of(&test, &before));
        let available = self.database.manifest().split.jobs(Part::Training).len();
        for own_rays in counts(&OWN_RAYS, available.min(OWN_RAYS[OWN_RAYS.len() - 1])) {
            refuse_stop(stop)?;
            eprintln!("split {seed}, {name}, {own_rays} rays");
            let thinned = self.database.thinned(own_rays);
            let own = self.states(&thinned.part(Part::Training));
            let factor = best_factor(&own, &energy.at(&inputs(&own))?);
            let errors = Errors::of(&test, &scaled(&before, factor));
            keep(Way::FamilyTimes(network), own_rays, errors);
            let config = TrainingConfig {
                mirror: false,
                frozen_layers: 0,
                ..self.tuned.clone()
            };
            let data = training_data(&own);
            let tuned = LawEnergy::fit(&data, network.form(), &config, Some(energy))?;
            let errors = Errors::of(&test, &tuned.at(&inputs(&test))?);
            keep(Way::FamilyTuned(network), own_rays, errors);
            if is_film {
                continue;
            }
            let factor = best_factor(&own, &films(&own));
            let errors = Errors::of(&test, &scaled(&films(&test), factor));
            keep(Way::FilmTimes, own_rays, errors);
            let fit = format!("{name}-{own_rays}-rays-split-{seed}");
            let start = Some(&self.film.weights);
            let weights = kept_fit(&self.fits, &fit, &thinned, self.tuned, start)?;
            let errors = Errors::of(&test, &self.by(weights, &thinned.part(Part::Test)));
            keep(Way::FilmTuned, own_rays, errors);
        }
        Ok(())
    }

    fn states(&self, rows: &[Row]) -> Vec<SolvedState> {
        SolvedState::of_rows(rows, &self.material.sheet, self.film)
    }

    /// The energies of weights of this material.
    fn by(&self, weights: Surrogate, rows: &[Row]) -> Vec<EnergySlopes> {
        let sheet = self.material.sheet.clone();
        let film = Film { weights, sheet };
        films(&SolvedState::of_rows(rows, &self.material.sheet, &film))
    }
}

/// Fewer than `all`, and `all`.
fn counts(fewer: &[usize], all: usize) -> Vec<usize> {
    let fewer = fewer.iter().copied().filter(|&count| count < all);
    fewer.chain([all]).collect()
}

/// Evenly spaced states of a ray, its last one among them.
fn thinned(states: &[SolvedState]) -> impl Iterator<Item = &SolvedState> {
    let step = states.len().div_ceil(STATES_OF_RAY).max(1);
    states.iter().rev().step_by(step)
}

fn inputs(states: &[SolvedState]) -> Vec<LawState> {
    states.iter().map(SolvedState::input).collect()
}

fn films(states: &[SolvedState]) -> Vec<EnergySlopes> {
    states.iter().map(|state| state.film).collect()
}

fn refuse_stop(stop: &AtomicBool) -> Result<()> {
    ensure!(
        !stop.load(Ordering::Relaxed),
        "stopped; run the same command again"
    );
    Ok(())
}
