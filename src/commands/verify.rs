//! `kirigami verify`: the hinges of a designed sheet solved by finite elements, compared with the surrogate.

mod polished;
mod sheet_errors;

use crate::commands::inspect::judged_design::DESIGN_TO_JUDGE;
use crate::commands::inspect::scene_args::Inspected;
use crate::replays::balanced_sheet::{WindowSolves, balanced};
use crate::replays::comparison;
use crate::replays::comparison::{SCALE, spread_table};
use crate::replays::kept_solves::{Outcome, SolveArgs};
use crate::replays::routes::{HingeRoute, ensemble, hinge_routes, judging_tier};
use crate::ui::run_folder;
use anyhow::{Context, Result, ensure};
use clap::Args;
use dataset::{COMPARED, ComparedState};
use design::pattern::design_vector::DesignVector;
use design::scene::Scene;
use fe_driver::KeptSolve;
use hinge::{HingeDeformation, HingeSample};
use mesher::Tier;
use output::drawing;
use serde::Serialize;
use std::collections::BTreeSet;
use std::fmt::{Display, Write};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use surrogate::{Surrogate, mean_and_variance};

/// Solve the hinges of a design by finite elements, along their paths in the sheet
///
/// Compares energy, forces and damage of the surrogate with CalculiX on the same paths, hinge by hinge: the
/// error of the whole chain on one design. Writes replay.md, replay.csv and a chart. With --equilibrium the sheet is
/// balanced with the forces of the finite elements: the error of its deployed shape. Writes equilibrium.md. With
/// --polish N the design is searched for N more steps with these forces. Writes polish.md, design.json and the files of
/// a run. Without --design the design of the scene's run is verified, or the start design if the scene has no run.
/// Example: kirigami verify configs/scenes/demo.toml --equilibrium
#[derive(Args)]
#[command(mut_arg("design", |arg| arg.help(DESIGN_TO_JUDGE)))]
pub struct VerifyCommand {
    #[command(flatten)]
    judged: Inspected,
    /// Weights of further networks of the same training (train --seeds), whose spread estimates the error [default: the
    /// ensemble of the scene, none with --weights]
    #[arg(long, value_name = "FILE", num_args = 1..)]
    ensemble: Vec<PathBuf>,
    /// Number of hinges to solve, spread evenly over the sheet [default: all]
    #[arg(long, value_name = "N")]
    sample: Option<NonZeroUsize>,
    /// Mesh tier of the windows [default: that of the weights' database, or the finer tier that it was
    /// corrected to]; a window of the tier reference takes two minutes on one core
    #[arg(long, value_name = "TIER")]
    tier: Option<Tier>,
    /// Deploy the sheet with finite elements for its hinges, which are solved several times
    #[arg(long, conflicts_with_all = ["ensemble", "sample"])]
    equilibrium: bool,
    /// Maximum number of times that all hinges are solved
    #[arg(long, value_name = "N", default_value_t = 6, requires = "equilibrium")]
    rounds: usize,
    /// Search for N more steps with the hinge law corrected to the finite elements, from the design on; judge the design that
    /// is found by finite elements again, and write it with its cut files
    #[arg(long, value_name = "N", requires = "equilibrium")]
    polish: Option<NonZeroUsize>,
    /// Write the cut files of a polished design even if its report has errors
    #[arg(long, requires = "polish")]
    force: bool,
    /// Print JSON instead of text
    #[arg(long, requires = "equilibrium")]
    json: bool,
    /// Folder for the tables, the chart and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/verify")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

/// One hinge, by the surrogate and by finite elements.
struct Replayed {
    route: HingeRoute,
    states: Vec<ComparedState>,
    /// Standard deviation over the ensemble, in the order of [`COMPARED`]; empty without one.
    spread: Vec<[f64; 6]>,
    /// Fraction of the states inside the training domain.
    inside: f64,
}

impl VerifyCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let (scene, design, name) = self.judged.read_judged()?;
        let surrogate = scene
            .surrogate()
            .context("only a surrogate can be verified: set hinge = \"surrogate\" in the scene")?;
        let tier = judging_tier(self.tier, surrogate)?;
        match self.equilibrium {
            true => self.balance(scene, &design, name, tier),
            false => self.replay(&scene, &design, &name, surrogate, tier),
        }
    }

    /// The equilibrium with finite elements, and the polish from there.
    fn balance(
        &self,
        mut scene: Scene,
        design: &DesignVector,
        name: String,
        tier: Tier,
    ) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let windows = WindowSolves {
            tier,
            args: &self.solve,
            folder: &self.out,
        };
        match self.polish {
            None => {
                let (found, _) = balanced(&scene, design, &windows, self.rounds)?;
                let end = found.by_elements();
                let picture = drawing::deployed(&scene, &end.sheet, end.final_step());
                run_folder::write(&self.out, "deployed.svg", &picture)?;
                self.print(&sheet_errors::write(&found, name, &windows)?)
            }
            Some(steps) => {
                scene.config.output = std::path::absolute(&self.out)?;
                let given = (design, name);
                let gain = polished::run(&scene, given, &windows, self.rounds, steps, self.force)?;
                self.print(&gain)
            }
        }
    }

    fn print(&self, found: &(impl Serialize + Display)) -> Result<()> {
        match self.json {
            true => println!("{}", serde_json::to_string_pretty(found)?),
            false => println!("{found}\nwritten to {}", self.out.display()),
        }
        Ok(())
    }

    /// Finite elements along the paths that the hinges have in the sheet by the hinge law.
    fn replay(
        &self,
        scene: &Scene,
        design: &DesignVector,
        name: &str,
        surrogate: &Surrogate,
        tier: Tier,
    ) -> Result<()> {
        let networks = ensemble(scene, surrogate, &self.ensemble)?;
        let mut routes = hinge_routes(scene, design)?;
        if let Some(sample) = self.sample {
            let (all, sample) = (routes.len(), sample.get());
            let chosen: BTreeSet<usize> = (0..sample).map(|i| i * all / sample).collect();
            routes.retain(|route| chosen.contains(&route.hinge));
        }
        let solves: Vec<KeptSolve> = routes
            .iter()
            .map(|route| route.recorded(&scene.material, tier))
            .collect::<Result<_>>()?;
        let _held = run_folder::hold(&self.out)?;
        let outcomes = self
            .solve
            .solve(&solves.iter().collect::<Vec<_>>(), &self.out)?;
        let (mut replayed, mut failures) = (Vec::new(), String::new());
        for (route, outcome) in routes.into_iter().zip(outcomes) {
            let hinge = route.hinge;
            match Replayed::new(route, outcome, surrogate, &networks) {
                Ok(hinge) => replayed.push(hinge),
                Err(reason) => writeln!(failures, "* hinge {hinge}: {reason}")?,
            }
        }
        ensure!(!replayed.is_empty(), "no hinge was solved:\n{failures}");
        let page = page(name, &replayed, tier, &failures)?;
        run_folder::write(&self.out, "replay.md", &page)?;
        run_folder::write(&self.out, "replay.csv", &csv(&replayed)?)?;
        let groups: Vec<_> = replayed.iter().map(|hinge| &hinge.states[..]).collect();
        let axes = ["finite elements", "surrogate"];
        comparison::draw(&groups, axes, &self.out.join("replay"))?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }
}

