//! The facts of a run: what the sheet is made of, how far it opens under which load, what the hinge
//! law rests on.

use crate::report::creep_and_springback::CreepAndSpringback;
use crate::report::hinge_row::HingeRow;
use crate::report::numbers::rounded;
use crate::report::self_weight::SelfWeight;
use design::equilibrium::load_step::Status;
use design::geometry::polygon::{area, bounds};
use design::objective::design_problem::{Deployment, DesignProblem};
use design::sheet::cut_sheet::AttachmentPoint;
use design::sheet::kinematics::deployed_corners;
use analysis::actuation_curve::{ActuationCurve, LimitPoint, LoadPeak, Mover};
use scene::{Level, Scene, panel_name};
use serde::Serialize;
use surrogate::TestErrors;

/// Facts of the best design of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FactSheet {
    /// Version of the program.
    pub version: &'static str,
    /// How much of the hinges is modelled.
    pub level: Level,
    /// Whether the hinges carry load.
    #[serde(skip)]
    carries_load: bool,
    /// What holds and pulls panels, where in the flat sheet (mm).
    pub attachments: Vec<String>,
    /// Whether the hinge law has a training domain.
    #[serde(skip)]
    pub has_domain: bool,
    /// Name of the material.
    pub material: String,
    /// Thickness of the sheet (mm).
    pub thickness: f64,
    /// Mass of the uncut sheet (kg).
    pub mass_kg: f64,
    /// The weight of the uncut sheet and how it acts.
    pub self_weight: SelfWeight,
    /// Creep and springback; `None` if the hinges carry no load.
    pub creep_and_springback: Option<CreepAndSpringback>,
    /// [columns, rows]
    pub panels: [usize; 2],
    /// Extent of the flat sheet along x and y (mm).
    pub flat_size: [f64; 2],
    /// Extent of the deployed sheet along x and y with all panels in the plane (mm).
    pub deployed_size: [f64; 2],
    /// Load and stroke at the end of the path; `None` without equilibrium, or if nothing moves the
    /// sheet.
    pub reached: Option<Reached>,
    /// Minimum of Gamma (21) over the hinges; `None` for a sheet that does not lie on a surface.
    pub gamma_min: Option<f64>,
    /// Fraction of the hinge states of the path that are inside the training domain of the hinge
    /// law.
    pub share_inside: f64,
    /// The weights that the hinge law reads.
    pub weights: Option<WeightFacts>,
    /// BLAKE3 hash of the keys of the scene, without title and run folder.
    pub scene_hash: String,
    /// BLAKE3 hash of the material law.
    pub material_hash: String,
    /// BLAKE3 hash of the points of the target.
    pub target_hash: String,
}

/// The end of an equilibrium path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reached {
    /// What moves the sheet, and what its displacement means.
    pub stroke_of: String,
    /// Load factor zeta.
    pub load_factor: f64,
    /// Whether the path ends there because no further equilibrium was found.
    pub ended_early: bool,
    /// Displacement, in the first of `units`.
    pub displacement: f64,
    /// Load, in the second of `units`.
    pub load: f64,
    /// Units of displacement and load.
    pub units: [&'static str; 2],
    /// The maximum of the load along the path; `None` under dead loads, whose maximum is the load
    /// at the end.
    pub peak: Option<LoadPeak>,
    /// The maxima and minima of the load on the way; empty under dead loads, or if the sheet jumps.
    pub limit_points: Vec<LimitPoint>,
    /// Increment of the load for an increment of the displacement; `None` if supports move the
    /// sheet, or if the tangent is singular.
    pub stiffness: Option<f64>,
}

/// Provenance and test errors of weights.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WeightFacts {
    /// Name of the file.
    pub file: String,
    /// Hash of everything that the predictions depend on.
    pub hash: String,
    /// Mesh tier of the training rays.
    pub tier: String,
    /// Number of training rays, if known.
    pub training_rays: Option<usize>,
    /// Number of rows, not used in training, on which the errors were measured.
    pub test_rows: usize,
    /// Relative root mean square errors (%): W, F_a, F_s, M_theta, D and, if it is predicted,
    /// D_peak.
    pub errors_percent: Vec<f64>,
    /// The spot check of the weights, if there was one.
    pub spot_check: Option<SpotCheckFacts>,
}

