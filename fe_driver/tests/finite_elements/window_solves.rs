//! Solves with gmsh and CalculiX, compared with the energy balance, the mirror symmetry and a
//! converged mesh.

use crate::common::{film, problem};
use fe_driver::{
    CalculiX, DeformationPath, HingePath, Ray, Solution, Solver, WindowProblem, WindowSolve,
};
use hinge::{HingeDeformation, HingeDesign, Regime, SheetMaterial};
use mesher::{Tier, WindowShape};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

fn solve(problem: &WindowProblem) -> Solution {
    solve_in(tempfile::tempdir().unwrap().path(), &CalculiX::find().unwrap(), problem)
}

fn solve_in(folder: &Path, solver: &CalculiX, problem: &WindowProblem) -> Solution {
    let solve = WindowSolve::new(problem.clone(), &solver.versions());
    let limit = Duration::from_secs(300);
    let solution = solver.attempt(&solve, folder, limit, &AtomicBool::new(false)).unwrap();
    assert!(solution.stopped.is_none(), "{:?}", solution.stopped);
    solution
}

/// The problem of the hinge and the path of another one.
fn along(hinge: HingePath, asked: &WindowProblem) -> WindowProblem {
    WindowProblem { hinge, ..asked.clone() }
}

/// A pure rotation of the paper's hinge by 45 deg stores 90.6 N mm on the finest mesh; the coarsest
/// mesh is known to be 15 % too stiff.
#[test]
fn a_pure_rotation_stores_the_work_done_on_it() {
    let solution = solve(&problem(90.0, [0.0, 0.0], 45.0));
    let end = solution.samples.last().unwrap();
    assert_eq!(end.lambda, 1.0);
    assert!((end.w - 90.6).abs() < 0.2 * 90.6, "{}", end.w);
    assert!(end.energy_residual < 1e-3, "{}", end.energy_residual);
    assert!(0.0 < end.w_elastic && end.w_elastic < end.w);
    // All energy is elastic before yield: the two energies are independent measurements of the
    // same quantity.
    let elastic = solution.samples.iter().filter(|s| s.plastic_integral == 0.0);
    assert!(elastic.clone().count() > 5);
    for sample in elastic {
        assert!((sample.w_elastic - sample.w).abs() < 1e-3 * sample.w, "{sample:?}");
    }
    // Symmetry excludes a shear force.
    assert!(end.f_s.abs() < 1e-2 * end.f_a.abs(), "{end:?}");
    // The ligament has buckled by tens of thicknesses, and yielded.
    assert!(end.uz_max > 10.0 && end.uz_max < 40.0, "{}", end.uz_max);
    assert!(end.d > 0.0 && Some(end.d) < end.d_peak);
    assert!(solution.samples.windows(2).all(|s| s[0].lambda < s[1].lambda && s[0].d <= s[1].d));
    assert!(solution.iterations > solution.samples.len());
}

/// W(a, s, theta; alpha) = W(a, -s, theta; pi - alpha), in the mean frame of the two panels.
#[test]
fn a_mirrored_window_gives_the_mirrored_sample() {
    let asked = problem(65.0, [-0.1, 0.12], 30.0);
    let mirrored = HingePath {
        design: asked.hinge.design.mirrored(),
        path: DeformationPath::straight(asked.hinge.path.at(1.0).mirrored()),
    };
    let mirrored = along(mirrored, &asked);
    let here = *solve(&asked).samples.last().unwrap();
    let there = solve(&mirrored).samples.last().unwrap().mirrored();
    let close =
        |a: f64, b: f64, scale: f64| assert!((a - b).abs() < 2e-3 * scale, "{here:?} {there:?}");
    let force = here.f_a.abs().max(here.f_s.abs());
    close(here.w, there.w, here.w);
    close(here.f_a, there.f_a, force);
    close(here.f_s, there.f_s, force);
    close(here.m_theta, there.m_theta, here.m_theta.abs());
    close(here.d, there.d, here.d);
    assert!(here.f_s.abs() > 0.05 * force, "the shear force is too small for this test: {here:?}");
}

