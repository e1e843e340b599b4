//! The sensor of the next reading.

use palpate::Sensor;
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::convert::{number, raise, restore};

type Any<'py> = Bound<'py, PyAny>;
type State = (f64, Option<f64>, f64, f64, f64);

#[doc = doc!("Sensor")]
#[pyclass(name = "Sensor", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PySensor(pub(crate) Sensor);

#[pymethods]
impl PySensor {
    #[new]
    #[pyo3(
        signature = (position_error, normal_error, max_incidence, tip_radius=None, path_error=None),
        text_signature = "(position_error, normal_error, max_incidence, tip_radius=0.0, path_error=0.0)"
    )]
    fn new(
        position_error: &Any<'_>,
        normal_error: Option<&Any<'_>>,
        max_incidence: &Any<'_>,
        tip_radius: Option<&Any<'_>>,
        path_error: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        let position_error = number("position_error", position_error)?;
        let normal_error = normal_error.map(|error| number("normal_error", error)).transpose()?;
        let max_incidence = number("max_incidence", max_incidence)?;
        let [tip_radius, path_error] = [("tip_radius", tip_radius), ("path_error", path_error)]
            .map(|(name, length)| length.map_or(Ok(0.0), |length| number(name, length)));
        let (tip_radius, path_error) = (tip_radius?, path_error?);
        Sensor::new(position_error, normal_error, max_incidence)
            .and_then(|sensor| sensor.with_tip(tip_radius, path_error))
            .map(Self)
            .map_err(raise)
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

    fn __repr__(&self) -> String {
        let Sensor { position_error, normal_error, max_incidence, tip_radius, path_error, stem: _ } = self.0;
        let normal = normal_error.map_or_else(|| "None".to_owned(), |error| format!("{error:?}"));
        let tip = format!("tip_radius={tip_radius:?}, path_error={path_error:?}");
        format!("Sensor({position_error:?}, {normal}, {max_incidence:?}, {tip})")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Any<'py>, State)> {
        let Sensor { position_error, normal_error, max_incidence, tip_radius, path_error, stem: _ } = self.0;
        Ok((restore::<Self>(py)?, (position_error, normal_error, max_incidence, tip_radius, path_error)))
    }

    /// Undoes `__reduce__`.
    #[classmethod]
    fn _restore(
        _class: &Bound<'_, PyType>,
        position_error: f64,
        normal_error: Option<f64>,
        max_incidence: f64,
        tip_radius: f64,
        path_error: f64,
    ) -> Self {
        Self(Sensor { position_error, normal_error, max_incidence, tip_radius, path_error, stem: None })
    }
}
