//! The next path.

use palpate::Line;
use palpate::{Hypothesis, Move, Plan, Verification, Why};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::contact::PyContact;
use crate::convert::{members, number, raise, refuse, vector};
use crate::dimension::In;
use crate::hypothesis::PyHypothesis;
use crate::interrupt::interruptible;
use crate::options::{JUDGED, Options, PLACED, REMEMBERED, SEARCHED, line};
use crate::path::PyPath;
use crate::recognize::all;
use crate::sensor::PySensor;

type Any<'py> = Bound<'py, PyAny>;

#[doc = doc!("PlanReport")]
#[pyclass(name = "PlanReport", module = "palpate._core", frozen)]
pub(crate) struct PyPlanReport {
    plan: Plan,
    path: Option<Py<PyPath>>,
    why: Why,
}

/// Hypotheses of a recognition.
pub(crate) fn hypotheses(value: &Any<'_>) -> PyResult<Vec<Hypothesis>> {
    let remedy = "give found.hypotheses of a recognition";
    let given = all::<PyHypothesis>("hypotheses", value, "Hypothesis", remedy)?;
    given.iter().enumerate().map(|(k, one)| planar(&format!("hypotheses[{k}]"), one)).collect()
}

/// A hypothesis of a part in the plane.
fn planar(argument: &str, given: &Bound<'_, PyHypothesis>) -> PyResult<Hypothesis> {
    match &given.get().hypothesis {
        In::Plane(hypothesis) => Ok(hypothesis.clone()),
        In::Space(_) => {
            let problem = "is of a part in space; planning works in the plane only";
            Err(refuse(argument, problem, given, "give hypotheses of models of dimension 2"))
        }
    }
}

fn hypothesis(value: &Any<'_>) -> PyResult<Hypothesis> {
    match value.cast::<PyHypothesis>() {
        Ok(one) => planar("hypothesis", one),
        Err(_) => Err(refuse("hypothesis", "must be a Hypothesis", value, "give one of found.hypotheses")),
    }
}

pub(crate) fn sensor(value: &Any<'_>) -> PyResult<palpate::Sensor> {
    match value.cast::<PySensor>() {
        Ok(sensor) => Ok(sensor.get().0),
        Err(_) => Err(refuse("sensor", "must be a Sensor", value, "give palpate.Sensor")),
    }
}

#[doc = doc!("plan")]
#[pyfunction]
#[pyo3(
    signature = (hypotheses, sensor, **options),
    text_signature = "(hypotheses, sensor, *, planner='auto', stop='perfect', workspace=None, directions=None, time_limit=None, effort=None, seed=0, features=None, avoid_assigned=False, margin=0.001, tried=(), cells=None, directions_tried=None)"
)]
pub(crate) fn plan(
    py: Python<'_>,
    hypotheses: &Any<'_>,
    sensor: &Any<'_>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Option<Py<PyPath>>> {
    planned(py, hypotheses, sensor, &Options::read("plan", options, &[JUDGED, PLACED, SEARCHED, REMEMBERED])?)
        .map(|report| report.path)
}

#[doc = doc!("plan_report")]
#[pyfunction]
#[pyo3(
    signature = (hypotheses, sensor, **options),
    text_signature = "(hypotheses, sensor, *, planner='auto', stop='perfect', workspace=None, directions=None, time_limit=None, effort=None, seed=0, features=None, avoid_assigned=False, margin=0.001, tried=(), cells=None, directions_tried=None)"
)]
pub(crate) fn plan_report(
    py: Python<'_>,
    hypotheses: &Any<'_>,
    sensor: &Any<'_>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<PyPlanReport> {
    let options = Options::read("plan_report", options, &[JUDGED, PLACED, SEARCHED, REMEMBERED])?;
    planned(py, hypotheses, sensor, &options)
}

