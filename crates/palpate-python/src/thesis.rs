//! The thesis's own pose and bounds.

use numpy::{PyArray1, PyArray2};
use palpate::plane::ThesisPose;
use pyo3::prelude::*;

use crate::convert::{pose_array, vector, vector_array, vectors_array};

#[doc = doc!("ThesisPose")]
#[pyclass(name = "ThesisPose", module = "palpate._core", frozen)]
pub(crate) struct PyThesisPose(pub(crate) ThesisPose);

#[pymethods]
impl PyThesisPose {
    #[doc = doc!("ThesisPose.world_from_model")]
    #[getter]
    fn world_from_model<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pose_array(py, self.0.world_from_model())
    }

    #[doc = doc!("ThesisPose.first_rotation")]
    #[getter]
    fn first_rotation(&self) -> f64 {
        self.0.first_rotation
    }

    #[doc = doc!("ThesisPose.rotation")]
    #[getter]
    fn rotation(&self) -> f64 {
        self.0.rotation
    }

    #[doc = doc!("ThesisPose.residual_rotation")]
    #[getter]
    fn residual_rotation(&self) -> f64 {
        self.0.residual_rotation
    }

    #[doc = doc!("ThesisPose.translation")]
    #[getter]
    fn translation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        vector_array(py, self.0.translation)
    }

    #[doc = doc!("ThesisPose.translation_error")]
    #[getter]
    fn translation_error(&self) -> f64 {
        self.0.translation_error
    }

    #[doc = doc!("ThesisPose.translation_region")]
    #[getter]
    fn translation_region<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors_array(py, &self.0.translation_region)
    }

    #[doc = doc!("ThesisPose.excursion")]
    fn excursion(&self, point: &Bound<'_, PyAny>) -> PyResult<f64> {
        Ok(self.0.excursion(vector("point", point)?))
    }

    fn __repr__(&self) -> String {
        let (rotation, residual) = (self.0.rotation, self.0.residual_rotation);
        format!("<ThesisPose rotation {rotation:.6} rad, residual {residual:.6} rad>")
    }
}
