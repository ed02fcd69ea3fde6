//! The vocabulary shared by all crates of the workspace.
//!
//! | term | type | paper |
//! |---|---|---|
//! | hinge design g | [`HingeDesign`] | (7) |
//! | hinge deformation (a, s, theta) | [`HingeDeformation`] | (8) |
//! | generalised forces (F_a, F_s, M_theta) | [`HingeSample::forces`] | section 2.3 |
//! | derivatives in both | [`HingeGradient`] | (20) |
//! | sheet material | [`SheetMaterial`] | section 4.1 |
//! | films and plates | [`Regime`] | section 5.1 |
//! | training domain | [`TrainingDomain`] | section 2.4 |
//! | a hinge that was unloaded | [`ReleasedHinge`] | - |
//! | one converged increment of a window solve | [`HingeSample`] | section 2.4 |
//!
//! Units: mm, N, MPa, N mm, rad. Angles in degrees have names that end in `_deg`.
//!
//! **Hinge frame.** x runs along the secondary cut. y is its counter-clockwise normal and points
//! away from the material, which lies at y <= 0. The main cut runs from its tip O at the angle
//! alpha, measured from +x into the material. Panel A lies on the -x side of the main cut, panel B
//! on the +x side. theta > 0 opens the main cut.
//!
//! **Reference point.** O is the tip of the main cut, at the perpendicular distance w_lig from the
//! secondary cut. The origin of the frame is the foot of that perpendicular. Both the window and
//! the sheet measure (a, s, theta) at O, in the mean frame of the two panels.
//!
//! ```
//! use hinge::{HingeConstants, HingeDeformation};
//!
//! // A ligament of 18 mm at 70 deg, opened by 30 deg, pulled by 0.9 mm and sheared by -1.8 mm.
//! let hinge = HingeConstants::PAPER.hinge(18.0, 70f64.to_radians());
//! hinge.validate()?;
//! let state = HingeDeformation { a: 0.9, s: -1.8, theta: 30f64.to_radians() };
//! assert_eq!(state.eta(hinge.w_lig), [0.05, -0.1]);
//! # Ok::<_, hinge::InvalidDesign>(())
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

mod deformation;
mod design;
mod domain;
mod gradient;
mod jet;
mod material;
mod net_ligament;
mod regime;
mod released;
mod sample;

pub use deformation::HingeDeformation;
pub use design::{HingeConstants, HingeDesign, InvalidDesign, MIN_W_LIG};
pub use domain::{Section, TrainingDomain};
pub use gradient::{DesignGradient, HingeGradient};
pub use jet::Jet;
pub use material::{Creep, STANDARD_GRAVITY, SheetMaterial};
pub use net_ligament::{NetLigament, NetLigamentJet};
pub use regime::Regime;
pub use released::ReleasedHinge;
pub use sample::HingeSample;
