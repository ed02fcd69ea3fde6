//! A hinge law corrected to measured forces at some states of each hinge.
//!
//! ```text
//! W_c(x) = W(x) + sum_j b_j . (u_j(x) E_j(x) - u_j(0) E_j(0)),      u_j(x) = (x - x_j) / l,
//! E_j = exp(-|u_j|^2 / 2)
//! ```
//!
//! x = (eta_a, eta_s, theta), x_j are the flat hinge and the states at which the forces were
//! measured, and l are lengths over which the error of a law changes. The vectors b_j are such that
//! the correction has the measured forces, conjugate to x, minus the forces of the law: of all
//! energies that have them, this is the smoothest one (the mean of a Gaussian process with this
//! kernel, whose slopes are observed). Energy and forces of the flat hinge remain zero, and far
//! from all states, in units of l, the forces of the law remain as they are. The last measurement
//! that is not nearly flat is met exactly, earlier ones within a noise: finite elements depend on
//! the path, and differences of nearly equal states are no tangent. As a function of (a, s, theta)
//! the correction is fixed by the design at which the forces were measured, also for a design close
//! to it: derivatives in the design are only derivatives of the law. (Solak, Murray-Smith,
//! Leithead, Leith, Rasmussen, "Derivative observations in Gaussian process models of dynamic
//! systems", 2003.)

use crate::hinge_law::law::{
    DamageMeasure, HingeDamage, HingeEnergy, HingeLaw, Order, PreparedLaw,
};
use faer::{
    Col, Mat, Side,
    linalg::solvers::{Llt, Solve},
};
use hinge::{HingeDeformation, HingeDesign, TrainingDomain};
use std::{array::from_fn, sync::Arc};
use support::vectors::dot;

/// A hinge law with a correction for each hinge of one sheet.
pub struct CorrectedLaw {
    /// The law that is corrected.
    pub law: Arc<dyn HingeLaw>,
    /// One for each hinge of the sheet, in their order.
    pub corrections: Vec<Correction>,
}

/// Lengths l of (eta_a, eta_s, theta (rad)): about a third of the extent of a training domain. The
/// forces of a second round of finite elements are predicted best with 0.06 to 0.15 and 0.2 to 0.5.
pub const LENGTHS: [f64; 3] = [0.1, 0.1, 0.3];

/// Variance of the noise of all measurements but the last one, relative to the variance of the
/// correction's slopes.
const NOISE: f64 = 1e-3;

/// States closer than this to the flat hinge, in units of the lengths, are not corrected: the noise
/// of their small forces would give a large slope.
const NEARLY_FLAT: f64 = 1e-2;

/// What the forces of a law lack at one state of a hinge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissingForces {
    /// Where the forces were measured.
    pub state: HingeDeformation,
    /// Measured (F_a, F_s, M_theta) (N, N, N mm) minus the forces of the law.
    pub forces: [f64; 3],
}

/// The correction of one hinge.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Correction {
    /// Lengths of (a, s, theta) (mm, mm, rad).
    lengths: [f64; 3],
    /// States in units of the lengths, each with its vector b_j (N mm).
    centres: Vec<([f64; 3], [f64; 3])>,
}

impl Correction {
    /// The correction by measurements at some states, the last of which is met exactly.
    pub fn new(design: &HingeDesign, missing: &[MissingForces]) -> Self {
        let [of_a, of_s, of_theta] = LENGTHS;
        let lengths = [of_a * design.w_lig, of_s * design.w_lig, of_theta];
        let scaled = |measured: &MissingForces| scaled(&measured.state, lengths);
        let bent = |measured: &&MissingForces| {
            let state = scaled(measured);
            dot(&state, &state) > NEARLY_FLAT * NEARLY_FLAT
        };
        let missing: Vec<&MissingForces> = missing.iter().filter(bent).collect();
        let flat = [0.0; 3];
        let states: Vec<[f64; 3]> =
            (missing.iter().map(|measured| scaled(measured))).chain([flat]).collect();
        let slopes: Vec<f64> = (missing.iter())
            .flat_map(|measured| from_fn::<_, 3, _>(|k| measured.forces[k] * lengths[k]))
            .chain(flat)
            .collect();
        let size = slopes.len();
        let noisy = 3 * missing.len().saturating_sub(1);
        let covariance = Mat::from_fn(size, size, |i, j| {
            let noise = if i == j && i < noisy { NOISE } else { 0.0 };
            kernel_slopes(states[i / 3], states[j / 3])[i % 3][j % 3] + noise
        });
        let factor = Llt::new(covariance.as_ref(), Side::Lower)
            .expect("the last state is not flat, and the others have noise");
        let solved = factor.solve(Col::from_fn(size, |i| slopes[i]));
        let vector = |j: usize| from_fn(|k| solved[3 * j + k]);
        Self {
            lengths,
            centres: states.iter().enumerate().map(|(j, &state)| (state, vector(j))).collect(),
        }
    }

