//! What keeps the panels of a sheet in its plane, about its flat deployment: the tilt that follows from the bumps of its
//! ligaments, and the stiffness against leaving the plane.
//!
//! Every hinge is solved four times along its path in the sheet: as it is, and with panel B lifted or tilted about one of two
//! axes by a little more in every increment. The forces out of the plane are then known to first order, g + K q. Panels have
//! three more degrees of freedom, the lift of the point at which they are held or pulled and the tilts about x and y. Out of the
//! plane they are in equilibrium if
//!
//! ```text
//! sum over hinges of (g + K q + in-plane forces turned with the panels, and their moments at the arms of the panels) = 0
//! ```
//!
//! Loads and weight act in the plane, at the point of a panel to which its moments refer, and have no part in it.

use design::sheet::cut_sheet::Sheet;
use design::sheet::kinematics::deployed;
use faer::Side;
use faer::mat::Mat;
use faer::prelude::Solve;
use fe_driver::Lean;
use hinge::HingeSample;
use std::f64::consts::TAU;

/// A hinge at a place on the path of the sheet.
#[derive(Clone, Copy, Debug)]
pub struct LeaningHinge {
    /// The window as it is.
    pub sample: HingeSample,
    /// Forces out of the plane (N, N mm, N mm) without a lean.
    pub forces: [f64; 3],
    /// Their derivatives with respect to the lean, column by column.
    pub stiffness: [[f64; 3]; 3],
}

impl LeaningHinge {
    /// From the solved windows of a hinge without a lean and with the three of [`leans`], at `lambda`; `bump` is the side to
    /// which its bump points, 1 or -1. `None` beyond the end of a path.
    pub fn at(
        windows: [&[HingeSample]; 4],
        leans: [Lean; 3],
        bump: f64,
        lambda: f64,
    ) -> Option<Self> {
        let sample = HingeSample::at(windows[0], lambda)?;
        let forces = sample.out_of_plane()?;
        let mut stiffness = [[0.0; 3]; 3];
        for ((column, samples), lean) in stiffness.iter_mut().zip(&windows[1..]).zip(leans) {
            let leaning = HingeSample::at(samples, lambda)?.out_of_plane()?;
            let lean = lean.at(lambda);
            let amount = lean.lift + lean.tilt[0] + lean.tilt[1];
            *column = std::array::from_fn(|i| (leaning[i] - forces[i]) / amount);
        }
        Some(Self {
            sample,
            forces: forces.map(|force| bump * force),
            stiffness,
        })
    }
}

/// Tilt of a window with which its stiffness is measured (rad), at the end of its path.
const SMALL_TILT: f64 = 0.02;

/// The three leans with which the stiffness of a window is measured.
pub fn leans(w_lig: f64) -> [Lean; 3] {
    let tilted = |x: f64, y: f64| Lean {
        lift: 0.0,
        tilt: [SMALL_TILT * x, SMALL_TILT * y],
    };
    [
        Lean {
            lift: SMALL_TILT * w_lig,
            tilt: [0.0; 2],
        },
        tilted(1.0, 0.0),
        tilted(0.0, 1.0),
    ]
}

/// A sheet at one place on its path.
#[derive(Clone, Debug)]
pub struct OutOfPlane {
    /// Lift (mm) and tilts about x and y (rad) of every panel.
    pub panels: Vec<[f64; 3]>,
    /// Lowest eigenvalue of the stiffness (N/mm), with tilts multiplied by the mean width of a panel.
    pub stiffness: f64,
}

impl OutOfPlane {
    /// Largest tilt of a panel (rad).
    pub fn tilt(&self) -> f64 {
        (self.panels.iter()).fold(0.0, |most, [_, x, y]| x.hypot(*y).max(most))
    }
}

/// The sheet in a configuration in which its hinges are as given and the panels marked in `held` cannot leave the plane.
/// `None` if every panel is held or the equations cannot be solved.
pub fn out_of_plane(
    sheet: &Sheet,
    configuration: &[[f64; 3]],
    hinges: &[LeaningHinge],
    held: &[bool],
) -> Option<OutOfPlane> {
    let free: Vec<usize> = (0..sheet.panels.len())
        .filter(|panel| !held[*panel])
        .collect();
    let place = |panel: usize| free.binary_search(&panel).ok();
    let size = 3 * free.len();
    let area = sheet.panels.iter().map(|panel| panel.area).sum::<f64>();
    let width = (area / sheet.panels.len() as f64).sqrt();
    let (mut stiffness, mut forces) = (Mat::<f64>::zeros(size, size), Mat::<f64>::zeros(size, 1));
    for (h, hinge) in hinges.iter().enumerate() {
        let joint = Joint::new(sheet, h, configuration, hinge);
        let panels = joint.panels.map(place);
        let still = joint.wrenches([[0.0; 3]; 2]);
        for (side, row) in panels.iter().enumerate() {
            let Some(row) = row else { continue };
            for i in 0..3 {
                forces[(3 * row + i, 0)] += scaled(still[side], width)[i];
            }
        }
        for (moved, column) in panels.iter().enumerate() {
            let Some(column) = column else { continue };
            for j in 0..3 {
                let mut motions = [[0.0; 3]; 2];
                motions[moved][j] = if j == 0 { 1.0 } else { 1.0 / width };
                let with = joint.wrenches(motions);
                for (side, row) in panels.iter().enumerate() {
                    let Some(row) = row else { continue };
                    let change = std::array::from_fn(|i| with[side][i] - still[side][i]);
                    for (i, change) in scaled(change, width).into_iter().enumerate() {
                        stiffness[(3 * row + i, 3 * column + j)] += change;
                    }
                }
            }
        }
    }
    let symmetric = Mat::from_fn(size, size, |i, j| {
        0.5 * (stiffness[(i, j)] + stiffness[(j, i)])
    });
    let eigen = symmetric.self_adjoint_eigenvalues(Side::Lower).ok()?;
    let motion = stiffness.full_piv_lu().solve(&forces);
    Some(OutOfPlane {
        panels: (0..sheet.panels.len())
            .map(|panel| match place(panel) {
                None => [0.0; 3],
                Some(k) => std::array::from_fn(|i| {
                    -motion[(3 * k + i, 0)] * if i == 0 { 1.0 } else { 1.0 / width }
                }),
            })
            .collect(),
        stiffness: *eigen.first()?,
    })
}

