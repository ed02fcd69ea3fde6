//! Designed sheets solved as a whole with gmsh and CalculiX, compared with the deployment by the
//! hinge law.

use fe_driver::{CalculiX, SolveService, SolveStore};
use mesher::{Panels, Tier};
use scene::{CellsConfig, Posture, Scene, SceneConfig, TrimmedPanel};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use support::severity::Severity;
use verification::{SheetCheck, SheetCost, SheetTask, VerificationError};

/// Four panels of film, after a change.
fn scene(change: impl FnOnce(&mut SceneConfig)) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/sheets/four-panels.toml");
    let mut config: SceneConfig = support::toml_file::read(&path).unwrap();
    config.load_steps = 10;
    config.drive.as_mut().unwrap().stroke = 8.0;
    change(&mut config);
    Scene::new(config, &path).unwrap()
}

fn four_panels() -> Scene {
    scene(|_| ())
}

fn task(scene: &Scene, support: Option<Posture>) -> Result<SheetTask, VerificationError> {
    SheetTask::new(scene, &scene.start(), support, Tier::Tiny, Panels::Rigid)
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
    let task = task(&four_panels(), None).unwrap();
    let check = checked(&task, Duration::from_secs(300));
    let last = check.last().unwrap();
    assert_eq!((last.fraction, &check.stopped), (1.0, &None));
    // Windows of the coarsest tier are 9 % too stiff in W; the shape hardly depends on that.
    assert!(last.corners[0] < 0.003 * check.size, "{last:?}");
    let [by_law, by_elements] = last.load.unwrap();
    assert!((by_elements / by_law - 1.0).abs() < 0.12, "{last:?}");
    let [asked, made] = last.stroke.unwrap();
    assert!((asked - made).abs() < 1e-6);
    assert!((last.opening_deg[0] - last.opening_deg[1]).abs() < 0.3);
    assert_eq!((check.counts, check.hinges.len()), ([4, 4], 4));
    for hinge in &check.hinges {
        let [law, elements] = hinge.energy;
        assert!((elements / law - 1.0).abs() < 0.2, "{hinge:?}");
    }
    let flat = &check.findings[check.findings.len() - 1];
    assert_eq!(flat.severity, Severity::Note);
    let page = check.document().markdown();
    for part in ["agrees with the hinge law", "panels held flat", "| hinge | w_lig", "| 3 |"] {
        assert!(page.contains(part), "{page}");
    }
    let [seen, of_law] = check.seen.unwrap();
    assert!((seen - of_law).abs() < 0.01 && page.contains("Seen of the target"), "{seen} {of_law}");
    let [by_law, by_elements] = check.supports.each_ref().map(|forces| forces[0]);
    assert!((by_elements / by_law - 1.0).abs() < 0.12, "{:?}", check.supports);
    // The path agrees with the path of the law from its beginning.
    let half = check.path.iter().find(|state| state.fraction > 0.5).unwrap();
    assert!(half.corners[1] < 0.005 * check.size, "{half:?}");
}

/// The panel at the upper right has a dent and two parts outside of its cell.
#[test]
fn a_trimmed_panel_is_meshed_as_its_boundary() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.45], [1.3, 0.6], [0.7, 0.7], [0.6, 1.3]];
    let corners = corners.into_iter().chain([[0.45, 1.0], [0.0, 1.0]]).collect();
    let trimmed = vec![TrimmedPanel { panel: [1, 1], corners, outer: Vec::new() }];
    let cells = CellsConfig { voids: vec!["o".to_owned()], trimmed };
    let scene = scene(|config| config.cells = Some(cells));
    let task = SheetTask::new(&scene, &scene.start(), None, Tier::Tiny, Panels::Meshed).unwrap();
    let versions = CalculiX::find().unwrap().versions();
    let shape = task.solve(&versions).unwrap().problem.shape;
    let found = shape.panels[3].corners[3..6].iter().flatten().map(|x| x.round());
    assert_eq!(found.collect::<Vec<_>>(), [161.0, 112.0, 119.0, 119.0, 112.0, 161.0]);
    let last = checked(&task, Duration::from_secs(300));
    let last = last.last().unwrap();
    assert!(last.fraction == 1.0 && last.corners[0] < 0.5, "{last:?}");
}

/// At the time limit, what was solved is reported, and the rest is said not to be known.
#[test]
fn a_path_that_ends_early_is_reported_as_far_as_it_goes() {
    let task = task(&four_panels(), Some(Posture::Free)).unwrap();
    let check = checked(&task, Duration::from_secs(8));
    let reason = check.stopped.as_deref().unwrap();
    let expected = "sheet of 4 panels and 4 hinges, tier tiny: ccx was terminated at its time";
    assert!(reason.starts_with(expected), "{reason}");
    assert_eq!(check.findings[0].severity, Severity::Error);
    let message = &check.findings[0].message;
    assert!(message.contains("not known") || message.contains("not solved"), "{message}");
    assert!(check.document().to_string().contains("free, nothing in the way"));
}

#[test]
fn what_has_no_counterpart_is_refused() {
    let refused = |change: fn(&mut SceneConfig), support: Option<Posture>| {
        let found = task(&scene(change), support).and_then(|task| {
            let versions = CalculiX::find().unwrap().versions();
            task.solve(&versions).map(|_| ())
        });
        found.err().map(|error| error.to_string()).unwrap_or_default()
    };
    let cases: [(fn(&mut SceneConfig), _, _); 4] = [
        (|_| (), Some(Posture::Hanging), "in which direction"),
        (|_| (), Some(Posture::Lying), "use --sheet meshed"),
        (|config| config.loads[0].couple = 3.0, None, "couples on panels"),
        (|config| config.supports[0].rotation_deg = 1.0, None, "a support that turns"),
    ];
    for (change, support, expected) in cases {
        let message = refused(change, support);
        assert!(message.contains(expected), "{expected}: {message}");
    }
    let unstructured =
        SheetTask::new(&four_panels(), &four_panels().start(), None, Tier::Paper, Panels::Rigid);
    let versions = CalculiX::find().unwrap().versions();
    let error = unstructured.unwrap().solve(&versions).unwrap_err();
    assert!(error.to_string().contains("no structured mesh"), "{error}");
}

#[test]
fn the_cost_is_that_of_measured_sheets() {
    let task = task(&four_panels(), None).unwrap();
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
