//! An equilibrium path with its energies against an independent implementation.

use crate::cases;
use crate::prelude::*;

#[test]
fn a_clamped_and_pulled_sheet() {
    let case = case("e0_3x3_clamp_pull");
    let sheet = sheet_of(&get::<String>(&case, "pattern"));
    let [k_a, k_s, k_theta]: [Vec<f64>; 3] = ["k_a", "k_s", "k_theta"].map(|key| get(&case, key));
    let hinges = 0..sheet.hinges.len();
    let stiffness: Vec<[f64; 3]> = hinges.map(|h| [k_a[h], k_s[h], k_theta[h]]).collect();
    let law = LinearLaw { stiffness: stiffness.clone() };
    let (supports, loads) = (cases::supports(&case), cases::loads(&case));
    let path = path(&sheet, &law, &supports, &loads, get(&case, "nsteps"));

    let load_factors: Vec<f64> = get(&case, "load_factors");
    let configurations: Vec<Vec<[f64; 3]>> = get(&case, "path_q");
    let potentials: Vec<f64> = get(&case, "path_Pi");
    let stored: Vec<f64> = get(&case, "path_U");
    assert_eq!(path.len(), load_factors.len());
    for (i, step) in path.iter().enumerate() {
        assert_eq!((step.status, step.negative_pivots), (Status::Converged, 0));
        assert_eq!(step.load_factor, load_factors[i]);
        assert!(step.residual < 1e-10);
        assert!(difference(&step.configuration, &configurations[i]) < 1e-8);
        assert_close(step.potential, potentials[i], 1e-10);
        assert_close(step.energies.iter().sum(), stored[i], 1e-9);
    }

    let last = path.last().unwrap();
    let deformations: Vec<[f64; 3]> = last.deformations.iter().map(|d| d.to_array()).collect();
    assert!(difference(&deformations, &get::<Vec<_>>(&case, "hinge_deformation")) < 1e-8);
    for (c, part) in ["axial", "shear", "rotation"].into_iter().enumerate() {
        let hinges = std::iter::zip(&deformations, &stiffness);
        let energy = hinges.map(|(deformation, k)| 0.5 * k[c] * deformation[c].powi(2));
        assert_close(energy.sum(), get(&case["energy_parts"], part), 1e-9);
    }
    let corners: Vec<[[f64; 2]; 4]> = get(&case, "deformed_corners");
    let found = deployed_corners(&sheet, &last.configuration);
    assert!(difference(found.as_flattened(), corners.as_flattened()) < 1e-8);
}
