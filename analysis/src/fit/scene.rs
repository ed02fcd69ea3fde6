//! The scene of a sheet that is fitted to the target of another: what the fit, the pulls and one
//! equilibrium decide becomes keys.

use crate::fit::opening::safe_opening;
use crate::fit::placement::place;
use crate::fit::pulls::{Pull, candidates, pulls};
use crate::fit::silhouette::{DIFFERENCE, Fitted, Making, ROTATIONS, fit};
use crate::out_of_plane::Stability;
use design::equilibrium::load_step::Status;
use design::geometry::chamfer::chamfer;
use design::geometry::plane::{complex, point};
use design::geometry::polygon::{bounds, distance_to_outline};
use design::geometry::similarity::Similarity;
use design::geometry::symmetric_difference::intersection_over_union;
use design::hinge_law::DamageMeasure;
use design::objective::design_problem::DesignError;
use design::optimise::search::SearchMethod;
use design::pattern::cut_pattern::Outline;
use design::pattern::design_vector::WidthChart;
use design::sheet::validity::{OVERLAP, overlap};
use hinge::Regime;
use scene::{
    DriveConfig, Level, LigamentConfig, LoadConfig, OptimiserConfig, Posture, PostureConfig, Scene,
    SceneConfig, SceneError, StartConfig, SupportConfig, SupportKind, rounded,
};
use std::cmp::Ordering;

/// The largest opening that is planned (rad): 65 degrees.
const MOST: f64 = 1.134;
/// The opening that is planned for a law that predicts no damage (rad): 45 degrees.
const UNKNOWN: f64 = 0.785;
/// The smallest angle between two cuts that is planned for such a law (rad): 30 degrees.
const ACUTE: f64 = 0.524;
/// By how much the cut angles stay away from the ends of the training domain (rad): two degrees.
const INSIDE: f64 = 0.035;
/// Weights of the damage and of states outside the training domain. With lower ones the ligaments
/// of a slender shape tear, and a few states remain outside.
const DAMAGE: f64 = 0.4;
const DOMAIN: f64 = 3e4;
/// Distance of the silhouette from the opened outline at which a place counts as reached, over the
/// longer side of the sheet.
const REACHED: f64 = 0.02;
/// The largest number of pulls.
const MOST_PULLS: usize = 4;
/// Outline error of an equilibrium over the outline error of the pins up to which another pull is
/// not needed.
const CLOSE: f64 = 1.25;
/// Steps of the search from the fitted sheet, and the length of its first step: it starts near its
/// end.
const STEPS: usize = 100;
const FIRST_STEP: f64 = 0.03;

/// How near an opened outline is to a silhouette.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearness {
    /// Root mean square distance of the free corners of the outline from the silhouette (mm).
    pub error: f64,
    /// The same over the longer side of the flat sheet.
    pub relative: f64,
    /// The area inside both the polygon through these corners and the silhouette, over that inside
    /// one of them.
    pub overlap: f64,
}

/// A place of a silhouette that a sheet on pins does not reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Missed {
    /// Its distance from the opened outline (mm).
    pub distance: f64,
    /// Where it is in the drawing, as parts of its width and height from its lower left corner.
    pub at: [f64; 2],
}

/// A fitted scene, and what is expected of it.
pub struct FittedScene {
    /// Its keys.
    pub config: SceneConfig,
    /// The opening of every hinge on pins (rad).
    pub opening: f64,
    /// The sheet on pins.
    pub on_pins: Nearness,
    /// The places that it does not reach within `REACHED` of its longer side, the farthest first,
    /// one for each stretch of the silhouette.
    pub missed: Vec<Missed>,
    /// Rotation of the silhouette on it (rad).
    rotation: f64,
    /// Its equilibrium under the pulls before any search; `None` if none was found.
    pub pulled: Option<Nearness>,
    /// Whether it stays in its plane there by itself; `None` for a film and without an equilibrium,
    /// where the panels are held flat.
    pub stability: Option<Stability>,
}

