//! The kernel, compared with an independent implementation at 50 states and with finite
//! differences.

mod common;

use common::{cases, design, tiny, with_peak};
use hinge::{DesignGradient, HingeDeformation, HingeDesign, HingeGradient};
use serde_json::Value;
use surrogate::{DenseLayer, HingeEnergy, Layers, Order, Surrogate, Tensor, feature_names};

/// The reference states, from an independent implementation.
fn states() -> Vec<Value> {
    let text = std::fs::read_to_string(cases().join("states_tiny.json")).unwrap();
    let file: Value = serde_json::from_str(&text).unwrap();
    file["states"].as_array().unwrap().clone()
}

/// The numbers in a value, in reading order.
fn numbers(value: &Value) -> Vec<f64> {
    match value.as_array() {
        Some(values) => values.iter().flat_map(numbers).collect(),
        None => vec![value.as_f64().unwrap()],
    }
}

fn hinges(states: &[Value]) -> (Vec<HingeDesign>, Vec<HingeDeformation>) {
    let hinge = |state: &Value| {
        let eps = numbers(&state["eps"]);
        let [w_lig, alpha] = ["w_lig", "alpha"].map(|key| state[key].as_f64().unwrap());
        let state = HingeDeformation::from([eps[0], eps[1], eps[2]]);
        (design(w_lig, alpha), state)
    };
    states.iter().map(hinge).unzip()
}

fn assert_close(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (found, expected) in found.iter().zip(expected) {
        let error = (found - expected).abs();
        let allowed = tolerance * expected.abs().max(1.0);
        assert!(error <= allowed, "{what}: {found} instead of {expected}");
    }
}

#[test]
fn energy_and_damage_agree_with_the_reference() {
    let (surrogate, states) = (tiny(), states());
    let (designs, deformations) = hinges(&states);
    let prepared = surrogate.prepare(&designs);
    let energies = surrogate.evaluate(&prepared, &deformations, Order::Design);
    let damages = surrogate.damage(&designs, &deformations, true);
    assert_eq!((states.len(), energies.len(), damages.len()), (50, 50, 50));
    for ((state, energy), damage) in states.iter().zip(&energies).zip(&damages) {
        let mixed = energy.mixed.map(|by| [by.w_lig, by.alpha]);
        let pairs: [(&str, &[f64]); 7] = [
            ("W", &[energy.w]),
            ("grad", &energy.forces),
            ("hessian", energy.tangent.as_flattened()),
            ("dW_dw_alpha", &energy.design.to_array()[..2]),
            ("d2W_deps_dw_alpha", mixed.as_flattened()),
            ("D", &[damage.d]),
            ("dD_deps", &damage.gradient.state),
        ];
        for (key, found) in pairs {
            assert_close(key, found, &numbers(&state[key]), 1e-10);
        }
    }
}

#[test]
fn each_order_contains_the_lower_ones_and_higher_derivatives_are_zero() {
    let surrogate = tiny();
    let (designs, deformations) = hinges(&states());
    let prepared = surrogate.prepare(&designs);
    let all = surrogate.evaluate(&prepared, &deformations, Order::Design);
    for order in [Order::Value, Order::Forces, Order::Tangent] {
        let energies = surrogate.evaluate(&prepared, &deformations, order);
        for (energy, all) in energies.iter().zip(&all) {
            assert_close("w", &[energy.w], &[all.w], 1e-13);
            if order >= Order::Forces {
                assert_close("forces", &energy.forces, &all.forces, 1e-13);
            } else {
                assert_eq!(energy.forces, [0.0; 3]);
            }
            if order >= Order::Tangent {
                let (tangent, all) = (energy.tangent.as_flattened(), all.tangent.as_flattened());
                assert_close("tangent", tangent, all, 1e-13);
            } else {
                assert_eq!(energy.tangent, [[0.0; 3]; 3]);
            }
            assert_eq!((energy.design, energy.mixed), Default::default());
        }
    }
}

#[test]
fn an_undeformed_hinge_has_no_energy_and_no_forces() {
    let surrogate = tiny();
    let (designs, _) = hinges(&states());
    let prepared = surrogate.prepare(&designs);
    let flat = vec![HingeDeformation::default(); designs.len()];
    for energy in surrogate.evaluate(&prepared, &flat, Order::Design) {
        assert!(energy.w >= 0.0 && energy.w < 1e-26, "{:e}", energy.w);
        for value in energy.forces.iter().chain(&energy.design.to_array()) {
            assert!(value.abs() < 1e-12, "{value:e}");
        }
        assert!((0..3).all(|i| energy.tangent[i][i] > 0.0));
    }
}

