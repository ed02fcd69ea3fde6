//! Final state, jumps and statuses do not depend on the number of load steps.

use crate::cases::{self, AT_CORNER, case, difference};
use crate::closed_forms::{clamp, opening_moments, path};
use crate::extremes::{Rotational, assert_finite, snapping};
use crate::random::Random;
use design::equilibrium::hinged_sheet::HingedSheet;
use design::equilibrium::load_step::{LoadStep, Status};
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::EquilibriumSolver;
use design::equilibrium::supports::{Dof, Load};
use design::hinge_law::{Contact, HingeEnergy, HingeLaw, LinearLaw, Order, PreparedLaw};
use design::objective::design_problem::Model;
use design::pattern::coordinates::PatternCoordinates;
use design::pattern::cut_pattern::{CutPattern, Outline};
use design::pattern::grid::Grid;
use design::scene::{Scene, SceneConfig};
use design::sheet::cut_sheet::Sheet;
use hinge::{HingeDeformation, HingeDesign};
use std::path::Path;

/// A scene of the repository, changed.
pub fn scene(name: &str, change: impl FnOnce(&mut SceneConfig)) -> Scene {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes");
    let path = scenes.join(name);
    let mut config: SceneConfig = support::toml_file::read(&path).unwrap();
    change(&mut config);
    Scene::new(config, &path).unwrap()
}

/// The path of a random linear sheet, with or without contact of its panels.
fn linear(seed: u64, steps: usize) -> Vec<LoadStep> {
    let mut random = Random::new(seed);
    let mut whole = |from: usize, to: usize| {
        from + ((0.5 + 0.5 * random.number(1.0)) * (to - from + 1) as f64) as usize
    };
    let grid = Grid {
        m: whole(3, 7),
        n: whole(3, 7),
    };
    let pulled = grid.panel(grid.m - 1, whole(0, grid.n - 1));
    let contact = whole(0, 1) == 1;
    let mut coordinates = PatternCoordinates::uniform(grid);
    coordinates
        .z
        .iter_mut()
        .for_each(|z| *z = random.number(1.0));
    let outline = Outline::rectangle(grid.m as f64, grid.n as f64);
    let pattern = CutPattern::new(grid, outline, &coordinates).unwrap();
    let sheet = Sheet::new(&pattern, &vec![0.1; grid.hinge_count()], AT_CORNER).unwrap();
    let [k_a, k_s] = [0, 1].map(|_| 10.0_f64.powf(3.0 + random.number(1.0)));
    let law = LinearLaw::uniform([k_a, k_s, 1.0], grid.hinge_count());
    let loads = [Dof::UX, Dof::UY].map(|dof| Load {
        panel: pulled,
        dof,
        value: random.number(2.0 * grid.n as f64),
    });
    let (supports, settings) = (clamp(grid.panel(0, grid.n / 2)), SolverSettings::default());
    let solver = EquilibriumSolver::new(grid, &supports, &loads, steps, settings).unwrap();
    solver.path(HingedSheet {
        sheet: &sheet,
        law: &*law.prepare(&sheet.designs()),
        contact: contact.then_some(&Contact::new(1.0, -0.1, -0.01).unwrap()),
        damage_gradient: false,
    })
}

/// The path of a random design of the polyester sheet with learned hinges.
fn learned(seed: u64, steps: usize) -> Vec<LoadStep> {
    let scene = scene("pet-3x3.toml", |config| {
        config.load_steps = steps;
        config.optimiser.start_noise = 1.2;
        config.optimiser.seed = seed;
        config.objective.domain = 0.0;
        if let Some(surrogate) = &mut config.surrogate {
            surrogate.ensemble.clear();
        }
    });
    scene
        .problem()
        .unwrap()
        .deploy(&scene.start())
        .unwrap()
        .path
}

