//! A hinge law corrected to measured forces at one state of each hinge.
//!
//! ```text
//! W_c(x) = W(x) + x' A x / 2,      A = (d e' + e d') / e'e - (d'e) e e' / (e'e)^2,      A e = d
//! ```
//!
//! x = (eta_a, eta_s, theta), e is the state at which the forces were measured, and d the measured forces, conjugate to
//! x, minus those of the law. Of all symmetric A that satisfy A e = d, this is the one with the smallest norm: the
//! symmetric secant update of Powell. Energy and forces of the flat hinge remain zero. As a function of (a, s, theta)
//! the correction is that of the design at which the forces were measured, also for a design close to it: derivatives in
//! the design are those of the law alone.
//! (Powell, "A new algorithm for unconstrained optimization", 1970.)

use crate::hinge_law::law::{
    DamageMeasure, HingeDamage, HingeEnergy, HingeLaw, Order, PreparedLaw,
};
use hinge::{HingeDeformation, HingeDesign, TrainingDomain};
use std::array::from_fn;
use std::sync::Arc;

/// A hinge law with a correction for each hinge of one sheet.
pub struct CorrectedLaw {
    law: Arc<dyn HingeLaw>,
    corrections: Vec<Correction>,
}

/// The correction of one hinge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Correction {
    /// The symmetric matrix of the correction in (a, s, theta) (N / mm, N, N mm).
    matrix: [[f64; 3]; 3],
}

impl Correction {
    /// The correction to the forces (F_a, F_s, M_theta) (N, N, N mm) that were measured at `state`; `law` are those of
    /// the law there. A flat hinge is not corrected.
    pub fn new(
        design: &HingeDesign,
        state: &HingeDeformation,
        measured: [f64; 3],
        law: [f64; 3],
    ) -> Self {
        let arms = [design.w_lig, design.w_lig, 1.0];
        let state = state.to_array();
        let e: [f64; 3] = from_fn(|i| state[i] / arms[i]);
        let d: [f64; 3] = from_fn(|i| arms[i] * (measured[i] - law[i]));
        let square = dot(e, e);
        if square == 0.0 {
            return Self::default();
        }
        let along = dot(d, e) / (square * square);
        let scaled = |i, j| (d[i] * e[j] + e[i] * d[j]) / square - along * e[i] * e[j];
        Self {
            matrix: from_fn(|i| from_fn(|j| scaled(i, j) / (arms[i] * arms[j]))),
        }
    }

    /// Adds the correction to the energy of a hinge and its derivatives in (a, s, theta).
    fn add(&self, energy: &mut HingeEnergy, state: &HingeDeformation, order: Order) {
        let x = state.to_array();
        let forces: [f64; 3] = from_fn(|i| dot(self.matrix[i], x));
        energy.w += 0.5 * dot(forces, x);
        if order >= Order::Forces {
            for (sum, force) in energy.forces.iter_mut().zip(forces) {
                *sum += force;
            }
        }
        if order >= Order::Tangent {
            let tangent = energy.tangent.as_flattened_mut().iter_mut();
            for (sum, entry) in tangent.zip(self.matrix.as_flattened()) {
                *sum += entry;
            }
        }
    }
}

impl CorrectedLaw {
    /// The law with one correction for each hinge of a sheet, in their order.
    pub fn new(law: Arc<dyn HingeLaw>, corrections: Vec<Correction>) -> Self {
        Self { law, corrections }
    }
}

