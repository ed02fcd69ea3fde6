//! The window as solid elements: the plane mesh extruded to layers, with the imperfection in z.
//!
//! The sheet's midplane is not quite flat, or it would never buckle: z is lifted by
//! t exp(-(x/w)^2 - (y/w)^2) (1 - (r/r_win)^4), stress-free and zero on the arcs. One thickness
//! is what the paper measured on a cut hinge (section 4.1). Amplitude and widths of the bump are
//! the recipe's.

use crate::geo;
use crate::gmsh::Gmsh;
use crate::msh::{Boundary, MshError, PlaneMesh, read_msh};
use crate::quality::MeshDefect;
use crate::tier::MeshRecipe;
use crate::tool::{self, ToolError};
use crate::window::Window;
use hinge::{HingeDesign, InvalidDesign};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// A window of solid elements of one kind; indices count from 0.
#[derive(Clone, Debug)]
pub struct WindowMesh {
    pub design: HingeDesign,
    /// mm
    pub thickness: f64,
    pub recipe: MeshRecipe,
    /// The plane mesh that was extruded.
    pub plane: PlaneMesh,
    /// Node positions in the hinge frame, imperfection included (mm).
    pub nodes: Vec<[f64; 3]>,
    /// Elements in the node order of their [`ElementKind`](crate::ElementKind), layer by layer.
    pub elements: Vec<Vec<usize>>,
    /// Nodes of the held arc, through the thickness.
    pub arc_a: Vec<usize>,
    /// Nodes of the driven arc, through the thickness.
    pub arc_b: Vec<usize>,
    /// Nodes of the sheet's lower face.
    pub bottom: Vec<usize>,
    /// Undeformed volume that each Gauss point of each element stands for (mm^3).
    pub gauss_volumes: Vec<Vec<f64>>,
}

/// Why there is no mesh.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    #[error(transparent)]
    Design(#[from] InvalidDesign),
    #[error("thickness = {0} mm violates thickness > 0")]
    Thickness(f64),
    #[error(transparent)]
    Gmsh(#[from] ToolError),
    #[error("gmsh wrote no usable mesh: {0}")]
    Read(#[from] MshError),
    #[error(
        "the mesh of w_lig = {w_lig} mm, alpha = {alpha_deg} deg is refused: {defect}; \
         try a finer tier"
    )]
    Defect {
        w_lig: f64,
        alpha_deg: f64,
        defect: MeshDefect,
    },
    #[error("{path}: {source}", path = .path.display())]
    File {
        path: PathBuf,
        source: std::io::Error,
    },
}

/// Meshes the window of `design`; `scratch` keeps gmsh's script, log and mesh.
pub fn mesh_window(
    design: &HingeDesign,
    thickness: f64,
    recipe: &MeshRecipe,
    scratch: &Path,
    gmsh: &Gmsh,
) -> Result<WindowMesh, MeshError> {
    design.validate()?;
    if !(thickness.is_finite() && thickness > 0.0) {
        return Err(MeshError::Thickness(thickness));
    }
    let script = geo::script(&Window(design), &recipe.plane);
    let at = |path: &Path| {
        let path = path.to_owned();
        move |source| MeshError::File { path, source }
    };
    let geo = scratch.join("window.geo");
    std::fs::write(&geo, script).map_err(at(&geo))?;
    let msh = scratch.join("window.msh");
    tool::remove_stale(&msh).map_err(at(&msh))?;
    gmsh.mesh(scratch)?;
    let bytes = match std::fs::read(&msh) {
        // gmsh has failed without saying so: the reader tells what is missing.
        Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
        read => read.map_err(at(&msh))?,
    };
    let mesh = WindowMesh::extrude(
        *design,
        thickness,
        *recipe,
        read_msh(&bytes, recipe.element())?,
    );
    match mesh.quality() {
        Ok(_) => Ok(mesh),
        Err(defect) => Err(MeshError::Defect {
            w_lig: design.w_lig,
            alpha_deg: design.alpha.to_degrees(),
            defect,
        }),
    }
}

