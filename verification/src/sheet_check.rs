//! A whole sheet by finite elements compared with the deployment that the hinge law predicts.

use crate::patch::SheetPart;
use crate::verification_error::VerificationError;
use crate::whole_sheet::{sheet_problem, with_support};
use analysis::actuation_curve::ActuationCurve;
use analysis::design_checks::WholeSheet;
use analysis::flanks::flank_gap;
use analysis::flatness::Flatness;
use analysis::out_of_plane::{OutOfPlane, out_of_plane};
use design::geometry::polygon::distance;
use design::hinge_law::{DamageMeasure, Order};
use design::objective::design_problem::{Deployment, DesignProblem};
use design::pattern::design_vector::DesignVector;
use design::sheet::cut_sheet::Panel;
use design::sheet::kinematics::{Configuration, deployed_corners, hinge_deformations};
use fe_driver::{PanelState, SheetSolve, SheetState, SheetSurface, Solved, ToolVersions};
use hinge::HingeDesign;
use mesher::Tier;
use scene::{Posture, Scene};
use serde::Serialize;
use support::severity::{Finding, Severity};
use support::statistics::rms_and_maximum;

/// Difference of the loads over the load by finite elements above which a finding names it.
const OTHER_LOAD: f64 = 0.05;
/// Kinetic over internal energy up to which a dynamic path is nearly at rest.
const AT_REST: f64 = 0.02;

/// Overlap of flanks from which a finding names it (mm).
const FLANKS_TOUCH: f64 = 0.1;
/// Tilt of a panel up to which its flanks are measured in the plane (rad).
const UPRIGHT: f64 = 0.02;

/// A deployed sheet that finite elements solve as a whole.
pub struct SheetTask {
    /// The scene with the support under which it is solved.
    scene: Scene,
    problem: DesignProblem,
    /// Its deployment by the hinge law.
    deployment: Deployment,
    /// What keeps the panels in their plane.
    support: Posture,
    tier: Tier,
    /// Whether the flanks of its cuts touch; `false` unless set.
    pub contact: bool,
    /// The panels and hinges that are solved.
    part: SheetPart,
    /// Displacement and load by the law, before the loads and at every load step.
    curve: Vec<[f64; 2]>,
    /// The plate out of its plane by the law at every load step; `None` for a patch, and where the
    /// law has none.
    out_of_plane: Option<Vec<OutOfPlane>>,
}

/// The result of a task.
#[derive(Debug, Serialize)]
pub struct SheetCheck {
    /// The design that is checked, for a person.
    pub design: String,
    /// What keeps the panels in their plane.
    pub support: Posture,
    /// Mesh tier of the windows.
    pub tier: Tier,
    /// Numbers of panels and of hinges that were solved.
    pub counts: [usize; 2],
    /// Whether the sheet has others, which move as the hinge law predicts.
    pub is_patch: bool,
    /// Whether flanks of cuts touch.
    pub contact: bool,
    /// Longer side of the flat sheet (mm).
    pub size: f64,
    /// Smallest radius of a window in the mesh, and the radius of the windows of the hinge law
    /// (mm).
    pub radius: [f64; 2],
    /// Smallest and largest ligament width over the thickness.
    pub slenderness: [f64; 2],
    /// The hinges that leave the training domain of the law on its path.
    pub outside: Vec<usize>,
    /// Whether the stroke is prescribed; otherwise loads are.
    pub driven: bool,
    /// What a person should know.
    pub findings: Vec<Finding>,
    /// Why the path was not followed to its end; `None` if it was.
    pub stopped: Option<String>,
    /// Whether inertia was needed to follow it.
    pub dynamic: bool,
    /// Number of unknowns of the mesh.
    pub unknowns: usize,
    /// CPU time of all attempts (s).
    pub cpu_seconds: f64,
    /// Memory of the solver (MiB), if it is known.
    pub memory_mib: Option<f64>,
    /// The states along the path.
    pub path: Vec<StateCheck>,
    /// The hinges at its end.
    pub hinges: Vec<HingeCheck>,
    /// The panels at its end.
    pub panels: Vec<PanelCheck>,
    /// Internal energy of the panels outside of the windows over the whole internal energy (1) at
    /// its end.
    pub panel_energy: f64,
    /// The middle surface at its end.
    #[serde(skip)]
    pub surface: SheetSurface,
}

