//! The main job from end to end with the real gmsh and CalculiX: campaign, database, weights,
//! design, verification.
//!
//! One story in steps, because each needs the files of those before it. A step that fails is named
//! before its message.

use crate::common::{Workplace, assert_contains};
use dataset::Database;
use serde_json::Value;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};
use testkit::failing_ccx;

const CAMPAIGN: &str = "configs/campaigns/tiny.toml";
const RUN: &str = "campaign run configs/campaigns/tiny.toml --folder runs/tiny/campaign";
const COLLECT: &str = "campaign collect configs/campaigns/tiny.toml --folder runs/tiny/campaign --out runs/tiny/hinges.parquet";
const STATUS: &str = "campaign status configs/campaigns/tiny.toml --folder runs/tiny/campaign";

/// Runs the steps in order in one folder.
macro_rules! story {
    ($work:expr; $($step:ident)*) => {
        let work = $work;
        $(
            println!("step: {}", stringify!($step));
            $step(&work);
        )*
    };
}

#[test]
fn the_whole_chain_runs_resumes_and_refuses_to_overwrite() {
    story! { small_chain();
        a_campaign_solves_its_rays_once
        a_database_is_collected_and_not_overwritten
        a_changed_campaign_is_not_collected
        weights_are_trained_and_not_overwritten
        a_sheet_is_designed_with_all_its_files
        the_design_is_balanced_by_finite_elements
        a_failed_round_keeps_the_rounds_before
        weights_are_tested_on_the_spot_check
        further_rays_are_planned
        a_folder_keeps_its_campaign_and_its_scene
    }
}

/// Short rays of few geometries take seconds; the steps are the steps of a real campaign.
fn small_chain() -> Workplace {
    let work = Workplace::new();
    work.edit(
        CAMPAIGN,
        &[
            ("count = 40", "count = 6"),
            ("theta_deg = [-5.0, 40.0]", "theta_deg = [-5.0, 20.0]"),
            ("median_deg = 20.0", "median_deg = 15.0"),
        ],
    );
    work.edit("configs/training/tiny.toml", &[("epochs = 300", "epochs = 20")]);
    let scene = work.read("configs/scenes/pet-3x3.toml").replace("steps = 150", "steps = 3");
    // The weights alone, without a draft and an ensemble.
    let (before, further) = scene.split_once("draft = ").unwrap();
    let (_, after) = further.split_once("]\n").unwrap();
    let scene = format!("{before}{after}").replace("../../runs/pet-3x3", "../../runs/tiny/design");
    work.write("configs/scenes/shipped.toml", &scene);
    let own =
        scene.replace(&format!("../../{SHIPPED_WEIGHTS}"), "../../runs/tiny/surrogate.safetensors");
    assert_ne!(own, scene);
    work.write(SCENE, own);
    work
}

const SCENE: &str = "configs/scenes/own.toml";
const SHIPPED_WEIGHTS: &str = "data/pet-0.5mm/medium.safetensors";

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// The events that the campaign has logged.
fn events(work: &Workplace) -> Vec<u8> {
    let hosts = std::fs::read_dir(work.path("runs/tiny/campaign/hosts")).unwrap();
    let host = hosts.map(|entry| entry.unwrap().path()).next().unwrap();
    std::fs::read(host.join("events-1-of-1.jsonl")).unwrap()
}

fn a_campaign_solves_its_rays_once(work: &Workplace) {
    // Six of the box, three of the spot check.
    assert_contains(&work.output(RUN), &["9 rays complete"]);
    let first = events(work);
    work.output(RUN);
    assert_eq!(events(work), first, "finished jobs are not run again");
    assert_contains(&work.output(STATUS), &["9 rays complete"]);
}

fn a_database_is_collected_and_not_overwritten(work: &Workplace) {
    assert_contains(
        &work.output(COLLECT),
        &[
            " rows of 6 rays",
            "spot check: 12 states of 3 rays, 0 states unknown, written to runs/tiny/spot-check.parquet",
        ],
    );
    assert_contains(&work.error(COLLECT), &["exists"]);
    // Also if the spot check alone is there.
    let beside = COLLECT.replace("hinges.parquet", "other.parquet");
    assert_contains(&work.error(&beside), &["spot-check.parquet exists"]);
    assert!(!work.path("runs/tiny/other.parquet").exists());
    let export = "dataset export runs/tiny/hinges.parquet --out runs/tiny/hinges.csv";
    work.output(export);
    assert_contains(&work.error(export), &["--replace"]);
    work.output(&format!("{export} --replace"));
}

fn a_changed_campaign_is_not_collected(work: &Workplace) {
    work.edit(CAMPAIGN, &[("count = 6", "count = 7")]);
    for command in [&format!("{COLLECT} --replace"), STATUS] {
        assert_contains(&work.error(command), &["has changed since it was run"]);
    }
    work.edit(CAMPAIGN, &[("count = 7", "count = 6")]);
}

fn weights_are_trained_and_not_overwritten(work: &Workplace) {
    let train = "train runs/tiny/hinges.parquet --config configs/training/tiny.toml \
                 --out runs/tiny/surrogate.safetensors";
    assert_contains(&work.output(train), &["shear force"]);
    assert_contains(&work.error(train), &["--replace"]);
}

