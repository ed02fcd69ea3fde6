//! A whole sheet by finite elements: its solve, and what the hinge law predicts of it.

use crate::sheet_check::{HingeCheck, PanelCheck, SheetCheck, StateCheck, findings};
use crate::verification_error::VerificationError;
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
use mesher::{Panels, Tier};
use scene::placement::seen_in;
use scene::{Posture, Scene};
use std::array::from_fn;
use std::iter::zip;
use support::statistics::rms_and_maximum;
use support::{Extremes, Point, fault};

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
    panels: Panels,
    /// Whether the flanks of its cuts touch; `false` unless set.
    pub contact: bool,
    /// Displacement and load by the law, before the loads and at every load step.
    curve: Vec<Point>,
    /// The plate out of its plane by the law at every load step; `None` where the law has none.
    out_of_plane: Option<Vec<OutOfPlane>>,
}

/// The sheet by the hinge law.
struct LawState {
    configuration: Configuration,
    /// Displacement (mm) and load (N).
    load_point: Point,
    /// The margin against leaving the plane at the next load step, and the largest tilt (rad).
    margin: Option<f64>,
    tilt: Option<f64>,
}

impl SheetTask {
    /// The design of a scene, kept in its plane by `support`, or as its posture states.
    pub fn new(
        scene: &Scene,
        design: &DesignVector,
        support: Option<Posture>,
        tier: Tier,
        panels: Panels,
    ) -> Result<Self, VerificationError> {
        let scene = with_support(scene, support)?;
        let posture = scene.config.posture.map(|posture| posture.kind);
        let problem = scene.problem()?;
        let no_loads =
            || fault!("whole sheets need supports and loads: the scene has level = \"pin\"");
        let mechanics = problem.model.mechanics().ok_or_else(no_loads)?;
        let deployment = problem.deploy(design)?;
        deployment.at_full_load()?;
        let curve = ActuationCurve::new(mechanics, &deployment);
        let curve = curve.ok_or_else(no_loads)?.points;
        Ok(Self {
            support: support.or(posture).ok_or_else(no_posture)?,
            tier,
            panels,
            contact: false,
            out_of_plane: out_of_plane(&scene, &problem, &deployment),
            curve,
            deployment,
            problem,
            scene,
        })
    }

