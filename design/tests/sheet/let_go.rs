//! Sheets that are let go: what their hinges want without loads, their weight, and supports that moved them.

use crate::cases::{self, case, difference};
use crate::closed_forms::clamp;
use design::equilibrium::hinged_sheet::HingedSheet;
use design::equilibrium::load_step::LoadStep;
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::EquilibriumSolver;
use design::equilibrium::supports::{Dof, Load, Support};
use design::hinge_law::{HingeLaw, LinearLaw, ReleasedLaw};
use design::sheet::cut_sheet::Sheet;
use hinge::{HingeDeformation, ReleasedHinge};
use std::array::from_fn;

const STIFFNESS: [f64; 3] = [90.0, 40.0, 0.8];

fn solver(sheet: &Sheet, supports: &[Support], loads: &[Load]) -> EquilibriumSolver {
    EquilibriumSolver::new(sheet.grid, supports, loads, 5, SolverSettings::default()).unwrap()
}

fn hinged<'a>(sheet: &'a Sheet, law: &'a dyn design::hinge_law::PreparedLaw) -> HingedSheet<'a> {
    HingedSheet {
        sheet,
        law,
        contact: None,
        damage_gradient: false,
    }
}

fn last(path: Vec<LoadStep>) -> LoadStep {
    path.into_iter().next_back().unwrap()
}

/// The last load step of springs without memory.
fn loaded(solver: &EquilibriumSolver, sheet: &Sheet) -> LoadStep {
    let law = LinearLaw::uniform(STIFFNESS, sheet.hinges.len());
    let law = law.prepare(&sheet.designs());
    last(solver.path(hinged(sheet, &*law)))
}

/// The sheet without loads, with springs about the deformations `rest`.
fn let_go(
    solver: &EquilibriumSolver,
    sheet: &Sheet,
    from: &LoadStep,
    rest: impl Fn(usize) -> HingeDeformation,
) -> LoadStep {
    let hinges = (0..sheet.hinges.len()).map(|h| ReleasedHinge {
        rest: rest(h),
        stiffness: from_fn(|i| from_fn(|j| if i == j { STIFFNESS[i] } else { 0.0 })),
    });
    let hinges: Vec<ReleasedHinge> = hinges.collect();
    let law = ReleasedLaw(&hinges);
    let hinged = hinged(sheet, &law);
    last(solver.let_go(hinged, from.configuration.clone()).unwrap())
}

const PULL: [Load; 1] = [Load {
    panel: 5,
    dof: Dof::UX,
    value: 2.0,
}];

#[test]
fn an_elastic_sheet_hangs_as_before_its_loads() {
    let sheet = cases::sheet(&case("p1_3x3_random"));
    let hangs = |loads: &[Load]| {
        solver(&sheet, &clamp(3), loads)
            .with_weight([0.05, -0.2])
            .unwrap()
    };
    for pulled in [hangs(&PULL), hangs(&PULL).driven(0.8).unwrap()] {
        let under_load = loaded(&pulled, &sheet);
        let free = let_go(&pulled, &sheet, &under_load, |_| {
            HingeDeformation::default()
        });
        let expected = loaded(&hangs(&[]), &sheet);
        assert!(difference(&free.configuration, &expected.configuration) < 1e-8);
        assert!(difference(&free.configuration, &under_load.configuration) > 0.1);
    }
}

/// Hinges that all stay where they are hold the sheet where it is.
#[test]
fn a_sheet_of_hinges_that_stay_does_not_move() {
    let sheet = cases::sheet(&case("p1_3x3_random"));
    let pulled = solver(&sheet, &clamp(3), &PULL);
    let under_load = loaded(&pulled, &sheet);
    let free = let_go(&pulled, &sheet, &under_load, |h| under_load.deformations[h]);
    assert!(difference(&free.configuration, &under_load.configuration) < 1e-8);
}

#[test]
fn supports_that_moved_the_sheet_let_it_go() {
    let sheet = cases::sheet(&case("p1_3x3_random"));
    let moved = Support {
        panel: 5,
        dof: Dof::UX,
        value: 0.4,
    };
    let supports: Vec<Support> = clamp(3).into_iter().chain([moved]).collect();
    let pulled = solver(&sheet, &supports, &[]);
    let under_load = loaded(&pulled, &sheet);
    let free = let_go(&pulled, &sheet, &under_load, |_| {
        HingeDeformation::default()
    });
    let flat = vec![[0.0; 3]; sheet.panels.len()];
    assert!(difference(&under_load.configuration, &flat) > 0.3);
    assert!(difference(&free.configuration, &flat) < 1e-8);
}
