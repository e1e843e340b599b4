//! What a tip meets first.

use glam::{DVec2, DVec3};
use numpy::PyArray1;
use palpate::{FirstContact, Line};
use pyo3::prelude::*;

use crate::convert::vector_array;
use crate::dimension::In;

#[doc = doc!("FirstContact")]
#[pyclass(name = "FirstContact", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyFirstContact(pub(crate) In<Met<DVec2>, Met<DVec3>>);

/// What is met, and the line on which it is.
#[derive(PartialEq)]
pub(crate) struct Met<V> {
    pub(crate) contact: FirstContact<V>,
    pub(crate) line: Line<V>,
}

#[pymethods]
impl PyFirstContact {
    #[doc = doc!("FirstContact.depth")]
    #[getter]
    fn depth(&self) -> f64 {
        either!(&self.0, met => met.contact.depth)
    }

    #[doc = doc!("FirstContact.center")]
    #[getter]
    fn center<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        either!(&self.0, met => vector_array(py, met.line.at(met.contact.depth)))
    }

    #[doc = doc!("FirstContact.normal")]
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        either!(&self.0, met => vector_array(py, met.contact.normal))
    }

    #[doc = doc!("FirstContact.feature")]
    #[getter]
    fn feature(&self) -> (&'static str, u32) {
        let feature = either!(&self.0, met => met.contact.feature);
        (feature.kind(), feature.number())
    }

    #[doc = doc!("FirstContact.touchable")]
    #[getter]
    fn touchable(&self) -> bool {
        either!(&self.0, met => met.contact.touchable)
    }

    fn __repr__(&self) -> String {
        let (kind, number) = self.feature();
        format!("<FirstContact: {kind} {number} at depth {:.6}>", self.depth())
    }
}
