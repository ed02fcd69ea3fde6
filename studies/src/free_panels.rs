//! Panels with free corners, with which section 3.1 compares the charts. The coordinates are the corners of each
//! panel and the opening angle. Hinges have gaps, panels overlap and voids remain unless this is enforced.
//!
//! In the deployed state panel k is rotated by R_k = R(-+theta/2) as in the ideal deployment. The translations
//! t_k close the hinges in the least-squares sense, as equal springs would:
//! ```text
//! y_kc = t_k + R_k x_kc,     t = argmin sum over hinges |y_a - y_b|^2
//! ```
//!
//! so t is linear in R x through the graph Laplacian of the panels, which is the same for all designs.
//! For a deployable pattern this is the ideal deployment. Lengths are relative to the sheet's side.

use crate::panel_penalties::{overlap, void};
use crate::tessellation::Tessellation;
use design::geometry::plane::{I, add, complex, dot, point, turn};
use design::geometry::polygon::contains;
use design::objective::design_problem::{DesignError, DesignProblem};
use design::objective::loss::Objective;
use design::optimise::adam::Adam;
use design::pattern::cut_pattern::Outline;
use design::pattern::design_vector::DesignVector;
use design::sheet::cut_sheet::Sheet;
use design::sheet::topology::{PanelCorner, is_even};
use faer::c64;
use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};

/// Weights of the penalties relative to the Chamfer distance divided by the sheet's area.
const OVERLAP_WEIGHT: f64 = 10.0;
const VOID_WEIGHT: f64 = 1.0;
/// Number of points along the side of a panel at which the cover of the sheet is evaluated; the softness of
/// the panels' borders is a quarter of their spacing.
const SAMPLES_A_PANEL: usize = 6;

/// How the validity of the panels is enforced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Enforcement {
    Nothing,
    /// After every step the corners that a hinge joins are moved to their mean, and overlap of the
    /// flat and the deployed panels is penalised.
    Projection,
    /// As [`Projection`](Self::Projection), with a penalty on area that the flat panels do not cover.
    Tiling,
}

/// The search over free panel corners.
pub struct FreePanels<'a> {
    enforcement: Enforcement,
    sheet: Sheet,
    /// mm
    side: f64,
    objective: &'a Objective,
    outline_points: Vec<PanelCorner>,
    laplacian: Llt<f64>,
    samples: Vec<[f64; 2]>,
    start: Vec<f64>,
}

/// The result of a search.
pub struct FreeDesign {
    /// Deployed with the mean of P at the origin, where the target is centred.
    pub tessellation: Tessellation,
    /// rad
    pub opening: f64,
    /// Loss including penalties (mm^2), at the start and after every step.
    pub losses: Vec<f64>,
}

impl<'a> FreePanels<'a> {
    /// Starts from the panels of `start`, with the opening angle `opening` (rad) at all hinges.
    pub fn new(
        problem: &'a DesignProblem,
        start: &DesignVector,
        opening: f64,
        enforcement: Enforcement,
    ) -> Result<Self, DesignError> {
        let (_, sheet) = problem.cut(start)?;
        if problem.objective.shape.target.is_empty() {
            return Err(DesignError::EmptyTarget);
        }
        let side = sheet.outline.area().sqrt();
        let corners = sheet
            .panels
            .iter()
            .flat_map(|panel| panel.corners)
            .flatten();
        let start = corners
            .map(|length| length / side)
            .chain([opening])
            .collect();
        Ok(Self {
            enforcement,
            side,
            objective: &problem.objective,
            outline_points: problem.objective.shape.outline.corners(&sheet),
            laplacian: laplacian(&sheet),
            samples: samples(&sheet.outline, sheet.panels.len(), side),
            start,
            sheet,
        })
    }

    /// Number of coordinates, including the opening.
    pub fn coordinates(&self) -> usize {
        self.start.len()
    }

