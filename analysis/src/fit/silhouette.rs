//! The sheet, and the place of a silhouette, so that the sheet of rigid panels on pins becomes it.
//!
//! Free are the cuts, the corners of the sheet inside its stock, and the size, the rotation and the
//! position of the silhouette. The search is L-BFGS from several rotations of the silhouette, in
//! each from the rectangle with its aspect.

use crate::fit::pulls::opened_about;
use design::geometry::plane::{complex, point};
use design::geometry::polygon::{area, bounds};
use design::geometry::similarity::Similarity;
use design::objective::centre;
use design::objective::design_problem::{DesignError, DesignProblem, Model};
use design::objective::loss::Objective;
use design::objective::scores::outline_error;
use design::objective::shape::Shape;
use design::objective::term::Weighted;
use design::objective::terms::{COVERAGE, CutAngles, PanelShape, SymmetricDifference};
use design::optimise::outer_loop::{SearchState, optimise};
use design::optimise::search::SearchMethod;
use design::pattern::coordinates::{PatternCoordinates, logit};
use design::pattern::cut_pattern::Outline;
use design::pattern::design_vector::{DesignVector, WidthChart};
use design::pattern::fit_variables::FitVariables;
use design::pattern::grid::Grid;
use design::sheet::cut_sheet::{Sheet, SheetOptions};
use design::sheet::kinematics::deployed;
use faer::c64;
use rayon::prelude::*;
use std::convert::Infallible;
use std::f64::consts::FRAC_PI_2;
use std::sync::atomic::AtomicBool;

/// Rotations of the silhouette at the starts (rad).
pub(super) const ROTATIONS: [f64; 10] =
    [0.0, 0.26, -0.26, 0.52, -0.52, 0.785, -0.785, 1.05, -1.05, FRAC_PI_2];
/// Steps of every search, the number of searches that go on from there, and the steps that they
/// have at their ends.
const FIRST_STEPS: usize = 100;
const KEPT: usize = 8;
const STEPS: usize = 600;
/// Length of the first step of a search in every coordinate.
const FIRST_STEP: f64 = 0.1;
/// Part of the stock, along one of its sides, that the sheet of a start fills.
const FILLED: f64 = 0.9;
/// Sides of the panels of the starts over the radius of a window. With 3.6 radii most windows
/// overlap, and the outline is no nearer.
const SIDES: [f64; 3] = [4.4, 4.8, 5.4];
/// Smallest distance of two corners of a panel that is not penalised, over the radius of a window:
/// two radii and a gap.
const APART: f64 = 2.3;
/// The largest number of panels.
const MOST_PANELS: f64 = 150.0;
/// Fewest panels along a side.
const FEWEST: usize = 3;
/// Weight of the symmetric difference relative to the Chamfer distance over the area of the sheet.
pub(super) const DIFFERENCE: f64 = 2.2;
/// Weights of the other penalties relative to the Chamfer distance over the area of a small panel.
const PANEL_SHAPE: f64 = 8.0;
const ANGLES: f64 = 3.0;

/// What a sheet is cut from, and what bounds its cuts.
#[derive(Clone, Copy, Debug)]
pub struct Making {
    /// Width and height of the space for the flat sheet (mm).
    pub stock: [f64; 2],
    /// Opening of every hinge (rad).
    pub opening: f64,
    /// Smallest angle between two cuts (rad).
    pub least_angle: f64,
    /// Interval of the ligament widths (mm).
    pub widths: WidthChart,
    /// Hinge points, cutter and windows.
    pub options: SheetOptions,
}

/// A sheet on pins that is fitted to a silhouette.
#[derive(Clone)]
pub struct Fitted {
    /// Numbers of panels.
    pub grid: Grid,
    /// The outline of the flat sheet, in its stock.
    pub outline: Outline,
    /// The cuts.
    pub pattern: PatternCoordinates,
    /// The flat sheet.
    pub sheet: Sheet,
    /// Root mean square distance of the free corners of the opened outline from the silhouette
    /// (mm).
    pub outline_error: f64,
    /// Opening of every hinge (rad).
    opening: f64,
    /// Scale and rotation of the silhouette, and the centre of its area in its own coordinates.
    turn: c64,
    centre: c64,
}

impl Fitted {
    /// Rotation of the silhouette (rad).
    pub(super) fn rotation(&self) -> f64 {
        self.turn.arg()
    }

