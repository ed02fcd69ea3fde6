//! A rigid panel in a deck: four points without elements, joined by stiff springs, on whose
//! displacements those of the arcs of its windows depend linearly.
//!
//! Unlike the rigid bodies of CalculiX, whose tangent lacks the moment of forces on a body that
//! turns, this converges at large rotations.

use crate::{Place, SheetProblem, real, write_element};
use hinge::STANDARD_GRAVITY;
use mesher::SheetMesh;
use support::add_line;

/// Number of its points.
pub(crate) const POINTS: usize = 4;
/// Stiffness of its springs over Young's modulus times the thickness: panels then deform by less
/// than a millionth of their size, and iterations still converge.
const STIFFNESS: f64 = 30.0;

/// Acceleration by gravity (mm/s^2).
pub(crate) const GRAVITY: f64 = 1e3 * STANDARD_GRAVITY;

/// A rigid panel. Its points are the corners of a tetrahedron, the first one where the panel is held
/// or pulled; nodes count from 0.
#[derive(Clone, Debug)]
pub(crate) struct RigidBody {
    /// Its first point, in the flat sheet (mm).
    at: [f64; 2],
    /// Distance of the other points from it (mm).
    size: f64,
    /// Its first point as a node; the others follow, and after them its centroid.
    pub first: usize,
    /// The nodes of its arcs through the thickness.
    pub arcs: Vec<usize>,
    /// Its centroid outside of its windows, in the middle of the thickness (mm).
    centroid: [f64; 3],
    /// Its mass outside of its windows (t).
    mass: f64,
}

impl RigidBody {
    /// The panels of a problem; the nodes of the first begin with `first`.
    pub(crate) fn of_panels(problem: &SheetProblem, mesh: &SheetMesh, first: usize) -> Vec<Self> {
        let body = |(panel, arcs): (usize, &Vec<usize>)| {
            let points = arcs.iter().map(|node| mesh.plane.nodes[*node]);
            let count = points.len().max(1) as f64;
            let sum = points.clone().fold([0.0; 2], |sum, p| [0, 1].map(|i| sum[i] + p[i]));
            let at = problem.reference(panel).unwrap_or(sum.map(|sum| sum / count));
            let distance = points.map(|[x, y]| (x - at[0]).hypot(y - at[1]));
            let [area, x, y] = problem.shape.rest(panel);
            Self {
                at,
                size: distance.fold(0.0, f64::max),
                first: first + (POINTS + 1) * panel,
                arcs: mesh.through(arcs),
                centroid: [x, y, 0.0],
                mass: problem.density() * area * problem.shape.thickness,
            }
        };
        mesh.panels.iter().enumerate().map(body).collect()
    }

    /// The node at its centroid.
    pub(crate) fn centre(&self) -> usize {
        self.first + POINTS
    }

    /// Its weight outside of its windows (N), for a unit vector along gravity.
    pub(crate) fn weight(&self, down: [f64; 3]) -> [f64; 3] {
        down.map(|part| GRAVITY * self.mass * part)
    }

    /// Its points, then its centroid.
    fn positions(&self) -> [[f64; 3]; POINTS + 1] {
        let ([x, y], size) = (self.at, self.size);
        let point = |dx, dy, z| [x + dx, y + dy, z];
        let [o, a, b, c] = [
            point(0.0, 0.0, 0.0),
            point(size, 0.0, 0.0),
            point(0.0, size, 0.0),
            point(0.0, 0.0, size),
        ];
        [o, a, b, c, self.centroid]
    }

    /// Its nodes, its springs in the set PANELS, numbered from `first` on, and the equations of its
    /// arcs; returns the number after the last.
    pub(crate) fn write(&self, d: &mut String, first: usize, mesh: &SheetMesh) -> usize {
        add_line!(d, "*NODE,NSET=BODIES");
        for (i, [x, y, z]) in self.positions().into_iter().enumerate() {
            add_line!(d, "{},{},{},{}", self.first + i + 1, real(x), real(y), real(z));
        }
        add_line!(d, "*ELEMENT,TYPE=SPRINGA,ELSET=PANELS");
        let pairs = (0..POINTS).flat_map(|to| (0..to).map(move |from| [from, to]));
        for (i, ends) in pairs.enumerate() {
            write_element(d, first + i, &ends.map(|end| self.first + end));
        }
        add_line!(d, "*EQUATION");
        let arcs = self.arcs.iter().map(|node| (*node, mesh.nodes[*node]));
        for (node, position) in arcs.chain([(self.centre(), self.centroid)]) {
            self.write_equations(d, node, position);
        }
        first + POINTS * (POINTS - 1) / 2
    }

    /// The three equations of a node at a position of the flat sheet.
    fn write_equations(&self, d: &mut String, node: usize, [x, y, z]: [f64; 3]) {
        let [x, y, z] = [x - self.at[0], y - self.at[1], z].map(|along| along / self.size);
        for freedom in 1..=3 {
            add_line!(d, "{}\n{},{freedom},-1.", POINTS + 1, node + 1);
            for (point, share) in [1.0 - x - y - z, x, y, z].into_iter().enumerate() {
                add_line!(d, "{},{freedom},{}", self.first + point + 1, real(share));
            }
        }
    }
}

impl SheetProblem {
    /// Stiffness of the springs of a rigid panel (N/mm).
    pub(crate) fn rigid_stiffness(&self) -> f64 {
        STIFFNESS * self.material.young * self.shape.thickness
    }

    /// The point at which a panel is held or pulled.
    fn reference(&self, panel: usize) -> Option<[f64; 2]> {
        let held = self.held.iter().filter(|held| held.panel == panel);
        let held = held.filter_map(|held| match held.place {
            Place::Point(at) => Some(at),
            Place::Panel | Place::Line(_) => None,
        });
        let pulled = self.pulled.iter().filter(|pulled| pulled.panel == panel);
        held.chain(pulled.map(|pulled| pulled.at)).next()
    }

    /// Density of the material (t/mm^3).
    pub(crate) fn density(&self) -> f64 {
        // From kg/m^3.
        1e-12 * self.material.density_kg_m3
    }
}
