//! The nodes of a meshed sheet at which it is held, pulled and supported by a table.

use crate::{Held, OutOfPlaneRestraint, POINTS, Place, Pulled, RigidBody, SheetProblem};
use mesher::{Panels, Part, SheetMesh};
use std::collections::BTreeSet;
use support::fault;
use support::fault::Fault;

/// Largest distance of a node from the line on which a panel is held (mm).
const ON_LINE: f64 = 1e-6;
/// Distance of a window's points from its origin, over w_lig, from which a table supports them.
/// Nearer ones are the ligament, which folds.
const SUPPORTED: f64 = 1.45;

/// Nodes of a sheet problem; they count from 0.
#[derive(Clone, Debug, Default)]
pub(crate) struct SheetNodes {
    /// The rigid panels; none if panels are meshed.
    pub bodies: Vec<RigidBody>,
    /// The nodes of each support, in the order of the problem.
    pub held: Vec<Vec<usize>>,
    /// The node of each load, in the middle of the thickness.
    pub pulled: Vec<usize>,
    /// The nodes whose forces add up to the force of each support, then of each load.
    pub measured: Vec<Vec<usize>>,
    /// Nodes that cannot leave the plane, other than the nodes of supports.
    pub flat: Vec<usize>,
    /// Nodes of the lower face that a table supports.
    pub on_table: Vec<usize>,
}

impl SheetNodes {
    pub(crate) fn new(problem: &SheetProblem, mesh: &SheetMesh) -> Result<Self, Fault> {
        let mut found = Self::default();
        let is_rigid = problem.shape.model == Panels::Rigid;
        if is_rigid {
            // After the control node.
            found.bodies = RigidBody::of_panels(problem, mesh, mesh.nodes.len() + 1);
        }
        for support in &problem.held {
            let nodes = match found.bodies.get(support.panel) {
                Some(body) => body.held(support.place),
                None => mesh.through(&held_nodes(support, mesh)?),
            };
            found.measure(support.panel, nodes.clone());
            found.held.push(nodes);
        }
        for Pulled { panel, at, .. } in &problem.pulled {
            let node = match found.bodies.get(*panel) {
                Some(body) => body.first,
                None => {
                    let nearest = mesh.nearest(Part::Panel(*panel), *at);
                    mesh.middle[nearest.ok_or_else(|| no_nodes(*panel))?]
                }
            };
            found.measure(*panel, vec![node]);
            found.pulled.push(node);
        }
        let fixed: BTreeSet<usize> = found.held.iter().flatten().copied().collect();
        let panels = || mesh.panels.iter().flatten().copied();
        let of_panels: BTreeSet<usize> = panels().collect();
        let unless_fixed = |nodes: BTreeSet<usize>| nodes.difference(&fixed).copied().collect();
        match problem.restraint {
            OutOfPlaneRestraint::HeldFlat if is_rigid => {
                // The fourth point of a body follows the other three, as its arcs do.
                let plane =
                    found.bodies.iter().flat_map(|body| body.first..body.first + POINTS - 1);
                let of_windows = (0..mesh.middle.len()).filter(|node| !of_panels.contains(node));
                let symmetric = of_windows.filter(|_| problem.shape.half);
                let plane = plane.chain(symmetric.map(|node| mesh.middle[node]));
                found.flat = unless_fixed(plane.collect());
            }
            OutOfPlaneRestraint::HeldFlat => {
                let plane: Vec<usize> = of_panels.into_iter().collect();
                found.flat = unless_fixed(mesh.through(&plane).into_iter().collect());
            }
            OutOfPlaneRestraint::Table => {
                let corners: BTreeSet<usize> = (mesh.plane.faces.iter())
                    .flat_map(|face| face[..face.len() / 2].iter().copied())
                    .collect();
                let windows = problem.shape.windows.iter().enumerate();
                let in_windows = windows.flat_map(|(h, window)| {
                    let nodes = mesh.plane_nodes(Part::Window(h)).into_iter();
                    nodes.filter(move |node| {
                        let [x, y] = window.frame.local(mesh.plane.nodes[*node]);
                        x.hypot(y) > SUPPORTED * window.design.w_lig
                    })
                });
                let supported = panels().chain(in_windows);
                let supported = supported.filter(|node| corners.contains(node));
                found.on_table = unless_fixed(supported.map(|node| mesh.bottom[node]).collect());
            }
            OutOfPlaneRestraint::Nothing => {}
        }
        Ok(found)
    }

    /// Forces at `nodes` of a panel are a support's or a load's; on a rigid panel forces at its
    /// arcs.
    fn measure(&mut self, panel: usize, nodes: Vec<usize>) {
        let body = self.bodies.get(panel);
        self.measured.push(body.map_or(nodes, |body| body.arcs.clone()))
    }
}

fn no_nodes(panel: usize) -> Fault {
    fault!("panel {panel} has no nodes where it is held or pulled")
}

/// The plane nodes of a support.
fn held_nodes(support: &Held, mesh: &SheetMesh) -> Result<Vec<usize>, Fault> {
    let part = Part::Panel(support.panel);
    let all = mesh.panels[support.panel].clone();
    let nodes = match support.place {
        Place::Panel => all,
        Place::Point(at) => mesh.nearest(part, at).into_iter().collect(),
        Place::Line([from, to]) => {
            let along = [to[0] - from[0], to[1] - from[1]];
            let length = along[0].hypot(along[1]);
            let on_line = |node: &usize| {
                let [x, y] = [0, 1].map(|i| mesh.plane.nodes[*node][i] - from[i]);
                let at = (x * along[0] + y * along[1]) / length;
                let off = (x * along[1] - y * along[0]) / length;
                off.abs() < ON_LINE && at > -ON_LINE && at < length + ON_LINE
            };
            all.into_iter().filter(on_line).collect()
        }
    };
    let least = match support.place {
        Place::Point(_) => 1,
        Place::Panel | Place::Line(_) => 3,
    };
    if nodes.len() < least {
        return Err(no_nodes(support.panel));
    }
    Ok(nodes)
}