    /// The free corners of the outline of the opened sheet whose panel `held` stays where it is
    /// (mm), and the place of the silhouette there.
    pub fn opened(&self, held: usize) -> (Vec<[f64; 2]>, Similarity) {
        let opened = opened_about(&self.sheet, held, self.opening);
        let corner = |(panel, corner): (usize, usize)| {
            let panel_at = &self.sheet.panels[panel];
            deployed(panel_at, opened[panel], panel_at.corners[corner])
        };
        let corners = self.sheet.free_outline_corners();
        let outline: Vec<[f64; 2]> = corners.into_iter().map(corner).collect();
        // The fit leaves panel 0 in the rotation of even panels.
        let turn = self.turn * c64::cis(opened[0][2] + 0.5 * self.opening);
        let shift = complex(centre::of(&outline)) - turn * self.centre;
        (outline, Similarity { turn, shift })
    }
}

/// Fits a sheet to a silhouette, a closed curve in any position and of any size, from each of some
/// rotations of it (rad).
pub fn fit(
    silhouette: &[[f64; 2]],
    making: &Making,
    rotations: &[f64],
) -> Result<Fitted, DesignError> {
    let starts = rotations.par_iter().flat_map_iter(|&rotation| SIDES.map(|side| (rotation, side)));
    let begun = starts.map(|(rotation, side)| {
        Search::new(silhouette, making, rotation, side)?.advanced(FIRST_STEPS)
    });
    // A failed start does not end the others.
    let loss = |search: &Result<Search, DesignError>| {
        search.as_ref().map_or(f64::INFINITY, |search| search.loss)
    };
    let mut searches: Vec<_> = begun.collect();
    searches.sort_by(|one, other| loss(one).total_cmp(&loss(other)));
    // Two sides of panels may give the same numbers of panels.
    searches.dedup_by(|one, other| loss(one) == loss(other));
    searches.truncate(KEPT);
    let ends = searches.into_par_iter().map(|search| search?.advanced(STEPS));
    let best = ends.min_by(|one, other| loss(one).total_cmp(&loss(other)));
    best.expect("there are starts")?.fitted(making.opening)
}

/// The search from one rotation of the silhouette and one size of the panels.
struct Search {
    problem: DesignProblem,
    state: SearchState,
    /// Scale and rotation of the silhouette at the start, and the centre of its area in its own
    /// coordinates.
    turn: c64,
    centre: c64,
    /// Value of the objective at the best design (mm^2).
    loss: f64,
}

impl Search {
    fn new(
        silhouette: &[[f64; 2]],
        making: &Making,
        rotation: f64,
        side: f64,
    ) -> Result<Self, DesignError> {
        let centre = complex(centre::of(silhouette));
        let turned =
            |turn: c64| (silhouette.iter()).map(move |&p| point(turn * (complex(p) - centre)));
        let [low, high] = bounds(turned(c64::cis(rotation)));
        let extent = [0, 1].map(|c| high[c] - low[c]);
        let fill = f64::min(making.stock[0] / extent[0], making.stock[1] / extent[1]);
        let sides = extent.map(|along| FILLED * fill * along);
        let sheet = sides[0] * sides[1];
        // The area of a uniform sheet grows by 1 + sin(theta).
        let scale = (sheet * (1.0 + making.opening.sin()) / area(silhouette).abs()).sqrt();
        let turn = c64::cis(rotation) * scale;
        let problem = making.problem(making.grid(sides, side), turned(turn).collect(), sheet);
        let corner = [0, 1].map(|c| logit(sides[c] / making.stock[c]));
        let mut start = DesignVector::uniform(problem.grid);
        start.fit = Some(FitVariables { ln_size: 0.0, rotation: 0.0, corners: [corner; 4] });
        let first = problem.evaluate(&start)?;
        let state = SearchState::new(&problem, start, &first, SearchMethod::Lbfgs, FIRST_STEP);
        Ok(Self { problem, state, turn, centre, loss: first.loss })
    }

    /// Goes on until `steps` are made.
    fn advanced(mut self, steps: usize) -> Result<Self, DesignError> {
        let never = AtomicBool::new(false);
        let Ok(_) =
            optimise::<Infallible>(&self.problem, &mut self.state, steps, &never, &mut |_| Ok(()));
        self.loss = self.problem.evaluate(&self.state.best)?.loss;
        Ok(self)
    }

