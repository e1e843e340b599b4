//! The next path.

use std::sync::atomic::Ordering::Relaxed;

use glam::{DVec2, DVec3};
use palpate::{Hypothesis, Line, Move, Plan, Sensor, Verification, Why};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::contact::PyContact;
use crate::convert::{members, number, raise, refuse, vector};
use crate::dimension::{AnyHypotheses, AnyHypothesis, AnyPlan, In, Vector};
use crate::hypothesis::PyHypothesis;
use crate::interrupt::{interruptible, interruptible_until};
use crate::options::{JUDGED, Options, PLACED, REMEMBERED, SEARCHED, line};
use crate::path::PyPath;
use crate::recognize::{all, sorted};
use crate::sensor::PySensor;

type Any<'py> = Bound<'py, PyAny>;

#[doc = doc!("PlanReport")]
#[pyclass(name = "PlanReport", module = "palpate._core", frozen)]
pub(crate) struct PyPlanReport {
    plan: AnyPlan,
    path: Option<Py<PyPath>>,
    why: Why,
}

/// Hypotheses of a recognition, all of the plane or all of space.
pub(crate) fn hypotheses(value: &Any<'_>) -> PyResult<AnyHypotheses> {
    let given = listed(value)?;
    match given.first().map(|one| &one.get().hypothesis) {
        Some(In::Space(_)) => Ok(In::Space(one_sided::<DVec3>(&given)?)),
        _ => Ok(In::Plane(one_sided::<DVec2>(&given)?)),
    }
}

fn one_sided<V: Vector>(given: &[Bound<'_, PyHypothesis>]) -> PyResult<Vec<Hypothesis<V>>> {
    sorted::<V, _, _, _>("hypotheses", "hypotheses", given, |one| &one.hypothesis)
}

/// Hypotheses of parts in the plane, for `what` works there only.
pub(crate) fn planar(what: &str, value: &Any<'_>) -> PyResult<Vec<Hypothesis>> {
    let of = |(k, one): (usize, &Bound<'_, PyHypothesis>)| match &one.get().hypothesis {
        In::Plane(hypothesis) => Ok(hypothesis.clone()),
        In::Space(_) => {
            let problem = format!("is of a part in space; {what} works in the plane only");
            let remedy = "give hypotheses of models of dimension 2";
            Err(refuse(&format!("hypotheses[{k}]"), &problem, one, remedy))
        }
    };
    listed(value)?.iter().enumerate().map(of).collect()
}

fn listed<'py>(value: &Any<'py>) -> PyResult<Vec<Bound<'py, PyHypothesis>>> {
    all("hypotheses", value, "Hypothesis", "give found.hypotheses of a recognition")
}

fn hypothesis(value: &Any<'_>) -> PyResult<AnyHypothesis> {
    match value.cast::<PyHypothesis>() {
        Ok(one) => Ok(one.get().hypothesis.clone()),
        Err(_) => Err(refuse("hypothesis", "must be a Hypothesis", value, "give one of found.hypotheses")),
    }
}

pub(crate) fn sensor(value: &Any<'_>) -> PyResult<Sensor> {
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
    planned(py, "plan", hypotheses, sensor, options).map(|report| report.path)
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
    planned(py, "plan_report", hypotheses, sensor, options)
}

type Given<'a, 'py> = Option<&'a Bound<'py, PyDict>>;

fn planned(
    py: Python<'_>,
    function: &str,
    hypotheses: &Any<'_>,
    sensor: &Any<'_>,
    options: Given<'_, '_>,
) -> PyResult<PyPlanReport> {
    either!(self::hypotheses(hypotheses)?, hypotheses => {
        planned_among(py, function, &hypotheses, self::sensor(sensor)?, options)
    })
}

fn planned_among<V: Vector>(
    py: Python<'_>,
    function: &str,
    hypotheses: &[Hypothesis<V>],
    sensor: Sensor,
    options: Given<'_, '_>,
) -> PyResult<PyPlanReport> {
    let options = Options::read(function, options, &[JUDGED, PLACED, SEARCHED, REMEMBERED])?;
    let (settings, deadline) = (&options.settings, options.deadline());
    let (plan, late) = interruptible_until(py, deadline, |halt| {
        let plan = palpate::plan_until(hypotheses, &sensor, settings, halt);
        (plan, halt.load(Relaxed))
    })?;
    let plan = plan.map_err(raise)?;
    let why = plan.why(hypotheses, settings, late);
    PyPlanReport::new(py, plan, why, sensor.tip_radius)
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
    let sensor = self::sensor(sensor)?;
    let path = likewise!(self::hypotheses(hypotheses)?, hypotheses => {
        let options = Options::read("judge", options, &[JUDGED])?;
        let line = Line { start: vector("start", start)?, direction: vector("direction", direction)? };
        let length = length.map(|length| number("length", length)).transpose()?;
        py.detach(|| palpate::judge(&hypotheses, &sensor, line, length, &options.settings)).map_err(raise)?
    });
    Ok(PyPath::new(path, sensor.tip_radius))
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
    let Some(line) = line else {
        return verified(py, "verification_path", hypothesis, sensor, options).map(|report| report.path);
    };
    let sensor = self::sensor(sensor)?;
    either!(self::hypothesis(hypothesis)?, one => along(py, &one, sensor, line, options))
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
    verified(py, "verification_report", hypothesis, sensor, options)
}

const VERIFIED: &[&[&str]] = &[PLACED, &["time_limit", "effort", "features", "margin", "seed"]];

