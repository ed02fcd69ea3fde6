//! The hinges of one sheet by finite elements, to which the level `final` corrects the learned
//! energy.

use crate::keys::{SceneConfig, resolved};
use design::{
    hinge_law::{CorrectedLaw, Correction, HingeLaw, MissingForces, Order},
    sheet::topology::Topology,
};
use hinge::{HingeDeformation, HingeDesign};
use serde::{Deserialize, Serialize};
use std::{path::Path, sync::Arc};
use support::{Fault, FileError, at, ensure, regular_file, said, sealed_json};

/// A hinge at the end of its path by finite elements.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolvedHinge {
    /// The hinge.
    pub design: HingeDesign,
    /// Its state.
    pub state: HingeDeformation,
    /// (F_a, F_s, M_theta) there (N, N, N mm).
    pub forces: [f64; 3],
}

/// The hinges of a sheet, in their order; `None` where finite elements found no solution.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolvedHinges {
    /// One entry a hinge.
    pub hinges: Vec<Option<SolvedHinge>>,
}

/// The error of a scene at the level `final` that names no solved hinges.
pub(super) fn no_file() -> Fault {
    said(
        "the level `final` needs surrogate.solved_hinges: `kirigami design SCENE --level final` solves the hinges by finite elements; the \
         finest level without them is `fine`, or `standard`",
    )
}

impl SolvedHinges {
    /// The solved hinges that the scene at `path` names.
    pub(super) fn load(
        config: &SceneConfig,
        topology: &Topology,
        path: &Path,
    ) -> Result<Self, Fault> {
        let named = (config.surrogate.as_ref()).and_then(|files| files.solved_hinges.as_ref());
        let file = resolved(path, named.ok_or_else(no_file)?);
        let place = format!("surrogate.solved_hinges: {}", file.display());
        let text = regular_file::read(&file).map_err(at(&place))?;
        let solved = sealed_json::from_slice::<Self>(&text)
            .map_err(|error| format!("{place} is not a file of solved hinges: {error}"))?;
        let (found, expected) = (solved.hinges.len(), topology.hinge_count());
        ensure!(
            found == expected,
            "{place} has {found} hinges and the sheet {expected}: it is of another sheet"
        );
        Ok(solved)
    }

    /// Writes them to a file.
    pub fn write(&self, file: &Path) -> Result<(), FileError> {
        sealed_json::write(file, self)
    }

    /// Identifies them.
    pub(super) fn hash(&self) -> String {
        let text = serde_json::to_vec(&self.hinges).expect("numbers have a text");
        blake3::hash(&text).to_hex().to_string()
    }

    /// A law corrected to them: at its state every hinge has the forces of finite elements.
    pub fn corrected(&self, law: Arc<dyn HingeLaw>) -> CorrectedLaw {
        let correction = |solved: &Option<SolvedHinge>| {
            let Some(solved) = solved else {
                return Correction::default();
            };
            let own = law.prepare(&[solved.design]);
            let own = own.energies(&[solved.state], Order::Forces)[0].forces;
            let missing = MissingForces {
                state: solved.state,
                forces: std::array::from_fn(|i| solved.forces[i] - own[i]),
            };
            Correction::new(&solved.design, &[missing])
        };
        let corrections = self.hinges.iter().map(correction).collect();
        CorrectedLaw { law, corrections }
    }
}
