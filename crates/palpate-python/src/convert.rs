//! From Python's arguments to the core's types: the value, or one line that names the argument.

use glam::{DVec2, DVec3, dvec2};
use numpy::ndarray::{ArrayD, ArrayViewD, Axis};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayDyn, PyArrayMethods};
use palpate::{Error, plane, space};
use pyo3::PyTypeInfo;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyMapping, PyString};

use crate::dimension::{In, Motion, Vector};

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

/// Complains of an array of the wrong shape; `other` is the last of its lengths if the plane is mixed with space.
fn misshapen(
    argument: &str,
    value: &Bound<'_, PyAny>,
    shape: &str,
    array: &ArrayD<f64>,
    other: Option<usize>,
) -> PyErr {
    let problem = format!("must have shape {shape}, has {}", shape_text(array.shape()));
    let mixed = other.is_some_and(|other| array.shape().last() == Some(&other));
    let caution = if mixed { "don't mix the plane and space: " } else { "" };
    refuse(argument, &problem, value, &format!("{caution}give an array of shape {shape}"))
}

/// The number of coordinates of the other dimension.
const fn other<V: Vector>() -> usize {
    DVec2::DIMENSION + DVec3::DIMENSION - V::DIMENSION
}

/// A shape as Python writes it.
fn shape_text(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => format!("({})", shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// A point or direction, shape `(d,)`.
pub(crate) fn vector<V: Vector>(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<V> {
    let shape = format!("({},)", V::DIMENSION);
    let array = array(argument, value, &shape)?;
    match *array.shape() {
        [length] if length == V::DIMENSION => Ok(V::from_coordinates(&array.into_iter().collect::<Vec<_>>())),
        _ => Err(misshapen(argument, value, &shape, &array, Some(other::<V>()))),
    }
}

/// A point that says by its shape whether it is of the plane or of space.
pub(crate) fn any_vector(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<In<DVec2, DVec3>> {
    const SHAPE: &str = "(2,) or (3,)";
    let array = array(argument, value, SHAPE)?;
    match *array.shape() {
        [2] => vector(argument, value).map(In::Plane),
        [3] => vector(argument, value).map(In::Space),
        _ => Err(misshapen(argument, value, SHAPE, &array, None)),
    }
}

/// A direction, shape `(d,)`, of any length but zero; made unit.
pub(crate) fn direction<V: Vector>(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<V> {
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
        _ => Err(misshapen(argument, value, "(n,)", &array, None)),
    }
}

/// Numbers of one shape, row by row; `other` as for `misshapen`.
pub(crate) fn array_of(
    argument: &str,
    value: &Bound<'_, PyAny>,
    shape: [usize; 2],
    other: Option<usize>,
) -> PyResult<Vec<f64>> {
    let shown = &shape_text(&shape);
    let array = array(argument, value, shown)?;
    if array.shape() == shape {
        Ok(array.iter().copied().collect())
    } else {
        Err(misshapen(argument, value, shown, &array, other))
    }
}

/// A point that may be left out.
pub(crate) fn optional_vector<V: Vector>(
    argument: &str,
    value: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<V>> {
    value.map(|value| vector(argument, value)).transpose()
}

/// Points, shape `(n, d)`.
pub(crate) fn vectors<V: Vector>(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<V>> {
    let shape = format!("(n, {})", V::DIMENSION);
    let array = array(argument, value, &shape)?;
    match *array.shape() {
        [_, length] if length == V::DIMENSION => Ok(rows(&array)),
        _ => Err(misshapen(argument, value, &shape, &array, Some(other::<V>()))),
    }
}

/// The rows of an array of two dimensions.
fn rows<V: Vector>(array: &ArrayD<f64>) -> Vec<V> {
    array
        .axis_iter(Axis(0))
        .map(|row| V::from_coordinates(&row.iter().copied().collect::<Vec<_>>()))
        .collect()
}

/// Loops of points of space: one array of shape `(n, 3)`, or several of them.
pub(crate) fn loops(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<DVec3>>> {
    if array(argument, value, "(n, 3)").is_ok_and(|array| array.ndim() == 2) {
        return Ok(vec![vectors(argument, value)?]);
    }
    let members = members(argument, value, "loops", "give an (n, 3) array, or a list of them")?;
    members.iter().enumerate().map(|(k, member)| vectors(&format!("{argument}[{k}]"), member)).collect()
}

/// Triangles as numbers of vertices, shape `(m, 3)`.
pub(crate) fn triangles(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<[u32; 3]>> {
    const SHAPE: &str = "(m, 3)";
    let array = array(argument, value, SHAPE)?;
    let &[_, 3] = array.shape() else { return Err(misshapen(argument, value, SHAPE, &array, None)) };
    let triangle = |(k, row): (usize, ArrayViewD<'_, f64>)| {
        let complain = || {
            let (place, shown) = (format!("{argument}[{k}]"), format!("{row}"));
            raise(Error::new(place, "must be numbers of vertices", shown, "number them from 0"))
        };
        match std::array::from_fn(|j| vertex_number(row[j])) {
            [Some(a), Some(b), Some(c)] => Ok([a, b, c]),
            _ => Err(complain()),
        }
    };
    array.axis_iter(Axis(0)).enumerate().map(triangle).collect()
}

/// A whole number that was read as a float.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked to be in range")]
fn vertex_number(number: f64) -> Option<u32> {
    (number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number)).then_some(number as u32)
}

/// Segments of the plane, shape `(n, 2, 2)`.
pub(crate) fn segments(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<[DVec2; 2]>> {
    let array = array(argument, value, "(n, 2, 2)")?;
    match array.shape() {
        [_, 2, 2] => Ok(array
            .axis_iter(Axis(0))
            .map(|ends| [dvec2(ends[[0, 0]], ends[[0, 1]]), dvec2(ends[[1, 0]], ends[[1, 1]])])
            .collect()),
        _ => Err(misshapen(argument, value, "(n, 2, 2)", &array, Some(DVec3::DIMENSION))),
    }
}

/// A rigid motion, a homogeneous matrix, shape `(d + 1, d + 1)`.
pub(crate) fn pose<M: Motion>(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<M> {
    let side = M::Vector::DIMENSION + 1;
    let numbers = array_of(argument, value, [side, side], Some(other::<M::Vector>() + 1))?;
    M::from_numbers(argument, &numbers).map_err(raise)
}

/// A rigid motion that says by its shape whether it is of the plane or of space.
pub(crate) fn any_pose(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<In<plane::Pose, space::Pose>> {
    const SHAPE: &str = "(3, 3) or (4, 4)";
    let array = array(argument, value, SHAPE)?;
    match array.shape() {
        [3, 3] => pose(argument, value).map(In::Plane),
        [4, 4] => pose(argument, value).map(In::Space),
        _ => Err(misshapen(argument, value, SHAPE, &array, None)),
    }
}

/// A read-only array of shape `(d,)`.
pub(crate) fn vector_array<V: Vector>(py: Python<'_>, point: V) -> PyResult<Bound<'_, PyArray1<f64>>> {
    fixed(PyArray1::from_vec(py, point.coordinates()))
}

/// A read-only array of shape `(k, d)`.
pub(crate) fn vectors_array<'py, V: Vector>(
    py: Python<'py>,
    points: &[V],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    fixed(PyArray1::from_vec(py, flat(points)).reshape([points.len(), V::DIMENSION])?)
}

/// The coordinates of points, one after the other.
pub(crate) fn flat<V: Vector>(points: &[V]) -> Vec<f64> {
    points.iter().flat_map(|point| point.coordinates()).collect()
}

/// A read-only array of shape `(d + 1, d + 1)`.
pub(crate) fn pose_array<M: Motion>(py: Python<'_>, pose: M) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let side = M::Vector::DIMENSION + 1;
    fixed(PyArray1::from_vec(py, pose.numbers()).reshape([side, side])?)
}

/// A read-only array of shape `(n, d + 1, d + 1)`.
pub(crate) fn poses_array<'py, M: Motion>(
    py: Python<'py>,
    poses: &[M],
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let side = M::Vector::DIMENSION + 1;
    let flat: Vec<f64> = poses.iter().flat_map(|pose| pose.numbers()).collect();
    fixed(PyArray1::from_vec(py, flat).reshape([poses.len(), side, side])?)
}

/// The same array, read-only: writing to it would not change the object it came from.
pub(crate) fn fixed<T>(array: Bound<'_, T>) -> PyResult<Bound<'_, T>> {
    array.as_any().call_method1("setflags", (false,))?;
    Ok(array)
}

/// A vector as Python writes it.
pub(crate) fn tuple<V: Vector>(vector: V) -> String {
    let coordinates: Vec<String> = vector.coordinates().iter().map(|one| format!("{one:?}")).collect();
    format!("({})", coordinates.join(", "))
}

/// A vector from the numbers of a pickle.
pub(crate) fn restored<V: Vector>(coordinates: &[f64]) -> PyResult<V> {
    if coordinates.len() == V::DIMENSION { Ok(V::from_coordinates(coordinates)) } else { Err(damaged()) }
}

/// A pickle that no object made.
pub(crate) fn damaged() -> PyErr {
    PyValueError::new_err("the pickle is damaged")
}

/// What is known in the plane only was asked for in space.
pub(crate) fn plane_only(what: &str, given: &str, remedy: &str) -> PyErr {
    raise(Error::new(what, "works in the plane only", given, remedy))
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
