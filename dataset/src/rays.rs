//! What makes two jobs the same ray.

use crate::rows::Row;

/// Design and end of a ray, in millionths of their units.
pub(crate) type RayKey = [i64; 8];

/// The ray to a row, or straight on beyond it.
pub(crate) fn ray_key(row: &Row) -> RayKey {
    let (design, x) = (&row.design, &row.sample);
    let [a, s, theta] = [x.a, x.s, x.theta].map(|component| component / x.lambda);
    let ray =
        [design.w_lig, design.alpha, design.fillet_ratio, design.kerf, design.r_win, a, s, theta];
    ray.map(|number| (1e6 * number).round() as i64)
}
