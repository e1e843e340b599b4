//! Misses and the prior.

use numpy::{PyArray1, PyArray2};
use palpate::{Dimension, Miss, Prior, space};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::convert::{
    any_pose, any_vector, damaged, number, pose, pose_array, raise, restore, restored, tuple, vector,
    vector_array,
};
use crate::dimension::{AnyMiss, AnyPrior, In, Motion};

type Any<'py> = Bound<'py, PyAny>;

/// Coordinates in a pickle.
type Coordinates = Vec<f64>;

#[doc = doc!("Miss")]
#[pyclass(name = "Miss", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyMiss(pub(crate) AnyMiss);

#[doc = doc!("Prior")]
#[pyclass(name = "Prior", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyPrior(pub(crate) AnyPrior);

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
        let (tip_radius, path_error) = (tip_radius?, path_error?);
        let miss = likewise!(any_vector("start", start)?, start => {
            Miss::new(start, vector("end", end)?, tip_radius, path_error).map_err(raise)?
        });
        Ok(Self(miss))
    }

    #[doc = doc!("Miss.start")]
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        either!(&self.0, miss => vector_array(py, miss.start))
    }

    #[doc = doc!("Miss.end")]
    #[getter]
    fn end<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        either!(&self.0, miss => vector_array(py, miss.end))
    }

    #[doc = doc!("Miss.tip_radius")]
    #[getter]
    fn tip_radius(&self) -> f64 {
        either!(&self.0, miss => miss.tip_radius)
    }

    #[doc = doc!("Miss.path_error")]
    #[getter]
    fn path_error(&self) -> f64 {
        either!(&self.0, miss => miss.path_error)
    }

    fn __repr__(&self) -> String {
        let ends = either!(&self.0, miss => format!("{}, {}", tuple(miss.start), tuple(miss.end)));
        format!("Miss({ends}, tip_radius={:?}, path_error={:?})", self.tip_radius(), self.path_error())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Any<'py>, (Coordinates, Coordinates, f64, f64))> {
        let state = either!(&self.0, miss => {
            (miss.start.coordinates().to_vec(), miss.end.coordinates().to_vec(), miss.tip_radius, miss.path_error)
        });
        Ok((restore::<Self>(py)?, state))
    }

    /// Undoes `__reduce__`.
    #[classmethod]
    #[expect(clippy::needless_pass_by_value, reason = "as Python hands it over")]
    fn _restore(
        _class: &Bound<'_, PyType>,
        start: Coordinates,
        end: Coordinates,
        tip_radius: f64,
        path_error: f64,
    ) -> PyResult<Self> {
        let miss = match start.len() {
            2 => In::Plane(Miss { start: restored(&start)?, end: restored(&end)?, tip_radius, path_error }),
            3 => In::Space(Miss { start: restored(&start)?, end: restored(&end)?, tip_radius, path_error }),
            _ => return Err(damaged()),
        };
        Ok(Self(miss))
    }
}

/// Normal, height and tilt of a part that lies on a plane.
type LyingState = (Coordinates, f64, f64);

/// The middle row by row, translation, rotation, and how it lies.
type PriorState = (Coordinates, f64, f64, Option<LyingState>);

impl PyPrior {
    fn lying(&self) -> Option<space::Lying> {
        if let In::Space(prior) = &self.0 { prior.lying } else { None }
    }
}

#[pymethods]
impl PyPrior {
    #[new]
    #[pyo3(signature = (world_from_model, *, translation, rotation))]
    fn new(world_from_model: &Any<'_>, translation: &Any<'_>, rotation: &Any<'_>) -> PyResult<Self> {
        let middle = any_pose("world_from_model", world_from_model)?;
        let [translation, rotation] = [number("translation", translation)?, number("rotation", rotation)?];
        let prior = match middle {
            In::Plane(middle) => In::Plane(Prior::new(middle, translation, rotation).map_err(raise)?),
            In::Space(middle) => In::Space(space::Prior::new(middle, translation, rotation).map_err(raise)?),
        };
        Ok(Self(prior))
    }