/// Errors of weights at random states that no training has seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpotCheckFacts {
    /// Number of states.
    pub states: usize,
    /// Number of states inside the training domain.
    pub inside: usize,
    /// As [`WeightFacts::errors_percent`], at all states.
    pub errors_percent: Vec<f64>,
}

impl FactSheet {
    pub(super) fn new(
        scene: &Scene,
        problem: &DesignProblem,
        deployment: &Deployment,
        hinges: &[HingeRow],
    ) -> Self {
        let material = &scene.material;
        let flat = &deployment.sheet.outline.corners;
        let corners = deployed_corners(&deployment.sheet, &deployment.final_step().configuration);
        let mass_kg = material.mass_by_area() * area(flat).abs();
        let reached = Reached::new(scene, problem, deployment);
        Self {
            version: env!("CARGO_PKG_VERSION"),
            level: scene.config.level,
            carries_load: scene.hinge.carries_load(),
            attachments: attachments(scene, deployment),
            has_domain: scene.surrogate().is_some(),
            material: material.name.clone(),
            thickness: material.thickness,
            mass_kg,
            self_weight: SelfWeight::new(scene, mass_kg, reached.as_ref().and_then(Reached::force)),
            creep_and_springback: CreepAndSpringback::new(scene, problem, deployment),
            panels: scene.config.sheet.panels,
            flat_size: extent(flat.iter().copied()),
            deployed_size: extent(corners.into_iter().flatten()),
            reached,
            gamma_min: (hinges.iter()).filter_map(|row| row.gamma).min_by(f64::total_cmp),
            share_inside: deployment.share_inside(),
            weights: WeightFacts::new(scene),
            scene_hash: scene.hash(),
            material_hash: material.law_hash(),
            target_hash: scene.target.hash(),
        }
    }

    /// Longer side of the flat sheet (mm), by which distances are measured.
    pub(super) fn longer_side(&self) -> f64 {
        let [width, height] = self.flat_size;
        width.max(height)
    }

    /// The facts as names and values with units.
    pub fn rows(&self) -> Vec<(&'static str, String)> {
        let size = |[x, y]: [f64; 2]| format!("{} x {} mm", rounded(x, 5), rounded(y, 5));
        let [columns, rows] = self.panels;
        let short = |hash: &str| hash.chars().take(16).collect::<String>();
        let mut facts = vec![
            ("material", format!("{}, {} mm thick", self.material, rounded(self.thickness, 4))),
            ("mass", format!("{} kg, uncut", rounded(self.mass_kg, 4))),
            ("panels", format!("{columns} x {rows}")),
            ("flat size", size(self.flat_size)),
            ("deployed size", size(self.deployed_size) + ", panels in the plane"),
            ("level", format!("{}, {}", self.level, self.level.hinges())),
        ];
        if let Some(reached) = &self.reached {
            facts.extend(reached.rows());
        }
        if self.carries_load {
            facts.extend(self.attachments.iter().map(|text| ("attachment", text.clone())));
            facts.extend(self.self_weight.rows());
        }
        facts.extend(self.creep_and_springback.iter().flat_map(CreepAndSpringback::rows));
        if let Some(gamma) = self.gamma_min {
            let gamma = rounded(gamma, 4);
            facts.push(("minimum Gamma", format!("{gamma}, for a sheet that lies on a surface")));
        }
        if let Some(weights) = &self.weights {
            let inside = rounded(100.0 * self.share_inside, 4);
            if self.has_domain {
                facts.push(("inside domain", format!("{inside} % of the hinge states")));
            }
            facts.extend(weights.rows());
            facts.push(("hash of weights", short(&weights.hash)));
        }
        facts.push(("hash of scene", short(&self.scene_hash)));
        facts.push(("hash of material", short(&self.material_hash)));
        facts.push(("hash of target", short(&self.target_hash)));
        facts.push(("kirigami", self.version.to_owned()));
        facts
    }
}

