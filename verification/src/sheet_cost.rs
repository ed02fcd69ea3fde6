//! What a whole sheet costs, from its mesh.

use fe_driver::OutOfPlaneRestraint;
use mesher::SheetMesh;

/// Estimates from sheets of 13 000 and 51 000 unknowns on one core of a busy machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetCost {
    /// Unknown displacements.
    pub unknowns: usize,
    /// CPU time of a path without a snap (s).
    pub cpu_seconds: f64,
    /// Memory of the solver (MiB).
    pub memory_mib: f64,
}

/// Unknowns of the sheet from which the estimates are scaled, its CPU time (s) and memory (MiB)
/// with panels held flat.
const REFERENCE: [f64; 3] = [13_000.0, 34.0, 53.0];
/// The power of the number of unknowns with which the time grows.
const GROWTH: f64 = 1.4;
/// Time of a sheet that may leave its plane over the time of a sheet that is held flat.
const NOT_HELD: f64 = 3.5;

impl SheetCost {
    /// The cost of a meshed sheet.
    pub fn of(mesh: &SheetMesh, restraint: OutOfPlaneRestraint) -> Self {
        let unknowns = 3 * mesh.nodes.len();
        let [reference, seconds, memory] = REFERENCE;
        let ratio = unknowns as f64 / reference;
        let paths = match restraint {
            OutOfPlaneRestraint::HeldFlat => 1.0,
            OutOfPlaneRestraint::Table | OutOfPlaneRestraint::Nothing => NOT_HELD,
        };
        Self {
            unknowns,
            cpu_seconds: paths * seconds * ratio.powf(GROWTH),
            memory_mib: memory * ratio,
        }
    }
}
