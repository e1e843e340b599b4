//! Paths and what they would tell.

use std::sync::Arc;

use glam::DVec2;
use numpy::PyArray1;
use palpate::{Fault, Outcome, Path, Touch};
use pyo3::prelude::*;

use crate::contact::PyContact;
use crate::convert::{decimal, decimals, refuse, vector_array};
use crate::dimension::In;

type Any<'py> = Bound<'py, PyAny>;

/// Numbers of the hypotheses that a path is about: its own numbers are places among them.
type Members = Arc<Vec<usize>>;

#[doc = doc!("Path")]
#[pyclass(name = "Path", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyPath {
    path: Path,
    members: Members,
    tip_radius: f64,
}

#[doc = doc!("Outcome")]
#[pyclass(name = "Outcome", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyOutcome {
    outcome: Outcome,
    hypothesis: usize,
}

#[doc = doc!("Touch")]
#[pyclass(name = "Touch", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyTouch(Touch);

fn fault_name(fault: Fault) -> &'static str {
    match fault {
        Fault::Start => "start",
        Fault::Skid => "skid",
        Fault::Untouchable => "untouchable",
        Fault::Kind => "kind",
        Fault::Assigned => "assigned",
        Fault::Stem => "stem",
    }
}

impl PyPath {
    /// A path among the members.
    pub(crate) fn among(path: Path, members: Vec<usize>, tip_radius: f64) -> Self {
        Self { path, members: Arc::new(members), tip_radius }
    }

    /// A path among all hypotheses.
    pub(crate) fn new(path: Path, tip_radius: f64) -> Self {
        let members = (0..path.outcomes.len()).collect();
        Self::among(path, members, tip_radius)
    }

    fn numbers(&self, places: &[usize]) -> Vec<usize> {
        places.iter().map(|place| self.members[*place]).collect()
    }
}

#[pymethods]
impl PyPath {
    #[doc = doc!("Path.start")]
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        vector_array(py, self.path.line.start)
    }

    #[doc = doc!("Path.direction")]
    #[getter]
    fn direction<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        vector_array(py, self.path.line.direction)
    }

    #[doc = doc!("Path.length")]
    #[getter]
    fn length(&self) -> f64 {
        self.path.length
    }

    #[doc = doc!("Path.end")]
    #[getter]
    fn end<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        vector_array(py, self.path.line.at(self.path.length))
    }

    #[doc = doc!("Path.margin")]
    #[getter]
    fn margin(&self) -> f64 {
        self.path.margin
    }

    #[doc = doc!("Path.score")]
    #[getter]
    fn score(&self) -> f64 {
        self.path.score
    }

    #[doc = doc!("Path.expected_score")]
    #[getter]
    fn expected_score(&self) -> f64 {
        self.path.expected_score
    }

    #[doc = doc!("Path.guaranteed")]
    #[getter]
    fn guaranteed(&self) -> bool {
        self.path.guaranteed()
    }

    #[doc = doc!("Path.members")]
    #[getter]
    fn members(&self) -> Vec<usize> {
        self.members.to_vec()
    }

    #[doc = doc!("Path.classes")]
    #[getter]
    fn classes(&self) -> Vec<Vec<usize>> {
        self.path.classes.iter().map(|class| self.numbers(class)).collect()
    }

    #[doc = doc!("Path.no_contact")]
    #[getter]
    fn no_contact(&self) -> Vec<usize> {
        self.numbers(&self.path.no_contact)
    }

    #[doc = doc!("Path.outcomes")]
    #[getter]
    fn outcomes(&self) -> Vec<PyOutcome> {
        let of = |(outcome, hypothesis): (&Outcome, &usize)| PyOutcome {
            outcome: outcome.clone(),
            hypothesis: *hypothesis,
        };
        self.path.outcomes.iter().zip(self.members.iter()).map(of).collect()
    }

    #[doc = doc!("Path.fault")]
    #[getter]
    fn fault(&self) -> Option<(usize, &'static str)> {
        self.path.fault.map(|(place, fault)| (self.members[place], fault_name(fault)))
    }

    #[doc = doc!("Path.faults")]
    #[getter]
    fn faults(&self) -> Vec<(usize, &'static str)> {
        let named = |(outcome, member): (&Outcome, &usize)| Some((*member, fault_name(outcome.fault?)));
        self.path.outcomes.iter().zip(self.members.iter()).filter_map(named).collect()
    }

    #[doc = doc!("Path.outcome_of")]
    #[pyo3(signature = (contact))]
    fn outcome_of(&self, contact: &Any<'_>) -> PyResult<Vec<usize>> {
        let reading = if contact.is_none() { None } else { Some(self.contact(contact)?) };
        let reading = reading.map(|(center, normal)| self.path.reading(center, normal));
        Ok(self.numbers(&self.path.outcome_of(reading)))
    }

    fn __repr__(&self) -> String {
        let (start, angle) = (self.path.line.start, self.path.line.direction.to_angle().to_degrees());
        let [x, y] = start.to_array().map(|length| decimal(length, decimals(self.path.length)));
        let (score, n) = (self.path.score, self.members.len());
        let told = match self.path.fault {
            Some((_, fault)) => format!("can't be used: {}", fault_name(fault)),
            None => format!("score {score:.4} of {n}"),
        };
        format!("<Path from ({x}, {y}) at {}°, {told}>", decimal(angle, 3))
    }
}

