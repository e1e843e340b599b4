//! What a tip meets first.

use numpy::PyArray1;
use palpate::{FirstContact, Line};
use pyo3::prelude::*;

use crate::convert::vector_array;

#[doc = doc!("FirstContact")]
#[pyclass(name = "FirstContact", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyFirstContact {
    pub(crate) contact: FirstContact,
    pub(crate) line: Line,
}

#[pymethods]
impl PyFirstContact {
    #[doc = doc!("FirstContact.depth")]
    #[getter]
    fn depth(&self) -> f64 {
        self.contact.depth
    }

    #[doc = doc!("FirstContact.center")]
    #[getter]
    fn center<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        vector_array(py, self.line.at(self.contact.depth))
    }

    #[doc = doc!("FirstContact.normal")]
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        vector_array(py, self.contact.normal)
    }

    #[doc = doc!("FirstContact.feature")]
    #[getter]
    fn feature(&self) -> (&'static str, u32) {
        (self.contact.feature.kind(), self.contact.feature.number())
    }

    #[doc = doc!("FirstContact.touchable")]
    #[getter]
    fn touchable(&self) -> bool {
        self.contact.touchable
    }

    fn __repr__(&self) -> String {
        let (kind, number) = self.feature();
        format!("<FirstContact: {kind} {number} at depth {:.6}>", self.contact.depth)
    }
}
