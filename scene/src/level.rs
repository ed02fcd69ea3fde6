//! The level of a scene: how much of its hinges is modelled. This file is the one place that says
//! what a level is.
//!
//! | level | hinges | load steps | residual of an equilibrium |
//! |---|---|---|---|
//! | `pin` | pins that open by one angle: no forces | - | - |
//! | `linear` | three springs (11) | the steps of the scene | 1e-10 |
//! | `draft` | the learned energy (14) of a small network | at most 5 | 1e-3 |
//! | `standard` | the learned energy (14) | the steps of the scene | 1e-10 |
//! | `fine` | the mean of the networks of the ensemble | the steps of the scene | 1e-10 |
//! | `final` | the learned energy, corrected to finite elements of every hinge | the steps of the scene | 1e-10 |

use design::equilibrium::settings::SolverSettings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How much of the hinges of a scene is modelled, from the cheapest level to the most expensive;
/// each hinge law reads the section that it needs.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    JsonSchema,
    strum::Display,
    strum::EnumString,
    strum::IntoStaticStr,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Level {
    /// Pins that all open by the same angle, without equilibrium: section 3.1.
    Pin,
    /// Three uncoupled springs, (11).
    Linear,
    /// The learned energy (14) of the network `surrogate.draft`, on few load steps.
    Draft,
    /// The learned energy (14) of `surrogate.weights`.
    Standard,
    /// The mean of the energies of `surrogate.weights` and `surrogate.ensemble`.
    Fine,
    /// The energy of `standard`, corrected to the finite elements of `surrogate.solved_hinges`.
    Final,
}

/// Load steps and residual of a draft: the shape differs by less than 1e-6 of a panel
/// (docs/TRIED.md).
const DRAFT_STEPS: usize = 5;
const DRAFT_TOLERANCE: f64 = 1e-3;

impl Level {
    /// All levels, from the cheapest to the most expensive.
    pub const ALL: [Self; 6] =
        [Self::Pin, Self::Linear, Self::Draft, Self::Standard, Self::Fine, Self::Final];

    /// Its name in a scene.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// The level with a name.
    pub fn named(name: &str) -> Option<Self> {
        name.parse().ok()
    }

    /// What its hinges are, for reports.
    pub fn hinges(self) -> &'static str {
        match self {
            Self::Pin => "pins: kinematics without forces",
            Self::Linear => "linear springs (11)",
            Self::Draft => "learned energy (14) of a small network, on few load steps",
            Self::Standard => "learned energy (14)",
            Self::Fine => "mean learned energy (14) of an ensemble",
            Self::Final => "learned energy (14), corrected to finite elements of every hinge",
        }
    }

    /// Whether its hinge law is learned.
    pub fn is_learned(self) -> bool {
        self >= Self::Draft
    }

    /// Its load steps in a scene that has `steps`.
    pub(super) fn load_steps(self, steps: usize) -> usize {
        match self {
            Self::Draft => steps.min(DRAFT_STEPS),
            _ => steps,
        }
    }

    /// Its solver in a scene that has `settings`.
    pub(super) fn solver(self, settings: SolverSettings) -> SolverSettings {
        match self {
            Self::Draft => {
                SolverSettings { tolerance: settings.tolerance.max(DRAFT_TOLERANCE), ..settings }
            }
            _ => settings,
        }
    }
}
