//! From Python's arguments to the core's types: the value, or one line that names the argument.

use glam::{DVec2, dvec2};
use numpy::ndarray::{ArrayD, Axis};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayDyn, PyArrayMethods};
use palpate::Error;
use palpate::plane::Pose;
use pyo3::PyTypeInfo;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyMapping, PyString};

/// The longest value that is quoted in a message, in characters.
const SHOWN: usize = 80;

/// Bad input as Python sees it.
#[expect(clippy::needless_pass_by_value, reason = "passed to map_err")]
pub(crate) fn raise(error: Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// The same, for a value that only Python can show.
pub(crate) fn refuse(argument: &str, problem: &str, value: &Bound<'_, PyAny>, remedy: &str) -> PyErr {
    raise(Error::new(argument, problem, shown(value), remedy))
}

/// `repr(value)` on one line, cut where it gets long.
fn shown(value: &Bound<'_, PyAny>) -> String {
    let text = value.repr().map_or_else(|_| value.get_type().to_string(), |repr| repr.to_string());
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line,
    }
}

/// A real number. Bounds on it are the core's business.
pub(crate) fn number(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let read = if value.is_instance_of::<PyBool>() { None } else { value.extract::<f64>().ok() };
    read.ok_or_else(|| refuse(argument, "must be a number", value, "give a single int or float"))
}

/// A whole number, `least` or more.
pub(crate) fn whole(argument: &str, value: &Bound<'_, PyAny>, least: u64) -> PyResult<u64> {
    let read = if value.is_instance_of::<PyBool>() { None } else { value.extract::<u64>().ok() };
    read.filter(|&count| count >= least).ok_or_else(|| {
        refuse(argument, &format!("must be a whole number, {least} or more"), value, "give an int in range")
    })
}

/// A text.
pub(crate) fn text(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    value.extract().map_err(|_| refuse(argument, "must be a text", value, "give a str"))
}

/// The members of a list, tuple, array or other iterable that is not a text or a mapping.
pub(crate) fn members<'py>(
    argument: &str,
    value: &Bound<'py, PyAny>,
    what: &str,
    remedy: &str,
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let complain = || refuse(argument, &format!("must be a sequence of {what}"), value, remedy);
    if value.is_instance_of::<PyString>() || value.cast::<PyMapping>().is_ok() {
        return Err(complain());
    }
    value.try_iter().map_err(|_| complain())?.collect()
}

/// An array of finite numbers, whatever its shape.
fn array(argument: &str, value: &Bound<'_, PyAny>, shape: &str) -> PyResult<ArrayD<f64>> {
    let complain =
        |problem: &str| refuse(argument, problem, value, &format!("give an array of shape {shape}"));
    let read = value.py().import("numpy")?.call_method1("asarray", (value,));
    let read = read.map_err(|_| complain("must be an array of numbers"))?;
    let kind: char = read.getattr("dtype")?.getattr("kind")?.extract()?;
    if !"iuf".contains(kind) {
        return Err(complain("must be an array of numbers"));
    }
    let floats = read.call_method1("astype", ("float64",))?.cast_into::<PyArrayDyn<f64>>()?;
    let array = floats.to_owned_array();
    let infinite = || refuse(argument, "must be finite", value, "give finite numbers");
    if array.iter().all(|number| number.is_finite()) { Ok(array) } else { Err(infinite()) }
}

/// Complains of an array of the wrong shape.
fn misshapen(argument: &str, value: &Bound<'_, PyAny>, shape: &str, array: &ArrayD<f64>) -> PyErr {
    let problem = format!("must have shape {shape}, has {}", shape_text(array.shape()));
    let spatial = array.shape().last() == Some(&3) && shape.ends_with("2,)") | shape.ends_with("2)")
        || array.shape() == [4, 4];
    let remedy = if spatial {
        "only the plane so far: leave z out".to_owned()
    } else {
        format!("give an array of shape {shape}")
    };
    refuse(argument, &problem, value, &remedy)
}

