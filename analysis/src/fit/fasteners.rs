//! The panels at which a sheet is held in its opened state.

use design::geometry::polygon::distance_to_outline;
use design::geometry::region::Region;
use design::sheet::topology::Topology;
use std::collections::VecDeque;

/// Panels a fastener, and the numbers of fasteners.
const PANELS: usize = 15;
const FASTENERS: [usize; 2] = [4, 12];
/// The middle of a cell, where a panel is fastened, and its least distance from an edge of the panel,
/// in sides.
const MIDDLE: [f64; 2] = [0.5; 2];
const ROOM: f64 = 0.15;

/// Panels far from each other along the sheet, beginning with the ends of its longest way.
pub(super) fn fastened(topology: &Topology) -> Vec<usize> {
    let [fewest, most] = FASTENERS;
    let count = (topology.panel_count() / PANELS).clamp(fewest, most);
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
    chosen
}
