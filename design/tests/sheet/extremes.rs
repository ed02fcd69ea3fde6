//! Invalid designs, loads and hinge laws: every result is an error or a status, never NaN.

use crate::cases;
use crate::prelude::*;

/// A hinge law without coupling: energy, force and stiffness of a, of s and of theta.
pub struct Uncoupled<F>(pub F);

impl<F: Fn(HingeDeformation) -> [[f64; 3]; 3] + Send + Sync> HingeLaw for Uncoupled<F> {
    fn prepare<'a>(&'a self, _designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        Box::new(self)
    }
}

impl<F: Fn(HingeDeformation) -> [[f64; 3]; 3] + Send + Sync> PreparedLaw for &Uncoupled<F> {
    fn energies(&self, deformations: &[HingeDeformation], _order: Order) -> Vec<HingeEnergy> {
        let energy = |deformation: &HingeDeformation| {
            let [a, s, theta] = (self.0)(*deformation);
            HingeEnergy {
                w: a[0] + s[0] + theta[0],
                forces: [a[1], s[1], theta[1]],
                tangent: [[a[2], 0.0, 0.0], [0.0, s[2], 0.0], [0.0, 0.0, theta[2]]],
                ..HingeEnergy::default()
            }
        };
        deformations.iter().map(energy).collect()
    }
}

/// Energy, force and stiffness of a linear spring.
pub fn spring(k: f64, x: f64) -> [f64; 3] {
    [0.5 * k * x * x, k * x, k]
}

/// k_a a^2/2 + k_s s^2/2 + any function of theta with two derivatives.
pub fn rotational(turned: fn(f64) -> [f64; 3]) -> impl HingeLaw {
    Uncoupled(move |eps: HingeDeformation| {
        [spring(100.0, eps.a), spring(100.0, eps.s), turned(eps.theta)]
    })
}

pub fn assert_finite(path: &[LoadStep]) {
    for step in path {
        let numbers = step.configuration.as_flattened().iter();
        let mut numbers = numbers.chain(&step.energies).chain([&step.potential]);
        assert!(numbers.all(|value| value.is_finite()));
        assert!(!step.residual.is_nan() && !step.pivot_ratio.is_nan());
        if !matches!(step.status, Status::Diverged | Status::Almost) {
            let balanced = step.residual <= step.rounding.max(1e-10);
            assert!(balanced && step.negative_pivots == 0, "{step}");
        }
    }
}

#[test]
fn no_load_leaves_the_sheet_flat() {
    let sheet = sheet_of("p1_3x3_random");
    let law = uniform(SPRINGS, &sheet);
    for step in path(&sheet, &law, &clamp(3), &[], 3) {
        let found = (step.status, step.effort.iterations);
        assert_eq!(found, (Status::Converged, 0));
        assert_eq!(step.configuration, vec![[0.0; 3]; 9]);
    }
}

#[test]
fn loads_of_any_size_and_sign_end_in_a_status() {
    let sheet = sheet_of("p1_3x3_random");
    for stiffness in [[90.0, 40.0, 0.8], [1e4, 1e4, 1.0], [1.0, 1.0, 1e-6]] {
        let law = uniform(stiffness, &sheet);
        for force in [1e-12, -0.3, 3.0, -30.0, 1e4, -1e9] {
            assert_finite(&path(&sheet, &law, &clamp(3), &[pull(5, force)], 5));
        }
    }
}

#[test]
fn a_load_that_no_wall_can_carry_diverges_and_keeps_the_last_equilibrium() {
    let sheet = sheet_of("p0_3x3_uniform");
    let law = uniform([100.0, 100.0, 1.0], &sheet);
    let loads = opening_moments(&sheet, 4, -1e18);
    let contact = Contact::new(1.0, -0.2, -0.01).unwrap();
    let solver = solver(sheet.topology.grid, &clamp(4), &loads, 4);
    let path = follow(&solver, &sheet, &law, Some(&contact));
    assert_finite(&path);
    let last = path.last().unwrap();
    assert_eq!(last.status, Status::Diverged);
    assert!(last.load_factor < 1.0 && last.residual > 1e-10);
    assert!(last.deformations.iter().all(|eps| eps.theta > -0.2));
}

