//! The gradient of objectives whose target is the sheet after its loads were taken off.

use crate::prelude::*;
use crate::taylor::{EASTS, East, assert_order_two, held, hung, problem, springs, start, tiny};
use design::hinge_law::Release;
use hinge::{HingeDeformation, HingeForces, ReleasedHinge, ReleasedSample, SheetMaterial};
use std::array::from_fn;
use std::f64::consts::FRAC_PI_2;
use surrogate::Springback;

/// A law of hinges with about this stiffness in units of (w_lig, w_lig, 1), of which a part of the
/// opening stays, in windows of a thickness of which the sheet has `scale` times.
fn release(stiffness: [f64; 3], scale: f64) -> Release {
    let mut random = Random::new(5);
    let rows: Vec<ReleasedSample> = (0..80)
        .map(|_| {
            let [w, alpha, a, s, theta] = from_fn(|_| random.numbers(1, 1.0)[0]);
            let design = PROCESS.hinge((16.0 + 8.0 * w) / scale, FRAC_PI_2 + 0.5 * alpha);
            let w = design.w_lig;
            let theta = 0.4 + 0.5 * theta;
            let reached = HingeDeformation::from_eta(0.2 * a, 0.2 * s, theta, w);
            let [eta_a, eta_s] = reached.eta(w);
            let kept = [0.7 * eta_a + 0.02 * theta * theta, 0.6 * eta_s];
            let rest = HingeDeformation::from_eta(kept[0], kept[1], 0.7 * theta, w);
            let lengths = [w, w, 1.0];
            let stiffer = 1.0 + 0.3 * theta + 0.2 * eta_a;
            let stiffness = from_fn(|i| {
                from_fn(|j| {
                    let coupled = if i == j { 1.0 } else { 0.1 * eta_s };
                    let mean = (stiffness[i] * stiffness[j]).sqrt();
                    stiffer * coupled * mean / (lengths[i] * lengths[j])
                })
            });
            let hinge = ReleasedHinge { rest, stiffness };
            let [f_a, f_s, m_theta] = hinge.forces(&reached).map(|force| 0.9 * force);
            let forces = HingeForces { f_a, f_s, m_theta };
            ReleasedSample::new(&design, &reached, &forces, None, &hinge)
        })
        .collect();
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let film = root.join("../configs/materials/pet-0.5mm.toml");
    let film = SheetMaterial::load(&film).unwrap();
    Release::new(Springback::fit(&rows, &[], &film, "tiny").unwrap(), scale)
}

/// A model whose sheet is compared with its target after it was unloaded.
fn unload(mut model: Model, release: Release) -> Model {
    mechanics_of(&mut model).release = Some(release);
    model
}

/// Sheets that are pulled, moved by a support that is removed, and that hang by their weight.
#[test]
fn springs_that_are_let_go() {
    let stiffness = [5000.0, 3000.0, 1500.0];
    for scale in [1.0_f64, 1.4] {
        for east in EASTS {
            let units = scale.powi(-3);
            let release = release(stiffness.map(|k| units * k), scale);
            let model = unload(held(springs(), 240.0, east), release);
            assert_order_two(&problem(model, HingePoint::Corner), &start());
        }
    }
    let pulled = held(springs(), 240.0, East::Pulled(12.0));
    let model = hung(pulled, [1e-5, -5e-5]);
    let model = unload(model, release(stiffness, 1.0));
    assert_order_two(&problem(model, HingePoint::Corner), &start());
}

/// Learned hinges under load.
#[test]
fn learned_hinges_that_are_let_go() {
    let driven = held(tiny(), 40.0, East::Driven(2.0, 18.0));
    let model = unload(driven, release([300.0, 200.0, 100.0], 1.0));
    let problem = problem(model, HingePoint::CutTip);
    let alone = problem.evaluate(&start()).unwrap();
    let released = alone.deployment.released.as_ref().unwrap();
    let [loaded, free] = [alone.deployment.final_step(), released.last()].map(|at| at.opening());
    let kept = free / loaded;
    assert!((0.2..0.95).contains(&kept), "{kept}");
    assert_order_two(&problem, &start());
}
