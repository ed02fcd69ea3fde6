//! The patch test of the node order and the extrusion: for a linear displacement prescribed on the
//! boundary of a real window mesh, the displacement must be linear inside, with the exact uniform
//! stress everywhere.

use crate::common::{design, film, rows, solved};
use fe_driver::{DeformationPath, StepControl, WindowModel, deck};
use hinge::HingeDeformation;
use mesher::{ElementKind, Gmsh, Tier, WindowMesh, WindowShape};
use std::collections::{HashMap, HashSet};
use std::fmt::Write;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// A small general displacement gradient.
const G: [[f64; 3]; 3] = [[1e-3, 4e-4, 2e-4], [-2e-4, -5e-4, 3e-4], [1e-4, -3e-4, 7e-4]];

fn displacement(x: &[f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (0..3).map(|j| G[i][j] * x[j]).sum())
}

/// Isotropic stress of the symmetric part of G, in the order xx, yy, zz, xy, xz, yz.
fn stress(young: f64, poisson: f64) -> [f64; 6] {
    let mu = young / (2.0 * (1.0 + poisson));
    let lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let trace = G[0][0] + G[1][1] + G[2][2];
    [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|(i, j)| {
        let volumetric = if i == j { lame * trace } else { 0.0 };
        volumetric + mu * (G[i][j] + G[j][i])
    })
}

/// Local node numbers of the faces of an element: lower, upper, sides.
fn faces_of(kind: ElementKind) -> Vec<Vec<usize>> {
    let n = kind.corners();
    let lower = [0..n, 2 * n..3 * n].into_iter().flatten().collect();
    let upper = [n..2 * n, 3 * n..4 * n].into_iter().flatten().collect();
    let side = |i: usize| {
        let j = (i + 1) % n;
        vec![i, j, n + j, n + i, 2 * n + i, 4 * n + j, 3 * n + i, 4 * n + i]
    };
    [lower, upper].into_iter().chain((0..n).map(side)).collect()
}

/// Nodes on the surface of the mesh, that is, of faces that belong to only one element.
fn surface(mesh: &WindowMesh) -> HashSet<usize> {
    let mut faces: HashMap<_, Vec<_>> = HashMap::new();
    for element in &mesh.elements {
        for face in faces_of(mesh.recipe.element()) {
            let nodes: Vec<_> = face.iter().map(|i| element[*i]).collect();
            let mut key = nodes.clone();
            key.sort_unstable();
            faces.entry(key).or_default().push(nodes);
        }
    }
    let single = faces.into_values().filter(|found| found.len() == 1);
    single.flatten().flatten().collect()
}

#[test]
fn a_linear_displacement_gives_bricks_the_exact_uniform_stress() {
    patch_test(Tier::Small);
}

#[test]
fn a_linear_displacement_gives_wedges_the_exact_uniform_stress() {
    patch_test(Tier::Paper);
}

fn patch_test(tier: Tier) {
    let folder = tempfile::tempdir().unwrap();
    let material = film();
    let gmsh = Gmsh::find().unwrap();
    let mesh = WindowShape { design: &design(60.0), thickness: 0.5, recipe: &tier.recipe() }
        .mesh(folder.path(), &gmsh, Duration::from_secs(60), &AtomicBool::new(false))
        .unwrap();

    // Nodes and elements are the same as in the usual deck; the material and the load are specific
    // to this test.
    let text = deck(&WindowModel {
        mesh: &mesh,
        path: &DeformationPath::straight(HingeDeformation::default()),
        material: &material,
        step: &StepControl::default(),
        print_all: false,
    });
    let mut text = text[..text.find("*MATERIAL").unwrap()].to_owned();
    let (young, poisson) = (material.young, material.poisson);
    writeln!(text, "*MATERIAL,NAME=M\n*ELASTIC\n{young},{poisson}").unwrap();
    writeln!(text, "*SOLID SECTION,ELSET=EALL,MATERIAL=M\n*STEP\n*STATIC\n*BOUNDARY").unwrap();
    let surface = surface(&mesh);
    for node in &surface {
        for (i, u) in displacement(&mesh.nodes[*node]).into_iter().enumerate() {
            writeln!(text, "{},{},{},{u:.12e}", node + 1, i + 1, i + 1).unwrap();
        }
    }
    writeln!(text, "*NODE PRINT,NSET=NALL\nU\n*EL PRINT,ELSET=EALL\nS\n*END STEP").unwrap();
    let dat = solved(&text);
    let (displacements, stresses) = dat.split_once("stresses").unwrap();
    let mut inside = 0;
    for row in rows(displacements, 4) {
        let node = row[0] as usize - 1;
        for (u, exact) in row[1..].iter().zip(displacement(&mesh.nodes[node])) {
            assert!((u - exact).abs() < 1e-7, "node {node}: {u} {exact}");
        }
        inside += usize::from(!surface.contains(&node));
    }
    assert!(inside > 100, "only {inside} nodes are free");
    let exact = stress(young, poisson);
    let found = rows(stresses, 8);
    let points = tier.recipe().element().gauss_points();
    assert_eq!(found.len(), points * mesh.elements.len());
    for row in found {
        for (s, exact) in row[2..].iter().zip(exact) {
            assert!((s - exact).abs() < 1e-4, "{row:?} {exact}");
        }
    }
}
