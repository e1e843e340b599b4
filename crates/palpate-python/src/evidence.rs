//! Misses and the prior.

use numpy::{PyArray1, PyArray2};
use palpate::plane::Pose;
use palpate::{Miss, Prior};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::convert::{number, pose, pose_array, raise, restore, tuple, vector, vector_array};

type Any<'py> = Bound<'py, PyAny>;
type Pair = (f64, f64);

#[doc = doc!("Miss")]
#[pyclass(name = "Miss", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyMiss(pub(crate) Miss);

#[doc = doc!("Prior")]
#[pyclass(name = "Prior", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyPrior(pub(crate) Prior);

#[pymethods]
impl PyMiss {
    #[new]
    #[pyo3(signature = (start, end, *, tip_radius=None, path_error=None), text_signature = "(start, end, *, tip_radius=0.0, path_error=0.0)")]
    fn new(
        start: &Any<'_>,
        end: &Any<'_>,
        tip_radius: Option<&Any<'_>>,
        path_error: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        let [tip_radius, path_error] = [("tip_radius", tip_radius), ("path_error", path_error)]
            .map(|(name, length)| length.map_or(Ok(0.0), |length| number(name, length)));
        Miss::new(vector("start", start)?, vector("end", end)?, tip_radius?, path_error?)
            .map(Self)
            .map_err(raise)
    }

    #[doc = doc!("Miss.start")]
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        vector_array(py, self.0.start)
    }

    #[doc = doc!("Miss.end")]
    #[getter]
    fn end<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        vector_array(py, self.0.end)
    }

    #[doc = doc!("Miss.tip_radius")]
    #[getter]
    fn tip_radius(&self) -> f64 {
        self.0.tip_radius
    }

    #[doc = doc!("Miss.path_error")]
    #[getter]
    fn path_error(&self) -> f64 {
        self.0.path_error
    }

    fn __repr__(&self) -> String {
        let Miss { start, end, tip_radius, path_error } = self.0;
        let ends = format!("{}, {}", tuple(start), tuple(end));
        format!("Miss({ends}, tip_radius={tip_radius:?}, path_error={path_error:?})")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Any<'py>, (Pair, Pair, f64, f64))> {
        let Miss { start, end, tip_radius, path_error } = self.0;
        Ok((restore::<Self>(py)?, (start.into(), end.into(), tip_radius, path_error)))
    }

    /// Undoes `__reduce__`.
    #[classmethod]
    fn _restore(
        _class: &Bound<'_, PyType>,
        start: Pair,
        end: Pair,
        tip_radius: f64,
        path_error: f64,
    ) -> Self {
        Self(Miss { start: start.into(), end: end.into(), tip_radius, path_error })
    }
}

#[pymethods]
impl PyPrior {
    #[new]
    #[pyo3(signature = (world_from_model, *, translation, rotation))]
    fn new(world_from_model: &Any<'_>, translation: &Any<'_>, rotation: &Any<'_>) -> PyResult<Self> {
        let middle = pose("world_from_model", world_from_model)?;
        let [translation, rotation] = [number("translation", translation)?, number("rotation", rotation)?];
        Prior::new(middle, translation, rotation).map(Self).map_err(raise)
    }

    #[doc = doc!("Prior.world_from_model")]
    #[getter]
    fn world_from_model<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pose_array(py, self.0.world_from_model)
    }

    #[doc = doc!("Prior.translation")]
    #[getter]
    fn translation(&self) -> f64 {
        self.0.translation
    }

    #[doc = doc!("Prior.rotation")]
    #[getter]
    fn rotation(&self) -> f64 {
        self.0.rotation
    }

    fn __repr__(&self) -> String {
        let Prior { world_from_model, translation, rotation } = self.0;
        let rows = world_from_model.to_rows();
        format!("Prior({rows:?}, translation={translation:?}, rotation={rotation:?})")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Any<'py>, (Pair, Pair, f64, f64))> {
        let Prior { world_from_model: Pose { rotation: turn, translation: shift }, translation, rotation } =
            self.0;
        Ok((restore::<Self>(py)?, (turn.into(), shift.into(), translation, rotation)))
    }

    /// Undoes `__reduce__`.
    #[classmethod]
    fn _restore(
        _class: &Bound<'_, PyType>,
        turn: Pair,
        shift: Pair,
        translation: f64,
        rotation: f64,
    ) -> Self {
        let world_from_model = Pose { rotation: turn.into(), translation: shift.into() };
        Self(Prior { world_from_model, translation, rotation })
    }
}
