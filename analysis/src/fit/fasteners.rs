//! The panels at which a sheet is fastened in its opened state, and how well they hold it.

use crate::mounting::borne_by_hole;
use crate::out_of_plane::Stability;
use design::equilibrium::warm_start::WarmStart;
use design::geometry::polygon::{bounds, distance, distance_to_outline, size};
use design::geometry::region::Region;
use design::sheet::kinematics::deployed;
use design::sheet::topology::Topology;
use scene::Scene;
use std::collections::VecDeque;
use support::statistics::rms_and_maximum;

/// Numbers of fasteners that are tried.
pub(super) const COUNTS: [usize; 7] = [3, 4, 6, 8, 12, 16, 24];
/// Distance of the panels from the even opening over the longer side of the sheet, root mean square,
/// up to which fasteners suffice.
const EVEN: f64 = 0.002;
/// Margin of the panels against leaving the plane up to which fasteners suffice.
const MARGIN: f64 = 1.5;
/// The middle of a cell, where a panel is fastened, and its least distance from an edge of the panel,
/// in sides.
const MIDDLE: [f64; 2] = [0.5; 2];
const ROOM: f64 = 0.15;
/// Diameter of the hole for a fastener (mm), such as a screw of 4 mm.
pub(super) const HOLE: f64 = 4.2;

/// How fasteners hold a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Number of fasteners.
    pub count: usize,
    /// Distance of the middles of the panels from the even opening over the longer side of the
    /// sheet, root mean square.
    pub off: f64,
    /// Largest force of a fastener (N).
    pub force: f64,
    /// Part of the force that the edge of its hole bears.
    pub of_borne: f64,
    /// Margin of the panels against leaving the plane; `None` if it is not known, and where too few
    /// fasteners hold the sheet in the plane.
    pub margin: Option<f64>,
    /// Whether a hinge leaves the training domain.
    pub leaves_domain: bool,
}

impl Held {
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
        let off = (panels.iter().enumerate())
            .map(|(k, panel)| distance(deployed(panel, end[k], flat[k]), even[k]));
        let [width, height] = size(bounds(even.iter().copied()));
        let side = f64::max(width, height);
        let force = response.reactions.iter().map(|[x, y, _]| x.hypot(*y)).fold(0.0, f64::max);
        let mut held = Self {
            count: scene.config.supports.len(),
            off: rms_and_maximum(off)[0] / side,
            force,
            of_borne: force / borne_by_hole(&scene.material, HOLE),
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
        let stays = self.margin.is_none_or(|margin| margin >= MARGIN);
        self.off < EVEN && self.of_borne < 1.0 && stays && !self.leaves_domain
    }
}

/// Panels far from each other along the sheet, in the order in which they are fastened.
pub(super) fn fastened(topology: &Topology, count: usize) -> Vec<usize> {
    let mut neighbours = vec![Vec::new(); topology.panel_count()];
    for site in &topology.sites {
        let [a, b] = [site.a.0, site.b.0];
        neighbours[a].push(b);
        neighbours[b].push(a);
    }
    // The numbers of hinges on the shortest way from a panel to the nearest of some.
    let steps_from = |some: &[usize]| {
        let mut steps = vec![usize::MAX; neighbours.len()];
        some.iter().for_each(|panel| steps[*panel] = 0);
        let mut queue = VecDeque::from(some.to_vec());
        while let Some(panel) = queue.pop_front() {
            for &next in &neighbours[panel] {
                if steps[next] == usize::MAX {
                    steps[next] = steps[panel] + 1;
                    queue.push_back(next);
                }
            }
        }
        steps
    };
    let has_room = |panel: &usize| {
        topology.trims[*panel].as_ref().is_none_or(|trim| {
            let room = distance_to_outline(MIDDLE, trim);
            room > ROOM && Region::union_of(vec![trim.to_vec()]).contains(MIDDLE)
        })
    };
    let panels: Vec<usize> = (0..topology.panel_count()).filter(has_room).collect();
    let farthest = |some: &[usize]| {
        let steps = steps_from(some);
        // Several hinges share the force of a fastener.
        let far = |panel: &usize| (steps[*panel], neighbours[*panel].len());
        panels.iter().copied().max_by_key(far).unwrap_or_default()
    };
    let mut chosen = vec![farthest(&[0])];
    while chosen.len() < count.min(panels.len()) {
        chosen.push(farthest(&chosen));
    }
    // The two farthest apart open the sheet.
    let apart = |[one, other]: &[usize; 2]| {
        let [from, to] = [one, other].map(|it| topology.places[chosen[*it]]);
        from[0].abs_diff(to[0]).pow(2) + from[1].abs_diff(to[1]).pow(2)
    };
    let pairs = (0..chosen.len()).flat_map(|other| (0..other).map(move |one| [one, other]));
    if let Some([one, other]) = pairs.max_by_key(apart) {
        chosen.swap(0, one);
        chosen.swap(1, other);
    }
    chosen
}
