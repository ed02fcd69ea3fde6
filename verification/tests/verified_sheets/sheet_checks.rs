//! Designed sheets solved as a whole with gmsh and CalculiX, compared with the deployment by the
//! hinge law.

use fe_driver::{CalculiX, SolveService, SolveStore};
use mesher::Tier;
use scene::{Posture, Scene};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use support::severity::Severity;
use verification::{SheetCheck, SheetCost, SheetTask, VerificationError};

/// Four panels of film; `change` replaces a part of its text by another.
fn scene([from, to]: [&str; 2]) -> Scene {
    let text = r#"
title = "four panels"
material = "configs/materials/pet-0.5mm.toml"
thickness = 0.1
level = "standard"
load_steps = 10
output = "runs/four"
[sheet]
size = [140.0, 140.0]
panels = [2, 2]
[ligament]
start = 3.6
range = [2.0, 5.0]
[process]
fillet_ratio = 0.16
slit_width = 0.1
r_win = 20.0
[surrogate]
weights = "data/pet-0.5mm/medium.safetensors"
[posture]
kind = "held-flat"
[[supports]]
panel = [0, 1]
kind = "clamp"
[[loads]]
panel = [1, 0]
force = [0.0, -1.0]
[drive]
stroke = 8.0
[target.rectangle]
centre = [70.0, 70.0]
size = [150.0, 150.0]
rotation_deg = 0.0
[objective]
[optimiser]
method = "lbfgs"
steps = 1
learning_rate = 0.1
"#;
    assert!(text.contains(from), "{from}");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../four.toml");
    let text = text.replacen(from, to, 1);
    Scene::new(support::toml_file::parse(&text, &path).unwrap(), &path).unwrap()
}

const AS_IT_IS: [&str; 2] = ["", ""];

fn task(scene: &Scene, support: Option<Posture>) -> Result<SheetTask, VerificationError> {
    SheetTask::new(scene, &scene.start(), support, Tier::Tiny, None)
}

fn checked(task: &SheetTask, limit: Duration) -> SheetCheck {
    let folder = tempfile::tempdir().unwrap();
    let calculix = CalculiX::find().unwrap();
    let solve = task.solve(&calculix.versions()).unwrap();
    let service = SolveService {
        solver: Box::new(calculix),
        store: SolveStore(folder.path().to_owned()),
        workers: 1,
        limit,
        stop: &AtomicBool::new(false),
        progress: Box::new(|_, _| {}),
    };
    task.check("test", &service.solve(&[solve]).unwrap()[0])
}

#[test]
fn panels_held_flat_go_where_the_law_has_them() {
    let task = task(&scene(AS_IT_IS), None).unwrap();
    let check = checked(&task, Duration::from_secs(300));
    let branch = &check;
    let last = branch.last().unwrap();
    assert_eq!((last.fraction, &branch.stopped), (1.0, &None));
    // Windows of the coarsest tier are 9 % too stiff in W; the shape hardly depends on that.
    assert!(last.corners[0] < 0.003 * check.size, "{last:?}");
    let [by_law, by_elements] = last.load.unwrap();
    assert!((by_elements / by_law - 1.0).abs() < 0.12, "{last:?}");
    let [asked, made] = last.stroke.unwrap();
    assert!((asked - made).abs() < 1e-6);
    assert!((last.opening_deg[0] - last.opening_deg[1]).abs() < 0.3);
    assert_eq!((check.counts, branch.hinges.len()), ([4, 4], 4));
    for hinge in &branch.hinges {
        let [law, elements] = hinge.energy;
        assert!((elements / law - 1.0).abs() < 0.2, "{hinge:?}");
    }
    let flat = &check.findings[check.findings.len() - 1];
    assert_eq!(flat.severity, Severity::Note);
    let page = check.document().markdown();
    for part in ["agrees with the hinge law", "panels held flat", "| hinge | w_lig", "| 3 |"] {
        assert!(page.contains(part), "{page}");
    }
    // The path agrees with the path of the law from its beginning.
    let half = branch.path.iter().find(|state| state.fraction > 0.5).unwrap();
    assert!(half.corners[1] < 0.005 * check.size, "{half:?}");
}

