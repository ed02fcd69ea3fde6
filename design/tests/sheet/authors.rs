//! The authors of the paper publish load and opening of a sheet of 3 x 3 panels with linear
//! springs, jkloers/neural-form-finding (MIT), `data/configs/closed/sheet_4x8ft_rom.yaml` (216f0de)
//! and `sheet_4x8ft_rom_disp.yaml` (bbe90d9). Their program differs from the text of the paper in
//! two points:
//!
//! * it holds and pulls a panel at the mean of its four corners, not at its centroid;
//! * an ideal corner is a bond of zero length, which has no direction. Their program takes x for
//!   it, at all hinges: `k_stretch` acts along x and `k_shear` along y, rotated by the mean frame.
//!
//! These two choices give all of their figures to the last digit. Our reading of the paper gives
//! openings up to 3.5 deg smaller.

use crate::prelude::*;

/// Width of a panel (mm).
const WIDTH: f64 = 406.4;
/// `k_stretch`, `k_shear` (N/mm) and `k_rot` (N mm/rad).
const STRETCH: f64 = 238.1;
const SHEAR: f64 = 127.4;
const ROTATION: f64 = 487.0;

/// Load of each of the three upper panels (N), and the mean opening of the hinges (deg).
const OPENINGS: [(f64, f64); 6] =
    [(15.0, 29.0), (30.0, 37.9), (60.0, 45.0), (120.0, 49.0), (600.0, 52.3), (6000.0, 53.0)];

/// A sheet of 4 x 8 ft whose voids have r = 0.45.
fn sheet() -> Sheet {
    let grid = Grid { m: 3, n: 3 };
    let mut coordinates = PatternCoordinates::uniform(grid);
    coordinates.z.fill((0.45_f64 / 0.55).ln());
    cut(grid, Outline::rectangle(1219.2, 2438.4), &coordinates, 18.0, AT_CORNER)
}

/// The sheet held and pulled at the mean of the corners of its panels.
fn at_means(sheet: Sheet) -> Sheet {
    let at_mean = |k: usize| {
        let sum = |c: usize| sheet.panels[k].corners.iter().map(|corner| corner[c]).sum::<f64>();
        attached(k, PanelPoint::Fixed([0, 1].map(|c| sum(c) / 4.0)))
    };
    let points: Vec<_> = (0..sheet.panels.len()).map(at_mean).collect();
    sheet.attached_at(&points)
}

/// The springs along x and y at all hinges: angles of the secondary cuts (rad).
struct AlongX(Vec<f64>);

fn along_x(sheet: &Sheet) -> AlongX {
    AlongX(sheet.hinges.iter().map(|hinge| hinge.e_sec[1].atan2(hinge.e_sec[0])).collect())
}

impl HingeLaw for AlongX {
    fn prepare<'a>(&'a self, _: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        Box::new(self)
    }
}

impl PreparedLaw for &AlongX {
    fn energies(&self, deformations: &[HingeDeformation], _: Order) -> Vec<HingeEnergy> {
        let energy = |(deformation, angle): (&HingeDeformation, &f64)| {
            let motion = deformation.to_array();
            let (sin, cos) = angle.sin_cos();
            let directions = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]];
            let mut energy = HingeEnergy::default();
            for (stiffness, direction) in std::iter::zip([STRETCH, SHEAR, ROTATION], directions) {
                let along = dot(&motion, &direction);
                energy.w += 0.5 * stiffness * along * along;
                for i in 0..3 {
                    energy.forces[i] += stiffness * along * direction[i];
                    for j in 0..3 {
                        energy.tangent[i][j] += stiffness * direction[i] * direction[j];
                    }
                }
            }
            energy
        };
        std::iter::zip(deformations, &self.0).map(energy).collect()
    }
}

/// Openings of the hinges (deg) and rises of the upper panels (widths) under a load (N).
fn opened(sheet: &Sheet, law: &dyn HingeLaw, force: f64) -> (Vec<f64>, [f64; 3]) {
    let supports = [(0, Dof::UY), (1, Dof::UY), (2, Dof::UY), (1, Dof::UX)];
    let supports = supports.map(|(panel, dof)| support(panel, dof, 0.0));
    let loads = [6, 7, 8].map(|panel| load(panel, Dof::UY, force));
    let path = path(sheet, law, &supports, &loads, 6);
    let end = &path[5].configuration;
    let openings = hinge_deformations(sheet, end).into_iter().map(|it| it.theta.to_degrees());
    (openings.collect(), [6, 7, 8].map(|panel| end[panel][1] / WIDTH))
}

fn mean(openings: &[f64]) -> f64 {
    openings.iter().sum::<f64>() / openings.len() as f64
}

#[test]
fn their_sheet_with_their_two_choices_opens_as_they_publish() {
    let sheet = at_means(sheet());
    let law = along_x(&sheet);
    let near = |found: f64, published: f64, digit: f64| {
        assert!((found - published).abs() <= 0.51 * digit, "{found} is not {published}");
    };
    for (force, published) in OPENINGS {
        near(mean(&opened(&sheet, &law, force).0), published, 0.1);
    }
    let (openings, rises) = opened(&sheet, &law, 55.33);
    near(mean(&openings), 44.35, 0.01);
    near(openings.iter().copied().fold(f64::INFINITY, f64::min), 42.67, 0.01);
    near(openings.iter().copied().fold(0.0, f64::max), 44.96, 0.01);
    std::iter::zip(rises, [0.4489, 0.4699, 0.4537])
        .for_each(|(found, published)| near(found, published, 1e-4));
}

/// What each choice adds to the mean opening at 30 N (deg).
#[test]
fn each_choice_has_its_share_of_the_difference() {
    let (ours, theirs) = (sheet(), at_means(sheet()));
    let opening = |sheet: &Sheet, law: &dyn HingeLaw| mean(&opened(sheet, law, 30.0).0);
    let along_the_ligament = uniform([STRETCH, SHEAR, ROTATION], &ours);
    let reading = opening(&ours, &along_the_ligament);
    let at_means = opening(&theirs, &along_the_ligament);
    let both = opening(&theirs, &along_x(&theirs));
    assert!((at_means - reading - 2.5).abs() < 0.1 && (both - at_means - 1.0).abs() < 0.1);
}
