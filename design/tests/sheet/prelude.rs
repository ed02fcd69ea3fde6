//! What the tests of this program have in common: the names of the library, and sheets, loads and
//! paths in a line each.

pub use crate::cases::{AT_CORNER, AT_TIP, PROCESS, case, coordinates, difference, get};
pub use crate::closed_forms::opening_moments;
pub use crate::random::Random;
pub use design::equilibrium::hinged_sheet::HingedSheet;
pub use design::equilibrium::load_step::{LoadStep, Status};
pub use design::equilibrium::settings::SolverSettings;
pub use design::equilibrium::supports::{Dof, Load, Support};
pub use design::hinge_law::{Contact, HingeEnergy, Order, PreparedLaw};
pub use design::objective::design_problem::*;
pub use design::pattern::coordinates::PatternCoordinates;
pub use design::pattern::cut_pattern::CutPattern;
pub use design::pattern::grid::Endpoint;
pub use design::sheet::cut_sheet::*;
pub use design::sheet::cutting_process::{CuttingProcess, HoleSize};
pub use design::sheet::ideal_deployment::ideal_deployment;
pub use design::sheet::kinematics::{deployed, deployed_corners, hinge_deformations};
pub use design::*;
pub use hinge::{HingeDeformation, HingeDesign};
pub use scene::{Scene, SceneConfig};
pub use std::sync::Arc;
pub use testkit::derivatives::{
    TaylorRemainders, assert_close, assert_gradient, assert_ratio, dot,
};

/// An outline without parallel edges.
pub const TAPERED: Outline =
    Outline { corners: [[0.0, 0.0], [3.2, -0.3], [2.7, 2.9], [-0.4, 3.3]] };

pub const fn load(panel: usize, dof: Dof, value: f64) -> Load {
    Load { panel, dof, value }
}

/// A force along x.
pub const fn pull(panel: usize, value: f64) -> Load {
    load(panel, Dof::UX, value)
}

pub const fn support(panel: usize, dof: Dof, value: f64) -> Support {
    Support { panel, dof, value }
}

pub fn clamp(panel: usize) -> [Support; 3] {
    Dof::ALL.map(|dof| support(panel, dof, 0.0))
}

pub fn solver(grid: Grid, supports: &[Support], loads: &[Load], steps: usize) -> EquilibriumSolver {
    let settings = SolverSettings::default();
    EquilibriumSolver::new(grid, supports, loads, steps, settings).unwrap()
}

pub fn hinged<'a>(sheet: &'a Sheet, law: &'a dyn PreparedLaw) -> HingedSheet<'a> {
    HingedSheet { sheet, law, contact: None, damage_gradient: false }
}

/// The path that a solver follows, with or without contact of the panels.
pub fn follow(
    solver: &EquilibriumSolver,
    sheet: &Sheet,
    law: &dyn HingeLaw,
    contact: Option<&Contact>,
) -> Vec<LoadStep> {
    let law = law.prepare(&sheet.designs());
    solver.path(HingedSheet { contact, ..hinged(sheet, &*law) })
}

pub fn path(
    sheet: &Sheet,
    law: &dyn HingeLaw,
    supports: &[Support],
    loads: &[Load],
    steps: usize,
) -> Vec<LoadStep> {
    follow(&solver(sheet.topology.grid, supports, loads, steps), sheet, law, None)
}

pub fn converged(path: &[LoadStep]) -> bool {
    path.iter().all(|step| step.status == Status::Converged)
}

/// The same springs at the twelve hinges of a sheet of 3 x 3 panels.
pub const SPRINGS: [f64; 3] = [90.0, 40.0, 0.8];

pub fn uniform(stiffness: [f64; 3], sheet: &Sheet) -> LinearLaw {
    LinearLaw::uniform(stiffness, sheet.hinges.len())
}

/// The sheet of one of the reference cases.
pub fn sheet_of(name: &str) -> Sheet {
    crate::cases::sheet(&case(name))
}

/// A sheet with ligaments of one width.
pub fn cut(
    grid: Grid,
    outline: Outline,
    coordinates: &PatternCoordinates,
    w_lig: f64,
    options: SheetOptions,
) -> Sheet {
    let pattern = CutPattern::new(grid, outline, coordinates).unwrap();
    Sheet::new(&pattern, &vec![w_lig; grid.hinge_count()], options).unwrap()
}

/// Coordinates of r and tau between -`size` and `size`.
pub fn drawn(random: &mut Random, grid: Grid, size: f64) -> PatternCoordinates {
    let mut drawn = PatternCoordinates::uniform(grid);
    let edges = drawn.ell.iter_mut().flatten();
    let all = drawn.z.iter_mut().chain(edges);
    all.for_each(|x| *x = random.number(size));
    drawn
}

/// A sheet whose equilibria are followed without release and contact.
pub fn mechanics(law: impl HingeLaw + 'static, solver: EquilibriumSolver) -> Model {
    Model::Equilibrium(Box::new(Mechanics { law: Arc::new(law), contact: None, solver }))
}

/// The mechanics of a model, to be changed.
pub fn mechanics_of(model: &mut Model) -> &mut Mechanics {
    match model {
        Model::Equilibrium(mechanics) => mechanics,
        Model::Ideal { .. } => panic!("the model has no equilibria"),
    }
}

/// A scene of the repository, changed.
pub fn scene(name: &str, change: impl FnOnce(&mut SceneConfig)) -> Scene {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../configs/scenes");
    let path = std::path::Path::new(scenes).join(name);
    let mut config: SceneConfig = support::toml_file::read(&path).unwrap();
    change(&mut config);
    Scene::new(config, &path).unwrap()
}

/// A point at which a panel is held or pulled.
pub fn attached(panel: usize, point: PanelPoint) -> AttachmentPoint {
    AttachmentPoint { panel, point, ..AttachmentPoint::default() }
}

/// The distance of the centroids of two panels in a configuration.
pub fn apart(sheet: &Sheet, configuration: &[[f64; 3]], panels: [usize; 2]) -> f64 {
    let [[ax, ay], [bx, by]] =
        panels.map(|k| [0, 1].map(|c| sheet.panels[k].centroid[c] + configuration[k][c]));
    f64::hypot(bx - ax, by - ay)
}

/// The same without the other networks of an ensemble.
pub fn alone(name: &str, change: impl FnOnce(&mut SceneConfig)) -> Scene {
    scene(name, |config| {
        if let Some(surrogate) = &mut config.surrogate {
            surrogate.ensemble.clear();
        }
        change(config);
    })
}

/// Asserts that the supports leave a sheet free to move.
pub fn assert_unsupported(solver: &EquilibriumSolver, sheet: &Sheet) {
    let message = solver.check_supports(sheet).unwrap_err().to_string();
    assert!(message.starts_with("the supports leave the sheet free to move"), "{message}");
}
