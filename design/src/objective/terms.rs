//! The terms of the objective, a file each; their keys, and their list.

mod compression;
pub mod damage;
mod domain;
mod fastenings;
mod panel_shape;
pub mod panel_width;
mod shear;
mod symmetric_difference;

pub use compression::Compression;
pub use damage::DamageFunctional;
pub use domain::DomainPenalty;
pub use fastenings::Fastenings;
pub use panel_shape::PanelShape;
pub use panel_width::PanelWidth;
pub use shear::Shear;
pub use symmetric_difference::SymmetricDifference;

use crate::{
    hinge_law::{DamageMeasure, HingeLaw},
    objective::{loss::Objective, shape::ShapeDistance, term::Weighted},
    sheet::cut_sheet::AttachmentPoint,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// w_cov of the Chamfer distance, as in the paper.
pub const COVERAGE: f64 = 0.5;
/// Weight of the penalty on holes and clips without room, relative to the Chamfer distance over the
/// area of a panel.
const FASTENINGS: f64 = 10.0;

/// The weights of (16)-(19), relative to the Chamfer distance divided by the mean panel area: at
/// the weight 1 a functional with the value 1 costs as much as an outline error of one panel size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ObjectiveConfig {
    /// Weight of the area inside the polygon through the compared corners and outside the target,
    /// or the reverse, over the area of the target.
    #[schemars(range(min = 0.0, max = 1e9))]
    pub symmetric_difference: f64,
    /// Weight of (17); needs a learned level.
    #[schemars(range(min = 0.0, max = 1e9))]
    pub damage: f64,
    /// The damage measure of (17): `mean`, D as in the paper, or `peak`, D_peak, at which 1 means
    /// tearing; from 0.9 on a ligament costs more.
    pub damage_measure: DamageMeasure,
    /// Weight of (18).
    #[schemars(range(min = 0.0, max = 1e9))]
    pub compression: f64,
    /// Weight of (19).
    #[schemars(range(min = 0.0, max = 1e9))]
    pub shear: f64,
    /// Weight of the panel shape penalty: on panels stretched more than eight to one or with angles
    /// below 14 degrees, which the outline alone does not prevent, and, with learned hinges, on
    /// corners of a panel closer than three radii of their windows.
    #[schemars(range(min = 0.0, max = 1e9))]
    pub panel_shape: f64,
    /// No panel is thinner anywhere (mm), at most a third of the side of a square panel of the mean
    /// area: the minimum that the cutter accepts. Distances of corners from the edges of their
    /// panel are kept above it by a barrier, which begins at twice the value; use it with `method =
    /// "lbfgs"`, since Adam can get stuck at it. The panels of the start must be wider. 0 sets no
    /// limit.
    #[schemars(range(min = 0.0))]
    pub min_panel_width: f64,
    /// Weight of the penalty on states outside the training domain of the hinge law, in squared
    /// tenths of its range, as a mean over hinges and load steps. Needs a learned level.
    #[schemars(range(min = 0.0, max = 1e9))]
    pub domain: f64,
}

/// The sheet that an objective is for.
pub struct TermContext<'a> {
    /// Points on the target, evenly spaced (mm).
    pub target: &'a [[f64; 2]],
    /// `None` for a sheet on pins, which has no supports and is centred on its target.
    pub law: Option<&'a dyn HingeLaw>,
    /// Area of the sheet divided by the number of panels (mm^2).
    pub mean_panel_area: f64,
    /// Radius of the windows of the hinges (mm).
    pub r_win: f64,
    /// The points at which panels are held or pulled.
    pub attachments: Vec<AttachmentPoint>,
}

impl ObjectiveConfig {
    /// The objective for a sheet.
    pub fn objective(&self, context: &TermContext) -> Objective {
        let area = context.mean_panel_area;
        let scale = (context.law).and_then(|law| law.damage_scale(self.damage_measure));
        let domain = context.law.and_then(|law| law.domain());
        // Only a learned hinge has a window. Two window radii and a gap: the windows do not lie on
        // one line.
        let min_distance = domain.map_or(0.0, |_| 3.0 * context.r_win);
        let (minimum, limited) = (self.min_panel_width, f64::from(self.min_panel_width > 0.0));
        // Temperatures are a tenth of typical values.
        let (domain, temperature) = (domain.cloned(), 0.01);
        let damage = DamageFunctional {
            measure: self.damage_measure,
            // No scale is needed without damage.
            scale: scale.unwrap_or(1.0),
            temperature: 0.1,
        };
        let mut penalties = vec![
            Weighted::new(self.panel_shape * area, PanelShape { min_distance }),
            Weighted::new(limited, PanelWidth { minimum }),
            Weighted::new(self.domain * area, DomainPenalty { domain }),
        ];
        let is_fastened = |at: &AttachmentPoint| at.hole.or(at.clip).is_some();
        if context.attachments.iter().any(is_fastened) {
            let attachments = context.attachments.clone();
            penalties.push(Weighted::new(FASTENINGS * area, Fastenings { attachments }));
        }
        let shape = self.shape(context);
        if self.symmetric_difference > 0.0 {
            let difference = SymmetricDifference::new(shape.clone());
            penalties.push(Weighted::new(self.symmetric_difference * area, difference));
        }
        Objective {
            shape,
            functionals: vec![
                Weighted::new(self.damage * area, damage),
                Weighted::new(self.compression * area, Compression { temperature }),
                Weighted::new(self.shear * area, Shear { temperature }),
            ],
            penalties,
        }
    }

