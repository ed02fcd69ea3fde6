//! Points and vectors of the plane as complex numbers: a rotation by phi is a product with e^(i
//! phi), the scalar product is Re(conj(a) b), the vector product Im(conj(a) b).

use faer::c64;
use support::Point;

/// The imaginary unit: a quarter turn counter-clockwise.
pub const I: c64 = c64::new(0.0, 1.0);

/// The complex number x + iy of a point.
pub fn complex([x, y]: Point) -> c64 {
    c64::new(x, y)
}

/// The point (x, y) of the complex number x + iy.
pub fn point(z: c64) -> Point {
    [z.re, z.im]
}

/// e^(i phi).
pub fn turn(phi: f64) -> c64 {
    c64::cis(phi)
}

/// e^(i phi) - 1 without cancellation at small phi.
pub fn turn_less_one(phi: f64) -> c64 {
    let (sin, cos) = (0.5 * phi).sin_cos();
    2.0 * sin * c64::new(-sin, cos)
}

/// The scalar product of two vectors, Re(conj(a) b).
pub fn dot(a: c64, b: c64) -> f64 {
    a.re * b.re + a.im * b.im
}

/// The vector product of two vectors, Im(conj(a) b).
pub fn cross(a: c64, b: c64) -> f64 {
    a.re * b.im - a.im * b.re
}
