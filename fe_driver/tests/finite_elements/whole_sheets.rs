//! Sheets solved as a whole with gmsh and CalculiX: two panels and one hinge, compared with the
//! window of that hinge.

use crate::common::film;
use fe_driver::{
    AttemptKind, CalculiX, DeformationPath, FailureKind, HeldPanel, HingePath, OutOfPlaneRestraint,
    Place, Pulled, SheetProblem, SheetSolve, SheetState, SheetStates, Solution, Solve,
    SolveService, SolveStore, Solver, WindowProblem, WindowSolve,
};
use hinge::{HingeDeformation, HingeDesign, SheetMaterial};
use mesher::{Frame, MeshError, PanelPolygon, Panels, PlacedWindow, PlaneRecipe, SheetShape, Tier};
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Height and width of a panel (mm).
const HEIGHT: f64 = 60.0;
const WIDTH: f64 = 50.0;
const KERF: f64 = 0.1;
const LIMIT: Duration = Duration::from_secs(300);

fn design() -> HingeDesign {
    HingeDesign {
        w_lig: 3.6,
        alpha: 90f64.to_radians(),
        fillet_ratio: 0.16,
        kerf: KERF,
        r_win: 20.0,
    }
}

fn thin() -> SheetMaterial {
    SheetMaterial { thickness: 0.1, ..film() }
}

/// Two panels side by side, joined at the upper edge. The left one is clamped, the right one is
/// pulled to the right by a point below the hinge, which opens the cut.
fn problem(keeping: OutOfPlaneRestraint, stroke: f64) -> SheetProblem {
    let PlaneRecipe::Structured(plane) = Tier::Tiny.recipe().plane else {
        panic!("the tier has a structured mesh");
    };
    let (left, right) = (WIDTH - 0.5 * KERF, WIDTH + 0.5 * KERF);
    let panel = |low: f64, high: f64| PanelPolygon {
        corners: vec![[low, 0.0], [high, 0.0], [high, HEIGHT], [low, HEIGHT]],
        marks: Vec::new(),
    };
    let at = [1.5 * WIDTH, 0.3 * HEIGHT];
    let mut pulled = panel(right, 2.0 * WIDTH);
    pulled.marks.push(at);
    SheetProblem {
        shape: SheetShape {
            thickness: 0.1,
            model: Panels::Meshed,
            panels: vec![panel(0.0, left), pulled],
            windows: vec![PlacedWindow {
                design: design(),
                frame: Frame { origin: [WIDTH, HEIGHT], e_x: [1.0, 0.0] },
                panels: [(0, 2), (1, 3)],
                bump: 1.0,
            }],
            plane,
            layers: 2,
            half: false,
            element_size: 12.0,
        },
        tier: Tier::Tiny,
        material: thin(),
        restraint: keeping,
        held: vec![HeldPanel { panel: 0, place: Place::Panel, motion: [Some(0.0); 2] }],
        pulled: vec![Pulled { panel: 1, at, force: [2.0, 0.0] }],
        stroke: Some(stroke),
        down: None,
        step: SheetProblem::usual_step(keeping, false),
        contact: false,
        dynamic: false,
    }
}

fn attempt(problem: &SheetProblem) -> Solution<SheetStates> {
    let calculix = CalculiX::find().unwrap();
    let solve = SheetSolve::new(problem.clone(), &calculix.versions());
    let folder = tempfile::tempdir().unwrap();
    let stop = AtomicBool::new(false);
    calculix.attempt(&solve, folder.path(), LIMIT, &stop).unwrap()
}

fn solved(problem: &SheetProblem) -> SheetStates {
    let solution = attempt(problem);
    assert!(solution.stopped.is_none(), "{:?}", solution.stopped);
    solution.samples
}

/// (a, s, theta) of the hinge between the two panels, in the mean frame.
fn deformation(state: &SheetState) -> HingeDeformation {
    let tip = [WIDTH, HEIGHT - design().w_lig];
    let [a, b] = [0, 1].map(|panel| state.panels[panel].moved(tip));
    let [alpha, beta] = [0, 1].map(|panel| state.panels[panel].turn());
    let (sin, cos) = (-0.5 * (alpha + beta)).sin_cos();
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    HingeDeformation { a: cos * x - sin * y, s: sin * x + cos * y, theta: beta - alpha }
}

