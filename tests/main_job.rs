//! The main job, end to end, with the real gmsh and CalculiX: campaign, database, weights, design.

mod common;

use common::Workplace;

const CAMPAIGN: &str = "configs/campaigns/demo.toml";

#[test]
fn the_whole_chain_runs_resumes_and_refuses_to_overwrite() {
    let work = Workplace::new();
    // Short rays of few geometries: seconds, and the same road as the real campaign.
    work.edit(
        CAMPAIGN,
        &[
            ("count = 40", "count = 6"),
            ("theta_deg = [10.0, 40.0]", "theta_deg = [10.0, 20.0]"),
        ],
    );
    work.edit(
        "configs/training/demo.toml",
        &[("epochs = 300", "epochs = 20")],
    );
    work.edit("configs/scenes/demo.toml", &[("steps = 150", "steps = 3")]);

    let run = format!("database run {CAMPAIGN} --folder runs/demo/campaign");
    assert!(work.output(&run).contains("6 rays complete"));
    let events = || std::fs::read(work.path("runs/demo/campaign/events-1-of-1.jsonl")).unwrap();
    let first = events();
    work.output(&run);
    assert_eq!(events(), first, "nothing finished is run again");

    let collect = format!(
        "database collect {CAMPAIGN} --folder runs/demo/campaign --out runs/demo/hinges.parquet"
    );
    let status = format!("database status {CAMPAIGN} --folder runs/demo/campaign");
    assert!(work.output(&status).contains("6 rays complete"));
    work.output(&collect);
    assert!(work.error(&collect).contains("exists"));

    // What was run is what is collected.
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
        "report.txt",
    ] {
        let size = std::fs::metadata(work.path("runs/demo/design").join(made))
            .unwrap()
            .len();
        assert!(size > 500, "{made} is {size} bytes");
    }

    // The folders belong to what was run in them.
    work.edit(CAMPAIGN, &[("name = \"demo\"", "name = \"other\"")]);
    assert!(
        work.error(&run)
            .contains("holds the campaign `demo`, not `other`")
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
