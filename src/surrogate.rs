//! `kirigami surrogate`: ask exported weights, and read their card.

use crate::train::{UNSEEN, bin_table, error_table};
use anyhow::{Context, Result, bail, ensure};
use clap::{Args, Subcommand};
use dataset::{Database, Row};
use hinge::{HingeDeformation, HingeDesign};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use surrogate::{Order, Surrogate};
use train::Parity;

/// Ask exported weights, and read their card
#[derive(Args)]
pub struct SurrogateCommand {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    Eval(EvalCommand),
    Card(CardCommand),
    Test(TestCommand),
}

/// Evaluate energy, forces, tangent and damage at the hinge states of a CSV file
///
/// The columns w_lig, a, s (mm), alpha and theta (rad) are read, others ignored.
#[derive(Args)]
struct EvalCommand {
    /// Weights (safetensors with their card)
    #[arg(value_name = "WEIGHTS")]
    weights: PathBuf,
    /// States (CSV)
    #[arg(value_name = "STATES")]
    states: PathBuf,
    /// Print JSON, with the tangent, instead of CSV
    #[arg(long)]
    json: bool,
}

/// Print what weights were trained on, and how well they fit
#[derive(Args)]
struct CardCommand {
    /// Weights (safetensors with their card)
    #[arg(value_name = "WEIGHTS")]
    weights: PathBuf,
}

/// Judge weights by every state of a database, such as rays of a finer mesh
///
/// Rays that the weights were trained on are judged too. Example: kirigami surrogate test
/// data/pet-0.5mm/medium.safetensors data/pet-0.5mm/reference.parquet
#[derive(Args)]
struct TestCommand {
    /// Weights (safetensors with their card)
    #[arg(value_name = "WEIGHTS")]
    weights: PathBuf,
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
}

/// One state to be evaluated.
#[derive(Deserialize)]
struct State {
    w_lig: f64,
    alpha: f64,
    a: f64,
    s: f64,
    theta: f64,
}

/// What the surrogate says about it.
#[derive(Serialize)]
struct Answer {
    /// Whether the state lies in the box of the training rows.
    inside: bool,
    w: f64,
    f_a: f64,
    f_s: f64,
    m_theta: f64,
    d: f64,
    d_peak: Option<f64>,
    /// d2W/d(a, s, theta)^2.
    tangent: [[f64; 3]; 3],
}

impl SurrogateCommand {
    pub fn run(&self) -> Result<()> {
        match &self.action {
            Action::Eval(command) => command.run(),
            Action::Card(command) => command.run(),
            Action::Test(command) => command.run(),
        }
    }
}

impl EvalCommand {
    fn run(&self) -> Result<()> {
        let surrogate = Surrogate::load(&self.weights)?;
        let answers = answers(&surrogate, &read_states(&self.states)?);
        if self.json {
            println!("{}", serde_json::to_string_pretty(&answers)?);
            return Ok(());
        }
        println!("inside,W,F_a,F_s,M_theta,D,D_peak");
        for it in answers {
            let peak = it.d_peak.map_or(String::new(), |peak| peak.to_string());
            println!(
                "{},{},{},{},{},{},{peak}",
                it.inside, it.w, it.f_a, it.f_s, it.m_theta, it.d
            );
        }
        Ok(())
    }
}

impl TestCommand {
    fn run(&self) -> Result<()> {
        let surrogate = Surrogate::load(&self.weights)?;
        let database = Database::read(&self.database)?;
        let (card, manifest) = (surrogate.card(), database.manifest());
        if let Some(material) = &card.material_hash {
            ensure!(
                manifest
                    .material_hashes
                    .iter()
                    .all(|other| other == material),
                "{} were trained on {}, {} is of {}",
                self.weights.display(),
                card.material,
                self.database.display(),
                manifest.material
            );
        }
        let rows = database.rows();
        let inside = |row: &&Row| card.domain.contains(&row.design, &row.sample.deformation());
        println!(
            "tier {}, judged by tier {}: {} states of {} rays, {:.1} % of them in the box of the training",
            card.tier,
            manifest.tier,
            rows.len(),
            manifest.rays,
            100.0 * rows.iter().filter(inside).count() as f64 / rows.len() as f64
        );
        println!(
            "{}",
            error_table(&Parity::of(&surrogate, rows).errors(), "states")
        );
        Ok(())
    }
}