/// A wrench with its moments divided by a width.
fn scaled([force, x, y]: [f64; 3], width: f64) -> [f64; 3] {
    [force, x / width, y / width]
}

/// A hinge between its two panels in the deployed sheet, in the axes of the sheet.
struct Joint<'a> {
    hinge: &'a LeaningHinge,
    /// Panels A and B.
    panels: [usize; 2],
    /// From the points of the panels to which their moments refer to O on panel B (mm).
    arms: [[f64; 2]; 2],
    /// Angle of the axes of the window that turn with panel B (rad).
    axes: f64,
    /// Force on panel B in the plane (N) and moment about O (N mm).
    force: [f64; 2],
    moment: f64,
}

impl<'a> Joint<'a> {
    fn new(sheet: &Sheet, h: usize, configuration: &[[f64; 3]], hinge: &'a LeaningHinge) -> Self {
        let of = &sheet.hinges[h];
        let panels = [of.panel_a(), of.panel_b()];
        let [turn_a, turn_b] = panels.map(|panel| configuration[panel][2]);
        let tip = deployed(&sheet.panels[panels[1]], configuration[panels[1]], of.tip);
        let arm = |panel: usize| {
            let flat = &sheet.panels[panel];
            let at = deployed(flat, configuration[panel], flat.reference);
            [tip[0] - at[0], tip[1] - at[1]]
        };
        let angle = of.e_sec[1].atan2(of.e_sec[0]);
        let sample = &hinge.sample;
        Self {
            hinge,
            panels,
            arms: panels.map(arm),
            axes: (angle + turn_b) % TAU,
            force: rotated([sample.f_a, sample.f_s], angle + 0.5 * (turn_a + turn_b)),
            moment: sample.m_theta - 0.5 * (sample.a * sample.f_s - sample.s * sample.f_a),
        }
    }

    /// The lean of panel B against panel A.
    fn lean(&self, [a, b]: [[f64; 3]; 2]) -> [f64; 3] {
        let [arm_a, arm_b] = self.arms;
        let rise = |[_, x, y]: [f64; 3], arm: [f64; 2]| x * arm[1] - y * arm[0];
        let lift = b[0] + rise(b, arm_b) - a[0] - rise(a, arm_a);
        let [x, y] = rotated([b[1] - a[1], b[2] - a[2]], -self.axes);
        [lift, x, y]
    }

    /// What must act on panels A and B out of the plane so that they have given lifts and tilts: forces, and moments about the
    /// points to which they refer.
    fn wrenches(&self, [a, b]: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
        let [arm_a, arm_b] = self.arms;
        let rise = |[_, x, y]: [f64; 3], arm: [f64; 2]| x * arm[1] - y * arm[0];
        let (rise_a, rise_b) = (rise(a, arm_a), rise(b, arm_b));
        let lift = b[0] + rise_b - a[0] - rise_a;
        let [x, y] = rotated([b[1] - a[1], b[2] - a[2]], -self.axes);
        let lean = [lift, x, y];
        let own: [f64; 3] = std::array::from_fn(|i| {
            let by_lean: f64 = (0..3).map(|j| self.hinge.stiffness[j][i] * lean[j]).sum();
            self.hinge.forces[i] + by_lean
        });
        let [f_x, f_y] = self.force;
        let force = own[0] + a[1] * f_y - a[2] * f_x;
        let [m_x, m_y] = rotated([own[1], own[2]], self.axes);
        let moment = [m_x + a[2] * self.moment, m_y - a[1] * self.moment];
        let about = |arm: [f64; 2], height: f64| {
            [
                moment[0] + arm[1] * force - height * f_y,
                moment[1] - arm[0] * force + height * f_x,
            ]
        };
        let on_a = about(arm_a, lift + rise_a);
        let on_b = about(arm_b, rise_b);
        [[-force, -on_a[0], -on_a[1]], [force, on_b[0], on_b[1]]]
    }
}

/// The vector (x, y) rotated counter-clockwise by `angle` (rad).
fn rotated([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

/// The leans of all hinges.
pub fn leans_of(
    sheet: &Sheet,
    configuration: &[[f64; 3]],
    hinges: &[LeaningHinge],
    panels: &[[f64; 3]],
) -> Vec<[f64; 3]> {
    hinges
        .iter()
        .enumerate()
        .map(|(h, hinge)| {
            let joint = Joint::new(sheet, h, configuration, hinge);
            joint.lean(joint.panels.map(|panel| panels[panel]))
        })
        .collect()
}
