//! Whether the panels of a plate stay in their plane along the path of its loads.
//!
//! Rigid panels may rise by z and tilt by (w_x, w_y) about the points at which they are held or
//! pulled. A ligament joins the heights of its panels at its middle, bends about the line across it
//! and twists about the line along it, with the stiffnesses
//!
//! ```text
//! k_bend = c K_aa t^2 / 12,      k_twist = J / (t w^3 / 12) k_theta / 3,      k_theta = M / theta,
//! ```
//!
//! with K_aa the stiffness along the ligament by the hinge law, J of the torsion of a rectangle w x
//! t, M the moment about the middle, k_theta at most its value in the flat sheet, and c a factor
//! from finite elements of whole sheets (docs/results/flatness). Moments M in the plane turn with
//! the ligament: by the mean tilt w of its panels, M changes by M w x e_z. Forces f act at an arm
//! that tilts with each panel. The margin of a state is the smallest factor of these forces and
//! moments at which the flat sheet is not stable. In an equilibrium without couples their stiffness
//! is symmetric; its symmetric part is taken.
//!
//! Ligaments as cut have a bump, here all of them on one side: their middles are higher by h and
//! slope by h / w_lig towards the secondary cut, so forces and moments lift and tilt the
//! panels before they are unstable. From a state to the next the motions q grow by
//!
//! ```text
//! (K + G) dq = dp - dG q,
//! ```
//!
//! with the stiffness K of the ligaments, the stiffness G by the forces in the plane, and the
//! moments p by the bumps.

use crate::calibration::CALIBRATION;
use design::equilibrium::load_step::LoadStep;
use design::equilibrium::tangent::TangentPattern;
use design::geometry::plane::{I, complex, cross, point, turn};
use design::hinge_law::Order;
use design::objective::design_problem::{Deployment, DesignProblem};
use design::sheet::cut_sheet::{Hinge, Sheet};
use design::sheet::kinematics::{Configuration, deployed};
use faer::c64;
use hinge::{HingeDeformation, Regime};
use scene::{Scene, SupportKind};
use serde::Serialize;
use std::array::from_fn;
use std::iter::zip;

/// The least margin that is distinguished.
const LEAST_MARGIN: f64 = 0.05;
/// The largest margin that is distinguished.
pub const MOST: f64 = 20.0;
/// Number of halvings of this interval: to 0.2 %.
const HALVINGS: usize = 12;

/// Stiffness of a ligament against a difference of heights over K_aa: so large that there is none.
const RIGID: f64 = 1e3;
/// Smallest stiffness along a ligament over that in the flat sheet.
const LEAST: f64 = 1e-3;

/// The stiffness of a hinge in (z, w_x, w_y) of its panels A and B.
type JointStiffness = [[f64; 6]; 6];

/// How a plate stays in its plane along its path.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Stability {
    /// The least margin.
    pub margin: f64,
    /// The largest tilt of a panel (rad) by the bumps of its ligaments; `None` if a margin is 1 or
    /// less.
    pub tilt: Option<f64>,
    /// Mean opening of the hinges (rad) at which the margin first falls below 1; `None` if it does
    /// not.
    pub leaves_at: Option<f64>,
}

impl Stability {
    /// Whether nothing needs to hold it flat.
    pub fn is_safe(self) -> bool {
        self.margin >= CALIBRATION.safe_margin.value
    }

    /// The stability of a deployed plate; `None` where [`out_of_plane`] has none.
    pub fn new(scene: &Scene, problem: &DesignProblem, deployment: &Deployment) -> Option<Self> {
        let path = out_of_plane(scene, problem, deployment)?;
        let states: Vec<[f64; 2]> = zip(&path, &deployment.path)
            .map(|(state, step)| [state.margin, step.mean_opening()])
            .collect();
        let crossing = |pair: &[[f64; 2]]| {
            let [[before, from], [after, to]] = [pair[0], pair[1]];
            (after < 1.0).then(|| from + (before - 1.0) / (before - after) * (to - from))
        };
        Some(Self {
            margin: (path.iter()).fold(f64::INFINITY, |least, state| least.min(state.margin)),
            tilt: (path.iter()).try_fold(0.0, |most, state| Some(f64::max(most, state.tilt()?))),
            leaves_at: match states.first() {
                Some([margin, opening]) if *margin < 1.0 => Some(*opening),
                _ => states.windows(2).find_map(crossing),
            },
        })
    }
}

