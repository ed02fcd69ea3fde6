//! The nodes of a meshed sheet at which it is held, pulled and supported by a table.

use crate::{HeldPanel, OutOfPlaneRestraint, Place, Pulled, SheetProblem, real, write_element};
use hinge::STANDARD_GRAVITY;
use mesher::{MeshPart, Panels, SheetMesh};
use std::collections::BTreeSet;
use support::{Fault, add_line, fault};

/// Largest distance of a node from the line on which a panel is held (mm).
const ON_LINE: f64 = 1e-6;
/// Distance of a window's points from its origin, over w_lig, from which a table supports them.
/// Nearer ones are the ligament, which folds.
const SUPPORTED: f64 = 1.45;

/// Nodes of a sheet problem; they count from 0.
#[derive(Debug, Default)]
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
                    let nearest = mesh.nearest(MeshPart::Panel(*panel), *at);
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
                    let nodes = mesh.plane_nodes(MeshPart::Window(h)).into_iter();
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
fn held_nodes(support: &HeldPanel, mesh: &SheetMesh) -> Result<Vec<usize>, Fault> {
    let part = MeshPart::Panel(support.panel);
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

// A rigid panel in a deck: four points without elements, joined by stiff springs. The arcs of its
// windows depend linearly on their displacements.
//
// Unlike the rigid bodies of CalculiX, whose tangent lacks the moment of forces on a body that
// turns, this converges at large rotations.

/// Number of its points.
pub(crate) const POINTS: usize = 4;
/// Stiffness of its springs over Young's modulus times the thickness: panels then deform by about
/// a millionth of their size, and iterations still converge.
pub(crate) const STIFFNESS: f64 = 30.0;

/// Acceleration by gravity (mm/s^2).
pub(crate) const GRAVITY: f64 = 1e3 * STANDARD_GRAVITY;

/// A rigid panel; nodes count from 0.
#[derive(Debug)]
pub(crate) struct RigidBody {
    /// The corners of a tetrahedron, the first where the panel is held or pulled, and its centroid
    /// outside of its windows, in the flat sheet (mm).
    points: [[f64; 3]; POINTS + 1],
    /// Length of the three edges of the tetrahedron at its first corner (mm).
    size: f64,
    /// Its first point as a node; the others follow.
    pub first: usize,
    /// The nodes of its arcs through the thickness.
    pub arcs: Vec<usize>,
    /// Its mass outside of its windows (t).
    mass: f64,
}

impl RigidBody {
    /// The panels of a problem; the nodes of the first begin with `first`.
    pub(crate) fn of_panels(problem: &SheetProblem, mesh: &SheetMesh, first: usize) -> Vec<Self> {
        let body = |(panel, arcs): (usize, &Vec<usize>)| {
            let [area, x, y] = problem.shape.rest(panel);
            let held = problem.held.iter().filter_map(|held| match held.place {
                Place::Point(at) => (held.panel == panel).then_some(at),
                Place::Panel | Place::Line(_) => None,
            });
            let pulled = problem.pulled.iter().filter(|pulled| pulled.panel == panel);
            let [u, v] = held.chain(pulled.map(|pulled| pulled.at)).next().unwrap_or([x, y]);
            let size = area.sqrt();
            Self {
                points: [
                    [u, v, 0.0],
                    [u + size, v, 0.0],
                    [u, v + size, 0.0],
                    [u, v, size],
                    [x, y, 0.0],
                ],
                size,
                first: first + (POINTS + 1) * panel,
                arcs: mesh.through(arcs),
                mass: problem.density() * area * problem.shape.thickness,
            }
        };
        mesh.panels.iter().enumerate().map(body).collect()
    }

    /// The nodes at which a support holds it.
    pub(crate) fn held(&self, place: Place) -> Vec<usize> {
        match place {
            Place::Point(_) => vec![self.first],
            Place::Panel | Place::Line(_) => (self.first..self.first + POINTS).collect(),
        }
    }

    /// The node at its centroid.
    pub(crate) fn centre(&self) -> usize {
        self.first + POINTS
    }

    /// Its weight outside of its windows (N), for a unit vector along gravity.
    pub(crate) fn weight(&self, down: [f64; 3]) -> [f64; 3] {
        down.map(|part| GRAVITY * self.mass * part)
    }

    /// Its nodes, its springs in the set PANELS, numbered from `first` on, and three equations for
    /// each node of its arcs and its centroid; returns the number after the last.
    pub(crate) fn write(&self, d: &mut String, mut first: usize, mesh: &SheetMesh) -> usize {
        add_line!(d, "*NODE,NSET=BODIES");
        for (i, [x, y, z]) in self.points.into_iter().enumerate() {
            add_line!(d, "{},{},{},{}", self.first + i + 1, real(x), real(y), real(z));
        }
        add_line!(d, "*ELEMENT,TYPE=SPRINGA,ELSET=PANELS");
        for to in 0..POINTS {
            for from in 0..to {
                write_element(d, first, &[self.first + from, self.first + to]);
                first += 1;
            }
        }
        add_line!(d, "*EQUATION");
        let arcs = self.arcs.iter().map(|node| (*node, mesh.nodes[*node]));
        let [[u, v, _], .., centre] = self.points;
        for (node, [x, y, z]) in arcs.chain([(self.centre(), centre)]) {
            let [x, y, z] = [x - u, y - v, z].map(|along| along / self.size);
            for freedom in 1..=3 {
                add_line!(d, "{}\n{},{freedom},-1.", POINTS + 1, node + 1);
                for (point, share) in [1.0 - x - y - z, x, y, z].into_iter().enumerate() {
                    add_line!(d, "{},{freedom},{}", self.first + point + 1, real(share));
                }
            }
        }
        first
    }
}

impl SheetProblem {
    /// Density of the material (t/mm^3).
    pub(crate) fn density(&self) -> f64 {
        // kg/m^3 to t/mm^3.
        1e-12 * self.material.density_kg_m3
    }
}
