//! The main job from end to end with the real gmsh and CalculiX: campaign, database, weights, design.

mod common;
#[path = "common/failing_ccx.rs"]
mod failing_ccx;

use common::Workplace;
use failing_ccx::failing_ccx;
use std::path::Path;
use std::time::{Duration, Instant};

const CAMPAIGN: &str = "configs/campaigns/demo.toml";

#[test]
fn the_whole_chain_runs_resumes_and_refuses_to_overwrite() {
    let work = Workplace::new();
    // Short rays of few geometries take seconds; the steps are those of a real campaign.
    work.edit(
        CAMPAIGN,
        &[
            ("count = 40", "count = 6"),
            ("theta_deg = [-5.0, 40.0]", "theta_deg = [-5.0, 20.0]"),
            ("median_deg = 20.0", "median_deg = 15.0"),
        ],
    );
    work.edit(
        "configs/training/demo.toml",
        &[("epochs = 300", "epochs = 20")],
    );
    work.edit("configs/scenes/demo.toml", &[("steps = 150", "steps = 3")]);

    let run = format!("campaign run {CAMPAIGN} --folder runs/demo/campaign");
    assert!(work.output(&run).contains("6 rays complete"));
    let events = || {
        let hosts = std::fs::read_dir(work.path("runs/demo/campaign/hosts")).unwrap();
        let host = hosts.map(|entry| entry.unwrap().path()).next().unwrap();
        std::fs::read(host.join("events-1-of-1.jsonl")).unwrap()
    };
    let first = events();
    work.output(&run);
    assert_eq!(events(), first, "finished jobs are not run again");

    let collect = format!(
        "campaign collect {CAMPAIGN} --folder runs/demo/campaign --out runs/demo/hinges.parquet"
    );
    let status = format!("campaign status {CAMPAIGN} --folder runs/demo/campaign");
    assert!(work.output(&status).contains("6 rays complete"));
    work.output(&collect);
    assert!(work.error(&collect).contains("exists"));
    let export = "dataset export runs/demo/hinges.parquet --out runs/demo/hinges.csv";
    work.output(export);
    assert!(work.error(export).contains("--replace"));
    work.output(&format!("{export} --replace"));

    // Only the campaign that was run can be collected.
    work.edit(CAMPAIGN, &[("count = 6", "count = 7")]);
    for command in [format!("{collect} --replace"), status] {
        let message = work.error(&command);
        assert!(
            message.contains("has changed since it was run"),
            "{message}"
        );
    }
    work.edit(CAMPAIGN, &[("count = 7", "count = 6")]);

    let train = "train runs/demo/hinges.parquet --config configs/training/demo.toml \
                 --out runs/demo/surrogate.safetensors";
    assert!(work.output(train).contains("shear force"));
    assert!(work.error(train).contains("--replace"));

    let report = work.output("design configs/scenes/demo.toml --json");
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["hinges"].as_array().unwrap().len(), 12);
    for made in [
        "cut.dxf",
        "cut.svg",
        "flat.png",
        "deployed.png",
        "deployment.png",
        "report.txt",
        "run.html",
    ] {
        let size = std::fs::metadata(work.path("runs/demo/design").join(made))
            .unwrap()
            .len();
        assert!(size > 500, "{made} is {size} bytes");
    }

    let design = "configs/scenes/demo.toml --design runs/demo/design/state.json";
    // Without --design, the design of the run.
    let replay = "verify configs/scenes/demo.toml --ensemble runs/demo/surrogate-last.safetensors --tier tiny --out \
                  replay";
    let page = work.output(replay);
    for expected in [
        "The design ",
        "runs/demo/design/state.json: ",
        "states of 12 hinges",
        "| M_theta |",
        "standard deviations",
    ] {
        assert!(page.contains(expected), "{page}");
    }
    let states = std::fs::read_to_string(work.path("replay/replay.csv")).unwrap();
    assert!(states.lines().count() > 12 * 5, "{states}");
    // Of hinges that have left the domain of so few rays, D and D_peak are not known.
    assert!(states.lines().any(|line| line.contains(",,")), "{states}");
    let again = Instant::now();
    assert_eq!(work.output(replay), page, "solved once");
    assert!(again.elapsed() < Duration::from_secs(5), "solved once");

    // Six rays make no law whose corrections converge. Those of the shipped weights do, though the coarsest mesh is far
    // from them: the panels move less in every round.
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/pet-0.5mm/medium.safetensors");
    let balance = format!(
        "verify {design} --weights {} --equilibrium --rounds 2 --tier tiny --out balance --json",
        shipped.display()
    );
    let balanced: serde_json::Value = serde_json::from_str(&work.output(&balance)).unwrap();
    let movement = |round: usize| balanced["rounds"][round]["movement"].as_f64().unwrap();
    assert!(movement(1) < 0.7 * movement(0), "{balanced}");
    assert!(balanced["corners"][1].as_f64().unwrap() > 0.0, "{balanced}");
    assert_eq!(balanced["design"], "design runs/demo/design/state.json");
    let page = || std::fs::read_to_string(work.path("balance/equilibrium.md")).unwrap();
    assert!(page().contains("by finite elements"), "{}", page());
    // Where a further round fails, the rounds before are reported.
    let diverging = "echo '1 1 1U 4 0. 0. 0.005' > window.sta";
    let mut further = work.program(&balance.replace("--rounds 2", "--rounds 3"));
    further.env("KIRIGAMI_CCX", failing_ccx(&work.path(""), diverging));
    assert!(further.output().unwrap().status.success());
    assert!(page().contains("a further round failed: ") && page().contains("\n| 2 |"));
    polish_by_finite_elements(&work, design, &shipped);

    let check = "surrogate spot-check runs/demo/surrogate.safetensors --count 6 --states-per-ray 2 --tier tiny \
                 --out spot";
    let judged = work.output(check);
    assert!(
        judged.contains("6 states of 3 rays") && judged.contains("W within 5 %"),
        "{judged}"
    );
    let test = "surrogate test runs/demo/surrogate.safetensors spot/spot-check.parquet";
    assert!(
        work.output(test)
            .contains("6 of 6 states inside the training domain")
    );
    let on_paths = format!("{check} --scene configs/scenes/demo.toml")
        .replace("--out spot", "--out spot-paths")
        .replace("--count 6", "--count 30");
    let judged = work.output(&on_paths);
    for expected in [
        "runs/demo/design/state.json",
        "states inside the training domain",
    ] {
        assert!(judged.contains(expected), "{judged}");
    }
    // The rays of two checks are different jobs.
    work.output("dataset merge spot/spot-check.parquet spot-paths/spot-check.parquet --mixed --out both.parquet");
    let rows = |file: &str| -> u64 {
        let manifest = work.output(&format!("dataset summary {file} --json"));
        let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
        manifest["rows"].as_u64().unwrap()
    };
    let parts = ["spot", "spot-paths"].map(|folder| rows(&format!("{folder}/spot-check.parquet")));
    assert_eq!(rows("both.parquet"), parts[0] + parts[1]);

    let anywhere = "campaign extend configs/scenes/demo.toml --anywhere 5 --doubt 0 --rays configs/campaigns/anywhere.csv";
    assert!(work.error(anywhere).contains("--ensemble"));
    let anywhere = format!("{anywhere} --ensemble runs/demo/surrogate-last.safetensors");
    assert!(
        work.output(&anywhere)
            .contains("100.00 % of the training domain")
    );
    let rays = std::fs::read_to_string(work.path("configs/campaigns/anywhere.csv")).unwrap();
    assert_eq!(rays.lines().count(), 6, "{rays}");

    // Six rays with small rotations do not cover the hinge states of a design.
    let extend = format!("campaign extend {design} --rays configs/campaigns/further.csv");
    assert!(work.output(&extend).contains("rays added"));
    let further = std::fs::read_to_string(work.path("configs/campaigns/further.csv")).unwrap();
    let rays = further.lines().count() - 1;
    assert!((1..=12).contains(&rays), "{further}");
    work.edit(
        CAMPAIGN,
        &[("seed = 1", "seed = 1\nfurther_rays = \"further.csv\"")],
    );
    let plan = work.output(&format!(
        "campaign plan {CAMPAIGN} --folder runs/demo/campaign --json"
    ));
    let plan: serde_json::Value = serde_json::from_str(&plan).unwrap();
    assert_eq!(
        plan["tally"]["open"].as_u64().unwrap() as usize,
        rays,
        "{plan}"
    );
    work.edit(CAMPAIGN, &[("\nfurther_rays = \"further.csv\"", "")]);

    // A folder belongs to the campaign or scene that was run in it.
    work.edit(CAMPAIGN, &[("name = \"demo\"", "name = \"other\"")]);
    assert!(
        work.error(&run)
            .contains("contains the campaign `demo`, not `other`")
    );
    work.edit(
        "configs/scenes/demo.toml",
        &[("[27.85, 0.0]", "[20.0, 0.0]")],
    );
    assert!(
        work.error("design configs/scenes/demo.toml")
            .contains("another scene")
    );
    assert_eq!(events(), first, "a refusal changes nothing");
}