impl Replayed {
    fn new(
        route: HingeRoute,
        outcome: Outcome,
        surrogate: &Surrogate,
        networks: &[Surrogate],
    ) -> Result<Self, String> {
        let solved = outcome?;
        let count = route.states.len();
        let computed =
            (1..=count).map(|k| HingeSample::at(&solved.samples, k as f64 / count as f64));
        let predicted = predicted(surrogate, &route);
        let domain = surrogate.domain();
        let inside = |state: &HingeDeformation| domain.contains(&route.design, state);
        // Damage grows along the path: it is not known once a state was outside the training domain.
        let left = route.states.iter().position(|state| !inside(state));
        let known = |(k, value): (usize, &HingeSample)| match left {
            Some(left) if k >= left => HingeSample {
                d: f64::NAN,
                d_peak: None,
                ..*value
            },
            _ => *value,
        };
        let states: Vec<_> = (predicted.iter().enumerate().map(known))
            .zip(computed)
            .filter_map(|(value, reference)| Some(ComparedState::new(&value, &reference?)))
            .collect();
        let others: Vec<_> = networks
            .iter()
            .map(|it| self::predicted(it, &route))
            .collect();
        let spread = match others.is_empty() {
            true => Vec::new(),
            false => (0..states.len())
                .map(|k| deviation(&predicted, &others, k))
                .collect(),
        };
        Ok(Self {
            inside: route.states.iter().filter(|state| inside(state)).count() as f64 / count as f64,
            route,
            states,
            spread,
        })
    }
}

/// The predictions of a surrogate at every state of a path.
fn predicted(surrogate: &Surrogate, route: &HingeRoute) -> Vec<HingeSample> {
    let designs = vec![route.design; route.states.len()];
    surrogate.samples(&designs, &route.states)
}

/// Standard deviation over all networks at the state `k`.
fn deviation(first: &[HingeSample], others: &[Vec<HingeSample>], k: usize) -> [f64; 6] {
    let all = std::iter::once(first).chain(others.iter().map(Vec::as_slice));
    let values: Vec<_> = all
        .map(|it| ComparedState::new(&it[k], &it[k]).value)
        .collect();
    std::array::from_fn(|i| {
        let [_, variance] = mean_and_variance(values.iter().map(|value| value[i]));
        variance.sqrt()
    })
}

