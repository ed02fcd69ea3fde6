//! A coupon: specimens of three ligament widths and two angles that are cut from the plate of a sheet before the sheet itself, and
//! the weights that open them.
//!
//! The heaviest weight of a specimen is the largest under which it, and a specimen that is softer by what is not known before
//! ([`Quantity::guess`]), stays on its path, inside the training domain of its hinges and below tearing. The others open it by equal
//! parts of the displacement under that one.

use crate::analysis::calibration::Quantity;
use crate::analysis::coupon_scene::{HOOK_HOLE, Shape, hooks};
use crate::analysis::measurements::{LoadData, Measurements};
use crate::analysis::real_sheet::RealSheet;
use crate::analysis::simulated_measurements::{StandardErrors, equal_parts};
use crate::equilibrium::load_step::{LoadStep, Status};
use crate::geometry::polygon::distance;
use crate::hinge_law::DamageMeasure;
use crate::objective::design_problem::{DesignError, DesignProblem};
use crate::scene::{Scene, SceneError};
use crate::sheet::deviation::Deviation;
use hinge::Regime;
use std::path::Path;

/// Number of weights of a specimen.
const WEIGHTS: usize = 5;
/// Angles of the corner of a specimen (deg), a letter each.
const CORNERS: [(char, f64); 2] = [('A', 90.0), ('B', 60.0)];
/// Number of ligament widths.
const WIDTHS: usize = 3;
/// Number of specimens.
pub const SPECIMENS: usize = WIDTHS * CORNERS.len();
/// The largest opening of a hinge that is planned, for a specimen or a first sheet (rad): 25 degrees.
pub const OPENING: f64 = 0.436;
/// The largest D_peak of a softer specimen: at 1 a ligament tears.
const SAFE: f64 = 0.8;
/// Largest displacement of a cut specimen over the largest that is planned: beyond it no weight is added.
const STOP: f64 = 1.25;
/// The narrowest and the widest ligaments are off the ends of the range of the sheet by this part of the range.
const OFF_ENDS: f64 = 0.05;
/// The first weight that is tried (g).
const FIRST: f64 = 100.0;
/// Number of equilibria on the way to a weight.
const STEPS: u32 = 40;
/// Maximum number of weights that are tried: the first one times 2^24 is more than a scene takes.
const MOST_TRIALS: usize = 24;

