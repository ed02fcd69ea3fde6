//! The mesh fidelity of the rows of a database.

use std::fmt;

/// The fidelity of a database, as written in its column `tier` and in its manifest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fidelity {
    /// Solved on the mesh with this name.
    Solved(String),
    /// Solved on one mesh and corrected to a finer one.
    Corrected {
        /// Name of the mesh on which the rows were solved.
        from: String,
        /// Name of the finer mesh.
        to: String,
    },
}

/// Separator of the two mesh names of a corrected tier.
const CORRECTED_TO: &str = " corrected to ";

impl Fidelity {
    /// Parses a tier as written in a database.
    pub fn from_tier(tier: &str) -> Self {
        match tier.rsplit_once(CORRECTED_TO) {
            Some((from, to)) => Self::Corrected { from: from.into(), to: to.into() },
            None => Self::Solved(tier.into()),
        }
    }

    /// The mesh whose results the rows represent.
    pub fn mesh(&self) -> &str {
        match self {
            Self::Solved(mesh) | Self::Corrected { to: mesh, .. } => mesh,
        }
    }
}

impl fmt::Display for Fidelity {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Solved(mesh) => f.write_str(mesh),
            Self::Corrected { from, to } => write!(f, "{from}{CORRECTED_TO}{to}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tier_is_written_and_read() {
        let corrected = Fidelity::Corrected { from: "default".into(), to: "reference".into() };
        assert_eq!(corrected.to_string(), "default corrected to reference");
        assert_eq!(Fidelity::from_tier(&corrected.to_string()), corrected);
        assert_eq!(corrected.mesh(), "reference");
        assert_eq!(Fidelity::from_tier("fine").mesh(), "fine");
    }
}