fn total_energy(state: &SheetState) -> f64 {
    state.panel_energy + state.hinges[0].energy
}

/// The sheet is its window: on the path that the hinge has in the sheet, the window stores the same
/// energy. And the work of the load is the energy of the sheet.
#[test]
fn a_hinge_of_a_sheet_held_flat_is_its_window() {
    let sheet = solved(&problem(OutOfPlaneRestraint::HeldFlat, 8.0));
    let end = sheet.states.last().unwrap();
    assert_eq!((end.lambda, end.fraction), (1.0, 1.0));
    assert!((end.stroke - 8.0).abs() < 1e-6, "{}", end.stroke);
    assert!(end.panels.iter().all(|panel| panel.tilt() < 1e-9));
    assert!(end.panel_energy < 0.01 * total_energy(end), "{}", end.panel_energy);

    let (mut work, mut before) = (0.0, [0.0; 2]);
    for state in &sheet.states {
        let load = 2.0 * state.load_factor;
        work += 0.5 * (load + before[1]) * (state.stroke - before[0]);
        before = [state.stroke, load];
    }
    let energy = total_energy(end);
    assert!((work - energy).abs() < 2e-3 * energy, "{work} {energy}");
    // The only horizontal force is the load; the reaction balances it.
    assert!((end.support_forces[0][0] + before[1]).abs() < 1e-3 * before[1]);

    let states: Vec<HingeDeformation> = sheet.states.iter().map(deformation).collect();
    let path = DeformationPath::through(&states).unwrap();
    let hinge = HingePath { design: design(), path };
    let calculix = CalculiX::find().unwrap();
    let mut window =
        WindowSolve::new(WindowProblem::new(hinge, &thin(), Tier::Tiny), &calculix.versions());
    window.mesh.layers = 2;
    let folder = tempfile::tempdir().unwrap();
    let stop = AtomicBool::new(false);
    let window = calculix.attempt(&window, folder.path(), LIMIT, &stop);
    let window = *window.unwrap().samples.last().unwrap();
    let of_sheet = end.hinges[0];
    assert!(window.theta > 0.1, "{window:?}");
    assert!(
        (window.w - of_sheet.energy).abs() < 0.01 * window.w,
        "{} {}",
        window.w,
        of_sheet.energy
    );
    assert!((window.d_peak.unwrap() - of_sheet.d_peak).abs() < 0.01);
}

/// A ligament that is wide against the thickness pushes panels that nothing holds out of the plane.
#[test]
fn a_free_film_tilts() {
    let sheet = solved(&problem(OutOfPlaneRestraint::Nothing, 1.0));
    let end = sheet.states.last().unwrap();
    let tilt = end.panels[1].tilt().to_degrees();
    assert!((1.0..90.0).contains(&tilt), "{tilt}");
    assert_eq!(end.panels[0].tilt(), 0.0);
    let surface = sheet.surface.unwrap();
    let steepest = surface.tilts_deg().into_iter().fold(0.0, f64::max);
    assert!(steepest >= 0.9 * tilt, "{steepest} {tilt}");
    // Bumps on the other side: the mirror image in the plane of the sheet.
    let mut mirrored = problem(OutOfPlaneRestraint::Nothing, 1.0);
    mirrored.shape.windows[0].bump = -1.0;
    let mirrored = solved(&mirrored);
    let other = mirrored.states.last().unwrap();
    let [up, down] = [end, other].map(|state| state.panels[1].shift[2]);
    assert!((up + down).abs() < 1e-3 * up.abs(), "{up} {down}");
    assert!((end.load_factor / other.load_factor - 1.0).abs() < 1e-4);
}