    /// Searches with Adam at the given rate (relative to the side, and rad); returns the design of minimum loss.
    pub fn search(&self, steps: usize, learning_rate: f64) -> FreeDesign {
        let mut adam = Adam::new(self.start.len(), learning_rate);
        let mut x = self.start.clone();
        let (mut loss, mut gradient) = self.evaluate(&x);
        let mut losses = vec![loss];
        let (mut best, mut minimum) = (x.clone(), loss);
        for _ in 0..steps {
            for (x, dx) in x.iter_mut().zip(adam.increment(&gradient)) {
                *x += dx;
            }
            if self.enforcement != Enforcement::Nothing {
                self.close_hinges(&mut x);
            }
            (loss, gradient) = self.evaluate(&x);
            losses.push(loss);
            if loss < minimum {
                (best, minimum) = (x.clone(), loss);
            }
        }
        let (corners, opening) = split(&best);
        let in_mm = |panels: Vec<[[f64; 2]; 4]>| -> Vec<_> {
            let scale = |corner: [f64; 2]| corner.map(|length| length * self.side);
            panels.into_iter().map(|panel| panel.map(scale)).collect()
        };
        let deployed = self.deploy(&corners, opening);
        let outline = self.outline_points.iter().map(|&(k, c)| deployed[k][c]);
        let centre = outline.sum::<c64>() / self.outline_points.len() as f64;
        FreeDesign {
            tessellation: Tessellation {
                outline: self.sheet.outline,
                grid: self.sheet.grid,
                deployed: in_mm(
                    deployed
                        .iter()
                        .map(|panel| panel.map(|z| point(z - centre)))
                        .collect(),
                ),
                flat: in_mm(corners),
            },
            opening,
            losses: losses.iter().map(|loss| loss * self.side.powi(2)).collect(),
        }
    }

    /// The flat corners `flat` (mm) deployed at `states` openings up to the given one.
    pub fn while_opening(
        &self,
        flat: &[[[f64; 2]; 4]],
        opening: f64,
        states: usize,
    ) -> impl Iterator<Item = Vec<[[f64; 2]; 4]>> {
        (1..=states).map(move |state| {
            let deployed = self.deploy(flat, opening * state as f64 / states as f64);
            deployed.iter().map(|panel| panel.map(point)).collect()
        })
    }

    /// The loss and its gradient.
    fn evaluate(&self, x: &[f64]) -> (f64, Vec<f64>) {
        let (corners, opening) = split(x);
        let deployed = self.deploy(&corners, opening);
        let mut by_deployed = vec![[c64::ZERO; 4]; corners.len()];
        let mut by_corners = vec![[[0.0; 2]; 4]; corners.len()];

        let scale = c64::new(self.side, 0.0);
        let outline: Vec<_> = (self.outline_points.iter())
            .map(|&(k, corner)| point(scale * deployed[k][corner]))
            .collect();
        let (chamfer, by_outline) = self.objective.shape.distance(&outline);
        let mut loss = chamfer / self.side.powi(2);
        for (&(k, corner), &gradient) in std::iter::zip(&self.outline_points, &by_outline) {
            by_deployed[k][corner] += complex(gradient) / self.side;
        }
        if self.enforcement != Enforcement::Nothing {
            let panels: Vec<_> = deployed.iter().map(|panel| panel.map(point)).collect();
            let (value, gradient) = overlap(&panels);
            loss += OVERLAP_WEIGHT * value;
            for (sum, gradient) in by_deployed
                .as_flattened_mut()
                .iter_mut()
                .zip(gradient.as_flattened())
            {
                *sum += complex(*gradient) * OVERLAP_WEIGHT;
            }
            let (value, gradient) = overlap(&corners);
            loss += OVERLAP_WEIGHT * value;
            add_weighted(&mut by_corners, &gradient, OVERLAP_WEIGHT);
        }
        if self.enforcement == Enforcement::Tiling {
            let outline = self
                .sheet
                .outline
                .corners
                .map(|corner| corner.map(|x| x / self.side));
            let (value, gradient) = void(&corners, &outline, &self.samples, self.softness());
            loss += VOID_WEIGHT * value;
            add_weighted(&mut by_corners, &gradient, VOID_WEIGHT);
        }
        let by_opening = self.deploy_pullback(&corners, opening, by_deployed, &mut by_corners);
        let gradient = by_corners.into_flattened().into_flattened();
        (loss, gradient.into_iter().chain([by_opening]).collect())
    }

    fn softness(&self) -> f64 {
        0.25 / (SAMPLES_A_PANEL as f64 * (self.sheet.panels.len() as f64).sqrt())
    }

    /// The deployed corners.
    fn deploy(&self, corners: &[[[f64; 2]; 4]], opening: f64) -> Vec<[c64; 4]> {
        let mut deployed: Vec<[c64; 4]> = (corners.iter().enumerate())
            .map(|(k, panel)| panel.map(|corner| self.turned(k, opening) * complex(corner)))
            .collect();
        let mut pulls = vec![c64::ZERO; corners.len()];
        for hinge in &self.sheet.hinges {
            let ((a, at_a), (b, at_b)) = (hinge.site.a, hinge.site.b);
            let gap = deployed[a][at_a] - deployed[b][at_b];
            pulls[a] -= gap;
            pulls[b] += gap;
        }
        for (panel, shift) in deployed.iter_mut().zip(self.solve(&pulls)) {
            panel.iter_mut().for_each(|corner| *corner += shift);
        }
        deployed
    }