fn page(name: &str, replayed: &[Replayed], tier: Tier, failures: &str) -> Result<String> {
    let states = replayed
        .iter()
        .map(|hinge| hinge.states.len())
        .sum::<usize>();
    let inside = replayed.iter().map(|hinge| hinge.inside).sum::<f64>() / replayed.len() as f64;
    let total = |of: fn(&ComparedState) -> f64| -> f64 {
        let ends = replayed.iter().filter_map(|hinge| hinge.states.last());
        ends.map(of).sum()
    };
    let (learned, solved) = (total(|end| end.value[0]), total(|end| end.reference[0]));
    let mut text = format!(
        "# The hinges of a sheet, replayed\n\n\
         The {name}: {states} states of {} hinges on their paths in the sheet, windows of tier {tier}; {:.0} % of the \
         states inside the training domain. Differences of the surrogate from the finite elements are root mean \
         squares, relative to the root mean square of the finite elements: {SCALE}. D and D_peak of a hinge are known, \
         and compared, until it leaves the domain.\n\n{}\n\
         Energy of these hinges at full load: {learned:.1} N mm by the surrogate, {solved:.1} N mm by finite \
         elements ({:+.2} %).\n",
        replayed.len(),
        100.0 * inside,
        spread_table(
            &replayed
                .iter()
                .map(|hinge| &hinge.states[..])
                .collect::<Vec<_>>(),
            "hinge"
        )?,
        100.0 * (learned / solved - 1.0),
    );
    if replayed.iter().any(|hinge| !hinge.spread.is_empty()) {
        write!(text, "\n{}", estimate(replayed)?)?;
    }
    text += "\nAt full load:\n\n| hinge | w_lig, mm | alpha, deg | eta_a | eta_s | theta, deg | inside \
             | W, N mm | by FE | M, N mm | by FE | D | by FE |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    for hinge in replayed {
        let (route, end) = (&hinge.route, hinge.route.end());
        let Some(ComparedState { value, reference }) = hinge.states.last() else {
            continue;
        };
        let [eta_a, eta_s] = end.eta(route.design.w_lig);
        writeln!(
            text,
            "| {} | {:.1} | {:.0} | {eta_a:.3} | {eta_s:.3} | {:.1} | {:.0} % | {:.2} | {:.2} | {:.1} | {:.1} | {} | {:.5} |",
            route.hinge,
            route.design.w_lig,
            route.design.alpha.to_degrees(),
            end.theta.to_degrees(),
            100.0 * hinge.inside,
            value[0],
            reference[0],
            value[3],
            reference[3],
            match value[4].is_nan() {
                true => "-".to_owned(),
                false => format!("{:.5}", value[4]),
            },
            reference[4],
        )?;
    }
    if !failures.is_empty() {
        write!(text, "\nNot solved:\n\n{failures}")?;
    }
    Ok(text)
}

/// How often the error is within one, two and three standard deviations of the ensemble.
fn estimate(replayed: &[Replayed]) -> Result<String> {
    let mut text = "Fraction of the states with an error within so many standard deviations of the ensemble:\n\n\
        | quantity | one | two | three |\n|---|---|---|---|\n"
        .to_owned();
    let pairs = || {
        replayed
            .iter()
            .flat_map(|hinge| hinge.states.iter().zip(&hinge.spread))
    };
    for (i, name) in COMPARED.iter().enumerate() {
        if pairs().any(|(_, spread)| spread[i].is_nan()) {
            writeln!(text, "| {name} | not predicted by all | | |")?;
            continue;
        }
        let known = || pairs().filter(|(state, _)| state.is_known(i));
        if known().next().is_none() {
            writeln!(text, "| {name} | not known | | |")?;
            continue;
        }
        let within = |count: f64| {
            let met = known().filter(|(state, spread)| {
                (state.value[i] - state.reference[i]).abs() <= count * spread[i]
            });
            100.0 * met.count() as f64 / known().count() as f64
        };
        let [one, two, three] = [1.0, 2.0, 3.0].map(within);
        writeln!(text, "| {name} | {one:.0} % | {two:.0} % | {three:.0} % |")?;
    }
    Ok(text)
}

/// One row per state; a cell is empty if its value is not known.
fn csv(replayed: &[Replayed]) -> Result<String> {
    let columns = |prefix: &str| COMPARED.map(|name| format!("{prefix}_{name}")).join(",");
    let mut text = format!(
        "hinge,w_lig_mm,alpha_deg,step,eta_a,eta_s,theta_deg,{},{}\n",
        columns("surrogate"),
        columns("fe")
    );
    for hinge in replayed {
        let design = &hinge.route.design;
        let states = hinge.route.states.iter().zip(&hinge.states);
        for (step, (state, ComparedState { value, reference })) in states.enumerate() {
            let [eta_a, eta_s] = state.eta(design.w_lig);
            write!(
                text,
                "{},{:.4},{:.4},{},{eta_a:.6},{eta_s:.6},{:.4}",
                hinge.route.hinge,
                design.w_lig,
                design.alpha.to_degrees(),
                step + 1,
                state.theta.to_degrees(),
            )?;
            for number in value.iter().chain(reference) {
                match number.is_nan() {
                    true => text.push(','),
                    false => write!(text, ",{number:.6}")?,
                }
            }
            writeln!(text)?;
        }
    }
    Ok(text)
}
