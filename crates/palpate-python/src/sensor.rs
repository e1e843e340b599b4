//! The sensor of the next reading.

use glam::DVec3;
use numpy::PyArray1;
use palpate::{Sensor, Stem};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::convert::{members, number, raise, refuse, restore, tuple, vector, vector_array};

type Any<'py> = Bound<'py, PyAny>;
/// Direction, radius and length of a stem.
type Rod<'py> = (Bound<'py, PyArray1<f64>>, f64, f64);
type StemState = ([f64; 3], f64, f64);
type State = (f64, Option<f64>, f64, f64, f64, Option<StemState>);

#[doc = doc!("Sensor")]
#[pyclass(name = "Sensor", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PySensor(pub(crate) Sensor);

#[pymethods]
impl PySensor {
    #[new]
    #[pyo3(
        signature = (position_error, normal_error, max_incidence, tip_radius=None, path_error=None, stem=None),
        text_signature = "(position_error, normal_error, max_incidence, tip_radius=0.0, path_error=0.0, stem=None)"
    )]
    fn new(
        position_error: &Any<'_>,
        normal_error: Option<&Any<'_>>,
        max_incidence: &Any<'_>,
        tip_radius: Option<&Any<'_>>,
        path_error: Option<&Any<'_>>,
        stem: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        let position_error = number("position_error", position_error)?;
        let normal_error = normal_error.map(|error| number("normal_error", error)).transpose()?;
        let max_incidence = number("max_incidence", max_incidence)?;
        let [tip_radius, path_error] = [("tip_radius", tip_radius), ("path_error", path_error)]
            .map(|(name, length)| length.map_or(Ok(0.0), |length| number(name, length)));
        let (tip_radius, path_error) = (tip_radius?, path_error?);
        let sensor = Sensor::new(position_error, normal_error, max_incidence)
            .and_then(|sensor| sensor.with_tip(tip_radius, path_error))
            .map_err(raise)?;
        Ok(Self(Sensor { stem: stem.map(rod).transpose()?, ..sensor }))
    }

    #[doc = doc!("Sensor.position_error")]
    #[getter]
    fn position_error(&self) -> f64 {
        self.0.position_error
    }

    #[doc = doc!("Sensor.normal_error")]
    #[getter]
    fn normal_error(&self) -> Option<f64> {
        self.0.normal_error
    }

    #[doc = doc!("Sensor.max_incidence")]
    #[getter]
    fn max_incidence(&self) -> f64 {
        self.0.max_incidence
    }

    #[doc = doc!("Sensor.tip_radius")]
    #[getter]
    fn tip_radius(&self) -> f64 {
        self.0.tip_radius
    }

    #[doc = doc!("Sensor.path_error")]
    #[getter]
    fn path_error(&self) -> f64 {
        self.0.path_error
    }

    #[doc = doc!("Sensor.stem")]
    #[getter]
    fn stem<'py>(&self, py: Python<'py>) -> PyResult<Option<Rod<'py>>> {
        let Some(stem) = self.0.stem else { return Ok(None) };
        Ok(Some((vector_array(py, stem.direction)?, stem.radius, stem.length)))
    }

    fn __repr__(&self) -> String {
        let Sensor { position_error, normal_error, max_incidence, tip_radius, path_error, stem } = self.0;
        let normal = normal_error.map_or_else(|| "None".to_owned(), |error| format!("{error:?}"));
        let tip = format!("tip_radius={tip_radius:?}, path_error={path_error:?}");
        let stem = stem.map_or_else(String::new, |Stem { direction, radius, length }| {
            format!(", stem=({}, {radius:?}, {length:?})", tuple(direction))
        });
        format!("Sensor({position_error:?}, {normal}, {max_incidence:?}, {tip}{stem})")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Any<'py>, State)> {
        let Sensor { position_error, normal_error, max_incidence, tip_radius, path_error, stem } = self.0;
        let stem = stem.map(|one| (one.direction.to_array(), one.radius, one.length));
        let state = (position_error, normal_error, max_incidence, tip_radius, path_error, stem);
        Ok((restore::<Self>(py)?, state))
    }

    /// Undoes `__reduce__`.
    #[classmethod]
    #[pyo3(signature = (position_error, normal_error, max_incidence, tip_radius, path_error, stem=None))]
    fn _restore(
        _class: &Bound<'_, PyType>,
        position_error: f64,
        normal_error: Option<f64>,
        max_incidence: f64,
        tip_radius: f64,
        path_error: f64,
        stem: Option<StemState>,
    ) -> Self {
        let stem = stem.map(|(direction, radius, length)| {
            let direction = DVec3::from_array(direction);
            Stem { direction, radius, length }
        });
        Self(Sensor { position_error, normal_error, max_incidence, tip_radius, path_error, stem })
    }
}

/// What carries the tip.
fn rod(value: &Any<'_>) -> PyResult<Stem> {
    let remedy = "give (direction, radius, length), the direction from the tip along the rod";
    let parts = members("stem", value, "a direction, a radius and a length", remedy)?;
    let [direction, radius, length] = parts.as_slice() else {
        return Err(refuse("stem", "must be a direction, a radius and a length", value, remedy));
    };
    let direction = vector("stem[0]", direction)?;
    Stem::new(direction, number("stem[1]", radius)?, number("stem[2]", length)?).map_err(raise)
}
