//! The thesis's own pose and bounds.

use glam::DMat3;
use numpy::{PyArray1, PyArray2};
use palpate::{plane, space};
use pyo3::prelude::*;

use crate::convert::{plane_only, pose_array, vector, vector_array, vectors_array};
use crate::dimension::In;

#[doc = doc!("ThesisPose")]
#[pyclass(name = "ThesisPose", module = "palpate._core", frozen)]
pub(crate) struct PyThesisPose(pub(crate) In<plane::ThesisPose, space::ThesisPose>);

/// A rotation as Python has it: an angle in the plane, a matrix in space.
fn matrix(py: Python<'_>, rotation: DMat3) -> PyResult<Bound<'_, PyAny>> {
    let rows = [0, 1, 2].map(|k| rotation.row(k));
    Ok(vectors_array(py, &rows)?.into_any())
}

#[pymethods]
impl PyThesisPose {
    #[doc = doc!("ThesisPose.world_from_model")]
    #[getter]
    fn world_from_model<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        either!(&self.0, thesis => pose_array(py, thesis.world_from_model()))
    }

    #[doc = doc!("ThesisPose.first_rotation")]
    #[getter]
    fn first_rotation<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        match &self.0 {
            In::Plane(thesis) => Ok(Some(thesis.first_rotation.into_pyobject(py)?.into_any())),
            In::Space(thesis) => thesis.first_rotation.map(|rotation| matrix(py, rotation)).transpose(),
        }
    }

    #[doc = doc!("ThesisPose.rotation")]
    #[getter]
    fn rotation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.0 {
            In::Plane(thesis) => Ok(thesis.rotation.into_pyobject(py)?.into_any()),
            In::Space(thesis) => matrix(py, thesis.rotation),
        }
    }

    #[doc = doc!("ThesisPose.residual_rotation")]
    #[getter]
    fn residual_rotation(&self) -> f64 {
        either!(&self.0, thesis => thesis.residual_rotation)
    }

    #[doc = doc!("ThesisPose.rotation_error")]
    #[getter]
    fn rotation_error(&self) -> f64 {
        match &self.0 {
            In::Plane(thesis) => 0.5 * thesis.residual_rotation,
            In::Space(thesis) => thesis.rotation_error,
        }
    }

    #[doc = doc!("ThesisPose.translation")]
    #[getter]
    fn translation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        either!(&self.0, thesis => vector_array(py, thesis.translation))
    }

    #[doc = doc!("ThesisPose.translation_error")]
    #[getter]
    fn translation_error(&self) -> f64 {
        either!(&self.0, thesis => thesis.translation_error)
    }

    #[doc = doc!("ThesisPose.translation_region")]
    #[getter]
    fn translation_region<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        either!(&self.0, thesis => vectors_array(py, &thesis.translation_region))
    }

    #[doc = doc!("ThesisPose.excursion")]
    fn excursion(&self, point: &Bound<'_, PyAny>) -> PyResult<f64> {
        match &self.0 {
            In::Plane(thesis) => Ok(thesis.excursion(vector("point", point)?)),
            In::Space(_) => Err(plane_only(
                "excursion of a thesis_pose",
                "one in space",
                "ask for excursion of the poses",
            )),
        }
    }

    fn __repr__(&self) -> String {
        let turn = match &self.0 {
            In::Plane(thesis) => thesis.rotation,
            In::Space(thesis) => thesis.world_from_model().angle(),
        };
        let residual = self.residual_rotation();
        format!("<ThesisPose rotation {turn:.6} rad, residual {residual:.6} rad>")
    }
}
