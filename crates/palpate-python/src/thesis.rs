//! The thesis's own pose and bounds.

use numpy::{PyArray1, PyArray2};
use palpate::plane::ThesisPose;
use pyo3::prelude::*;

use crate::convert::{pose_array, vector, vector_array, vectors_array};

/// The thesis's nominal pose of an interpretation, and its bounds on the pose's error.
#[pyclass(name = "ThesisPose", module = "palpate._core", frozen)]
pub(crate) struct PyThesisPose(pub(crate) ThesisPose);

#[pymethods]
impl PyThesisPose {
    #[getter]
    fn world_from_model<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pose_array(py, self.0.world_from_model())
    }

    #[getter]
    fn first_rotation(&self) -> f64 {
        self.0.first_rotation
    }

    #[getter]
    fn rotation(&self) -> f64 {
        self.0.rotation
    }

    #[getter]
    fn residual_rotation(&self) -> f64 {
        self.0.residual_rotation
    }

    #[getter]
    fn translation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        vector_array(py, self.0.translation)
    }

    #[getter]
    fn translation_error(&self) -> f64 {
        self.0.translation_error
    }

    #[getter]
    fn translation_region<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors_array(py, &self.0.translation_region)
    }

    fn excursion(&self, point: &Bound<'_, PyAny>) -> PyResult<f64> {
        Ok(self.0.excursion(vector("point", point)?))
    }

    fn __repr__(&self) -> String {
        let (rotation, residual) = (self.0.rotation, self.0.residual_rotation);
        format!("<ThesisPose rotation {rotation:.6} rad, residual {residual:.6} rad>")
    }
}
