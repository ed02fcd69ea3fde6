//! Named mesh tiers: how fine the window is meshed, and what that costs.

use crate::element::ElementKind;
use hinge::HingeDesign;
use serde::{Deserialize, Serialize};

/// A named compromise between speed and accuracy, cheapest first.
///
/// | tier | bricks | CPU seconds | W | F_a | M_theta | D |
/// |---|---|---|---|---|---|---|
/// | `tiny` | 36 | 2.5 | 9.2 % | 35 % | 11.3 % | 26 % |
/// | `small` | 104 | 6.3 | 3.9 % | 21 % | 4.7 % | 16 % |
/// | `default` | 228 | 17 | 1.2 % | 8.2 % | 1.4 % | 5.4 % |
/// | `fine` | 400 | 39 | 1.0 % | 6.6 % | 1.1 % | 3.3 % |
/// | `reference` | 912 | 126 | - | - | - | - |
/// | `paper` | 1777 wedges | 171 | 2.4 % | 4.0 % | 3.9 % | 10.2 % |
///
/// The paper's film, hinges of 5, 18 and 25 mm and of 60 and 90 degrees rotated to 60 degrees, one
/// thread of a busy machine; the greatest root mean square error over the ray, against `reference`
/// (`kirigami study window`, docs/results/window). Over the whole box of the default campaign the
/// tier `default` is judged in docs/results/tiers. `small`, `fine` and `reference` are `default`
/// with elements of 3/2, 3/4 and 1/2 of its size.
///
/// All but `paper` are layers of bricks on one structured topology. A hinge in tension and shear
/// folds along two lines through O, one of them at 40 deg to the other: columns are fine out to
/// 0.8 w_lig on the free edge. A hinge in compression bends its panels: rings are as fine around O
/// as the columns, and their number decides the energy before it yields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tier {
    Tiny,
    Small,
    #[default]
    Default,
    Fine,
    Reference,
    Paper,
}

/// All that decides the mesh of a design, but its thickness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeshRecipe {
    pub plane: PlaneRecipe,
    /// Layers of elements through the thickness.
    pub layers: usize,
    pub imperfection: Imperfection,
}

/// How the plane mesh is made.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlaneRecipe {
    Structured(Structured),
    Unstructured(Unstructured),
}

/// Numbers of elements of a structured mesh of quadrilaterals.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Structured {
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
}

/// Sizes of free triangles, in proportion to their distance from O between two limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unstructured {
    /// At the hole, over w_lig.
    pub tip_size: f64,
    /// At the window's arcs, over r_win.
    pub rim_size: f64,
}

/// The stress-free bump without which the sheet would not buckle:
/// z = amplitude t exp(-(x / (w_x w_lig))^2 - (y / (w_y w_lig))^2) (1 - (r / r_win)^4).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Imperfection {
    /// Height over the thickness; the paper measured one thickness on a cut hinge (section 4.1).
    pub amplitude: f64,
    /// (w_x, w_y), half-widths along and across the secondary cut over w_lig.
    pub widths: [f64; 2],
}

impl Tier {
    /// Every tier, cheapest first.
    pub const ALL: [Tier; 6] = [
        Tier::Tiny,
        Tier::Small,
        Tier::Default,
        Tier::Fine,
        Tier::Reference,
        Tier::Paper,
    ];

    /// The mesh of this tier.
    pub fn recipe(self) -> MeshRecipe {
        let structured = |inner_rings, edge_columns, arc_columns, outer_rings, fold_size| {
            PlaneRecipe::Structured(Structured {
                inner_rings,
                edge_columns,
                arc_columns,
                outer_rings,
                fold_size,
            })
        };
        let (plane, layers) = match self {
            Tier::Tiny => (structured(2, 8, 2, 3, 0.15), 1),
            Tier::Small => (structured(2, 14, 2, 4, 0.105), 2),
            Tier::Default => (structured(3, 20, 3, 6, 0.07), 2),
            Tier::Fine => (structured(4, 26, 4, 8, 0.0525), 2),
            Tier::Reference => (structured(6, 40, 6, 12, 0.035), 2),
            Tier::Paper => (
                PlaneRecipe::Unstructured(Unstructured {
                    tip_size: 0.1,
                    rim_size: 0.2,
                }),
                1,
            ),
        };
        MeshRecipe {
            plane,
            layers,
            imperfection: Imperfection::default(),
        }
    }

    /// The next finer tier of the same element, if there is one.
    pub fn finer(self) -> Option<Tier> {
        let same = |tier: &Tier| tier.recipe().element() == self.recipe().element();
        Self::ALL.into_iter().filter(same).find(|tier| *tier > self)
    }

    /// CPU seconds to expect of one ray.
    pub fn usual_cpu_seconds(self) -> f64 {
        match self {
            Tier::Tiny => 2.5,
            Tier::Small => 6.0,
            Tier::Default => 15.0,
            Tier::Fine => 35.0,
            Tier::Reference => 105.0,
            Tier::Paper => 170.0,
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
            Tier::Paper => "paper",
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
#[error("no mesh tier is called `{0}`; there are tiny, small, default, fine, reference and paper")]
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
    /// The element that the plane mesh is extruded to.
    pub fn element(&self) -> ElementKind {
        match self.plane {
            PlaneRecipe::Structured(_) => ElementKind::Brick,
            PlaneRecipe::Unstructured(_) => ElementKind::Wedge,
        }
    }
}

impl Structured {
    /// Quadrilaterals of the plane mesh.
    pub fn quads(&self) -> usize {
        (2 * self.arc_columns + self.edge_columns) * self.inner_rings
            + 2 * self.arc_columns * self.outer_rings
    }
}

impl Default for Imperfection {
    /// As the paper measured it, and as wide as the ligament.
    fn default() -> Self {
        Self {
            amplitude: 1.0,
            widths: [1.0, 1.0],
        }
    }
}

impl Imperfection {
    /// Height (mm) of the bump at (x, y).
    pub(crate) fn height(&self, design: &HingeDesign, thickness: f64, x: f64, y: f64) -> f64 {
        let [x_share, y_share] = [x / self.widths[0], y / self.widths[1]].map(|v| v / design.w_lig);
        let decay = 1.0 - ((x * x + y * y) / design.r_win.powi(2)).powi(2);
        self.amplitude * thickness * (-x_share * x_share - y_share * y_share).exp() * decay
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structured_tiers_have_the_numbers_of_bricks_that_are_told() {
        let bricks = Tier::ALL.map(|tier| match tier.recipe().plane {
            PlaneRecipe::Structured(plane) => plane.quads() * tier.recipe().layers,
            PlaneRecipe::Unstructured(_) => 0,
        });
        assert_eq!(bricks, [36, 104, 228, 400, 912, 0]);
    }

    #[test]
    fn names_are_read_back_and_the_ladder_ends() {
        for tier in Tier::ALL {
            assert_eq!(tier.name().parse(), Ok(tier));
            assert!(tier.finer().is_none_or(|finer| finer > tier));
        }
        assert_eq!(Tier::Reference.finer(), None);
        assert_eq!(Tier::Paper.finer(), None);
        assert!(
            "huge"
                .parse::<Tier>()
                .unwrap_err()
                .to_string()
                .contains("`huge`")
        );
    }
}
