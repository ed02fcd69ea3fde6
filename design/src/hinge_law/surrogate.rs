//! The learned hinge energy (14) inside its training domain, and its continuation outside.
//!
//! ```text
//! W_law(x; g) = W(y(x); g) + k (W_s + W(y(x); g)) e^3 / (e + delta),        e = max(0, gamma(x) -
//! 1) y(x) = c + (x - c) psi(gamma) / gamma,              psi = 1 + delta z / (1 + z^3)^(1/3),  z =
//! e / delta
//! ```
//!
//! gamma is the gauge of the domain and c its centre. Inside, y = x. Outside, y stays within delta
//! of the domain, so that the network is not evaluated far from its data. The second term is cubic
//! near the domain and quadratic far from it, and returns the state to the domain: W_law is twice
//! differentiable and coercive for any weights. It grows with the energy at the edge, which is
//! several hundred W_s where a wide ligament is pulled: a term of W_s alone is less than what W(y)
//! loses as y stops, and the sheet snaps outwards there. The cut angle is mapped to its interval by
//! the same psi.

use crate::hinge_law::law::{
    DamageMeasure, DesignGradient, HingeDamage, HingeEnergy, HingeGradient, HingeLaw, Order,
    PreparedLaw,
};
use hinge::{HingeDeformation, HingeDesign, Jet, Section, TrainingDomain};
use std::iter::zip;
use std::{array::from_fn, ops::Deref, sync::Arc};
use surrogate::{Prepared, Surrogate};

/// delta: maximum distance outside the domain at which the network is evaluated, relative to the
/// half-range.
const BEYOND: f64 = 0.1;
/// k: the force along a line outwards does not fall if dW/dgamma at the edge is at most 6 (W_s +
/// W), since the second derivative of e^3 / (e + delta) is at least 0.16 times the second
/// derivative of -psi.
const RETURN_STIFFNESS: f64 = 40.0;
/// Half-range of the cut angle (rad) for weights that were trained on a single one.
const NARROWEST_ANGLE: f64 = 0.01;

/// The standardised features (13) and the activations of the layers are of order one: a deformation
/// is resolved to a few of their last digits.
const RESOLUTION: f64 = 16.0 * f64::EPSILON;

/// The learned hinge law.
#[derive(Clone, Debug)]
pub struct SurrogateLaw {
    /// The learned energy of the law.
    pub surrogate: Surrogate,
}

impl HingeLaw for SurrogateLaw {
    fn prepare<'a>(&'a self, designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        Box::new(PreparedSurrogate::new(&self.surrogate, designs))
    }

    fn damage_scale(&self, measure: DamageMeasure) -> Option<f64> {
        match measure {
            DamageMeasure::Mean => Some(self.surrogate.damage_scale()),
            DamageMeasure::Peak => self.surrogate.card().peak_scale,
        }
    }

    fn domain(&self) -> Option<&TrainingDomain> {
        Some(self.surrogate.domain())
    }

    fn scaled(&self, thickness: f64, stress: f64) -> Option<Arc<dyn HingeLaw>> {
        let surrogate = self.surrogate.clone().scaled(thickness);
        Some(Arc::new(Self { surrogate: surrogate.stressed(stress, None) }))
    }

    fn scales(&self) -> [bool; 2] {
        [true; 2]
    }
}

/// The learned hinge law prepared for some hinges; `S` refers to its surrogate.
pub struct PreparedSurrogate<S> {
    surrogate: S,
    designs: Vec<HingeDesign>,
    /// Training domain of each.
    sections: Vec<Section>,
    /// d(mapped cut angle) / d(cut angle of the hinge), per hinge.
    angle_slopes: Vec<f64>,
    /// Prepared for the mapped cut angles.
    prepared: Prepared,
}

impl<S: Deref<Target = Surrogate>> PreparedSurrogate<S> {
    /// Computes what depends only on the designs.
    pub fn new(surrogate: S, designs: &[HingeDesign]) -> Self {
        let (mapped, angle_slopes): (Vec<HingeDesign>, Vec<f64>) = designs
            .iter()
            .map(|design| {
                let [alpha, slope] = drawn_in(surrogate.domain().alpha, design.alpha);
                (HingeDesign { alpha, ..*design }, slope)
            })
            .unzip();
        Self {
            designs: designs.to_vec(),
            sections: designs.iter().map(|design| surrogate.domain().section(design)).collect(),
            angle_slopes,
            prepared: surrogate.prepare(&mapped),
            surrogate,
        }
    }