/// A state of a path. Pairs are by the hinge law and by finite elements.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StateCheck {
    /// Fraction of the stroke or of the loads.
    pub fraction: f64,
    /// Stroke of the loads (mm); `None` for a patch.
    pub stroke: Option<[f64; 2]>,
    /// Load (N); `None` for a patch.
    pub load: Option<[f64; 2]>,
    /// Distance of the panel corners in space (mm): root mean square and maximum.
    pub corners: [f64; 2],
    /// Mean rotation of the hinges (deg).
    pub opening_deg: [f64; 2],
    /// Largest tilt of a panel (deg).
    pub tilt_deg: f64,
    /// The largest tilt by the hinge law and the bumps of the ligaments; `None` where there is no
    /// margin, and from a margin of 1 on.
    pub tilt_by_law_deg: Option<f64>,
    /// Lowest and highest point of the panels (mm).
    pub z: [f64; 2],
    /// Largest bending of a panel (mm).
    pub bending: f64,
    /// Kinetic over internal energy; zero on a static path.
    pub kinetic: f64,
    /// Distance of the flanks of a cut where they come nearest (mm), negative where they pass
    /// through each other; `None` for a patch, and where panels tilt, whose flanks pass each other
    /// in space.
    pub flank_gap: Option<f64>,
    /// The margin against leaving the plane by the hinge law, at its next load step; `None` for a
    /// patch, and where the law has none.
    pub margin: Option<f64>,
}

/// A hinge at the end of a path. Pairs are by the hinge law and by finite elements.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HingeCheck {
    /// Number of the hinge.
    pub hinge: usize,
    /// Ligament width (mm).
    pub w_lig: f64,
    /// Rotation (deg).
    pub theta_deg: [f64; 2],
    /// Energy (N mm).
    pub energy: [f64; 2],
    /// D_peak; by the law `None` if it is not known.
    pub d_peak: [Option<f64>; 2],
}

/// A panel at the end of a path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PanelCheck {
    /// Number of the panel.
    pub panel: usize,
    /// Tilt (deg).
    pub tilt_deg: f64,
    /// Largest distance of a corner from where the law has it (mm).
    pub off: f64,
    /// Lowest and highest point (mm).
    pub z: [f64; 2],
    /// Largest bending (mm).
    pub bending: f64,
}

impl SheetTask {
    /// The design of a scene, kept in its plane as `support` says, or as its posture does. Of a
    /// `patch`, the panel [column, row] and those around it are solved.
    pub fn new(
        scene: &Scene,
        design: &DesignVector,
        support: Option<Posture>,
        tier: Tier,
        patch: Option<[usize; 2]>,
    ) -> Result<Self, VerificationError> {
        let scene = with_support(scene, support)?;
        let posture = scene.config.posture.map(|posture| posture.kind);
        let problem = scene.problem()?;
        let mechanics = (problem.model.mechanics()).ok_or(VerificationError::NoLoads)?;
        let deployment = problem.deploy(design)?;
        deployment.at_full_load()?;
        let curve = ActuationCurve::new(mechanics, &deployment);
        let curve = curve.ok_or(VerificationError::NoLoads)?.points;
        Ok(Self {
            support: support.or(posture).ok_or(VerificationError::NoPosture)?,
            tier,
            contact: false,
            part: match patch {
                Some(panel) => SheetPart::around(&deployment.sheet, panel)?,
                None => SheetPart::whole(&deployment.sheet),
            },
            out_of_plane: (patch.is_none())
                .then(|| out_of_plane(&scene, &problem, &deployment))
                .flatten(),
            curve,
            deployment,
            problem,
            scene,
        })
    }

    /// The solve.
    pub fn solve(&self, versions: &ToolVersions) -> Result<SheetSolve, VerificationError> {
        let (scene, sheet) = (&self.scene, &self.deployment.sheet);
        let problem = sheet_problem(scene, sheet, self.support, self.tier, self.contact)?;
        let problem = self.part.of(problem, &self.deployment)?;
        Ok(SheetSolve::new(problem, versions))
    }

