//! Displacement control: the stroke of the loads is prescribed; the load factor is an unknown.
//!
//! The stroke c . q with c = f / F is the work of the full loads divided by the sum F of their
//! magnitudes: for one pulled panel, the displacement along the pull. An equilibrium minimises U at
//! given c . q, and zeta is the multiplier of that constraint, so the path can be followed past
//! limit points of the load. Linear systems have the border c,
//!
//! ```text
//! [ H   c ] [ x  ]   [ b ]          x = H^-1 b - mu y,   y = H^-1 c,
//! [ c'  0 ] [ mu ] = [ d ]          mu = (c . H^-1 b - d) / (c . y)
//! ```

use crate::equilibrium::tangent::{Factor, TangentPattern};
use crate::sheet::kinematics::Motion;
use std::iter::zip;
use support::vectors::dot;

/// The direction c of the loads in the free degrees of freedom.
#[derive(Clone, Debug)]
pub(crate) struct Stroke {
    direction: Vec<f64>,
    /// F
    size: f64,
    /// Whether F is the sum of the forces; otherwise there are only couples, and F is their sum.
    of_forces: bool,
}

impl Stroke {
    /// The stroke of the loads (F_x, F_y, M), given in `loads` with three entries per panel, in the
    /// free degrees of freedom; `None` without any load. If there are only couples, F is the sum of
    /// the couples and the stroke is an angle.
    pub(crate) fn new(loads: &[Motion], gathered: &[f64]) -> Option<Self> {
        magnitude(loads).map(|(size, of_forces)| Self {
            direction: gathered.iter().map(|f| f / size).collect(),
            size,
            of_forces,
        })
    }

    pub(crate) fn direction(&self) -> &[f64] {
        &self.direction
    }

    /// The stroke of a configuration, given by its free degrees of freedom (mm).
    pub(crate) fn of(&self, free: &[f64]) -> f64 {
        dot(&self.direction, free)
    }

    /// The gradient of the stroke of a configuration with respect to the loads.
    pub(crate) fn by_loads(&self, loads: &[Motion], configuration: &[Motion]) -> Vec<Motion> {
        let stroke = work(loads, configuration) / self.size;
        let by_load = |([x, y, m], q): (&Motion, &Motion)| {
            let force = x.hypot(*y);
            let by_size = if !self.of_forces {
                [0.0, 0.0, m.signum()]
            } else if force > 0.0 {
                [x / force, y / force, 0.0]
            } else {
                [0.0; 3]
            };
            std::array::from_fn(|d| (q[d] - stroke * by_size[d]) / self.size)
        };
        zip(loads, configuration).map(by_load).collect()
    }

    /// Whether the sum F is differentiable in each component of the load on a panel.
    pub(crate) fn smooth_in(&self, &[x, y, m]: &Motion) -> [bool; 3] {
        let pulled = x.hypot(y) > 0.0;
        if self.of_forces { [pulled, pulled, true] } else { [false, false, m != 0.0] }
    }

    /// The stroke of the adjoint of a function with the given derivative in the load factor.
    pub(crate) fn slack(&self, by_load_factor: f64) -> f64 {
        -by_load_factor / self.size
    }

    /// A motion with the given stroke, used without a better prediction.
    pub(crate) fn motion(&self, stroke: f64) -> Vec<f64> {
        let square = dot(&self.direction, &self.direction);
        self.direction.iter().map(|c| stroke * c / square).collect()
    }
}

/// Factors of the tangent, with the border under displacement control.
#[derive(Clone, Debug)]
pub(crate) struct HeldFactor {
    pub factor: Factor,
    /// Whether the factors belong to a shifted tangent.
    pub shifted: bool,
    border: Option<Border>,
}

#[derive(Clone, Debug)]
struct Border {
    /// c
    direction: Vec<f64>,
    /// y
    response: Vec<f64>,
    /// c . y
    compliance: f64,
}

impl HeldFactor {
    /// `None` if the stroke cannot be prescribed.
    pub(crate) fn new(
        pattern: &TangentPattern,
        factor: Factor,
        stroke: Option<&Stroke>,
    ) -> Option<Self> {
        let border = stroke.map(|stroke| {
            let mut response = stroke.direction.clone();
            pattern.solve(&factor, &mut response);
            Border {
                compliance: dot(&stroke.direction, &response),
                direction: stroke.direction.clone(),
                response,
            }
        });
        let regular = |border: &Border| border.compliance.is_finite() && border.compliance != 0.0;
        border.as_ref().is_none_or(regular).then_some(Self { factor, shifted: false, border })
    }

    /// Whether there is no direction of negative curvature, at constant stroke if that is
    /// prescribed. The border adds one negative pivot, or removes one if the force of the sheet
    /// decreases with the stroke.
    pub(crate) fn is_stable(&self) -> bool {
        let softening = (self.border.as_ref()).is_some_and(|border| border.compliance < 0.0);
        self.factor.negative_pivots <= usize::from(softening)
    }

    /// The x for the right-hand side `b` and d = 0.
    pub(crate) fn solve(&self, pattern: &TangentPattern, b: &[f64]) -> Vec<f64> {
        self.solve_bordered(pattern, b, 0.0).0
    }

    /// x and mu; mu is 0 under load control.
    pub(crate) fn solve_bordered(
        &self,
        pattern: &TangentPattern,
        b: &[f64],
        d: f64,
    ) -> (Vec<f64>, f64) {
        let mut x = b.to_vec();
        pattern.solve(&self.factor, &mut x);
        let Some(border) = &self.border else {
            return (x, 0.0);
        };
        let mu = (dot(&border.direction, &x) - d) / border.compliance;
        for (x, y) in zip(&mut x, &border.response) {
            *x -= mu * y;
        }
        (x, mu)
    }
}

/// The sum of the magnitudes of the translational components, or of the rotational ones if the
/// former are zero, and whether it is the former; `None` if all are zero.
pub fn magnitude(by_panel: &[Motion]) -> Option<(f64, bool)> {
    let along: f64 = by_panel.iter().map(|[x, y, _]| x.hypot(*y)).sum();
    let about: f64 = by_panel.iter().map(|[_, _, m]| m.abs()).sum();
    match (along > 0.0, about > 0.0) {
        (true, _) => Some((along, true)),
        (false, true) => Some((about, false)),
        (false, false) => None,
    }
}

/// The work of the forces (F_x, F_y, M) on panels in motions of them (N mm).
pub fn work(forces: &[Motion], motions: &[Motion]) -> f64 {
    dot(forces.as_flattened(), motions.as_flattened())
}
