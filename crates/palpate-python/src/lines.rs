//! Hypotheses made ready for many lines.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use palpate::Prepared;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;

use crate::convert::{number, numbers, raise, vector_array};
use crate::dimension::In;
use crate::interrupt::interruptible;
use crate::options::{JUDGED, Options, PLACED};
use crate::path::PyPath;
use crate::plan::{planar, sensor};

type Any<'py> = Bound<'py, PyAny>;

#[doc = doc!("Lines")]
#[pyclass(name = "Lines", module = "palpate._core", frozen)]
pub(crate) struct PyLines {
    prepared: Prepared,
    tip_radius: f64,
}

#[pymethods]
impl PyLines {
    #[new]
    #[pyo3(
        signature = (hypotheses, sensor, **options),
        text_signature = "(hypotheses, sensor, *, workspace=None, directions=None, features=None, avoid_assigned=False, margin=0.001, seed=0)"
    )]
    fn new(
        py: Python<'_>,
        hypotheses: &Any<'_>,
        sensor: &Any<'_>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let options = Options::read("Lines", options, &[JUDGED, PLACED])?;
        let (hypotheses, sensor) = (planar("Lines", hypotheses)?, self::sensor(sensor)?);
        let prepared = py.detach(|| Prepared::new(&hypotheses, &sensor, &options.settings)).map_err(raise)?;
        Ok(Self { prepared, tip_radius: sensor.tip_radius })
    }

    #[doc = doc!("Lines.middle")]
    #[getter]
    fn middle<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        vector_array(py, self.prepared.middle())
    }

    #[doc = doc!("Lines.radius")]
    #[getter]
    fn radius(&self) -> f64 {
        self.prepared.radius()
    }

    #[doc = doc!("Lines.scores")]
    fn scores<'py>(
        &self,
        py: Python<'py>,
        angles: &Any<'py>,
        offsets: &Any<'py>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (angles, offsets) = (numbers("angles", angles)?, numbers("offsets", offsets)?);
        let score = |angle: f64, offset: f64| {
            let line = self.prepared.line(angle, offset)?;
            self.prepared.score(&line)
        };
        let rows = interruptible(py, |halt| {
            let row = |angle: &f64| -> Vec<f64> {
                let halted = halt.load(std::sync::atomic::Ordering::Relaxed);
                let of =
                    |offset: &f64| if halted { f64::NAN } else { score(*angle, *offset).unwrap_or(f64::NAN) };
                offsets.iter().map(of).collect()
            };
            angles.par_iter().flat_map(row).collect::<Vec<f64>>()
        })?;
        PyArray1::from_vec(py, rows).reshape([angles.len(), offsets.len()])
    }

    #[doc = doc!("Lines.judge")]
    fn judge(&self, py: Python<'_>, angle: &Any<'_>, offset: &Any<'_>) -> PyResult<Option<PyPath>> {
        let (angle, offset) = (number("angle", angle)?, number("offset", offset)?);
        let finite = [("angle", angle), ("offset", offset)].into_iter().find(|(_, value)| !value.is_finite());
        if let Some((name, value)) = finite {
            return Err(raise(palpate::Error::new(name, "must be finite", value, "give a finite number")));
        }
        let path = py.detach(|| Some(self.prepared.judge(&self.prepared.line(angle, offset)?)));
        Ok(path.map(|path| PyPath::new(In::Plane(path), self.tip_radius)))
    }

    fn __repr__(&self) -> String {
        format!(
            "<Lines within {:.6} of {}>",
            self.prepared.radius(),
            crate::convert::tuple(self.prepared.middle())
        )
    }
}