    fn fitted(self, opening: f64) -> Result<Fitted, DesignError> {
        let design = self.state.best;
        let end = self.problem.evaluate(&design)?;
        let variables = design.fit.unwrap_or_default();
        Ok(Fitted {
            grid: self.problem.grid,
            outline: self.problem.outline_of(&design),
            outline_error: outline_error(&self.problem.objective, &end.deployment),
            pattern: design.pattern,
            sheet: end.deployment.sheet,
            opening,
            turn: self.turn * c64::cis(variables.rotation) * variables.ln_size.exp(),
            centre: self.centre,
        })
    }
}

impl Making {
    fn problem(&self, grid: Grid, target: Vec<[f64; 2]>, sheet: f64) -> DesignProblem {
        let panel_area = (SIDES[0] * self.options.process.r_win).powi(2);
        let shape = Shape { target, coverage_weight: COVERAGE, centred: true };
        let min_distance = APART * self.options.process.r_win;
        let penalties = vec![
            Weighted::new(DIFFERENCE * sheet, SymmetricDifference::new(shape.clone())),
            Weighted::new(PANEL_SHAPE * panel_area, PanelShape { min_distance }),
            Weighted::new(ANGLES * panel_area, CutAngles { minimum: self.least_angle }),
        ];
        DesignProblem {
            grid,
            outline: Outline::rectangle(self.stock[0], self.stock[1]),
            widths: self.widths,
            options: self.options,
            model: Model::Ideal { opening: self.opening },
            objective: Objective { shape, functionals: Vec::new(), penalties },
        }
    }

    /// An even number of columns, so that a symmetric silhouette can have a symmetric sheet.
    fn grid(&self, sides: [f64; 2], side: f64) -> Grid {
        let side =
            (side * self.options.process.r_win).max((sides[0] * sides[1] / MOST_PANELS).sqrt());
        let [columns, rows] = sides.map(|along| along / side);
        Grid {
            m: 2 * ((0.5 * columns).round() as usize).max(2),
            n: (rows.round() as usize).max(FEWEST),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use design::geometry::chamfer::chamfer;
    use design::sheet::cut_sheet::HingePoint;
    use design::sheet::cutting_process::{CuttingProcess, Hole};
    use scene::target::{Target, TargetShape};
    use std::path::Path;

    const MAKING: Making = Making {
        stock: [300.0, 300.0],
        opening: 1.0,
        least_angle: 0.5,
        widths: WidthChart { w_minus: 0.7, w_plus: 1.8 },
        options: SheetOptions {
            hinge_point: HingePoint::CutTip,
            process: CuttingProcess { hole: Hole::Ratio(0.16), slit_width: 0.1, r_win: 8.0 },
        },
    };

    fn leaf(centre: [f64; 2], height: f64, rotation_deg: f64) -> Vec<[f64; 2]> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/targets");
        let file = "leaf.svg".into();
        let shape = TargetShape::Svg { file, centre, height: Some(height), rotation_deg };
        Target::sample(&shape, &folder, 400).unwrap().points
    }

    #[test]
    fn a_leaf_is_reached_wherever_it_stands_in_its_file() {
        let fits = [leaf([0.0; 2], 100.0, 0.0), leaf([5e3, -70.0], 2e3, 0.0)]
            .map(|silhouette| (fit(&silhouette, &MAKING, &[0.0, 0.3, -0.3]).unwrap(), silhouette));
        for (fit, silhouette) in &fits {
            assert!(fit.outline_error < 0.015 * 300.0, "{}", fit.outline_error);
            for [x, y] in fit.outline.corners {
                assert!((0.0..=300.0).contains(&x) && (0.0..=300.0).contains(&y));
            }
            // The place of the silhouette, and the outline of the opened sheet, are where the error
            // says.
            for held in [0, fit.grid.m + 1] {
                let (outline, place) = fit.opened(held);
                let placed: Vec<[f64; 2]> =
                    (silhouette.iter()).map(|p| point(place.of(complex(*p)))).collect();
                let error = chamfer(&outline, &placed, 0.0).0.sqrt();
                assert!((error / fit.outline_error - 1.0).abs() < 1e-6, "{error}");
            }
        }
        // Rounding grows in hundreds of steps, to another end of nearly the same error.
        let [one, other] = fits.map(|(fit, _)| fit.outline_error);
        assert!((one / other - 1.0).abs() < 0.1, "{one} {other}");
    }
}