impl WindowMesh {
    /// Extrudes a plane mesh to the layers of `recipe` through z in [-t/2, t/2].
    fn extrude(design: HingeDesign, thickness: f64, recipe: MeshRecipe, plane: PlaneMesh) -> Self {
        let layers = recipe.layers;
        let levels = Levels::of(&plane, layers);
        let nodes: Vec<_> = levels
            .nodes
            .iter()
            .map(|(level, node)| {
                let [x, y] = plane.nodes[*node];
                let z = thickness * (*level as f64 / (2 * layers) as f64 - 0.5);
                [
                    x,
                    y,
                    z + recipe.imperfection.height(&design, thickness, x, y),
                ]
            })
            .collect();
        let elements: Vec<_> = (0..layers)
            .flat_map(|layer| plane.faces.iter().map(move |face| (layer, face)))
            .map(|(layer, face)| levels.element(layer, face))
            .collect();
        let gauss_volumes = elements
            .iter()
            .map(|element| {
                let positions: Vec<_> = element.iter().map(|node| nodes[*node]).collect();
                recipe.element().gauss_volumes(&positions)
            })
            .collect();
        Self {
            design,
            thickness,
            recipe,
            arc_a: levels.through(&plane.nodes_on(Boundary::ArcA)),
            arc_b: levels.through(&plane.nodes_on(Boundary::ArcB)),
            bottom: (0..plane.nodes.len()).collect(),
            plane,
            nodes,
            elements,
            gauss_volumes,
        }
    }

    /// Volume of the meshed window (mm^3).
    pub fn volume(&self) -> f64 {
        self.gauss_volumes.iter().flatten().sum()
    }
}

/// Numbering of the extruded nodes, level by level from the bottom. Even levels carry every plane
/// node, the odd ones between (the middle of the layers) only the corners.
struct Levels {
    /// Level and plane node of each extruded node.
    nodes: Vec<(usize, usize)>,
    /// The extruded node on each level over each plane node.
    ids: Vec<Vec<Option<usize>>>,
}

impl Levels {
    fn of(plane: &PlaneMesh, layers: usize) -> Self {
        let mut is_corner = vec![false; plane.nodes.len()];
        for face in &plane.faces {
            let corners = face.len() / 2;
            face[..corners]
                .iter()
                .for_each(|node| is_corner[*node] = true);
        }
        let mut nodes = Vec::new();
        let ids = (0..=2 * layers)
            .map(|level| {
                let mut number = |node| {
                    nodes.push((level, node));
                    nodes.len() - 1
                };
                let carries = |node: &usize| level % 2 == 0 || is_corner[*node];
                (0..plane.nodes.len())
                    .map(|node| carries(&node).then(|| number(node)))
                    .collect()
            })
            .collect();
        Self { nodes, ids }
    }

    /// The element over a face: bottom and top corners, bottom and top mid-sides, verticals.
    fn element(&self, layer: usize, face: &[usize]) -> Vec<usize> {
        let (bottom, middle, top) = (2 * layer, 2 * layer + 1, 2 * layer + 2);
        let (corners, mid_sides) = face.split_at(face.len() / 2);
        [
            (bottom, corners),
            (top, corners),
            (bottom, mid_sides),
            (top, mid_sides),
            (middle, corners),
        ]
        .into_iter()
        .flat_map(|(level, nodes)| nodes.iter().map(move |node| (level, *node)))
        .map(|(level, node)| {
            self.ids[level][node].expect("corners are on every level, mid-sides on the even ones")
        })
        .collect()
    }

    /// The extruded nodes over plane nodes, on all levels.
    fn through(&self, plane: &[usize]) -> Vec<usize> {
        let on_level = |ids: &Vec<Option<usize>>| plane.iter().filter_map(|n| ids[*n]).collect();
        self.ids.iter().flat_map::<Vec<_>, _>(on_level).collect()
    }
}