#[test]
fn contact_carries_a_load_that_closes_the_sheet() {
    let sheet = sheet_of("p0_3x3_uniform");
    let law = uniform([100.0, 100.0, 1.0], &sheet);
    let contact = Contact::new(10.0, -0.2, -0.01).unwrap();
    let loads = opening_moments(&sheet, 4, -5.0);
    let solver = solver(sheet.topology.grid, &clamp(4), &loads, 5);
    for step in follow(&solver, &sheet, &law, Some(&contact)) {
        assert_eq!(step.status, Status::Converged);
        for deformation in &step.deformations {
            let mut energy = [HingeEnergy::default()];
            contact.add(&mut energy, &[*deformation]);
            let moment = deformation.theta + energy[0].forces[2];
            assert_close(moment, -5.0 * step.load_factor, 1e-8);
            assert!(deformation.theta > -0.2);
        }
    }
}

/// A learned energy is a small difference of larger numbers: its forces are accurate, its value is
/// not.
#[test]
fn an_energy_with_few_digits_converges_by_its_forces() {
    let law = rotational(|theta| [(0.5 * theta * theta + 1.0) - 1.0, theta, 1.0]);
    let sheet = sheet_of("p1_3x3_random");
    for step in path(&sheet, &law, &clamp(3), &[pull(5, 1e-2)], 5) {
        assert_eq!(step.status, Status::Converged);
        assert!(step.effort.iterations <= 6);
    }
}

/// With W = theta^4/4 - theta_0^2 theta^2/2 the flat sheet is an equilibrium but not a minimum.
#[test]
fn an_unstable_flat_sheet_is_left_for_a_minimum() {
    let law = rotational(|theta| {
        let rest: f64 = 0.8 * 0.8;
        let square = theta * theta;
        [0.25 * square * square - 0.5 * rest * square, theta * (square - rest), 3.0 * square - rest]
    });
    let sheet = sheet_of("p0_3x3_uniform");
    let path = path(&sheet, &law, &clamp(4), &[], 2);
    assert_finite(&path);
    assert_eq!(path[0].status, Status::LimitPoint);
    assert_eq!(path[1].status, Status::Converged);
    assert!(path[1].potential < -0.1);
}

/// W = theta^2 (theta - 1)^2 resists opening by at most M_max = sqrt(3)/9.
pub fn snapping(theta: f64) -> [f64; 3] {
    [
        theta * theta * (theta - 1.0).powi(2),
        2.0 * theta * (theta - 1.0) * (2.0 * theta - 1.0),
        12.0 * theta * theta - 12.0 * theta + 2.0,
    ]
}

#[test]
fn a_snapping_sheet_reports_its_limit_point() {
    let law = rotational(snapping);
    let sheet = sheet_of("p1_3x3_random");
    let maximum = 3.0_f64.sqrt() / 9.0;
    let loads = opening_moments(&sheet, 4, 1.5 * maximum);
    let path = path(&sheet, &law, &clamp(4), &loads, 6);
    assert_finite(&path);
    // The load of the fourth step is the limit load itself.
    let snapped = |step: &LoadStep| step.deformations.iter().all(|d| d.theta > 0.5);
    let jumps: Vec<usize> = (0..6).filter(|&i| path[i].jumps > 0).collect();
    assert!(jumps == [3] || jumps == [4], "{jumps:?}");
    for (i, step) in path.iter().enumerate().filter(|(i, _)| *i != 3) {
        let statuses = [Status::Converged, Status::LimitPoint];
        let expected = statuses[usize::from(jumps.contains(&i))];
        assert_eq!(step.status, expected, "step {i}");
        assert_eq!(snapped(step), i > 3, "step {i}");
    }
}

#[test]
fn a_sheet_without_any_stiffness_is_reported_as_singular_or_diverged() {
    let law = rotational(|_| [0.0; 3]);
    let sheet = sheet_of("p1_3x3_random");
    let unloaded = path(&sheet, &law, &clamp(3), &[], 1);
    assert_eq!(unloaded[0].status, Status::Almost);
    assert_finite(&unloaded);
    let loads = opening_moments(&sheet, 4, 1.0);
    let turned = path(&sheet, &law, &clamp(4), &loads, 2);
    assert_eq!(turned.last().unwrap().status, Status::Diverged);
    assert_finite(&turned);
}

#[test]
fn a_sheet_supported_everywhere_stays_at_its_supports() {
    let sheet = sheet_of("p1_3x3_random");
    let law = uniform(SPRINGS, &sheet);
    let everywhere: Vec<Support> = (0..9).flat_map(clamp).collect();
    let path = path(&sheet, &law, &everywhere, &[], 2);
    assert!(converged(&path));
    assert_finite(&path);
}

