//! CalculiX with the generated decks, compared with closed-form solutions: the bar, the cantilever,
//! the plate strip, the elastica, and rigid motions of a whole window.

use crate::common::{design, film, problem, rows, solved};
use fe_driver::{DeformationPath, StepControl, WindowModel, deck};
use hinge::{HingeDeformation, SheetMaterial};
use mesher::{Gmsh, Tier, WindowMesh, WindowShape};
use std::fmt::Write;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// A box of 20-node bricks, in the node order of this crate; nodes count from 0, in decks from 1.
struct Bricks {
    nodes: Vec<[f64; 3]>,
    elements: Vec<Vec<usize>>,
}

impl Bricks {
    /// A box with a corner at the origin, with `n` bricks along each edge.
    fn new(n: [usize; 3], size: [f64; 3]) -> Self {
        // Points at half of the bricks' spacing: corners have no odd index, mid-sides have one.
        let mut ids = std::collections::HashMap::new();
        let mut nodes = Vec::new();
        for k in 0..=2 * n[2] {
            for j in 0..=2 * n[1] {
                for i in 0..=2 * n[0] {
                    if i % 2 + j % 2 + k % 2 <= 1 {
                        ids.insert([i, j, k], nodes.len());
                        let at = [i, j, k];
                        nodes.push([0, 1, 2].map(|a| size[a] * at[a] as f64 / (2 * n[a]) as f64));
                    }
                }
            }
        }
        let ring = [[0, 0], [2, 0], [2, 2], [0, 2]];
        let middles = [[1, 0], [2, 1], [1, 2], [0, 1]];
        let places: Vec<_> = [(ring, 0), (ring, 2), (middles, 0), (middles, 2), (ring, 1)]
            .into_iter()
            .flat_map(|(plane, k)| plane.map(|[i, j]| [i, j, k]))
            .collect();
        let mut elements = Vec::new();
        for k in 0..n[2] {
            for j in 0..n[1] {
                for i in 0..n[0] {
                    let id = |p: &[usize; 3]| ids[&[2 * i + p[0], 2 * j + p[1], 2 * k + p[2]]];
                    elements.push(places.iter().map(id).collect());
                }
            }
        }
        Self { nodes, elements }
    }

    /// Nodes, elements, and the sets FACE0..FACE5: x = 0, x = end, y = 0, and so on.
    fn deck(&self) -> String {
        let mut d = "*NODE,NSET=NALL\n".to_owned();
        for (i, [x, y, z]) in self.nodes.iter().enumerate() {
            writeln!(d, "{},{x:.11e},{y:.11e},{z:.11e}", i + 1).unwrap();
        }
        writeln!(d, "*ELEMENT,TYPE=C3D20R,ELSET=EALL").unwrap();
        for (i, element) in self.elements.iter().enumerate() {
            let ids: Vec<_> = element.iter().map(|n| (n + 1).to_string()).collect();
            let (first, rest) = ids.split_at(15);
            writeln!(d, "{},{},\n{}", i + 1, first.join(","), rest.join(",")).unwrap();
        }
        for axis in 0..3 {
            let end = self.nodes.iter().map(|p| p[axis]).fold(0.0, f64::max);
            for (side, value) in [0.0, end].into_iter().enumerate() {
                writeln!(d, "*NSET,NSET=FACE{}", 2 * axis + side).unwrap();
                for (i, p) in self.nodes.iter().enumerate() {
                    if (p[axis] - value).abs() < 1e-9 {
                        writeln!(d, "{},", i + 1).unwrap();
                    }
                }
            }
        }
        d
    }
}

/// The material block of the generated decks.
fn material_block(material: &SheetMaterial) -> String {
    let rest = HingeDeformation::default();
    let text = window_deck(&window(), &DeformationPath::straight(rest), material);
    let (from, to) = (text.find("*MATERIAL"), text.find("*SOLID SECTION"));
    text[from.unwrap()..to.unwrap()].to_owned()
}

/// The paper's hinge at 60 deg on the coarsest mesh.
fn window() -> WindowMesh {
    let folder = tempfile::tempdir().unwrap();
    let (gmsh, recipe) = (Gmsh::find().unwrap(), Tier::Tiny.recipe());
    WindowShape { design: &design(60.0), thickness: 0.5, recipe: &recipe }
        .mesh(folder.path(), &gmsh, Duration::from_secs(60), &AtomicBool::new(false))
        .unwrap()
}

fn window_deck(mesh: &WindowMesh, path: &DeformationPath, material: &SheetMaterial) -> String {
    deck(&WindowModel { mesh, path, material, step: &StepControl::default(), print_all: false })
}

