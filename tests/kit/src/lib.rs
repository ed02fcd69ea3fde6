//! What the tests of several crates share: derivatives, training domains, running processes, a
//! CalculiX that is a script.
//!
//! ```
//! use testkit::derivatives::TaylorRemainders;
//!
//! let square = |x: &[f64]| Ok::<_, ()>(x[0] * x[0]);
//! let remainders = TaylorRemainders::new(square, &[3.0], &[6.0], &[1.0], 0.1, 5);
//! remainders.unwrap().assert_orders(1.95..2.05);
//! ```

pub mod derivatives;
mod domain_of_box;
mod fake_ccx;
mod processes;

pub use domain_of_box::domain_of_box;
pub use fake_ccx::{failing_ccx, fake_ccx};
pub use processes::left_running;

/// Values with a change of each.
pub fn changed<T>(mut values: Vec<T>, change: impl FnMut(&mut T)) -> Vec<T> {
    values.iter_mut().for_each(change);
    values
}