impl HingeLaw for CorrectedLaw {
    /// # Panics
    /// If the numbers of hinges and of corrections differ.
    fn prepare<'a>(&'a self, designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        assert_eq!(
            designs.len(),
            self.corrections.len(),
            "one correction per hinge"
        );
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

fn dot(x: [f64; 3], y: [f64; 3]) -> f64 {
    std::iter::zip(x, y).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::taylor::central_slope;
    use crate::hinge_law::{LinearLaw, SurrogateLaw};
    use ::surrogate::Surrogate;
    use hinge::HingeConstants;

    const MEASURED: [f64; 3] = [-1.5, 0.7, 40.0];

    fn design() -> HingeDesign {
        HingeConstants::PAPER.hinge(10.0, 1.3)
    }

    fn state() -> HingeDeformation {
        HingeDeformation::from([-2.0, 0.5, 0.6])
    }

    fn linear() -> Arc<LinearLaw> {
        Arc::new(LinearLaw::uniform([3.0, 2.0, 50.0], 1).unwrap())
    }

    /// The energy by the law corrected to [`MEASURED`] at [`state`].
    fn corrected(at: &HingeDeformation) -> HingeEnergy {
        let law = linear();
        let own = law.prepare(&[design()]).energies(&[state()], Order::Forces)[0];
        let correction = Correction::new(&design(), &state(), MEASURED, own.forces);
        let law = CorrectedLaw::new(law, vec![correction]);
        law.prepare(&[design()]).energies(&[*at], Order::Tangent)[0]
    }

    #[test]
    fn the_measured_forces_are_met_and_the_flat_hinge_stays_free_of_force() {
        let found = corrected(&state()).forces;
        for (found, measured) in std::iter::zip(found, MEASURED) {
            assert!((found - measured).abs() < 1e-12, "{found} {measured}");
        }
        let flat = corrected(&HingeDeformation::default());
        assert_eq!((flat.w, flat.forces), (0.0, [0.0; 3]));
    }

    #[test]
    fn forces_and_tangent_are_the_derivatives_of_the_energy() {
        let at = [0.8, -1.1, 0.3];
        let found = corrected(&HingeDeformation::from(at));
        for i in 0..3 {
            let unit: Vec<f64> = (0..3).map(|j| f64::from(i == j)).collect();
            let slope = |part: &dyn Fn(&HingeEnergy) -> f64| {
                let of = |x: &[f64]| part(&corrected(&[x[0], x[1], x[2]].into()));
                central_slope(of, &at, &unit, 1e-4)
            };
            assert!((found.forces[i] - slope(&|energy| energy.w)).abs() < 1e-7);
            for j in 0..3 {
                let expected = slope(&|energy| energy.forces[j]);
                assert!((found.tangent[i][j] - expected).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn derivatives_in_the_design_are_those_of_energy_and_forces() {
        let weights = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../data/pet-0.5mm/small.safetensors"
        );
        let law = Surrogate::load(std::path::Path::new(weights)).unwrap();
        let law: Arc<dyn HingeLaw> = Arc::new(SurrogateLaw::new(law));
        let correction = Correction::new(&design(), &state(), MEASURED, [0.0; 3]);
        let law = CorrectedLaw::new(law, vec![correction]);
        let of = |design: &HingeDesign| {
            let prepared = law.prepare(std::slice::from_ref(design));
            prepared.energies(&[state()], Order::Design)[0]
        };
        let found = of(&design());
        for i in 0..2 {
            let unit: Vec<f64> = (0..2).map(|j| f64::from(i == j)).collect();
            let slope = |part: &dyn Fn(&HingeEnergy) -> f64| {
                let at = |x: &[f64]| part(&of(&HingeConstants::PAPER.hinge(x[0], x[1])));
                central_slope(at, &[10.0, 1.3], &unit, 1e-4)
            };
            let expected = slope(&|energy| energy.w);
            assert!((found.design[i] - expected).abs() < 1e-5 * expected.abs());
            for j in 0..3 {
                let expected = slope(&|energy| energy.forces[j]);
                assert!((found.mixed[j][i] - expected).abs() < 1e-5 * expected.abs());
            }
        }
    }

    #[test]
    fn forces_of_the_law_itself_correct_nothing() {
        let own = [1.0, 2.0, 3.0];
        let none = Correction::new(&design(), &state(), own, own);
        assert_eq!(none, Correction::default());
        let flat = HingeDeformation::default();
        let of_flat = Correction::new(&design(), &flat, MEASURED, own);
        assert_eq!(of_flat, Correction::default());
    }
}
