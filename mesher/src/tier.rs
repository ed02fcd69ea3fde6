//! Named mesh tiers: how fine the window is meshed, and what that costs.

use serde::{Deserialize, Serialize};

/// A named compromise between speed and accuracy, cheapest first.
///
/// | tier | bricks | CPU seconds | error in W |
/// |---|---|---|---|
/// | `tiny` | 44 | 2.2 | 15 % |
/// | `small` | 120 | 9.5 | 4.5 % |
/// | `default` | 168 | 10 | 2.3 % |
/// | `fine` | 288 | 20 | 1.7 % |
/// | `reference` | 696 | 80 | - |
///
/// One thread, the paper's film and hinge (18 mm, 90 deg) rotated to 70 deg; the error is the root
/// mean square over the ray against `reference`. `small` costs as much as `default` on this ray, as
/// it takes more increments.
///
/// All are layers of 20-node bricks with reduced integration (C3D20R) on one structured topology.
/// The paper's own element, the 15-node wedge, would be a tier with an element kind in its
/// [`MeshRecipe`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tier {
    Tiny,
    Small,
    #[default]
    Default,
    Fine,
    Reference,
}

/// Numbers of elements of the structured window mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeshRecipe {
    /// Rings between the hole and the inner half-disc.
    pub inner_rings: usize,
    /// Columns along the free edge of the inner half-disc; even.
    pub edge_columns: usize,
    /// Columns along the inner half-disc's arc on each panel.
    pub arc_columns: usize,
    /// Rings between the inner half-disc and the window's arcs.
    pub outer_rings: usize,
    /// Width of the elements at the fold line, over w_lig: what the accuracy hangs on.
    pub fold_size: f64,
    /// Layers of bricks through the thickness.
    pub layers: usize,
}

impl Tier {
    /// Every tier, cheapest first.
    pub const ALL: [Tier; 5] = [
        Tier::Tiny,
        Tier::Small,
        Tier::Default,
        Tier::Fine,
        Tier::Reference,
    ];

    /// The mesh of this tier.
    pub fn recipe(self) -> MeshRecipe {
        let (inner_rings, edge_columns, arc_columns, outer_rings, fold_size, layers) = match self {
            Tier::Tiny => (3, 8, 2, 2, 0.15, 1),
            Tier::Small => (3, 10, 3, 2, 0.12, 2),
            Tier::Default => (3, 14, 3, 4, 0.10, 2),
            Tier::Fine => (4, 16, 5, 4, 0.10, 2),
            Tier::Reference => (8, 24, 6, 5, 0.06, 2),
        };
        MeshRecipe {
            inner_rings,
            edge_columns,
            arc_columns,
            outer_rings,
            fold_size,
            layers,
        }
    }

    /// The next finer tier, if there is one.
    pub fn finer(self) -> Option<Tier> {
        Self::ALL.into_iter().find(|tier| *tier > self)
    }

    /// CPU seconds to expect of one ray: the mean of 40 sampled rays for `tiny` and `default`, the
    /// ray of the table for the others.
    pub fn usual_cpu_seconds(self) -> f64 {
        match self {
            Tier::Tiny => 2.1,
            Tier::Small => 9.5,
            Tier::Default => 9.2,
            Tier::Fine => 20.0,
            Tier::Reference => 80.0,
        }
    }

    /// The name used in configurations and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Tier::Tiny => "tiny",
            Tier::Small => "small",
            Tier::Default => "default",
            Tier::Fine => "fine",
            Tier::Reference => "reference",
        }
    }
}

impl std::fmt::Display for Tier {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// A tier's name that is none; the message lists those there are.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("no mesh tier is called `{0}`; there are tiny, small, default, fine and reference")]
pub struct UnknownTier(String);

impl std::str::FromStr for Tier {
    type Err = UnknownTier;

    fn from_str(name: &str) -> Result<Self, UnknownTier> {
        Self::ALL
            .into_iter()
            .find(|tier| tier.name() == name)
            .ok_or_else(|| UnknownTier(name.to_owned()))
    }
}

impl MeshRecipe {
    /// Quadrilaterals of the plane mesh.
    pub fn quads(&self) -> usize {
        (2 * self.arc_columns + self.edge_columns) * self.inner_rings
            + 2 * self.arc_columns * self.outer_rings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiers_have_the_published_numbers_of_bricks() {
        let bricks = Tier::ALL.map(|tier| tier.recipe().quads() * tier.recipe().layers);
        assert_eq!(bricks, [44, 120, 168, 288, 696]);
    }

    #[test]
    fn names_are_read_back_and_the_ladder_ends() {
        for tier in Tier::ALL {
            assert_eq!(tier.name().parse(), Ok(tier));
            assert!(tier.finer().is_none_or(|finer| finer > tier));
        }
        assert_eq!(Tier::Reference.finer(), None);
        assert!(
            "huge"
                .parse::<Tier>()
                .unwrap_err()
                .to_string()
                .contains("`huge`")
        );
    }
}