    /// The gradient in the opening of a function with the given gradient in the deployed corners; the gradient
    /// in the flat corners is added to `by_corners`.
    fn deploy_pullback(
        &self,
        corners: &[[[f64; 2]; 4]],
        opening: f64,
        mut by_deployed: Vec<[c64; 4]>,
        by_corners: &mut [[[f64; 2]; 4]],
    ) -> f64 {
        let by_shift: Vec<c64> = by_deployed.iter().map(|panel| panel.iter().sum()).collect();
        let adjoint = self.solve(&by_shift);
        for hinge in &self.sheet.hinges {
            let ((a, at_a), (b, at_b)) = (hinge.site.a, hinge.site.b);
            let by_gap = adjoint[b] - adjoint[a];
            by_deployed[a][at_a] += by_gap;
            by_deployed[b][at_b] -= by_gap;
        }
        let mut by_opening = 0.0;
        for (k, panel) in by_deployed.iter().enumerate() {
            let spin = self.turned(k, opening);
            for (corner, &force) in panel.iter().enumerate() {
                add(&mut by_corners[k][corner], spin.conj() * force);
                let arm = spin * complex(corners[k][corner]);
                by_opening += self.sense(k) * dot(force, I * arm);
            }
        }
        by_opening
    }

    fn turned(&self, panel: usize, opening: f64) -> c64 {
        turn(self.sense(panel) * opening)
    }

    /// Derivative of the panel's rotation with respect to the opening.
    fn sense(&self, panel: usize) -> f64 {
        if is_even(self.sheet.grid, panel) {
            -0.5
        } else {
            0.5
        }
    }

    /// The translations with zero mean that solve the Laplacian for `pulls` minus their mean.
    fn solve(&self, pulls: &[c64]) -> Vec<c64> {
        let mean = pulls.iter().sum::<c64>() / pulls.len() as f64;
        let rhs = Mat::from_fn(pulls.len(), 2, |k, axis| point(pulls[k] - mean)[axis]);
        let shifts = self.laplacian.solve(rhs);
        (0..pulls.len())
            .map(|k| c64::new(shifts[(k, 0)], shifts[(k, 1)]))
            .collect()
    }

    /// Moves the flat corners that a hinge joins to their mean.
    fn close_hinges(&self, x: &mut [f64]) {
        for hinge in &self.sheet.hinges {
            let [a, b] = [hinge.site.a, hinge.site.b].map(|(k, corner)| 8 * k + 2 * corner);
            for axis in 0..2 {
                let middle = 0.5 * (x[a + axis] + x[b + axis]);
                x[a + axis] = middle;
                x[b + axis] = middle;
            }
        }
    }
}

/// The corners of every panel, and the opening.
fn split(x: &[f64]) -> (Vec<[[f64; 2]; 4]>, f64) {
    let panel = |x: &[f64]| std::array::from_fn(|c| [x[2 * c], x[2 * c + 1]]);
    (x.chunks_exact(8).map(panel).collect(), x[x.len() - 1])
}

fn add_weighted(sum: &mut [[[f64; 2]; 4]], gradient: &[[[f64; 2]; 4]], weight: f64) {
    for (sum, gradient) in sum
        .as_flattened_mut()
        .iter_mut()
        .zip(gradient.as_flattened())
    {
        add(sum, complex(*gradient) * weight);
    }
}

/// The factored graph Laplacian of panels joined by hinges; a common translation of all panels, which is its
/// null space, is fixed at zero.
fn laplacian(sheet: &Sheet) -> Llt<f64> {
    let n = sheet.panels.len();
    let mut matrix = Mat::from_fn(n, n, |_, _| 1.0 / n as f64);
    for hinge in &sheet.hinges {
        let (a, b) = (hinge.panel_a(), hinge.panel_b());
        matrix[(a, a)] += 1.0;
        matrix[(b, b)] += 1.0;
        matrix[(a, b)] -= 1.0;
        matrix[(b, a)] -= 1.0;
    }
    matrix
        .llt(Side::Lower)
        .expect("the panels are connected and their common translation is fixed")
}

