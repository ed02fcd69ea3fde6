//! A whole sheet by finite elements: its solve, and what the hinge law predicts of it.

use crate::patch::SheetPart;
use crate::sheet_check::{HingeCheck, PanelCheck, SheetCheck, StateCheck, findings};
use crate::verification_error::{VerificationError, refused};
use crate::whole_sheet::{no_posture, sheet_problem, with_support};
use analysis::actuation_curve::ActuationCurve;
use analysis::flanks::flank_gap;
use analysis::out_of_plane::{OutOfPlane, out_of_plane};
use design::geometry::polygon::distance;
use design::hinge_law::{DamageMeasure, Order};
use design::objective::design_problem::{Deployment, DesignProblem};
use design::pattern::design_vector::DesignVector;
use design::sheet::cut_sheet::Panel;
use design::sheet::kinematics::{Configuration, deployed_boundaries, hinge_deformations};
use fe_driver::{PanelState, SheetSolve, SheetState, Solved, ToolVersions};
use hinge::HingeDesign;
use mesher::Tier;
use scene::{Posture, Scene};
use std::array::from_fn;
use support::statistics::rms_and_maximum;

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

/// The sheet by the hinge law.
struct LawState {
    configuration: Configuration,
    /// Displacement (mm) and load (N).
    load_point: [f64; 2],
    /// The margin against leaving the plane at the next load step, and the largest tilt (rad).
    margin: Option<f64>,
    tilt: Option<f64>,
}

impl SheetTask {
    /// The design of a scene, kept in its plane by `support`, or as its posture states. With a
    /// `patch`, only the panel [column, row] and those around it are solved.
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
        let no_loads =
            || refused("whole sheets need supports and loads: the scene has level = \"pin\"");
        let mechanics = problem.model.mechanics().ok_or_else(no_loads)?;
        let deployment = problem.deploy(design)?;
        deployment.at_full_load()?;
        let curve = ActuationCurve::new(mechanics, &deployment);
        let curve = curve.ok_or_else(no_loads)?.points;
        Ok(Self {
            support: support.or(posture).ok_or_else(no_posture)?,
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

    /// What the law predicts at a fraction of the loads, linear between its load steps.
    fn by_law(&self, fraction: f64) -> LawState {
        let weighed = self.deployment.weight_steps();
        let loaded = &self.deployment.path[weighed.len()..];
        let position = fraction.clamp(0.0, 1.0) * loaded.len() as f64;
        let next = (position.ceil() as usize).clamp(1, loaded.len());
        let share = position - (next - 1) as f64;
        let mix = |from: f64, to: f64| from + share * (to - from);
        let flat = vec![[0.0; 3]; self.deployment.sheet.panels.len()];
        let before = loaded[..next - 1].last().or(weighed.last());
        let from = before.map_or(&flat, |step| &step.configuration);
        let configuration = std::iter::zip(from, &loaded[next - 1].configuration);
        let plane = self.out_of_plane.as_ref().map(|steps| &steps[weighed.len()..]);
        let tilt = |steps: &[OutOfPlane]| {
            let from = next.checked_sub(2).map_or(Some(0.0), |step| steps[step].tilt());
            Some(mix(from?, steps[next - 1].tilt()?))
        };
        LawState {
            configuration: configuration
                .map(|(from, to)| from_fn(|i| mix(from[i], to[i])))
                .collect(),
            load_point: from_fn(|i| mix(self.curve[next - 1][i], self.curve[next][i])),
            margin: plane.map(|steps| steps[next - 1].margin),
            tilt: plane.and_then(tilt),
        }
    }

    /// Distances in space of the corners of the panels between a configuration and finite elements
    /// (mm).
    fn corner_errors(&self, configuration: &[[f64; 3]], state: &SheetState) -> Vec<Vec<f64>> {
        let sheet = &self.deployment.sheet;
        let deployed = deployed_boundaries(sheet, configuration);
        let panels = std::iter::zip(&self.part.panels, &state.panels);
        let errors = panels.map(|(&panel, moved)| {
            let corners = std::iter::zip(&sheet.panels[panel].boundary, &deployed[panel]);
            let error = |(flat, [u, v]): (&[f64; 2], &[f64; 2])| {
                let [x, y, z] = moved.moved(*flat);
                (x - u).hypot(y - v).hypot(z)
            };
            corners.map(error).collect()
        });
        errors.collect()
    }

    /// `full_load` is the sum of the magnitudes of the full loads (N).
    fn state(&self, state: &SheetState, full_load: f64) -> StateCheck {
        let sheet = &self.deployment.sheet;
        let LawState { configuration, load_point: [displacement, load], margin, tilt } =
            self.by_law(state.fraction);
        let errors = self.corner_errors(&configuration, state).concat();
        let openings = hinge_deformations(sheet, &configuration);
        let hinges = &self.part.hinges;
        let mean = |opening: &dyn Fn(usize) -> f64| {
            let sum: f64 = hinges.iter().map(|&h| opening(h)).sum();
            (sum / hinges.len() as f64).to_degrees()
        };
        // The work of supports that move is no load of the solved sheet.
        let (whole, pulled) = (!self.is_patch(), !self.is_patch() && full_load > 0.0);
        StateCheck {
            fraction: state.fraction,
            stroke: pulled.then_some([displacement, state.stroke]),
            load: pulled.then_some([load, state.load_factor * full_load]),
            corners: rms_and_maximum(errors),
            opening_deg: [
                mean(&|h| openings[h].theta),
                mean(&|h| self.opening(state, h, &configuration)),
            ],
            tilt_deg: state.tilt().to_degrees(),
            z: state.z(),
            bending: (state.panels.iter()).fold(0.0, |most, panel| panel.bending.max(most)),
            kinetic: state.kinetic_energy / state.internal_energy().max(f64::MIN_POSITIVE),
            flank_gap: (whole && state.tilt() < UPRIGHT).then(|| self.flank_gap(state)),
            margin,
            tilt_by_law_deg: tilt.map(f64::to_degrees),
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
        let LawState { configuration, .. } = self.by_law(last.fraction);
        let states = hinge_deformations(sheet, &configuration);
        let designs = sheet.designs();
        let mechanics = self.problem.model.mechanics();
        let energies = mechanics
            .map(|mechanics| mechanics.law.prepare(&designs).energies(&states, Order::Value));
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
