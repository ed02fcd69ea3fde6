//! The panels at which a sheet is fastened in its opened state, and how well they hold it.

use crate::mounting::borne_by_hole;
use crate::out_of_plane::Stability;
use design::equilibrium::warm_start::WarmStart;
use design::geometry::polygon::{bounds, contains, distance, distance_to_outline, size};
use design::hinge_law::DamageMeasure;
use design::objective::terms::damage::NEARLY_TORN;
use design::sheet::kinematics::deployed;
use design::sheet::topology::Topology;
use scene::Scene;
use std::collections::VecDeque;
use support::statistics::rms_and_maximum;

/// Number of fasteners that a sheet begins with.
pub(super) const FIRST: usize = 3;
/// Largest number of fasteners.
pub(super) const AT_MOST: usize = 24;
/// Distance of the panels from the even opening over the longer side of the sheet, root mean square,
/// up to which fasteners suffice.
const EVEN: f64 = 0.002;
/// Margin of the panels against leaving the plane up to which fasteners suffice.
const MARGIN: f64 = 1.5;
/// The middle of a cell, where a panel is fastened, and its least distance from an edge of the panel,
/// in sides.
pub(super) const MIDDLE: [f64; 2] = [0.5; 2];
const ROOM: f64 = 0.15;
/// Diameters of the holes for screws of 4, 3 and 2 mm (mm).
pub(super) const HOLES: [f64; 3] = [4.2, 3.2, 2.2];

/// How fasteners hold a sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Fastening {
    /// Number of fasteners.
    pub count: usize,
    /// Distances of the middles of the panels from the even opening, over the longer side of the
    /// sheet.
    pub off: Vec<f64>,
    /// Largest force of a fastener (N).
    pub force: f64,
    /// Part of the force that the edge of its hole bears.
    pub of_borne: f64,
    /// Largest D_peak of a ligament of the opened sheet; `None` for a law that predicts none.
    pub peak_damage: Option<f64>,
    /// Margin of the panels against leaving the plane; `None` if it is not known, and where too few
    /// fasteners hold the sheet in the plane.
    pub margin: Option<f64>,
    /// Whether a hinge leaves the training domain.
    pub leaves_domain: bool,
}

impl Fastening {
    /// How the fasteners of a scene hold its sheet, whose panels have their middles at `flat` and,
    /// opened evenly, at `even` (mm); `None` without an equilibrium next to a `known` one.
    pub(super) fn of(
        scene: &Scene,
        flat: &[[f64; 2]],
        even: &[[f64; 2]],
        known: &WarmStart,
    ) -> Option<Self> {
        let problem = scene.problem().ok()?;
        let response = problem.draft(&scene.start(), Some(known)).ok()?;
        let panels = &response.deployment.sheet.panels;
        let end = &response.state().configuration;
        let [width, height] = size(bounds(even.iter().copied()));
        let side = f64::max(width, height);
        let off = (panels.iter().enumerate())
            .map(|(k, panel)| distance(deployed(panel, end[k], flat[k]), even[k]) / side);
        let force = response.reactions.iter().map(|[x, y, _]| x.hypot(*y)).fold(0.0, f64::max);
        let damage = response.state().damage.iter();
        let peaks = damage.filter_map(|damage| DamageMeasure::Peak.known(damage));
        let mut held = Self {
            count: scene.config.supports.len(),
            off: off.collect(),
            force,
            of_borne: force / borne_by_hole(&scene.material, scene.config.supports[0].hole?),
            peak_damage: peaks.reduce(f64::max),
            margin: None,
            leaves_domain: false,
        };
        // The path costs more than its end.
        if held.suffices() {
            let deployment = problem.deploy(&scene.start()).ok()?;
            held.margin = Stability::new(scene, &problem, &deployment).map(|found| found.margin);
            held.leaves_domain = deployment.share_inside() < 1.0;
        }
        Some(held)
    }

    /// Whether more fasteners are not needed.
    pub fn suffices(&self) -> bool {
        let whole = self.peak_damage.is_none_or(|peak| peak < NEARLY_TORN);
        let stays = self.margin.is_none_or(|margin| margin >= MARGIN);
        self.unevenness() < EVEN && self.of_borne < 1.0 && whole && stays && !self.leaves_domain
    }

    /// Distance of the panels from the even opening over the longer side of the sheet, root mean
    /// square.
    pub fn unevenness(&self) -> f64 {
        rms_and_maximum(self.off.iter().copied())[0]
    }
}

/// Panels at which a sheet can be fastened.
pub(super) struct Candidates {
    /// The panels that hang at each panel.
    neighbours: Vec<Vec<usize>>,
    /// The panels with room for a hole.
    panels: Vec<usize>,
}

impl Candidates {
    pub(super) fn new(topology: &Topology) -> Self {
        let mut neighbours = vec![Vec::new(); topology.panel_count()];
        for site in &topology.sites {
            let [a, b] = [site.a.0, site.b.0];
            neighbours[a].push(b);
            neighbours[b].push(a);
        }
        let has_room = |panel: &usize| {
            topology.trims[*panel].as_ref().is_none_or(|trim| {
                distance_to_outline(MIDDLE, trim) > ROOM && contains(trim, MIDDLE)
            })
        };
        let panels = (0..topology.panel_count()).filter(has_room).collect();
        Self { neighbours, panels }
    }

    /// Some panels far from each other along the sheet, fewer if there are fewer: the first two, which
    /// open it, are the farthest apart.
    pub(super) fn spread(&self, count: usize) -> Vec<usize> {
        let mut some: Vec<usize> = self.farthest(&[0]).into_iter().collect();
        while some.len() < count.min(self.panels.len()) {
            some.extend(self.farthest(&some));
        }
        some
    }

    /// The panel that is the most hinges away from all of some.
    pub(super) fn farthest(&self, some: &[usize]) -> Option<usize> {
        let mut steps = vec![usize::MAX; self.neighbours.len()];
        some.iter().for_each(|panel| steps[*panel] = 0);
        let mut queue = VecDeque::from(some.to_vec());
        while let Some(panel) = queue.pop_front() {
            for &next in &self.neighbours[panel] {
                if steps[next] == usize::MAX {
                    steps[next] = steps[panel] + 1;
                    queue.push_back(next);
                }
            }
        }
        // Several hinges share the force of a fastener.
        let far = |panel: &usize| (steps[*panel], self.neighbours[*panel].len());
        self.panels.iter().copied().max_by_key(far)
    }

    /// The panel that is farthest from the even opening, where it is `off` by so much.
    pub(super) fn most_off(&self, off: &[f64]) -> Option<usize> {
        self.panels.iter().copied().max_by(|a, b| off[*a].total_cmp(&off[*b]))
    }
}