/// Reference: the hardening table. A bar stretched to a true strain of 0.5 has the tabulated true
/// stress at its plastic strain, both in the drop after the yield peak and during hardening.
#[test]
fn a_bar_in_tension_follows_the_tabulated_curve() {
    let film = film();
    let bar = Bricks::new([1, 1, 1], [1.0, 1.0, 1.0]);
    let stretch = 0.5_f64.exp() - 1.0;
    let dat = solved(&format!(
        "{}{}*SOLID SECTION,ELSET=EALL,MATERIAL=SHEET\n\
         *STEP,NLGEOM,INC=500\n*STATIC\n0.005,1.,1e-6,0.02\n\
         *BOUNDARY\nFACE0,1,1,0.\nFACE2,2,2,0.\nFACE4,3,3,0.\nFACE1,1,1,{stretch}\n\
         *EL PRINT,ELSET=EALL,FREQUENCY=1\nPEEQ,S\n*END STEP\n",
        bar.deck(),
        material_block(&film)
    ));
    let (strains, stresses) = (rows(&dat, 3), rows(&dat, 8));
    assert_eq!(strains.len(), stresses.len());
    let tabulated = |strain: f64| {
        let after = film.plastic.partition_point(|row| row[1] < strain);
        let ([s0, e0], [s1, e1]) = (film.plastic[after - 1], film.plastic[after]);
        s0 + (s1 - s0) * (strain - e0) / (e1 - e0)
    };
    let mut plastic = 0;
    for (strain, stress) in strains.iter().zip(&stresses) {
        if strain[2] > 1e-3 {
            let expected = tabulated(strain[2]);
            let error = (stress[2] - expected).abs() / expected;
            assert!(error < 0.005, "{strain:?} {stress:?} {expected}");
            plastic += 1;
        }
        assert!(stress[3..].iter().all(|s| s.abs() < 0.1), "{stress:?}");
    }
    assert!(plastic > 100, "{plastic}");
    // The sum of elastic and plastic strain is the total strain; CalculiX gives 1.5 to 2 % more
    // plastic strain.
    let last = strains.last().unwrap()[2];
    let expected = 0.5 - tabulated(last) / film.young;
    assert!((last / expected - 1.0).abs() < 0.025, "{last} {expected}");
}

/// Reference: beam theory, P = 3 E I delta / L^3; thin-plate theory for a strip without lateral
/// contraction, where E is replaced by E / (1 - nu^2); and the elastica, whose tip moves by
/// 0.493457 L and 0.713792 L under P = 2 and 5 E I / L^2 (Bisshopp and Drucker 1945). The strip has
/// two layers of bricks and is 40 times as long as thick.
#[test]
fn a_cantilever_a_plate_strip_and_an_elastica_bend_as_theory_says() {
    let film = film();
    let (length, breadth, thickness) = (20.0, 0.1, 0.5);
    let strip = Bricks::new([20, 1, 2], [length, breadth, thickness]);
    let plate = film.young / (1.0 - film.poisson.powi(2));
    // The clamp fixes the slope and the middle plane; the thickness may change. The tip may rotate.
    let middle = |x: f64| {
        let places = strip.nodes.iter().enumerate();
        let middle =
            places.filter(move |(_, p)| p[0] == x && (p[2] - 0.5 * thickness).abs() < 1e-9);
        middle.map(|(i, _)| format!("{},\n", i + 1)).collect::<String>()
    };
    let deck = format!(
        "{}*NSET,NSET=CLAMP\n{}*NSET,NSET=TIP\n{}*MATERIAL,NAME=M\n*ELASTIC\n{},{}\n\
         *SOLID SECTION,ELSET=EALL,MATERIAL=M\n",
        strip.deck(),
        middle(0.0),
        middle(length),
        film.young,
        film.poisson
    );
    for (held, step, young, delta, load) in [
        ("", "*STEP\n*STATIC", film.young, 0.005, 0.015),
        ("NALL,2,2,0.\n", "*STEP\n*STATIC", plate, 0.005, 0.015),
        ("", "*STEP,NLGEOM\n*STATIC\n0.1,1.", film.young, 0.493_457, 2.0),
        ("", "*STEP,NLGEOM\n*STATIC\n0.1,1.", film.young, 0.713_792, 5.0),
    ] {
        let dat = solved(&format!(
            "{deck}{step}\n*BOUNDARY\nFACE0,1,1,0.\nCLAMP,3,3,0.\nFACE2,2,2,0.\n\
             {held}TIP,3,3,{}\n*NODE PRINT,NSET=TIP\nRF\n*END STEP\n",
            delta * length
        ));
        let (_, last) = dat.rsplit_once("forces (fx,fy,fz)").unwrap();
        let force: f64 = rows(last, 4).iter().map(|row| row[3]).sum();
        let expected = load * young * breadth * thickness.powi(3) / (12.0 * length.powi(2));
        assert!((force / expected - 1.0).abs() < 0.01, "{held}{delta}: {force} {expected}");
    }
}