/// A square and the same square turned by 45 degrees, where panels 1 and 3 have the same height and
/// panels 1 and 4 have not.
#[test]
fn supports_are_judged_by_the_places_of_the_panels() {
    let sheet = |corners| {
        let grid = Grid { m: 3, n: 3 };
        let coordinates = PatternCoordinates::uniform(grid);
        cut(grid, Outline { corners }, &coordinates, 0.1, AT_CORNER)
    };
    let square = sheet([[0.0, 0.0], [6.0, 0.0], [6.0, 6.0], [0.0, 6.0]]);
    let turned = sheet([[0.0, -4.0], [4.0, 0.0], [0.0, 4.0], [-4.0, 0.0]]);
    let holds = |sheet: &Sheet, supports: &[(usize, Dof)]| {
        let supports = (supports.iter()).map(|&(panel, dof)| support(panel, dof, 0.0));
        let solver = solver(sheet.topology.grid, &supports.collect::<Vec<_>>(), &[], 1);
        let holds = solver.check_supports(sheet).is_ok();
        if !holds {
            assert_unsupported(&solver, sheet);
        }
        holds
    };
    let two_along_x = |other| [(1, Dof::UX), (other, Dof::UX), (0, Dof::UY)];
    assert!(holds(&square, &two_along_x(3)) && !holds(&turned, &two_along_x(3)));
    assert!(holds(&square, &two_along_x(4)) && holds(&turned, &two_along_x(4)));
    let in_a_row = two_along_x(0);
    assert!(!holds(&square, &in_a_row) && holds(&turned, &in_a_row));
    for sheet in [&square, &turned] {
        assert!(!holds(sheet, &[]));
        assert!(!holds(sheet, &[0, 1, 2].map(|panel| (panel, Dof::UX))));
        assert!(holds(sheet, &Dof::ALL.map(|dof| (4, dof))));
    }
}

#[test]
fn impossible_supports_and_loads_are_named() {
    let grid = Grid { m: 3, n: 3 };
    let settings = SolverSettings::default();
    let new = |supports: &[Support], loads: &[Load], steps| {
        EquilibriumSolver::new(grid, supports, loads, steps, settings)
    };
    let (held, pulled) = (clamp(3), [pull(5, 1.0)]);
    let twice = [held, clamp(3)].concat();
    let absent = "a support on panel 9: the panels of the sheet are 0..9";
    let endless = "a load of NaN on panel 5 is not a finite number";
    for (refused, named) in [
        (new(&held, &pulled, 0), "0 load steps: use at least 1"),
        (new(&clamp(9), &[], 1), absent),
        (new(&clamp(5), &pulled, 1), "panel 5 is loaded in UX, where it is supported"),
        (new(&held, &[pull(5, f64::NAN)], 1), endless),
        (new(&twice, &[], 1), "UX of panel 3 is supported twice"),
    ] {
        assert_begins(refused, named);
    }
    // A pin and a roller are sufficient supports.
    let statically = [(0, Dof::UX), (0, Dof::UY), (2, Dof::UY)];
    let statically = statically.map(|(panel, dof)| support(panel, dof, 0.0));
    assert!(new(&statically, &[], 1).is_ok());
}

/// Fails unless this is an error whose message begins like this.
fn assert_begins<T, E: std::fmt::Display>(refused: Result<T, E>, named: &str) {
    let error = refused.err().unwrap().to_string();
    assert!(error.starts_with(named), "{error} instead of {named}");
}

#[test]
fn impossible_patterns_are_named() {
    let grid = Grid { m: 3, n: 4 };
    let outline = Outline::rectangle(3.0, 4.0);
    let uniform = PatternCoordinates::uniform(grid);
    let of = |grid, outline| CutPattern::new(grid, outline, &uniform);
    let with = |change: fn(&mut PatternCoordinates)| {
        let mut coordinates = uniform.clone();
        change(&mut coordinates);
        CutPattern::new(grid, outline, &coordinates)
    };
    let [mut clockwise, mut endless] = [outline; 2];
    clockwise.corners.reverse();
    endless.corners[1][0] = f64::NAN;
    for (refused, named) in [
        (of(Grid { m: 1, n: 4 }, outline), "a sheet of 1 x 4 panels has no interior cut"),
        (of(Grid { m: 4, n: 4 }, outline), "z has 6 entries; a sheet of 4 x 4 panels needs 9"),
        (of(grid, clockwise), "the outline [[0.0, 4.0]"),
        (of(grid, endless), "the outline [[0.0, 0.0], [NaN"),
        (with(|c| c.z[2] = f64::NAN), "z[2] = NaN is not a finite number"),
        (with(|c| c.z[2] = 50.0), "z[2] is so far from 0"),
        (with(|c| c.ell[1][0] = 900.0), "ell[1] is so far from 0"),
    ] {
        assert_begins(refused, named);
    }
    let narrow = Sheet::new(&of(grid, outline).unwrap(), &[0.1; 3], AT_CORNER);
    assert_begins(narrow, "3 ligament widths for 17 hinges");
}