    /// The solve.
    pub fn solve(&self, versions: &ToolVersions) -> Result<SheetSolve, VerificationError> {
        let (scene, sheet) = (&self.scene, &self.deployment.sheet);
        let problem =
            sheet_problem(scene, sheet, self.support, self.tier, self.panels, self.contact)?;
        problem.validate()?;
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
            model: self.panels,
            counts: [sheet.panels.len(), sheet.hinges.len()],
            contact: self.contact,
            size: sheet.outline.size(),
            radius: [
                (problem.shape.windows.iter()).map(|window| window.design.r_win).smallest(),
                sheet.options.process.r_win,
            ],
            slenderness: [widths.clone().smallest(), widths.largest()],
            outside: (0..sheet.hinges.len())
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
            supports: last.map_or_else(Default::default, |last| self.supports(last)),
            seen: last.map(|last| self.seen(last)),
            panel_energy: last.map_or(0.0, |last| {
                last.panel_energy / last.internal_energy().max(f64::MIN_POSITIVE)
            }),
            surface: samples.surface.clone().unwrap_or_default(),
            findings: Vec::new(),
        };
        check.findings = findings(&check);
        check
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
        let configuration = zip(from, &loaded[next - 1].configuration);
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
        let panels = zip(&sheet.panels, &state.panels).zip(&deployed);
        let errors = panels.map(|((panel, moved), deployed)| {
            let corners = zip(&panel.boundary, deployed);
            let error = |(flat, [u, v]): (&Point, &Point)| {
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
        let mean = |opening: &dyn Fn(usize) -> f64| {
            let sum: f64 = (0..openings.len()).map(opening).sum();
            (sum / openings.len() as f64).to_degrees()
        };
        // The work of supports that move is no load of the solved sheet.
        let pulled = full_load > 0.0;
        StateCheck {
            fraction: state.fraction,
            stroke: pulled.then_some([displacement, state.stroke]),
            load: pulled.then_some([load, state.load_factor * full_load]),
            corners: rms_and_maximum(errors),
            opening_deg: [mean(&|h| openings[h].theta), mean(&|h| self.opening(state, h))],
            tilt_deg: state.tilt().to_degrees(),
            z: state.z(),
            bending: (state.panels.iter()).fold(0.0, |most, panel| panel.bending.max(most)),
            kinetic: state.kinetic_energy / state.internal_energy().max(f64::MIN_POSITIVE),
            flank_gap: (state.tilt() < UPRIGHT).then(|| self.flank_gap(state)),
            margin,
            tilt_by_law_deg: tilt.map(f64::to_degrees),
        }
    }

    /// The motion of the panels in the plane.
    fn in_plane(&self, state: &SheetState) -> Configuration {
        let motion = |(panel, moved): (&Panel, &PanelState)| {
            let [x, y] = panel.reference;
            let [u, v, _] = moved.moved(panel.reference);
            [u - x, v - y, moved.turn()]
        };
        zip(&self.deployment.sheet.panels, &state.panels).map(motion).collect()
    }

    /// How much of the target is seen.
    fn seen(&self, state: &SheetState) -> Point {
        let LawState { configuration, .. } = self.by_law(state.fraction);
        [configuration, self.in_plane(state)]
            .map(|motions| seen_in(&self.scene, &self.deployment, &motions))
    }

    /// The reactions of the supports in the plane in the last state (N).
    fn supports(&self, last: &SheetState) -> [Vec<f64>; 2] {
        let sheet = &self.deployment.sheet;
        let designs = sheet.designs();
        // Between load steps the law has no equilibrium.
        let mechanics = self.problem.model.mechanics().filter(|_| last.fraction >= 1.0);
        let by_law = mechanics.map_or_else(Vec::new, |mechanics| {
            let law = mechanics.law.prepare(&designs);
            let hinged = mechanics.hinged(sheet, &*law, false);
            let end = self.deployment.final_step();
            let forces = mechanics.solver.reactions(hinged, &end.configuration);
            let supports = self.scene.actuation().supports.into_iter();
            supports.map(|support| forces[support.panel]).collect()
        });
        [by_law, last.support_forces.clone()]
            .map(|forces| forces.into_iter().map(|[x, y, _]| x.hypot(y)).collect())
    }

    /// The least gap of the flanks of a cut (mm), by the motion of the panels in the plane.
    fn flank_gap(&self, state: &SheetState) -> f64 {
        let sheet = &self.deployment.sheet;
        let states = hinge_deformations(sheet, &self.in_plane(state));
        let regime = |design: &HingeDesign| self.scene.material.regime(design.w_lig);
        let hinges = zip(&sheet.hinges, sheet.designs());
        let gaps = zip(hinges, states).map(|((hinge, design), state)| {
            // The cut ends outside of the window, at the other end of its edge of panel A.
            let (panel, corner) = hinge.site.a;
            let corners = sheet.panels[panel].corners;
            let r_win = distance(corners[corner], corners[(corner + 3) % 4]);
            flank_gap(&HingeDesign { r_win, ..design }, &state, regime(&design))
        });
        gaps.smallest()
    }

    /// Rotation of a hinge in the plane by finite elements (rad).
    fn opening(&self, state: &SheetState, hinge: usize) -> f64 {
        let hinge = &self.deployment.sheet.hinges[hinge];
        state.panels[hinge.panel_b()].turn() - state.panels[hinge.panel_a()].turn()
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
        let hinges = last.hinges.iter().enumerate().map(|(h, found)| HingeCheck {
            hinge: h,
            w_lig: sheet.hinges[h].w_lig,
            theta_deg: [states[h].theta, self.opening(last, h)].map(f64::to_degrees),
            energy: [energies.as_ref().map_or(f64::NAN, |energies| energies[h].w), found.energy],
            d_peak: [
                full.then(|| self.deployment.damage_max(DamageMeasure::Peak, h)).flatten(),
                Some(found.d_peak),
            ],
        });
        let errors = self.corner_errors(&configuration, last);
        let panels = zip(&last.panels, errors).enumerate();
        let panels = panels.map(|(number, (panel, errors))| PanelCheck {
            panel: number,
            tilt_deg: panel.tilt().to_degrees(),
            off: errors.into_iter().largest(),
            z: panel.z,
            bending: panel.bending,
        });
        (hinges.collect(), panels.collect())
    }
}
