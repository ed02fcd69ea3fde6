//! Errors as Python exceptions. The message is the message of the command line.

use design::DesignError;
use pyo3::{create_exception, exceptions::PyException, prelude::*};
use std::fmt::Display;
use support::Fault;

create_exception!(
    kirigami,
    KirigamiError,
    PyException,
    "What kirigami reports: the base of all its exceptions."
);
create_exception!(
    kirigami,
    WeightsError,
    KirigamiError,
    "Weights or their card cannot be read, or do not belong together."
);
create_exception!(
    kirigami,
    InvalidScene,
    KirigamiError,
    "A scene, or a file that it names, is not valid; the message names the file and the key."
);
create_exception!(
    kirigami,
    InvalidDesign,
    KirigamiError,
    "A design has no sheet: its cuts or its ligaments cannot exist."
);
create_exception!(kirigami, NoEquilibrium, KirigamiError, "No equilibrium was found at full load.");
create_exception!(
    kirigami,
    SingularTangent,
    KirigamiError,
    "The tangent of the equilibrium is singular, as at a limit point: the gradient does not exist."
);

/// The exception of weights that cannot be read.
pub(crate) fn weights(error: Fault) -> PyErr {
    WeightsError::new_err(error.to_string())
}

/// The exception of a scene, or of a file that it names.
pub(crate) fn scene(error: impl Display) -> PyErr {
    InvalidScene::new_err(error.to_string())
}

/// The same exception, with the element of a batch in its message.
pub(crate) fn of_element(element: usize, error: PyErr) -> PyErr {
    Python::attach(|py| {
        let message = format!("element {element}: {}", error.value(py));
        let kind = error.get_type(py).call1((message,));
        kind.map_or(error, PyErr::from_value)
    })
}

/// The exception of a design without a value or a gradient.
pub(crate) fn design(error: impl Into<DesignError>) -> PyErr {
    let error = error.into();
    let message = error.to_string();
    match error {
        DesignError::NoEquilibrium { .. } => NoEquilibrium::new_err(message),
        DesignError::SingularTangent(_) => SingularTangent::new_err(message),
        _ => InvalidDesign::new_err(message),
    }
}
