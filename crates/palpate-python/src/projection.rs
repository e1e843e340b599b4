//! The projection space of a generator.

use glam::DVec2;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use palpate::projection::{FaceOf, Overlap, Projection, Sheaf, projection_space_until};
use palpate::tree::Range;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::{fixed, members, number, numbers, pose_array, raise, refuse, vectors_array, whole};
use crate::dimension::In;
use crate::interrupt::interruptible;
use crate::options::{JUDGED, Options, PLACED};
use crate::path::PyPath;
use crate::plan::{planar, sensor};

type Any<'py> = Bound<'py, PyAny>;

#[doc = doc!("ProjectionSpace")]
#[pyclass(name = "ProjectionSpace", module = "palpate._core", frozen)]
pub(crate) struct PyProjectionSpace {
    projection: Projection,
    path: Option<Py<PyPath>>,
}

#[doc = doc!("Sheaf")]
#[pyclass(name = "Sheaf", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PySheaf(Sheaf);

#[doc = doc!("Overlap")]
#[pyclass(name = "Overlap", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyOverlap(Overlap);

#[doc = doc!("projection_space")]
#[pyfunction]
#[pyo3(
    signature = (hypotheses, sensor, generator=None, **options),
    text_signature = "(hypotheses, sensor, generator=None, *, stop='perfect', workspace=None, directions=None, time_limit=None, effort=None, seed=0, features=None, avoid_assigned=False, margin=0.001)"
)]
pub(crate) fn projection_space<'py>(
    py: Python<'py>,
    hypotheses: &Any<'py>,
    sensor: &Any<'py>,
    generator: Option<&Any<'py>>,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<PyProjectionSpace> {
    let known: &[&[&str]] = &[JUDGED, PLACED, &["stop", "time_limit", "effort"]];
    let options = Options::read("projection_space", options, known)?;
    let (hypotheses, sensor) = (planar("projection_space", hypotheses)?, self::sensor(sensor)?);
    let generator = generator.map(face_of).transpose()?;
    let (settings, deadline) = (&options.settings, options.deadline());
    let projection = interruptible(py, |halt| {
        projection_space_until(&hypotheses, &sensor, generator, settings, &|| deadline.late(halt))
    })?;
    let projection = projection.map_err(raise)?;
    let path = projection.path.as_ref();
    let path = path.map(|found| PyPath::new(In::Plane(found.path.clone()), sensor.tip_radius));
    Ok(PyProjectionSpace { projection, path: path.map(|path| Py::new(py, path)).transpose()? })
}

fn face_of(value: &Any<'_>) -> PyResult<FaceOf> {
    let remedy = "give (hypothesis, face)";
    let parts = members("generator", value, "a hypothesis' and a face's number", remedy)?;
    let [hypothesis, face] = parts.as_slice() else {
        return Err(refuse("generator", "must be a hypothesis' and a face's number", value, remedy));
    };
    let read = |argument: &str, part: &Any<'_>| whole(argument, part, 0).map(|number| number as usize);
    Ok(FaceOf { hypothesis: read("generator[0]", hypothesis)?, face: read("generator[1]", face)? })
}

/// As rows of low and high; NaN where there is nothing.
fn rows<'py>(
    py: Python<'py>,
    slopes: &Any<'py>,
    range: impl Fn(f64) -> Range,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let row = |slope: f64| {
        let Range { low, high } = range(slope);
        if low <= high { DVec2::new(low, high) } else { DVec2::NAN }
    };
    let rows: Vec<DVec2> = numbers("slopes", slopes)?.into_iter().map(row).collect();
    vectors_array(py, &rows)
}

#[pymethods]
impl PyProjectionSpace {
    #[doc = doc!("ProjectionSpace.generator")]
    #[getter]
    fn generator(&self) -> (usize, usize) {
        let sheaf = self.projection.space.generator();
        (sheaf.hypothesis, sheaf.face)
    }