/// [`with_peak`] with the radius of the hole as a feature.
fn with_holes() -> Surrogate {
    let one_hole = with_peak();
    let mut card = one_hole.card().clone();
    let features = feature_names(true).iter();
    card.features = features.map(ToString::to_string).collect();
    card.domain.holes = Some([0.02, 0.4]);
    card.standardisation.mean.push(0.2);
    card.standardisation.std.push(0.1);
    let Layers { chi, chi_d, chi_p } = one_hole.layers();
    let widened = |mut layers: Vec<DenseLayer>| {
        let Tensor { shape, values } = &mut layers[0].weight;
        let rows = values.chunks(shape[1]).enumerate();
        let rows = rows.map(|(i, row)| [row, &[0.3 * (1.7 * i as f64).sin()]].concat());
        *values = rows.flatten().collect();
        shape[1] += 1;
        layers
    };
    let layers = Layers { chi: widened(chi), chi_d: widened(chi_d), chi_p: chi_p.map(widened) };
    Surrogate::from_parts(layers, card).unwrap()
}

/// Central differences of all hinges in one of (a, s, theta, w_lig, alpha, rho_f).
fn differences(
    hinges: (&[HingeDesign], &[HingeDeformation]),
    evaluate: impl Fn(&[HingeDesign], &[HingeDeformation]) -> Vec<f64>,
    direction: usize,
    step: f64,
) -> Vec<f64> {
    let moved = |step: f64| {
        let (mut designs, mut deformations) = (hinges.0.to_vec(), hinges.1.to_vec());
        for (design, deformation) in designs.iter_mut().zip(&mut deformations) {
            let unknowns = [
                &mut deformation.a,
                &mut deformation.s,
                &mut deformation.theta,
                &mut design.w_lig,
                &mut design.alpha,
                &mut design.fillet_ratio,
            ];
            *unknowns.into_iter().nth(direction).unwrap() += step;
        }
        evaluate(&designs, &deformations)
    };
    let pairs = std::iter::zip(moved(step), moved(-step));
    let slope = |(ahead, behind)| (ahead - behind) / (2.0 * step);
    pairs.map(slope).collect()
}

/// The derivatives of W and of the forces in one of (a, s, theta, w_lig, alpha, rho_f), from a
/// HingeEnergy.
fn derivative(energy: &HingeEnergy, direction: usize) -> [f64; 4] {
    let first = match direction {
        0..3 => energy.forces[direction],
        _ => energy.design.to_array()[direction - 3],
    };
    let second = |i: usize| match direction {
        0..3 => energy.tangent[i][direction],
        _ => energy.mixed[i].to_array()[direction - 3],
    };
    [first, second(0), second(1), second(2)]
}

#[test]
fn every_derivative_agrees_with_finite_differences() {
    derivatives_agree(&with_peak(), 0.16, 5);
    // In hinges with other holes than the hole of the features the tip moves with the hole.
    for fillet_ratio in [0.03, 0.16, 0.37] {
        derivatives_agree(&with_holes(), fillet_ratio, 6);
    }
}

/// A hole that is not among the holes of the training is not inside, wherever the hinge is.
#[test]
fn a_hole_of_another_radius_is_outside() {
    let flat = HingeDeformation::default();
    let at = |fillet_ratio: f64| HingeDesign { fillet_ratio, ..design(12.0, 1.5) };
    let (one, several) = (with_peak(), with_holes());
    assert!(one.contains(&at(0.16), &flat) && !one.contains(&at(0.2), &flat));
    assert!(several.contains(&at(0.2), &flat) && !several.contains(&at(0.5), &flat));
}

