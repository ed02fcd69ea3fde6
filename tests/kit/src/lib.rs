//! What the tests of several crates share: derivatives, running processes, a CalculiX that is a
//! script.

pub mod derivatives;
mod fake_ccx;
mod processes;

pub use fake_ccx::{failing_ccx, fake_ccx};
pub use processes::left_running;