/// The path of one line.
fn along<V: Vector>(
    py: Python<'_>,
    one: &Hypothesis<V>,
    sensor: Sensor,
    line: &Any<'_>,
    options: Given<'_, '_>,
) -> PyResult<Option<Py<PyPath>>> {
    let options = Options::read("verification_path", options, VERIFIED)?;
    let line = self::line("line", line)?;
    let path = py.detach(|| palpate::verification_along(one, &sensor, line, &options.settings));
    let path = path.map_err(raise)?.map(V::within);
    path.map(|path| Py::new(py, PyPath::new(path, sensor.tip_radius))).transpose()
}

fn verified(
    py: Python<'_>,
    function: &str,
    hypothesis: &Any<'_>,
    sensor: &Any<'_>,
    options: Given<'_, '_>,
) -> PyResult<PyPlanReport> {
    let sensor = self::sensor(sensor)?;
    either!(self::hypothesis(hypothesis)?, one => verified_for(py, function, &one, sensor, options))
}

fn verified_for<V: Vector>(
    py: Python<'_>,
    function: &str,
    one: &Hypothesis<V>,
    sensor: Sensor,
    options: Given<'_, '_>,
) -> PyResult<PyPlanReport> {
    let options = Options::read(function, options, VERIFIED)?;
    let (settings, deadline) = (&options.settings, options.deadline());
    let found = interruptible(py, |halt| {
        palpate::verification_until(one, &sensor, settings, &|| deadline.late(halt))
    })?;
    let Verification { path, why, num_judged } = found.map_err(raise)?;
    let plan = Plan { path, bound: 1.0, proved: false, num_judged, num_boxes: 0, counters: None };
    PyPlanReport::new(py, plan, why, sensor.tip_radius)
}

#[doc = doc!("refuting_moves")]
#[pyfunction]
#[pyo3(signature = (hypotheses, moves))]
pub(crate) fn refuting_moves(
    py: Python<'_>,
    hypotheses: &Any<'_>,
    moves: &Any<'_>,
) -> PyResult<Vec<Option<usize>>> {
    either!(self::hypotheses(hypotheses)?, hypotheses => refuting(py, &hypotheses, moves))
}

fn refuting<V: Vector>(
    py: Python<'_>,
    hypotheses: &[Hypothesis<V>],
    moves: &Any<'_>,
) -> PyResult<Vec<Option<usize>>> {
    let listed = members("moves", moves, "moves", MOVE)?;
    let made = listed.iter().enumerate().map(|(k, one)| guarded(&format!("moves[{k}]"), one));
    let moves = made.collect::<PyResult<Vec<Move<V>>>>()?;
    py.detach(|| palpate::refuting_moves(hypotheses, &moves)).map_err(raise)
}

const MOVE: &str = "give (start, direction, length, sensor, contact or None)";

/// A guarded move, and what was met.
fn guarded<V: Vector>(argument: &str, value: &Any<'_>) -> PyResult<Move<V>> {
    let parts = members(argument, value, "a move", MOVE)?;
    let [start, direction, length, with, met] = parts.as_slice() else {
        return Err(refuse(argument, "must be a move and what it met", value, MOVE));
    };
    let met = if met.is_none() {
        None
    } else {
        let refused = |problem: &str| refuse(&format!("{argument}[4]"), problem, met, MOVE);
        let contact = met.cast::<PyContact>().map_err(|_| refused("must be a Contact"))?;
        let Some(contact) = V::of(&contact.get().0) else {
            return Err(refused(&format!("must be a contact of {}", V::NAME)));
        };
        Some((contact.center, contact.normal.map(|normal| normal.direction)))
    };
    let line = Line {
        start: vector(&format!("{argument}[0]"), start)?,
        direction: vector(&format!("{argument}[1]"), direction)?,
    };
    Ok(Move { line, length: number(&format!("{argument}[2]"), length)?, sensor: sensor(with)?, met })
}

impl PyPlanReport {
    fn new<V: Vector>(py: Python<'_>, plan: Plan<V>, why: Why, tip_radius: f64) -> PyResult<Self> {
        let path = plan.path.clone().map(|path| PyPath::new(V::within(path), tip_radius));
        Ok(Self { plan: V::within(plan), path: path.map(|path| Py::new(py, path)).transpose()?, why })
    }
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
        either!(&self.plan, plan => plan.bound)
    }

    #[doc = doc!("PlanReport.proved")]
    #[getter]
    fn proved(&self) -> bool {
        either!(&self.plan, plan => plan.proved)
    }

    #[doc = doc!("PlanReport.why")]
    #[getter]
    fn why(&self) -> &'static str {
        self.why.name()
    }

    #[doc = doc!("PlanReport.num_judged")]
    #[getter]
    fn num_judged(&self) -> u64 {
        either!(&self.plan, plan => plan.num_judged)
    }

    #[doc = doc!("PlanReport.num_boxes")]
    #[getter]
    fn num_boxes(&self) -> u64 {
        either!(&self.plan, plan => plan.num_boxes)
    }

    #[doc = doc!("PlanReport.counters")]
    #[getter]
    fn counters<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(found) = either!(&self.plan, plan => plan.counters) else { return Ok(None) };
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
        let told = either!(&self.plan, plan => {
            plan.path.as_ref().map(|path| format!("score {:.4} of {}", path.score, path.outcomes.len()))
        });
        let told = told.unwrap_or_else(|| "no path".to_owned());
        let proved = if self.proved() { "proved" } else { "not proved" };
        format!("<PlanReport: {}, {told}, {proved}>", self.why.name())
    }
}