/// Fails if the paths with the given numbers of load steps differ.
fn assert_equal_paths(name: &str, steps: &[usize], path: impl Fn(usize) -> Vec<LoadStep>) {
    let jumps = |path: &[LoadStep]| path.iter().map(|step| step.jumps).sum::<usize>();
    let reference = path(steps[0]);
    let (end, expected) = (&reference[reference.len() - 1], jumps(&reference));
    for &steps in &steps[1..] {
        let path = path(steps);
        assert_finite(&path);
        let last = &path[path.len() - 1];
        let at = format!("{name}, {steps} steps");
        assert_eq!(jumps(&path), expected, "{at}");
        let ended = |step: &LoadStep| step.status == Status::Diverged;
        assert_eq!(ended(last), ended(end), "{at}");
        let apart = difference(&last.configuration, &end.configuration);
        let size = last.configuration.as_flattened().iter();
        let size = size.fold(1.0_f64, |most, q| most.max(q.abs()));
        assert!(apart < 1e-7 * size, "{at}: {apart:e}");
        let energy = last.potential / end.potential - 1.0;
        assert!(energy.abs() < 1e-9, "{at}: {energy:e}");
        for step in &path {
            let jumped = matches!(step.status, Status::LimitPoint | Status::Almost);
            assert!(
                jumped || step.jumps == 0 || ended(step),
                "{at}: a silent jump"
            );
        }
    }
}

#[test]
fn paths_do_not_depend_on_the_number_of_load_steps() {
    for seed in 0..40 {
        assert_equal_paths(&format!("linear {seed}"), &[5, 10, 20], |steps| {
            linear(seed, steps)
        });
    }
    for seed in 0..6 {
        assert_equal_paths(&format!("learned {seed}"), &[5, 20], |steps| {
            learned(seed, steps)
        });
    }
    assert_equal_paths("linear", &[20, 1000], |steps| linear(3, steps));
}

/// The same for several hundred sheets.
#[test]
fn paths_of_hundreds_of_sheets_do_not_depend_on_the_number_of_load_steps() {
    let mut jumping = 0;
    for seed in 100..350 {
        assert_equal_paths(&format!("linear {seed}"), &[5, 10, 20, 100], |steps| {
            linear(seed, steps)
        });
        jumping += usize::from(linear(seed, 5).iter().any(|step| step.jumps > 0));
    }
    for seed in 100..110 {
        assert_equal_paths(&format!("linear {seed}"), &[5, 1000], |steps| {
            linear(seed, steps)
        });
    }
    println!("{jumping} of 250 paths jump");
    assert!(jumping > 10);
}

/// The same for learned hinges.
#[test]
fn paths_of_learned_sheets_do_not_depend_on_the_number_of_load_steps() {
    for seed in 100..150 {
        assert_equal_paths(&format!("learned {seed}"), &[5, 20, 100], |steps| {
            learned(seed, steps)
        });
    }
}

/// k_a a^2/2 + k_theta theta^2/2 and a double well in s: a hinge that snaps by 0.3 in shear turns its panels little.
#[derive(Clone, Copy)]
struct SnappingInShear;

impl HingeLaw for SnappingInShear {
    fn prepare<'a>(&'a self, _designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        Box::new(*self)
    }
}

impl PreparedLaw for SnappingInShear {
    fn energies(&self, deformations: &[HingeDeformation], _order: Order) -> Vec<HingeEnergy> {
        let energy = |&HingeDeformation { a, s, theta }: &HingeDeformation| {
            let [well, force, stiffness] = snapping(s / 0.3);
            HingeEnergy {
                w: 50.0 * a * a + 500.0 * theta * theta + well,
                forces: [100.0 * a, force / 0.3, 1000.0 * theta],
                tangent: [
                    [100.0, 0.0, 0.0],
                    [0.0, stiffness / 0.09, 0.0],
                    [0.0, 0.0, 1000.0],
                ],
                ..HingeEnergy::default()
            }
        };
        deformations.iter().map(energy).collect()
    }
}

#[test]
fn a_snap_in_shear_is_reported() {
    let sheet = cases::sheet(&case("p0_3x3_uniform"));
    let pull = [Load {
        panel: 5,
        dof: Dof::UX,
        value: 25.0,
    }];
    let snaps = |steps: usize| {
        let path = path(&sheet, &SnappingInShear, &clamp(3), &pull, steps);
        assert_finite(&path);
        path
    };
    let coarse = snaps(4);
    assert!(coarse.iter().any(|step| step.status == Status::LimitPoint));
    let turned = |step: &LoadStep| {
        step.configuration
            .iter()
            .fold(0.0_f64, |m, q| m.max(q[2].abs()))
    };
    assert!(turned(&coarse[3]) < 0.1, "{}", turned(&coarse[3]));
    assert_equal_paths("shear", &[4, 5, 40, 200], snaps);
}

