//! The equilibrium problem of the sheet under dead loads (10), along the load factors zeta_i = i/N:
//!
//! ```text
//! min over q of  Pi(q) = sum_h W(eps_h(q); g_h) - zeta sum_k (F_k . u_k + M_k phi_k)
//! ```
//!
//! Self-weight in the plane is applied before the loads, with fixed supports and no prescribed
//! displacement; its work is subtracted. In unloading the work of the forces that held the sheet is
//! subtracted.

use crate::{
    equilibrium::{
        displacement_control::{Stroke, magnitude, work},
        settings::SolverSettings,
        supports::{Dof, Load, Support, hold_rigid_body},
        tangent::TangentPattern,
        weight::hung_from,
    },
    sheet::{
        cut_sheet::{AttachmentPoint, Sheet},
        kinematics::{Configuration, Motion},
        topology::Topology,
    },
};
use std::iter::zip;
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};
use support::{Fault, fault, refuse};

/// Number of load steps in which the weight comes on.
const WEIGHT_STEPS: usize = 2;

/// Supports and loads of a sheet, with everything that depends only on its topology.
#[derive(Clone, Debug)]
pub struct EquilibriumSolver {
    pub(crate) topology: Arc<Topology>,
    pub(crate) settings: SolverSettings,
    pub(crate) steps: usize,
    /// Prescribed motions at full load.
    pub(crate) supports: Box<[Support]>,
    /// (F_x, F_y, M) per panel at full load.
    pub(crate) loads: Box<[Motion]>,
    /// Weight of a unit of area (N/mm^2), zero without weight.
    pub(crate) weight: [f64; 2],
    /// The points at which panels are held or pulled; the others have their centroids as reference
    /// points.
    pub(crate) attachment_points: Box<[AttachmentPoint]>,
    /// Loads held constant from the beginning of the path.
    pub(crate) held: Box<[Motion]>,
    /// Direction of the stroke and its value at full load, under displacement control.
    pub(crate) drive: Option<(Box<Stroke>, f64)>,
    /// Shared by the solvers of one sheet with other loads.
    pub(crate) pattern: Arc<TangentPattern>,
    /// When it becomes true, paths end where they are.
    pub(crate) stop: Arc<AtomicBool>,
}

impl EquilibriumSolver {
    /// Equilibria at the load factors i/steps, i = 1..=steps.
    pub fn new(
        topology: impl Into<Arc<Topology>>,
        supports: &[Support],
        loads: &[Load],
        steps: usize,
        settings: SolverSettings,
    ) -> Result<Self, Fault> {
        let topology = topology.into();
        if steps == 0 {
            refuse!("0 load steps: use at least 1");
        }
        let panels = topology.panel_count();
        let check = |what: &str, panel: usize| match panel < panels {
            true => Ok(()),
            false => {
                Err(fault!("{what} on panel {panel}: the panels of the sheet are 0..{panels}"))
            }
        };
        let mut supported = vec![[false; 3]; panels];
        for &Support { panel, dof, value } in supports {
            check("a support", panel)?;
            finite("a support", panel, value)?;
            if std::mem::replace(&mut supported[panel][dof.index()], true) {
                refuse!("{dof:?} of panel {panel} is supported twice");
            }
        }
        let mut total = vec![[0.0; 3]; panels];
        for &Load { panel, dof, value } in loads {
            check("a load", panel)?;
            total[panel][dof.index()] += value;
        }
        let solver = Self {
            settings,
            steps,
            pattern: Arc::new(TangentPattern::new(&topology, supported.as_flattened())),
            topology,
            supports: supports.into(),
            weight: [0.0; 2],
            attachment_points: Box::default(),
            held: vec![[0.0; 3]; panels].into(),
            loads: vec![[0.0; 3]; panels].into(),
            drive: None,
            stop: Arc::default(),
        };
        solver.loaded(&total)
    }