    /// Adds the correction to the energy of a hinge and its derivatives in (a, s, theta).
    fn add(&self, energy: &mut HingeEnergy, state: &HingeDeformation, order: Order) {
        let x = scaled(state, self.lengths);
        for (centre, b) in &self.centres {
            let (u, at_flat) = (minus(x, *centre), minus([0.0; 3], *centre));
            let (decay, along) = (gaussian(u), dot(b, &u));
            energy.w += decay * along - gaussian(at_flat) * dot(b, &at_flat);
            for i in (0..3).filter(|_| order >= Order::Forces) {
                energy.forces[i] += decay * (b[i] - along * u[i]) / self.lengths[i];
                for j in (0..3).filter(|_| order >= Order::Tangent) {
                    let unit = if i == j { 1.0 } else { 0.0 };
                    let curvature = along * (u[i] * u[j] - unit) - b[i] * u[j] - u[i] * b[j];
                    energy.tangent[i][j] += decay * curvature / (self.lengths[i] * self.lengths[j]);
                }
            }
        }
    }
}

/// (a, s, theta) in units of the lengths.
fn scaled(state: &HingeDeformation, lengths: [f64; 3]) -> [f64; 3] {
    let state = state.to_array();
    from_fn(|i| state[i] / lengths[i])
}

fn gaussian(u: [f64; 3]) -> f64 {
    (-0.5 * dot(&u, &u)).exp()
}

/// Covariance of the slopes at two states: the mixed second derivative of the Gaussian kernel.
fn kernel_slopes(x: [f64; 3], y: [f64; 3]) -> [[f64; 3]; 3] {
    let u = minus(x, y);
    let unit = |i, j| if i == j { 1.0 } else { 0.0 };
    from_fn(|i| from_fn(|j| gaussian(u) * (unit(i, j) - u[i] * u[j])))
}

impl HingeLaw for CorrectedLaw {
    /// # Panics
    /// If the numbers of hinges and of corrections differ.
    fn prepare<'a>(&'a self, designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        assert_eq!(designs.len(), self.corrections.len(), "one correction per hinge");
        Box::new(PreparedCorrected {
            law: self.law.prepare(designs),
            corrections: &self.corrections,
        })
    }

    fn damage_scale(&self, measure: DamageMeasure) -> Option<f64> {
        self.law.damage_scale(measure)
    }

    fn domain(&self) -> Option<&TrainingDomain> {
        self.law.domain()
    }
}

struct PreparedCorrected<'a> {
    law: Box<dyn PreparedLaw + 'a>,
    corrections: &'a [Correction],
}

impl PreparedLaw for PreparedCorrected<'_> {
    fn energies(&self, deformations: &[HingeDeformation], order: Order) -> Vec<HingeEnergy> {
        let mut energies = self.law.energies(deformations, order);
        let hinges = energies.iter_mut().zip(self.corrections);
        for ((energy, correction), deformation) in hinges.zip(deformations) {
            correction.add(energy, deformation, order);
        }
        energies
    }

    fn damage(&self, deformations: &[HingeDeformation], with_gradient: bool) -> Vec<HingeDamage> {
        self.law.damage(deformations, with_gradient)
    }

    fn resolution(&self) -> f64 {
        self.law.resolution()
    }

    fn inside(&self, deformations: &[HingeDeformation]) -> Vec<bool> {
        self.law.inside(deformations)
    }
}