/// Four of six panels; the other two move as the law predicts.
#[test]
fn a_patch_of_a_sheet_is_where_the_law_has_it() {
    let six = ["panels = [2, 2]", "panels = [2, 3]"];
    let task_of = |panel| {
        let mut scene = scene(six);
        scene.config.sheet.size = Some([140.0, 210.0]);
        scene.config.supports[0].panel = [0, 2];
        SheetTask::new(&scene, &scene.start(), None, Tier::Tiny, Some(panel))
    };
    let check = checked(&task_of([1, 2]).unwrap(), Duration::from_secs(300));
    assert!(check.is_patch && check.counts[0] == 4, "{:?}", check.counts);
    let branch = &check;
    let last = branch.last().unwrap();
    assert_eq!((last.fraction, last.load), (1.0, None));
    assert!(last.corners[0] < 0.003 * check.size, "{last:?}");
    assert!((last.opening_deg[0] - last.opening_deg[1]).abs() < 0.3);
    let numbers: Vec<usize> = branch.panels.iter().map(|panel| panel.panel).collect();
    assert_eq!(numbers, [2, 3, 4, 5]);
    assert!(check.document().to_string().contains("A patch of a larger sheet"));

    let versions = CalculiX::find().unwrap().versions();
    let pulled = task_of([1, 0]).unwrap().solve(&versions).unwrap_err();
    assert!(pulled.to_string().contains("pulled by a prescribed stroke"), "{pulled}");
    let absent = task_of([2, 0]).err().unwrap();
    assert!(absent.to_string().contains("no panel [2, 0]"), "{absent}");
}

/// At the time limit, what was solved is reported, and the rest is said not to be known.
#[test]
fn a_path_that_ends_early_is_reported_as_far_as_it_goes() {
    let task = task(&scene(AS_IT_IS), Some(Posture::Free)).unwrap();
    let check = checked(&task, Duration::from_secs(8));
    let branch = &check;
    let reason = branch.stopped.as_deref().unwrap();
    assert!(reason.contains("Nothing") && reason.contains("time limit"), "{reason}");
    assert_eq!(check.findings[0].severity, Severity::Error);
    let message = &check.findings[0].message;
    assert!(message.contains("not known") || message.contains("not solved"), "{message}");
    assert!(check.document().to_string().contains("free, nothing in the way"));
}

#[test]
fn what_has_no_counterpart_is_refused() {
    let refused = |change: [&str; 2], support: Option<Posture>| {
        let found = task(&scene(change), support).and_then(|task| {
            let versions = CalculiX::find().unwrap().versions();
            task.solve(&versions).map(|_| ())
        });
        found.err().map(|error| error.to_string()).unwrap_or_default()
    };
    let force = "force = [0.0, -1.0]";
    for (change, support, expected) in [
        (AS_IT_IS, Some(Posture::Hanging), "in which direction"),
        ([force, "force = [0.0, -1.0]\ncouple = 3.0"], None, "couples on panels"),
        (
            ["kind = \"clamp\"", "kind = \"clamp\"\nrotation_deg = 1.0"],
            None,
            "a support that turns",
        ),
    ] {
        let message = refused(change, support);
        assert!(message.contains(expected), "{expected}: {message}");
    }
    let unstructured =
        SheetTask::new(&scene(AS_IT_IS), &scene(AS_IT_IS).start(), None, Tier::Paper, None);
    let versions = CalculiX::find().unwrap().versions();
    let error = unstructured.unwrap().solve(&versions).unwrap_err();
    assert!(error.to_string().contains("no structured mesh"), "{error}");
}

#[test]
fn the_cost_is_that_of_measured_sheets() {
    let task = task(&scene(AS_IT_IS), None).unwrap();
    let calculix = CalculiX::find().unwrap();
    let solve = task.solve(&calculix.versions()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (limit, stop) = (Duration::from_secs(60), AtomicBool::new(false));
    let shape = &solve.problem.shape;
    let mesh = shape.mesh(folder.path(), &calculix.gmsh, limit, &stop).unwrap();
    let cost = SheetCost::of(&mesh, solve.problem.restraint);
    assert_eq!(cost.unknowns, 3 * mesh.nodes.len());
    assert!((3.0..60.0).contains(&cost.cpu_seconds), "{cost:?}");
    assert!((10.0..100.0).contains(&cost.memory_mib), "{cost:?}");
}