    /// The states at which the network is evaluated, and for hinges outside the domain their map
    /// from the actual state.
    fn mapped(
        &self,
        deformations: &[HingeDeformation],
    ) -> (Vec<HingeDeformation>, Vec<Option<Continuation>>) {
        let domain = self.surrogate.domain();
        let hinges = zip(zip(&self.designs, &self.sections), deformations);
        hinges
            .map(|((design, section), deformation)| {
                let beyond = domain.is_beyond(1.0, section, deformation);
                let beyond = beyond.then(|| Continuation::new(domain, design, deformation));
                let mapped = beyond.as_ref().map_or(*deformation, Continuation::mapped);
                (mapped, beyond)
            })
            .unzip()
    }
}

impl<S: Deref<Target = Surrogate> + Sync> PreparedLaw for PreparedSurrogate<S> {
    fn energies(&self, deformations: &[HingeDeformation], order: Order) -> Vec<HingeEnergy> {
        let (mapped, continuations) = self.mapped(deformations);
        let mut energies = self.surrogate.evaluate(&self.prepared, &mapped, order);
        let scale = self.surrogate.energy_scale();
        for (h, energy) in energies.iter_mut().enumerate() {
            let by_design = std::iter::once(&mut energy.design).chain(&mut energy.mixed);
            by_design.for_each(|gradient| gradient.alpha *= self.angle_slopes[h]);
            if let Some(continuation) = &continuations[h] {
                *energy = continuation.energy(energy, scale, order);
            }
        }
        energies
    }

    fn damage(&self, deformations: &[HingeDeformation], with_gradient: bool) -> Vec<HingeDamage> {
        let (mapped, continuations) = self.mapped(deformations);
        let designs = self.prepared.designs();
        let mut damages = self.surrogate.damage(designs, &mapped, with_gradient);
        for (h, damage) in damages.iter_mut().enumerate().filter(|_| with_gradient) {
            for gradient in [&mut damage.gradient, &mut damage.peak_gradient] {
                gradient.design.alpha *= self.angle_slopes[h];
                if let Some(continuation) = &continuations[h] {
                    *gradient = continuation.gradient(gradient);
                }
            }
        }
        damages
    }

    fn resolution(&self) -> f64 {
        RESOLUTION
    }

    fn inside(&self, deformations: &[HingeDeformation]) -> Vec<bool> {
        zip(&self.designs, deformations)
            .map(|(design, deformation)| self.surrogate.domain().contains(design, deformation))
            .collect()
    }
}

/// One state outside the domain.
struct Continuation {
    /// gamma
    gauge: Jet,
    /// (a, s, theta) of y.
    mapped: [Jet; 3],
}

impl Continuation {
    fn new(domain: &TrainingDomain, design: &HingeDesign, deformation: &HingeDeformation) -> Self {
        let gauge = domain.gauge_jet(design, deformation);
        let drawn = gauge.map(saturated(gauge.value)) * gauge.recip();
        // The domain is star-shaped in its coordinates.
        let at = domain.coordinates_jet(design, deformation);
        let mapped = from_fn(|i| {
            let centre = Jet::constant(domain.centre()[i]);
            centre + (at[i] - centre) * drawn
        });
        Self { gauge, mapped: domain.state_jet(design, mapped) }
    }

    fn mapped(&self) -> HingeDeformation {
        self.mapped.map(|y| y.value).into()
    }

    /// W_law from the energy at y and W_s.
    fn energy(&self, at: &HingeEnergy, scale: f64, order: Order) -> HingeEnergy {
        let y = &self.mapped;
        let returning = self.gauge.map(returning(self.gauge.value)) * RETURN_STIFFNESS;
        // d2W/dy_i d(variable j); the variable changes y only.
        let stiffness = |i: usize, j: usize| sum(|l| at.tangent[i][l] * y[l].gradient[j]);
        let curvature = |j: usize, k: usize| {
            sum(|i| y[i].gradient[j] * stiffness(i, k) + at.forces[i] * y[i].hessian[j][k])
        };
        // W(y) as a function of (a, s, theta, w_lig, rho_f), without the network's own dependence
        // on the last two.
        let drawn = Jet {
            value: at.w,
            gradient: from_fn(|j| sum(|i| at.forces[i] * y[i].gradient[j])),
            hessian: from_fn(|j| from_fn(|k| curvature(j, k))),
        };
        let law = drawn + (drawn + Jet::constant(scale)) * returning;
        let grown = 1.0 + returning.value;
        let (by_design, mixed) = (at.design.to_array(), at.mixed.map(DesignGradient::to_array));
        let mixed = |j: usize, g: usize| {
            grown * sum(|i| y[i].gradient[j] * mixed[i][g]) + returning.gradient[j] * by_design[g]
        };
        let mut energy = HingeEnergy { w: law.value, ..HingeEnergy::default() };
        if order >= Order::Forces {
            energy.forces = from_fn(|j| law.gradient[j]);
        }
        if order >= Order::Tangent {
            energy.tangent = from_fn(|j| from_fn(|k| law.hessian[j][k]));
        }
        if order >= Order::Design {
            energy.design = at.design * grown;
            energy.design += HingeGradient::from_jet(law.gradient).design;
            for j in 0..3 {
                energy.mixed[j] = from_fn(|g| mixed(j, g)).into();
                energy.mixed[j] += HingeGradient::from_jet(law.hessian[j]).design;
            }
        }
        energy
    }

