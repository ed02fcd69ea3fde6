//! Sheets, weights and campaigns checked by a fake solver with a closed-form hinge: exact, and with
//! windows that fail.

#[path = "../../../fe_driver/tests/common/fake_solver.rs"]
mod fake_solver;

use dataset::{Fidelity, SolvedRay, samples};
use design::hinge_law::Order;
use design::objective::design_problem::Deployment;
use design::pattern::design_vector::DesignVector;
use fake_solver::{FakeSolver, Fault};
use fe_driver::{
    Campaign, RunOptions, Shard, Solution, SolveError, SolveService, SolveStore, Solver,
    ToolVersions, WindowSolve, random_paths, run,
};
use mesher::Tier;
use scene::run_inputs::scene_file;
use scene::{Level, LinearConstants, Scene, SceneConfig};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use surrogate::Surrogate;
use tempfile::TempDir;
use verification::{
    Accuracy, BALANCED, BalanceEnd, Balanced, ElementWindows, Learning, LearningEnd, LearningTask,
    VerificationError, balanced, distillation_states, final_design, movements, size, spot_check,
    visited_paths,
};

/// (k_a, k_s) (N/mm) and k_theta (N mm/rad) of the hinges of film.
const STIFFNESS: [f64; 3] = [6.0, 12.0, 120.0];

static NEVER: AtomicBool = AtomicBool::new(false);

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A sheet of nine panels with the smallest shipped weights.
fn scene() -> Scene {
    let path = repository().join("configs/scenes/pet-3x3.toml");
    let mut config: SceneConfig = support::toml_file::read(&path).unwrap();
    let weights = repository().join("data/pet-0.5mm/small.safetensors");
    config.name_weights(&weights).unwrap();
    config.ligament.range = [12.5, 25.0];
    (config.objective.damage, config.objective.compression) = (0.01, 0.05);
    config.objective.panel_shape = 1.0;
    Scene::new(config, &path).unwrap()
}

fn start(scene: &Scene) -> DesignVector {
    scene.start()
}

fn service<'a>(solver: impl Solver + 'a, folder: &TempDir) -> SolveService<'a> {
    SolveService {
        solver: Box::new(solver),
        store: SolveStore(folder.path().join("solves")),
        workers: 2,
        limit: Duration::from_millis(5),
        stop: &NEVER,
        progress: Box::new(|_, _| {}),
    }
}

/// A solver without faults.
fn healthy() -> FakeSolver<fn(&WindowSolve) -> Option<Fault>> {
    FakeSolver::new(STIFFNESS, |_| None)
}

fn balance(
    scene: &Scene,
    solver: impl Solver,
    folder: &TempDir,
    rounds: usize,
) -> Result<Balanced, VerificationError> {
    let service = &service(solver, folder);
    let tier = Tier::Tiny;
    let windows = ElementWindows { tier, service };
    Ok(balanced(scene, &start(scene), &windows, rounds)?.0)
}

/// A sheet of springs with the stiffness of [`SPRINGS`], times `factor`.
fn springs(factor: f64) -> Scene {
    let path = repository().join("configs/scenes/linear-7x7.toml");
    let mut config: SceneConfig = support::toml_file::read(&path).unwrap();
    let [k_a, k_s, k_theta] = SPRINGS.map(|k| k * factor);
    config.linear = Some(LinearConstants { k_a, k_s, k_theta });
    Scene::new(config, &path).unwrap()
}

/// (k_a, k_s) (N/mm) and k_theta (N mm/rad).
const SPRINGS: [f64; 3] = [400.0, 250.0, 300.0];

/// The finite elements of the test are springs that are a tenth stiffer than the springs of the
/// scene: the exact equilibrium is the equilibrium of a scene with their stiffness.
#[test]
fn a_balanced_sheet_is_that_of_the_hinges_of_the_solver() {
    let folder = tempfile::tempdir().unwrap();
    let stiffer = SPRINGS.map(|k| 1.1 * k);
    let solver = || FakeSolver::new(stiffer, |_: &WindowSolve| None);
    let found = balance(&springs(1.0), solver(), &folder, 8).unwrap();
    assert_eq!(found.ended, BalanceEnd::Converged);
    let exact = springs(1.1);
    let exact = exact.problem().unwrap().deploy(&exact.start()).unwrap();
    let error = |sheet: &Deployment| {
        let corners = movements(sheet, &exact).into_iter();
        corners.fold(0.0, f64::max) / size(&exact)
    };
    assert!(error(found.by_law()) > 10.0 * BALANCED);
    assert!(error(found.by_elements()) < BALANCED, "{:?}", found.rounds);
    let errors: Vec<f64> = found.rounds.iter().map(|round| round.force_error).collect();
    assert!(errors.is_sorted_by(|before, now| before > now), "{errors:?}");
    // The same sheet again solves nothing.
    let again = solver();
    balance(&springs(1.0), &again, &folder, 8).unwrap();
    assert_eq!(again.attempts(), 0);
}

