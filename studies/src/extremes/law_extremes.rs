//! The learned law at the edge of its training domain and far outside it, at ligaments and cut angles of no training.

use super::{Checked, kept};
use anyhow::{Context, Result};
use design::hinge_law::{HingeEnergy, HingeLaw, Order};
use design::sheet::cutting_process::CuttingProcess;
use hinge::{HingeDeformation, HingeDesign, TrainingDomain};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::array::from_fn;
use std::fmt::Write;

/// Number of random directions of each row.
const DIRECTIONS: usize = 400;
/// Step of the difference quotients, relative to the extent of the domain.
const STEP: f64 = 1e-5;
/// Maximum difference of derivatives and difference quotients, relative to the norm of the derivative and to that at
/// the centre of the domain: the rounding of W over [`STEP`] leaves 1e-8, the curvature of the law the rest.
const CONSISTENT: f64 = 1e-4;

/// Distances from the centre of the domain in units of its extent along a direction. The first is from the flat state.
const DISTANCES: [f64; 6] = [1e-9, 0.5, 0.999, 1.001, 2.0, 100.0];

/// A ligament width relative to the limits of the training, and a cut angle (deg).
const LIGAMENTS: [(&str, Width, f64); 5] = [
    ("narrowest of the training", Width::Narrowest(1.0), 90.0),
    ("widest of the training", Width::Widest(1.0), 90.0),
    ("as narrow as thick", Width::Narrowest(0.1), 90.0),
    ("cut angle 25 deg", Width::Widest(0.5), 25.0),
    ("cut angle 150 deg", Width::Widest(0.5), 150.0),
];

#[derive(Clone, Copy)]
enum Width {
    /// Times the minimum of the training.
    Narrowest(f64),
    /// Times the maximum of the training.
    Widest(f64),
}

/// What was found at the states of a row.
#[derive(Default)]
struct Found {
    not_finite: usize,
    /// Of the forces from the difference quotients of the energy, and of the tangent from those of the forces.
    errors: [f64; 2],
    inside: usize,
}

/// One row for each ligament at each place.
pub(super) fn table(law: &dyn HingeLaw, process: &CuttingProcess) -> Result<Checked> {
    let domain = law
        .domain()
        .context("the law of the scene has no training domain")?;
    let mut text = format!(
        "# At the extremes: the learned law\n\n\
         {DIRECTIONS} random states of each ligament at each distance from the centre of the training domain, whose edge along \
         a direction is at 1 (the first distance is from the flat state). Promised: numbers are finite; forces are the derivatives of the energy and the tangent \
         those of the forces (difference quotients, relative, below {CONSISTENT:e}); a state is inside if ligament and \
         deformation are those of the training.\n\n\
         | ligament | distance | not finite | forces | tangent | inside | |\n|---|---|---|---|---|---|---|\n"
    );
    let mut broken = 0;
    for (ligament, width, alpha_deg) in LIGAMENTS {
        let w_lig = match width {
            Width::Narrowest(factor) => factor * domain.w_lig[0],
            Width::Widest(factor) => factor * domain.w_lig[1],
        };
        let design = process.hinge(w_lig, f64::to_radians(alpha_deg));
        for distance in DISTANCES {
            let found = Found::at(law, domain, &design, distance);
            let known = domain.has_ligament(&design) && distance < 1.0;
            let expected = if known { DIRECTIONS } else { 0 };
            let [forces, tangent] = found.errors;
            let promise = found.not_finite == 0
                && found.inside == expected
                && forces.max(tangent) < CONSISTENT;
            broken += usize::from(!promise);
            writeln!(
                text,
                "| {ligament}, {w_lig:.1} mm | {distance} | {} | {forces:.0e} | {tangent:.0e} | {} | {} |",
                found.not_finite,
                found.inside,
                kept(promise)
            )?;
        }
    }
    Ok(Checked { text, broken })
}

impl Found {
    /// At `distance` from the centre in random directions.
    fn at(
        law: &dyn HingeLaw,
        domain: &TrainingDomain,
        design: &HingeDesign,
        distance: f64,
    ) -> Self {
        let prepared = law.prepare(&[*design]);
        let energy =
            |state: [f64; 3]| prepared.energies(&[deformation(design, state)], Order::Tangent)[0];
        let inside = |state: [f64; 3]| prepared.inside(&[deformation(design, state)])[0];
        // (eta_a, eta_s, theta) of the coordinates of the domain.
        let measured = |coordinates: [f64; 3]| {
            let state = domain.state(design, coordinates);
            let [eta_a, eta_s] = state.eta(design.w_lig);
            [eta_a, eta_s, state.theta]
        };
        let reference = energy(measured(domain.centre()));
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let extent = domain.bounds().map(|[from, to]| 0.5 * (to - from));
        let mut found = Self::default();
        for _ in 0..DIRECTIONS {
            let direction: [f64; 3] = from_fn(|i| extent[i] * random.random_range(-1.0..1.0));
            let centre = domain.centre();
            let along = |length: f64| measured(from_fn(|i| centre[i] + length * direction[i]));
            // The gauge is homogeneous about the centre of the domain.
            let edge = 1.0 / domain.gauge(design, &deformation(design, along(1.0)));
            let state = if distance == DISTANCES[0] {
                direction.map(|x| distance * x)
            } else {
                along(distance * edge)
            };
            found.not_finite += usize::from(!is_finite(&energy(state)));
            found.inside += usize::from(inside(state));
            let errors = errors(energy, state, &reference, (design, extent));
            found.errors = from_fn(|i| found.errors[i].max(errors[i]));
        }
        found
    }
}

/// The state (eta_a, eta_s, theta) of a hinge.
fn deformation(design: &HingeDesign, [eta_a, eta_s, theta]: [f64; 3]) -> HingeDeformation {
    HingeDeformation::from_eta(eta_a, eta_s, theta, design.w_lig)
}

fn is_finite(energy: &HingeEnergy) -> bool {
    let tangent = energy.tangent.as_flattened().iter();
    let mut numbers = energy.forces.iter().chain(tangent).chain([&energy.w]);
    numbers.all(|number| number.is_finite())
}

/// See [`Found::errors`]: with central differences, in the coordinates (eta_a, eta_s, theta).
fn errors(
    at: impl Fn([f64; 3]) -> HingeEnergy,
    state: [f64; 3],
    reference: &HingeEnergy,
    (design, extent): (&HingeDesign, [f64; 3]),
) -> [f64; 2] {
    let here = at(state);
    let arms = [design.w_lig, design.w_lig, 1.0];
    let force = |energy: &HingeEnergy, i: usize| arms[i] * energy.forces[i] * extent[i];
    let scale =
        |energy: &HingeEnergy| (0..3).fold(0.0_f64, |most, i| most.max(force(energy, i).abs()));
    let size = scale(&here).max(scale(reference));
    let mut errors = [0.0_f64; 2];
    for i in 0..3 {
        let beside = |sign: f64| {
            let mut moved = state;
            moved[i] += sign * STEP * extent[i];
            at(moved)
        };
        let (after, before) = (beside(1.0), beside(-1.0));
        let slope = |after: f64, before: f64| (after - before) / (2.0 * STEP);
        let of_energy = slope(after.w, before.w) - force(&here, i);
        errors[0] = errors[0].max(of_energy.abs() / size);
        for j in 0..3 {
            let tangent = here.tangent[i][j] * arms[i] * arms[j] * extent[i] * extent[j];
            let of_force = slope(force(&after, j), force(&before, j)) - tangent;
            errors[1] = errors[1].max(of_force.abs() / size.max(tangent.abs()));
        }
    }
    errors
}
