//! The Python package `kirigami`: conversions and handles over the crates `surrogate` and `design`,
//! no physics.
//!
//! | file | contents |
//! |---|---|
//! | `arrays` | NumPy arrays in and out |
//! | `errors` | errors as exceptions, with the words of the command line |
//! | `hinges` | the learned hinge energy |
//! | `flat_sheet` | pattern and flat sheet |
//! | `deployment` | deployed sheets: a path, or the state at full load |
//! | `problem` | a prepared design problem |
//! | `waiting` | Ctrl-C during long calls |
//!
//! Calls that evaluate hinges, solve or search release the GIL meanwhile.

#![cfg_attr(not(test), warn(unreachable_pub))]

mod arrays;
mod deployment;
mod errors;
mod flat_sheet;
mod hinges;
mod problem;
mod scene_keys;
mod waiting;
mod warm;

use pyo3::prelude::*;

#[pymodule]
mod _kirigami {
    #[pymodule_export]
    use crate::deployment::{Deployment, State};
    #[pymodule_export]
    use crate::errors::{
        InvalidDesign, InvalidScene, KirigamiError, NoEquilibrium, SingularTangent, WeightsError,
    };
    #[pymodule_export]
    use crate::flat_sheet::{Pattern, Sheet};
    #[pymodule_export]
    use crate::hinges::{HingeStates, Hinges, Surrogate};
    #[pymodule_export]
    use crate::problem::Problem;
}