fn a_sheet_is_designed_with_all_its_files(work: &Workplace) {
    let report = json(&work.output(&format!("design {SCENE} --json")));
    assert_eq!(report["hinges"].as_array().unwrap().len(), 12);
    for file in [
        "cut.dxf",
        "cut.svg",
        "flat.png",
        "deployed.png",
        "deployment.png",
        "report.txt",
        "run.html",
    ] {
        let written = std::fs::metadata(work.path("runs/tiny/design").join(file)).unwrap();
        assert!(written.len() > 500, "{file} is {} bytes", written.len());
    }
}

/// Six rays make no law whose corrections converge. The corrections of the shipped weights
/// converge, though the coarsest mesh is far from these weights: the panels move less in every
/// round.
fn balance(rounds: usize) -> String {
    format!(
        "verify configs/scenes/shipped.toml --design runs/tiny/design/state.json --equilibrium --rounds {rounds} --tier tiny --out balance --json"
    )
}

fn balance_page(work: &Workplace) -> String {
    work.read("balance/equilibrium.md")
}

fn the_design_is_balanced_by_finite_elements(work: &Workplace) {
    let text = work.output(&balance(2));
    let again = Instant::now();
    assert_eq!(work.output(&balance(2)), text, "solved once");
    assert!(again.elapsed() < Duration::from_secs(5), "solved once");
    let balanced = json(&text);
    let movement = |round: usize| balanced["rounds"][round]["movement"].as_f64().unwrap();
    assert!(movement(1) < 0.7 * movement(0), "{balanced}");
    let [ref errors] = balanced["errors"].as_array().unwrap()[..] else {
        panic!("one mesh: {balanced}");
    };
    assert!(errors["corners"][1].as_f64().unwrap() > 0.0, "{balanced}");
    assert!(balanced["budget"]["corners"][0].as_f64().unwrap() > 0.0);
    assert_eq!(balanced["design"], "design runs/tiny/design/state.json");
    assert_contains(&balance_page(work), &["by finite elements"]);
}

fn a_failed_round_keeps_the_rounds_before(work: &Workplace) {
    let diverging = "echo '1 1 1U 4 0. 0. 0.005' > window.sta";
    let mut further = work.program(&balance(3));
    further.env("KIRIGAMI_CCX", failing_ccx(&work.path(""), diverging));
    assert!(further.output().unwrap().status.success());
    assert_contains(&balance_page(work), &["a further round failed: ", "\n| 2 |"]);
}

fn weights_are_tested_on_the_spot_check(work: &Workplace) {
    let test = "surrogate test runs/tiny/surrogate.safetensors runs/tiny/spot-check.parquet";
    let card = || json(&work.read("runs/tiny/surrogate.json"));
    // Six rays do not cover the region in which the states are drawn; the rays of the shipped
    // weights cover most of it.
    let tested = ["tested on tier tiny, 3 rays", " of 12 states inside the training domain"];
    assert_contains(&work.output(test), &tested);
    let shipped = test.replace("runs/tiny/surrogate.safetensors", SHIPPED_WEIGHTS);
    let page = work.output(&shipped);
    assert_contains(&page, &tested);
    assert_contains(&page, &["W, relative to its own value"]);
    assert_eq!(card()["spot_check"], Value::Null);
    assert_contains(&work.output(&format!("{test} --record random")), &tested);
    assert_eq!(card()["spot_check"]["errors"]["rows"], 12);
    assert_eq!(card()["spot_check"]["tier"], "tiny");
    // The hinges of the designed sheet are solved along their paths.
    let visited = work.output("surrogate visited runs/visited runs/tiny/design");
    assert_contains(&visited, &["tested on tier tiny, 12 rays", "of 60 states inside"]);
    let again = test.replace("runs/tiny/spot-check", "runs/visited/visited");
    assert_eq!(work.output(&again), visited);
    // No ray of the spot check is in the database.
    let [rays, spot] = ["hinges", "spot-check"].map(|name| {
        let database = Database::read(&work.path(&format!("runs/tiny/{name}.parquet"))).unwrap();
        let jobs = database.rays().iter().map(|ray| ray.job.clone());
        jobs.collect::<BTreeSet<String>>()
    });
    assert_eq!((rays.len(), spot.len()), (6, 3));
    assert!(rays.is_disjoint(&spot));
}

fn further_rays_are_planned(work: &Workplace) {
    let rays = "w_lig,alpha_deg,eta_a,eta_s,theta_deg\n18,80,-0.3,0.1,20\n12,90,0.1,0,30\n";
    work.write("configs/campaigns/further.csv", rays);
    work.edit(CAMPAIGN, &[("spot_rays = 3", "extra_rays = \"further.csv\"\nspot_rays = 3")]);
    let plan =
        json(&work.output(&format!("campaign plan {CAMPAIGN} --folder runs/tiny/campaign --json")));
    assert_eq!(plan["tally"]["open"], 2, "{plan}");
    work.edit(CAMPAIGN, &[("extra_rays = \"further.csv\"\n", "")]);
}

fn a_folder_keeps_its_campaign_and_its_scene(work: &Workplace) {
    let before = events(work);
    work.edit(CAMPAIGN, &[("name = \"tiny\"", "name = \"other\"")]);
    assert_contains(&work.error(RUN), &["contains the campaign `tiny`, not `other`"]);
    work.edit(SCENE, &[("[27.85, 0.0]", "[20.0, 0.0]")]);
    assert_contains(
        &work.error(&format!("design {SCENE}")),
        &["another run, the key `loads` changed"],
    );
    assert_eq!(events(work), before, "a refusal changes nothing");
}
