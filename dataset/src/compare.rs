//! The same rays solved twice: what a database is worth, beside one of a finer mesh.
//!
//! Two jobs are the same ray if their designs and the directions of their ends are the same. They
//! are compared at the states of the first, between which the second is read linearly, as far as
//! both go.

use crate::database::Database;
use crate::rows::Row;
use hinge::HingeSample;
use std::collections::BTreeMap;

/// The quantities that are compared.
pub const COMPARED: [&str; 6] = ["W", "F_a", "F_s", "M_theta", "D", "D_peak"];

/// The values of [`COMPARED`] in a state.
fn values(x: &HingeSample) -> [f64; 6] {
    [x.w, x.f_a, x.f_s, x.m_theta, x.d, x.d_peak]
}

/// One ray solved twice.
#[derive(Clone, Debug)]
pub struct ComparedRay<'a> {
    /// The furthest row of the database that is judged.
    pub end: &'a Row,
    /// CPU time of the ray (s) in the database that is judged, and in the one it is judged by.
    pub cpu_s: [f64; 2],
    /// The states of the database that is judged.
    pub states: Vec<ComparedState>,
}

/// A state in both databases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComparedState {
    /// In the database that is judged, in the order of [`COMPARED`].
    pub value: [f64; 6],
    /// In the one it is judged by.
    pub reference: [f64; 6],
}

/// The rays that stand in both databases, in the order of their designs.
pub fn compare<'a>(judged: &'a Database, reference: &'a Database) -> Vec<ComparedRay<'a>> {
    let references = rays(reference.rows());
    let pairs = rays(judged.rows()).into_iter().filter_map(|(ray, rows)| {
        let reference = references.get(&ray)?;
        Some((rows, reference))
    });
    pairs
        .filter_map(|(rows, reference)| {
            let end = *rows.last()?;
            let states = rows.iter().filter_map(|row| {
                Some(ComparedState {
                    value: values(&row.sample),
                    reference: at(reference, row.sample.lambda)?,
                })
            });
            Some(ComparedRay {
                end,
                cpu_s: [end.cpu_s, reference.first()?.cpu_s],
                states: states.collect(),
            })
        })
        .collect()
}

/// Root mean square of the differences over that of the reference, quantity by quantity.
pub fn relative_rms<'a>(states: impl IntoIterator<Item = &'a ComparedState>) -> [f64; 6] {
    let (mut off, mut all) = ([0.0; 6], [0.0; 6]);
    for state in states {
        for i in 0..6 {
            off[i] += (state.value[i] - state.reference[i]).powi(2);
            all[i] += state.reference[i].powi(2);
        }
    }
    std::array::from_fn(|i| (off[i] / f64::max(all[i], f64::MIN_POSITIVE)).sqrt())
}

/// Design and end, in millionths of their units.
type Ray = [i64; 8];

/// Rows by ray, in order of lambda.
fn rays(rows: &[Row]) -> BTreeMap<Ray, Vec<&Row>> {
    let mut rays: BTreeMap<Ray, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        let (design, x) = (&row.design, &row.sample);
        let [a, s, theta] = [x.a, x.s, x.theta].map(|component| component / x.lambda);
        let ray = [
            design.w_lig,
            design.alpha,
            design.fillet_ratio,
            design.kerf,
            design.r_win,
            a,
            s,
            theta,
        ];
        let ray = ray.map(|number| (1e6 * number).round() as i64);
        rays.entry(ray).or_default().push(row);
    }
    for rows in rays.values_mut() {
        rows.sort_by(|x, y| x.sample.lambda.total_cmp(&y.sample.lambda));
    }
    rays
}

/// The values at `lambda`, linear between rows and from the undeformed state to the first; none
/// past the last.
fn at(rows: &[&Row], lambda: f64) -> Option<[f64; 6]> {
    let after = rows.partition_point(|row| row.sample.lambda < lambda);
    let next = &rows.get(after)?.sample;
    let start = HingeSample::default();
    let before = after.checked_sub(1).map_or(&start, |i| &rows[i].sample);
    let share = (lambda - before.lambda) / (next.lambda - before.lambda);
    let (x, y) = (values(before), values(next));
    Some(std::array::from_fn(|i| x[i] + share * (y[i] - x[i])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gates::Gates;
    use crate::rows::tests::rows;
    use crate::split::SplitPlan;

    fn database(rows: Vec<Row>) -> Database {
        Database::collect(rows, &Gates::default(), &SplitPlan::default()).unwrap()
    }

    #[test]
    fn rays_three_percent_apart_differ_by_three_percent() {
        let stiff = rows(6).into_iter().map(|row| {
            let x = row.sample;
            let (w, w_work) = (1.03 * x.w, 1.03 * x.w_work);
            let (f_a, f_s, m_theta) = (1.03 * x.f_a, 1.03 * x.f_s, 1.03 * x.m_theta);
            let (d, d_peak) = (1.03 * x.d, 1.03 * x.d_peak);
            let sample = HingeSample {
                w,
                w_work,
                f_a,
                f_s,
                m_theta,
                d,
                d_peak,
                ..x
            };
            Row {
                sample,
                job: format!("stiff-{}", row.job),
                ..row
            }
        });
        let (judged, reference) = (database(stiff.collect()), database(rows(6)));
        let rays = compare(&judged, &reference);
        assert_eq!(rays.len(), 6);
        assert!(rays.iter().all(|ray| !ray.states.is_empty()));
        for difference in relative_rms(rays.iter().flat_map(|ray| &ray.states)) {
            assert!((difference - 0.03).abs() < 1e-12, "{difference}");
        }
        // Only what both hold is compared.
        let fewer = database(rows(4));
        assert_eq!(compare(&judged, &fewer).len(), 4);
    }

    #[test]
    fn states_are_read_between_rows_and_not_past_the_end() {
        let rows = rows(1);
        let rows: Vec<_> = rows.iter().collect();
        let first = rows[0].sample;
        let half = at(&rows, 0.5 * first.lambda).unwrap();
        assert!((half[0] - 0.5 * first.w).abs() < 1e-12);
        let last = rows.last().unwrap().sample;
        assert_eq!(at(&rows, last.lambda), Some(values(&last)));
        assert_eq!(at(&rows, last.lambda + 1e-9), None);
    }
}