/// The deck of a window in which panel A also rotates about O, by `beta` (rad) at the end. If the
/// path of panel B includes the same rotation, it is superposed on both panels.
fn with_panel_a_turned(mesh: &WindowMesh, path: &DeformationPath, beta: f64) -> String {
    let text = window_deck(mesh, path, &film());
    let turner = mesh.nodes.len() + 3;
    let tip = mesh.design.tip();
    let mut added = format!("*NODE,NSET=TURNER\n{turner},0.,0.,0.\n*EQUATION\n");
    for index in &mesh.arc_a {
        let node = index + 1;
        let [x, y] = [0, 1].map(|i| mesh.nodes[*index][i] - tip[i]);
        for (freedom, by_cos, by_sin) in [(1, -x, y), (2, -y, -x)] {
            let terms = format!("{turner},1,{by_cos:.11e},{turner},2,{by_sin:.11e}");
            writeln!(added, "3\n{node},{freedom},1.,{terms}").unwrap();
        }
    }
    for (i, value) in [|b: f64| b.cos() - 1.0, f64::sin].into_iter().enumerate() {
        writeln!(added, "*AMPLITUDE,NAME=A{i}").unwrap();
        for k in 0..=720 {
            let lambda = f64::from(k) / 720.0;
            writeln!(added, "{lambda:.11e},{:.11e}", value(lambda * beta)).unwrap();
        }
    }
    let driven = "*BOUNDARY\nARCA,3,3,0.\nTURNER,3,3,0.\n*BOUNDARY,AMPLITUDE=A0\nTURNER,1,1,1.\n\
         *BOUNDARY,AMPLITUDE=A1\nTURNER,2,2,1.\n*BOUNDARY\n";
    text.replacen("*STEP", &format!("{added}*STEP"), 1).replacen(
        "*BOUNDARY\nARCA,1,3,0.\n",
        driven,
        1,
    )
}

/// The energy and the resultant force on panel B of each printed increment.
fn energies_and_forces(dat: &str, mesh: &WindowMesh) -> Vec<(f64, [f64; 2])> {
    let nodes = mesh.arc_b.len();
    dat.split("forces (fx,fy,fz)")
        .skip(1)
        .map(|increment| {
            let reactions = rows(increment, 4);
            let force = [1, 2].map(|i| reactions[..nodes].iter().map(|row| row[i]).sum());
            let (_, energy) = increment.split_once("total internal energy").unwrap();
            (rows(energy, 1)[0][0], force)
        })
        .collect()
}

/// Reference: a rigid motion causes no strain. The energy that remains, some 1e-6 N mm, is due to
/// the chords of the amplitude tables; a hinge rotated to 45 deg stores 90 N mm.
#[test]
fn a_window_that_is_rotated_as_a_whole_stores_no_energy() {
    let mesh = window();
    let beta = 60.0_f64.to_radians();
    let end = HingeDeformation { theta: beta, ..HingeDeformation::default() };
    let dat = solved(&with_panel_a_turned(&mesh, &DeformationPath::straight(end), beta));
    let increments = energies_and_forces(&dat, &mesh);
    assert!(increments.len() > 10);
    for (energy, force) in increments {
        assert!(energy.abs() < 1e-3, "{energy}");
        assert!(force[0].hypot(force[1]) < 1e-2, "{force:?}");
    }
}

/// Reference: material frame indifference. The same (a, s, theta) with a superposed rotation of the
/// whole hinge by beta gives the same energy, and forces rotated by beta.
#[test]
fn a_superposed_rotation_changes_neither_energy_nor_corotated_forces() {
    let mesh = window();
    let beta = 40.0_f64.to_radians();
    let end = problem(60.0, [-0.1, 0.1], 30.0).hinge.path.at(1.0);
    let still = DeformationPath::straight(end);
    // The motion of B in the fixed frame: the rotation is theta + beta, and du is rotated by beta,
    // which is R(beta / 2) (a, s) in the mean frame of a fixed panel A.
    let state = |k: u32| {
        let lambda = f64::from(k) / 720.0;
        let [a, s, theta] = end.at(lambda).to_array();
        let (sin, cos) = (0.5 * lambda * beta).sin_cos();
        let (a, s) = (cos * a - sin * s, sin * a + cos * s);
        HingeDeformation { a, s, theta: theta + lambda * beta }
    };
    let turned = DeformationPath::through(&(1..=720).map(state).collect::<Vec<_>>()).unwrap();
    let last = |deck: &str| *energies_and_forces(&solved(deck), &mesh).last().unwrap();
    let (energy, force) = last(&window_deck(&mesh, &still, &film()));
    let (same, found) = last(&with_panel_a_turned(&mesh, &turned, beta));
    assert!((same - energy).abs() < 2e-3 * energy, "{same} {energy}");
    let (sin, cos) = beta.sin_cos();
    let expected = [cos * force[0] - sin * force[1], sin * force[0] + cos * force[1]];
    let error = (found[0] - expected[0]).hypot(found[1] - expected[1]);
    assert!(error < 0.01 * force[0].hypot(force[1]), "{found:?} {expected:?}");
}