/// A plate in a state of its path, seen from the side.
#[derive(Debug, PartialEq)]
pub struct OutOfPlane {
    /// The factor of its forces at which it leaves the plane, at most [`MOST`].
    pub margin: f64,
    /// (z, w_x, w_y) of every panel (mm, rad) by the bumps of its ligaments; `None` if the margin
    /// is 1 or less.
    pub motions: Option<Vec<[f64; 3]>>,
}

impl OutOfPlane {
    /// The largest tilt of a panel (rad).
    pub fn tilt(&self) -> Option<f64> {
        let tilts = self.motions.as_ref()?.iter().map(|[_, x, y]| x.hypot(*y));
        Some(tilts.fold(0.0, f64::max))
    }

    /// The heights of the panel corners (mm): SW, SE, NE and NW of every panel.
    pub fn heights(&self, sheet: &Sheet, configuration: &Configuration) -> Option<Vec<f64>> {
        let panels = zip(&sheet.panels, configuration);
        let heights =
            zip(self.motions.as_ref()?, panels).flat_map(|([z, w_x, w_y], (panel, motion))| {
                let [u_x, u_y, _] = motion;
                let [x, y] = panel.reference;
                panel.corners.map(|corner| {
                    let [at_x, at_y] = deployed(panel, *motion, corner);
                    z + w_x * (at_y - y - u_y) - w_y * (at_x - x - u_x)
                })
            });
        Some(heights.collect())
    }
}

/// Every load step of a deployed plate; `None` for a sheet on pins, for a film, and for a sheet
/// whose supports leave it free to move out of the plane. Clips and clamps of supports hold a panel
/// against rising and tilting, other supports one of its points; what pulls a panel holds nothing.
pub fn out_of_plane(
    scene: &Scene,
    problem: &DesignProblem,
    deployment: &Deployment,
) -> Option<Vec<OutOfPlane>> {
    let thickness = scene.material.thickness;
    let is_film = |hinge: &Hinge| scene.material.regime(hinge.w_lig) == Regime::Film;
    if deployment.sheet.hinges.iter().any(is_film) {
        return None;
    }
    let mechanics = problem.model.mechanics()?;
    let sheet = &deployment.sheet;
    let law = mechanics.law.prepare(&sheet.designs());
    let undeformed = vec![HingeDeformation::default(); sheet.hinges.len()];
    let flat = law.energies(&undeformed, Order::Tangent);
    let pattern = TangentPattern::new(&sheet.topology, supported(scene, sheet).as_flattened());
    let of_step = |step: &LoadStep| {
        let elastic = law.energies(&step.deformations, Order::Tangent);
        // Contact carries forces, but does not stiffen ligaments.
        let mut total = elastic.clone();
        if let Some(contact) = &mechanics.contact {
            contact.add(&mut total, &step.deformations);
        }
        let mut loads = vec![[0.0; 3]; sheet.panels.len()];
        let blocks = sheet.hinges.iter().enumerate().map(|(h, hinge)| {
            let ligament = Ligament::new(sheet, h, &step.configuration, total[h].forces);
            let secant = ligament.moment / step.deformations[h].theta;
            let tangents = [&flat[h].tangent, &elastic[h].tangent];
            let stiffness = Stiffness::new(tangents, secant, hinge.w_lig, thickness);
            let [a, b] = ligament.moments_of_bump(hinge.w_lig, thickness);
            for (panel, [x, y]) in [(hinge.panel_a(), a), (hinge.panel_b(), b)] {
                loads[panel][1] += x;
                loads[panel][2] += y;
            }
            (ligament.elastic(&stiffness), ligament.geometric())
        });
        let (elastic, geometric): (Vec<JointStiffness>, Vec<JointStiffness>) = blocks.unzip();
        OfForces {
            elastic: pattern.assemble(elastic.into_iter()),
            geometric: pattern.assemble(geometric.into_iter().map(symmetric)),
            loads: pattern.gather(&loads),
        }
    };
    let mut path = Vec::new();
    let nothing = pattern.gather(&vec![[0.0; 3]; sheet.panels.len()]);
    let (mut before, mut motions): (Option<OfForces>, _) = (None, Some(nothing));
    for step in &deployment.path {
        let now = of_step(step);
        let margin = margin(&pattern, &now.elastic, &now.geometric)?;
        motions = (motions.filter(|_| margin > 1.0))
            .and_then(|motions| moved(&pattern, before.as_ref(), &now, motions));
        path.push(OutOfPlane {
            margin,
            motions: motions.as_ref().map(|motions| pattern.spread(motions)),
        });
        before = Some(now);
    }
    Some(path)
}

