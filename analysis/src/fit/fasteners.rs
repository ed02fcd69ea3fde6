//! The panels at which a sheet is fastened in its opened state, and how well they hold it.

use crate::mounting::borne_by_hole;
use crate::out_of_plane::Stability;
use design::geometry::polygon::{bounds, distance, distance_to_outline};
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
    /// opened evenly, at `even` (mm), turned by `turns` (rad); `None` without an equilibrium.
    pub(super) fn of(
        scene: &Scene,
        flat: &[[f64; 2]],
        even: &[[f64; 2]],
        turns: &[f64],
    ) -> Option<Self> {
        let (problem, start) = (scene.problem().ok()?, scene.start());
        let (_, sheet) = problem.cut(&start).ok()?;
        // From the middle to the reference point of a panel.
        let opened = sheet.panels.iter().zip(turns).enumerate().map(|(k, (panel, turn))| {
            let moved = deployed(panel, [0.0, 0.0, *turn], flat[k]);
            [even[k][0] - moved[0], even[k][1] - moved[1], *turn]
        });
        let response = problem.draft_near(&start, &opened.collect::<Vec<_>>()).ok()?;
        let end = &response.state().configuration;
        let off = (sheet.panels.iter().enumerate())
            .map(|(k, panel)| distance(deployed(panel, end[k], flat[k]), even[k]));
        let [low, high] = bounds(even.iter().copied());
        let side = f64::max(high[0] - low[0], high[1] - low[1]);
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
            let deployment = problem.deploy(&start).ok()?;
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

/// Panels far from each other along the sheet, in the order in which they are fastened: next is the
/// one nearest to those before it, whose hole has the shortest way.
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
    let apart = |one: usize, other: usize| {
        let [from, to] = [one, other].map(|panel| topology.places[panel]);
        from[0].abs_diff(to[0]).pow(2) + from[1].abs_diff(to[1]).pow(2)
    };
    let mut order: Vec<usize> = Vec::new();
    while !chosen.is_empty() {
        let of = |at: &usize| {
            let others = if order.is_empty() { &chosen } else { &order };
            let apart = others.iter().map(|other| apart(chosen[*at], *other));
            if order.is_empty() { apart.max() } else { apart.min() }
        };
        let next = (0..chosen.len()).max_by_key(of).unwrap_or_default();
        order.push(chosen.remove(next));
    }
    order
}
