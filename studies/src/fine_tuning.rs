//! `kirigami-studies fine-tuning`: the rays that a new material needs when it starts from the weights of another one.

mod fine_tuning_page;

use crate::charts;
use crate::stop::refuse_stop;
use ::train::{Backend, Parity, Start, Training, TrainingConfig};
use anyhow::{Result, ensure};
use clap::Args;
use dataset::{Database, Part, SplitPlan};
use kirigami::commands::train::kept_fit;
use kirigami::ui::{interrupt, picture, run_folder};
use std::path::PathBuf;
use surrogate::{Surrogate, TestErrors};

/// Compare fine-tuned networks with networks trained from scratch, over the number of training rays
///
/// Every network of a split is tested on the same hinge geometries, which are in no training and no choice. Several
/// splits of a database are averaged. Trained networks are stored in the folder, so the study can be stopped and continued.
/// Writes fine-tuning.csv, fine-tuning.md and a chart of each database. Example:
/// kirigami-studies fine-tuning runs/polypropylene.parquet --splits 3
#[derive(Args)]
pub struct FineTuningStudy {
    /// Databases of new materials (Parquet with their manifests)
    #[arg(value_name = "DATABASE", required = true)]
    databases: Vec<PathBuf>,
    /// Weights of another material, with which fine-tuning starts
    #[arg(
        long,
        value_name = "WEIGHTS",
        default_value = "data/pet-0.5mm/medium.safetensors"
    )]
    from: PathBuf,
    /// Training configuration for random initial weights
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/training/medium.toml"
    )]
    scratch: PathBuf,
    /// Training configuration for fine-tuning
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/training/fine-tuning.toml"
    )]
    tuned: PathBuf,
    /// Number of splits of each database into training, validation and test geometries
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u64).range(1..=64))]
    splits: u64,
    /// Folder for the tables, the charts and the fits
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-fine-tuning")]
    out: PathBuf,
}

/// Numbers of training rays; the number of all available rays is added.
const RAYS: [usize; 5] = [25, 50, 100, 200, 400];

/// Fractions of the geometries.
const VALIDATION: f64 = 0.1;
const TEST: f64 = 0.2;

/// A way to make the weights of a new material.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    /// The given weights, scaled to the windows: no ray is used.
    Similarity,
    /// The given weights with three fitted factors.
    Factors,
    /// Random initial weights; epochs of the configuration times the factor.
    Scratch { epochs: usize },
    /// The given weights as initial ones; learning rate of the configuration times the factor.
    Tuned { frozen: usize, rate: f64 },
}

const TUNED: Way = Way::Tuned {
    frozen: 0,
    rate: 1.0,
};

/// Ways that are compared at every number of rays.
const COMPARED: [Way; 5] = [
    Way::Scratch { epochs: 1 },
    Way::Factors,
    TUNED,
    Way::Tuned {
        frozen: 1,
        rate: 1.0,
    },
    Way::Tuned {
        frozen: 2,
        rate: 1.0,
    },
];

/// Other recipes, compared with all rays.
const RECIPES: [Way; 3] = [
    Way::Scratch { epochs: 4 },
    Way::Tuned {
        frozen: 0,
        rate: 3.5,
    },
    Way::Tuned {
        frozen: 0,
        rate: 0.35,
    },
];

/// The errors of a way with a number of rays, averaged over the splits.
struct Measured {
    way: Way,
    /// Number of training rays.
    rays: usize,
    /// Relative root mean square errors (%) on the validation part: of W, F_a, F_s, M_theta, D and D_peak.
    validation: [f64; 6],
    /// The same on the test part.
    test: [f64; 6],
    /// Mean training time (s).
    training_s: f64,
}

/// The results of one database.
struct Material {
    name: String,
    /// Number of rays of the database.
    rays: usize,
    measured: Vec<Measured>,
}

impl Material {
    /// Name of the chart's files; the end of a name after a dot would be taken for its extension.
    fn chart(&self) -> String {
        self.name.replace('.', "-")
    }
}

impl FineTuningStudy {
    pub fn run(&self) -> Result<()> {
        let parent = Surrogate::load(&self.from)?;
        let read = |path| support::toml_file::read::<TrainingConfig>(path);
        let configs = [
            read(&self.scratch)?,
            read(&self.tuned)?.with_sizes_of(&parent),
        ];
        let _held = run_folder::hold(&self.out)?;
        let stop = interrupt::stop_flag()?;
        let mut materials: Vec<Material> = Vec::new();
        for path in &self.databases {
            let database = Database::read(path)?;
            let name = database.manifest().material.clone();
            ensure!(
                materials.iter().all(|other| other.name != name),
                "{}: another database is also of {name}",
                path.display()
            );
            let splits = self.splits(&database)?;
            let cases = cases(&splits[0]);
            let mut measured = Vec::new();
            for (done, &(way, rays)) in cases.iter().enumerate() {
                refuse_stop(stop)?;
                eprintln!(
                    "{name}, {} of {}: {way}, {rays} rays",
                    done + 1,
                    cases.len()
                );
                let folder = self.out.join("fits").join(&name);
                let fit = |(k, split): (usize, &Database)| {
                    let thinned = split.thinned(rays);
                    let name = format!("{}-{rays}-rays-split-{k}", way.file_name());
                    let surrogate =
                        way.weights(&thinned, &parent, &configs, |config, parent| {
                            kept_fit(&folder, &name, &thinned, config, parent)
                        })?;
                    Ok(Errors::of(way, &surrogate, &thinned))
                };
                let errors: Vec<Errors> =
                    (splits.iter().enumerate().map(fit)).collect::<Result<_>>()?;
                measured.push(Errors::averaged(&errors, way, rays));
            }
            materials.push(Material {
                name,
                rays: database.manifest().rays,
                measured,
            });
            self.write(&materials, &configs)?;
        }
        println!("see {}", self.out.join("fine-tuning.md").display());
        Ok(())
    }

