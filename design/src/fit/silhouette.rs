//! The sheet, and the place of a silhouette, so that the sheet of rigid panels on pins becomes it.
//!
//! Free are the cuts, the corners of the sheet inside its stock, and the size, the rotation and the position of the silhouette. The
//! search is L-BFGS from several rotations of the silhouette, in each from the rectangle with its aspect.

use crate::fit::pulls::opened_about;
use crate::geometry::plane::{complex, point};
use crate::geometry::polygon::{area, bounds};
use crate::geometry::similarity::Similarity;
use crate::objective::centre;
use crate::objective::design_problem::{DesignError, DesignProblem, Model};
use crate::objective::loss::Objective;
use crate::objective::scores::outline_error;
use crate::objective::shape::Shape;
use crate::objective::term::Weighted;
use crate::objective::terms::{COVERAGE, CutAngles, PanelShape, SymmetricDifference};
use crate::optimise::outer_loop::{SearchState, optimise};
use crate::optimise::search::SearchMethod;
use crate::pattern::coordinates::{PatternCoordinates, logit};
use crate::pattern::cut_pattern::Outline;
use crate::pattern::design_vector::{DesignVector, WidthChart};
use crate::pattern::fit_variables::FitVariables;
use crate::pattern::grid::Grid;
use crate::sheet::cut_sheet::{Sheet, SheetOptions};
use crate::sheet::kinematics::deployed;
use faer::c64;
use std::convert::Infallible;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::sync::atomic::AtomicBool;
use std::thread;

/// Rotations of the silhouette at the starts (rad).
const ROTATIONS: [f64; 6] = [0.0, 0.3, -0.3, FRAC_PI_4, -FRAC_PI_4, FRAC_PI_2];
/// Steps of one search.
const STEPS: usize = 300;
/// Length of its first step in every coordinate.
const FIRST_STEP: f64 = 0.1;
/// Part of the stock, along one of its sides, that the sheet of a start fills.
const FILLED: f64 = 0.9;
/// Side of a panel over the radius of a window. With 3.6 radii most windows overlap, and the outline is no nearer.
const PANEL: f64 = 4.4;
/// Smallest distance of two corners of a panel that is not penalised, over the radius of a window: two radii and a gap.
const APART: f64 = 2.3;
/// The largest number of panels.
const MOST_PANELS: f64 = 150.0;
/// Fewest panels along a side.
const FEWEST: usize = 3;
/// Weights of the penalties relative to the Chamfer distance over the mean panel area.
pub(super) const DIFFERENCE: f64 = 10.0;
const PANELS: f64 = 8.0;
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
    /// Root mean square distance of the free corners of the opened outline from the silhouette (mm).
    pub outline_error: f64,
    /// The area inside one of outline and silhouette but not in both, over that of the silhouette.
    pub difference: f64,
    /// Opening of every hinge (rad).
    opening: f64,
    /// Scale and rotation of the silhouette, and the centre of its area in its own coordinates.
    turn: c64,
    centre: c64,
    /// Value of the objective over the mean panel area.
    loss: f64,
}

impl Fitted {
    /// The free corners of the outline of the opened sheet whose panel `held` stays where it is (mm), and the place of the silhouette there.
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

/// Fits a sheet to a silhouette, a closed curve in any position and of any size.
pub fn fit(silhouette: &[[f64; 2]], making: &Making) -> Result<Fitted, DesignError> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let shares = ROTATIONS.chunks(ROTATIONS.len().div_ceil(cores));
    let of_share = |rotations: &'static [f64]| {
        let fits = rotations
            .iter()
            .map(|&rotation| fit_from(silhouette, making, rotation));
        fits.collect::<Vec<_>>()
    };
    let fits: Vec<Result<Fitted, DesignError>> = thread::scope(|scope| {
        let running: Vec<_> = shares
            .map(|share| scope.spawn(move || of_share(share)))
            .collect();
        (running.into_iter())
            .flat_map(|fits| fits.join().expect("a fit does not panic"))
            .collect()
    });
    // A failed start does not end the others.
    let loss =
        |fit: &Result<Fitted, DesignError>| fit.as_ref().map_or(f64::INFINITY, |fit| fit.loss);
    let best = fits
        .into_iter()
        .min_by(|one, other| loss(one).total_cmp(&loss(other)));
    best.expect("there are starts")
}

