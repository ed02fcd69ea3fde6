//! NumPy arrays in and out. What cannot be read as real numbers without loss is an error that names
//! the argument.

use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods, ndarray::ArrayD};
use pyo3::{
    exceptions::{PyTypeError, PyValueError},
    prelude::*,
};
use serde::Serialize;

/// An array of float64.
pub(crate) type Doubles<'py> = Bound<'py, PyArrayDyn<f64>>;

/// Finite real numbers in the order of the indices, from any order in memory.
pub(crate) struct Numbers {
    /// The last index runs fastest.
    pub values: Vec<f64>,
    /// Empty for a single number.
    pub shape: Vec<usize>,
}

impl Numbers {
    /// A single number.
    pub fn single(value: f64) -> Self {
        Self { values: vec![value], shape: Vec::new() }
    }

    /// One value for each of the `count` elements of a shape.
    pub fn filled(self, name: &str, shape: &[usize], count: usize) -> PyResult<Vec<f64>> {
        if self.shape.is_empty() {
            return Ok(vec![self.values[0]; count]);
        }
        if self.shape != shape {
            let expected = format!("a number or {}", tuple(shape));
            return Err(wrong_shape(name, &self.shape, &expected));
        }
        Ok(self.values)
    }
}

/// The numbers of an argument: an array, nested lists or a number. Integers and short floats are
/// converted, as they are exact.
pub(crate) fn numbers(argument: &Bound<PyAny>, name: &str) -> PyResult<Numbers> {
    let direct = argument.cast_exact::<PyArrayDyn<f64>>();
    let numbers = if let Some(array) = direct.ok().filter(|array| is_regular(array)) {
        copied(array)
    } else {
        copied(converted(argument, name)?.cast()?)
    };
    if let Some(place) = numbers.values.iter().position(|value| !value.is_finite()) {
        let value = numbers.values[place];
        return Err(PyValueError::new_err(format!(
            "`{name}`{} = {value} is not a finite number",
            index(place, &numbers.shape)
        )));
    }
    Ok(numbers)
}

/// The numbers of an argument of a given shape, in which `None` is any length; `expected` is the
/// shape in words.
pub(crate) fn shaped(
    argument: &Bound<PyAny>,
    name: &str,
    shape: &[Option<usize>],
    expected: &str,
) -> PyResult<Numbers> {
    let numbers = numbers(argument, name)?;
    let fits = |(length, given): (&Option<usize>, &usize)| length.is_none_or(|n| n == *given);
    if numbers.shape.len() != shape.len() || !shape.iter().zip(&numbers.shape).all(fits) {
        return Err(wrong_shape(name, &numbers.shape, expected));
    }
    Ok(numbers)
}

/// The error of an argument of another shape.
pub(crate) fn wrong_shape(name: &str, found: &[usize], expected: &str) -> PyErr {
    PyValueError::new_err(format!("`{name}` has the shape {}, expected {expected}", tuple(found)))
}

/// A shape as Python prints it.
pub(crate) fn tuple(shape: &[usize]) -> String {
    match shape {
        [length] => format!("({length},)"),
        _ => format!("{shape:?}").replace('[', "(").replace(']', ")"),
    }
}

/// A new array.
pub(crate) fn array<'py>(py: Python<'py>, values: Vec<f64>, shape: &[usize]) -> Doubles<'py> {
    ArrayD::from_shape_vec(shape, values).expect("as many values as the shape has").into_pyarray(py)
}

/// A new array of truth values.
pub(crate) fn bools<'py>(
    py: Python<'py>,
    values: Vec<bool>,
    shape: &[usize],
) -> Bound<'py, PyArrayDyn<bool>> {
    ArrayD::from_shape_vec(shape, values).expect("as many values as the shape has").into_pyarray(py)
}

/// A new array of three numbers for each panel, or each hinge.
pub(crate) fn triples<'py>(py: Python<'py>, values: &[[f64; 3]]) -> Doubles<'py> {
    array(py, values.as_flattened().to_vec(), &[values.len(), 3])
}

/// A value as the dicts, lists and numbers of its JSON.
pub(crate) fn plain<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).expect("these are numbers and text");
    py.import("json")?.call_method1("loads", (text,))
}

/// The lengths of `shape` followed by others.
pub(crate) fn followed_by(shape: &[usize], by: &[usize]) -> Vec<usize> {
    [shape, by].concat()
}

/// Whether every element is at a multiple of its size from the others, as a field of a structured
/// array need not be.
fn is_regular(array: &Bound<PyArrayDyn<f64>>) -> bool {
    let size = size_of::<f64>() as isize;
    array.is_aligned() && array.strides().iter().all(|stride| stride % size == 0)
}

/// A number that must be finite.
pub(crate) fn finite(name: &str, value: f64) -> PyResult<f64> {
    if value.is_finite() {
        return Ok(value);
    }
    let message = format!("`{name}` = {value} is not a finite number");
    Err(PyValueError::new_err(message))
}

fn copied(array: &Bound<PyArrayDyn<f64>>) -> Numbers {
    let shape = array.shape().to_vec();
    let read = array.readonly();
    // A contiguous slice may be in the order of Fortran.
    let values = match read.as_slice() {
        Ok(values) if array.is_c_contiguous() => values.to_vec(),
        _ => read.as_array().iter().copied().collect(),
    };
    Numbers { values, shape }
}

/// A value as a NumPy array of float64, if that loses nothing.
fn converted<'py>(argument: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let numpy = argument.py().import("numpy")?;
    let wrong = |what: String| {
        PyTypeError::new_err(format!("`{name}` is {what}, expected real numbers (float64)"))
    };
    if argument.hasattr("mask")? {
        return Err(wrong("a masked array".into()));
    }
    let array = (numpy.call_method1("asarray", (argument,)))
        .map_err(|error| wrong(format!("no array ({error})")))?;
    let dtype = array.getattr("dtype")?;
    let kind: String = dtype.getattr("kind")?.extract()?;
    let exact = numpy.call_method1("can_cast", (&dtype, "float64", "safe"))?;
    if !("fiu".contains(&kind) && exact.extract()?) {
        return Err(wrong(format!("an array of {dtype}")));
    }
    array.call_method1("astype", ("float64",))
}

/// The index of a place, as Python writes it; empty for a single number.
fn index(place: usize, shape: &[usize]) -> String {
    let mut rest = place;
    let mut indices: Vec<String> = Vec::new();
    for length in shape.iter().rev() {
        indices.insert(0, (rest % length).to_string());
        rest /= length;
    }
    if indices.is_empty() { String::new() } else { format!("[{}]", indices.join(", ")) }
}
