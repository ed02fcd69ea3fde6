//! The area of the symmetric difference of target and deployed outline, over the area of the
//! target. It is zero only where they coincide, wherever the corners are along the outline, whereas
//! the Chamfer distance also depends on their spacing.

use crate::{
    geometry::{
        polygon::{area, counter_clockwise},
        symmetric_difference::symmetric_difference,
    },
    objective::{
        shape::ShapeDistance,
        term::{Deployed, Term, TermGradient},
    },
};

/// The symmetric difference of target and deployed outline.
#[derive(Debug)]
pub struct SymmetricDifference {
    shape: ShapeDistance,
    /// The target, counter-clockwise (mm).
    target: Vec<[f64; 2]>,
}

impl SymmetricDifference {
    /// The term for the outline and the target of `shape`.
    pub fn new(shape: ShapeDistance) -> Self {
        let target = counter_clockwise(&shape.target);
        Self { shape, target }
    }
}

impl Term for SymmetricDifference {
    fn name(&self) -> &'static str {
        "symmetric_difference"
    }

    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64 {
        let placed = self.shape.placed(at.outline);
        let (difference, by_placed) = symmetric_difference(&placed, &self.target);
        let whole = area(&self.target);
        (self.shape).pullback(at, &by_placed, weight / whole, gradient);
        difference / whole
    }
}