/// Hinges whose stiffness depends on the mesh: [`SPRINGS`] times 1.05 on the mesh `default`, times
/// 1.1 on any other.
struct ByMesh([NeverFails; 2]);

type NeverFails = FakeSolver<fn(&WindowSolve) -> Option<Fault>>;

impl ByMesh {
    fn new() -> Self {
        Self([1.05, 1.1].map(|factor| NeverFails::new(SPRINGS.map(|k| factor * k), |_| None)))
    }
}

impl Solver for ByMesh {
    fn versions(&self) -> ToolVersions {
        self.0[0].versions()
    }

    fn attempt(
        &self,
        solve: &WindowSolve,
        work: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Solution, SolveError> {
        let [draft, finest] = &self.0;
        let of_mesh = match solve.problem.tier {
            Tier::Default => draft,
            _ => finest,
        };
        of_mesh.attempt(solve, work, limit, stop)
    }
}

/// The cheaper mesh is balanced first, and the forces of the finest one in nearly the same states,
/// which are others, give no false slope.
#[test]
fn a_sheet_is_balanced_on_the_cheaper_mesh_first() {
    let (scene, folder) = (springs(1.0), tempfile::tempdir().unwrap());
    let service = &service(ByMesh::new(), &folder);
    let tier = Tier::Reference;
    let windows = ElementWindows { tier, service };
    let (found, _) = balanced(&scene, &start(&scene), &windows, 8).unwrap();
    assert_eq!(found.ended, BalanceEnd::Converged);
    let of_tier = |tier: Tier| found.rounds.iter().filter(move |round| round.tier == tier);
    assert!(found.rounds.is_sorted_by_key(|round| round.tier));
    let [first, ..] = of_tier(Tier::Reference).collect::<Vec<_>>()[..] else {
        panic!("no round on the finest mesh");
    };
    let [(Tier::Default, draft), (Tier::Reference, finest)] = found.mesh_error().unwrap() else {
        panic!("two meshes");
    };
    let far = |from: &Deployment, to: &Deployment| {
        movements(from, to).into_iter().fold(0.0, f64::max) / size(to)
    };
    for (by_mesh, factor) in [(draft, 1.05), (finest, 1.1)] {
        let exact = springs(factor);
        let exact = exact.problem().unwrap().deploy(&exact.start()).unwrap();
        assert!(far(by_mesh, &exact) < BALANCED, "{:?}", found.rounds);
    }
    let between = far(draft, finest);
    assert!(between > 10.0 * BALANCED, "{between}");
    // Already the first round on the finest mesh moves the sheet by about what it is off.
    let moved = first.movement / size(finest) / between;
    assert!((0.5..1.5).contains(&moved), "{moved}");
}

/// Hinges with 1.2 times the forces of weights.
struct Stiffer(NeverFails, Surrogate);

impl Solver for Stiffer {
    fn versions(&self) -> ToolVersions {
        self.0.versions()
    }