/// The derivatives in the first `directions` of (a, s, theta, w_lig, alpha, rho_f).
fn derivatives_agree(surrogate: &Surrogate, fillet_ratio: f64, directions: usize) {
    let (mut designs, deformations) = hinges(&states());
    for design in &mut designs {
        design.fillet_ratio = fillet_ratio;
    }
    let prepared = surrogate.prepare(&designs);
    let exact = surrogate.evaluate(&prepared, &deformations, Order::Design);
    let damages = surrogate.damage(&designs, &deformations, true);
    for direction in 0..directions {
        // rho_f varies by tenths, the others by one.
        let unit = if direction == 5 { 0.1 } else { 1.0 };
        let energies = differences(
            (&designs, &deformations),
            |designs, deformations| {
                let prepared = surrogate.prepare(designs);
                let energies = surrogate.evaluate(&prepared, deformations, Order::Forces);
                let each = |e: &HingeEnergy| [e.w, e.forces[0], e.forces[1], e.forces[2]];
                energies.iter().flat_map(each).collect()
            },
            direction,
            1e-5 * unit,
        );
        for (exact, difference) in exact.iter().zip(energies.as_chunks::<4>().0) {
            let what = format!("W in direction {direction}");
            assert_close(&what, difference, &derivative(exact, direction), 2e-7);
        }
        let values = differences(
            (&designs, &deformations),
            |designs, deformations| {
                let damages = surrogate.damage(designs, deformations, false).into_iter();
                damages.flat_map(|it| [it.d, it.d_peak.unwrap()]).collect()
            },
            direction,
            1e-4 * unit,
        );
        let peak_scale = surrogate.card().peak_scale.unwrap();
        let scales = [surrogate.damage_scale(), peak_scale];
        for (exact, difference) in damages.iter().zip(values.as_chunks::<2>().0) {
            let exact = [exact.gradient, exact.peak_gradient].map(|by| by.to_array()[direction]);
            for k in 0..2 {
                let (exact, found) = (exact[k] / scales[k], difference[k] / scales[k]);
                assert_close("damage", &[found], &[exact], 1e-7);
            }
        }
    }
}

/// A rounding error in one weight of every network ends the mirror symmetry of shipped weights, and
/// with it the shorter products.
#[test]
fn weights_with_mirror_symmetry_are_evaluated_like_others() {
    let file = "../data/pet-0.5mm/small.safetensors";
    let symmetric = Surrogate::load(&cases().join("../..").join(file)).unwrap();
    let mut layers = symmetric.layers();
    for layer in
        layers.chi.iter_mut().chain(&mut layers.chi_d).chain(layers.chi_p.iter_mut().flatten())
    {
        layer.weight.values[1] *= 1.0 + f64::EPSILON;
    }
    let other = Surrogate::from_parts(layers, symmetric.card().clone()).unwrap();
    let (designs, deformations) = hinges(&states());
    let [symmetric, other] = [symmetric, other].map(|surrogate| {
        let prepared = surrogate.prepare(&designs);
        let energies = surrogate.evaluate(&prepared, &deformations, Order::Design);
        let damages = surrogate.damage(&designs, &deformations, true);
        let of_energy = energies.into_iter().flat_map(|it| {
            let mixed = it.mixed.map(|by| by.to_array()).into_iter().flatten();
            let tangent = it.tangent.into_iter().flatten();
            [it.w]
                .into_iter()
                .chain(it.forces)
                .chain(tangent)
                .chain(it.design.to_array())
                .chain(mixed)
        });
        let of_damage = damages.into_iter().flat_map(|it| {
            let gradients = [it.gradient, it.peak_gradient].map(|by| by.to_array());
            [it.d, it.d_peak.unwrap()].into_iter().chain(gradients.into_iter().flatten())
        });
        of_energy.chain(of_damage).collect::<Vec<f64>>()
    });
    assert_close("energies and damages", &symmetric, &other, 1e-9);
}

#[test]
fn a_head_for_d_peak_does_not_change_d() {
    let (designs, deformations) = hinges(&states());
    let two = with_peak();
    let (mut layers, mut card) = (two.layers(), two.card().clone());
    (layers.chi_p, card.peak_scale) = (None, None);
    let one = Surrogate::from_parts(layers, card).unwrap();
    let [one, two] = [one, two].map(|it| it.damage(&designs, &deformations, true));
    for (one, two) in one.iter().zip(&two) {
        assert_close("D", &[two.d], &[one.d], 1e-14);
        assert_close("dD", &two.gradient.to_array(), &one.gradient.to_array(), 1e-14);
        assert_eq!((one.d_peak, one.peak_gradient), (None, HingeGradient::default()));
    }
}

