//! The design objective (16): the Chamfer distance of the deployed outline to the target, and
//! functionals of the deformation path of the hinges; and what the outline does not mind: how well-shaped
//! the panels are, and whether their hinges stay where their law was learned.

use crate::chamfer::Chamfer;
use crate::domain_penalty::DomainPenalty;
use crate::equilibrium::LoadStep;
use crate::hinge_law::DamageMeasure;
use crate::panel_shape::panel_shape;
use crate::path_functionals::{HingePath, PathFunctionals, PerFunctional};
use crate::sheet::Sheet;
use crate::topology::PanelCorner;
use serde::{Deserialize, Serialize};

/// Which panel corners on the outline make the point set P of (16).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OutlinePoints {
    /// Those that belong to no hinge.
    #[default]
    Free,
    All,
}

impl OutlinePoints {
    /// P, counter-clockwise from the south-west.
    pub fn of(self, sheet: &Sheet) -> Vec<PanelCorner> {
        match self {
            Self::Free => sheet.free_outline_corners(),
            Self::All => sheet.outline_corners(),
        }
    }
}

/// What a design is judged by.
#[derive(Clone, Debug, PartialEq)]
pub struct Objective {
    /// T (mm); not empty.
    pub target: Vec<[f64; 2]>,
    pub chamfer: Chamfer,
    pub outline: OutlinePoints,
    /// Whether P is moved so that its mean is the origin; the target should be centred then.
    pub centred: bool,
    /// w_j of the functionals of the path.
    pub weights: PerFunctional,
    /// Which damage the functional of damage is of.
    pub damage_measure: DamageMeasure,
    /// Temperatures of the path extrema.
    pub temperatures: PerFunctional,
    /// Weight of the panels' shape (mm^2).
    pub panel_shape: f64,
    /// Corners of a panel that are closer count as badly shaped (mm).
    pub least_distance: f64,
    /// `None` where the hinge law was not learned, or may be used anywhere.
    pub domain: Option<DomainPenalty>,
}

/// The unweighted terms of the objective.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// mm^2
    pub chamfer: f64,
    pub path: PerFunctional,
    pub panel_shape: f64,
    pub domain: f64,
}

/// The objective and its partial derivatives at a deployment.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// L of (16).
    pub loss: f64,
    pub terms: Terms,
    /// Gradient in the deployed positions of P.
    pub by_outline: Vec<[f64; 2]>,
    /// Gradient in (a, s, theta, w_lig, alpha) per hinge and load step.
    pub by_path: Vec<Vec<[f64; 5]>>,
    /// Gradient in the flat corners of every panel.
    pub by_corners: Vec<[[f64; 2]; 4]>,
}

impl Objective {
    /// Judges a path whose last configuration puts the points P at `outline` (mm); `damage_scale` is
    /// D_s of (17).
    pub fn judge(
        &self,
        outline: &[[f64; 2]],
        sheet: &Sheet,
        path: &[LoadStep],
        damage_scale: f64,
    ) -> Judgement {
        let (chamfer, by_outline) = self.shape(outline);
        let functionals = PathFunctionals {
            weights: self.weights,
            temperatures: self.temperatures,
            measure: self.damage_measure,
            damage_scale,
        };
        let (values, mut by_path) = functionals.evaluate(&hinge_paths(sheet, path));
        let (outside, weight) = match &self.domain {
            Some(penalty) => (penalty.evaluate(sheet, path, &mut by_path), penalty.weight),
            None => (0.0, 0.0),
        };
        // Panels that are not weighed may have any shape.
        let (shape, mut by_corners) = match self.panel_shape {
            0.0 => (0.0, vec![[[0.0; 2]; 4]; sheet.panels.len()]),
            _ => panel_shape(&sheet.panels, self.least_distance),
        };
        let entries = by_corners.as_flattened_mut().as_flattened_mut();
        entries
            .iter_mut()
            .for_each(|entry| *entry *= self.panel_shape);
        Judgement {
            loss: chamfer
                + functionals.weighted(&values)
                + self.panel_shape * shape
                + weight * outside,
            terms: Terms {
                chamfer,
                path: values,
                panel_shape: shape,
                domain: outside,
            },
            by_outline,
            by_path,
            by_corners,
        }
    }

    /// The Chamfer distance of the points P to the target (mm^2), and its gradient in them.
    pub(crate) fn shape(&self, outline: &[[f64; 2]]) -> (f64, Vec<[f64; 2]>) {
        let origin = if self.centred {
            mean(outline)
        } else {
            [0.0; 2]
        };
        let points: Vec<[f64; 2]> = outline
            .iter()
            .map(|point| [point[0] - origin[0], point[1] - origin[1]])
            .collect();
        let (chamfer, mut by_outline) = self.chamfer.evaluate(&points, &self.target);
        if self.centred {
            let [x, y] = mean(&by_outline);
            for gradient in &mut by_outline {
                gradient[0] -= x;
                gradient[1] -= y;
            }
        }
        (chamfer, by_outline)
    }
}

/// The path of every hinge.
fn hinge_paths(sheet: &Sheet, path: &[LoadStep]) -> Vec<HingePath> {
    let hinges = sheet.hinges.iter().enumerate();
    hinges
        .map(|(h, hinge)| HingePath {
            w_lig: hinge.w_lig,
            deformations: path.iter().map(|step| step.deformations[h]).collect(),
            damage: (path.iter())
                .filter_map(|step| step.damage.get(h).copied())
                .collect(),
        })
        .collect()
}

fn mean(points: &[[f64; 2]]) -> [f64; 2] {
    let sum = points.iter().fold([0.0; 2], |sum, point| {
        [sum[0] + point[0], sum[1] + point[1]]
    });
    sum.map(|component| component / points.len() as f64)
}