    fn shape(&self, context: &TermContext) -> ShapeDistance {
        let mut shape = ShapeDistance {
            target: Vec::new(),
            coverage_weight: COVERAGE,
            centred: context.law.is_none(),
        };
        shape.target = shape.placed(context.target);
        shape
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::load_step::LoadStep;
    use crate::hinge_law::{HingeDamage, PreparedLaw};
    use crate::objective::hinge_measures::add_by_states;
    use crate::objective::term::{Deployed, Term, TermGradient};
    use crate::pattern::coordinates::PatternCoordinates;
    use crate::pattern::cut_pattern::{CutPattern, Outline};
    use crate::pattern::grid::Grid;
    use crate::sheet::cut_sheet::{HingePoint, Sheet, SheetOptions};
    use hinge::{HingeConstants, HingeDeformation, HingeDesign, TrainingDomain};
    use std::f64::consts::TAU;
    use testkit::derivatives::assert_gradient;

    const GRID: Grid = Grid { m: 2, n: 2 };
    const STEPS: usize = 3;
    /// w_lig and alpha, then (a, s, theta) per load step.
    const PER_HINGE: usize = 2 + 3 * STEPS;

    /// A law with a training domain and with damage.
    struct Law(TrainingDomain);

    impl HingeLaw for Law {
        fn prepare<'a>(&'a self, _designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
            unreachable!("no state is computed")
        }

        fn damage_scale(&self, _measure: DamageMeasure) -> Option<f64> {
            Some(0.5)
        }

        fn domain(&self) -> Option<&TrainingDomain> {
            Some(&self.0)
        }
    }

    /// The objective with all terms.
    fn objective(damage_measure: DamageMeasure) -> Objective {
        let config = ObjectiveConfig {
            symmetric_difference: 0.9,
            damage: 0.7,
            damage_measure,
            compression: 0.3,
            shear: 0.2,
            panel_shape: 0.4,
            min_panel_width: 6.0,
            domain: 0.6,
        };
        let angles = (0..1000).map(|i| TAU * f64::from(i) / 1000.0);
        let circle = angles.map(|t| [90.0 + 60.0 * t.cos(), 10.0 + 60.0 * t.sin()]);
        let state = [[-0.02, 0.03], [-0.02, 0.02], [0.0, 0.1]];
        let domain = testkit::domain_of_box(state, [1.0, 2.5], [0.8, 1.5]);
        config.objective(&TermContext {
            target: &circle.collect::<Vec<_>>(),
            law: Some(&Law(domain)),
            mean_panel_area: 10.0,
            r_win: 10.0,
            attachments: Vec::new(),
        })
    }

    /// A sheet of slender panels.
    fn sheet() -> Sheet {
        let outline = Outline::rectangle(200.0, 20.0);
        let pattern = CutPattern::new(GRID, outline, &PatternCoordinates::uniform(GRID)).unwrap();
        let options =
            SheetOptions { hinge_point: HingePoint::Corner, process: HingeConstants::PAPER.into() };
        Sheet::new(&pattern, &vec![2.0; GRID.hinge_count()], options).unwrap()
    }

    /// D = w_lig theta^2 (1 + a), D_peak = 3 D
    fn damage(w_lig: f64, state: &HingeDeformation) -> HingeDamage {
        let HingeDeformation { a, theta, .. } = *state;
        let per_width = theta * theta * (1.0 + a);
        let by_a = w_lig * theta * theta;
        let by_theta = 2.0 * w_lig * theta * (1.0 + a);
        let gradient = [by_a, 0.0, by_theta, per_width, 0.0, 0.0];
        HingeDamage {
            d: w_lig * per_width,
            gradient: gradient.into(),
            d_peak: Some(3.0 * w_lig * per_width),
            peak_gradient: gradient.map(|slope| 3.0 * slope).into(),
        }
    }

