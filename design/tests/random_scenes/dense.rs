//! Forces and tangent of a sheet from the definitions, with full matrices: the equations of the
//! solver written a second time, for small sheets.
//!
//! Let x(O) be the deployed position of the attachment point O on either panel. The hinge
//! deformation (8) is
//!
//! ```text
//! a + i s = e^(-i(beta + phibar)) (x_B(O) - x_A(O)),     theta = phi_B - phi_A
//! ```

use crate::drawn::Drawn;
use design::equilibrium::load_step::LoadStep;
use design::hinge_law::Order;
use design::objective::design_problem::DesignProblem;
use design::sheet::cut_sheet::Sheet;
use faer::{Mat, Side, c64};
use hinge::HingeDeformation;

/// The unbalanced forces and the lowest stiffness of a state.
pub(crate) struct DenseCheck {
    /// The largest force on a panel, in this state or before (N).
    pub force: f64,
    /// Maximum unbalanced force, relative to that.
    pub residual: f64,
    /// The part of it that the rounding of the deformations can cause.
    pub rounding: f64,
    /// Lowest eigenvalue of the tangent of the free motions, scaled to a unit diagonal and divided
    /// by the highest one.
    pub lowest: f64,
}

fn complex([x, y]: [f64; 2]) -> c64 {
    c64::new(x, y)
}

/// The deformation (a, s, theta) of a hinge with its first and second derivatives in the six
/// motions of its panels.
type Deformation = ([f64; 3], [[f64; 6]; 3], [[[f64; 6]; 6]; 3]);

fn deformation(sheet: &Sheet, hinge: usize, configuration: &[[f64; 3]]) -> Deformation {
    const I: c64 = c64::new(0.0, 1.0);
    let hinge = &sheet.hinges[hinge];
    let (a, b) = (hinge.site.a.0, hinge.site.b.0);
    let place = |panel: usize| {
        let ([x, y, phi], reference) =
            (configuration[panel], complex(sheet.panels[panel].reference));
        let arm = c64::cis(phi) * (complex(hinge.attachment) - reference);
        (reference + c64::new(x, y) + arm, arm, phi)
    };
    let ((x_a, arm_a, phi_a), (x_b, arm_b, phi_b)) = (place(a), place(b));
    let gap = x_b - x_a;
    let frame = complex(hinge.e_sec).conj() * c64::cis(-0.5 * (phi_a + phi_b));
    let one = c64::new(1.0, 0.0);
    let gap_rates = [-one, -I, -I * arm_a, one, I, I * arm_b];
    let frame_rates = [0.0, 0.0, -0.5, 0.0, 0.0, -0.5].map(|part| part * I * frame);
    let (mut first, mut second) = ([[0.0; 6]; 3], [[[0.0; 6]; 6]; 3]);
    for j in 0..6 {
        let rate = frame * gap_rates[j] + frame_rates[j] * gap;
        (first[0][j], first[1][j]) = (rate.re, rate.im);
        for k in 0..6 {
            let turning = [j, k].iter().all(|motion| motion % 3 == 2);
            let mut rate = frame_rates[j] * gap_rates[k] + frame_rates[k] * gap_rates[j];
            if turning {
                rate -= 0.25 * frame * gap;
            }
            rate += match (j, k) {
                (2, 2) => frame * arm_a,
                (5, 5) => -frame * arm_b,
                _ => c64::new(0.0, 0.0),
            };
            (second[0][j][k], second[1][j][k]) = (rate.re, rate.im);
        }
    }
    (first[2][2], first[2][5]) = (-1.0, 1.0);
    let moved = frame * gap;
    ([moved.re, moved.im, phi_b - phi_a], first, second)
}