/// Why a sheet is not fitted to a target.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum FitError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(
        "the sheet has pins (level = \"pin\"): its search is on pins already; a fit is for a sheet with a hinge law"
    )]
    Pins,
    #[error("no sheet on pins is found for the target: {0}")]
    Design(#[from] DesignError),
}

/// Fits the sheet of a scene, a rectangle that stands for the space in its stock, to its target.
pub fn fitted(scene: &Scene) -> Result<FittedScene, FitError> {
    if scene.config.level == Level::Pin {
        return Err(FitError::Pins);
    }
    let silhouette = &scene.target.points;
    let making = making(scene);
    let fitted = fit(silhouette, &making, &ROTATIONS)?;
    let held = [fitted.grid.m / 2, fitted.grid.n / 2];
    let index = held[1] * fitted.grid.m + held[0];
    let (on_pins, place_on_pins) = fitted.opened(index);
    let nearness = |outline: &[[f64; 2]], place: Similarity| {
        Nearness::new(outline, &placed(silhouette, place), &fitted)
    };
    let pins = nearness(&on_pins, place_on_pins);
    let candidates = candidates(&fitted.sheet, fitted.grid, index, making.opening);
    let with = |count: usize, place: Similarity| {
        fitted_keys(scene, &fitted, held, &pulls(&candidates, count), place)
    };
    let mut tried: Vec<([bool; 4], Pulled, Nearness, SceneConfig)> = Vec::new();
    for count in 1..=MOST_PULLS {
        let pulling = scene.changed(with(count, place_on_pins))?;
        let Some(pulled) = pulled(&pulling, silhouette, place_on_pins) else {
            continue;
        };
        let near = nearness(&pulled.outline, pulled.place);
        // The worst first: cuts close, the outline is far, the sheet jumps, the panels leave their
        // plane.
        let overlaps = pulled.overlap > OVERLAP;
        let is_close = near.error <= CLOSE * pins.error;
        let defects = [overlaps, !is_close, pulled.jumps, !pulled.is_flat()];
        let config = with(count, pulled.place);
        tried.push((defects, pulled, near, config));
        if defects == [false; 4] {
            break;
        }
    }
    // Of those with the same defects the one with the least of the worst; without defects the one
    // with the fewest pulls.
    let best = tried.into_iter().min_by(|one, other| {
        let by_size = match one.0 {
            [true, ..] => one.1.overlap.total_cmp(&other.1.overlap),
            [_, true, ..] => one.2.error.total_cmp(&other.2.error),
            _ => Ordering::Equal,
        };
        one.0.cmp(&other.0).then(by_size)
    });
    let (pulled, stability, mut config) = match best {
        Some((_, pulled, near, config)) => (Some(near), pulled.stability, config),
        None => (None, None, with(1, place_on_pins)),
    };
    let regime = scene.material.regime(scene.config.ligament.start);
    let stays = stability.is_some_and(Stability::is_safe);
    let kind = match regime {
        Regime::Plate if stays => Posture::Lying,
        Regime::Plate | Regime::Film => Posture::HeldFlat,
    };
    config.posture = Some(PostureConfig { kind, down: None });
    Ok(FittedScene {
        config,
        opening: making.opening,
        on_pins: pins,
        missed: missed(silhouette, &on_pins, place_on_pins, REACHED * fitted.longer()),
        rotation: fitted.rotation(),
        pulled,
        stability,
    })
}

/// The numbers of panels of a sheet whose stock is `factor` times as long and as wide, fitted on
/// pins from the rotation of a fit, and how near it comes.
pub fn on_larger_stock(
    scene: &Scene,
    fit_of_stock: &FittedScene,
    factor: f64,
) -> Result<([usize; 2], Nearness), FitError> {
    let making = making(scene);
    let larger = Making { stock: making.stock.map(|side| factor * side), ..making };
    let silhouette = &scene.target.points;
    let fitted = fit(silhouette, &larger, &[fit_of_stock.rotation])?;
    let (outline, place) = fitted.opened(0);
    let nearness = Nearness::new(&outline, &placed(silhouette, place), &fitted);
    Ok(([fitted.grid.m, fitted.grid.n], nearness))
}