    /// A gradient at y, pulled back to x.
    fn gradient(&self, at: &HingeGradient) -> HingeGradient {
        let along = |j: usize| sum(|i| at.state[i] * self.mapped[i].gradient[j]);
        let mut gradient = HingeGradient::from_jet(from_fn(along));
        gradient.design += at.design;
        gradient
    }
}

fn sum(of: impl Fn(usize) -> f64) -> f64 {
    (0..3).map(of).sum()
}

/// psi and its first two derivatives at `gauge` > 1.
fn saturated(gauge: f64) -> [f64; 3] {
    let z = (gauge - 1.0) / BEYOND;
    let root = (1.0 + z * z * z).cbrt();
    [1.0 + BEYOND * z / root, root.powi(-4), -4.0 * z * z * root.powi(-7) / BEYOND]
}

/// e^3 / (e + delta) and its first two derivatives at `gauge` > 1.
fn returning(gauge: f64) -> [f64; 3] {
    let e = gauge - 1.0;
    let sum = e + BEYOND;
    [
        e.powi(3) / sum,
        e * e * (2.0 * e + 3.0 * BEYOND) / (sum * sum),
        2.0 * e * (e * e + 3.0 * e * BEYOND + 3.0 * BEYOND * BEYOND) / sum.powi(3),
    ]
}

