//! Vectors in the plane.

pub(crate) fn minus(p: [f64; 2], q: [f64; 2]) -> [f64; 2] {
    [p[0] - q[0], p[1] - q[1]]
}

pub(crate) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(crate) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The unit vector from `p` to `q`.
pub(crate) fn unit(p: [f64; 2], q: [f64; 2]) -> [f64; 2] {
    let [x, y] = minus(q, p);
    [x / x.hypot(y), y / x.hypot(y)]
}