impl DenseCheck {
    /// The state of a load step; `before` is the largest force of those before (N).
    pub(crate) fn new(
        drawn: &Drawn,
        problem: &DesignProblem,
        sheet: &Sheet,
        step: &LoadStep,
        before: f64,
    ) -> Self {
        let panels = sheet.panels.len();
        let hinges = 0..sheet.hinges.len();
        let motions: Vec<Deformation> =
            hinges.map(|h| deformation(sheet, h, &step.configuration)).collect();
        let deformations: Vec<HingeDeformation> =
            motions.iter().map(|(value, ..)| (*value).into()).collect();
        let mechanics = problem.model.mechanics().unwrap();
        let law = mechanics.law.prepare(&sheet.designs());
        let law_resolution = law.resolution();
        let mut energies = law.energies(&deformations, Order::Tangent);
        if let Some(contact) = &mechanics.contact {
            contact.add(&mut energies, &deformations);
        }

        let mut forces = vec![0.0; 3 * panels];
        let mut stiffness = Mat::<f64>::zeros(3 * panels, 3 * panels);
        let extent = extent(sheet, step);
        let (mut largest, mut rounding) = (before, 0.0);
        let size = (sheet.outline.area() / panels as f64).sqrt();
        let as_force = |d: usize, force: f64| if d % 3 == 2 { force / size } else { force }.abs();
        for (hinge, ((_, first, second), energy)) in
            std::iter::zip(&sheet.hinges, std::iter::zip(&motions, &energies))
        {
            let dofs: [usize; 6] =
                std::array::from_fn(|d| 3 * [hinge.site.a.0, hinge.site.b.0][d / 3] + d % 3);
            let f = energy.forces;
            largest = largest.max(f[0].hypot(f[1])).max(f[2].abs() / size);
            let resolved = law_resolution * hinge.w_lig + extent * f64::EPSILON;
            for (c, row) in energy.tangent.iter().enumerate() {
                let force = resolved * row[0].abs().max(row[1].abs())
                    + (law_resolution + f64::EPSILON) * row[2].abs();
                rounding += if c == 2 { force / size } else { force };
            }
            for j in 0..6 {
                forces[dofs[j]] += (0..3).map(|c| f[c] * first[c][j]).sum::<f64>();
                for k in 0..6 {
                    let mut sum: f64 = (0..3).map(|c| f[c] * second[c][j][k]).sum();
                    for (row, tangent) in std::iter::zip(first, energy.tangent) {
                        sum += row[j] * (0..3).map(|d| tangent[d] * first[d][k]).sum::<f64>();
                    }
                    stiffness[(dofs[j], dofs[k])] += sum;
                }
            }
        }
        for (k, panel) in sheet.panels.iter().enumerate() {
            let weight = step.weight * panel.area * complex(drawn.weight);
            let arm = c64::cis(step.configuration[k][2])
                * (complex(panel.centroid) - complex(panel.reference));
            forces[3 * k] -= weight.re;
            forces[3 * k + 1] -= weight.im;
            forces[3 * k + 2] -= arm.re * weight.im - arm.im * weight.re;
            stiffness[(3 * k + 2, 3 * k + 2)] += arm.re * weight.re + arm.im * weight.im;
            largest = largest.max(weight.re.hypot(weight.im));
        }
        let loads = loads(drawn, panels);
        for (d, load) in loads.iter().enumerate() {
            forces[d] -= step.load_factor * load;
            largest = largest.max(as_force(d, step.load_factor * load));
        }

        let free = free(drawn, panels);
        let unbalanced = free.iter().map(|&d| as_force(d, forces[d]));
        let unbalanced = unbalanced.fold(0.0, f64::max);
        let along = || free.iter().map(|&d| loads[d]).collect::<Vec<f64>>();
        let held = drawn.stroke.map(|_| along());
        let relative = |force: f64| if force == 0.0 { 0.0 } else { force / largest };
        Self {
            force: largest,
            residual: relative(unbalanced),
            rounding: relative(rounding),
            lowest: lowest(&stiffness, &free, held),
        }
    }
}

/// The loads on all motions at full load.
fn loads(drawn: &Drawn, panels: usize) -> Vec<f64> {
    let mut loads = vec![0.0; 3 * panels];
    for load in &drawn.loads {
        loads[3 * load.panel + load.dof.index()] += load.value;
    }
    loads
}

/// The motions without a support.
fn free(drawn: &Drawn, panels: usize) -> Vec<usize> {
    let held = |d: &usize| drawn.supports.iter().any(|s| 3 * s.panel + s.dof.index() == *d);
    (0..3 * panels).filter(|d| !held(d)).collect()
}

/// The largest coordinate of the flat and the deployed sheet (mm).
fn extent(sheet: &Sheet, step: &LoadStep) -> f64 {
    let flat = sheet.outline.corners.as_flattened().iter().copied();
    let moved = step.configuration.iter().flat_map(|[x, y, _]| [*x, *y]);
    flat.chain(moved).map(f64::abs).fold(0.0, f64::max)
}

/// The lowest eigenvalue of a tangent over the free motions, orthogonal to the stroke if that is
/// held.
fn lowest(stiffness: &Mat<f64>, free: &[usize], stroke: Option<Vec<f64>>) -> f64 {
    let n = free.len();
    let diagonal = free.iter().map(|&d| stiffness[(d, d)].abs());
    let scale = diagonal.map(|k: f64| k.max(f64::MIN_POSITIVE).sqrt().recip());
    let scale: Vec<f64> = scale.collect();
    let mut scaled = Mat::from_fn(n, n, |i, j| scale[i] * scale[j] * stiffness[(free[i], free[j])]);
    if let Some(stroke) = stroke {
        // A reflection turns the scaled stroke into the first coordinate, which is then left out.
        let mut normal: Vec<f64> = std::iter::zip(&stroke, &scale).map(|(c, s)| c * s).collect();
        let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        normal[0] += norm(&normal).copysign(normal[0]);
        let length = norm(&normal);
        let reflection = Mat::from_fn(n, n, |i, j| {
            f64::from(i == j) - 2.0 * normal[i] * normal[j] / (length * length)
        });
        let reflected = &reflection * &scaled * &reflection;
        scaled = Mat::from_fn(n - 1, n - 1, |i, j| reflected[(i + 1, j + 1)]);
    }
    if scaled.nrows() == 0 {
        return 1.0;
    }
    let values = scaled.self_adjoint_eigenvalues(Side::Lower).unwrap();
    values[0] / values[values.len() - 1].abs().max(values[0].abs())
}
