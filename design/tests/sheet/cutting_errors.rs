//! What errors of a cut sheet do to it.

use crate::error_budget::{effect, film};
use crate::prelude::*;
use design::analysis::cutting_errors::{
    CuttingError, CuttingErrors, CuttingErrorsError, FirstOrder,
};
use design::analysis::error_budget::{Cause, ErrorBudget};
use design::scene::ToleranceConfig;

fn tolerances(ligament: f64, kerf: f64, thickness: f64) -> ToleranceConfig {
    let given = |tolerance: f64| (tolerance > 0.0).then_some(tolerance);
    ToleranceConfig {
        ligament: given(ligament),
        kerf: given(kerf),
        thickness: given(thickness),
    }
}

fn with<T>(
    scene: &Scene,
    tolerances: ToleranceConfig,
    of: impl FnOnce(&CuttingErrors) -> T,
) -> Result<T, CuttingErrorsError> {
    let problem = scene.problem().unwrap();
    let errors = CuttingErrors::new(scene, &problem, &scene.start(), tolerances)?;
    Ok(of(&errors))
}

/// The effects to first order.
fn first_order(scene: &Scene, tolerances: ToleranceConfig) -> FirstOrder {
    with(scene, tolerances, |errors| {
        errors.first_order(&mut || ()).unwrap()
    })
    .unwrap()
}

/// Two ways to one number: two sheets on either side, and the response of one sheet to the change of its hinge forces. The tip
/// of a main cut stays where it is when the kerf or the thickness is off.
#[test]
fn kerf_and_thickness_have_the_effects_of_the_error_budget() {
    let small = tolerances(0.0, 2e-4, 2e-5);
    let scene = film(|config| config.tolerances = small);
    let found = first_order(&scene, small);
    let problem = scene.problem().unwrap();
    let deployment = problem.deploy(&scene.start()).unwrap();
    let budget = ErrorBudget::new(&scene, &problem, &deployment, None).unwrap();
    for (error, cause) in [
        (CuttingError::Kerf, Cause::Kerf),
        (CuttingError::Thickness, Cause::Thickness),
    ] {
        let own = found.errors.iter().find(|own| own.error == error).unwrap();
        let expected = effect(&budget, cause).unwrap();
        for (own, expected) in std::iter::zip(own.corners, expected.corners) {
            assert_ratio(own, expected, 1e-3);
        }
        let load = own.load.unwrap().abs();
        assert_ratio(load, expected.load.unwrap(), 1e-3);
    }
    let shares: f64 = found.errors.iter().map(|own| own.share).sum();
    assert_close(shares, 1.0, 1e-12);
}

/// Small errors at random have the deviations of the first order, within four standard errors of so many sheets.
#[test]
fn small_errors_at_random_have_the_first_order() {
    let scene = film(|_| ());
    let given = tolerances(0.02, 0.004, 2e-4);
    let first = first_order(&scene, given);
    let sampled = |sheets: usize| {
        let sample = |errors: &CuttingErrors| errors.sampled(sheets, 3, &mut || ());
        with(&scene, given, sample).unwrap().unwrap()
    };
    let found = sampled(200);
    assert_eq!((found.deployed, found.failed), (200, 0));
    let allowed = 4.0 / 400f64.sqrt();
    assert_ratio(found.corners[0], first.corners[0], allowed);
    assert_ratio(found.load.unwrap()[1], first.load.unwrap(), allowed);
    assert!(found.largest[0] < found.largest[1]);
    // The same seed gives the same sheets.
    assert_eq!(sampled(20), sampled(20));
}

/// Twice the tolerance, twice the effect; and the largest share belongs to the error that moves the corners most.
#[test]
fn effects_are_in_proportion_to_tolerances() {
    let scene = film(|_| ());
    let [one, two] =
        [0.01, 0.02].map(|ligament| first_order(&scene, tolerances(ligament, 0.0, 0.0)));
    assert!((two.corners[0] / one.corners[0] - 2.0).abs() < 1e-3);
    assert!(one.errors.is_sorted_by(|a, b| a.corners[0] >= b.corners[0]));
    assert_eq!(one.errors.len(), scene.grid().hinge_count());
}

#[test]
fn a_sheet_without_tolerances_is_refused() {
    let refused = with(&film(|_| ()), tolerances(0.0, 0.0, 0.0), |_| ()).unwrap_err();
    assert!(refused.to_string().contains("[tolerances]"), "{refused}");
}