/// A closing rotation, and an axial compression: the prescribed motion and the mean frame hold for
/// either sign.
#[test]
fn closing_and_compression_do_work_too() {
    for (eta_a, theta_deg) in [(0.0, -20.0), (-0.3, 10.0)] {
        let solution = solve(&problem(75.0, [eta_a, 0.05], theta_deg));
        let end = solution.samples.last().unwrap();
        assert_eq!(end.deformation(), problem(75.0, [eta_a, 0.05], theta_deg).hinge.path.at(1.0));
        assert!(end.w > 1.0, "{end:?}");
        assert!(end.energy_residual < 2e-3, "{end:?}");
        // The forces resist the motion: the work of the drive is positive.
        let power = end.f_a * end.a + end.f_s * end.s + end.m_theta * end.theta;
        assert!(power > 0.0, "{end:?}");
    }
}

/// A recorded path and the straight ray to the same end (section 5.2): a plastic hinge that rotates
/// first and translates later stores more energy, but less than 7 % more, as the paper found.
#[test]
fn a_path_that_rotates_first_stores_more_energy_than_its_ray() {
    // The ligament snaps with one layer of bricks and the solve stops; with two layers it
    // continues.
    let asked = WindowProblem { tier: Tier::Small, ..problem(90.0, [-0.1, 0.1], 60.0) };
    let design = asked.hinge.design;
    let folded = HingeDeformation { theta: 60f64.to_radians(), ..HingeDeformation::default() };
    let path = DeformationPath::through(&[folded, asked.hinge.path.at(1.0)]).unwrap();
    let bent = solve(&along(HingePath { design, path }, &asked));
    let (bent, straight) = (bent.samples.last().unwrap(), solve(&asked).samples);
    let straight = straight.last().unwrap();
    assert_eq!(bent.deformation(), straight.deformation());
    assert!(bent.energy_residual < 5e-3, "{bent:?}");
    let excess = bent.w / straight.w - 1.0;
    assert!(0.002 < excess && excess < 0.07, "{excess}");
}

/// The window buckles at sheet thicknesses from 0.1 mm to 3 mm.
#[test]
fn the_thinnest_and_the_thickest_sheet_are_solved() {
    for thickness in [0.1, 3.0] {
        let mut asked = problem(80.0, [0.0, 0.0], 20.0);
        asked.material.thickness = thickness;
        let solution = solve(&asked);
        let end = solution.samples.last().unwrap();
        assert!(end.w > 0.0 && end.uz_max > thickness, "{end:?}");
        assert!(end.energy_residual < 2e-3, "{end:?}");
    }
}

/// A ligament narrower than the plate is thick stays in the plane and carries no axial force as it
/// turns about its middle. An ideally plastic one carries the moment of a notched strip in bending:
/// the moment of a plane section, sigma t c^2 / 4 over the net width c, or up to 1.26 times as much
/// by the constraint of the notch (Green and Hundy 1956: deep notch, plane strain).
#[test]
fn a_ligament_of_a_plate_bends_in_its_plane() {
    let (yields, thickness, w_lig) = (40.0, 3.0, 1.5);
    let material = SheetMaterial { thickness, plastic: vec![[yields, 0.0]], ..film() };
    let design = HingeDesign { w_lig, r_win: 12.0, ..crate::common::design(90.0) };
    let solved_to = |eta_a: f64| {
        let end = HingeDeformation::from_eta(eta_a, 0.0, 20f64.to_radians(), w_lig);
        let solution = solve(&WindowProblem::new(
            Ray { design, end }.driven(Regime::Plate),
            &material,
            Tier::PlateTiny,
        ));
        *solution.samples.last().unwrap()
    };
    let free = solved_to(0.19);
    assert!(free.energy_residual < 1e-3, "{free:?}");
    assert!(free.uz_max < 0.1 * thickness, "{free:?}");
    let net = (1.0 - design.fillet_ratio) * w_lig;
    let section = yields * thickness * net * net / 4.0;
    let constraint = free.m_theta / section;
    assert!((1.0..1.26).contains(&constraint), "{constraint}");
    // The axial force changes sign there: a tenth of the width to either side it is half of the
    // force that yields.
    let [pushed, pulled] = [0.09, 0.29].map(solved_to);
    let section = yields * thickness * net;
    assert!(free.f_a.abs() < 0.1 * section, "{free:?}");
    assert!(pushed.f_a < -0.3 * section, "{pushed:?}");
    assert!(pulled.f_a > 0.3 * section, "{pulled:?}");
}