    /// Compares the solved sheet with the deployment by the law; `design` is its name for a person.
    pub fn check(&self, design: &str, solved: &Solved<SheetSolve>) -> SheetCheck {
        let sheet = &self.deployment.sheet;
        let thickness = self.scene.material.thickness;
        let widths = sheet.hinges.iter().map(|hinge| hinge.w_lig / thickness);
        let samples = &solved.samples;
        // Before the loads, while the weight comes on, the law has no state to compare with.
        let loaded = samples.states.iter().filter(|state| state.fraction > 0.0);
        let problem = &solved.solve.problem;
        let path = loaded.map(|state| self.state(state, problem.total_load()));
        let last = samples.states.last();
        let (hinges, panels) = last.map_or_else(Default::default, |last| self.end(last));
        let mut check = SheetCheck {
            design: design.to_owned(),
            support: self.support,
            tier: self.tier,
            counts: [self.part.panels.len(), self.part.hinges.len()],
            is_patch: self.is_patch(),
            contact: self.contact,
            size: sheet.outline.size(),
            radius: [
                (problem.shape.windows.iter())
                    .map(|window| window.design.r_win)
                    .fold(f64::INFINITY, f64::min),
                sheet.options.process.r_win,
            ],
            slenderness: [widths.clone().fold(f64::INFINITY, f64::min), widths.fold(0.0, f64::max)],
            outside: (self.part.hinges.iter().copied())
                .filter(|h| self.deployment.path.iter().any(|step| !step.inside[*h]))
                .collect(),
            driven: self.scene.config.drive.is_some(),
            stopped: (solved.complete().err()).map(|unsolved| unsolved.to_string()),
            dynamic: last.is_some_and(|last| last.kinetic_energy != 0.0),
            unknowns: samples.unknowns,
            cpu_seconds: solved.record.cpu_seconds,
            memory_mib: solved.record.peak_memory_mib,
            path: path.collect(),
            hinges,
            panels,
            panel_energy: last.map_or(0.0, |last| {
                last.panel_energy / last.internal_energy().max(f64::MIN_POSITIVE)
            }),
            surface: samples.surface.clone().unwrap_or_default(),
            findings: Vec::new(),
        };
        check.findings = findings(&check);
        check
    }

    /// Whether only a part of the sheet is solved.
    fn is_patch(&self) -> bool {
        self.part.panels.len() < self.deployment.sheet.panels.len()
    }

    /// What the law predicts at a fraction of the loads: motions of the panels, and (displacement,
    /// load).
    fn by_law(&self, fraction: f64) -> (Configuration, [f64; 2]) {
        let weighed = self.deployment.weight_steps();
        let loaded = &self.deployment.path[weighed.len()..];
        let flat = vec![[0.0; 3]; self.deployment.sheet.panels.len()];
        let start = weighed.last().map_or(&flat, |step| &step.configuration);
        let (after, share) = self.place(fraction);
        let mix = |from: f64, to: f64| from + share * (to - from);
        let from = match after {
            1 => start,
            _ => &loaded[after - 2].configuration,
        };
        let to = &loaded[after - 1].configuration;
        let configuration = std::iter::zip(from, to)
            .map(|(from, to)| std::array::from_fn(|i| mix(from[i], to[i])))
            .collect();
        let (from, to) = (self.curve[after - 1], self.curve[after]);
        (configuration, [0, 1].map(|i| mix(from[i], to[i])))
    }

    /// Distances in space of the corners of the panels between a configuration and finite elements
    /// (mm).
    fn corner_errors(&self, configuration: &[[f64; 3]], state: &SheetState) -> Vec<[f64; 4]> {
        let sheet = &self.deployment.sheet;
        let deployed = deployed_corners(sheet, configuration);
        let panels = std::iter::zip(&self.part.panels, &state.panels);
        panels
            .map(|(&panel, moved)| {
                std::array::from_fn(|corner| {
                    let [x, y, z] = moved.moved(sheet.panels[panel].corners[corner]);
                    let [u, v] = deployed[panel][corner];
                    (x - u).hypot(y - v).hypot(z)
                })
            })
            .collect()
    }

