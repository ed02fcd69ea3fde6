//! Named mesh tiers: mesh fineness of the window, with CPU time and errors.

use crate::ElementKind;
use hinge::{HingeDesign, Regime, SheetMaterial};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::time::Duration;
use strum::{IntoEnumIterator, VariantNames};
use support::{Fault, fault};

/// A named mesh fineness; for each regime in order of increasing CPU time.
///
/// | tier | bricks | CPU seconds | W | F_a | M_theta | D |
/// |---|---|---|---|---|---|---|
/// | `tiny` | 36 | 2.5 | 9.2 % | 35 % | 11.3 % | 26 % |
/// | `small` | 104 | 6.3 | 3.9 % | 21 % | 4.7 % | 16 % |
/// | `default` | 228 | 20 | 1.2 % | 8.2 % | 1.4 % | 5.4 % |
/// | `fine` | 400 | 39 | 1.0 % | 6.6 % | 1.1 % | 3.3 % |
/// | `reference` | 912 | 132 | - | - | - | - |
/// | `paper` | 1777 wedges | 171 | 2.4 % | 4.0 % | 3.9 % | 10.2 % |
///
/// CPU seconds are of one thread of a busy machine. The errors are the maximum, over hinges of 5,
/// 18 and 25 mm width with cut angles of 60 and 90 degrees in the paper's film, rotated to 60
/// degrees, of the root mean square error over the ray, relative to `reference`. The error of the
/// tier `default` over the whole box of the default campaign is in docs/CHOOSE.md. `small`, `fine`
/// and `reference` are `default` with elements of 3/2, 3/4 and 1/2 of its element size.
///
/// All tiers but `paper` are layers of bricks on one structured topology. A hinge in tension and
/// shear folds along two lines through O, one of them at 40 deg to the other; therefore the columns
/// are fine out to 0.8 w_lig on the free edge. A hinge in compression bends its panels; therefore
/// the rings around O are as fine as the columns. The number of rings determines the error of the
/// energy before yield.
///
/// The plate tiers are for the other [`Regime`]. A ligament that bends in the plane is strained
/// across its width: these meshes have few columns, and twice the rings between the hole and the
/// free edge.
///
/// | tier | bricks | CPU seconds |
/// |---|---|---|
/// | `plate-tiny` | 72 | 1.7 |
/// | `plate` | 160 | 3.5 |
/// | `plate-reference` | 768 | 30 |
///
/// These times are of polymers, means over the shipped databases. Their errors are in
/// docs/results/plates.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    JsonSchema,
    strum::Display,
    strum::EnumString,
    strum::EnumIter,
    strum::VariantNames,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
#[strum(parse_err_ty = Fault, parse_err_fn = unknown)]
pub enum Tier {
    /// 36 bricks in one layer; 2.5 CPU seconds a ray.
    Tiny,
    /// 104 bricks in two layers; 6.3 CPU seconds a ray.
    Small,
    /// 228 bricks in two layers; 20 CPU seconds a ray.
    #[default]
    Default,
    /// 400 bricks in two layers; 39 CPU seconds a ray.
    Fine,
    /// 912 bricks in two layers; 132 CPU seconds a ray. The errors of the other tiers are relative
    /// to it.
    Reference,
    /// 1777 wedges in one layer, as in the paper; 171 CPU seconds a ray.
    Paper,
    /// Plates: 72 bricks in two layers; 1.7 CPU seconds a ray.
    PlateTiny,
    /// Plates: 160 bricks in two layers; 3.5 CPU seconds a ray.
    Plate,
    /// Plates: 768 bricks in three layers; 30 CPU seconds a ray. The errors of the other plate
    /// tiers are relative to it.
    PlateReference,
}

/// All parameters of the mesh of a design, except the sheet thickness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeshRecipe {
    /// How the plane mesh is generated.
    pub plane: PlaneRecipe,
    /// Layers of elements through the thickness.
    pub layers: usize,
    /// The bump that initiates buckling.
    pub imperfection: Imperfection,
}

/// How the plane mesh is generated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlaneRecipe {
    /// Quadrilaterals in rings and columns, extruded to bricks.
    Structured(Structured),
    /// Free triangles as in the paper, extruded to wedges.
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
    /// Width of the elements at the fold line, over w_lig. It determines the accuracy.
    pub fold_size: f64,
}

/// Sizes of free triangles, which grow with the distance from O between two limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unstructured {
    /// Size at the hole, over w_lig.
    pub tip_size: f64,
    /// Size at the window's arcs, over r_win.
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

/// Regime, plane mesh, layers, CPU seconds of one ray, and resident memory of the solver (MB),
/// measured.
type Spec = (Regime, PlaneRecipe, usize, f64, f64);