/// The window is rate-independent and has no length of its own: with all lengths times lambda, W is
/// multiplied by lambda^3, forces by lambda^2, the moment by lambda^3, and D and D_peak do not
/// change. Decks and results have seven digits, and iterations that end at a residual of 0.5 %
/// amplify their rounding to a few 1e-5.
#[test]
fn windows_of_every_thickness_are_similar() {
    let asked = problem(80.0, [-0.05, 0.05], 20.0);
    let solved_at = |thickness: f64| {
        let factor = thickness / asked.material.thickness;
        let mut asked = asked.clone();
        asked.material.thickness = thickness;
        let HingePath { design, path } = &asked.hinge;
        asked.hinge = HingePath {
            design: design.scaled(factor),
            path: DeformationPath::straight(path.at(1.0).scaled(factor)),
        };
        let end = *solve(&asked).samples.last().unwrap();
        let forces = [end.f_a, end.f_s, end.m_theta / factor].map(|f| f / factor.powi(2));
        let [f_a, f_s, m] = forces;
        [end.w / factor.powi(3), f_a, f_s, m, end.d, end.d_peak.unwrap()]
    };
    let film = solved_at(0.5);
    for thickness in [0.1, 2.0] {
        let found = solved_at(thickness);
        for (found, expected) in std::iter::zip(found, film) {
            assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        }
    }
}

/// Printing all displacements changes no sample, and the fields agree with the prescribed motion
/// and the sample.
#[test]
fn the_fields_of_a_window_agree_with_its_last_sample() {
    let asked = problem(70.0, [0.1, -0.05], 40.0);
    let folder = tempfile::tempdir().unwrap();
    let solver = CalculiX { print_all: true, ..CalculiX::find().unwrap() };
    let solution = solve_in(folder.path(), &solver, &asked);
    assert_eq!(solution.samples, solve(&asked).samples);
    let last = solution.samples.last().unwrap();

    let (design, recipe) = (&asked.hinge.design, &asked.tier.recipe());
    let shape = WindowShape { design, thickness: asked.material.thickness, recipe };
    let mesh = shape.read(folder.path()).unwrap();
    let solve = WindowSolve::new(asked.clone(), &solver.versions());
    let fields = || solver.fields(&solve, folder.path()).unwrap();
    let grid = fields().unwrap();
    let field = |name: &str| {
        let mut fields = grid.point_data.iter().chain(&grid.cell_data);
        &fields.find(|field| field.name == name).unwrap().values
    };
    let displacements = field("displacement (mm)").as_chunks::<3>().0;
    assert_eq!(displacements.len(), grid.points.len());
    let tip = mesh.design.tip();
    let (sin, cos) = last.theta.sin_cos();
    let (half_sin, half_cos) = (0.5 * last.theta).sin_cos();
    let du = [half_cos * last.a - half_sin * last.s, half_sin * last.a + half_cos * last.s];
    for &node in &mesh.arc_b {
        let [x, y] = [0, 1].map(|axis| grid.points[node][axis] - tip[axis]);
        let expected = [cos * x - sin * y - x + du[0], sin * x + cos * y - y + du[1], 0.0];
        for (found, expected) in displacements[node].iter().zip(expected) {
            // Printed with seven digits; positions are up to 100 mm from the tip.
            assert!((found - expected).abs() < 1e-4, "{found} {expected}");
        }
    }
    assert!(mesh.arc_a.iter().all(|&node| displacements[node] == [0.0; 3]));
    let highest = mesh.bottom.iter().map(|&node| displacements[node][2].abs());
    assert_eq!(highest.fold(0.0, f64::max), last.uz_max);
    let volumes = mesh.gauss_volumes.iter().map(|volumes| volumes.iter().sum::<f64>());
    let plastic: f64 =
        field("plastic strain").iter().zip(volumes).map(|(strain, volume)| strain * volume).sum();
    assert!((plastic / last.plastic_integral - 1.0).abs() < 1e-12);
    std::fs::remove_file(folder.path().join("window.dat")).unwrap();
    assert!(fields().is_none());
}