fn planned(py: Python<'_>, given: &Any<'_>, with: &Any<'_>, options: &Options) -> PyResult<PyPlanReport> {
    let (hypotheses, sensor) = (hypotheses(given)?, sensor(with)?);
    let (settings, deadline) = (&options.settings, options.deadline());
    let (plan, late) = interruptible(py, |halt| {
        let late = std::cell::Cell::new(false);
        let plan = palpate::plan_until(&hypotheses, &sensor, settings, &|| {
            late.set(late.get() || deadline.late(halt));
            late.get()
        });
        (plan, late.get())
    })?;
    let plan = plan.map_err(raise)?;
    let path = plan.path.clone().map(|path| Py::new(py, PyPath::new(path, sensor.tip_radius))).transpose()?;
    let why = plan.why(&hypotheses, settings, late);
    Ok(PyPlanReport { plan, path, why })
}

#[doc = doc!("judge")]
#[pyfunction]
#[pyo3(
    signature = (hypotheses, sensor, start, direction, length=None, **options),
    text_signature = "(hypotheses, sensor, start, direction, length=None, *, features=None, avoid_assigned=False, margin=0.001, seed=0)"
)]
pub(crate) fn judge<'py>(
    py: Python<'py>,
    hypotheses: &Any<'py>,
    sensor: &Any<'py>,
    start: &Any<'py>,
    direction: &Any<'py>,
    length: Option<&Any<'py>>,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<PyPath> {
    let options = Options::read("judge", options, &[JUDGED])?;
    let (hypotheses, sensor) = (self::hypotheses(hypotheses)?, self::sensor(sensor)?);
    let line = Line { start: vector("start", start)?, direction: vector("direction", direction)? };
    let length = length.map(|length| number("length", length)).transpose()?;
    let path = py.detach(|| palpate::judge(&hypotheses, &sensor, line, length, &options.settings));
    Ok(PyPath::new(path.map_err(raise)?, sensor.tip_radius))
}

#[doc = doc!("verification_path")]
#[pyfunction]
#[pyo3(
    signature = (hypothesis, sensor, *, line=None, **options),
    text_signature = "(hypothesis, sensor, *, line=None, workspace=None, directions=None, time_limit=None, effort=None, features=None, margin=0.001, seed=0)"
)]
pub(crate) fn verification_path<'py>(
    py: Python<'py>,
    hypothesis: &Any<'py>,
    sensor: &Any<'py>,
    line: Option<&Any<'py>>,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Option<Py<PyPath>>> {
    let options = Options::read("verification_path", options, VERIFIED)?;
    let Some(line) = line else {
        return verified(py, hypothesis, sensor, &options).map(|report| report.path);
    };
    let (one, sensor, line) =
        (self::hypothesis(hypothesis)?, self::sensor(sensor)?, self::line("line", line)?);
    let path = py.detach(|| palpate::verification_along(&one, &sensor, line, &options.settings));
    path.map_err(raise)?.map(|path| Py::new(py, PyPath::new(path, sensor.tip_radius))).transpose()
}

#[doc = doc!("verification_report")]
#[pyfunction]
#[pyo3(
    signature = (hypothesis, sensor, **options),
    text_signature = "(hypothesis, sensor, *, workspace=None, directions=None, time_limit=None, effort=None, features=None, margin=0.001, seed=0)"
)]
pub(crate) fn verification_report<'py>(
    py: Python<'py>,
    hypothesis: &Any<'py>,
    sensor: &Any<'py>,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<PyPlanReport> {
    verified(py, hypothesis, sensor, &Options::read("verification_report", options, VERIFIED)?)
}

const VERIFIED: &[&[&str]] = &[PLACED, &["time_limit", "effort", "features", "margin", "seed"]];

fn verified(py: Python<'_>, given: &Any<'_>, with: &Any<'_>, options: &Options) -> PyResult<PyPlanReport> {
    let (one, sensor) = (hypothesis(given)?, sensor(with)?);
    let (settings, deadline) = (&options.settings, options.deadline());
    let found = interruptible(py, |halt| {
        palpate::verification_until(&one, &sensor, settings, &|| deadline.late(halt))
    })?;
    let Verification { path, why, num_judged } = found.map_err(raise)?;
    let plan = Plan { path, bound: 1.0, proved: false, num_judged, num_boxes: 0, counters: None };
    let path = plan.path.clone().map(|path| Py::new(py, PyPath::new(path, sensor.tip_radius))).transpose()?;
    Ok(PyPlanReport { plan, path, why })
}

