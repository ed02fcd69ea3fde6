//! The hinges of one sheet by finite elements, to which the level `final` corrects the learned
//! energy.

use crate::keys::{SceneConfig, resolved};
use design::hinge_law::{CorrectedLaw, Correction, HingeLaw, MissingForces, Order};
use design::sheet::topology::Topology;
use hinge::{HingeDeformation, HingeDesign};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use support::sealed_json::{self, SealError};
use support::{FileError, regular_file, whole_file};

/// A hinge at the end of its path by finite elements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolvedHinges {
    /// One entry a hinge.
    pub hinges: Vec<Option<SolvedHinge>>,
}

/// Why the level `final` has no solved hinges.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum SolvedHingesError {
    #[error(
        "the level `final` needs surrogate.solved_hinges: `kirigami design SCENE --level final` solves the hinges by finite elements; the \
         finest level without them is `fine`, or `standard`"
    )]
    NoFile,
    #[error("surrogate.solved_hinges: {0}")]
    Read(#[from] FileError),
    #[error("surrogate.solved_hinges: {} is not a file of solved hinges: {source}", file.display())]
    Other { file: PathBuf, source: SealError },
    #[error(
        "surrogate.solved_hinges: {} has {found} hinges and the sheet {expected}: it is of another sheet", file.display()
    )]
    OtherSheet { file: PathBuf, found: usize, expected: usize },
}

impl SolvedHinges {
    /// The solved hinges that the scene at `path` names.
    pub(super) fn load(
        config: &SceneConfig,
        topology: &Topology,
        path: &Path,
    ) -> Result<Self, SolvedHingesError> {
        let named = (config.surrogate.as_ref()).and_then(|files| files.solved_hinges.as_ref());
        let file = resolved(path, named.ok_or(SolvedHingesError::NoFile)?);
        let text = regular_file::read(&file).map_err(FileError::at(&file))?;
        let solved: Self = match sealed_json::from_slice(&text) {
            Ok(solved) => solved,
            Err(source) => return Err(SolvedHingesError::Other { file, source }),
        };
        let (found, expected) = (solved.hinges.len(), topology.hinge_count());
        if found != expected {
            return Err(SolvedHingesError::OtherSheet { file, found, expected });
        }
        Ok(solved)
    }

    /// Writes them to a file.
    pub fn write(&self, file: &Path) -> Result<(), FileError> {
        let text = sealed_json::to_vec(self).map_err(FileError::at(file))?;
        whole_file::write(file, &text).map_err(FileError::at(file))
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
