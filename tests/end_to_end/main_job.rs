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

const CAMPAIGN: &str = "configs/campaigns/demo.toml";
const RUN: &str = "campaign run configs/campaigns/demo.toml --folder runs/demo/campaign";
const COLLECT: &str = "campaign collect configs/campaigns/demo.toml --folder runs/demo/campaign --out runs/demo/hinges.parquet";
const STATUS: &str = "campaign status configs/campaigns/demo.toml --folder runs/demo/campaign";

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
    story! { small_demo();
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
fn small_demo() -> Workplace {
    let work = Workplace::new();
    work.edit(
        CAMPAIGN,
        &[
            ("count = 40", "count = 6"),
            ("theta_deg = [-5.0, 40.0]", "theta_deg = [-5.0, 20.0]"),
            ("median_deg = 20.0", "median_deg = 15.0"),
        ],
    );
    work.edit("configs/training/demo.toml", &[("epochs = 300", "epochs = 20")]);
    work.edit("configs/scenes/demo.toml", &[("steps = 150", "steps = 3")]);
    work
}

const SHIPPED_WEIGHTS: &str = "data/pet-0.5mm/medium.safetensors";

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// The events that the campaign has logged.
fn events(work: &Workplace) -> Vec<u8> {
    let hosts = std::fs::read_dir(work.path("runs/demo/campaign/hosts")).unwrap();
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
            "spot check: 12 states of 3 rays, 0 states unknown, written to runs/demo/spot-check.parquet",
        ],
    );
    assert_contains(&work.error(COLLECT), &["exists"]);
    // Also if the spot check alone is there.
    let beside = COLLECT.replace("hinges.parquet", "other.parquet");
    assert_contains(&work.error(&beside), &["spot-check.parquet exists"]);
    assert!(!work.path("runs/demo/other.parquet").exists());
    let export = "dataset export runs/demo/hinges.parquet --out runs/demo/hinges.csv";
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
    let train = "train runs/demo/hinges.parquet --config configs/training/demo.toml \
                 --out runs/demo/surrogate.safetensors";
    assert_contains(&work.output(train), &["shear force"]);
    assert_contains(&work.error(train), &["--replace"]);
}

fn a_sheet_is_designed_with_all_its_files(work: &Workplace) {
    let report = json(&work.output("design configs/scenes/demo.toml --json"));
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
        let written = std::fs::metadata(work.path("runs/demo/design").join(file)).unwrap();
        assert!(written.len() > 500, "{file} is {} bytes", written.len());
    }
}

/// Six rays make no law whose corrections converge. The corrections of the shipped weights
/// converge, though the coarsest mesh is far from these weights: the panels move less in every
/// round.
fn balance(rounds: usize) -> String {
    format!(
        "verify shipped.toml --design runs/demo/design/state.json --equilibrium --rounds {rounds} --tier tiny --out balance --json"
    )
}

fn balance_page(work: &Workplace) -> String {
    work.read("balance/equilibrium.md")
}

fn the_design_is_balanced_by_finite_elements(work: &Workplace) {
    let scene = work.read("configs/scenes/demo.toml");
    let scene = scene
        .replace("../../runs/demo/surrogate.safetensors", SHIPPED_WEIGHTS)
        .replace("../materials", "configs/materials");
    work.write("shipped.toml", scene);
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
    assert_eq!(balanced["design"], "design runs/demo/design/state.json");
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
    let test = "surrogate test runs/demo/surrogate.safetensors runs/demo/spot-check.parquet";
    let card = || json(&work.read("runs/demo/surrogate.json"));
    // Six rays do not cover the region in which the states are drawn; the rays of the shipped
    // weights cover most of it.
    let tested = ["tested on tier tiny, 3 rays", " of 12 states inside the training domain"];
    assert_contains(&work.output(test), &tested);
    let shipped = test.replace("runs/demo/surrogate.safetensors", SHIPPED_WEIGHTS);
    let page = work.output(&shipped);
    assert_contains(&page, &tested);
    assert_contains(&page, &["W, relative to its own value"]);
    assert_eq!(card()["spot_check"], Value::Null);
    assert_contains(&work.output(&format!("{test} --record random")), &tested);
    assert_eq!(card()["spot_check"]["errors"]["rows"], 12);
    assert_eq!(card()["spot_check"]["tier"], "tiny");
    // The hinges of the designed sheet are solved along their paths.
    let visited = work.output("surrogate visited runs/visited runs/demo/design");
    assert_contains(&visited, &["tested on tier tiny, 12 rays", "of 60 states inside"]);
    let again = test.replace("runs/demo/spot-check", "runs/visited/visited");
    assert_eq!(work.output(&again), visited);
    // No ray of the spot check is in the database.
    let [rays, spot] = ["hinges", "spot-check"].map(|name| {
        let database = Database::read(&work.path(&format!("runs/demo/{name}.parquet"))).unwrap();
        let jobs = database.rows().iter().map(|row| row.job.clone());
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
        json(&work.output(&format!("campaign plan {CAMPAIGN} --folder runs/demo/campaign --json")));
    assert_eq!(plan["tally"]["open"], 2, "{plan}");
    work.edit(CAMPAIGN, &[("extra_rays = \"further.csv\"\n", "")]);
}

fn a_folder_keeps_its_campaign_and_its_scene(work: &Workplace) {
    let before = events(work);
    work.edit(CAMPAIGN, &[("name = \"demo\"", "name = \"other\"")]);
    assert_contains(&work.error(RUN), &["contains the campaign `demo`, not `other`"]);
    work.edit("configs/scenes/demo.toml", &[("[27.85, 0.0]", "[20.0, 0.0]")]);
    assert_contains(
        &work.error("design configs/scenes/demo.toml"),
        &["another run, the key `loads` changed"],
    );
    assert_eq!(events(work), before, "a refusal changes nothing");
}
