//! The nodes of a meshed sheet at which it is held, pulled and supported by a table.

use crate::{Held, OutOfPlaneRestraint, POINTS, Place, RigidBody, SheetProblem};
use mesher::{Panels, Part, SheetMesh};
use std::collections::BTreeSet;
use support::fault::Fault;

/// Largest distance of a node from the line on which a panel is held (mm).
const ON_LINE: f64 = 1e-6;
/// Distance of a window's points from its origin, over w_lig, from which a table supports them.
/// Nearer ones are the ligament, which folds.
const SUPPORTED: f64 = 1.45;

/// Nodes of a sheet problem; they count from 0.
#[derive(Clone, Debug)]
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
        match problem.shape.model {
            Panels::Rigid => Ok(Self::of_rigid_panels(problem, mesh)),
            Panels::Meshed => Self::of_meshed_panels(problem, mesh),
        }
    }

    fn of_rigid_panels(problem: &SheetProblem, mesh: &SheetMesh) -> Self {
        // After the control node.
        let bodies = RigidBody::of_panels(problem, mesh, mesh.nodes.len() + 1);
        let held = problem.held.iter().map(|held| {
            let first = bodies[held.panel].first;
            match held.place {
                Place::Point(_) => vec![first],
                Place::Panel | Place::Line(_) => (first..first + POINTS).collect(),
            }
        });
        let held: Vec<Vec<usize>> = held.collect();
        let fixed = held.concat();
        // The fourth point of a body follows the other three.
        let plane = bodies.iter().flat_map(|body| body.first..body.first + POINTS - 1);
        let of_arcs: BTreeSet<usize> =
            bodies.iter().flat_map(|body| body.arcs.iter().copied()).collect();
        let symmetric = mesh.middle.iter().copied();
        let symmetric = symmetric.filter(|n| problem.shape.half && !of_arcs.contains(n));
        let plane = plane.chain(symmetric);
        let measured = problem.held.iter().map(|held| held.panel);
        let measured = measured.chain(problem.pulled.iter().map(|pulled| pulled.panel));
        Self {
            measured: measured.map(|panel| bodies[panel].arcs.clone()).collect(),
            pulled: problem.pulled.iter().map(|pulled| bodies[pulled.panel].first).collect(),
            flat: match problem.restraint {
                OutOfPlaneRestraint::HeldFlat => plane.filter(|n| !fixed.contains(n)).collect(),
                OutOfPlaneRestraint::Table | OutOfPlaneRestraint::Nothing => Vec::new(),
            },
            on_table: Vec::new(),
            held,
            bodies,
        }
    }

    fn of_meshed_panels(problem: &SheetProblem, mesh: &SheetMesh) -> Result<Self, Fault> {
        let mut held = Vec::with_capacity(problem.held.len());
        for support in &problem.held {
            held.push(mesh.through(&held_nodes(support, mesh)?));
        }
        let pulled = problem.pulled.iter().map(|pulled| {
            let nearest = mesh.nearest(Part::Panel(pulled.panel), pulled.at);
            let node = nearest.ok_or_else(|| no_nodes(pulled.panel))?;
            Ok(mesh.middle[node])
        });
        let pulled = pulled.collect::<Result<Vec<_>, Fault>>()?;
        let fixed: BTreeSet<usize> = held.iter().flatten().copied().collect();
        let panels = || mesh.panels.iter().flatten().copied();
        let unless_fixed = |nodes: BTreeSet<usize>| nodes.difference(&fixed).copied().collect();
        let measured = held.iter().cloned().chain(pulled.iter().map(|node| vec![*node]));
        let mut found = Self {
            bodies: Vec::new(),
            measured: measured.collect(),
            held,
            pulled,
            flat: Vec::new(),
            on_table: Vec::new(),
        };
        match problem.restraint {
            OutOfPlaneRestraint::HeldFlat => {
                let plane: BTreeSet<usize> = panels().collect();
                let plane: Vec<usize> = plane.into_iter().collect();
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
}

fn no_nodes(panel: usize) -> Fault {
    Fault::from(format!("panel {panel} has no nodes where it is held or pulled"))
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