    #[doc = doc!("Prior.on_plane")]
    #[classmethod]
    #[pyo3(
        signature = (world_from_model, *, translation, rotation, height, tilt, normal=None),
        text_signature = "(world_from_model, *, translation, rotation, height, tilt, normal=(0, 0, 1))"
    )]
    fn on_plane(
        _class: &Bound<'_, PyType>,
        world_from_model: &Any<'_>,
        translation: &Any<'_>,
        rotation: &Any<'_>,
        height: &Any<'_>,
        tilt: &Any<'_>,
        normal: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        let middle = pose("world_from_model", world_from_model)?;
        let [translation, rotation] = [number("translation", translation)?, number("rotation", rotation)?];
        let [height, tilt] = [number("height", height)?, number("tilt", tilt)?];
        let normal = normal.map_or(Ok(glam::DVec3::Z), |normal| vector("normal", normal))?;
        let prior = space::Prior::new(middle, translation, rotation).map_err(raise)?;
        Ok(Self(In::Space(prior.on_plane(normal, height, tilt).map_err(raise)?)))
    }

    #[doc = doc!("Prior.world_from_model")]
    #[getter]
    fn world_from_model<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        either!(&self.0, prior => pose_array(py, prior.world_from_model))
    }

    #[doc = doc!("Prior.translation")]
    #[getter]
    fn translation(&self) -> f64 {
        either!(&self.0, prior => prior.translation)
    }

    #[doc = doc!("Prior.rotation")]
    #[getter]
    fn rotation(&self) -> f64 {
        either!(&self.0, prior => prior.rotation)
    }

    #[doc = doc!("Prior.height")]
    #[getter]
    fn height(&self) -> Option<f64> {
        self.lying().map(|lying| lying.height)
    }

    #[doc = doc!("Prior.tilt")]
    #[getter]
    fn tilt(&self) -> Option<f64> {
        self.lying().map(|lying| lying.tilt)
    }

    #[doc = doc!("Prior.normal")]
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        self.lying().map(|lying| vector_array(py, lying.normal)).transpose()
    }

    fn __repr__(&self) -> String {
        let rows = either!(&self.0, prior => format!("{:?}", prior.world_from_model.to_rows()));
        let bounds = format!("translation={:?}, rotation={:?}", self.translation(), self.rotation());
        match self.lying() {
            None => format!("Prior({rows}, {bounds})"),
            Some(space::Lying { normal, height, tilt }) => {
                let normal = tuple(normal);
                format!("Prior.on_plane({rows}, {bounds}, height={height:?}, tilt={tilt:?}, normal={normal})")
            }
        }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Any<'py>, PriorState)> {
        let rows = either!(&self.0, prior => prior.world_from_model.numbers());
        let lying = self.lying().map(|one| (one.normal.coordinates().to_vec(), one.height, one.tilt));
        Ok((restore::<Self>(py)?, (rows, self.translation(), self.rotation(), lying)))
    }

    /// Undoes `__reduce__`.
    #[classmethod]
    #[expect(clippy::needless_pass_by_value, reason = "as Python hands it over")]
    fn _restore(
        _class: &Bound<'_, PyType>,
        rows: Coordinates,
        translation: f64,
        rotation: f64,
        lying: Option<LyingState>,
    ) -> PyResult<Self> {
        let again = |(normal, height, tilt): LyingState| {
            PyResult::Ok(space::Lying { normal: restored(&normal)?, height, tilt })
        };
        let prior = match rows.len() {
            9 => In::Plane(Prior { world_from_model: Motion::restored(&rows), translation, rotation }),
            16 => In::Space(space::Prior {
                world_from_model: Motion::restored(&rows),
                translation,
                rotation,
                lying: lying.map(again).transpose()?,
            }),
            _ => return Err(damaged()),
        };
        Ok(Self(prior))
    }
}
