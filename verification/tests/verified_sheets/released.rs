//! Unloaded hinges and sheets: by springs that slip, whose rest is known exactly, and by finite
//! elements at the limits.

use design::objective::design_problem::Deployment;
use design::sheet::kinematics::deployed_corners;
use fe_driver::{
    CalculiX, DrawnStates, HingePath, Ray, Solution, SolveError, SolveService, SolveStore, Solver,
    ToolVersions, WindowSolve, random_paths,
};
use hinge::{
    HingeConstants, HingeDeformation, HingeSample, Regime, ReleasedHinge, ReleasedSample,
    SheetMaterial,
};
use mesher::Tier;
use scene::analysis::springback::{ResidualShape, released_hinges};
use scene::{Scene, SceneConfig};
use std::array::from_fn;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use surrogate::Springback;
use tempfile::TempDir;
use verification::{ElementWindows, balanced, first_guess, released_by_elements, releases};

/// (k_a, k_s) (N/mm) and k_theta (N mm/rad) of the hinges.
const STIFFNESS: [f64; 3] = [6.0, 12.0, 120.0];

static NEVER: AtomicBool = AtomicBool::new(false);

/// Three springs a hinge, that slip at the forces (N, N, N mm).
#[derive(Clone, Copy)]
struct Slipping([f64; 3]);

impl Solver for Slipping {
    fn versions(&self) -> ToolVersions {
        let [gmsh, ccx] = ["none", "slipping"].map(str::to_owned);
        ToolVersions { gmsh, ccx }
    }

    fn attempt(
        &self,
        solve: &WindowSolve,
        _work: &Path,
        _limit: Duration,
        _stop: &AtomicBool,
    ) -> Result<Solution, SolveError> {
        let mut slipped = [0.0; 3];
        let path = &solve.problem.hinge.path;
        let corners: Vec<f64> = path.corners().collect();
        let lambdas = corners
            .windows(2)
            .flat_map(|leg| (1..=20).map(|k| leg[0] + f64::from(k) / 20.0 * (leg[1] - leg[0])));
        let samples = lambdas.map(|lambda| {
            let state = path.at(lambda);
            let forces = self.forces(&mut slipped, &state);
            HingeSample {
                lambda,
                a: state.a,
                s: state.s,
                theta: state.theta,
                f_a: forces[0],
                f_s: forces[1],
                m_theta: forces[2],
                d_peak: Some(0.0),
                ..HingeSample::default()
            }
        });
        Ok(Solution {
            samples: samples.collect(),
            elements: 1,
            cpu_seconds: Some(1.0),
            ..Solution::default()
        })
    }
}

impl Slipping {
    fn forces(&self, slipped: &mut [f64; 3], state: &HingeDeformation) -> [f64; 3] {
        let state = state.to_array();
        from_fn(|i| {
            let limit = self.0[i];
            let force = (STIFFNESS[i] * (state[i] - slipped[i])).clamp(-limit, limit);
            slipped[i] = state[i] - force / STIFFNESS[i];
            force
        })
    }

    /// A hinge that was unloaded from a state to which it was driven without return.
    fn released(&self, reached: &HingeDeformation) -> ReleasedHinge {
        let mut slipped = [0.0; 3];
        self.forces(&mut slipped, reached);
        ReleasedHinge {
            rest: slipped.into(),
            stiffness: from_fn(|i| from_fn(|j| if i == j { STIFFNESS[i] } else { 0.0 })),
        }
    }
}

fn service(solver: impl Solver + 'static, folder: &TempDir) -> SolveService<'static> {
    SolveService {
        solver: Box::new(solver),
        store: SolveStore(folder.path().join("solves")),
        workers: 2,
        limit: Duration::from_secs(600),
        stop: &NEVER,
        progress: Box::new(|_, _| {}),
    }
}

/// The sheet of the demo with the smallest shipped weights.
fn scene() -> Scene {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let path = repository.join("configs/scenes/demo.toml");
    let mut config: SceneConfig = support::toml_file::read(&path).unwrap();
    let weights = repository.join("data/pet-0.5mm/small.safetensors");
    config.name_weights(&weights).unwrap();
    Scene::new(config, &path).unwrap()
}

fn rows(solver: Slipping, count: usize) -> Vec<ReleasedSample> {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene();
    let surrogate = scene.surrogate().unwrap();
    // A law knows one hole.
    let mut domain = surrogate.domain().clone();
    domain.holes = None;
    let inside =
        DrawnStates { domain: &domain, constants: &surrogate.card().hinge, regime: Regime::Film };
    let drawn = random_paths(inside, count, 1, 5);
    let hinges: Vec<HingePath> = drawn.into_iter().map(|path| path.hinge).collect();
    let guess = |design: &_, reached: &_| first_guess(&scene.material, design, reached);
    let windows = service(solver, &folder);
    let found = releases(&windows, &hinges, &scene.material, Tier::Tiny, guess).unwrap();
    assert_eq!(found.failed, Vec::<String>::new());
    found.rows
}

fn apart(x: &HingeDeformation, y: &HingeDeformation, w_lig: f64) -> f64 {
    let [[a, s], [b, t]] = [x.eta(w_lig), y.eta(w_lig)];
    ((a - b).powi(2) + (s - t).powi(2) + (x.theta - y.theta).powi(2)).sqrt()
}

#[test]
fn hinges_are_found_at_rest_where_their_springs_have_slipped_to() {
    let solver = Slipping([6.0, 9.0, 20.0]);
    for row in rows(solver, 20) {
        let (found, exact) = (row.released(), solver.released(&row.reached()));
        let error = apart(&found.rest, &exact.rest, row.w_lig);
        assert!(error < 1e-6, "{error} {row:?}");
        for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
            let error = (found.stiffness[i][j] - exact.stiffness[i][j]).abs();
            assert!(error < 1e-6 * STIFFNESS[2], "{found:?}");
        }
    }
}