#[test]
fn sharpness_is_equivalent_to_a_scaled_head_and_damage_scale() {
    let (designs, deformations) = hinges(&states());
    let sharp = with_peak();
    let beta = sharp.card().damage_sharpness;
    assert_eq!(beta, 8.0);
    let (mut layers, mut card) = (sharp.layers(), sharp.card().clone());
    card.damage_sharpness = 1.0;
    card.damage_scale /= beta;
    let last = layers.chi_d.last_mut().unwrap();
    for tensor in [&mut last.weight, &mut last.bias] {
        tensor.values.iter_mut().for_each(|value| *value *= beta);
    }
    let plain = Surrogate::from_parts(layers, card).unwrap();
    let [sharp, plain] = [sharp, plain].map(|it| it.damage(&designs, &deformations, true));
    for (sharp, plain) in sharp.iter().zip(&plain) {
        assert_close("D", &[sharp.d], &[plain.d], 1e-15);
        assert_close("dD", &sharp.gradient.to_array(), &plain.gradient.to_array(), 1e-14);
    }
}

#[test]
fn a_batch_gives_the_same_results_as_single_hinges() {
    let surrogate = tiny();
    let (designs, deformations) = hinges(&states());
    let repeat = |count: usize| {
        let designs: Vec<_> = designs.iter().cycle().take(count).copied().collect();
        let deformations: Vec<_> = deformations.iter().cycle().take(count).copied().collect();
        let prepared = surrogate.prepare(&designs);
        surrogate.evaluate(&prepared, &deformations, Order::Design)
    };
    let many = repeat(275);
    assert_eq!(many.len(), 275);
    assert!(repeat(0).is_empty());
    for (index, energy) in many.iter().enumerate() {
        let index = index % designs.len();
        let prepared = surrogate.prepare(&designs[index..=index]);
        let alone = surrogate.evaluate(&prepared, &deformations[index..=index], Order::Design);
        assert_close("w", &[energy.w], &[alone[0].w], 1e-12);
        let [many, alone] = [energy, &alone[0]].map(|it| it.mixed.map(DesignGradient::to_array));
        let (many, alone) = (many.as_flattened(), alone.as_flattened());
        assert_close("mixed", many, alone, 1e-12);
    }
}

/// Lengths times 0.2: W times 0.2^3, forces times 0.2^2, the moment times 0.2^3, damage unchanged.
#[test]
fn weights_of_another_thickness_follow_similarity() {
    const FACTOR: f64 = 0.2;
    let surrogate = with_peak();
    let thin = surrogate.clone().scaled(FACTOR);
    let (designs, deformations) = hinges(&states());
    let thin_designs: Vec<_> = designs.iter().map(|it| it.scaled(FACTOR)).collect();
    let thin_deformations: Vec<_> = deformations.iter().map(|it| it.scaled(FACTOR)).collect();
    let evaluate = |of: &Surrogate, designs: &[HingeDesign], states: &[HingeDeformation]| {
        let energies = of.evaluate(&of.prepare(designs), states, Order::Design);
        (energies, of.damage(designs, states, true))
    };
    let (energies, damages) = evaluate(&surrogate, &designs, &deformations);
    let (thin_energies, thin_damages) = evaluate(&thin, &thin_designs, &thin_deformations);
    let force = FACTOR.powi(2);
    for (thick, thin) in std::iter::zip(&energies, &thin_energies) {
        let [f_a, f_s, m] = thick.forces;
        assert_close("W", &[thin.w], &[FACTOR * force * thick.w], 1e-12);
        let expected = [force * f_a, force * f_s, FACTOR * force * m];
        assert_close("forces", &thin.forces, &expected, 1e-12);
        let [by_width, by_angle, _] = thick.design.to_array();
        let expected = [force * by_width, FACTOR * force * by_angle];
        assert_close("by design", &thin.design.to_array()[..2], &expected, 1e-12);
        let expected = FACTOR * thick.tangent[0][0];
        assert_close("tangent", &[thin.tangent[0][0]], &[expected], 1e-12);
    }
    for (thick, thin) in std::iter::zip(&damages, &thin_damages) {
        assert_close("D", &[thin.d], &[thick.d], 1e-12);
        let peaks = [thin, thick].map(|damage| damage.d_peak.unwrap());
        assert_close("D_peak", &peaks[..1], &peaks[1..], 1e-12);
    }
    let inside = |of: &Surrogate, design: &HingeDesign, state: &HingeDeformation| {
        of.domain().contains(design, state)
    };
    let thick = std::iter::zip(&designs, &deformations).map(|(g, x)| inside(&surrogate, g, x));
    let thin = std::iter::zip(&thin_designs, &thin_deformations).map(|(g, x)| inside(&thin, g, x));
    assert!(thick.eq(thin));
}