/// A shape as Python writes it.
fn shape_text(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => format!("({})", shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// A point or direction of the plane, shape `(2,)`.
pub(crate) fn vector(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<DVec2> {
    let array = array(argument, value, "(2,)")?;
    match array.shape() {
        [2] => Ok(dvec2(array[[0]], array[[1]])),
        _ => Err(misshapen(argument, value, "(2,)", &array)),
    }
}

/// A direction of the plane, shape `(2,)`, of any length but zero; made unit.
pub(crate) fn direction(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<DVec2> {
    let nowhere = || refuse(argument, "must not be zero", value, "give a direction, of any length");
    palpate::plan::normalized(vector(argument, value)?).ok_or_else(nowhere)
}

/// A length, zero or more.
pub(crate) fn length(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let read = number(argument, value)?;
    let complain = || refuse(argument, "must be a finite number, zero or more", value, "give a length");
    (read.is_finite() && read >= 0.0).then_some(read).ok_or_else(complain)
}

/// Numbers in a row, shape `(n,)`.
pub(crate) fn numbers(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let array = array(argument, value, "(n,)")?;
    match array.shape() {
        [_] => Ok(array.iter().copied().collect()),
        _ => Err(misshapen(argument, value, "(n,)", &array)),
    }
}

/// Numbers of one shape, row by row.
pub(crate) fn array_of(
    argument: &str,
    value: &Bound<'_, PyAny>,
    shape: [usize; 2],
    shown: &str,
) -> PyResult<Vec<f64>> {
    let array = array(argument, value, shown)?;
    if array.shape() == shape {
        Ok(array.iter().copied().collect())
    } else {
        Err(misshapen(argument, value, shown, &array))
    }
}

/// A point that may be left out.
pub(crate) fn optional_vector(argument: &str, value: Option<&Bound<'_, PyAny>>) -> PyResult<Option<DVec2>> {
    value.map(|value| vector(argument, value)).transpose()
}

/// Points of the plane, shape `(n, 2)`.
pub(crate) fn vectors(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<DVec2>> {
    let array = array(argument, value, "(n, 2)")?;
    match array.shape() {
        [_, 2] => Ok(array.axis_iter(Axis(0)).map(|row| dvec2(row[0], row[1])).collect()),
        _ => Err(misshapen(argument, value, "(n, 2)", &array)),
    }
}

/// Segments of the plane, shape `(n, 2, 2)`.
pub(crate) fn segments(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<[DVec2; 2]>> {
    let array = array(argument, value, "(n, 2, 2)")?;
    match array.shape() {
        [_, 2, 2] => Ok(array
            .axis_iter(Axis(0))
            .map(|ends| [dvec2(ends[[0, 0]], ends[[0, 1]]), dvec2(ends[[1, 0]], ends[[1, 1]])])
            .collect()),
        _ => Err(misshapen(argument, value, "(n, 2, 2)", &array)),
    }
}

/// A rigid motion of the plane, shape `(3, 3)`, homogeneous.
pub(crate) fn pose(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Pose> {
    let array = array(argument, value, "(3, 3)")?;
    if array.shape() != [3, 3] {
        return Err(misshapen(argument, value, "(3, 3)", &array));
    }
    let rows = std::array::from_fn(|i| std::array::from_fn(|j| array[[i, j]]));
    Pose::from_rows(argument, rows).map_err(raise)
}

/// A read-only array of shape `(2,)`.
pub(crate) fn vector_array(py: Python<'_>, point: DVec2) -> PyResult<Bound<'_, PyArray1<f64>>> {
    fixed(PyArray1::from_slice(py, &point.to_array()))
}

/// A read-only array of shape `(k, 2)`.
pub(crate) fn vectors_array<'py>(py: Python<'py>, points: &[DVec2]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat: Vec<f64> = points.iter().flat_map(DVec2::to_array).collect();
    fixed(PyArray1::from_vec(py, flat).reshape([points.len(), 2])?)
}

/// A read-only array of shape `(3, 3)`.
pub(crate) fn pose_array(py: Python<'_>, pose: Pose) -> PyResult<Bound<'_, PyArray2<f64>>> {
    fixed(PyArray1::from_slice(py, pose.to_rows().as_flattened()).reshape([3, 3])?)
}

/// A read-only array of shape `(n, 3, 3)`.
pub(crate) fn poses_array<'py>(py: Python<'py>, poses: &[Pose]) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let flat: Vec<f64> = poses.iter().flat_map(|pose| pose.to_rows().into_iter().flatten()).collect();
    fixed(PyArray1::from_vec(py, flat).reshape([poses.len(), 3, 3])?)
}

/// The same array, read-only: writing to it would not change the object it came from.
pub(crate) fn fixed<T>(array: Bound<'_, T>) -> PyResult<Bound<'_, T>> {
    array.as_any().call_method1("setflags", (false,))?;
    Ok(array)
}

/// A vector as Python writes it.
pub(crate) fn tuple(vector: DVec2) -> String {
    format!("({:?}, {:?})", vector.x, vector.y)
}

/// The class method by which a pickle makes the object again.
pub(crate) fn restore<T: PyTypeInfo>(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    py.get_type::<T>().getattr("_restore")
}

/// How many decimals a place on something of this size is told to: six, and one for each tenth below a hundredth.
pub(crate) fn decimals(size: f64) -> usize {
    let tenfold = std::iter::successors(Some(size), |one| Some(one * 10.0));
    6 + tenfold.take_while(|&one| one > 0.0 && one < 0.01).count()
}

/// A number to so many decimals, without negative zeros.
pub(crate) fn decimal(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|one| one == '0' || one == '.') => zero.to_owned(),
        _ => text,
    }
}