impl CardCommand {
    fn run(&self) -> Result<()> {
        let surrogate = Surrogate::load(&self.weights)?;
        let card = surrogate.card();
        println!("material {}, tier {}", card.material, card.tier);
        let known = |hash: &Option<String>| hash.clone().unwrap_or_else(|| "not known".into());
        println!("material law      {}", known(&card.material_hash));
        println!("campaign settings {}", known(&card.settings_hash));
        println!("database {}", card.dataset_hash);
        println!("split    {}", card.split_hash);
        if let Some(base) = &card.fine_tuned_from {
            println!("fine-tuned from weights of the database {base}");
        }
        let hinge = card.hinge;
        println!(
            "hinges with fillet_ratio {}, kerf {} mm, r_win {} mm",
            hinge.fillet_ratio, hinge.kerf, hinge.r_win
        );
        let domain = &card.domain;
        for (name, [least, greatest], scale) in [
            ("a / w_lig", domain.eta_a, 1.0),
            ("s / w_lig", domain.eta_s, 1.0),
            ("theta (deg)", domain.theta, 1f64.to_degrees()),
            ("w_lig (mm)", domain.w_lig, 1.0),
            ("alpha (deg)", domain.alpha, 1f64.to_degrees()),
        ] {
            println!(
                "{name:12} from {:.3} to {:.3}",
                scale * least,
                scale * greatest
            );
        }
        println!("\n{}", error_table(&card.test_errors, UNSEEN));
        if !card.error_bins.is_empty() {
            println!("\n{}", bin_table(&card.error_bins));
        }
        Ok(())
    }
}

fn answers(surrogate: &Surrogate, states: &[State]) -> Vec<Answer> {
    let constants = surrogate.card().hinge;
    let (designs, deformations): (Vec<HingeDesign>, Vec<HingeDeformation>) = states
        .iter()
        .map(|it| {
            let design = constants.hinge(it.w_lig, it.alpha);
            (design, HingeDeformation::from([it.a, it.s, it.theta]))
        })
        .unzip();
    let prepared = surrogate.prepare(&designs);
    let energies = surrogate.evaluate(&prepared, &deformations, Order::Tangent);
    let damages = surrogate.damage(&designs, &deformations);
    let states = designs.iter().zip(&deformations);
    states
        .zip(energies.iter().zip(damages))
        .map(|((design, deformation), (energy, damage))| Answer {
            inside: surrogate.domain().contains(design, deformation),
            w: energy.w,
            f_a: energy.forces[0],
            f_s: energy.forces[1],
            m_theta: energy.forces[2],
            d: damage.d,
            d_peak: damage.d_peak,
            tangent: energy.tangent,
        })
        .collect()
}

fn read_states(path: &Path) -> Result<Vec<State>> {
    let mut reader =
        csv::Reader::from_path(path).with_context(|| format!("cannot read {}", path.display()))?;
    let states: Result<Vec<State>, _> = reader.deserialize().collect();
    let states = states.with_context(|| format!("{} holds no hinge states", path.display()))?;
    ensure!(!states.is_empty(), "{} has no rows", path.display());
    for (index, state) in states.iter().enumerate() {
        let row = || format!("{}, row {}", path.display(), index + 1);
        if ![state.a, state.s, state.theta]
            .iter()
            .all(|it| it.is_finite())
        {
            bail!("{}: a number is not finite", row());
        }
        ensure!(
            state.w_lig > 0.0 && state.w_lig.is_finite(),
            "{}: w_lig = {} violates 0 < w_lig (mm)",
            row(),
            state.w_lig
        );
        ensure!(
            (0.0..=std::f64::consts::PI).contains(&state.alpha),
            "{}: alpha = {} violates 0 <= alpha <= pi (rad)",
            row(),
            state.alpha
        );
    }
    Ok(states)
}