impl Reached {
    fn new(scene: &Scene, problem: &DesignProblem, deployment: &Deployment) -> Option<Self> {
        let mechanics = problem.model.mechanics()?;
        let curve = ActuationCurve::new(mechanics, deployment)?;
        let [displacement, load] = *curve.points.last()?;
        let last = deployment.final_step();
        let by_loads = last.stiffness(&mechanics.solver).filter(|_| curve.mover == Mover::Loads);
        let resolved = (curve.is_prescribed(mechanics))
            .then(|| ActuationCurve::resolved(mechanics, &deployment.sheet))
            .flatten();
        Some(Self {
            stroke_of: if scene.weight_by_area() == [0.0; 2] {
                stroke_of(scene, &curve)
            } else {
                stroke_of(scene, &curve) + ", from the flat sheet before its weight came on"
            },
            load_factor: last.load_factor,
            ended_early: last.status == Status::Diverged,
            displacement,
            load,
            units: curve.units(),
            peak: resolved.as_ref().map(ActuationCurve::peak),
            // Beyond a jump the curve is another branch.
            limit_points: resolved
                .filter(|_| deployment.path.iter().all(|step| step.jumps == 0))
                .map_or_else(Vec::new, |curve| curve.limit_points()),
            stiffness: by_loads,
        })
    }

    /// The load, if it is a force (N).
    fn force(&self) -> Option<f64> {
        (self.units[1] == "N").then_some(self.load)
    }

    fn rows(&self) -> Vec<(&'static str, String)> {
        let [length, force] = self.units;
        let end = if self.ended_early { ", where the path ends early" } else { "" };
        let mut rows = vec![(
            "load reached",
            format!(
                "{} {force}, load factor {}{end}",
                rounded(self.load, 4),
                rounded(self.load_factor, 4)
            ),
        )];
        if let Some(peak) = &self.peak {
            let [load, stroke] = [peak.load, peak.displacement].map(|value| rounded(value, 4));
            let text = format!("{load} {force} at a stroke of {stroke} {length}");
            rows.push(("largest load", text));
        }
        if !self.limit_points.is_empty() {
            rows.push(("stable parts", self.stable_parts()));
        }
        let stroke = rounded(self.displacement, 4);
        let text = format!("{stroke} {length}, {}", self.stroke_of);
        rows.push(("stroke reached", text));
        if let Some(stiffness) = self.stiffness {
            let stiffness = rounded(stiffness, 4);
            let text = format!("{stiffness} {force}/{length} at the end of the path");
            rows.push(("stiffness", text));
        }
        rows
    }
}

impl Reached {
    /// The parts of the stroke in which the load rises, so that a dead load holds the sheet there.
    fn stable_parts(&self) -> String {
        let [length, force] = self.units;
        let mut parts = Vec::new();
        let mut from = Some("0".to_owned());
        for point in &self.limit_points {
            let [at, load] = [point.displacement, point.load].map(|value| rounded(value, 4));
            match from.take() {
                Some(from) if point.is_maximum => {
                    parts.push(format!("{from} to {at} {length} (up to {load} {force})"));
                }
                _ => from = Some(at),
            }
        }
        if let Some(from) = from {
            let end = rounded(self.displacement, 4);
            parts.push(format!("{from} to {end} {length}"));
        }
        format!("a dead load holds the sheet at strokes of {}", parts.join(", "))
    }
}

