//! The design objective: the Chamfer distance of the deployed outline to the target and functionals of the
//! deformation paths of the hinges (16), plus two penalties: on badly shaped panels, and on hinge states outside
//! the training domain of the hinge law.

use crate::equilibrium::load_step::LoadStep;
use crate::geometry::chamfer::{Chamfer, Precision};
use crate::geometry::plane::{add, complex};
use crate::hinge_law::DamageMeasure;
use crate::objective::domain_penalty::DomainPenalty;
use crate::objective::panel_shape::panel_shape;
use crate::objective::panel_width::panel_width;
use crate::objective::path_functionals::{HingePath, PathFunctionals, PerFunctional};
use crate::sheet::cut_sheet::Sheet;
use crate::sheet::topology::PanelCorner;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The panel corners on the outline that form the point set P of (16).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OutlinePoints {
    /// Corners that belong to no hinge.
    #[default]
    Free,
    /// All corners on the outline.
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

/// The terms of the objective and their weights.
#[derive(Clone, Debug, PartialEq)]
pub struct Objective {
    /// T (mm); not empty.
    pub target: Vec<[f64; 2]>,
    /// Weight and smoothness of the Chamfer distance.
    pub chamfer: Chamfer,
    /// The panel corners that form P.
    pub outline: OutlinePoints,
    /// Whether P is translated so that its mean is the origin; the target should then be centred too.
    pub centred: bool,
    /// w_j of the functionals of the path.
    pub weights: PerFunctional,
    /// The damage measure of the damage functional.
    pub damage_measure: DamageMeasure,
    /// Temperatures of the path extrema.
    pub temperatures: PerFunctional,
    /// Weight of the panel shape penalty (mm^2).
    pub panel_shape: f64,
    /// Corners of a panel at a smaller distance are penalised (mm).
    pub least_distance: f64,
    /// No panel is thinner (mm); 0 sets no limit.
    pub min_panel_width: f64,
    /// `None` if the hinge law has no training domain, or the domain is not weighted.
    pub domain: Option<DomainPenalty>,
}

/// The unweighted terms of the objective.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// mm^2
    pub chamfer: f64,
    /// The path functionals (17)-(19).
    pub path: PerFunctional,
    /// The panel shape penalty.
    pub panel_shape: f64,
    /// The barrier at the minimum panel width (mm^2).
    pub panel_width: f64,
    /// The penalty on hinge states outside the training domain.
    pub domain: f64,
}

/// The objective and its partial derivatives at a deployment.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Judgement {
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
    /// The Chamfer distance alone, with the paper's hard minima and coverage weight 1/2, of the free corners on the
    /// outline to the points `target` (mm).
    pub fn of_shape(target: Vec<[f64; 2]>) -> Self {
        Self {
            target,
            chamfer: Chamfer {
                coverage_weight: 0.5,
                smoothing: 0.0,
                precision: Precision::Samples,
            },
            outline: OutlinePoints::Free,
            centred: false,
            weights: PerFunctional::default(),
            damage_measure: DamageMeasure::Mean,
            temperatures: PerFunctional::default(),
            panel_shape: 0.0,
            least_distance: 0.0,
            min_panel_width: 0.0,
            domain: None,
        }
    }

    /// Evaluates a path whose last configuration places the points P at `outline` (mm); `damage_scale` is
    /// D_s of (17).
    pub(crate) fn judge(
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
        // With zero weight the panels may have any shape.
        let (shape, mut by_corners) = match self.panel_shape {
            0.0 => (0.0, vec![[[0.0; 2]; 4]; sheet.panels.len()]),
            _ => panel_shape(&sheet.panels, self.least_distance),
        };
        let entries = by_corners.as_flattened_mut().as_flattened_mut();
        entries
            .iter_mut()
            .for_each(|entry| *entry *= self.panel_shape);
        let mut width = 0.0;
        if self.min_panel_width > 0.0 {
            let by_width;
            (width, by_width) = panel_width(&sheet.panels, self.min_panel_width);
            let sums = by_corners.as_flattened_mut().iter_mut();
            for (sum, gradient) in sums.zip(by_width.as_flattened()) {
                add(sum, complex(*gradient));
            }
        }
        Judgement {
            loss: chamfer
                + functionals.weighted(&values)
                + self.panel_shape * shape
                + width
                + weight * outside,
            terms: Terms {
                chamfer,
                path: values,
                panel_shape: shape,
                panel_width: width,
                domain: outside,
            },
            by_outline,
            by_path,
            by_corners,
        }
    }

    /// The points P in the position in which they are compared with the target (mm).
    pub fn placed(&self, outline: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let origin = if self.centred {
            mean(outline)
        } else {
            [0.0; 2]
        };
        let moved = |point: &[f64; 2]| [point[0] - origin[0], point[1] - origin[1]];
        outline.iter().map(moved).collect()
    }

    /// Vectors v in P whose sum of v v^T approximates the second derivative of the Chamfer distance (Gauss-Newton).
    pub(crate) fn shape_curvature(&self, outline: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
        let factors = (self.chamfer).curvature_factors(&self.placed(outline), &self.target);
        let share = if self.centred {
            1.0 / outline.len() as f64
        } else {
            0.0
        };
        let mut vectors = Vec::new();
        for (k, columns) in factors.into_iter().enumerate() {
            for column in columns.into_iter().filter(|column| *column != [0.0; 2]) {
                let mut vector = vec![column.map(|entry| -share * entry); outline.len()];
                (0..2).for_each(|axis| vector[k][axis] += column[axis]);
                vectors.push(vector);
            }
        }
        vectors
    }

    /// The Chamfer distance of the points P to the target (mm^2), and its gradient in P.
    pub fn shape(&self, outline: &[[f64; 2]]) -> (f64, Vec<[f64; 2]>) {
        let (chamfer, mut by_outline) =
            (self.chamfer).evaluate(&self.placed(outline), &self.target);
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

/// The paths of all hinges.
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