/// Hinges a hundred times softer in rotation than those of the scene: the flat sheet turns by most of its opening at
/// a hundredth of the load.
#[test]
fn soft_hinges_have_an_equilibrium_at_full_load() {
    for k_theta in [10.0, 1.0] {
        let scene = scene("linear-7x7.toml", |config| {
            config.linear.as_mut().unwrap().k_theta = k_theta;
        });
        let problem = scene.problem().unwrap();
        let Model::Equilibrium(_) = &problem.model else {
            panic!("the scene has mechanics");
        };
        let deployment = problem.deploy(&scene.start()).unwrap();
        assert_finite(&deployment.path);
        let last = deployment.at_full_load().unwrap();
        assert!(last.residual <= last.rounding.max(1e-10) && last.negative_pivots == 0);
    }
}

/// Forces with seven digits: the sheet jumps, and lands at a residual above or below the tolerance.
#[test]
fn a_jump_does_not_hide_an_unconverged_state() {
    let law = Rotational(|theta| {
        let [energy, moment, stiffness] = snapping(theta);
        [energy, (moment * 3e6).round() / 3e6, stiffness]
    });
    let sheet = cases::sheet(&case("p1_3x3_random"));
    let mut unconverged = 0;
    for m_theta in [0.29, 0.3, 0.31, 0.32, 0.33] {
        let path = path(
            &sheet,
            &law,
            &clamp(4),
            &opening_moments(&sheet, 4, m_theta),
            3,
        );
        let landed = path.iter().find(|step| step.jumps > 0).unwrap();
        let expected = match landed.residual <= landed.rounding.max(1e-10) {
            true => Status::LimitPoint,
            false => Status::Almost,
        };
        assert_eq!(landed.status, expected, "{m_theta}");
        unconverged += usize::from(expected == Status::Almost);
    }
    assert!(unconverged > 0);
}

/// Corrections, factorisations and rejected increments of a path.
fn costs(path: &[LoadStep]) -> [usize; 3] {
    let total = |of: fn(&LoadStep) -> usize| path.iter().map(of).sum::<usize>();
    let found = [
        total(|step| step.effort.iterations),
        total(|step| step.effort.factorisations),
        total(|step| step.effort.rejected),
    ];
    println!("{found:?}");
    found
}

fn assert_at_most(found: [usize; 3], most: [usize; 3]) {
    let within = std::iter::zip(found, most).all(|(found, most)| found <= most);
    assert!(within, "{found:?} {most:?}");
}

/// The cost of three paths without jumps, so that a change of it is noticed: of linear hinges, with contact, learned.
#[test]
fn a_path_costs_a_bounded_number_of_factorisations() {
    let sheet = cases::sheet(&case("p2_4x7_random"));
    let law = LinearLaw::uniform([1000.0, 1000.0, 0.1], sheet.hinges.len());
    let pull = [Load {
        panel: 15,
        dof: Dof::UX,
        value: 2.0,
    }];
    let path = path(&sheet, &law, &clamp(12), &pull, 10);
    assert!(path.iter().all(|step| step.status == Status::Converged));
    assert_at_most(costs(&path), [80, 36, 3]);

    // The contact begins at -0.01 rad and becomes rigid at -0.1 rad.
    let path = linear(2, 10);
    let touches = |step: &LoadStep| step.deformations.iter().any(|eps| eps.theta < -0.09);
    assert!(path.iter().any(touches) && path.iter().all(|step| step.jumps == 0));
    assert_at_most(costs(&path), [110, 44, 3]);

    let path = learned(150, 20);
    assert!(path.iter().all(|step| step.status == Status::Converged));
    assert_at_most(costs(&path), [220, 90, 7]);
}