    /// `full_load` is the sum of the magnitudes of the full loads (N).
    fn state(&self, state: &SheetState, full_load: f64) -> StateCheck {
        let sheet = &self.deployment.sheet;
        let (configuration, [displacement, load]) = self.by_law(state.fraction);
        let errors = self.corner_errors(&configuration, state).concat();
        let openings = hinge_deformations(sheet, &configuration);
        let hinges = &self.part.hinges;
        let by_law: f64 = hinges.iter().map(|h| openings[*h].theta).sum();
        let by_elements = hinges.iter().map(|h| self.opening(state, *h, &configuration));
        let by_elements: f64 = by_elements.sum();
        let mean = |sum: f64| (sum / hinges.len() as f64).to_degrees();
        let whole = !self.is_patch();
        StateCheck {
            fraction: state.fraction,
            stroke: whole.then_some([displacement, state.stroke]),
            load: whole.then_some([load, state.load_factor * full_load]),
            corners: rms_and_maximum(errors),
            opening_deg: [mean(by_law), mean(by_elements)],
            tilt_deg: state.tilt().to_degrees(),
            z: state.z(),
            bending: (state.panels.iter()).fold(0.0, |most, panel| panel.bending.max(most)),
            kinetic: state.kinetic_energy / state.internal_energy().max(f64::MIN_POSITIVE),
            flank_gap: (whole && state.tilt() < UPRIGHT).then(|| self.flank_gap(state)),
            margin: self.margin(state.fraction),
            tilt_by_law_deg: self.tilt_by_law(state.fraction).map(f64::to_degrees),
        }
    }

    /// The least gap of the flanks of a cut (mm), by the motion of the panels in the plane.
    fn flank_gap(&self, state: &SheetState) -> f64 {
        let sheet = &self.deployment.sheet;
        let motion = |(panel, moved): (&Panel, &PanelState)| {
            let [x, y] = panel.reference;
            let [u, v, _] = moved.moved(panel.reference);
            [u - x, v - y, moved.turn()]
        };
        let configuration: Configuration =
            std::iter::zip(&sheet.panels, &state.panels).map(motion).collect();
        let states = hinge_deformations(sheet, &configuration);
        let regime = |design: &HingeDesign| self.scene.material.regime(design.w_lig);
        let hinges = std::iter::zip(&sheet.hinges, sheet.designs());
        let gaps = std::iter::zip(hinges, states).map(|((hinge, design), state)| {
            // The cut ends outside of the window, at the other end of its edge of panel A.
            let (panel, corner) = hinge.site.a;
            let corners = sheet.panels[panel].corners;
            let r_win = distance(corners[corner], corners[(corner + 3) % 4]);
            flank_gap(&HingeDesign { r_win, ..design }, &state, regime(&design))
        });
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// The margin by the law at the next load step.
    fn margin(&self, fraction: f64) -> Option<f64> {
        let weighed = self.deployment.weight_steps().len();
        Some(self.out_of_plane.as_ref()?[weighed + self.place(fraction).0 - 1].margin)
    }

    /// The largest tilt by the law (rad).
    fn tilt_by_law(&self, fraction: f64) -> Option<f64> {
        let by_step = &self.out_of_plane.as_ref()?[self.deployment.weight_steps().len()..];
        let (after, share) = self.place(fraction);
        let tilt = |number: usize| match number {
            0 => Some(0.0),
            _ => by_step[number - 1].tilt(),
        };
        let [from, to] = [tilt(after - 1)?, tilt(after)?];
        Some(from + share * (to - from))
    }

    /// The load step at or after a fraction of the loads, counted from 1, and the share of the way
    /// to it from the one before.
    fn place(&self, fraction: f64) -> (usize, f64) {
        let steps = self.deployment.path.len() - self.deployment.weight_steps().len();
        let place = fraction.clamp(0.0, 1.0) * steps as f64;
        let after = (place.ceil() as usize).clamp(1, steps);
        (after, place - (after - 1) as f64)
    }

    /// Rotation of a hinge in the plane by finite elements (rad); a panel that is not solved moves
    /// by the law.
    fn opening(&self, state: &SheetState, hinge: usize, by_law: &[[f64; 3]]) -> f64 {
        let hinge = &self.deployment.sheet.hinges[hinge];
        let turn = |panel: usize| match self.part.panels.binary_search(&panel) {
            Ok(place) => state.panels[place].turn(),
            Err(_) => by_law[panel][2],
        };
        turn(hinge.panel_b()) - turn(hinge.panel_a())
    }

    /// Hinges and panels in the last state.
    fn end(&self, last: &SheetState) -> (Vec<HingeCheck>, Vec<PanelCheck>) {
        let sheet = &self.deployment.sheet;
        let (configuration, _) = self.by_law(last.fraction);
        let states = hinge_deformations(sheet, &configuration);
        let designs = sheet.designs();
        let energies = (self.problem.model.mechanics()).map(|mechanics| {
            let law = mechanics.law.prepare(&designs);
            law.energies(&states, Order::Value)
        });
        let full = last.fraction >= 1.0;
        let hinges = std::iter::zip(&self.part.hinges, &last.hinges);
        let hinges = hinges.map(|(&h, found)| HingeCheck {
            hinge: h,
            w_lig: sheet.hinges[h].w_lig,
            theta_deg: [states[h].theta, self.opening(last, h, &configuration)]
                .map(f64::to_degrees),
            energy: [energies.as_ref().map_or(f64::NAN, |energies| energies[h].w), found.energy],
            d_peak: [
                full.then(|| self.deployment.damage_max(DamageMeasure::Peak, h)).flatten(),
                Some(found.d_peak),
            ],
        });
        let errors = self.corner_errors(&configuration, last);
        let panels = std::iter::zip(&self.part.panels, &last.panels).zip(errors);
        let panels = panels.map(|((&number, panel), errors)| PanelCheck {
            panel: number,
            tilt_deg: panel.tilt().to_degrees(),
            off: errors.into_iter().fold(0.0, f64::max),
            z: panel.z,
            bending: panel.bending,
        });
        (hinges.collect(), panels.collect())
    }
}

impl SheetCheck {
    /// What a run keeps of it; `None` for a part of a sheet, and if there is no state.
    pub fn summary(&self) -> Option<WholeSheet> {
        let last = self.last().filter(|_| !self.is_patch)?;
        let tilts = self.path.iter().map(|state| state.tilt_deg);
        Some(WholeSheet {
            support: self.support,
            tilt_deg: tilts.fold(0.0, f64::max),
            corners: last.corners,
            load: last.load,
            findings: self.findings.clone(),
        })
    }