/// A plate of 3 mm, whole or the half above its middle.
#[test]
fn rigid_panels_move_as_meshed_panels() {
    let mut plate = problem(OutOfPlaneRestraint::HeldFlat, 4.0);
    (plate.shape.thickness, plate.material.thickness) = (3.0, 3.0);
    (plate.shape.windows[0].bump, plate.down) = (0.0, Some([0.0, -1.0, 0.0]));
    let mut half = plate.clone();
    (half.shape.half, half.shape.layers) = (true, 1);
    for mut rigid in [plate.clone(), half] {
        rigid.shape.model = Panels::Rigid;
        let ends = [&plate, &rigid].map(|problem| solved(problem).states.pop().unwrap());
        let [one, other] = &ends;
        assert!((other.load_factor / one.load_factor - 1.0).abs() < 0.01, "{ends:?}");
        let turned = one.panels[1].turn() - other.panels[1].turn();
        assert!(turned.abs().to_degrees() < 0.1, "{ends:?}");
        let [p, q] = ends.each_ref().map(|end| end.panels[1].moved([2.0 * WIDTH, 0.0]));
        assert!(std::iter::zip(p, q).all(|(p, q)| (p - q).abs() < 0.1), "{p:?} {q:?}");
        let [p, q] = ends.each_ref().map(|end| end.support_forces[0]);
        assert!((p[0] - q[0]).hypot(p[1] - q[1]) < 0.02 * p[0].abs(), "{p:?} {q:?}");
    }
}

/// A clamp and a screw that moves hold a plate on a board, with equal and opposite forces.
#[test]
fn a_screw_holds_a_plate_on_a_board() {
    let mut mounted = problem(OutOfPlaneRestraint::Nothing, 0.0);
    (mounted.shape.thickness, mounted.material.thickness) = (3.0, 3.0);
    (mounted.shape.model, mounted.stroke) = (Panels::Rigid, None);
    mounted.shape.windows[0].bump = 0.02;
    mounted.pulled.clear();
    let pin = |panel, at| HeldPanel { panel, place: Place::Point(at), motion: [Some(3.0), None] };
    mounted.held.push(pin(1, [90.0, 10.0]));
    let end = solved(&mounted).states.pop().unwrap();
    let [x, _, z] = end.panels[1].moved([90.0, 10.0]);
    assert!((x - 93.0).abs() < 1e-3 && z.abs() < 1e-3, "{x} {z}");
    let [one, other] = [0, 1].map(|support| end.support_forces[support][0]);
    assert!(other > 0.1 && (one + other).abs() < 1e-3 * other, "{one} {other}");
    mounted.held = [[10.0, 10.0], [10.0, 50.0], [90.0, 10.0]].map(|at| pin(0, at)).to_vec();
    assert_eq!(mounted.validate(), Ok(()));
}

/// A sheet on a table sinks by its weight over the stiffness of the table's springs, and the table
/// carries its weight.
#[test]
fn a_table_carries_the_sheet() {
    let mut lying = problem(OutOfPlaneRestraint::Table, 0.05);
    lying.down = Some([0.0, 0.0, -1.0]);
    let sheet = solved(&lying);
    let end = sheet.states.last().unwrap();
    assert!(end.panels[1].tilt().to_degrees() < 0.5);
    assert!(end.panels[1].z[0] > -0.01, "{:?}", end.panels[1].z);
}

#[test]
fn weight_in_the_plane_comes_on_before_the_stroke() {
    let mut heavy = problem(OutOfPlaneRestraint::HeldFlat, 1.0);
    heavy.down = Some([0.0, -1.0, 0.0]);
    let sheet = solved(&heavy);
    let first = sheet.states.iter().find(|state| state.lambda < 0.1).unwrap();
    assert_eq!(first.fraction, 0.0);
    assert!(first.stroke.abs() < 1e-9);
    // The pulled panel and the window hang from the nodes of the clamped panel; no other force is
    // upright.
    let end = sheet.states.last().unwrap();
    let by_area = thin().weight_by_area();
    let panel = by_area * WIDTH * HEIGHT;
    let window = by_area * 0.25 * PI * design().r_win.powi(2);
    let [_, up, _] = end.support_forces[0];
    assert!((panel..panel + window).contains(&up), "{up} {panel}");
}

/// A plate of 3 mm whose pulled panel is pushed against the clamped one: about the ligament, and
/// without contact the far ends of the flanks would pass each other.
#[test]
fn the_flanks_of_a_cut_that_is_pushed_shut_touch() {
    let mut shut = problem(OutOfPlaneRestraint::HeldFlat, 0.0);
    shut.stroke = None;
    (shut.contact, shut.step) =
        (true, SheetProblem::usual_step(OutOfPlaneRestraint::HeldFlat, true));
    shut.shape.thickness = 3.0;
    shut.shape.windows[0].bump = 0.02;
    shut.material.thickness = 3.0;
    shut.pulled[0].force = [-5.0, 0.0];
    let sheet = solved(&shut);
    let gaps = sheet.states.iter().map(|state| {
        let far_end = |panel: usize, corner: usize| {
            state.panels[panel].moved(shut.shape.panels[panel].corners[corner])[0]
        };
        far_end(1, 0) - far_end(0, 1)
    });
    let gaps: Vec<f64> = gaps.collect();
    assert!((-0.02..0.0).contains(gaps.last().unwrap()), "{gaps:?}");
}

