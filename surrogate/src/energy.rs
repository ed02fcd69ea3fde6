//! W of (14) and its derivatives in the hinge deformation and in (w_lig, alpha, rho_f).
//!
//! Let r = chi(xi) - chi(xi(0, g)), J = d chi / d xi and J0 = d chi(xi(0, g)) / d g. Then
//!
//! ```text
//! W                     = W_s |r|^2
//! dW/dxi                = 2 W_s J' r
//! d2W/dxi2              = 2 W_s (J'J + sum over layers and units of lambda sigma'' grad(a) grad(a)')
//! ```
//!
//! where lambda is the adjoint of a unit, seeded by r. chi(xi(0, g)) depends on the features of the
//! design: in their columns J is replaced by J - J0.

use crate::features::{DEFORMATION_FEATURES, FEATURES, HingeEnergy, Order, features, pull_back};
use crate::mlp_kernels::{Passes, chunk_size, filled};
use crate::network::Network;
use crate::reference_ligament;
use faer::Mat;
use hinge::{HingeDeformation, HingeDesign, HingeGradient, NetLigament};
use std::iter::{once, zip};

use rayon::prelude::*;
use std::cell::RefCell;
use std::ops::Range;

/// Number of quantities of the design.
const DESIGN: usize = FEATURES - DEFORMATION_FEATURES;

/// Hinge designs with chi(xi(0, g)) and its derivatives, which do not depend on the deformation.
#[derive(Clone, Debug)]
pub struct Prepared {
    designs: Vec<HingeDesign>,
    /// The maps to the hinges that the networks see.
    ligaments: Vec<NetLigament>,
    /// chi(xi(0, g)), one row for each of the [`filled`] hinges.
    origin: Mat<f64>,
    /// The derivatives of `origin` in the features of the design.
    origin_tangents: Vec<Mat<f64>>,
}

impl Prepared {
    /// `reference`: the hole of the hinges that the networks see, a multiple of w_lig.
    pub(crate) fn new(chi: &Network, designs: &[HingeDesign], reference: f64) -> Self {
        let ligaments: Vec<_> =
            designs.iter().map(|design| NetLigament::new(design, reference)).collect();
        let undeformed = filled(zip(&ligaments, designs).map(|(ligament, design)| {
            features(&ligament.design(design), &HingeDeformation::default())
        }));
        let of_design = DEFORMATION_FEATURES..FEATURES;
        let zeros = || Mat::zeros(undeformed.len(), chi.outputs());
        let mut origin = zeros();
        let mut origin_tangents: Vec<_> = of_design.clone().map(|_| zeros()).collect();
        Passes::lent(|passes| {
            let size = chunk_size(designs.len(), of_design.len());
            for (chunk, undeformed) in undeformed.chunks(size).enumerate() {
                let n = undeformed.len();
                passes.forward(chi, undeformed, of_design.clone());
                let rows = chunk * size..chunk * size + n;
                for (output, block) in passes.outputs().enumerate() {
                    for (target, values) in
                        once(&mut origin).chain(&mut origin_tangents).zip(block.chunks_exact(n))
                    {
                        target.col_as_slice_mut(output)[rows.clone()].copy_from_slice(values);
                    }
                }
            }
        });
        Self { designs: designs.to_vec(), ligaments, origin, origin_tangents }
    }

    /// The designs, in the order given.
    pub fn designs(&self) -> &[HingeDesign] {
        &self.designs
    }
}

/// See [`crate::Surrogate::evaluate`].
pub(crate) fn evaluate(
    chi: &Network,
    energy_scale: f64,
    prepared: &Prepared,
    deformations: &[HingeDeformation],
    order: Order,
) -> Vec<HingeEnergy> {
    assert_eq!(
        prepared.designs.len(),
        deformations.len(),
        "one deformation for each prepared hinge"
    );
    let size = chunk_size(deformations.len(), order.tangents());
    let of_chunk = |(chunk, deformations): (usize, &[HingeDeformation])| -> Vec<HingeEnergy> {
        let first = chunk * size;
        let chunk = first..first + deformations.len();
        let ligaments = &prepared.ligaments[chunk.clone()];
        let hinges = zip(&prepared.designs[chunk], deformations).zip(ligaments);
        let seen = filled(hinges.map(|((design, deformation), ligament)| {
            reference_ligament::seen(ligament, design, deformation)
        }));
        KERNEL.with_borrow_mut(|kernel| {
            kernel.run(chi, prepared, first, &seen, order);
            let hinges = zip(ligaments, &seen).enumerate();
            hinges
                .map(|(hinge, (ligament, (design, deformation)))| {
                    let energy = kernel.energy(hinge, design, deformation, energy_scale, order);
                    reference_ligament::energy(ligament, energy, deformation.theta, order)
                })
                .collect()
        })
    };
    // A single chunk takes less time than waking another thread.
    if (1..=size).contains(&deformations.len()) {
        return of_chunk((0, deformations));
    }
    let chunks = deformations.par_chunks(size).enumerate();
    chunks.map(of_chunk).collect::<Vec<_>>().concat()
}

thread_local! {
    /// Reused like the buffers of [`Passes::lent`].
    static KERNEL: RefCell<Kernel> = RefCell::default();
}

