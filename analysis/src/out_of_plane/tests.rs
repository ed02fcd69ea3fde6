use super::*;
use design::pattern::grid::Grid;
use design::sheet::topology::Topology;
use std::path::Path;
use std::sync::Arc;
use testkit::derivatives::assert_close;

fn deployed_scene(name: &str) -> (Scene, Deployment) {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes");
    let scene = Scene::read(&scenes.join(name)).unwrap();
    let deployment = scene.problem().unwrap().deploy(&scene.start()).unwrap();
    (scene, deployment)
}

/// A panel that a force pushes towards its hinge with a clamped panel tips over it at the load
/// of a rigid bar on a spring.
#[test]
fn a_pushed_panel_tips_over_at_the_load_of_a_bar_on_a_spring() {
    let (load, arm, bend) = (3.0, 40.0, 500.0);
    let along = turn(0.4);
    let ligament =
        Ligament { along, arms: [10.0 * along, -arm * along], force: -load * along, moment: 0.0 };
    let stiffness = Stiffness { height: 1e6, bend, twist: 0.1 * bend };
    let pattern = TangentPattern::new(
        &Arc::<Topology>::from(Grid { m: 2, n: 1 }),
        &[true, true, true, false, false, false],
    );
    let [elastic, geometric] = [ligament.elastic(&stiffness), ligament.geometric()]
        .map(|block| pattern.assemble(std::iter::once(block)));
    let found = margin(&pattern, &elastic, &geometric).unwrap();
    assert_close(found, bend / (load * arm), 0.02);
    // Pulled, it stays.
    let pulled: Vec<f64> = geometric.iter().map(|entry| -entry).collect();
    assert_eq!(margin(&pattern, &elastic, &pulled), Some(MOST));
    // Nothing holds it.
    let free = TangentPattern::new(&Arc::<Topology>::from(Grid { m: 2, n: 1 }), &[false; 6]);
    let loose = free.assemble(std::iter::once(ligament.elastic(&stiffness)));
    assert_eq!(margin(&free, &loose, &loose), None);
}

/// A pulled panel tilts by the moment of the force at the height of the bump, less the more it
/// is pulled, in one load step as in two.
#[test]
fn a_bump_tilts_a_pulled_panel() {
    let (load, arm, bend, w_lig, thickness) = (3.0, 40.0, 500.0, 2.0, 3.0);
    let along = turn(0.4);
    let pattern = TangentPattern::new(
        &Arc::<Topology>::from(Grid { m: 2, n: 1 }),
        &[true, true, true, false, false, false],
    );
    let of = |share: f64| {
        let ligament = Ligament {
            along,
            arms: [10.0 * along, -arm * along],
            force: share * load * along,
            moment: 0.0,
        };
        let stiffness = Stiffness { height: 1e9, bend, twist: bend };
        let [_, [x, y]] = ligament.moments_of_bump(w_lig, thickness);
        let [elastic, geometric] = [ligament.elastic(&stiffness), ligament.geometric()]
            .map(|block| pattern.assemble(std::iter::once(block)));
        OfForces { elastic, geometric, loads: pattern.gather(&[[0.0; 3], [0.0, x, y]]) }
    };
    let none = vec![0.0; 3];
    let half = of(0.5);
    let at_half = moved(&pattern, None, &half, none.clone()).unwrap();
    for motions in
        [moved(&pattern, Some(&half), &of(1.0), at_half), moved(&pattern, None, &of(1.0), none)]
    {
        let [_, [z, x, y]] = pattern.spread(&motions.unwrap())[..] else { unreachable!() };
        let height = Regime::Plate.bump() * thickness * f64::exp(-0.25);
        let tilt = load * height / (bend + load * arm);
        assert_close(x.hypot(y), tilt, 1e-6);
        // The far end of the arm rises to the line of the force.
        let tilted = c64::new(x, y) / (I * along);
        assert_close(tilted.re.abs(), tilt, 1e-6);
        assert_close(z.abs(), arm * tilt, 1e-6);
    }
}

/// The stiffness by the forces is symmetric, as in any equilibrium.
#[test]
fn forces_in_equilibrium_have_a_symmetric_stiffness() {
    let (scene, deployment) = deployed_scene("linear-7x7.toml");
    let problem = scene.problem().unwrap();
    let (sheet, step) = (&deployment.sheet, deployment.final_step());
    let mechanics = problem.model.mechanics().unwrap();
    let prepared = mechanics.law.prepare(&sheet.designs());
    let hinged = mechanics.hinged(sheet, &*prepared, false);
    let energies = hinged.energies(&step.deformations, Order::Forces);
    let mut turning = vec![0.0; sheet.panels.len()];
    let mut size = 0.0_f64;
    for (h, energy) in energies.iter().enumerate() {
        let ligament = Ligament::new(sheet, h, &step.configuration, energy.forces);
        let block = ligament.geometric();
        let hinge = &sheet.hinges[h];
        for (panel, at) in [(hinge.panel_a(), 0), (hinge.panel_b(), 3)] {
            turning[panel] += block[at + 1][at + 2] - block[at + 2][at + 1];
            size = size.max(block[at + 1][at + 2].abs());
        }
        // The part between its panels is symmetric by itself.
        let between: [[f64; 3]; 3] = from_fn(|i| from_fn(|j| block[i][j + 3]));
        let mirrored: [[f64; 3]; 3] = from_fn(|i| from_fn(|j| block[j + 3][i]));
        assert_eq!(between, mirrored);
    }
    let held: Vec<usize> = (scene.config.supports.iter())
        .map(|support| support.panel[1] * sheet.topology.grid.m + support.panel[0])
        .collect();
    let free = (0..turning.len()).filter(|panel| !held.contains(panel));
    for panel in free {
        assert!(turning[panel].abs() < 1e-6 * size, "{panel}: {}", turning[panel]);
    }
}

/// Panels of the design tilt by 0.28 deg by finite elements, and its corners are 0.20 mm out of
/// the plane, root mean square (docs/results/plates).
#[test]
fn the_a4_plate_stays_nearly_in_its_plane_and_a_film_has_no_margin() {
    let (scene, deployment) = deployed_scene("a4-plate.toml");
    let stability = Stability::new(&scene, &scene.problem().unwrap(), &deployment).unwrap();
    assert!(stability.is_safe(), "{stability:?}");
    assert_eq!(stability.leaves_at, None);
    let tilt_deg = stability.tilt.unwrap().to_degrees();
    assert!((0.15..0.5).contains(&tilt_deg), "{tilt_deg}");
    let (film, deployment) = deployed_scene("pet-3x3.toml");
    let film = out_of_plane(&film, &film.problem().unwrap(), &deployment);
    assert_eq!(film, None);
}
