//! The patch test, through our own node order and extrusion: a linear displacement on the boundary
//! of a real two-layer window mesh must be linear inside, with the exact uniform stress everywhere.

mod common;

use common::{design, film, problem};
use fe_driver::{Ccx, deck};
use mesher::{Gmsh, Tier, WindowMesh, mesh_window};
use std::collections::{HashMap, HashSet};
use std::fmt::Write;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// A general displacement gradient, small.
const G: [[f64; 3]; 3] = [
    [1e-3, 4e-4, 2e-4],
    [-2e-4, -5e-4, 3e-4],
    [1e-4, -3e-4, 7e-4],
];

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

/// Nodes on the surface of the mesh: of a face that only one brick has.
fn surface(mesh: &WindowMesh) -> HashSet<usize> {
    /// Corners, then mid-sides, of the faces of a 20-node brick.
    const FACES: [[usize; 8]; 6] = [
        [0, 1, 2, 3, 8, 9, 10, 11],
        [4, 5, 6, 7, 12, 13, 14, 15],
        [0, 1, 5, 4, 8, 17, 12, 16],
        [1, 2, 6, 5, 9, 18, 13, 17],
        [2, 3, 7, 6, 10, 19, 14, 18],
        [3, 0, 4, 7, 11, 16, 15, 19],
    ];
    let mut faces: HashMap<_, Vec<_>> = HashMap::new();
    for element in &mesh.elements {
        for face in FACES {
            let nodes = face.map(|i| element[i]);
            let mut key = nodes;
            key.sort_unstable();
            faces.entry(key).or_default().push(nodes);
        }
    }
    let single = faces.into_values().filter(|found| found.len() == 1);
    single.flatten().flatten().collect()
}

#[test]
fn a_linear_displacement_gives_the_exact_uniform_stress() {
    let folder = tempfile::tempdir().unwrap();
    let material = film();
    let gmsh = Gmsh::find().unwrap();
    let mesh = mesh_window(&design(60.0), 0.5, Tier::Small, folder.path(), &gmsh).unwrap();

    // Nodes and elements as every deck has them; the load is this test's own.
    let problem = problem(60.0, [0.0, 0.0], 1.0);
    let text = deck(&mesh, &problem.ray, &material, &problem.step);
    let mut text = text[..text.find("*MATERIAL").unwrap()].to_owned();
    let (young, poisson) = (material.young, material.poisson);
    writeln!(text, "*MATERIAL,NAME=M\n*ELASTIC\n{young},{poisson}").unwrap();
    writeln!(
        text,
        "*SOLID SECTION,ELSET=EALL,MATERIAL=M\n*STEP\n*STATIC\n*BOUNDARY"
    )
    .unwrap();
    let surface = surface(&mesh);
    for node in &surface {
        for (i, u) in displacement(&mesh.nodes[*node]).into_iter().enumerate() {
            writeln!(text, "{},{},{},{u:.12e}", node + 1, i + 1, i + 1).unwrap();
        }
    }
    writeln!(
        text,
        "*NODE PRINT,NSET=NALL\nU\n*EL PRINT,ELSET=EALL\nS\n*END STEP"
    )
    .unwrap();
    std::fs::write(folder.path().join("patch.inp"), text).unwrap();
    let limit = Duration::from_secs(60);
    let ccx = Ccx::find().unwrap();
    let run = ccx.run(folder.path(), "patch", limit, &AtomicBool::new(false));
    let run = run.unwrap();
    let log = mesher::tool::tail(&folder.path().join("patch.log"));
    assert!(run.finished, "{run:?} {log}");

    let dat = std::fs::read_to_string(folder.path().join("patch.dat")).unwrap();
    let (displacements, stresses) = dat.split_once("stresses").unwrap();
    let rows = |text: &str, fields: usize| -> Vec<Vec<f64>> {
        let numbers = |line: &str| line.split_whitespace().map(|f| f.parse().ok()).collect();
        let rows = text.lines().filter_map(numbers);
        rows.filter(|row: &Vec<f64>| row.len() == fields).collect()
    };
    let mut inside = 0;
    for row in rows(displacements, 4) {
        let node = row[0] as usize - 1;
        for (u, exact) in row[1..].iter().zip(displacement(&mesh.nodes[node])) {
            assert!((u - exact).abs() < 1e-7, "node {node}: {u} {exact}");
        }
        inside += usize::from(!surface.contains(&node));
    }
    assert!(inside > 100, "only {inside} nodes were free");
    let exact = stress(young, poisson);
    let found = rows(stresses, 8);
    assert_eq!(found.len(), 8 * mesh.elements.len());
    for row in found {
        for (s, exact) in row[2..].iter().zip(exact) {
            assert!((s - exact).abs() < 1e-4, "{row:?} {exact}");
        }
    }
}
