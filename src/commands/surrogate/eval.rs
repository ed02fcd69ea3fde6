//! `kirigami surrogate eval`

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use design::hinge_law::{HingeLaw, Order, SurrogateLaw};
use hinge::{HingeConstants, HingeDeformation, HingeDesign};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use support::regular_file;
use surrogate::Surrogate;

/// Evaluate energy, forces, tangent and damage at the hinge states of a CSV file
///
/// Reads the columns w_lig, a, s (mm), alpha and theta (rad) or alpha_deg and theta_deg (deg), and fillet_ratio, the
/// radius of the hole over w_lig, for weights with holes of several radii; other columns are ignored. Outside the training domain energy, forces and tangent are those of the continued law that designs use.
#[derive(Args)]
pub struct EvalCommand {
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

/// One state to be evaluated.
struct State {
    w_lig: f64,
    alpha: f64,
    a: f64,
    s: f64,
    theta: f64,
    fillet_ratio: Option<f64>,
}

/// A row of the CSV file, each angle in radians or in degrees.
#[derive(Deserialize)]
struct StateRow {
    w_lig: f64,
    alpha: Option<f64>,
    alpha_deg: Option<f64>,
    a: f64,
    s: f64,
    theta: Option<f64>,
    theta_deg: Option<f64>,
    fillet_ratio: Option<f64>,
}

impl StateRow {
    fn state(&self) -> Result<State> {
        let angle =
            |name: &str, radians: Option<f64>, degrees: Option<f64>| match (radians, degrees) {
                (Some(radians), None) => Ok(radians),
                (None, Some(degrees)) => Ok(degrees.to_radians()),
                _ => bail!("give exactly one of the columns {name} (rad) and {name}_deg"),
            };
        Ok(State {
            w_lig: self.w_lig,
            alpha: angle("alpha", self.alpha, self.alpha_deg)?,
            a: self.a,
            s: self.s,
            theta: angle("theta", self.theta, self.theta_deg)?,
            fillet_ratio: self.fillet_ratio,
        })
    }
}

/// The prediction of the surrogate at one state.
#[derive(Serialize)]
struct Answer {
    /// Whether the state lies in the training domain.
    inside: bool,
    w: f64,
    f_a: f64,
    f_s: f64,
    m_theta: f64,
    /// Unknown outside the domain, as is D_peak.
    d: Option<f64>,
    d_peak: Option<f64>,
    /// d2W/d(a, s, theta)^2.
    tangent: [[f64; 3]; 3],
}

impl EvalCommand {
    pub fn run(&self) -> Result<()> {
        let surrogate = Surrogate::load(&self.weights)?;
        let states = read_states(&self.states)?;
        if let Some([least, most]) = surrogate.domain().holes {
            ensure!(
                states.iter().all(|state| state.fillet_ratio.is_some()),
                "{} has no column fillet_ratio: these weights are for holes with a radius of {least:.3} to {most:.3} w_lig",
                self.states.display()
            );
        }
        let answers = answers(surrogate, &states);
        if self.json {
            println!("{}", serde_json::to_string_pretty(&answers)?);
            return Ok(());
        }
        println!("inside,W,F_a,F_s,M_theta,D,D_peak");
        for Answer {
            inside,
            w,
            f_a,
            f_s,
            m_theta,
            d,
            d_peak,
            ..
        } in answers
        {
            let known = |damage: Option<f64>| damage.map_or(String::new(), |d| d.to_string());
            let (d, d_peak) = (known(d), known(d_peak));
            println!("{inside},{w},{f_a},{f_s},{m_theta},{d},{d_peak}");
        }
        Ok(())
    }
}

fn answers(surrogate: Surrogate, states: &[State]) -> Vec<Answer> {
    let constants = surrogate.card().hinge;
    let (designs, deformations): (Vec<HingeDesign>, Vec<HingeDeformation>) = states
        .iter()
        .map(|state| {
            let deformation = HingeDeformation::from([state.a, state.s, state.theta]);
            let constants = HingeConstants {
                fillet_ratio: state.fillet_ratio.unwrap_or(constants.fillet_ratio),
                ..constants
            };
            (constants.hinge(state.w_lig, state.alpha), deformation)
        })
        .unzip();
    let law = SurrogateLaw { surrogate };
    let prepared = law.prepare(&designs);
    let energies = prepared.energies(&deformations, Order::Tangent);
    let damages = prepared.damage(&deformations, false);
    let inside = std::iter::zip(&designs, &deformations)
        .map(|(design, deformation)| law.surrogate.contains(design, deformation));
    std::iter::zip(inside, energies.iter().zip(damages))
        .map(|(inside, (energy, damage))| Answer {
            inside,
            w: energy.w,
            f_a: energy.forces[0],
            f_s: energy.forces[1],
            m_theta: energy.forces[2],
            d: inside.then_some(damage.d),
            d_peak: damage.d_peak.filter(|_| inside),
            tangent: energy.tangent,
        })
        .collect()
}

fn read_states(path: &Path) -> Result<Vec<State>> {
    let bytes =
        regular_file::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let rows: Result<Vec<StateRow>, _> = reader.deserialize().collect();
    let rows = rows.with_context(|| format!("{} contains no hinge states", path.display()))?;
    let states: Result<Vec<State>> = rows.iter().map(StateRow::state).collect();
    let states = states.with_context(|| path.display().to_string())?;
    ensure!(!states.is_empty(), "{} has no rows", path.display());
    for (index, state) in states.iter().enumerate() {
        let row = || format!("{}, row {}", path.display(), index + 1);
        if ![state.a, state.s, state.theta]
            .iter()
            .all(|number| number.is_finite())
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