fn minus(x: [f64; 3], y: [f64; 3]) -> [f64; 3] {
    from_fn(|i| x[i] - y[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hinge_law::SurrogateLaw;
    use ::surrogate::Surrogate;
    use hinge::HingeConstants;
    use testkit::derivatives::assert_gradient;

    const MISSING: [f64; 3] = [-1.5, 0.7, 40.0];

    fn design() -> HingeDesign {
        HingeConstants::PAPER.hinge(10.0, 1.3)
    }

    fn state() -> HingeDeformation {
        HingeDeformation::from([-0.5, 0.2, 0.4])
    }

    fn missing() -> MissingForces {
        MissingForces { state: state(), forces: MISSING }
    }

    /// The energy of the correction by some measurements.
    fn correction(missing: &[MissingForces], at: &HingeDeformation) -> HingeEnergy {
        let mut energy = HingeEnergy::default();
        Correction::new(&design(), missing).add(&mut energy, at, Order::Tangent);
        energy
    }

    #[test]
    fn the_last_forces_are_met_and_the_flat_hinge_stays_free_of_force() {
        let earlier = MissingForces {
            state: HingeDeformation::from([-0.2, 0.4, 0.3]),
            forces: [-1.0, 0.5, 30.0],
        };
        for measured in [&[missing()][..], &[earlier, missing()]] {
            let found = correction(measured, &state()).forces;
            for (found, missing) in std::iter::zip(found, MISSING) {
                assert!((found - missing).abs() < 1e-9, "{found} {missing}");
            }
            let flat = correction(measured, &HingeDeformation::default());
            assert!(flat.w.abs() < 1e-12);
            assert!(flat.forces.iter().all(|force| force.abs() < 1e-9));
        }
        let found = correction(&[earlier, missing()], &earlier.state).forces;
        let error = (found[2] / earlier.forces[2] - 1.0).abs();
        assert!(0.0 < error && error < NOISE.sqrt(), "{found:?}");
    }

    #[test]
    fn a_smooth_error_is_predicted_between_its_measurements() {
        let error = |state: &HingeDeformation| {
            let [a, s, theta] = state.to_array();
            let moment = 2.0 * a + 60.0 * theta * theta;
            [10.0 * a + 2.0 * theta, 3.0 * s, moment]
        };
        let measured = [[-0.6, 0.1, 0.35], [-0.4, 0.3, 0.35], [-0.5, 0.25, 0.45]].map(|state| {
            let state = HingeDeformation::from(state);
            let forces = error(&state);
            MissingForces { state, forces }
        });
        let found = correction(&measured, &state()).forces;
        // The last measurement has 25 % more F_s and 30 % more M_theta.
        let expected = error(&state());
        for (found, expected) in std::iter::zip(found, expected) {
            assert!((found / expected - 1.0).abs() < 0.12, "{found} {expected}");
        }
    }

    /// A hinge under a dead moment of 11 N mm, by a law whose moment is nearly constant beyond
    /// yield; its measured yield moment is 5 % larger. The rotations are 0.5 rad by the law and
    /// 0.25 rad by the measurements.
    #[test]
    fn a_law_that_is_nearly_flat_beyond_yield_is_balanced_in_a_few_rounds() {
        let moment = |yields: f64, theta: f64| yields * (theta / 0.02).tanh() + 2.0 * theta;
        let at = |theta| HingeDeformation::from([0.0, 0.0, theta]);
        let mut missing: Vec<MissingForces> = Vec::new();
        let mut theta = 0.5;
        for _ in 0..4 {
            let lacks = moment(10.5, theta) - moment(10.0, theta);
            missing.push(MissingForces { state: at(theta), forces: [0.0, 0.0, lacks] });
            let [mut below, mut above] = [0.0, 1.0];
            for _ in 0..50 {
                theta = 0.5 * (below + above);
                let found = moment(10.0, theta) + correction(&missing, &at(theta)).forces[2];
                let end = if found < 11.0 { &mut below } else { &mut above };
                *end = theta;
            }
        }
        assert!((theta - 0.25).abs() < 1e-3, "{theta}");
    }

    /// The truncation error is h^2 / 6 of the third and fourth derivatives, which are about M / l^3
    /// and M / l^4.
    #[test]
    fn forces_and_tangent_are_the_derivatives_of_the_energy() {
        let at = [0.3, -0.4, 0.3];
        let found = correction(&[missing()], &HingeDeformation::from(at));
        let of = |x: &[f64]| correction(&[missing()], &[x[0], x[1], x[2]].into());
        assert_gradient(|x| of(x).w, &at, &found.forces, 1e-4, |_| 1e-5);
        for j in 0..3 {
            let column = found.tangent.map(|row| row[j]);
            assert_gradient(|x| of(x).forces[j], &at, &column, 1e-4, |_| 1e-4);
        }
    }

    #[test]
    fn derivatives_in_the_design_are_those_of_energy_and_forces() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let weights = root.join("../data/pet-0.5mm/small.safetensors");
        let surrogate = Surrogate::load(&weights).unwrap();
        let law = CorrectedLaw {
            law: Arc::new(SurrogateLaw { surrogate }),
            corrections: vec![Correction::new(&design(), &[missing()])],
        };
        let of = |design: &HingeDesign| {
            let prepared = law.prepare(std::slice::from_ref(design));
            prepared.energies(&[state()], Order::Design)[0]
        };
        let found = of(&design());
        let at = |x: &[f64]| of(&HingeConstants::PAPER.hinge(x[0], x[1]));
        let (x, allowed) = ([10.0, 1.3], |slope: f64| 1e-5 * slope.abs());
        assert_gradient(|x| at(x).w, &x, &found.design.to_array()[..2], 1e-4, allowed);
        for j in 0..3 {
            let mixed = found.mixed[j].to_array();
            assert_gradient(|x| at(x).forces[j], &x, &mixed[..2], 1e-4, allowed);
        }
    }

    #[test]
    fn forces_of_the_law_itself_and_of_a_flat_hinge_correct_nothing() {
        let own = MissingForces { state: state(), forces: [0.0; 3] };
        let flat = MissingForces { state: HingeDeformation::default(), forces: MISSING };
        for missing in [own, flat] {
            let found = correction(&[missing], &state());
            assert_eq!((found.w, found.forces), (0.0, [0.0; 3]));
        }
    }
}
