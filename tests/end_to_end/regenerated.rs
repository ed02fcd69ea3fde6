//! A campaign file says everything: the commands of docs/CAMPAIGN.md make its database, its spot
//! check and its weights, the same ones every time.

use crate::common::{Workplace, timeless};
use crate::fake_solver::{FakeSolver, Fault};
use crate::own_data::differences;
use dataset::Database;
use fe_driver::{
    Campaign, RunOptions, Shard, Solution, Solve, SolveError, Solver, ToolVersions, WindowSolve,
    run,
};
use mesher::Tier;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use surrogate::Surrogate;

const CAMPAIGN: &str = "configs/campaigns/tiny.toml";
/// The best network of a training, and the others of its ensemble.
const NETWORKS: [&str; 4] = ["tiny", "tiny-1", "tiny-2", "tiny-3"];

/// The shipped campaign of films with few and short rays, and a short training.
fn small_campaign(changes: &[(&str, &str)]) -> Workplace {
    let work = Workplace::new();
    work.edit(
        CAMPAIGN,
        &[
            ("theta_deg = [-5.0, 40.0]", "theta_deg = [-5.0, 20.0]"),
            ("median_deg = 20.0", "median_deg = 15.0"),
        ],
    );
    work.edit(CAMPAIGN, changes);
    work.edit("configs/training/tiny.toml", &[("epochs = 300", "epochs = 5")]);
    work
}

/// Runs the first commands of the page, for that campaign; returns what they print.
fn regenerate(work: &Workplace) -> String {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/CAMPAIGN.md");
    let page = std::fs::read_to_string(page).unwrap();
    let (_, block) = page.split_once("```sh\n").unwrap();
    let (block, _) = block.split_once("\n\n").unwrap();
    let commands = block.lines().map(|line| {
        let command = line.strip_prefix("kirigami ").unwrap();
        let command = command.split(" #").next().unwrap();
        command.replace("configs/campaigns/polypropylene-3mm.toml", CAMPAIGN)
    });
    let commands: Vec<String> = commands.collect();
    let verbs = ["campaign plan", "campaign run", "campaign collect", "train"];
    for (command, verb) in std::iter::zip(&commands, verbs) {
        assert!(command.starts_with(verb) && command.contains(CAMPAIGN), "{command}");
    }
    assert_eq!(commands.len(), verbs.len());
    commands.iter().map(|command| work.output(command)).collect()
}

fn database(work: &Workplace, name: &str) -> Database {
    Database::read(&work.path("runs/tiny").join(name)).unwrap()
}

/// The weight files of a training.
fn weights(work: &Workplace) -> [Vec<u8>; 4] {
    NETWORKS.map(|name| {
        let file = format!("runs/tiny/weights/{name}.safetensors");
        std::fs::read(work.path(&file)).unwrap()
    })
}

fn network(work: &Workplace, name: &str) -> Surrogate {
    let file = format!("runs/tiny/weights/{name}.safetensors");
    Surrogate::load(&work.path(&file)).unwrap()
}

#[test]
fn a_database_and_its_weights_are_regenerated_to_the_digits() {
    let [once, again] = [(); 2].map(|()| {
        let work = small_campaign(&[("count = 40", "count = 6")]);
        regenerate(&work);
        work
    });
    for (name, rays) in [("hinges.parquet", 6), ("spot-check.parquet", 3)] {
        let [rows, same] = [&once, &again].map(|work| {
            let database = database(work, name);
            assert_eq!(database.manifest().rays, rays, "{name}");
            timeless(&database)
        });
        assert!(rows == same, "{name}: the rows differ");
    }
    let made = weights(&once);
    assert!(made == weights(&again), "the weights differ");
    for name in NETWORKS {
        let [check, same] = [&once, &again].map(|work| {
            let card = network(work, name).card().clone();
            card.spot_check.expect("the spot check is recorded")
        });
        assert_eq!((check.errors.rows, check.tier.as_deref()), (12, Some("tiny")));
        assert_eq!(check, same, "{name}");
    }
    // Four networks of four seeds.
    for (place, network) in made.iter().enumerate() {
        assert!(!made[..place].contains(network), "{place}");
    }
    // What is trained is not trained again.
    once.output(&format!("train {CAMPAIGN}"));
    assert!(weights(&once) == made);
    // Networks may begin from weights of another material.
    let base = network(&once, "tiny");
    base.save(&once.path("runs/base.safetensors")).unwrap();
    let (key, named) = ("spot_rays", "pretrained = [\"../../runs/base.safetensors\"]\nspot_rays");
    once.edit(CAMPAIGN, &[(key, named)]);
    once.output(&format!("train {CAMPAIGN} --replace"));
    for name in NETWORKS {
        let tuned = network(&once, name);
        assert_eq!(tuned.card().fine_tuned_from.as_ref(), Some(&base.hash()));
    }
    let other =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("surrogate/tests/cases/chi_tiny.safetensors");
    once.edit(CAMPAIGN, &[("../../runs/base.safetensors", other.to_str().unwrap())]);
    let refused = once.error(&format!("train {CAMPAIGN}"));
    assert!(refused.contains("no training has a network of the sizes of"), "{refused}");
}