/// The mapped cut angle of a hinge, and its derivative.
fn drawn_in([minimum, maximum]: [f64; 2], alpha: f64) -> [f64; 2] {
    let middle = 0.5 * (minimum + maximum);
    let half = (0.5 * (maximum - minimum)).max(NARROWEST_ANGLE);
    let distance = (alpha - middle) / half;
    if distance.abs() <= 1.0 {
        return [alpha, 1.0];
    }
    let [drawn, slope, _] = saturated(distance.abs());
    [middle + half * drawn * distance.signum(), slope]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use testkit::derivatives::assert_gradient;

    fn law(weights: &str) -> SurrogateLaw {
        let weights = Path::new(env!("CARGO_MANIFEST_DIR")).join(weights);
        let surrogate = Surrogate::load(&weights.with_extension("safetensors")).unwrap();
        SurrogateLaw { surrogate }
    }

    fn tiny() -> SurrogateLaw {
        law("tests/cases/chi_tiny")
    }

    fn design(w_lig: f64, alpha: f64) -> HingeDesign {
        hinge::HingeConstants::PAPER.hinge(w_lig, alpha)
    }

    /// x = (a, s, theta, w_lig, alpha)
    fn energy(law: &SurrogateLaw, x: &[f64]) -> HingeEnergy {
        let deformation = HingeDeformation::from([x[0], x[1], x[2]]);
        let prepared = law.prepare(&[design(x[3], x[4])]);
        prepared.energies(&[deformation], Order::Design)[0]
    }

    #[test]
    fn outside_the_domain_every_derivative_agrees_with_differences() {
        let law = tiny();
        for x in [
            [9.0, -11.0, 1.4, 18.0, 1.4],
            [-14.0, 9.5, -0.2, 16.0, 1.9],
            [-3.0, 1.0, 0.6, 16.0, 1.9],
        ] {
            let found = energy(&law, &x);
            let allowed = |slope: f64| 1e-7 * law.surrogate.energy_scale().max(slope.abs());
            let first = [&found.forces[..], &found.design.to_array()[..2]].concat();
            assert_gradient(|x| energy(&law, x).w, &x, &first, 1e-5, allowed);
            for i in 0..3 {
                let force = |x: &[f64]| energy(&law, x).forces[i];
                let second = [&found.tangent[i][..], &found.mixed[i].to_array()[..2]].concat();
                assert_gradient(force, &x, &second, 1e-5, allowed);
            }
        }
    }

    #[test]
    fn the_energy_grows_without_bound_and_the_inside_is_untouched() {
        let law = tiny();
        // Quadratic far out, in each direction and sign.
        for c in 0..3 {
            let far = |t: f64| {
                let mut x = [0.0, 0.0, 0.0, 18.0, 1.5];
                x[c] = t;
                energy(&law, &x).w
            };
            for t in [1e5, -1e5] {
                assert!((far(2.0 * t) / far(t) - 4.0).abs() < 0.01, "{c} {t}");
            }
        }
        let state = HingeDeformation::from([1.0, 1.0, 0.5]);
        let design = design(18.0, 1.5);
        let surrogate = &law.surrogate;
        let bare = surrogate.evaluate(&surrogate.prepare(&[design]), &[state], Order::Design);
        assert_eq!(energy(&law, &[1.0, 1.0, 0.5, 18.0, 1.5]), bare[0]);
        assert_eq!(law.prepare(&[design]).inside(&[state]), [true]);
    }

    #[test]
    fn the_return_outweighs_the_end_of_the_learned_force() {
        for i in 1..1000 {
            let gauge = 1.0 + 1e-3 * f64::from(i);
            let [lost, gained] = [-saturated(gauge)[2], returning(gauge)[2]];
            assert!(gained >= 0.16 * lost, "{gauge}");
        }
    }

    #[test]
    fn derivatives_beyond_the_order_are_zero_outside_too() {
        let law = tiny();
        let prepared = law.prepare(&[design(18.0, 1.4)]);
        let outside = HingeDeformation::from([9.0, -11.0, 1.4]);
        let numbers = |order| {
            let HingeEnergy { w, forces, tangent, design, mixed } =
                prepared.energies(&[outside], order)[0];
            let mixed = mixed.map(DesignGradient::to_array);
            let [tangent, mixed] = [&tangent, &mixed].map(|rows| rows.as_flattened());
            [&[w][..], &forces, tangent, &design.to_array(), mixed].concat()
        };
        let all = numbers(Order::Design);
        for (order, known) in [(Order::Value, 1), (Order::Forces, 4), (Order::Tangent, 13)] {
            let found = numbers(order);
            assert!(found[known..].iter().all(|x| *x == 0.0), "{found:?}");
            // Products of blocks of other sizes differ by rounding.
            for (found, expected) in zip(&found[..known], &all) {
                assert!((found / expected - 1.0).abs() < 1e-13, "{found} {expected}");
            }
        }
    }

    /// On lines from the centre outwards the force that returns a hinge does not fall: no ridge,
    /// no second minimum, no snap. In the states of the edge of the shipped weights `small`.
    #[test]
    fn beyond_the_edge_the_force_does_not_fall() {
        let law = law("../data/pet-0.5mm/small");
        let domain = law.surrogate.domain();
        let (centre, bounds) = (domain.centre(), domain.bounds());
        // Fractions of multiples of irrational numbers fill the intervals evenly.
        let part = |i: usize, number: f64| (i as f64 * number).fract();
        for i in 0..500 {
            let w_lig = 5.0 * 5f64.powf(part(i, 0.618_033_988_7));
            let design = design(w_lig, 0.8 + 1.5 * part(i, 0.414_213_562_4));
            let outwards: [f64; 3] = from_fn(|j| {
                let number = [0.732_050_807_6, 0.236_067_977_5, 0.645_751_311_1][j];
                (part(i, number) - 0.5) * (bounds[j][1] - bounds[j][0])
            });
            let state = |t: f64| domain.state(&design, from_fn(|j| centre[j] + t * outwards[j]));
            let edge = 1.0 / domain.gauge(&design, &state(1.0));
            let prepared = law.prepare(&[design]);
            // The derivative of W in gamma.
            let slope = |gamma: f64| {
                let energies = prepared.energies(&[state(gamma * edge)], Order::Forces);
                let [f_a, f_s, m_theta] = energies[0].forces;
                let [a, s, theta] = outwards;
                edge * (w_lig * (f_a * a + f_s * s) + m_theta * theta)
            };
            let (mut peak, mut fall) = (f64::NEG_INFINITY, 0.0_f64);
            for slope in (0..=60).map(|i| slope(1.0 + 0.005 * f64::from(i))) {
                peak = peak.max(slope);
                fall = fall.max(peak - slope);
            }
            // The networks' own softening at the edge of a folding hinge.
            let most = 0.3 * law.surrogate.energy_scale();
            assert!(fall < most, "{w_lig} {outwards:?}: {fall}");
        }
    }

    #[test]
    fn a_cut_angle_outside_the_domain_is_mapped_to_it_smoothly() {
        let interval = [0.8, 2.4];
        assert_eq!(drawn_in(interval, 1.0), [1.0, 1.0]);
        for alpha in [0.75, 0.3, 2.41, 3.0] {
            let [drawn, slope] = drawn_in(interval, alpha);
            assert!((0.8 - 0.081..=2.4 + 0.081).contains(&drawn), "{drawn}");
            let difference = (drawn_in(interval, alpha + 1e-6)[0] - drawn) / 1e-6;
            assert!((slope - difference).abs() < 1e-4);
        }
        assert!(drawn_in([1.0; 2], 1.5)[0].is_finite());
    }
}
