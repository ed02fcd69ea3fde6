//! A rigid panel in a deck: four points without elements, joined by stiff springs. The arcs of its
//! windows depend linearly on their displacements.
//!
//! Unlike the rigid bodies of CalculiX, whose tangent lacks the moment of forces on a body that
//! turns, this converges at large rotations.

use crate::{Place, SheetProblem, real, write_element};
use hinge::STANDARD_GRAVITY;
use mesher::SheetMesh;
use support::add_line;

/// Number of its points.
pub(crate) const POINTS: usize = 4;
/// Stiffness of its springs over Young's modulus times the thickness: panels then deform by about
/// a millionth of their size, and iterations still converge.
pub(crate) const STIFFNESS: f64 = 30.0;

/// Acceleration by gravity (mm/s^2).
pub(crate) const GRAVITY: f64 = 1e3 * STANDARD_GRAVITY;

/// A rigid panel; nodes count from 0.
#[derive(Clone, Debug)]
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