#[doc = doc!("refuting_moves")]
#[pyfunction]
#[pyo3(signature = (hypotheses, moves))]
pub(crate) fn refuting_moves(
    py: Python<'_>,
    hypotheses: &Any<'_>,
    moves: &Any<'_>,
) -> PyResult<Vec<Option<usize>>> {
    let hypotheses = self::hypotheses(hypotheses)?;
    let listed = members("moves", moves, "moves", MOVE)?;
    let moves = listed
        .iter()
        .enumerate()
        .map(|(k, one)| guarded(&format!("moves[{k}]"), one))
        .collect::<PyResult<Vec<Move>>>()?;
    py.detach(|| palpate::refuting_moves(&hypotheses, &moves)).map_err(raise)
}

const MOVE: &str = "give (start, direction, length, sensor, contact or None)";

/// A guarded move, and what was met.
fn guarded(argument: &str, value: &Any<'_>) -> PyResult<Move> {
    let parts = members(argument, value, "a move", MOVE)?;
    let [start, direction, length, with, met] = parts.as_slice() else {
        return Err(refuse(argument, "must be a move and what it met", value, MOVE));
    };
    let met = if met.is_none() {
        None
    } else {
        let Ok(contact) = met.cast::<PyContact>() else {
            return Err(refuse(&format!("{argument}[4]"), "must be a Contact", met, MOVE));
        };
        let In::Plane(contact) = contact.get().0 else {
            return Err(refuse(&format!("{argument}[4]"), "must be a contact of the plane", met, MOVE));
        };
        Some((contact.center, contact.normal.map(|normal| normal.direction)))
    };
    let line = Line {
        start: vector(&format!("{argument}[0]"), start)?,
        direction: vector(&format!("{argument}[1]"), direction)?,
    };
    Ok(Move { line, length: number(&format!("{argument}[2]"), length)?, sensor: sensor(with)?, met })
}

#[pymethods]
impl PyPlanReport {
    #[doc = doc!("PlanReport.path")]
    #[getter]
    fn path(&self, py: Python<'_>) -> Option<Py<PyPath>> {
        self.path.as_ref().map(|path| path.clone_ref(py))
    }

    #[doc = doc!("PlanReport.bound")]
    #[getter]
    fn bound(&self) -> f64 {
        self.plan.bound
    }

    #[doc = doc!("PlanReport.proved")]
    #[getter]
    fn proved(&self) -> bool {
        self.plan.proved
    }

    #[doc = doc!("PlanReport.why")]
    #[getter]
    fn why(&self) -> &'static str {
        self.why.name()
    }

    #[doc = doc!("PlanReport.num_judged")]
    #[getter]
    fn num_judged(&self) -> u64 {
        self.plan.num_judged
    }

    #[doc = doc!("PlanReport.num_boxes")]
    #[getter]
    fn num_boxes(&self) -> u64 {
        self.plan.num_boxes
    }

    #[doc = doc!("PlanReport.counters")]
    #[getter]
    fn counters<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(found) = &self.plan.counters else { return Ok(None) };
        let counts = PyDict::new(py);
        for (name, count) in [
            ("unsensed", found.unsensed),
            ("sensed", found.sensed),
            ("inner_products", found.inner_products),
            ("predicted_inner_products", found.predicted_inner_products()),
            ("generators", found.generators),
            ("candidates", found.candidates),
            ("critical_points", found.critical_points),
            ("predicted_critical_points", found.predicted_critical_points()),
            ("critical_kept", found.critical_kept),
            ("overlaps", found.overlaps),
            ("paths", found.paths),
        ] {
            counts.set_item(name, count)?;
        }
        Ok(Some(counts))
    }

    fn __repr__(&self) -> String {
        let score = self.plan.path.as_ref().map_or_else(
            || "no path".to_owned(),
            |path| format!("score {:.4} of {}", path.score, path.outcomes.len()),
        );
        let proved = if self.plan.proved { "proved" } else { "not proved" };
        format!("<PlanReport: {}, {score}, {proved}>", self.why.name())
    }
}