    /// The database, split with several seeds.
    fn splits(&self, database: &Database) -> Result<Vec<Database>> {
        let split = |seed| {
            let plan = SplitPlan {
                seed,
                validation: VALIDATION,
                test: TEST,
            };
            Ok(database.split(&plan)?)
        };
        (0..self.splits).map(split).collect()
    }

    fn write(&self, materials: &[Material], configs: &[TrainingConfig; 2]) -> Result<()> {
        for material in materials {
            let chart = charts::against_rays(&fine_tuning_page::curves(material))?;
            picture::save(&chart, &self.out.join(material.chart()), 1600)?;
        }
        let write = |name: &str, text: &str| run_folder::write(&self.out, name, text);
        write("fine-tuning.csv", &fine_tuning_page::csv(materials)?)?;
        write(
            "fine-tuning.md",
            &fine_tuning_page::markdown(materials, configs, self.splits)?,
        )
    }
}

/// Every way with every number of rays that the training part has, and other recipes with all rays.
fn cases(split: &Database) -> Vec<(Way, usize)> {
    let all = split.manifest().split.jobs(Part::Training).len();
    let fewer = RAYS.into_iter().filter(|&rays| rays < all);
    let rays: Vec<usize> = fewer.chain([all]).collect();
    let mut cases = vec![(Way::Similarity, 0)];
    for way in COMPARED {
        cases.extend(rays.iter().map(|&rays| (way, rays)));
    }
    cases.extend(RECIPES.map(|way| (way, all)));
    cases
}

impl Way {
    /// The weights; `fit` trains with a configuration and initial weights.
    fn weights(
        self,
        database: &Database,
        parent: &Surrogate,
        [scratch, tuned]: &[TrainingConfig; 2],
        fit: impl FnOnce(&TrainingConfig, Option<&Surrogate>) -> Result<Surrogate>,
    ) -> Result<Surrogate> {
        match self {
            Self::Similarity => {
                let factor = database.manifest().hinge.r_win / parent.card().hinge.r_win;
                Ok(parent.clone().scaled(factor))
            }
            Self::Factors => {
                let start = Start::Weights(parent);
                let training = Training::new(database, tuned, Backend::default(), start)?;
                Ok(training.finish()?.surrogate)
            }
            Self::Scratch { epochs } => {
                let config = TrainingConfig {
                    epochs: epochs * scratch.epochs,
                    ..scratch.clone()
                };
                fit(&config, None)
            }
            Self::Tuned { frozen, rate } => {
                let config = TrainingConfig {
                    frozen_layers: frozen,
                    learning_rate: rate * tuned.learning_rate,
                    ..tuned.clone()
                };
                fit(&config, Some(parent))
            }
        }
    }

    fn file_name(self) -> String {
        self.to_string().replace([' ', ','], "-")
    }
}

/// The errors of one network.
struct Errors {
    validation: TestErrors,
    test: TestErrors,
    training_s: f64,
}

impl Errors {
    fn of(way: Way, surrogate: &Surrogate, database: &Database) -> Self {
        let errors = |part| Parity::of(surrogate, &database.part(part)).errors();
        let trained = !matches!(way, Way::Similarity);
        Self {
            validation: errors(Part::Validation),
            test: errors(Part::Test),
            training_s: surrogate
                .card()
                .training_s
                .filter(|_| trained)
                .unwrap_or_default(),
        }
    }

    /// Root mean squares over the splits.
    fn averaged(splits: &[Self], way: Way, rays: usize) -> Measured {
        let count = splits.len() as f64;
        let mean = |part: fn(&Self) -> TestErrors| {
            let all: Vec<[f64; 6]> = splits.iter().map(|it| part(it).percents()).collect();
            std::array::from_fn(|k| {
                (all.iter().map(|it| it[k] * it[k]).sum::<f64>() / count).sqrt()
            })
        };
        Measured {
            way,
            rays,
            validation: mean(|it| it.validation),
            test: mean(|it| it.test),
            training_s: splits.iter().map(|it| it.training_s).sum::<f64>() / count,
        }
    }
}

impl std::fmt::Display for Way {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match *self {
            Self::Similarity => write!(f, "similarity alone"),
            Self::Factors => write!(f, "three factors"),
            Self::Scratch { epochs: 1 } => write!(f, "from scratch"),
            Self::Scratch { epochs } => write!(f, "from scratch, {epochs} times the epochs"),
            Self::Tuned { frozen, rate } => {
                write!(f, "fine-tuned")?;
                match frozen {
                    0 => {}
                    1 => write!(f, ", first layer frozen")?,
                    _ => write!(f, ", first {frozen} layers frozen")?,
                }
                if rate != 1.0 {
                    write!(f, ", {rate} times the learning rate")?;
                }
                Ok(())
            }
        }
    }
}