/// |r|^2 and its derivatives in the features, for a chunk of hinges.
#[derive(Default)]
struct Kernel {
    passes: Passes,
    n: usize,
    /// Number of features with second derivatives.
    tangents: usize,
    /// chi(xi) - chi(xi(0, g)), one column per output.
    r: Vec<f64>,
    /// |r|^2
    square: Vec<f64>,
    /// Half of the Hessian of |r|^2: a run for each deformation feature and each feature.
    half_hessian: Vec<f64>,
    /// (J - J0)' r, one run per design feature.
    by_design: Vec<f64>,
}

impl Kernel {
    fn run(
        &mut self,
        chi: &Network,
        prepared: &Prepared,
        first: usize,
        seen: &[(HingeDesign, HingeDeformation)],
        order: Order,
    ) {
        let n = seen.len();
        let rows = first..first + n;
        self.n = n;
        self.tangents = order.tangents();
        let xi: Vec<_> =
            seen.iter().map(|(design, deformation)| features(design, deformation)).collect();
        self.passes.forward(chi, &xi, 0..self.tangents);

        self.r.clear();
        reset(&mut self.square, n);
        for (output, block) in self.passes.outputs().enumerate() {
            let origin = &prepared.origin.col_as_slice(output)[rows.clone()];
            self.r.extend(zip(block, origin).map(|(value, origin)| value - origin));
        }
        for r in self.r.chunks_exact(n) {
            add_product(&mut self.square, r, r);
        }
        if order < Order::Forces {
            return;
        }
        reset(&mut self.half_hessian, n * DEFORMATION_FEATURES * self.tangents);
        self.passes.reverse(chi, &self.r, &mut self.half_hessian);
        if order == Order::Design {
            self.move_origin(prepared, rows);
        }
        self.passes.add_gauss_newton(&mut self.half_hessian);
    }

    /// Subtracts J0, the derivative of chi(xi(0, g)) in the features of the design, from J.
    fn move_origin(&mut self, prepared: &Prepared, rows: Range<usize>) {
        let n = self.n;
        reset(&mut self.by_design, DESIGN * n);
        for (output, (block, r)) in
            zip(self.passes.outputs_mut(), self.r.chunks_exact(n)).enumerate()
        {
            let tangents = block[n * (1 + DEFORMATION_FEATURES)..].chunks_exact_mut(n);
            let sums = self.by_design.chunks_exact_mut(n);
            for ((tangent, sum), origin) in zip(zip(tangents, sums), &prepared.origin_tangents) {
                for (value, origin) in
                    zip(&mut *tangent, &origin.col_as_slice(output)[rows.clone()])
                {
                    *value -= origin;
                }
                add_product(sum, r, tangent);
            }
        }
    }

    /// W_s |r|^2 of one hinge with its derivatives in deformation and design.
    fn energy(
        &self,
        hinge: usize,
        design: &HingeDesign,
        deformation: &HingeDeformation,
        energy_scale: f64,
        order: Order,
    ) -> HingeEnergy {
        let mut energy =
            HingeEnergy { w: energy_scale * self.square[hinge], ..HingeEnergy::default() };
        if order < Order::Forces {
            return energy;
        }
        let twice = 2.0 * energy_scale;
        let mut gradient = self.passes.gradient(hinge).map(|value| twice * value);
        if order == Order::Design {
            for p in 0..DESIGN {
                gradient[DEFORMATION_FEATURES + p] = twice * self.by_design[self.n * p + hinge];
            }
        }
        let gradient = pull_back(gradient, design, deformation);
        energy.forces = gradient.state;
        if order < Order::Tangent {
            return energy;
        }
        // Row i of the Hessian in the features is the gradient of dW/dxi_i.
        for (i, scale) in [design.w_lig, design.w_lig, 1.0].into_iter().enumerate() {
            let row: [f64; FEATURES] = std::array::from_fn(|j| twice * self.second(hinge, i, j));
            let row = pull_back(row, design, deformation).to_array();
            let row = HingeGradient::from(row.map(|value| value / scale));
            energy.tangent[i] = row.state;
            if order == Order::Design {
                energy.mixed[i] = row.design;
            }
        }
        if order == Order::Design {
            energy.design = gradient.design;
            // The factor 1 / w_lig of dW/da and dW/ds depends on w_lig itself.
            let [f_a, f_s, _] = energy.forces;
            energy.mixed[0].w_lig -= f_a / design.w_lig;
            energy.mixed[1].w_lig -= f_s / design.w_lig;
        }
        energy
    }

    /// Half of the second derivative of |r|^2 in the features i (of the deformation) and j.
    fn second(&self, hinge: usize, i: usize, j: usize) -> f64 {
        if j >= self.tangents {
            return 0.0;
        }
        self.half_hessian[self.n * (i.min(j) * self.tangents + i.max(j)) + hinge]
    }
}

fn reset(buffer: &mut Vec<f64>, len: usize) {
    buffer.clear();
    buffer.resize(len, 0.0);
}

/// sum += left * right, element by element.
fn add_product(sum: &mut [f64], left: &[f64], right: &[f64]) {
    for ((sum, left), right) in zip(zip(sum, left), right) {
        *sum += left * right;
    }
}