impl PyPath {
    /// Centre and normal of a contact that the path may have met.
    fn contact(&self, given: &Any<'_>) -> PyResult<(DVec2, Option<DVec2>)> {
        let Ok(contact) = given.cast::<PyContact>() else {
            return Err(refuse(
                "contact",
                "must be a Contact",
                given,
                "give palpate.Contact, or None for a miss",
            ));
        };
        let In::Plane(contact) = contact.get().0 else {
            let problem = "is of space; the path is of the plane";
            return Err(refuse("contact", problem, given, "give a contact of 2 coordinates"));
        };
        if contact.tip_radius != self.tip_radius {
            let problem = format!("must have the sensor's tip radius {:?}", self.tip_radius);
            let remedy = "make it with Contact.from_tip and that radius";
            return Err(refuse("contact", &problem, given, remedy));
        }
        Ok((contact.center, contact.normal.map(|normal| normal.direction)))
    }
}

#[pymethods]
impl PyOutcome {
    #[doc = doc!("Outcome.hypothesis")]
    #[getter]
    fn hypothesis(&self) -> usize {
        self.hypothesis
    }

    #[doc = doc!("Outcome.touches")]
    #[getter]
    fn touches(&self) -> Vec<PyTouch> {
        self.outcome.touches.iter().copied().map(PyTouch).collect()
    }

    #[doc = doc!("Outcome.may_miss")]
    #[getter]
    fn may_miss(&self) -> bool {
        self.outcome.may_miss
    }

    #[doc = doc!("Outcome.fault")]
    #[getter]
    fn fault(&self) -> Option<&'static str> {
        self.outcome.fault.map(fault_name)
    }

    fn __repr__(&self) -> String {
        let mut answers: Vec<String> = self.outcome.touches.iter().map(|touch| described(*touch)).collect();
        if self.outcome.may_miss {
            answers.push("a miss".to_owned());
        }
        if let Some(fault) = self.outcome.fault {
            answers.push(format!("fault {}", fault_name(fault)));
        }
        format!("<Outcome of {}: {}>", self.hypothesis, answers.join(", "))
    }
}

fn described(touch: Touch) -> String {
    let (kind, number) = (touch.feature.kind(), touch.feature.number());
    let [low, high] = [touch.depth.low, touch.depth.high].map(|depth| decimal(depth, decimals(depth)));
    format!("{kind} {number} at depth {low} to {high}")
}

#[pymethods]
impl PyTouch {
    #[doc = doc!("Touch.feature")]
    #[getter]
    fn feature(&self) -> (&'static str, u32) {
        (self.0.feature.kind(), self.0.feature.number())
    }

    #[doc = doc!("Touch.depth")]
    #[getter]
    fn depth(&self) -> (f64, f64) {
        (self.0.depth.low, self.0.depth.high)
    }

    #[doc = doc!("Touch.normals")]
    #[getter]
    fn normals(&self) -> (f64, f64) {
        (self.0.normals.start, self.0.normals.start + self.0.normals.width)
    }

    fn __repr__(&self) -> String {
        format!("<Touch: {}>", described(self.0))
    }
}