#[test]
fn what_never_yields_springs_back_to_the_flat_state() {
    for row in rows(Slipping([f64::INFINITY; 3]), 5) {
        let rest = row.released().rest;
        assert!(apart(&rest, &HingeDeformation::default(), row.w_lig) < 1e-9);
    }
}

/// The sheet without loads by its exact hinges is what the rounds of solved windows find, from a
/// law that is only nearly right.
#[test]
fn a_sheet_that_is_let_go_has_the_hinges_of_the_solver() {
    let solver = Slipping([40.0, 60.0, 45.0]);
    let scene = scene();
    let rows = rows(solver, 60);
    let law = Springback::fit(&rows, &[], &scene.material, "tiny").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let service = &service(solver, &folder);
    let tier = Tier::Tiny;
    let windows = ElementWindows { tier, service };
    let (found, problem) = balanced(&scene, &scene.start(), &windows, 6).unwrap();
    let deployed = found.by_elements();
    let released = released_by_elements(&scene, &found, &problem, &law, &windows, 8).unwrap();
    assert!(released.is_balanced, "{:?}", released.movements);
    // The springs have slipped along the whole path, which need not be straight.
    let exact = (0..deployed.sheet.hinges.len())
        .map(|hinge| {
            let mut slipped = [0.0; 3];
            let mut from = HingeDeformation::default().to_array();
            for step in &deployed.path {
                let to = step.deformations[hinge].to_array();
                for k in 1..=100 {
                    let share = f64::from(k) / 100.0;
                    let state = from_fn(|i| from[i] + share * (to[i] - from[i]));
                    solver.forces(&mut slipped, &HingeDeformation::from(state));
                }
                from = to;
            }
            ReleasedHinge { rest: slipped.into(), ..solver.released(&HingeDeformation::default()) }
        })
        .collect();
    let exact = problem.unload(deployed, exact).unwrap();
    let exact = ResidualShape::new(&problem, deployed, &exact).unwrap();
    let [found, exact] = [&released.by_elements, &exact].map(|stays| stays.rotations.clone());
    for ([_, found], [_, exact]) in std::iter::zip(found, exact) {
        assert!((found - exact).abs() < 1e-3, "{found} {exact}");
    }
    let share = released.by_elements.share().unwrap();
    assert!((0.05..0.95).contains(&share), "{share}");
}

#[test]
fn a_law_for_another_material_is_refused() {
    let scene = scene();
    let rows = rows(Slipping([6.0, 9.0, 12.0]), 40);
    let other = SheetMaterial { young: 0.5 * scene.material.young, ..scene.material.clone() };
    let law = Springback::fit(&rows, &[], &other, "tiny").unwrap();
    let problem = scene.problem().unwrap();
    let deployed = problem.deploy(&scene.start()).unwrap();
    let refused = released_hinges(&scene, &problem, &law, &deployed).unwrap_err();
    assert!(refused.to_string().contains("another material"), "{refused}");
}

/// Without springs that slip, an unloaded sheet is flat again.
#[test]
fn an_elastic_sheet_is_flat_again() {
    let scene = scene();
    let problem = scene.problem().unwrap();
    let deployed = problem.deploy(&scene.start()).unwrap();
    let elastic = Slipping([f64::INFINITY; 3]).released(&HingeDeformation::default());
    let hinges = vec![elastic; deployed.sheet.hinges.len()];
    let released = problem.unload(&deployed, hinges).unwrap();
    let flat: Vec<[f64; 3]> = vec![[0.0; 3]; deployed.sheet.panels.len()];
    let corners = |of: &Deployment, configuration: &[[f64; 3]]| {
        deployed_corners(&of.sheet, configuration).concat()
    };
    let last = released.path.last().unwrap();
    let pairs = std::iter::zip(corners(&deployed, &last.configuration), corners(&deployed, &flat));
    let most = pairs.map(|([x, y], [u, v])| f64::hypot(x - u, y - v)).fold(0.0, f64::max);
    assert!(most < 1e-4, "{most}");
}

/// Finite elements: a ligament that never yields goes back to the flat state, one that yields at
/// once nearly stays.
#[test]
fn ligaments_at_the_limits_of_plasticity() {
    let plate = |stress: f64| SheetMaterial {
        name: "plate".into(),
        thickness: 3.0,
        young: 1300.0,
        poisson: 0.4,
        density_kg_m3: 900.0,
        fracture_strain: 1.0,
        plastic: vec![[stress, 0.0]],
        ..SheetMaterial::default()
    };
    let constants = HingeConstants { r_win: 12.0, ..HingeConstants::PAPER };
    let design = constants.hinge(1.5, 1.3);
    let end = HingeDeformation::from_eta(0.1, 0.02, 0.3, design.w_lig);
    let share = |stress: f64| {
        let (material, folder) = (plate(stress), tempfile::tempdir().unwrap());
        let windows = service(CalculiX::find().unwrap(), &folder);
        let hinges = [Ray { design, end }.driven(Regime::Plate)];
        let guess =
            |_: &_, reached: &HingeDeformation| reached.at(if stress > 100.0 { 0.0 } else { 0.9 });
        let found = releases(&windows, &hinges, &material, Tier::PlateTiny, guess).unwrap();
        assert_eq!(found.failed, Vec::<String>::new());
        found.rows[0].rest_theta / end.theta
    };
    let (elastic, plastic) = (share(1299.0), share(10.0));
    assert!(elastic.abs() < 0.02, "{elastic}");
    assert!(plastic > 0.8, "{plastic}");
}
