//! Slices of the learned energy: W against the rotation, with the finite-element samples.

use crate::ui::charts::Slice;
use dataset::{Database, Part, Row};
use hinge::HingeDeformation;
use surrogate::{Order, Surrogate};

/// Maximum number of curves in the chart.
const MAX_CURVES: usize = 5;
/// Points of each curve.
const POINTS: usize = 61;

/// Rays of pure rotation, ordered from the narrowest ligament to the widest.
pub fn rotations(surrogate: &Surrogate, database: &Database) -> Vec<Slice> {
    let mut rays: Vec<&[Row]> = database
        .rows()
        .chunk_by(|left, right| left.job == right.job)
        .filter(|ray| {
            ray.iter()
                .all(|row| row.sample.a == 0.0 && row.sample.s == 0.0)
        })
        .collect();
    rays.sort_by(|left, right| left[0].design.w_lig.total_cmp(&right[0].design.w_lig));
    let count = rays.len().min(MAX_CURVES);
    let held_out = database.manifest().split.jobs(Part::Test);
    (0..count)
        .map(|k| rays[k * (rays.len() - 1) / (count - 1).max(1)])
        .map(|ray| slice(surrogate, ray, held_out.contains(&ray[0].job)))
        .collect()
}

fn slice(surrogate: &Surrogate, ray: &[Row], held_out: bool) -> Slice {
    let design = ray[0].design;
    let end = ray.iter().map(|row| row.sample.theta).fold(0.0, f64::max);
    let thetas: Vec<f64> = (0..POINTS)
        .map(|k| end * k as f64 / (POINTS - 1) as f64)
        .collect();
    let states: Vec<HingeDeformation> = thetas
        .iter()
        .map(|&theta| HingeDeformation::from([0.0, 0.0, theta]))
        .collect();
    let prepared = surrogate.prepare(&vec![design; POINTS]);
    let energies = surrogate.evaluate(&prepared, &states, Order::Value);
    let curve = thetas.iter().zip(&energies);
    Slice {
        title: format!(
            "w {:.1} mm, alpha {:.0} deg{}",
            design.w_lig,
            design.alpha.to_degrees(),
            if held_out { " (unseen)" } else { "" }
        ),
        curve: curve
            .map(|(theta, energy)| (theta.to_degrees(), energy.w))
            .collect(),
        points: ray
            .iter()
            .map(|row| (row.sample.theta.to_degrees(), row.sample.w))
            .collect(),
    }
}