    /// Ends the paths that are followed with
    /// [`DescentEnd::Stopped`](crate::equilibrium::load_step::DescentEnd) at the increment during
    /// which `stop` becomes true.
    pub(crate) fn stop_by(&mut self, stop: Arc<AtomicBool>) {
        self.stop = stop;
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The same problem with other loads (F_x, F_y, M) on the panels at full load (N, N, N mm); the
    /// loads of a stroke give its direction.
    ///
    /// # Panics
    /// If there is not one load for each panel.
    pub fn loaded(mut self, loads: &[Motion]) -> Result<Self, Fault> {
        assert_eq!(loads.len(), self.loads.len(), "one load per panel");
        for (panel, load) in loads.iter().enumerate() {
            load.iter().try_for_each(|value| finite("a load", panel, *value))?;
        }
        let held = self.supports.iter();
        if let Some(support) = held.into_iter().find(|s| loads[s.panel][s.dof.index()] != 0.0) {
            let Support { panel, dof, .. } = *support;
            refuse!(
                "panel {panel} is loaded in {dof:?}, where it is supported: loads act on free degrees of freedom"
            );
        }
        self.loads = loads.into();
        match self.drive.take() {
            Some((_, stroke)) => self.driven(stroke),
            None => Ok(self),
        }
    }

    /// Loads (F_x, F_y, M) on the panels at full load (N, N, N mm).
    pub fn loads(&self) -> &[Motion] {
        &self.loads
    }

    /// A gradient in the loads, zero in those that are no variables: at the supports, and under
    /// displacement control those whose magnitude has a kink in the sum of all, at panels without
    /// them.
    pub(crate) fn in_loads(&self, gradient: &[Motion]) -> Vec<Motion> {
        let mut gradient = self.pattern.spread(&self.pattern.gather(gradient));
        if let Some(stroke) = self.stroke() {
            for (gradient, load) in zip(&mut gradient, &self.loads) {
                for (entry, smooth) in zip(gradient, stroke.smooth_in(load)) {
                    *entry *= f64::from(smooth);
                }
            }
        }
        gradient
    }

    /// The components of forces on the panels at the supports; at the free degrees of freedom they
    /// are zero.
    pub(crate) fn at_supports(&self, forces: &[Motion]) -> Vec<Motion> {
        let mut at_supports = vec![[0.0; 3]; forces.len()];
        for support in &self.supports {
            let (panel, dof) = (support.panel, support.dof.index());
            at_supports[panel][dof] = forces[panel][dof];
        }
        at_supports
    }

    /// The motions (u_x, u_y, phi) of the panels that the supports prescribe at full load.
    pub fn support_motions(&self) -> Vec<Motion> {
        let mut motions = vec![[0.0; 3]; self.loads.len()];
        for support in &self.supports {
            motions[support.panel][support.dof.index()] = support.value;
        }
        motions
    }

    /// The direction in which the stroke of the loads is prescribed, if it is.
    pub(crate) fn stroke(&self) -> Option<&Stroke> {
        self.drive.as_ref().map(|(stroke, _)| &**stroke)
    }

    /// The displacement of a configuration along the loads, by which a stroke is prescribed: their
    /// work over the sum of their magnitudes (mm; rad if there are only couples). `None` without
    /// loads.
    pub fn displacement(&self, configuration: &[Motion]) -> Option<f64> {
        let (size, _) = magnitude(&self.loads)?;
        Some(work(&self.loads, configuration) / size)
    }

    /// Whether the stroke is prescribed and the load factor follows.
    pub fn is_driven(&self) -> bool {
        self.drive.is_some()
    }

    /// The same supports and loads under displacement control: the load factors follow from the
    /// strokes i/steps of `stroke` (mm), the work of the full loads divided by the sum of their
    /// magnitudes.
    pub fn driven(mut self, stroke: f64) -> Result<Self, Fault> {
        if !stroke.is_finite() {
            refuse!("the stroke {stroke} mm is not a finite number");
        }
        let direction = Stroke::new(&self.loads, &self.pattern.gather(&self.loads));
        let no_load = || fault!("displacement control needs a load, whose stroke is prescribed");
        let direction = direction.ok_or_else(no_load)?;
        self.drive = Some((Box::new(direction), stroke));
        Ok(self)
    }

    /// The same problem for panels that are held or pulled at `points`, to which supports and loads
    /// refer.
    pub fn attached_at(mut self, points: Vec<AttachmentPoint>) -> Self {
        self.attachment_points = points.into();
        self
    }

    /// The points at which panels are held or pulled.
    pub fn attachment_points(&self) -> &[AttachmentPoint] {
        &self.attachment_points
    }

    /// The same problem with a weight of `by_area` (N/mm^2) in the plane of the sheet.
    pub fn with_weight(mut self, by_area: [f64; 2]) -> Result<Self, Fault> {
        if !by_area.iter().all(|component| component.is_finite()) {
            refuse!("the weight {by_area:?} N/mm^2 is not finite");
        }
        self.weight = by_area;
        Ok(self)
    }

    /// Weight of a unit of area in the plane of the sheet (N/mm^2); zero without weight.
    pub fn weight(&self) -> [f64; 2] {
        self.weight
    }

    /// The number of load steps in which the weight comes on.
    pub fn weight_steps(&self) -> usize {
        if self.weight == [0.0; 2] { 0 } else { WEIGHT_STEPS }
    }

    /// An error if the supports leave a sheet free to move as a rigid body and its weight does not
    /// hold it.
    pub fn check_supports(&self, sheet: &Sheet) -> Result<(), Fault> {
        self.start(sheet).map(drop).ok_or_else(|| {
            fault!(
                "the supports leave the sheet free to move as a rigid body: support at least three degrees of freedom, \
                 such as one clamp or a pin and a roller; one pin is enough for a sheet that hangs by its weight, without \
                 a prescribed stroke, from a point that is not its centre of gravity"
            )
        })
    }

    /// The unloaded sheet: flat, and turned about a nail from which it hangs; `None` if it is free
    /// to move.
    pub(crate) fn start(&self, sheet: &Sheet) -> Option<Configuration> {
        if hold_rigid_body(&self.supports, sheet) {
            return Some(self.flat());
        }
        match (self.supports.as_ref(), &self.drive) {
            ([x, y], None) if x.panel == y.panel && x.dof != Dof::Phi && y.dof != Dof::Phi => {
                hung_from(sheet, sheet.panels[x.panel].reference, self.weight)
            }
            _ => None,
        }
    }

    /// The configuration of the flat sheet.
    pub fn flat(&self) -> Configuration {
        vec![[0.0; 3]; self.topology.panel_count()]
    }
}

fn finite(what: &str, panel: usize, value: f64) -> Result<(), Fault> {
    if value.is_finite() {
        return Ok(());
    }
    Err(fault!("{what} of {value} on panel {panel} is not a finite number"))
}
