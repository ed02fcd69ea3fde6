//! NumPy arrays in and out. What cannot be read as real numbers without loss is an error that names
//! the argument.

use numpy::{
    Element, IntoPyArray, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods, ndarray::ArrayD,
};
use pyo3::{
    exceptions::{PyTypeError, PyValueError},
    prelude::*,
};
use serde::Serialize;
use std::convert::Infallible;

/// An argument of a function.
pub(crate) type Argument<'py> = Bound<'py, PyAny>;

/// Finite real numbers of an argument in the order of the indices, from any order in memory.
pub(crate) struct Numbers {
    /// The name of the argument.
    pub name: &'static str,
    /// The last index runs fastest.
    pub values: Vec<f64>,
    /// Empty for a single number.
    pub shape: Vec<usize>,
}

impl Numbers {
    /// The numbers of an array, of nested lists or a number. Integers and short floats are
    /// converted, as they are exact.
    pub(crate) fn read(argument: &Argument, name: &'static str) -> PyResult<Self> {
        let direct = argument.cast_exact::<PyArrayDyn<f64>>();
        let numbers = if let Some(array) = direct.ok().filter(|array| is_regular(array)) {
            copied(array, name)
        } else {
            copied(converted(argument, name)?.cast()?, name)
        };
        if let Some(position) = numbers.values.iter().position(|value| !value.is_finite()) {
            let (index, value) = (index(position, &numbers.shape), numbers.values[position]);
            return Err(PyValueError::new_err(format!(
                "`{name}`{index} = {value} is not a finite number"
            )));
        }
        Ok(numbers)
    }

    /// One value for each element of a shape.
    pub(crate) fn filled(self, shape: &[usize]) -> PyResult<Vec<f64>> {
        if self.shape.is_empty() {
            return Ok(vec![self.values[0]; shape.iter().product()]);
        }
        match self.shape == shape {
            true => Ok(self.values),
            false => Err(self.wrong_shape(&format!("a number or {}", tuple(shape)))),
        }
    }

    /// The error of an argument of another shape.
    pub(crate) fn wrong_shape(&self, expected: &str) -> PyErr {
        let (name, found) = (self.name, tuple(&self.shape));
        PyValueError::new_err(format!("`{name}` has the shape {found}, expected {expected}"))
    }
}

/// The numbers of an argument of a given shape.
pub(crate) fn shaped(
    argument: &Argument,
    name: &'static str,
    shape: &[usize],
) -> PyResult<Vec<f64>> {
    let numbers = Numbers::read(argument, name)?;
    match numbers.shape == shape {
        true => Ok(numbers.values),
        false => Err(numbers.wrong_shape(&tuple(shape))),
    }
}

/// A shape as Python prints it.
pub(crate) fn tuple(shape: &[usize]) -> String {
    match shape {
        [length] => format!("({length},)"),
        _ => format!("{shape:?}").replace('[', "(").replace(']', ")"),
    }
}

/// A new array.
pub(crate) struct Array<T = f64> {
    values: Vec<T>,
    shape: Vec<usize>,
}

/// The array of values; the lengths of its shape are given in parts.
pub(crate) fn array<T>(values: impl IntoIterator<Item = T>, shape: &[&[usize]]) -> Array<T> {
    Array { values: values.into_iter().collect(), shape: shape.concat() }
}

/// The one-dimensional array of values.
pub(crate) fn list(values: Vec<f64>) -> Array {
    Array { shape: vec![values.len()], values }
}

/// The array of `N` numbers for each panel, or each hinge.
pub(crate) fn rows<const N: usize>(rows: impl IntoIterator<Item = [f64; N]>) -> Array {
    let values: Vec<f64> = rows.into_iter().flatten().collect();
    Array { shape: vec![values.len() / N, N], values }
}

/// The corners of panels, an array of shape (panels, 4, 2).
pub(crate) fn quadrilaterals(corners: &[[[f64; 2]; 4]]) -> Array {
    array(corners.as_flattened().as_flattened().to_vec(), &[&[corners.len(), 4, 2]])
}

impl<'py, T: Element> IntoPyObject<'py> for Array<T> {
    type Target = PyArrayDyn<T>;
    type Output = Bound<'py, Self::Target>;
    type Error = Infallible;

    fn into_pyobject(self, py: Python<'py>) -> Result<Self::Output, Infallible> {
        let array = ArrayD::from_shape_vec(self.shape, self.values);
        Ok(array.expect("as many values as the shape has").into_pyarray(py))
    }
}

/// A value as the dicts, lists and numbers of its JSON.
pub(crate) struct Plain(String);

/// The value in Python.
pub(crate) fn plain(value: &impl Serialize) -> Plain {
    Plain(serde_json::to_string(value).expect("these are numbers and text"))
}

impl<'py> IntoPyObject<'py> for Plain {
    type Target = PyAny;
    type Output = Argument<'py>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        py.import("json")?.call_method1("loads", (self.0,))
    }
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
    Err(PyValueError::new_err(format!("`{name}` = {value} is not a finite number")))
}

fn copied(array: &Bound<PyArrayDyn<f64>>, name: &'static str) -> Numbers {
    let shape = array.shape().to_vec();
    let read = array.readonly();
    // A contiguous slice may be in the order of Fortran.
    let values = match read.as_slice() {
        Ok(values) if array.is_c_contiguous() => values.to_vec(),
        _ => read.as_array().iter().copied().collect(),
    };
    Numbers { name, values, shape }
}

/// A value as a NumPy array of float64, if that loses nothing.
fn converted<'py>(argument: &Argument<'py>, name: &str) -> PyResult<Argument<'py>> {
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

/// The index of a position, as Python writes it; empty for a single number.
fn index(position: usize, shape: &[usize]) -> String {
    let mut rest = position;
    let mut indices: Vec<String> = Vec::new();
    for length in shape.iter().rev() {
        indices.insert(0, (rest % length).to_string());
        rest /= length;
    }
    if indices.is_empty() { String::new() } else { format!("[{}]", indices.join(", ")) }
}
