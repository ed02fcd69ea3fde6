//! The stored energy of a hinge as a function of its deformation and design (9), behind one trait.
//!
//! | law | energy | needs |
//! |---|---|---|
//! | [`LinearLaw`] | (11), three springs | constants |
//! | [`SurrogateLaw`] | (14), continued beyond the training domain | weights |
//! | [`MeanLaw`] | the mean of other laws | these |
//! | [`ReleasedLaw`] | elastic about the residual deformation of an unloaded hinge | rest deformations and stiffnesses |
//! | [`CorrectedLaw`] | another law, corrected to forces measured at some states of each hinge | those forces |
//!
//! A law is prepared once for the hinges of a sheet and then evaluated for all of them at once.

mod contact;
mod corrected;
mod law;
mod linear;
mod mean;
mod released;
mod surrogate;

pub use contact::Contact;
pub use corrected::{CorrectedLaw, Correction, LENGTHS, MissingForces};
pub use law::{
    DamageMeasure, DesignGradient, HingeDamage, HingeEnergy, HingeGradient, HingeLaw, Order,
    PreparedLaw,
};
pub use linear::LinearLaw;
pub use mean::MeanLaw;
pub use released::{Release, ReleasedLaw};
pub use surrogate::{PreparedSurrogate, SurrogateLaw};
