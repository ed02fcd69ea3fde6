//! The authors of the paper publish load and opening of a sheet of 3 x 3 panels with linear
//! springs, jkloers/neural-form-finding (MIT), `data/configs/closed/sheet_4x8ft_rom.yaml` (216f0de)
//! and `sheet_4x8ft_rom_disp.yaml` (bbe90d9). Their program differs from the text of the paper in
//! two points:
//!
//! * it holds and pulls a panel at the mean of its four corners, not at its centroid;
//! * an ideal corner is a bond of zero length, which has no direction. Their program takes x for
//!   it, at all hinges: `k_stretch` acts along x and `k_shear` along y, rotated by the mean frame.
//!
//! With both, all of their figures are found to the last digit; without, openings are up to 3.5 deg
//! smaller.

use crate::prelude::*;

/// Width and height of a panel (mm).
const PITCH: [f64; 2] = [406.4, 812.8];
/// `k_stretch`, `k_shear` (N/mm) and `k_rot` (N mm/rad).
const STRETCH: f64 = 238.1;
const SHEAR: f64 = 127.4;
const ROTATION: f64 = 487.0;

/// Load of each of the three upper panels (N), and the mean opening of the hinges (deg).
const OPENINGS: [(f64, f64); 7] = [
    (15.0, 29.0),
    (30.0, 37.9),
    (55.33, 44.35),
    (60.0, 45.0),
    (120.0, 49.0),
    (600.0, 52.3),
    (6000.0, 53.0),
];

/// Smallest and largest opening at 55.33 N (deg).
const EXTREMES: [f64; 2] = [42.67, 44.96];
/// Motion of the upper panels at 55.33 N, in widths of a panel.
const RISES: [f64; 3] = [0.4489, 0.4699, 0.4537];

/// A sheet of 4 x 8 ft whose voids have r = 0.45.
fn sheet() -> Sheet {
    let grid = Grid { m: 3, n: 3 };
    let mut coordinates = PatternCoordinates::uniform(grid);
    coordinates.z.fill((0.45_f64 / 0.55).ln());
    let outline = Outline::rectangle(3.0 * PITCH[0], 3.0 * PITCH[1]);
    cut(grid, outline, &coordinates, 18.0, AT_CORNER)
}

fn mean_of_corners(panel: &Panel) -> [f64; 2] {
    [0, 1].map(|c| panel.corners.iter().map(|corner| corner[c]).sum::<f64>() / 4.0)
}

/// The sheet held and pulled at the mean of the corners of its panels.
fn at_means(sheet: Sheet) -> Sheet {
    let at_mean = |k: usize| attached(k, PanelPoint::Fixed(mean_of_corners(&sheet.panels[k])));
    let points: Vec<_> = (0..sheet.panels.len()).map(at_mean).collect();
    sheet.attached_at(&points)
}

/// The springs along and across the ligament.
fn along_the_ligament(sheet: &Sheet) -> LinearLaw {
    uniform([STRETCH, SHEAR, ROTATION], sheet)
}

/// The springs along x and y at all hinges: angles of the secondary cuts (rad).
struct AlongX(Vec<f64>);

impl AlongX {
    fn new(sheet: &Sheet) -> Self {
        Self(sheet.hinges.iter().map(|hinge| hinge.e_sec[1].atan2(hinge.e_sec[0])).collect())
    }
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
    let mut supports = [0, 1, 2].map(|panel| support(panel, Dof::UY, 0.0)).to_vec();
    supports.push(support(1, Dof::UX, 0.0));
    let loads = [6, 7, 8].map(|panel| load(panel, Dof::UY, force));
    let path = path(sheet, law, &supports, &loads, 6);
    assert!(converged(&path), "{force} N");
    let end = &path[5].configuration;
    let openings =
        hinge_deformations(sheet, end).iter().map(|hinge| hinge.theta.to_degrees()).collect();
    (openings, [6, 7, 8].map(|panel| end[panel][1] / PITCH[0]))
}

fn mean(openings: &[f64]) -> f64 {
    openings.iter().sum::<f64>() / openings.len() as f64
}

fn near(found: f64, published: f64, digit: f64) -> bool {
    (found - published).abs() <= 0.51 * digit
}

#[test]
fn their_sheet_with_their_two_choices_opens_as_they_publish() {
    let sheet = at_means(sheet());
    let law = AlongX::new(&sheet);
    for (force, published) in OPENINGS {
        let digit = if published == 44.35 { 0.01 } else { 0.1 };
        let found = mean(&opened(&sheet, &law, force).0);
        assert!(near(found, published, digit), "{force} N: {found}, {published}");
    }
    let (openings, rises) = opened(&sheet, &law, 55.33);
    let smallest = openings.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = openings.iter().copied().fold(0.0, f64::max);
    for (found, published) in std::iter::zip([smallest, largest], EXTREMES) {
        assert!(near(found, published, 0.01), "{found}, {published}");
    }
    for (found, published) in std::iter::zip(rises, RISES) {
        assert!(near(found, published, 1e-4), "{found}, {published}");
    }
}

/// Differences of the mean opening at 15 and 30 N (deg) by each choice, from our reading.
#[test]
fn each_choice_has_its_share_of_the_difference() {
    let ours = sheet();
    let theirs = at_means(sheet());
    for (force, points, axes) in [(15.0, 2.3, 0.7), (30.0, 2.5, 1.0)] {
        let opening = |sheet: &Sheet, law: &dyn HingeLaw| mean(&opened(sheet, law, force).0);
        let reading = opening(&ours, &along_the_ligament(&ours));
        let at_means = opening(&theirs, &along_the_ligament(&theirs));
        let both = opening(&theirs, &AlongX::new(&theirs));
        assert!((at_means - reading - points).abs() < 0.1, "{force} N: {}", at_means - reading);
        assert!((both - at_means - axes).abs() < 0.1, "{force} N: {}", both - at_means);
    }
}
