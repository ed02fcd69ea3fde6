//! Sheets that are unloaded: what their hinges want without loads, their weight, and supports that
//! moved them.

use crate::prelude::*;
use design::hinge_law::ReleasedLaw;
use hinge::{HingeDeformation, ReleasedHinge};
use std::array::from_fn;

fn last(path: Vec<LoadStep>) -> LoadStep {
    path.into_iter().next_back().unwrap()
}

/// The last load step of springs without memory.
fn loaded(solver: &EquilibriumSolver, sheet: &Sheet) -> LoadStep {
    last(follow(solver, sheet, &uniform(SPRINGS, sheet), None))
}

/// The sheet without loads, with springs about the deformations `rest`.
fn unload(
    solver: &EquilibriumSolver,
    sheet: &Sheet,
    from: &LoadStep,
    rest: impl Fn(usize) -> HingeDeformation,
) -> LoadStep {
    let hinges = (0..sheet.hinges.len()).map(|h| ReleasedHinge {
        rest: rest(h),
        stiffness: from_fn(|i| from_fn(|j| if i == j { SPRINGS[i] } else { 0.0 })),
    });
    let hinges: Vec<ReleasedHinge> = hinges.collect();
    let law = ReleasedLaw(&hinges);
    let hinged = hinged(sheet, &law);
    last(solver.unload(hinged, from.configuration.clone()).unwrap())
}

fn unstrained(_hinge: usize) -> HingeDeformation {
    HingeDeformation::default()
}

const PULL: [Load; 1] = [pull(5, 2.0)];

#[test]
fn an_elastic_sheet_hangs_as_before_its_loads() {
    let sheet = sheet_of("p1_3x3_random");
    let hangs = |loads: &[Load]| {
        let solver = solver(sheet.topology.grid, &clamp(3), loads, 5);
        solver.with_weight([0.05, -0.2]).unwrap()
    };
    for pulled in [hangs(&PULL), hangs(&PULL).driven(0.8).unwrap()] {
        let under_load = loaded(&pulled, &sheet);
        let free = unload(&pulled, &sheet, &under_load, unstrained);
        let expected = loaded(&hangs(&[]), &sheet);
        assert!(difference(&free.configuration, &expected.configuration) < 1e-8);
        assert!(difference(&free.configuration, &under_load.configuration) > 0.1);
    }
}

/// Hinges that all stay where they are hold the sheet where it is.
#[test]
fn a_sheet_of_hinges_that_stay_does_not_move() {
    let sheet = sheet_of("p1_3x3_random");
    let pulled = solver(sheet.topology.grid, &clamp(3), &PULL, 5);
    let under_load = loaded(&pulled, &sheet);
    let free = unload(&pulled, &sheet, &under_load, |h| under_load.deformations[h]);
    assert!(difference(&free.configuration, &under_load.configuration) < 1e-8);
}

#[test]
fn supports_that_moved_the_sheet_let_it_go() {
    let sheet = sheet_of("p1_3x3_random");
    let moved = support(5, Dof::UX, 0.4);
    let supports = [clamp(3).as_slice(), &[moved]].concat();
    let pulled = solver(sheet.topology.grid, &supports, &[], 5);
    let under_load = loaded(&pulled, &sheet);
    let free = unload(&pulled, &sheet, &under_load, unstrained);
    let flat = vec![[0.0; 3]; sheet.panels.len()];
    assert!(difference(&under_load.configuration, &flat) > 0.3);
    assert!(difference(&free.configuration, &flat) < 1e-8);
}