/// A few steps with the hinge law corrected to finite elements; the solves of the balance above are reused.
fn polish_by_finite_elements(work: &Workplace, design: &str, weights: &Path) {
    let polish = format!(
        "verify {design} --weights {} --equilibrium --rounds 1 --polish 4 --force --tier tiny --out balance --json",
        weights.display()
    );
    let gain: serde_json::Value = serde_json::from_str(&work.output(&polish)).unwrap();
    let loss = |of: &str, i: usize| gain[of][i]["loss"].as_f64().unwrap();
    assert!(gain["steps"].as_u64().unwrap() > 0, "{gain}");
    // The mesh is far from the weights: finite elements judge the given design otherwise than they do.
    assert!(loss("by_law", 0) != loss("by_elements", 0), "{gain}");
    assert!(loss("by_elements", 1) < loss("by_elements", 0), "{gain}");
    let page = std::fs::read_to_string(work.path("balance/polish.md")).unwrap();
    assert!(page.contains("by finite elements"), "{page}");
    for made in ["cut.dxf", "run.html", "deployed.png", "equilibrium.md"] {
        assert!(work.path("balance").join(made).exists(), "{made}");
    }
    let polished = design.replace("runs/demo/design/state.json", "balance/design.json");
    work.output(&format!("inspect equilibrium {polished} --json"));
}
