//! Contacts.

use numpy::PyArray1;
use palpate::{Contact, Error, Normal};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

use crate::convert::{
    any_vector, damaged, number, optional_vector, raise, restore, restored, tuple, vector, vector_array,
};
use crate::dimension::{AnyContact, In, Vector};

type Any<'py> = Bound<'py, PyAny>;

#[doc = doc!("Contact")]
#[pyclass(name = "Contact", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyContact(pub(crate) AnyContact);

/// Coordinates in a pickle.
type Coordinates = Vec<f64>;

/// Centre, tip radius, position error, normal with its error, approach, start.
type ContactState =
    (Coordinates, f64, f64, Option<(Coordinates, f64)>, Option<Coordinates>, Option<Coordinates>);

/// The arguments that both constructors of a contact share.
struct Reading<'a, 'py> {
    position_error: &'a Any<'py>,
    normal: Option<&'a Any<'py>>,
    normal_error: Option<&'a Any<'py>>,
    approach: Option<&'a Any<'py>>,
    start: Option<&'a Any<'py>>,
}

impl Reading<'_, '_> {
    /// A contact of the plane or of space, as the centre is.
    fn contact(&self, argument: &str, center: &Any<'_>, tip_radius: f64) -> PyResult<PyContact> {
        Ok(PyContact(likewise!(any_vector(argument, center)?, center => self.at(center, tip_radius)?)))
    }

    fn at<V: Vector>(&self, center: V, tip_radius: f64) -> PyResult<Contact<V>> {
        let position_error = number("position_error", self.position_error)?;
        let mut contact = Contact::new(center, tip_radius, position_error).map_err(raise)?;
        contact.normal = self.normal()?;
        if let Some(toward) = optional_vector("approach", self.approach)? {
            contact = contact.with_approach(toward).map_err(raise)?;
        }
        if let Some(start) = optional_vector("start", self.start)? {
            contact = contact.with_start(start).map_err(raise)?;
        }
        Ok(contact)
    }

    fn normal<V: Vector>(&self) -> PyResult<Option<Normal<V>>> {
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
    #[pyo3(
        signature = (point, normal=None, *, position_error, normal_error=None, approach=None, start=None, **others),
        text_signature = "(point, normal=None, *, position_error, normal_error=None, approach=None, start=None)"
    )]
    fn new(
        point: &Any<'_>,
        normal: Option<&Any<'_>>,
        position_error: &Any<'_>,
        normal_error: Option<&Any<'_>>,
        approach: Option<&Any<'_>>,
        start: Option<&Any<'_>>,
        others: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        if let Some(other) = others.and_then(|others| others.keys().iter().next()) {
            let name = other.extract::<String>()?;
            let of_tip = ["center", "tip_radius"].contains(&name.as_str());
            let remedy =
                if of_tip { "; give the tip to Contact.from_tip(center, tip_radius, ...)" } else { "" };
            let problem = format!("Contact() got an unexpected keyword argument '{name}'{remedy}");
            return Err(PyTypeError::new_err(problem));
        }
        Reading { position_error, normal, normal_error, approach, start }.contact("point", point, 0.0)
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
            .contact("center", center, tip_radius)
    }

    #[doc = doc!("Contact.center")]
    #[getter]
    fn center<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        either!(&self.0, contact => vector_array(py, contact.center))
    }

    #[doc = doc!("Contact.tip_radius")]
    #[getter]
    fn tip_radius(&self) -> f64 {
        either!(&self.0, contact => contact.tip_radius)
    }

    #[doc = doc!("Contact.position_error")]
    #[getter]
    fn position_error(&self) -> f64 {
        either!(&self.0, contact => contact.position_error)
    }

    #[doc = doc!("Contact.normal")]
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        either!(&self.0, contact => {
            contact.normal.map(|normal| vector_array(py, normal.direction)).transpose()
        })
    }

    #[doc = doc!("Contact.normal_error")]
    #[getter]
    fn normal_error(&self) -> Option<f64> {
        either!(&self.0, contact => contact.normal.map(|normal| normal.error))
    }

    #[doc = doc!("Contact.approach")]
    #[getter]
    fn approach<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        either!(&self.0, contact => contact.approach.map(|approach| vector_array(py, approach)).transpose())
    }

    #[doc = doc!("Contact.start")]
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        either!(&self.0, contact => contact.start.map(|start| vector_array(py, start)).transpose())
    }

    fn __repr__(&self) -> String {
        either!(&self.0, contact => shown(contact))
    }

    /// Pickled by its numbers as they are: normalizing a unit vector again may change its last bit.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Any<'py>, ContactState)> {
        Ok((restore::<Self>(py)?, either!(&self.0, contact => state(contact))))
    }

    /// Undoes `__reduce__`.
    #[classmethod]
    fn _restore(
        _class: &Bound<'_, PyType>,
        center: Coordinates,
        tip_radius: f64,
        position_error: f64,
        normal: Option<(Coordinates, f64)>,
        approach: Option<Coordinates>,
        start: Option<Coordinates>,
    ) -> PyResult<Self> {
        let state = (center, tip_radius, position_error, normal, approach, start);
        match state.0.len() {
            2 => again(state).map(In::Plane),
            3 => again(state).map(In::Space),
            _ => Err(damaged()),
        }
        .map(Self)
    }
}

fn shown<V: Vector>(contact: &Contact<V>) -> String {
    let (maker, radius) = match contact.tip_radius {
        0.0 => ("Contact", String::new()),
        radius => ("Contact.from_tip", format!(", {radius:?}")),
    };
    let normal = contact.normal.map_or_else(String::new, |Normal { direction, error }| {
        format!(", normal={}, normal_error={error:?}", tuple(direction))
    });
    let named = |name: &str, vector: Option<V>| {
        vector.map_or_else(String::new, |vector| format!(", {name}={}", tuple(vector)))
    };
    let (approach, start) = (named("approach", contact.approach), named("start", contact.start));
    let (center, error) = (tuple(contact.center), contact.position_error);
    format!("{maker}({center}{radius}, position_error={error:?}{normal}{approach}{start})")
}

fn state<V: Vector>(contact: &Contact<V>) -> ContactState {
    (
        contact.center.coordinates().to_vec(),
        contact.tip_radius,
        contact.position_error,
        contact.normal.map(|normal| (normal.direction.coordinates().to_vec(), normal.error)),
        contact.approach.map(|one| one.coordinates().to_vec()),
        contact.start.map(|one| one.coordinates().to_vec()),
    )
}

fn again<V: Vector>(state: ContactState) -> PyResult<Contact<V>> {
    let (center, tip_radius, position_error, normal, approach, start) = state;
    let sensed = |(direction, error): (Coordinates, f64)| {
        PyResult::Ok(Normal { direction: restored(&direction)?, error })
    };
    Ok(Contact {
        center: restored(&center)?,
        tip_radius,
        position_error,
        normal: normal.map(sensed).transpose()?,
        approach: approach.map(|one| restored(&one)).transpose()?,
        start: start.map(|one| restored(&one)).transpose()?,
    })
}