/// Why a coupon is not written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum CouponError {
    #[error(
        "a coupon is for a learned hinge law: set hinge = \"surrogate\" with the weights of the material"
    )]
    NoLearnedLaw,
    #[error(
        "the ligaments of this scene, up to {width} mm in a sheet of {thickness} mm, are those of a film: they buckle and fold, and a hung \
         specimen leaves its plane, which the model does not. Coupons are for plates, whose ligaments are narrower than they are thick. \
         Calibrate a film on the sheet itself, held flat: kirigami calibrate RUN --points FILE"
    )]
    Film { width: f64, thickness: f64 },
    #[error("no weight opens specimen {0} on a path that is known")]
    NoWeight(String),
    #[error("cannot find the files of the scene: {0}")]
    Paths(#[from] std::io::Error),
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Design(#[from] DesignError),
}

/// A specimen with its weights.
pub struct Specimen {
    /// Its name: a letter for the angle and a number, from 1, for the width.
    pub name: String,
    /// The number in its name.
    pub number: usize,
    /// Angle of its lower left corner (deg).
    pub corner_deg: f64,
    /// What is hung from it.
    pub loaded: Loaded,
}

/// A specimen under its weights.
pub struct Loaded {
    /// Its scene, under its heaviest weight.
    pub scene: Scene,
    /// Masses to hang (g), ascending.
    pub masses_g: Vec<f64>,
    /// Predicted distance between the facing edges of the holes of the hooks before the weights (mm).
    pub distance: f64,
    /// Predicted displacement under each mass (mm), by which the distance grows.
    pub displacements: Vec<f64>,
    /// Predicted opening of the hinges under the heaviest weight (rad), root mean square.
    pub opening: f64,
}

/// The specimens of the coupon of a sheet, with scenes in `folder`; `progress` is called with the number of those that are planned.
pub fn specimens(
    scene: &Scene,
    folder: &Path,
    progress: &mut dyn FnMut(usize),
) -> Result<Vec<Specimen>, CouponError> {
    if scene.surrogate().is_none() {
        return Err(CouponError::NoLearnedLaw);
    }
    let [narrowest, widest] = scene.config.ligament.range;
    if scene.material.regime(widest) == Regime::Film {
        let thickness = scene.material.thickness;
        return Err(CouponError::Film {
            width: widest,
            thickness,
        });
    }
    let off = OFF_ENDS * (widest - narrowest);
    let (narrow, wide) = (narrowest + off, widest - off);
    let widths: [f64; WIDTHS] = [narrow, (narrow * wide).sqrt(), wide];
    let mut found = Vec::new();
    for (letter, corner_deg) in CORNERS {
        for (width, number) in widths.iter().zip(1..) {
            let width = (1e2 * width).round() / 1e2;
            let name = format!("{letter}{number}");
            let config = Shape { width, corner_deg }.scene(scene, &name)?;
            let blank = Scene::new(config, &folder.join(format!("{name}.toml")))?;
            let loaded = Loaded::new(&blank)?.ok_or_else(|| CouponError::NoWeight(name.clone()))?;
            found.push(Specimen {
                name,
                number,
                corner_deg,
                loaded,
            });
            progress(found.len());
        }
    }
    Ok(found)
}

impl Loaded {
    /// `None` if no weight can be used.
    fn new(blank: &Scene) -> Result<Option<Self>, CouponError> {
        let Some(heaviest) = heaviest(blank)? else {
            return Ok(None);
        };
        let scene = under(blank, heaviest)?;
        let problem = scene.problem()?;
        let sheet = RealSheet::new(&scene, &problem, &scene.start())?;
        let curve = |parts: &[f64]| -> Result<Vec<[f64; 2]>, CouponError> {
            let curve = sheet.reading_plan(parts)?.drawn;
            Ok(curve.map_or(Vec::new(), |curve| curve.from_before_loads().collect()))
        };
        let mut masses_g = evenly_opening(&curve(&equal_parts(STEPS))?, heaviest);
        masses_g.push(heaviest);
        let parts: Vec<f64> = masses_g.iter().map(|mass| mass / heaviest).collect();
        let between = hooks(&scene.config).map_or(0.0, |[held, pulled]| distance(held, pulled));
        Ok(Some(Self {
            distance: between - HOOK_HOLE,
            displacements: curve(&parts)?.iter().map(|[moved, _]| *moved).collect(),
            masses_g,
            opening: sheet.designed().final_step().opening(),
            scene: scene.clone(),
        }))
    }

    /// The largest displacement up to which weights are added, for any plate (mm).
    pub fn stop(&self) -> f64 {
        STOP * self.displacements.last().copied().unwrap_or(0.0)
    }

    /// Exact distances of a cut specimen before its weights and under those that it bears, `sheet` being its drawing; their standard
    /// error is relative to the largest. `None` if it bears none.
    pub fn exact(&self, sheet: &RealSheet, cut: &Deviation, error: f64) -> Option<Measurements> {
        let heaviest = self.masses_g.last()?;
        let parts: Vec<f64> = self.masses_g.iter().map(|mass| mass / heaviest).collect();
        let errors = StandardErrors {
            point: 1.0,
            reading: error,
        };
        let under = |count: usize| -> Option<LoadData> {
            let read = Measurements::exact(sheet, cut, &parts[..count], errors).ok()?;
            let loads = read.loads?;
            let [moved, _] = *loads.readings.last()?;
            (moved <= self.stop()).then_some(loads)
        };
        let loads = (1..=parts.len()).rev().find_map(under)?;
        Some(Measurements {
            points: None,
            loads: Some(LoadData {
                from_reading: true,
                ..loads
            }),
        })
    }
}

/// The masses (g) but the heaviest that open a specimen by equal parts of the displacement at the end of its curve.
fn evenly_opening(curve: &[[f64; 2]], heaviest: f64) -> Vec<f64> {
    let [end, full] = curve[curve.len() - 1];
    let mut masses: Vec<f64> = (1..WEIGHTS)
        .map(|i| {
            let displacement = end * i as f64 / WEIGHTS as f64;
            let next = (curve.iter()).position(|[moved, _]| *moved >= displacement);
            let next = next.unwrap_or(curve.len() - 1);
            let before = next.checked_sub(1).map_or([0.0; 2], |before| curve[before]);
            let [moved, load] = curve[next];
            let part = (displacement - before[0]) / (moved - before[0]);
            handy(heaviest * (before[1] + part * (load - before[1])) / full)
        })
        .filter(|mass| *mass < heaviest)
        .collect();
    masses.dedup();
    masses
}

/// The heaviest mass of a specimen (g); `None` if there is none.
fn heaviest(blank: &Scene) -> Result<Option<f64>, CouponError> {
    let mut mass = FIRST;
    for _ in 0..MOST_TRIALS {
        let scene = under(blank, mass)?;
        match usable(&scene, &scene.problem()?)? {
            STEPS => mass *= 2.0,
            // Too coarse to say.
            steps if steps < STEPS / 4 => mass *= 0.25,
            steps => return Ok(Some(handy(mass * f64::from(steps) / f64::from(STEPS)))),
        }
    }
    Ok(None)
}

/// The specimen under a mass (g).
fn under(blank: &Scene, mass: f64) -> Result<Scene, SceneError> {
    let mut config = blank.config.clone();
    for load in &mut config.loads {
        load.mass_g = Some(mass);
    }
    blank.changed(config)
}

/// Number of the first of [`STEPS`] states on the way to full load up to which the specimen and a softer one can be used.
fn usable(scene: &Scene, problem: &DesignProblem) -> Result<u32, DesignError> {
    let thickness = scene.material.thickness;
    let mechanics = problem.model.mechanics().ok_or(DesignError::NoMechanics)?;
    let drawn = problem.deploy(&scene.start())?.sheet;
    let softer = Deviation {
        kerf: Quantity::Kerf.guess(thickness),
        stress: -Quantity::Stress.guess(thickness),
        ..Deviation::default()
    };
    let parts = equal_parts(STEPS);
    let usable = |deviation: &Deviation, opening: f64| -> Result<u32, DesignError> {
        let sheet = drawn.clone().with_deviation(deviation);
        let sheet = sheet.ok_or(DesignError::ImpossibleSheet)?;
        let mechanics = mechanics.as_cut(deviation, thickness)?;
        let prepared = mechanics.law.prepare(&sheet.designs());
        let hinged = mechanics.hinged(&sheet, &*prepared, false);
        let steps = mechanics.solver.readings(hinged, &parts);
        let good = |step: &&LoadStep| is_safe(step) && step.opening() <= opening;
        Ok(steps
            .iter()
            .take_while(good)
            .zip(1..)
            .map(|(_, step)| step)
            .last()
            .unwrap_or(0))
    };
    let [own, soft] = [
        usable(&Deviation::default(), OPENING)?,
        usable(&softer, f64::INFINITY)?,
    ];
    Ok(own.min(soft))
}

/// Whether a state is on the path from the flat sheet, where the hinge law is known and no ligament tears.
fn is_safe(step: &LoadStep) -> bool {
    let peak = |damage| DamageMeasure::Peak.known(damage).unwrap_or(0.0);
    step.status == Status::Converged
        && step.jumps == 0
        && step.inside.iter().all(|inside| *inside)
        && step.damage.iter().all(|damage| peak(damage) <= SAFE)
}

/// A mass (g) rounded down to a twentieth of its power of ten: 430 and 435 g, 1250 and 1300 g.
fn handy(mass: f64) -> f64 {
    let unit = 0.05 * 10f64.powf(mass.log10().floor());
    ((mass / unit + 1e-9).floor() * unit * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_open_by_equal_parts_and_ascend() {
        let curve: Vec<[f64; 2]> = (1..=40)
            .map(|i| f64::from(i) / 40.0)
            .map(|part| [10.0 * part * part, 8.0 * part])
            .collect();
        let masses = evenly_opening(&curve, 1000.0);
        // sqrt(0.2), sqrt(0.4), sqrt(0.6), sqrt(0.8)
        assert_eq!(masses, [445.0, 630.0, 770.0, 890.0]);
    }

    #[test]
    fn masses_are_rounded_down() {
        for (mass, rounded) in [(1276.0, 1250.0), (999.0, 995.0), (12.0, 12.0), (4.57, 4.55)] {
            assert_eq!(handy(mass), rounded);
        }
    }
}
