//! The condensed hinge energy (14): a learned potential of the hinge deformation.
//!
//! ```text
//! W(eps; g) = W_s |chi(xi(eps, g)) - chi(xi(0, g))|^2
//! D(eps; g) = D_s softplus(beta chi_D(xi(eps, g))) / beta,   and D_peak likewise with chi_P
//! xi(eps, g) = [a / w_lig, s / w_lig, theta, log w_lig, alpha]                  (13)
//! ```
//!
//! Weights that were trained on holes of several radii see their radius, too
//! ([`hinge::NetLigament`]). The squared distance makes W >= 0, W(0) = 0 and grad W(0) = 0 for any
//! weights. A surrogate is loaded from `X.safetensors` and its card `X.json`, and is evaluated in
//! float64 for batches of hinges.
//!
//! Evaluating a thousand hinges:
//!
//! ```
//! use hinge::{HingeConstants, HingeDeformation};
//! use std::path::Path;
//! use surrogate::{Order, Surrogate};
//!
//! # let weights = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases/chi_tiny.safetensors");
//! let surrogate = Surrogate::load(&weights)?;
//! // Ligaments of 18 mm at 70 deg, rotated by up to 30 deg.
//! let designs = vec![HingeConstants::PAPER.hinge(18.0, 70f64.to_radians()); 1000];
//! let states: Vec<HingeDeformation> = (0..1000)
//!     .map(|i| HingeDeformation { a: 0.0, s: 0.0, theta: f64::from(i) * 30f64.to_radians() / 1000.0 })
//!     .collect();
//! let prepared = surrogate.prepare(&designs);
//! let energies = surrogate.evaluate(&prepared, &states, Order::Tangent);
//! let [_, _, moment] = energies[999].forces; // N mm
//! assert_eq!(energies[0].w, 0.0);
//! assert!(moment.is_finite());
//! # Ok::<_, support::Fault>(())
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

mod card;
mod damage;
mod energy;
mod ensemble;
mod features;
mod mlp_kernels;
mod model;
mod network;
mod reference_ligament;
mod springback;
mod tanh;
mod weight_panels;
mod weights;

pub use card::{
    Card, DistillationRecord, FORMAT_VERSION, FitError, SpotCheck, Teacher, TestErrors, UNITS,
};
pub use damage::HingeDamage;
pub use energy::Prepared;
pub use ensemble::mean_and_variance;
pub use features::{FEATURE_NAMES, HingeEnergy, Order, Standardisation, feature_names, features};
pub use model::{Layers, Surrogate};
pub use network::{DenseLayer, Network, Tensor};
pub use springback::{Springback, SpringbackErrors};
pub use tanh::tanh_in_place;