    fn attempt(
        &self,
        solve: &WindowSolve,
        work: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Solution, SolveError> {
        let mut solution = self.0.attempt(solve, work, limit, stop)?;
        let law = self.1.prepare(&[solve.problem.hinge.design]);
        for sample in &mut solution.samples {
            let energy = self.1.evaluate(&law, &[sample.deformation()], Order::Forces)[0];
            [sample.f_a, sample.f_s, sample.m_theta] = energy.forces.map(|force| 1.2 * force);
        }
        Ok(solution)
    }
}

/// The search goes on with the hinges of the solver, whose forces the law of the final design has
/// at their states, although they are far from the forces of the learned law.
#[test]
fn a_final_design_has_the_forces_of_the_solver() {
    let folder = tempfile::tempdir().unwrap();
    let mut config = scene().config;
    config.output = folder.path().join("run");
    config.optimiser.steps = 4;
    let scene = scene().changed(config).unwrap();
    let weights = scene.weights().unwrap().clone();
    let stiffer = || Stiffer(healthy(), weights.clone());
    let designed = |solver: &Stiffer| {
        let service = &service(solver, &folder);
        let windows = ElementWindows { tier: Tier::Tiny, service };
        final_design(&scene, &windows, &NEVER, &mut |_, _| {}).unwrap()
    };
    let found = designed(&stiffer());
    let searches = &found.coarse_searches;
    assert_eq!([searches[0].level, searches[1].level], [Level::Standard, Level::Final]);
    let [first, .., last] = &searches[..] else {
        panic!("at least two searches");
    };
    let off = [first, last].map(|search| search.difference.corners[1]);
    assert!(off[1] < 0.5 * off[0], "{off:?}");
    // The run is opened again with its law, which has the forces of the solver, and solves nothing.
    let run = Scene::read(&scene_file(&found.scene.output()).unwrap()).unwrap();
    assert_eq!(run.config.level, Level::Final);
    let problem = run.problem().unwrap();
    let deployed = problem.deploy(&found.search.best).unwrap();
    let (designs, states) = (deployed.sheet.designs(), &deployed.final_step().deformations);
    let law = problem.model.mechanics().unwrap().law.clone();
    let forces = law.prepare(&designs).energies(states, Order::Forces);
    let exact = weights.evaluate(&weights.prepare(&designs), states, Order::Forces);
    for (hinge, (found, exact)) in std::iter::zip(forces, exact).enumerate() {
        for (found, exact) in std::iter::zip(found.forces, exact.forces) {
            let size = exact.abs().max(0.1);
            assert!((found - 1.2 * exact).abs() < 0.05 * size, "{hinge}: {found} {exact}");
        }
    }
    let again = stiffer();
    let same = designed(&again);
    assert_eq!(again.0.attempts(), 0);
    assert_eq!(same.search.best, found.search.best);
}

#[test]
fn a_hinge_that_is_never_solved_ends_no_round_and_is_named() {
    let (scene, folder) = (scene(), tempfile::tempdir().unwrap());
    // The hinge of the design's third path has its own end in every round: it is known by its
    // ligament and angle.
    let deployed = scene.problem().unwrap().deploy(&start(&scene)).unwrap();
    let ends = &deployed.final_step().deformations;
    let end = ends[3];
    let diverges = FakeSolver::new(STIFFNESS, |solve: &WindowSolve| {
        let is_third = solve.problem.hinge.path.at(1.0) == end;
        is_third.then_some(Fault::Diverges(0.55))
    });
    let found = balance(&scene, &diverges, &folder, 1).unwrap();
    let [round] = &found.rounds[..] else {
        panic!("one round");
    };
    assert_eq!(round.unsolved.len(), 1);
    assert_eq!(round.unsolved[0].hinge, 3);
    let reason = &round.unsolved[0].reason;
    assert!(reason.contains("diverged") && reason.contains("solves"), "{reason}");
    assert!(found.hinges[3].is_none());
    assert_eq!(found.hinges.iter().flatten().count(), ends.len() - 1);
    // A second round has other paths, all of which are solved.
    let found = balance(&scene, &diverges, &folder, 2).unwrap();
    assert!(found.rounds[1].unsolved.is_empty() && found.hinges[3].is_some());
}

#[test]
fn rounds_without_a_solved_hinge_end_the_iteration_and_keep_what_is_known() {
    let (scene, folder) = (scene(), tempfile::tempdir().unwrap());
    balance(&scene, healthy(), &folder, 2).unwrap();
    let diverges = FakeSolver::new(STIFFNESS, |_: &WindowSolve| Some(Fault::Diverges(0.0)));
    let found = balance(&scene, &diverges, &folder, 3).unwrap();
    assert_eq!(found.rounds.len(), 2);
    assert!(
        matches!(&found.ended, BalanceEnd::Failed(reason) if reason.contains("solved no hinge"))
    );
    let nothing = tempfile::tempdir().unwrap();
    let error = balance(&scene, &diverges, &nothing, 3).err().unwrap();
    assert!(matches!(error, VerificationError::NoHinge(_)), "{error}");
}

#[test]
fn a_spot_check_keeps_the_states_of_the_windows_that_are_solved() {
    let (scene, folder) = (scene(), tempfile::tempdir().unwrap());
    let deployed = scene.problem().unwrap().deploy(&start(&scene)).unwrap();
    let paths = visited_paths(&[&deployed; 6]).unwrap();
    let ends = &deployed.final_step().deformations;
    assert!(paths.iter().all(|path| ends.contains(&path.hinge.path.at(1.0))));
    let first = paths[0].hinge.clone();
    let diverges = FakeSolver::new(STIFFNESS, |solve: &WindowSolve| {
        (solve.problem.hinge == first).then_some(Fault::Diverges(0.4))
    });
    let windows = service(&diverges, &folder);
    let tier = Tier::Tiny;
    let check = spot_check(&windows, &paths, &scene.material, tier).unwrap();
    assert_eq!((samples(&check.rays).count(), check.unknown_states), (55, 5));
    assert!(check.unsolved[0].to_string().contains("(3 attempts"), "{}", check.unsolved[0]);
    let ray = &check.rays[0];
    assert_eq!((ray.tier, ray.tools.ccx.as_str()), (Fidelity::Solved(Tier::Tiny), "fake"));
    assert_eq!(ray.material_hash, scene.material.law_hash());
}

#[test]
fn rays_are_solved_in_rounds_until_the_weights_are_accurate() {
    let (scene, folder) = (scene(), tempfile::tempdir().unwrap());
    let path = repository().join("configs/campaigns/tiny.toml");
    let mut campaign = Campaign::load(&path).unwrap();
    campaign = campaign.first_rays(12);
    let region = campaign.region().unwrap();
    assert!(!distillation_states(campaign.drawn(&region)).is_empty());
    let solver = healthy();
    let windows = service(&solver, &folder);
    let spot = |states: usize| {
        let paths = random_paths(campaign.drawn(&region), states, 4, 1);
        spot_check(&windows, &paths, &campaign.material, campaign.tier).unwrap().rays
    };
    let rays = folder.path().join("campaign");
    let learned_at = |spot: &[SolvedRay], accuracy: f64, deadline: Option<Instant>| {
        let task = LearningTask {
            campaign: &campaign,
            folder: &rays,
            solver: &solver,
            workers: 1,
            first_rays: 3,
            spot,
            accuracy: Accuracy { energy: accuracy, forces: accuracy },
            deadline,
            stop: &NEVER,
        };
        // The weights of every round are the shipped ones.
        let weights = scene.surrogate().unwrap();
        let (mut trained, mut saved) = (Vec::new(), Vec::new());
        let mut learning = Learning::new(task).unwrap();
        loop {
            let (rays, database) = match learning.solve(&mut |_| ()).unwrap() {
                Ok(solved) => solved,
                Err(end) => return (end, trained, saved),
            };
            assert!(database.rays().len() >= rays);
            trained.push(rays);
            let (round, tested) = learning.test(weights.clone(), 1.0).unwrap();
            assert_eq!(round.complete, round.rays);
            assert!(tested.card().spot_check.is_some());
            if round.is_latest {
                saved.push(round.rays);
            }
        }
    };
    let many = spot(24);
    let learned = |accuracy: f64, deadline: Option<Instant>| learned_at(&many, accuracy, deadline);
    // Without time nothing is solved.
    let (end, trained, _) = learned(1e9, Some(Instant::now()));
    let (left, what) = (3, "rays of this round");
    assert_eq!(end, LearningEnd::Unfinished { left, what });
    assert!(trained.is_empty());
    assert_eq!(learned(1e9, None), (LearningEnd::Accurate, vec![3], vec![3]));
    // The next round is stopped after two rays. Its weights are tested and kept, not the weights
    // of three rays.
    let five = campaign.first_rays(5);
    let options = RunOptions { shard: Shard::WHOLE, workers: 1, time_limit: None, retry: false };
    run(&five, &rays, &solver, &options, &NEVER, &mut |_| ()).unwrap();
    assert_eq!(learned(1e9, None), (LearningEnd::Accurate, vec![3, 5], vec![5]));
    // The errors of weights of another material are never zero.
    let all = learned(0.0, None);
    assert_eq!(all, (LearningEnd::AllRays, vec![3, 5, 6, 12], vec![5, 6, 12]));
    // What is solved is not solved again, and the weights of earlier rounds are not taken.
    let before = solver.attempts();
    assert_eq!(learned(1e9, None), (LearningEnd::Accurate, vec![3, 6, 12], vec![12]));
    // No weights are accurate by states on five rays, which have no interval, nor by states of
    // which only three rays have some in the training domain.
    let mut beyond = many.clone();
    beyond[3..].iter_mut().for_each(|ray| ray.design.w_lig *= 9.0);
    for spot in [many[..5].to_vec(), beyond] {
        assert_eq!(learned_at(&spot, 1e9, None).0, LearningEnd::AllRays);
    }
    assert_eq!(solver.attempts(), before);
}
