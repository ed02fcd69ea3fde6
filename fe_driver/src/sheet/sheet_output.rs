//! What CalculiX prints of a sheet in an increment.

use crate::{Block, Printed, SheetModel, at_node, force_set, hinge_set, numbers};
use mesher::{ElementKind, MeshPart};

/// What a complete increment of a sheet prints.
#[derive(Debug)]
pub(crate) struct SheetLayout {
    /// The nodes in the middle of the thickness, in their order.
    middle: Vec<usize>,
    /// Number of supports and loads.
    forces: usize,
    hinges: usize,
    /// Gauss points of each element of a window; 0 for the elements of panels.
    points: Vec<usize>,
    is_dynamic: bool,
}

/// The printed output of one converged increment of a sheet.
#[derive(Debug, Default)]
pub(crate) struct SheetFrame {
    /// Time of the step.
    pub time: f64,
    /// Displacements of the nodes in the middle of the thickness (mm), in the order of the plane
    /// nodes.
    pub displacements: Vec<[f64; 3]>,
    /// Forces at the nodes of each support, then of each load (N).
    pub forces: Vec<Option<[f64; 3]>>,
    /// Internal energy of each window, then of the panels (N mm).
    pub energies: Vec<Option<f64>>,
    /// Kinetic energy (N mm).
    pub kinetic_energy: Option<f64>,
    /// Equivalent plastic strain at the Gauss points of each element; empty for panels.
    pub peeq: Vec<Vec<f64>>,
}

impl SheetLayout {
    pub(crate) fn new(model: &SheetModel) -> Self {
        let mesh = model.mesh;
        let points = mesh.elements.iter().enumerate();
        Self {
            middle: mesh.middle.clone(),
            forces: model.nodes.measured.len(),
            hinges: model.problem.shape.windows.len(),
            points: points
                .map(|(element, nodes)| match mesh.part(element) {
                    MeshPart::Window(_) => ElementKind::of(nodes).gauss_points(),
                    MeshPart::Panel(_) => 0,
                })
                .collect(),
            is_dynamic: model.problem.dynamic,
        }
    }

    /// The place of a set of elements in [`SheetFrame::energies`].
    fn index(&self, set: &str) -> Option<usize> {
        (0..self.hinges)
            .find(|hinge| hinge_set(*hinge) == set)
            .or((set == "PANELS").then_some(self.hinges))
    }
}

impl Printed for SheetFrame {
    type Layout = SheetLayout;

    fn begin(time: f64) -> Self {
        Self { time, ..Self::default() }
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn add(
        &mut self,
        block: Block,
        set: &str,
        fields: &[&str],
        layout: &SheetLayout,
    ) -> Option<()> {
        match block {
            Block::Displacements => {
                let (node, values) = at_node(fields)?;
                if layout.middle.get(self.displacements.len()) != Some(&node) {
                    return None;
                }
                self.displacements.push(values);
            }
            Block::TotalForce => {
                self.forces.resize(layout.forces, None);
                let index = (0..layout.forces).find(|index| force_set(*index) == set)?;
                self.forces[index] = Some(numbers(fields)?);
            }
            Block::Energy => {
                let [energy] = numbers(fields)?;
                self.energies.resize(layout.hinges + 1, None);
                self.energies[layout.index(set)?] = Some(energy);
            }
            Block::KineticEnergy => self.kinetic_energy = Some(numbers::<1>(fields)?[0]),
            Block::PlasticStrain => {
                let [element, point, value] = fields else {
                    return None;
                };
                let element = element.parse::<usize>().ok()?.checked_sub(1)?;
                self.peeq.resize(layout.points.len(), Vec::new());
                let strains = self.peeq.get_mut(element)?;
                if point.parse() != Ok(strains.len() + 1) || strains.len() == layout.points[element]
                {
                    return None;
                }
                strains.push(numbers::<1>(&[value])?[0]);
            }
            Block::Reactions | Block::Stress => return None,
        }
        Some(())
    }

    fn is_complete(&self, layout: &SheetLayout) -> bool {
        let strains = self.peeq.iter().map(Vec::len);
        self.displacements.len() == layout.middle.len()
            && self.forces.len() == layout.forces
            && self.forces.iter().all(Option::is_some)
            && self.energies.len() == layout.hinges + 1
            && self.energies.iter().all(Option::is_some)
            && self.kinetic_energy.is_some() == layout.is_dynamic
            && strains.eq(layout.points.iter().copied())
    }
}