/// Points of a square grid in the sheet, relative to its side.
fn samples(outline: &Outline, panels: usize, side: f64) -> Vec<[f64; 2]> {
    let corners = outline
        .corners
        .map(|corner| corner.map(|length| length / side));
    let low = [0, 1].map(|axis| {
        corners
            .iter()
            .map(|c| c[axis])
            .fold(f64::INFINITY, f64::min)
    });
    let spacing = 1.0 / (SAMPLES_A_PANEL as f64 * (panels as f64).sqrt());
    let count = (outline.size() / side / spacing).ceil() as usize;
    let at = |i: usize, j: usize| [i, j].map(|index| (index as f64 + 0.5) * spacing);
    (0..count)
        .flat_map(|j| (0..count).map(move |i| (i, j)))
        .map(|(i, j)| {
            let [x, y] = at(i, j);
            [low[0] + x, low[1] + y]
        })
        .filter(|sample| contains(&corners, *sample))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use design::analysis::taylor::central_slope;
    use design::scene::Scene;
    use design::sheet::kinematics::deployed_corners;
    use std::path::Path;

    /// The shipped scene of section 3.1, with any deployable pattern.
    fn scene() -> Scene {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes/pin-7x7.toml");
        let mut scene = Scene::read(&path).unwrap();
        scene.config.optimiser.start_noise = 0.5;
        scene
    }

    #[test]
    fn the_gradient_agrees_with_differences() {
        let mut scene = scene();
        scene.config.objective.smoothing = 1e4;
        let (problem, start) = (scene.problem().unwrap(), scene.start());
        let free = FreePanels::new(&problem, &start, 0.9, Enforcement::Tiling).unwrap();
        // A general state, in which panels overlap and have gaps and voids.
        let x: Vec<f64> = (free.start.iter().enumerate())
            .map(|(i, x)| x + 0.01 * (1.7 * i as f64).sin())
            .collect();
        let (_, gradient) = free.evaluate(&x);
        for turn in 0..4 {
            let direction: Vec<f64> = (0..x.len())
                .map(|i| ((turn * 31 + i) as f64 * 0.7).cos())
                .collect();
            let slope = central_slope(|x| free.evaluate(x).0, &x, &direction, 1e-7);
            let found: f64 = std::iter::zip(&gradient, &direction)
                .map(|(g, d)| g * d)
                .sum();
            assert!((found / slope - 1.0).abs() < 1e-5, "{found} {slope}");
        }
        let opening = x.len() - 1;
        let unit: Vec<f64> = (0..x.len()).map(|i| f64::from(i == opening)).collect();
        let slope = central_slope(|x| free.evaluate(x).0, &x, &unit, 1e-7);
        assert!((gradient[opening] / slope - 1.0).abs() < 1e-5);
    }

    /// For a deployable pattern the equal springs are not stretched.
    #[test]
    fn a_deployable_pattern_deploys_as_its_mechanism() {
        let scene = scene();
        let (problem, start) = (scene.problem().unwrap(), scene.start());
        let opening = start.opening.unwrap();
        let free = FreePanels::new(&problem, &start, opening, Enforcement::Tiling).unwrap();
        assert_eq!(free.coordinates(), 392 + 1);
        let found = free.search(0, 0.01);
        let defects = found.tessellation.defects();
        assert!(defects.gap.iter().all(|gap| *gap < 1e-14), "{defects:?}");
        assert!(defects.overlap.iter().all(|overlap| *overlap < 1e-14));
        assert!(defects.void < 1e-14);

        let deployment = problem.deploy(&start).unwrap();
        let exact = deployed_corners(&deployment.sheet, &deployment.final_step().configuration);
        let corner = |panels: &[[[f64; 2]; 4]]| panels[0][0];
        let shift =
            [0, 1].map(|axis| corner(&exact)[axis] - corner(&found.tessellation.deployed)[axis]);
        for (exact, found) in std::iter::zip(&exact, &found.tessellation.deployed) {
            for (exact, found) in std::iter::zip(exact, found) {
                for axis in 0..2 {
                    assert!((exact[axis] - found[axis] - shift[axis]).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn enforced_conditions_have_smaller_defects() {
        let scene = scene();
        let (problem, start) = (scene.problem().unwrap(), scene.start());
        let run = |enforcement| {
            let opening = start.opening.unwrap();
            let free = FreePanels::new(&problem, &start, opening, enforcement).unwrap();
            let found = free.search(15, 0.005);
            let minimum = found.losses.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(minimum < 0.9 * found.losses[0], "{enforcement:?}");
            found.tessellation.defects()
        };
        let torn = run(Enforcement::Nothing);
        let joined = run(Enforcement::Projection);
        assert!(torn.gap[0] > 0.01, "{torn:?}");
        assert!(joined.gap[0] < 1e-14, "{joined:?}");
        assert!(joined.overlap[0] < torn.overlap[0]);
    }
}