    #[doc = doc!("ProjectionSpace.world_from_generator")]
    #[getter]
    fn world_from_generator<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pose_array(py, self.projection.space.world_from_generator)
    }

    #[doc = doc!("ProjectionSpace.max_slope")]
    #[getter]
    fn max_slope(&self) -> f64 {
        self.projection.space.max_slope
    }

    #[doc = doc!("ProjectionSpace.sheaves")]
    #[getter]
    fn sheaves(&self) -> Vec<PySheaf> {
        self.projection.space.sheaves.iter().cloned().map(PySheaf).collect()
    }

    #[doc = doc!("ProjectionSpace.critical_points")]
    #[getter]
    fn critical_points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = self.projection.space.critical_points();
        let points: Vec<DVec2> = points.iter().map(|one| DVec2::new(one.position, one.slope)).collect();
        vectors_array(py, &points)
    }

    #[doc = doc!("ProjectionSpace.critical_slopes")]
    #[getter]
    fn critical_slopes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        fixed(PyArray1::from_vec(py, self.projection.space.critical_slopes()))
    }

    #[doc = doc!("ProjectionSpace.overlaps")]
    fn overlaps(&self, slope: &Any<'_>) -> PyResult<Vec<PyOverlap>> {
        let slope = number("slope", slope)?;
        if !slope.is_finite() {
            let remedy = "give a finite number";
            return Err(raise(palpate::Error::new("slope", "must be finite", slope, remedy)));
        }
        Ok(self.projection.space.overlaps(slope).into_iter().flatten().map(PyOverlap).collect())
    }

    #[doc = doc!("ProjectionSpace.path")]
    #[getter]
    fn path(&self, py: Python<'_>) -> Option<Py<PyPath>> {
        self.path.as_ref().map(|path| path.clone_ref(py))
    }

    #[doc = doc!("ProjectionSpace.path_position")]
    #[getter]
    fn path_position(&self) -> Option<f64> {
        self.projection.path.as_ref().map(|path| path.position)
    }

    #[doc = doc!("ProjectionSpace.path_slope")]
    #[getter]
    fn path_slope(&self) -> Option<f64> {
        self.projection.path.as_ref().map(|path| path.slope)
    }

    fn __repr__(&self) -> String {
        let space = &self.projection.space;
        let Sheaf { hypothesis, face, .. } = space.generator();
        let slopes = space.critical_slopes().len();
        let candidates = space.sheaves.len() - 1;
        format!(
            "<ProjectionSpace of face {face} of hypothesis {hypothesis}: {candidates} candidates, {slopes} critical slopes>"
        )
    }
}

#[pymethods]
impl PySheaf {
    #[doc = doc!("Sheaf.hypothesis")]
    #[getter]
    fn hypothesis(&self) -> usize {
        self.0.hypothesis
    }

    #[doc = doc!("Sheaf.face")]
    #[getter]
    fn face(&self) -> usize {
        self.0.face
    }

    #[doc = doc!("Sheaf.sensed")]
    #[getter]
    fn sensed(&self) -> bool {
        self.0.sensed
    }

    #[doc = doc!("Sheaf.ends")]
    #[getter]
    fn ends<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors_array(py, &self.0.ends)
    }

    #[doc = doc!("Sheaf.extreme_ends")]
    #[getter]
    fn extreme_ends<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let flat = self.0.extreme_ends().into_iter().flatten().flat_map(|end| end.to_array());
        fixed(PyArray1::from_iter(py, flat).reshape([2, 2, 2])?)
    }

    #[doc = doc!("Sheaf.inner")]
    fn inner<'py>(&self, py: Python<'py>, slopes: &Any<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, slopes, |slope| self.0.inner(slope))
    }

    #[doc = doc!("Sheaf.outer")]
    fn outer<'py>(&self, py: Python<'py>, slopes: &Any<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, slopes, |slope| self.0.outer(slope))
    }

    #[doc = doc!("Sheaf.skids")]
    fn skids<'py>(&self, py: Python<'py>, slopes: &Any<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let slopes = numbers("slopes", slopes)?;
        fixed(PyArray1::from_iter(py, slopes.into_iter().map(|slope| self.0.skids(slope))))
    }

    fn __repr__(&self) -> String {
        let Sheaf { hypothesis, face, sensed, .. } = self.0;
        let told = if sensed { ", sensed" } else { "" };
        format!("<Sheaf of face {face} of hypothesis {hypothesis}{told}>")
    }
}

#[pymethods]
impl PyOverlap {
    #[doc = doc!("Overlap.positions")]
    #[getter]
    fn positions(&self) -> Option<(f64, f64)> {
        let Range { low, high } = self.0.positions;
        (low <= high).then_some((low, high))
    }

    #[doc = doc!("Overlap.sheaves")]
    #[getter]
    fn sheaves(&self) -> Vec<usize> {
        self.0.sheaves.clone()
    }

    fn __repr__(&self) -> String {
        let Range { low, high } = self.0.positions;
        format!("<Overlap of {} sheaves, from {low:.6} to {high:.6}>", self.0.sheaves.len())
    }
}
