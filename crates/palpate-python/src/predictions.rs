//! What two of the thesis's planners in space predict of themselves.

use glam::{DVec2, DVec3};
use palpate::space;
use pyo3::prelude::*;

use crate::convert::{refuse, vector, vectors};

/// The fewest corners of a polygon.
const FEWEST: usize = 3;

/// A polygon's corners in the chart of a generator.
fn polygon(corners: &Bound<'_, PyAny>) -> PyResult<Vec<DVec3>> {
    let read = vectors("corners", corners)?;
    if read.len() < FEWEST {
        return Err(refuse("corners", "must be three or more", corners, "give the corners of one polygon"));
    }
    Ok(read)
}

#[doc = doc!("linearization_error")]
#[pyfunction]
pub(crate) fn linearization_error(
    corners: &Bound<'_, PyAny>,
    slopes: &Bound<'_, PyAny>,
) -> PyResult<(f64, f64)> {
    let error = space::linearization_error(&polygon(corners)?, vector::<DVec2>("slopes", slopes)?);
    Ok((error.shift, error.area))
}

#[doc = doc!("predicted_hit_rate")]
#[pyfunction]
pub(crate) fn predicted_hit_rate(corners: &Bound<'_, PyAny>, slopes: &Bound<'_, PyAny>) -> PyResult<f64> {
    Ok(space::predicted_hit_rate(&polygon(corners)?, vector::<DVec2>("slopes", slopes)?))
}