impl WeightFacts {
    fn new(scene: &Scene) -> Option<Self> {
        let surrogate = scene.weights()?;
        let files = scene.config.weights_files();
        let card = surrogate.card();
        let predicted = if card.peak_scale.is_some() { 6 } else { 5 };
        let errors = |of: &TestErrors| of.percents()[..predicted].to_vec();
        Some(Self {
            file: (files.first().and_then(|path| path.file_name()))
                .map_or(String::new(), |name| name.to_string_lossy().into_owned()),
            hash: surrogate.hash(),
            tier: card.tier.clone(),
            training_rays: card.training_rays,
            test_rows: card.test_errors.rows,
            errors_percent: errors(&card.test_errors),
            spot_check: card.spot_check.as_ref().map(|check| SpotCheckFacts {
                states: check.errors.rows,
                inside: check.inside,
                errors_percent: errors(&check.errors),
            }),
        })
    }

    fn rows(&self) -> Vec<(&'static str, String)> {
        let rays =
            self.training_rays.map_or("an unknown number of".to_owned(), |rays| rays.to_string());
        let trained = format!("{}, trained on {rays} rays of the mesh `{}`", self.file, self.tier);
        let test_errors = errors(&self.errors_percent, self.test_rows, "unseen");
        let mut rows = vec![("weights", trained), ("test errors", test_errors)];
        if let Some(check) = &self.spot_check {
            let text = errors(&check.errors_percent, check.states, "random");
            let inside = format!(", {} of them inside the domain", check.inside);
            rows.push(("spot check", text + &inside));
        }
        rows
    }
}

/// Errors of W, F_a, F_s, M_theta, D and D_peak as one line.
fn errors(percents: &[f64], states: usize, kind: &str) -> String {
    let names = ["W", "F_a", "F_s", "M_theta", "D", "D_peak"];
    let errors: Vec<String> = std::iter::zip(names, percents)
        .map(|(name, error)| {
            if error.is_nan() {
                format!("{name} -")
            } else {
                format!("{name} {}", rounded(*error, 3))
            }
        })
        .collect();
    format!("{} % (rms, {states} {kind} states)", errors.join(", "))
}

/// Every support and every load of a single panel, with its place in the flat sheet.
fn attachments(scene: &Scene, deployment: &Deployment) -> Vec<String> {
    let attachments = scene.actuation().attachments.into_iter();
    let text = |attachment: AttachmentPoint| {
        let panel = &deployment.sheet.panels[attachment.panel];
        let [x, y] = panel.position(attachment.point).map(|x| rounded(x, 5));
        let size = |what: &str, size: Option<f64>| {
            size.map_or(String::new(), |size| format!(", {what} {} mm", rounded(size, 4)))
        };
        let (hole, clip) = (size("hole", attachment.hole), size("clip", attachment.clip));
        format!("{}, at ({x}, {y}) mm{hole}{clip}", attachment.name)
    };
    attachments.map(text).collect()
}

/// What moves the sheet, and what its displacement means.
fn stroke_of(scene: &Scene, curve: &ActuationCurve) -> String {
    let [way, load] =
        if curve.translational { ["displacement", "force"] } else { ["rotation", "couple"] };
    if curve.mover == Mover::Supports {
        return format!("{way} of the moved supports");
    }
    let place = match (scene.actuation().loads.as_slice(), &*scene.config.loads) {
        ([only], [load]) => only.place.zip(Some(load.at)),
        _ => None,
    };
    match place {
        Some((panel, at)) => {
            let panel = panel_name(scene.grid(), panel);
            format!("{way} of {at}{panel} along its {load}")
        }
        None => format!("mean {way} along the loads, weighted by their {load}s"),
    }
}

/// The distance of the outline of a sheet of some flat size to its target (mm), in words.
pub(crate) fn miss(outline_error: f64, [width, height]: [f64; 2]) -> String {
    format!(
        "the outline is {} mm (root mean square) from the target, {} % of the longer side of the flat sheet",
        rounded(outline_error, 3),
        rounded(100.0 * outline_error / width.max(height), 2)
    )
}

pub(crate) fn extent(points: impl IntoIterator<Item = [f64; 2]>) -> [f64; 2] {
    let [low, high] = bounds(points);
    [high[0] - low[0], high[1] - low[1]]
}