/// Panels tile the outline and every void opens as a parallelogram, for any r and tau.
#[test]
fn random_patterns_of_every_small_size_tile_and_deploy() {
    let mut random = Random::new(17);
    for (m, n) in (2..=6).flat_map(|m| (2..=6).map(move |n| (m, n))) {
        for outline in [Outline::rectangle(2.0, 1.5), TAPERED] {
            let grid = Grid { m, n };
            let coordinates = drawn(&mut random, grid, 2.5);
            let sheet = cut(grid, outline, &coordinates, 0.02, AT_CORNER);
            let area: f64 = sheet.panels.iter().map(|panel| panel.area).sum();
            assert_ratio(area, shoelace(&outline.corners), 1e-13);
            assert_voids_open_as_parallelograms(&sheet, 1.0 + random.number(0.9));
        }
    }
}

fn assert_voids_open_as_parallelograms(sheet: &Sheet, theta: f64) {
    let q = ideal_deployment(sheet, theta);
    // The deployed position of a hinge, equal on both of its panels.
    let place = |vertex: [usize; 2], endpoint: Endpoint| {
        let at = |hinge: &&Hinge| hinge.site.vertex == vertex && hinge.site.endpoint == endpoint;
        let hinge = sheet.hinges.iter().find(at)?;
        let seen_from = |k: usize| deployed(&sheet.panels[k], q[k], hinge.corner);
        let (a, b) = (seen_from(hinge.panel_a()), seen_from(hinge.panel_b()));
        assert!(cases::difference(&[a], &[b]) < 1e-12);
        Some(a)
    };
    let mut voids = 0;
    for j in 1..sheet.topology.grid.n {
        for i in 1..sheet.topology.grid.m {
            let ends = match (i + j) % 2 == 0 {
                true => [([i - 1, j], Endpoint::X), ([i + 1, j], Endpoint::XPrime)],
                false => [([i, j - 1], Endpoint::XPrime), ([i, j + 1], Endpoint::X)],
            };
            let [a, b] = ends.map(|(vertex, endpoint)| place(vertex, endpoint));
            let sides = [Endpoint::X, Endpoint::XPrime].map(|endpoint| place([i, j], endpoint));
            if let (Some(a), Some(b), [Some(x), Some(x_prime)]) = (a, b, sides) {
                let sum = |p: [f64; 2], q: [f64; 2]| [p[0] + q[0], p[1] + q[1]];
                assert!(cases::difference(&[sum(a, b)], &[sum(x, x_prime)]) < 1e-12);
                voids += 1;
            }
        }
    }
    assert!(voids > 0 || sheet.topology.grid.m.min(sheet.topology.grid.n) < 4);
}

fn shoelace(corners: &[[f64; 2]; 4]) -> f64 {
    (0..4)
        .map(|k| {
            let ([x, y], [u, v]) = (corners[k], corners[(k + 1) % 4]);
            0.5 * (x * v - u * y)
        })
        .sum()
}

/// Springs that are soft in rotation and stiff in translation open under a thousandth of the load
/// and lock; there the path turns by nearly a right angle.
#[test]
fn a_path_goes_on_where_hinges_lock() {
    let scene = scene("linear-7x7.toml", |config| {
        let linear = config.linear.as_mut().unwrap();
        (linear.k_a, linear.k_s, linear.k_theta) = (1e6, 1e6, 1.0);
    });
    let deployment = scene.problem().unwrap().deploy(&scene.start()).unwrap();
    let statuses: Vec<Status> = deployment.path.iter().map(|step| step.status).collect();
    assert_eq!(statuses, [Status::Converged; 10]);
}
