//! Contacts.

use glam::DVec2;
use numpy::PyArray1;
use palpate::{Contact, Error, Normal};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::convert::{number, optional_vector, raise, restore, tuple, vector, vector_array};

type Any<'py> = Bound<'py, PyAny>;
type Pair = (f64, f64);

#[doc = doc!("Contact")]
#[pyclass(name = "Contact", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyContact(pub(crate) Contact);

/// Centre, tip radius, position error, normal with its error, approach, start.
type ContactState = (Pair, f64, f64, Option<(Pair, f64)>, Option<Pair>, Option<Pair>);

/// The arguments that both constructors of a contact share.
struct Reading<'a, 'py> {
    position_error: &'a Any<'py>,
    normal: Option<&'a Any<'py>>,
    normal_error: Option<&'a Any<'py>>,
    approach: Option<&'a Any<'py>>,
    start: Option<&'a Any<'py>>,
}

impl Reading<'_, '_> {
    fn contact(&self, center: DVec2, tip_radius: f64) -> PyResult<PyContact> {
        let position_error = number("position_error", self.position_error)?;
        let mut contact = Contact::new(center, tip_radius, position_error).map_err(raise)?;
        contact.normal = self.normal()?;
        if let Some(toward) = optional_vector("approach", self.approach)? {
            contact = contact.with_approach(toward).map_err(raise)?;
        }
        if let Some(start) = optional_vector("start", self.start)? {
            contact = contact.with_start(start).map_err(raise)?;
        }
        Ok(PyContact(contact))
    }

    fn normal(&self) -> PyResult<Option<Normal>> {
        match (self.normal, self.normal_error) {
            (Some(toward), Some(error)) => {
                let normal = Normal::new(vector("normal", toward)?, number("normal_error", error)?);
                normal.map(Some).map_err(raise)
            }
            (Some(_), None) => Err(alone("normal_error", "normal", "give its bound in radians")),
            (None, Some(_)) => Err(alone("normal", "normal_error", "give the outward normal")),
            (None, None) => Ok(None),
        }
    }
}

/// One of two arguments that belong together was given alone.
fn alone(missing: &str, given: &str, remedy: &str) -> PyErr {
    let remedy = format!("{remedy}, or leave {given} out");
    raise(Error::new(missing, format!("must be given with {given}"), "None", remedy))
}

#[pymethods]
impl PyContact {
    #[new]
    #[pyo3(signature = (point, normal=None, *, position_error, normal_error=None, approach=None, start=None))]
    fn new(
        point: &Any<'_>,
        normal: Option<&Any<'_>>,
        position_error: &Any<'_>,
        normal_error: Option<&Any<'_>>,
        approach: Option<&Any<'_>>,
        start: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        Reading { position_error, normal, normal_error, approach, start }
            .contact(vector("point", point)?, 0.0)
    }

    #[doc = doc!("Contact.from_tip")]
    #[classmethod]
    #[pyo3(signature = (center, tip_radius, *, position_error, approach=None, normal=None, normal_error=None, start=None))]
    #[expect(clippy::too_many_arguments, reason = "Python's keyword arguments")]
    fn from_tip(
        _class: &Bound<'_, PyType>,
        center: &Any<'_>,
        tip_radius: &Any<'_>,
        position_error: &Any<'_>,
        approach: Option<&Any<'_>>,
        normal: Option<&Any<'_>>,
        normal_error: Option<&Any<'_>>,
        start: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        let tip_radius = number("tip_radius", tip_radius)?;
        Reading { position_error, normal, normal_error, approach, start }
            .contact(vector("center", center)?, tip_radius)
    }

    #[doc = doc!("Contact.center")]
    #[getter]
    fn center<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        vector_array(py, self.0.center)
    }

    #[doc = doc!("Contact.tip_radius")]
    #[getter]
    fn tip_radius(&self) -> f64 {
        self.0.tip_radius
    }

    #[doc = doc!("Contact.position_error")]
    #[getter]
    fn position_error(&self) -> f64 {
        self.0.position_error
    }

    #[doc = doc!("Contact.normal")]
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        self.0.normal.map(|normal| vector_array(py, normal.direction)).transpose()
    }

    #[doc = doc!("Contact.normal_error")]
    #[getter]
    fn normal_error(&self) -> Option<f64> {
        self.0.normal.map(|normal| normal.error)
    }

    #[doc = doc!("Contact.approach")]
    #[getter]
    fn approach<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        self.0.approach.map(|approach| vector_array(py, approach)).transpose()
    }

    #[doc = doc!("Contact.start")]
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        self.0.start.map(|start| vector_array(py, start)).transpose()
    }

    fn __repr__(&self) -> String {
        let contact = &self.0;
        let (maker, radius) = match contact.tip_radius {
            0.0 => ("Contact", String::new()),
            radius => ("Contact.from_tip", format!(", {radius:?}")),
        };
        let normal = contact.normal.map_or_else(String::new, |Normal { direction, error }| {
            format!(", normal={}, normal_error={error:?}", tuple(direction))
        });
        let named = |name: &str, vector: Option<DVec2>| {
            vector.map_or_else(String::new, |vector| format!(", {name}={}", tuple(vector)))
        };
        let (approach, start) = (named("approach", contact.approach), named("start", contact.start));
        let (center, error) = (tuple(contact.center), contact.position_error);
        format!("{maker}({center}{radius}, position_error={error:?}{normal}{approach}{start})")
    }

    /// Pickled by its numbers as they are: normalizing a unit vector again may change its last bit.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Any<'py>, ContactState)> {
        let contact = &self.0;
        let state = (
            contact.center.into(),
            contact.tip_radius,
            contact.position_error,
            contact.normal.map(|normal| (normal.direction.into(), normal.error)),
            contact.approach.map(Into::into),
            contact.start.map(Into::into),
        );
        Ok((restore::<Self>(py)?, state))
    }

    /// Undoes `__reduce__`.
    #[classmethod]
    fn _restore(
        _class: &Bound<'_, PyType>,
        center: Pair,
        tip_radius: f64,
        position_error: f64,
        normal: Option<(Pair, f64)>,
        approach: Option<Pair>,
        start: Option<Pair>,
    ) -> Self {
        Self(Contact {
            center: center.into(),
            tip_radius,
            position_error,
            normal: normal.map(|(direction, error)| Normal { direction: direction.into(), error }),
            approach: approach.map(Into::into),
            start: start.map(Into::into),
        })
    }
}