#[test]
fn a_sheet_is_solved_once_and_a_snap_is_followed_with_inertia() {
    let folder = tempfile::tempdir().unwrap();
    let stop = AtomicBool::new(false);
    let calculix = CalculiX::find().unwrap();
    let solve = SheetSolve::new(problem(OutOfPlaneRestraint::HeldFlat, 0.5), &calculix.versions());
    let service = SolveService {
        solver: Box::new(calculix),
        store: SolveStore(folder.path().to_owned()),
        workers: 1,
        limit: LIMIT,
        stop: &stop,
        progress: Box::new(|_, _| {}),
    };
    let once = service.solve(std::slice::from_ref(&solve)).unwrap();
    assert!(once[0].complete().is_ok());
    let again = service.solve(std::slice::from_ref(&solve)).unwrap();
    assert_eq!(once, again);
    assert_eq!(again[0].record.attempts, 1);

    let next = |attempt, failure| solve.next_attempt(attempt, failure, 0.3);
    assert_eq!(next(AttemptKind::Requested, FailureKind::Diverged), Some(AttemptKind::Dynamic));
    assert_eq!(next(AttemptKind::Dynamic, FailureKind::Diverged), None);
    assert_eq!(next(AttemptKind::Requested, FailureKind::TimedOut), None);
    let dynamic = solve.attempted(AttemptKind::Dynamic).problem;
    let moved = solved(&dynamic);
    let end = moved.states.last().unwrap();
    let still = once[0].samples.states.last().unwrap();
    assert!(end.kinetic_energy < 0.02 * total_energy(end));
    assert!(
        (end.load_factor / still.load_factor - 1.0).abs() < 0.03,
        "{} {}",
        end.load_factor,
        still.load_factor
    );
}

#[test]
fn sheets_that_cannot_be_solved_are_refused() {
    let calculix = CalculiX::find().unwrap();
    let refused = |problem: SheetProblem| {
        let solve = SheetSolve::new(problem, &calculix.versions());
        let folder = tempfile::tempdir().unwrap();
        let stop = AtomicBool::new(false);
        let found = calculix.attempt(&solve, folder.path(), LIMIT, &stop);
        found.unwrap_err().to_string()
    };
    let flat = || problem(OutOfPlaneRestraint::HeldFlat, 1.0);
    let mut small = flat();
    small.shape.panels[1].corners[0][1] = 45.0;
    small.shape.panels[1].corners[1][1] = 45.0;
    let mut beside = flat();
    beside.shape.windows[0].frame.origin[1] -= 1.0;
    let mut in_window = flat();
    in_window.shape.panels[1].marks[0] = [WIDTH + 8.0, HEIGHT - 8.0];
    let mut outside = flat();
    outside.shape.panels[1].marks[0] = [-20.0, 5.0];
    let mut unheld = flat();
    unheld.held.clear();
    let mut still = flat();
    still.pulled.clear();
    let mut falling = problem(OutOfPlaneRestraint::Nothing, 1.0);
    falling.held[0].place = Place::Point([0.2 * WIDTH, 0.2 * HEIGHT]);
    for (problem, expected) in [
        (small, "panel 1 is too small for its windows"),
        (beside, "does not end on the edges"),
        (in_window, "is in the window of a hinge"),
        (outside, "is not inside the panel"),
        (unheld, "no panel is held"),
        (still, "nothing pulls the sheet"),
        (falling, "no panel is clamped"),
    ] {
        let message = refused(problem);
        assert!(message.contains(expected), "{expected}: {message}");
    }
    let mut thin = flat().shape;
    thin.thickness = 0.0;
    let folder = tempfile::tempdir().unwrap();
    let stop = AtomicBool::new(false);
    let error = thin.mesh(folder.path(), &calculix.gmsh, LIMIT, &stop);
    assert!(matches!(error, Err(MeshError::Invalid(_))));
}