/// The fit from one rotation.
fn fit_from(
    silhouette: &[[f64; 2]],
    making: &Making,
    rotation: f64,
) -> Result<Fitted, DesignError> {
    let centre = complex(centre::of(silhouette));
    let turned = |size: f64| {
        let turn = c64::cis(rotation) * size;
        silhouette
            .iter()
            .map(move |&p| point(turn * (complex(p) - centre)))
    };
    let [low, high] = bounds(turned(1.0));
    let extent = [0, 1].map(|c| high[c] - low[c]);
    let fill = f64::min(making.stock[0] / extent[0], making.stock[1] / extent[1]);
    let sides = extent.map(|along| FILLED * fill * along);
    let sheet = sides[0] * sides[1];
    let grid = making.grid(sides);
    // The area of a uniform sheet grows by 1 + sin(theta).
    let scale = (sheet * (1.0 + making.opening.sin()) / area(silhouette).abs()).sqrt();
    let problem = making.problem(
        grid,
        turned(scale).collect(),
        sheet / grid.panel_count() as f64,
    );
    let corner = [0, 1].map(|c| logit(sides[c] / making.stock[c]));
    let mut start = DesignVector::uniform(grid);
    start.fit = Some(FitVariables {
        ln_size: 0.0,
        rotation: 0.0,
        corners: [corner; 4],
    });
    let first = problem.evaluate(&start)?;
    let mut search = SearchState::new(&problem, start, &first, SearchMethod::Lbfgs, FIRST_STEP);
    let never = AtomicBool::new(false);
    let Ok(_) = optimise::<Infallible>(&problem, &mut search, STEPS, &never, &mut |_| Ok(()));
    let design = search.best;
    let end = problem.evaluate(&design)?;
    let variables = design.fit.unwrap_or_default();
    Ok(Fitted {
        grid,
        outline: problem.outline_of(&design),
        outline_error: outline_error(&problem.objective, &end.deployment),
        difference: end.terms["symmetric_difference"],
        pattern: design.pattern,
        sheet: end.deployment.sheet,
        opening: making.opening,
        turn: c64::cis(rotation + variables.rotation) * (scale * variables.ln_size.exp()),
        centre,
        loss: end.loss / problem.objective.penalties[0].weight * DIFFERENCE,
    })
}

impl Making {
    fn problem(&self, grid: Grid, target: Vec<[f64; 2]>, panel_area: f64) -> DesignProblem {
        let shape = Shape {
            target,
            coverage_weight: COVERAGE,
            centred: true,
        };
        let min_distance = APART * self.options.process.r_win;
        let penalties = vec![
            Weighted::new(
                DIFFERENCE * panel_area,
                SymmetricDifference::new(shape.clone()),
            ),
            Weighted::new(PANELS * panel_area, PanelShape { min_distance }),
            Weighted::new(
                ANGLES * panel_area,
                CutAngles {
                    least: self.least_angle,
                },
            ),
        ];
        DesignProblem {
            grid,
            outline: Outline::rectangle(self.stock[0], self.stock[1]),
            widths: self.widths,
            options: self.options,
            model: Model::Ideal {
                opening: self.opening,
            },
            objective: Objective {
                shape,
                functionals: Vec::new(),
                penalties,
            },
        }
    }

    /// An even number of columns, so that a symmetric silhouette can have a symmetric sheet.
    fn grid(&self, sides: [f64; 2]) -> Grid {
        let side =
            (PANEL * self.options.process.r_win).max((sides[0] * sides[1] / MOST_PANELS).sqrt());
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
    use crate::geometry::chamfer::chamfer;
    use crate::objective::target::{Target, TargetShape};
    use crate::sheet::cut_sheet::HingePoint;
    use crate::sheet::cutting_process::{CuttingProcess, Hole};
    use std::path::Path;

    const MAKING: Making = Making {
        stock: [300.0, 300.0],
        opening: 1.0,
        least_angle: 0.5,
        widths: WidthChart {
            w_minus: 0.7,
            w_plus: 1.8,
        },
        options: SheetOptions {
            hinge_point: HingePoint::CutTip,
            process: CuttingProcess {
                hole: Hole::Ratio(0.16),
                kerf: 0.1,
                r_win: 8.0,
            },
        },
    };

    fn leaf(centre: [f64; 2], height: f64, rotation_deg: f64) -> Vec<[f64; 2]> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/targets");
        let file = "leaf.svg".into();
        let shape = TargetShape::Svg {
            file,
            centre,
            height,
            rotation_deg,
        };
        Target::sample(&shape, &folder, 400).unwrap().points
    }

    #[test]
    fn a_leaf_is_reached_wherever_it_stands_in_its_file() {
        let fits = [leaf([0.0; 2], 100.0, 0.0), leaf([5e3, -70.0], 2e3, 0.0)]
            .map(|silhouette| (fit(&silhouette, &MAKING).unwrap(), silhouette));
        for (fit, silhouette) in &fits {
            assert!(fit.outline_error < 0.015 * 300.0, "{}", fit.outline_error);
            assert!(fit.difference < 0.03, "{}", fit.difference);
            for [x, y] in fit.outline.corners {
                assert!((0.0..=300.0).contains(&x) && (0.0..=300.0).contains(&y));
            }
            // The place of the silhouette, and the outline of the opened sheet, are where the error says.
            for held in [0, fit.grid.m + 1] {
                let (outline, place) = fit.opened(held);
                let placed: Vec<[f64; 2]> = (silhouette.iter())
                    .map(|p| point(place.of(complex(*p))))
                    .collect();
                let error = chamfer(&outline, &placed, 0.0).0.sqrt();
                assert!((error / fit.outline_error - 1.0).abs() < 1e-6, "{error}");
            }
        }
        // Rounding grows in hundreds of steps, to another end of nearly the same error.
        let [one, other] = fits.map(|(fit, _)| fit.outline_error);
        assert!((one / other - 1.0).abs() < 0.1, "{one} {other}");
    }
}