/// The tiers, in the order of [`Tier`].
#[rustfmt::skip]
const TIERS: [Spec; 9] = [
    (Regime::Film, structured([2, 8, 2, 3], 0.15), 1, 2.5, 25.0),
    (Regime::Film, structured([2, 14, 2, 4], 0.105), 2, 6.3, 25.0),
    (Regime::Film, structured([3, 20, 3, 6], 0.07), 2, 20.0, 30.0),
    (Regime::Film, structured([4, 26, 4, 8], 0.0525), 2, 39.0, 45.0),
    (Regime::Film, structured([6, 40, 6, 12], 0.035), 2, 132.0, 95.0),
    (Regime::Film, WEDGES, 1, 171.0, 115.0),
    (Regime::Plate, structured([2, 8, 2, 3], 0.25), 2, 1.7, 25.0),
    (Regime::Plate, structured([4, 8, 3, 4], 0.25), 2, 3.5, 25.0),
    (Regime::Plate, structured([8, 16, 4, 8], 0.125), 3, 30.0, 85.0),
];

/// Time of a ray of a metal over the time of a polymer: 3.2 on `plate` and on `plate-reference`, in
/// the mean of the shipped databases.
const METAL: f64 = 3.2;

/// The mesh of the paper.
const WEDGES: PlaneRecipe =
    PlaneRecipe::Unstructured(Unstructured { tip_size: 0.1, rim_size: 0.2 });

/// A mesh by the numbers of [`Structured`], in their order.
const fn structured(
    [inner_rings, edge_columns, arc_columns, outer_rings]: [usize; 4],
    fold_size: f64,
) -> PlaneRecipe {
    PlaneRecipe::Structured(Structured {
        inner_rings,
        edge_columns,
        arc_columns,
        outer_rings,
        fold_size,
    })
}

impl Tier {
    /// All tiers; the tiers of a regime are in order of increasing CPU time.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::iter()
    }

    fn spec(self) -> Spec {
        TIERS[self as usize]
    }

    /// The cheaper tier on which a sheet is balanced before windows of this one are solved; `None`
    /// if that saves little.
    pub fn draft(self) -> Option<Self> {
        match self {
            Self::Reference => Some(Self::Default),
            Self::PlateReference => Some(Self::Plate),
            _ => None,
        }
    }

    /// The ligaments that this mesh is for.
    pub fn regime(self) -> Regime {
        self.spec().0
    }

    /// The mesh of this tier.
    pub fn recipe(self) -> MeshRecipe {
        let (regime, plane, layers, ..) = self.spec();
        MeshRecipe { plane, layers, imperfection: Imperfection::of(regime) }
    }

    /// The next finer tier of the regime with the same element, if there is one.
    pub fn finer(self) -> Option<Tier> {
        let kind = |tier: Tier| (tier.regime(), tier.recipe().element());
        Self::all().find(|tier| *tier > self && kind(*tier) == kind(self))
    }

    /// CPU seconds of one ray of a material: of a polymer, as in the table of [`Tier`].
    pub fn usual_cpu_seconds(self, material: &SheetMaterial) -> f64 {
        let (.., seconds, _) = self.spec();
        if material.is_metal() { METAL * seconds } else { seconds }
    }

    /// Resident memory of the solver (MB), measured.
    pub fn usual_memory_mb(self) -> f64 {
        let (.., memory_mb) = self.spec();
        memory_mb
    }

    /// Time limit of one solve: a hundred times the usual time of a polymer and at least twenty
    /// minutes, for metals and slow machines.
    pub fn time_limit(self) -> Duration {
        let (.., seconds, _) = self.spec();
        Duration::from_secs_f64((100.0 * seconds).max(1200.0))
    }
}

/// The error for a name that is no tier.
fn unknown(name: &str) -> Fault {
    let known = Tier::VARIANTS.join(", ");
    fault!("unknown mesh tier `{name}`; choose {known}")
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

impl Imperfection {
    /// Half-widths of the bump of a ligament as cut, equal to the ligament width.
    pub(crate) const WIDTHS: [f64; 2] = [1.0, 1.0];

    /// The bump of a ligament as cut, [`Regime::bump`]. Half-widths are equal to the ligament
    /// width.
    pub fn of(regime: Regime) -> Self {
        Self { amplitude: regime.bump(), widths: Self::WIDTHS }
    }

    /// Height (mm) of the bump at (x, y).
    pub(crate) fn height(&self, design: &HingeDesign, thickness: f64, x: f64, y: f64) -> f64 {
        let [x_ratio, y_ratio] = [x / self.widths[0], y / self.widths[1]].map(|v| v / design.w_lig);
        let decay = 1.0 - ((x * x + y * y) / design.r_win.powi(2)).powi(2);
        self.amplitude * thickness * (-x_ratio * x_ratio - y_ratio * y_ratio).exp() * decay
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip_and_the_finest_tiers_have_no_finer_one() {
        for tier in Tier::all() {
            assert_eq!(tier.to_string().parse(), Ok(tier));
            assert!(tier.finer().is_none_or(|finer| finer > tier));
        }
        assert_eq!(Tier::Reference.finer(), None);
        assert_eq!(Tier::Paper.finer(), None);
        assert_eq!(Tier::Plate.finer(), Some(Tier::PlateReference));
        assert_eq!(Tier::PlateReference.finer(), None);
        assert!("huge".parse::<Tier>().unwrap_err().to_string().contains("`huge`"));
    }
}