/// Hinges that are a tenth too stiff on the mesh `tiny`, and right on any other.
struct Meshes {
    tiny: FakeSolver<fn(&WindowSolve) -> Option<Fault>>,
    other: FakeSolver<fn(&WindowSolve) -> Option<Fault>>,
}

impl Solver for Meshes {
    fn versions(&self) -> ToolVersions {
        self.other.versions()
    }

    fn attempt(
        &self,
        solve: &WindowSolve,
        work: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Solution, SolveError> {
        let mesh = match solve.tier() {
            Tier::Tiny => &self.tiny,
            _ => &self.other,
        };
        mesh.attempt(solve, work, limit, stop)
    }
}

/// The rays that are solved on both meshes are in one database, and the training corrects the
/// others by them.
#[test]
fn rays_on_a_finer_mesh_correct_the_others() {
    let work = small_campaign(&[
        ("seed = 1", "seed = 1\nfiner = 20"),
        ("spot_rays = 3", "finer_tier = \"small\"\nspot_rays = 3"),
    ]);
    let campaign = Campaign::load(&work.path(CAMPAIGN)).unwrap();
    let stiffness = [3.0, 5.0, 200.0];
    let solver = Meshes {
        tiny: FakeSolver::new(stiffness.map(|k| 1.1 * k), |_| None),
        other: FakeSolver::new(stiffness, |_| None),
    };
    let options = RunOptions { shard: Shard::WHOLE, workers: 1, time_limit: None, retry: false };
    let (folder, stop) = (work.path("runs/tiny"), AtomicBool::new(false));
    run(&campaign, &folder, &solver, &options, &stop, &mut |_| {}).unwrap();

    let commands = ["campaign status", "campaign collect", "train"];
    let said = commands.map(|command| work.output(&format!("{command} {CAMPAIGN}")));
    let said = said.concat();
    for text in [
        "63 rays complete",
        "600 rows of 40 rays",
        "20 of the rays also on tier small",
        "spot check: 12 states of 3 rays",
        "each of the 20 rays is corrected by the others",
        "weights of tier tiny corrected to small, tested on tier small, 3 rays",
    ] {
        assert!(said.contains(text), "no `{text}` in:\n{said}");
    }
    let rays = database(&work, "hinges.parquet");
    assert_eq!(rays.on_both_meshes().len(), 20);
    let spot = database(&work, "spot-check.parquet");
    assert_eq!(spot.manifest().tier.to_string(), "small");
    for name in NETWORKS {
        let card = network(&work, name).card().clone();
        assert_eq!(card.tier, "tiny corrected to small");
        assert_eq!(card.dataset_hash, rays.manifest().hash);
        assert_eq!(card.spot_check.unwrap().tier.as_deref(), Some("small"));
    }
    let compared = work.output("dataset compare runs/tiny/hinges.parquet");
    for quantity in ["W", "F_a", "F_s", "M_theta"] {
        let [before, after] = differences(&compared, quantity);
        assert_eq!(before, 10.0, "{compared}");
        assert!(after < before / 10.0, "{compared}");
    }
}