/// Whether the supports hold (z, w_x, w_y) of every panel.
fn supported(scene: &Scene, sheet: &Sheet) -> Vec<[bool; 3]> {
    let mut supported = vec![[false; 3]; sheet.panels.len()];
    let attachments = scene.actuation().attachments;
    for (support, attachment) in zip(&scene.config.supports, &attachments) {
        let [height, tilts @ ..] = &mut supported[attachment.panel];
        *height = true;
        let clipped = support.kind == SupportKind::Clamp || attachment.clip.is_some();
        tilts.iter_mut().for_each(|held| *held |= clipped);
    }
    supported
}

/// What forces and moments in the plane of a state do out of it.
struct OfForces {
    /// The stiffness of the ligaments by their own, and by forces and moments in the plane.
    elastic: Vec<f64>,
    geometric: Vec<f64>,
    /// The moments by the bumps.
    loads: Vec<f64>,
}

/// The `motions` after a further state; `None` if the stiffness is singular.
fn moved(
    pattern: &TangentPattern,
    before: Option<&OfForces>,
    now: &OfForces,
    mut motions: Vec<f64>,
) -> Option<Vec<f64>> {
    let stiffness = zip(&now.elastic, &now.geometric).map(|(e, g)| e + g);
    let factor = pattern.factorise(&stiffness.collect::<Vec<_>>(), Vec::new())?;
    let unbalanced = |state: &OfForces| {
        let (by_tilt, _) = pattern.product(&state.geometric, &motions);
        zip(&state.loads, by_tilt).map(|(load, by_tilt)| load - by_tilt).collect()
    };
    let mut change: Vec<f64> = unbalanced(now);
    if let Some(before) = before {
        let before: Vec<f64> = unbalanced(before);
        change.iter_mut().zip(before).for_each(|(change, before)| *change -= before);
    }
    pattern.solve(&factor, &mut change);
    motions.iter_mut().zip(change).for_each(|(motion, change)| *motion += change);
    Some(motions)
}

/// The symmetric part of a block.
fn symmetric(block: JointStiffness) -> JointStiffness {
    from_fn(|i| from_fn(|j| 0.5 * (block[i][j] + block[j][i])))
}

/// The smallest multiple of `geometric` at which its sum with `elastic` is not positive definite,
/// from [`LEAST_MARGIN`] to [`MOST`]; `None` if `elastic` is not.
fn margin(pattern: &TangentPattern, elastic: &[f64], geometric: &[f64]) -> Option<f64> {
    let is_stable = |multiple: f64| {
        let sum = zip(elastic, geometric).map(|(e, g)| e + multiple * g);
        let sum: Vec<f64> = sum.collect();
        let factor = pattern.factorise(&sum, Vec::new());
        factor.is_some_and(|factor| factor.negative_pivots == 0)
    };
    if !is_stable(0.0) {
        return None;
    }
    let [mut stable, mut unstable] = [LEAST_MARGIN, MOST];
    if is_stable(unstable) {
        return Some(unstable);
    }
    for _ in 0..HALVINGS {
        let between = (stable * unstable).sqrt();
        if is_stable(between) {
            stable = between;
        } else {
            unstable = between;
        }
    }
    Some(stable)
}

/// The stiffnesses of a ligament out of the plane.
struct Stiffness {
    /// Resistance to a difference of heights (N/mm).
    height: f64,
    /// Resistance to bending and twist (N mm).
    bend: f64,
    twist: f64,
}

impl Stiffness {
    /// The stiffnesses by the tangents of the hinge law in the flat sheet and in a state, and by the
    /// `secant` stiffness of the rotation there (N mm).
    fn new([flat, state]: [&[[f64; 3]; 3]; 2], secant: f64, w_lig: f64, thickness: f64) -> Self {
        let axial = state[0][0].max(LEAST * flat[0][0]);
        // The stiffness about the middle, where a rotation causes no axial force.
        let elastic = flat[2][2] - flat[0][2].powi(2) / flat[0][0];
        // A hinge that forces turn against its moment, or that has not turned, has the stiffness of
        // the flat sheet.
        let rotation = if secant > 0.0 { secant.clamp(LEAST * elastic, elastic) } else { elastic };
        let (least, most) = (w_lig.min(thickness), w_lig.max(thickness));
        let slender = least / most;
        let torsion = most * least.powi(3) / 3.0 * (1.0 - 0.63 * slender + 0.052 * slender.powi(5));
        let bending = thickness * w_lig.powi(3) / 12.0;
        Self {
            height: RIGID * flat[0][0],
            bend: CALIBRATION.unloading.value * axial * thickness.powi(2) / 12.0,
            twist: torsion / bending * rotation / 3.0,
        }
    }
}

