//! Hypotheses made ready for many lines.

use std::sync::atomic::Ordering;

use glam::{DVec2, DVec3};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use palpate::plan::normalized;
use palpate::{Error, Line, Prepared};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;

use crate::convert::{direction, number, numbers, plane_only, raise, tuple, vector, vector_array, vectors};
use crate::dimension::In;
use crate::interrupt::interruptible;
use crate::options::{JUDGED, Options, PLACED};
use crate::path::PyPath;
use crate::plan::{hypotheses, sensor};

type Any<'py> = Bound<'py, PyAny>;

#[doc = doc!("Lines")]
#[pyclass(name = "Lines", module = "palpate._core", frozen)]
pub(crate) struct PyLines {
    prepared: In<Prepared<DVec2>, Prepared<DVec3>>,
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
        let sensor = self::sensor(sensor)?;
        let prepared = likewise!(self::hypotheses(hypotheses)?, hypotheses => {
            let options = Options::read("Lines", options, &[JUDGED, PLACED])?;
            py.detach(|| Prepared::new(&hypotheses, &sensor, &options.settings)).map_err(raise)?
        });
        Ok(Self { prepared, tip_radius: sensor.tip_radius })
    }

    #[doc = doc!("Lines.middle")]
    #[getter]
    fn middle<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        either!(&self.prepared, prepared => vector_array(py, prepared.middle()))
    }

    #[doc = doc!("Lines.radius")]
    #[getter]
    fn radius(&self) -> f64 {
        either!(&self.prepared, prepared => prepared.radius())
    }

    #[doc = doc!("Lines.scores")]
    fn scores<'py>(
        &self,
        py: Python<'py>,
        angles: &Any<'py>,
        offsets: &Any<'py>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let prepared = self.planar("scores")?;
        let (angles, offsets) = (numbers("angles", angles)?, numbers("offsets", offsets)?);
        let score = |angle: f64, offset: f64| prepared.score(&prepared.line(angle, offset)?);
        let rows = interruptible(py, |halt| {
            let row = |angle: &f64| -> Vec<f64> {
                let halted = halt.load(Ordering::Relaxed);
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
        let prepared = self.planar("judge")?;
        let (angle, offset) = (number("angle", angle)?, number("offset", offset)?);
        let finite = [("angle", angle), ("offset", offset)].into_iter().find(|(_, value)| !value.is_finite());
        if let Some((name, value)) = finite {
            return Err(raise(Error::new(name, "must be finite", value, "give a finite number")));
        }
        let path = py.detach(|| Some(prepared.judge(&prepared.line(angle, offset)?)));
        Ok(path.map(|path| PyPath::new(In::Plane(path), self.tip_radius)))
    }

    #[doc = doc!("Lines.judge_through")]
    fn judge_through(
        &self,
        py: Python<'_>,
        direction: &Any<'_>,
        point: &Any<'_>,
    ) -> PyResult<Option<PyPath>> {
        let prepared = self.spatial("judge_through")?;
        let (direction, point) = (self::direction("direction", direction)?, vector("point", point)?);
        let path = py.detach(|| Some(prepared.judge(&prepared.along(direction, point)?)));
        Ok(path.map(|path| PyPath::new(In::Space(path), self.tip_radius)))
    }

    #[doc = doc!("Lines.scores_through")]
    fn scores_through<'py>(
        &self,
        py: Python<'py>,
        directions: &Any<'py>,
        points: &Any<'py>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.of_each(py, "scores_through", directions, points, Prepared::score)
    }

    #[doc = doc!("Lines.least_scores")]
    fn least_scores<'py>(
        &self,
        py: Python<'py>,
        directions: &Any<'py>,
        points: &Any<'py>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.of_each(py, "least_scores", directions, points, Prepared::<DVec3>::least_score)
    }

    fn __repr__(&self) -> String {
        let middle = either!(&self.prepared, prepared => tuple(prepared.middle()));
        format!("<Lines within {:.6} of {middle}>", self.radius())
    }
}

impl PyLines {
    fn planar(&self, what: &str) -> PyResult<&Prepared<DVec2>> {
        match &self.prepared {
            In::Plane(prepared) => Ok(prepared),
            In::Space(_) => Err(plane_only(
                what,
                "hypotheses in space",
                "call judge_through, scores_through or least_scores",
            )),
        }
    }

    fn spatial(&self, what: &str) -> PyResult<&Prepared<DVec3>> {
        let remedy = "call judge or scores";
        match &self.prepared {
            In::Space(prepared) => Ok(prepared),
            In::Plane(_) => {
                Err(raise(Error::new(what, "works in space only", "hypotheses in the plane", remedy)))
            }
        }
    }

    /// A number of each line of space; NaN where there is none.
    fn of_each<'py>(
        &self,
        py: Python<'py>,
        what: &str,
        directions: &Any<'py>,
        points: &Any<'py>,
        number: impl Fn(&Prepared<DVec3>, &Line<DVec3>) -> Option<f64> + Sync,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let prepared = self.spatial(what)?;
        let given: Vec<DVec3> = vectors("directions", directions)?;
        let points: Vec<DVec3> = vectors("points", points)?;
        if given.len() != points.len() {
            let problem = format!("must be as many as directions, which are {}", given.len());
            return Err(raise(Error::new("points", problem, points.len(), "give one for each direction")));
        }
        if let Some(k) = given.iter().position(|one| normalized(*one).is_none()) {
            let name = format!("directions[{k}]");
            let remedy = "give a direction, of any length";
            return Err(raise(Error::new(name, "must not be zero", tuple(given[k]), remedy)));
        }
        let numbers = interruptible(py, |halt| {
            let of_line = |(direction, point): (&DVec3, &DVec3)| {
                if halt.load(Ordering::Relaxed) {
                    return f64::NAN;
                }
                let line = normalized(*direction).and_then(|one| prepared.along(one, *point));
                line.and_then(|line| number(prepared, &line)).unwrap_or(f64::NAN)
            };
            given.par_iter().zip(&points).map(of_line).collect::<Vec<f64>>()
        })?;
        Ok(PyArray1::from_vec(py, numbers))
    }
}
