//! The nodes of a meshed sheet at which it is held, pulled and supported by a table.

use crate::{Held, OutOfPlaneRestraint, Place, SheetProblem};
use mesher::{Part, SheetMesh};
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
    /// The nodes of each support, in the order of the problem.
    pub held: Vec<Vec<usize>>,
    /// The node of each load, in the middle of the thickness.
    pub pulled: Vec<usize>,
    /// The nodes of each driven rim, in the order of the problem.
    pub rims: Vec<Vec<usize>>,
    /// Nodes that cannot leave the plane, other than the nodes of supports.
    pub flat: Vec<usize>,
    /// Nodes of the lower face that a table supports.
    pub on_table: Vec<usize>,
}

impl SheetNodes {
    pub(crate) fn new(problem: &SheetProblem, mesh: &SheetMesh) -> Result<Self, Fault> {
        let mut held = Vec::with_capacity(problem.held.len());
        for support in &problem.held {
            held.push(mesh.through(&held_nodes(support, mesh)?));
        }
        let pulled = problem.pulled.iter().map(|pulled| {
            let nearest = mesh.nearest(Part::Panel(pulled.panel), pulled.at);
            let node = nearest.ok_or_else(|| no_nodes(pulled.panel))?;
            Ok(mesh.middle[node])
        });
        let pulled = pulled.collect::<Result<_, Fault>>()?;
        let rims = problem.rims.iter().map(|rim| {
            let nodes = mesh.rim(&problem.shape, rim.window, rim.side);
            mesh.through(&nodes)
        });
        let rims: Vec<Vec<usize>> = rims.collect();
        let fixed: BTreeSet<usize> = held.iter().chain(&rims).flatten().copied().collect();
        let panels = || {
            let panels = 0..problem.shape.panels.len();
            panels.flat_map(|panel| mesh.plane_nodes(Part::Panel(panel)))
        };
        let unless_fixed = |nodes: BTreeSet<usize>| nodes.difference(&fixed).copied().collect();
        let mut found = Self { held, pulled, rims, flat: Vec::new(), on_table: Vec::new() };
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
    let all = mesh.plane_nodes(part);
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