/// A ligament in a state of the sheet in its plane.
struct Ligament {
    /// Unit vector along it.
    along: c64,
    /// Arms from the reference points of panels A and B to its middle (mm).
    arms: [c64; 2],
    /// Force on panel A towards B (N), and moment about its middle (N mm).
    force: c64,
    moment: f64,
}

impl Ligament {
    fn new(
        sheet: &Sheet,
        h: usize,
        configuration: &Configuration,
        [f_a, f_s, m_theta]: [f64; 3],
    ) -> Self {
        let hinge = &sheet.hinges[h];
        let panels = hinge.panels();
        let turned = 0.5 * (configuration[panels[0]][2] + configuration[panels[1]][2]);
        let e_sec = complex(hinge.e_sec);
        let middle = complex(hinge.tip) + 0.5 * hinge.w_lig * I * e_sec;
        // Mean position of a point of the flat sheet on the two panels.
        let mean = |flat: c64| {
            let on = |k: usize| {
                let panel = &sheet.panels[panels[k]];
                complex(deployed(panel, configuration[panels[k]], point(flat)))
            };
            0.5 * (on(0) + on(1))
        };
        let at = mean(middle);
        let along = e_sec * turn(turned);
        let force = c64::new(f_a, f_s) * along;
        let arm = |k: usize| {
            let [u_x, u_y, _] = configuration[panels[k]];
            at - complex(sheet.panels[panels[k]].reference) - c64::new(u_x, u_y)
        };
        Self {
            along,
            arms: [arm(0), arm(1)],
            force,
            moment: m_theta + cross(mean(complex(hinge.attachment)) - at, force),
        }
    }

    /// The stiffness of the ligament itself.
    fn elastic(&self, stiffness: &Stiffness) -> JointStiffness {
        let [a, b] = self.arms;
        let turn = |c64 { re: x, im: y }: c64| [0.0, -x, -y, 0.0, x, y];
        let height = [-1.0, -a.im, a.re, 1.0, b.im, -b.re];
        let motions = [
            (stiffness.height, height),
            (stiffness.twist, turn(self.along)),
            (stiffness.bend, turn(I * self.along)),
        ];
        let mut block = JointStiffness::default();
        for (stiffness, motion) in motions {
            for (row, by_row) in block.iter_mut().zip(motion) {
                for (entry, by_column) in row.iter_mut().zip(motion) {
                    *entry += stiffness * by_row * by_column;
                }
            }
        }
        block
    }

    /// The moments (N mm) about x and y on panels A and B by its bump.
    fn moments_of_bump(&self, w_lig: f64, thickness: f64) -> [[f64; 2]; 2] {
        // Its middle is half a ligament width from the secondary cut.
        let height = Regime::Plate.bump() * thickness * f64::exp(-0.25);
        let slope = height / w_lig * I * self.along;
        let moment = self.moment * slope - height * I * self.force;
        let on_b = [moment.re, moment.im];
        [on_b.map(|moment| -moment), on_b]
    }

    /// The stiffness by its force and moment in the plane.
    fn geometric(&self) -> JointStiffness {
        let mut block = JointStiffness::default();
        let half = 0.5 * self.moment;
        for (panel, sign) in [(0, -1.0), (1, 1.0)] {
            let row = 3 * panel;
            // M w x e_z, of the mean tilt.
            for column in [0, 3] {
                block[row + 1][column + 2] += sign * half;
                block[row + 2][column + 1] -= sign * half;
            }
            // The height w x r of the middle times e_z x f.
            let (r, f) = (self.arms[panel], self.force);
            for (column, height) in [(row + 1, r.im), (row + 2, -r.re)] {
                block[row + 1][column] -= sign * height * f.im;
                block[row + 2][column] += sign * height * f.re;
            }
        }
        block
    }
}

#[cfg(test)]
mod tests;