    /// The last state of the path.
    pub fn last(&self) -> Option<&StateCheck> {
        self.path.last()
    }
}

/// All findings, the most severe first.
fn findings(check: &SheetCheck) -> Vec<Finding> {
    let Some(last) = check.last() else {
        let reason = check.stopped.as_deref();
        let reason = reason.unwrap_or("no increment converged");
        let message = format!("the sheet was not solved: {reason}");
        let unsolved = Severity::Error.finding(message);
        return std::iter::once(unsolved).chain(outside_domain(check)).collect();
    };
    let stopped = check.stopped.as_ref().map(|reason| {
        Severity::Error.finding(format!(
            "the path was followed to {:.1} % only; what happens beyond is not known: {reason}",
            100.0 * last.fraction
        ))
    });
    let found = [
        stopped,
        flatness(check.support, check.size, &check.path),
        flanks_pass(&check.path),
        other_load(check, last),
        tearing(check),
        still_moving(last),
        outside_domain(check),
    ];
    let mut found: Vec<Finding> = found.into_iter().flatten().collect();
    found.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    found
}

/// Whether a sheet of a size (mm) is flat, by the rule of a design, where it is least so: on the
/// way or at the end.
fn flatness(support: Posture, size: f64, path: &[StateCheck]) -> Option<Finding> {
    let most = |value: fn(&StateCheck) -> f64| {
        path.iter().max_by(|one, other| value(one).total_cmp(&value(other)))
    };
    let tilted = most(|state| state.tilt_deg)?;
    let off = most(|state| state.corners[0])?;
    let [rms, largest] = off.corners;
    let (error, tilt) = (rms / size, tilted.tilt_deg);
    let [as_predicted, otherwise] = match support {
        Posture::HeldFlat => ["agrees with the hinge law", "opens otherwise than predicted"],
        _ => ["stays flat", "does not stay flat"],
    };
    let (severity, what) = match Flatness::of(error, tilt) {
        Flatness::Flat => (Severity::Note, as_predicted),
        Flatness::Tilts => (Severity::Warning, otherwise),
        Flatness::Falls => (Severity::Error, otherwise),
    };
    let at = |state: &StateCheck| format!("at {:.0} % of the path", 100.0 * state.fraction);
    Some(severity.finding(format!(
            "the sheet {what}: the panels tilt by up to {tilt:.1} deg, {}, and the corners are {rms:.2} mm (root mean square) from where \
             the hinge law has them, {largest:.2} mm at most, {}: {:.2} % of the sheet",
            at(tilted),
            at(off),
            100.0 * error
        ),
    ))
}

/// Flanks that pass through each other, as flanks of a cut sheet cannot.
fn flanks_pass(path: &[StateCheck]) -> Option<Finding> {
    let gap = |state: &&StateCheck| state.flank_gap.is_some_and(|gap| gap < -FLANKS_TOUCH);
    let first = path.iter().find(gap)?;
    let deepest = path.iter().filter_map(|state| state.flank_gap).fold(0.0, f64::min);
    Some(Severity::Warning.finding(format!(
            "flanks of cuts pass through each other, by up to {:.2} mm, from {:.0} % of the path on: the sheet may go another way. Pull other \
             panels, or more of them; with --contact the flanks of a plate touch, in several times the time",
            -deepest,
            100.0 * first.fraction
        ),
    ))
}

fn other_load(check: &SheetCheck, last: &StateCheck) -> Option<Finding> {
    let [by_law, by_elements] = last.load.filter(|_| check.driven)?;
    let differs = (by_law - by_elements).abs() > OTHER_LOAD * by_elements.abs();
    differs.then(|| {
        Severity::Warning.finding(format!(
            "the load is {by_elements:.4} N by finite elements and {by_law:.4} N by the hinge law"
        ))
    })
}

fn tearing(check: &SheetCheck) -> Option<Finding> {
    let tears = |hinge: &&HingeCheck| hinge.d_peak[1].is_some_and(|peak| peak >= 1.0);
    let torn = check.hinges.iter().filter(tears).map(|hinge| hinge.hinge);
    let torn: Vec<String> = torn.map(|hinge| hinge.to_string()).collect();
    (!torn.is_empty()).then(|| {
        let hinges = torn.join(", ");
        Severity::Error.finding(format!("ligaments tear: D_peak is 1 or more (hinges {hinges})"))
    })
}

fn still_moving(last: &StateCheck) -> Option<Finding> {
    (last.kinetic > AT_REST).then(|| {
        Severity::Warning.finding(format!(
            "the sheet still moves at the end of its dynamic path: kinetic energy is {:.1} % of the internal energy",
            100.0 * last.kinetic
        ))
    })
}

fn outside_domain(check: &SheetCheck) -> Option<Finding> {
    let hinges: Vec<String> = check.outside.iter().map(usize::to_string).collect();
    (!hinges.is_empty()).then(|| {
        Severity::Warning.finding(format!(
            "the hinge law is outside of its training domain at hinges {}: what it predicts there is extrapolated, and the \
             difference to finite elements is not one of flatness",
            hinges.join(", ")
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Flat at the end is not flat on the way.
    #[test]
    fn the_verdict_is_of_the_whole_path() {
        let state = |fraction: f64, tilt_deg: f64, rms: f64| StateCheck {
            fraction,
            stroke: None,
            load: None,
            corners: [rms, 2.0 * rms],
            opening_deg: [20.0; 2],
            tilt_deg,
            z: [0.0; 2],
            bending: 0.0,
            kinetic: 0.0,
            flank_gap: None,
            margin: None,
            tilt_by_law_deg: None,
        };
        let found = |on_the_way: [f64; 2], support| {
            let path = [state(0.4, on_the_way[0], on_the_way[1]), state(1.0, 0.4, 0.3)];
            flatness(support, 200.0, &path).unwrap()
        };
        // 0.3 and 5 % of the sheet are 0.6 and 10 mm.
        for (on_the_way, severity, what) in [
            ([0.9, 0.59], Severity::Note, "stays flat"),
            ([2.3, 0.3], Severity::Warning, "does not stay flat"),
            ([0.3, 0.61], Severity::Warning, "does not stay flat"),
            ([5.1, 0.3], Severity::Error, "does not stay flat"),
            ([0.3, 10.1], Severity::Error, "does not stay flat"),
        ] {
            let found = found(on_the_way, Posture::Free);
            assert_eq!(found.severity, severity, "{found:?}");
            assert!(found.message.contains(&format!("the sheet {what}: ")), "{found:?}");
            let largest = on_the_way[0].max(0.4);
            let tilt = format!("tilt by up to {largest:.1} deg");
            assert!(found.message.contains(&tilt), "{found:?}");
        }
        let held = found([0.3, 1.0], Posture::HeldFlat);
        for part in ["opens otherwise than predicted", "2.00 mm at most, at 40 % of the path"] {
            assert!(held.message.contains(part), "{held:?}");
        }
        assert_eq!(flatness(Posture::Free, 200.0, &[]), None);
    }
}
