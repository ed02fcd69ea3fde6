//! Which quantities the rows of one database must have in common.

use crate::error::DatasetError;
use crate::rows::Row;

/// Whether the rows of a database may be of different materials or mesh tiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mixing {
    /// Rows of different materials or tiers are an error.
    Refused,
    /// Rows of different materials and tiers are accepted.
    Allowed,
}

impl Mixing {
    /// Rejects a row that differs from the first one in a quantity that is not a feature of the surrogate.
    pub(crate) fn check(self, first: &Row, row: &Row) -> Result<(), DatasetError> {
        let constants = |row: &Row| [row.design.kerf, row.design.r_win];
        if constants(first) == constants(row) && (self == Self::Allowed || same_origin(first, row))
        {
            return Ok(());
        }
        let pairs = self.shared(first).into_iter().zip(self.shared(row));
        for ((column, expected), (_, found)) in pairs {
            if expected != found {
                return Err(DatasetError::Mixed {
                    job: row.job.clone(),
                    column,
                    expected,
                    found,
                });
            }
        }
        Ok(())
    }

    /// The quantities that all rows have in common, as text.
    fn shared(self, row: &Row) -> Vec<(&'static str, String)> {
        let constants = [
            ("kerf", format!("{} mm", row.design.kerf)),
            ("r_win", format!("{} mm", row.design.r_win)),
        ];
        let mixable = [
            ("material", row.material.clone()),
            ("material_hash", row.material_hash.clone()),
            ("settings_hash", row.settings_hash.clone()),
            ("tier", row.tier.clone()),
        ];
        let mixable = mixable.into_iter().filter(|_| self == Self::Refused);
        mixable.chain(constants).collect()
    }
}

/// Whether two rows are of the same material, settings and tier.
fn same_origin(first: &Row, row: &Row) -> bool {
    first.material == row.material
        && first.material_hash == row.material_hash
        && first.settings_hash == row.settings_hash
        && first.tier == row.tier
}
