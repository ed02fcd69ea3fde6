//! The VTK grids of a deployment against the deployment itself.

use design::sheet::kinematics::deployed_corners;
use output::vtk_sheet::vtk_states;
use scene::Scene;
use std::path::Path;
use support::vtk::UnstructuredGrid;

fn moved(grid: &UnstructuredGrid) -> Vec<[f64; 3]> {
    let displacements = grid.point_data[0].values.as_chunks::<3>().0;
    let sum = |(x, u): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|axis| x[axis] + u[axis]);
    grid.points.iter().zip(displacements).map(sum).collect()
}

#[test]
fn displaced_points_are_the_deployed_sheet() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes/pet-3x3.toml");
    let scene = Scene::read(&scene).unwrap();
    let deployment = scene.problem().unwrap().deploy(&scene.start()).unwrap();
    let states = vtk_states(&deployment);
    assert_eq!(states.len(), 1 + deployment.path.len());
    for grid in [&states[0].panels, &states[0].hinges] {
        assert!(grid.point_data[0].values.iter().all(|u| *u == 0.0));
    }
    for (state, step) in states[1..].iter().zip(&deployment.path) {
        assert_eq!(state.time, step.load_factor);
        let corners = deployed_corners(&deployment.sheet, &step.configuration);
        let moved = moved(&state.panels).into_iter();
        for ([x, y, z], expected) in moved.zip(corners.into_iter().flatten()) {
            // Adding and subtracting positions of up to 3 m.
            assert!((x - expected[0]).abs() < 1e-9 && (y - expected[1]).abs() < 1e-9 && z == 0.0);
        }
        let hinges = &state.hinges.point_data;
        let values = |name: &str| {
            let mut fields = hinges.iter();
            &fields.find(|field| field.name == name).unwrap().values
        };
        for (h, &theta_deg) in values("theta (deg)").iter().enumerate() {
            assert_eq!(theta_deg, step.deformations[h].theta.to_degrees());
            assert_eq!(values("W (N mm)")[h], step.energies[h]);
            assert_eq!(values("hinge")[h], h as f64);
            match step.inside[h] {
                true => assert_eq!(values("D")[h], step.damage[h].d),
                false => assert!(values("D")[h].is_nan()),
            }
        }
    }
}