impl Nearness {
    fn new(outline: &[[f64; 2]], placed: &[[f64; 2]], fitted: &Fitted) -> Self {
        let error = chamfer(outline, placed, 0.0).0.sqrt();
        Self {
            error,
            relative: error / fitted.longer(),
            overlap: intersection_over_union(outline, placed),
        }
    }
}

impl Fitted {
    /// The longer side of the flat sheet (mm).
    fn longer(&self) -> f64 {
        extent(&self.outline).into_iter().fold(0.0, f64::max)
    }
}

fn placed(silhouette: &[[f64; 2]], place: Similarity) -> Vec<[f64; 2]> {
    let placed = silhouette.iter().map(|p| point(place.of(complex(*p))));
    placed.collect()
}

/// The farthest place of each stretch of a silhouette that is more than `least` (mm) from an
/// outline.
fn missed(
    silhouette: &[[f64; 2]],
    outline: &[[f64; 2]],
    place: Similarity,
    least: f64,
) -> Vec<Missed> {
    let [low, high] = bounds(silhouette.iter().copied());
    let mut missed: Vec<Missed> = Vec::new();
    let mut reached = true;
    for (placed, point) in placed(silhouette, place).into_iter().zip(silhouette) {
        let distance = distance_to_outline(placed, outline);
        let at = [0, 1].map(|c| (point[c] - low[c]) / (high[c] - low[c]));
        if distance > least {
            match missed.last_mut() {
                Some(last) if !reached => {
                    if distance > last.distance {
                        *last = Missed { distance, at };
                    }
                }
                _ => missed.push(Missed { distance, at }),
            }
        }
        reached = distance <= least;
    }
    missed.sort_by(|one, other| other.distance.total_cmp(&one.distance));
    missed
}

/// A sheet under its pulls.
struct Pulled {
    /// The free corners of its outline (mm).
    outline: Vec<[f64; 2]>,
    /// The place of the silhouette on it.
    place: Similarity,
    /// The largest common area of two panels on the way, over the area of a panel.
    overlap: f64,
    /// Whether the load has a maximum on the way.
    jumps: bool,
    /// Whether it stays in its plane by itself; `None` for a film.
    stability: Option<Stability>,
}

impl Pulled {
    /// Whether nothing needs to hold it flat, or always something does.
    fn is_flat(&self) -> bool {
        self.stability.is_none_or(Stability::is_safe)
    }
}

/// The equilibrium of a scene; `None` if none is found.
fn pulled(scene: &Scene, silhouette: &[[f64; 2]], guess: Similarity) -> Option<Pulled> {
    let problem = scene.problem().ok()?;
    problem.model.mechanics()?;
    let deployment = problem.deploy(&scene.start()).ok()?;
    deployment.at_full_load().ok()?;
    let sheet = &deployment.sheet;
    let outline = deployment.outline(&sheet.free_outline_corners());
    let place = place(silhouette, &outline, guess);
    let overlaps = deployment.path.iter().map(|step| overlap(sheet, &step.configuration));
    let overlap = overlaps.fold(0.0, f64::max);
    let mut statuses = deployment.path.iter().map(|step| step.status);
    Some(Pulled {
        outline,
        place,
        overlap,
        jumps: statuses.any(|status| status == Status::LimitPoint),
        stability: Stability::new(scene, &problem, &deployment),
    })
}

/// Width and height of an outline (mm).
fn extent(outline: &Outline) -> [f64; 2] {
    let [low, high] = bounds(outline.corners.iter().copied());
    [0, 1].map(|c| high[c] - low[c])
}

fn making(scene: &Scene) -> Making {
    let config = &scene.config;
    let [w_minus, w_plus] = config.ligament.range;
    let learned = scene.surrogate().map(|surrogate| {
        let w_lig = config.ligament.start / scene.scale();
        let regime = scene.material.regime(config.ligament.start);
        let [least, _] = surrogate.domain().alpha;
        (safe_opening(surrogate, regime, w_lig, MOST), least + INSIDE)
    });
    let (opening, least_angle) = learned.unwrap_or((UNKNOWN, ACUTE));
    Making {
        stock: extent(&config.sheet.outline()),
        opening,
        least_angle,
        widths: WidthChart { w_minus, w_plus },
        options: scene.sheet_options(),
    }
}