    /// The value of a term and its gradient in the outline points, the corners of the panels, and
    /// the hinges with their states.
    fn evaluate(term: &dyn Term, x: &[f64]) -> (f64, Vec<f64>) {
        let mut sheet = sheet();
        let (hinges, rest) = x.split_at(PER_HINGE * sheet.hinges.len());
        let (corners, outline) = rest.split_at(8 * sheet.panels.len());
        for (panel, corners) in sheet.panels.iter_mut().zip(corners.chunks(8)) {
            let flat = panel.corners.as_flattened_mut();
            flat.copy_from_slice(corners);
        }
        for (hinge, numbers) in sheet.hinges.iter_mut().zip(hinges.chunks(PER_HINGE)) {
            [hinge.w_lig, hinge.alpha] = [numbers[0], numbers[1]];
        }
        let step = |i: usize| {
            let mut step = LoadStep::ideal(&sheet, vec![[0.0; 3]; sheet.panels.len()]);
            let at = |numbers: &[f64]| [0, 1, 2].map(|c| numbers[2 + 3 * i + c]).into();
            step.deformations = hinges.chunks(PER_HINGE).map(at).collect();
            let states = sheet.hinges.iter().zip(&step.deformations);
            step.damage = states.map(|(h, state)| damage(h.w_lig, state)).collect();
            step
        };
        let path: Vec<LoadStep> = (0..STEPS).map(step).collect();
        let at = Deployed { sheet: &sheet, path: &path, outline: outline.as_chunks().0 };
        let mut gradient = TermGradient::zeros(&at);
        let value = term.evaluate(&at, 1.0, &mut gradient);
        add_by_states(&at, &mut gradient);
        let by_hinges = std::iter::zip(&gradient.by_states, &gradient.by_sheet.alphas);
        let by_hinges = by_hinges.flat_map(|(steps, by_angle)| {
            let [width, angle] = [0, 1].map(|c| {
                let slopes = steps.iter().map(|step| step.design.to_array()[c]);
                slopes.sum::<f64>()
            });
            let states = steps.iter().flat_map(|step| step.state);
            [width, angle + by_angle].into_iter().chain(states)
        });
        let by_corners = gradient.by_sheet.corners.into_flattened();
        let by_corners = by_corners.into_iter().flat_map(|slope| [slope.re, slope.im]);
        let by_outline = gradient.by_outline.into_flattened();
        let slopes = by_hinges.chain(by_corners).chain(by_outline).collect();
        (value, slopes)
    }

    /// A point at which every term counts.
    fn point() -> Vec<f64> {
        let sheet = sheet();
        let mut wave = (1..).map(|i: i32| f64::from(i * i).sin());
        let mut next = |middle: f64, width: f64| middle + width * wave.next().unwrap();
        let mut x = Vec::new();
        for _ in &sheet.hinges {
            x.extend([next(2.0, 1.0), next(1.2, 0.5)]);
            for i in 1..=STEPS {
                let far = i as f64;
                x.extend([next(0.0, 0.1 * far), next(0.0, 0.1 * far), 0.2 * far]);
            }
        }
        let corners = sheet.panels.iter().flat_map(|panel| panel.corners);
        x.extend(corners.flatten().map(|corner| next(corner, 0.5)));
        let outline = sheet.outline_corners().into_iter();
        let outline = outline.flat_map(|(panel, corner)| sheet.panels[panel].corners[corner]);
        x.extend(outline.map(|corner| next(1.2 * corner, 2.0)));
        x
    }

    #[test]
    fn gradients_of_all_terms_agree_with_differences() {
        let x = point();
        for measure in [DamageMeasure::Mean, DamageMeasure::Peak] {
            for (term, _) in objective(measure).terms() {
                let (value, gradient) = evaluate(term, &x);
                let largest = gradient.iter().fold(0.0, |max, slope| slope.abs().max(max));
                assert!(value > 0.0 && largest > 0.0, "{}: {value}", term.name());
                let allowed = |_| 1e-7 * largest.max(value);
                assert_gradient(|x| evaluate(term, x).0, &x, &gradient, 1e-6, allowed);
            }
        }
    }

    #[test]
    fn peak_damage_costs_more_and_a_path_without_compression_nothing() {
        let values = |measure, x: &[f64]| {
            let objective = objective(measure);
            ["damage", "compression"].map(|name| {
                let mut terms = objective.terms();
                let (term, _) = terms.find(|(term, _)| term.name() == name).unwrap();
                evaluate(term, x).0
            })
        };
        let mut x = point();
        let [mean, _] = values(DamageMeasure::Mean, &x);
        let [peak, compression] = values(DamageMeasure::Peak, &x);
        assert!(peak > 2.0 * mean, "{mean} {peak}");
        assert!(compression > 0.0);
        for numbers in x[..PER_HINGE * GRID.hinge_count()].chunks_mut(PER_HINGE) {
            (0..STEPS).for_each(|i| numbers[2 + 3 * i] = numbers[2 + 3 * i].abs());
        }
        assert_eq!(values(DamageMeasure::Mean, &x)[1], 0.0);
    }
}