/// The keys of the scene with the fitted sheet, its supports, its pulls and the place of its
/// target.
fn fitted_keys(
    scene: &Scene,
    fitted: &Fitted,
    held: [usize; 2],
    pulls: &[Pull],
    place: Similarity,
) -> SceneConfig {
    let mut config = scene.config.clone();
    config.sheet.size = None;
    config.sheet.corners = Some(fitted.outline.corners.map(|corner| corner.map(rounded)));
    config.sheet.panels = [fitted.grid.m, fitted.grid.n];
    // For the first equilibrium: in a hanging sheet the weight would act.
    config.posture = Some(PostureConfig { kind: Posture::HeldFlat, down: None });
    let regime = scene.material.regime(config.ligament.start);
    config.start = StartConfig::at(&fitted.pattern, widths(scene, fitted, regime));
    config.clear_actuation();
    config.supports = vec![SupportConfig::at_centroid(held, SupportKind::Clamp)];
    let length = |pull: &Pull| complex(pull.displacement).norm();
    let load = |pull: &Pull| {
        let direction = pull.displacement.map(|x| rounded(x / length(pull)));
        LoadConfig::at_centroid(pull.panel, direction)
    };
    config.loads = pulls.iter().map(load).collect();
    config.drive = Some(DriveConfig {
        stroke: rounded(pulls.iter().map(length).sum::<f64>() / pulls.len() as f64),
    });
    // Relative to the mean area of a panel.
    config.objective.symmetric_difference = DIFFERENCE * fitted.grid.panel_count() as f64;
    if scene.surrogate().is_some() {
        config.objective.damage = DAMAGE;
        config.objective.damage_measure = DamageMeasure::Peak;
        config.objective.domain = DOMAIN;
    }
    config.optimiser = OptimiserConfig {
        steps: STEPS,
        learning_rate: FIRST_STEP,
        method: SearchMethod::Lbfgs,
        ..config.optimiser
    };
    config.target = config.target.placed(&place, &scene.target.points);
    config
}

/// The widths of the ligaments at the start (mm). The ligament of a plate turns about its middle,
/// w_lig / (2 sin alpha) from the corner of its void along the main cut: if this distance is the
/// same at every hinge, the voids remain parallelograms, and the sheet opens like that on pins.
fn widths(scene: &Scene, fitted: &Fitted, regime: Regime) -> Vec<f64> {
    let LigamentConfig { start, range } = scene.config.ligament;
    let [narrowest, widest] = [1.01 * range[0], 0.99 * range[1]];
    let width = |alpha: f64| match regime {
        Regime::Film => start,
        Regime::Plate => rounded(start * alpha.sin()).clamp(narrowest, widest),
    };
    let hinges = fitted.sheet.hinges.iter();
    hinges.map(|hinge| width(hinge.alpha)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_beyond_the_outline_is_missed_once_where_it_is_farthest() {
        let outline = [[0.0, 0.0], [40.0, 0.0], [40.0, 30.0], [0.0, 30.0]];
        // The rectangle, with a spike at its top and a notch at its right.
        let silhouette = [
            [0.0, 0.0],
            [40.0, 0.0],
            [40.0, 10.0],
            [35.0, 15.0],
            [40.0, 20.0],
            [40.0, 30.0],
            [22.0, 30.0],
            [21.0, 40.0],
            [20.0, 50.0],
            [19.0, 40.0],
            [18.0, 30.0],
            [0.0, 30.0],
        ];
        let here = Similarity { turn: complex([1.0, 0.0]), shift: complex([0.0; 2]) };
        let missed = missed(&silhouette, &outline, here, 4.0);
        let expected = [(20.0, [0.5, 1.0]), (5.0, [0.875, 0.3])];
        assert_eq!(missed, expected.map(|(distance, at)| Missed { distance, at }));
    }
}
