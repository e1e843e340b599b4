//! Paths and what they would tell.

use std::sync::Arc;

use numpy::PyArray1;
use palpate::judge::Normals;
use palpate::{Fault, Path, Reading, Touch};
use pyo3::prelude::*;

use crate::contact::PyContact;
use crate::convert::{decimal, decimals, plane_only, refuse, vector_array};
use crate::dimension::{AnyOutcome, AnyPath, AnyTouch, In, Vector};

type Any<'py> = Bound<'py, PyAny>;

/// Numbers of the hypotheses that a path is about: its own numbers are places among them.
type Members = Arc<Vec<usize>>;

#[doc = doc!("Path")]
#[pyclass(name = "Path", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyPath {
    path: AnyPath,
    members: Members,
    tip_radius: f64,
}

#[doc = doc!("Outcome")]
#[pyclass(name = "Outcome", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyOutcome {
    outcome: AnyOutcome,
    hypothesis: usize,
}

#[doc = doc!("Touch")]
#[pyclass(name = "Touch", module = "palpate._core", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyTouch(AnyTouch);

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
    pub(crate) fn among(path: AnyPath, members: Vec<usize>, tip_radius: f64) -> Self {
        Self { path, members: Arc::new(members), tip_radius }
    }

    /// A path among all hypotheses.
    pub(crate) fn new(path: AnyPath, tip_radius: f64) -> Self {
        let members = (0..either!(&path, path => path.outcomes.len())).collect();
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
        either!(&self.path, path => vector_array(py, path.line.start))
    }

    #[doc = doc!("Path.direction")]
    #[getter]
    fn direction<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        either!(&self.path, path => vector_array(py, path.line.direction))
    }

    #[doc = doc!("Path.length")]
    #[getter]
    fn length(&self) -> f64 {
        either!(&self.path, path => path.length)
    }

    #[doc = doc!("Path.end")]
    #[getter]
    fn end<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        either!(&self.path, path => vector_array(py, path.line.at(path.length)))
    }

    #[doc = doc!("Path.margin")]
    #[getter]
    fn margin(&self) -> f64 {
        either!(&self.path, path => path.margin)
    }

    #[doc = doc!("Path.score")]
    #[getter]
    fn score(&self) -> f64 {
        either!(&self.path, path => path.score)
    }

    #[doc = doc!("Path.expected_score")]
    #[getter]
    fn expected_score(&self) -> f64 {
        either!(&self.path, path => path.expected_score)
    }

    #[doc = doc!("Path.guaranteed")]
    #[getter]
    fn guaranteed(&self) -> bool {
        either!(&self.path, path => path.guaranteed())
    }

    #[doc = doc!("Path.members")]
    #[getter]
    fn members(&self) -> Vec<usize> {
        self.members.to_vec()
    }

    #[doc = doc!("Path.classes")]
    #[getter]
    fn classes(&self) -> Vec<Vec<usize>> {
        either!(&self.path, path => &path.classes).iter().map(|class| self.numbers(class)).collect()
    }

    #[doc = doc!("Path.no_contact")]
    #[getter]
    fn no_contact(&self) -> Vec<usize> {
        self.numbers(either!(&self.path, path => &path.no_contact))
    }

    #[doc = doc!("Path.outcomes")]
    #[getter]
    fn outcomes(&self) -> Vec<PyOutcome> {
        either!(&self.path, path => self.outcomes_of(path))
    }

    #[doc = doc!("Path.fault")]
    #[getter]
    fn fault(&self) -> Option<(usize, &'static str)> {
        let fault = either!(&self.path, path => path.fault);
        fault.map(|(place, fault)| (self.members[place], fault_name(fault)))
    }

    #[doc = doc!("Path.faults")]
    #[getter]
    fn faults(&self) -> Vec<(usize, &'static str)> {
        self.outcomes().iter().filter_map(|one| Some((one.hypothesis, one.fault()?))).collect()
    }

    #[doc = doc!("Path.outcome_of")]
    #[pyo3(signature = (contact))]
    fn outcome_of(&self, contact: &Any<'_>) -> PyResult<Vec<usize>> {
        either!(&self.path, path => {
            let reading = if contact.is_none() { None } else { Some(self.reading(path, contact)?) };
            Ok(self.numbers(&path.outcome_of(reading)))
        })
    }

    fn __repr__(&self) -> String {
        either!(&self.path, path => self.shown(path))
    }
}

impl PyPath {
    fn outcomes_of<V: Vector>(&self, path: &Path<V>) -> Vec<PyOutcome> {
        let outcomes = path.outcomes.iter().map(|outcome| V::within(outcome.clone()));
        outcomes.zip(self.members.iter()).map(|(outcome, k)| PyOutcome { outcome, hypothesis: *k }).collect()
    }

    /// A contact as the path may have met it.
    fn reading<V: Vector>(&self, path: &Path<V>, given: &Any<'_>) -> PyResult<Reading<V>> {
        let Ok(contact) = given.cast::<PyContact>() else {
            return Err(refuse(
                "contact",
                "must be a Contact",
                given,
                "give palpate.Contact, or None for a miss",
            ));
        };
        let Some(contact) = V::of(&contact.get().0) else {
            let problem = format!("is of {}; the path is of {}", V::OTHER, V::NAME);
            let remedy = format!("give a contact of {} coordinates", V::DIMENSION);
            return Err(refuse("contact", &problem, given, &remedy));
        };
        if contact.tip_radius != self.tip_radius {
            let problem = format!("must have the sensor's tip radius {:?}", self.tip_radius);
            let remedy = "make it with Contact.from_tip and that radius";
            return Err(refuse("contact", &problem, given, remedy));
        }
        Ok(path.reading(contact.center, contact.normal.map(|normal| normal.direction)))
    }

    fn shown<V: Vector>(&self, path: &Path<V>) -> String {
        let told = match path.fault {
            Some((_, fault)) => format!("can't be used: {}", fault_name(fault)),
            None => format!("score {:.4} of {}", path.score, self.members.len()),
        };
        let rounded = |vector: V, digits: usize| {
            let coordinates: Vec<String> =
                vector.coordinates().iter().map(|one| decimal(*one, digits)).collect();
            format!("({})", coordinates.join(", "))
        };
        let way = match path.line.direction.angle() {
            Some(angle) => format!("at {}°", decimal(angle.to_degrees(), 3)),
            None => format!("along {}", rounded(path.line.direction, 6)),
        };
        format!("<Path from {} {way}, {told}>", rounded(path.line.start, decimals(path.length)))
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
        either!(&self.outcome, outcome => touches(&outcome.touches))
    }

    #[doc = doc!("Outcome.may_miss")]
    #[getter]
    fn may_miss(&self) -> bool {
        either!(&self.outcome, outcome => outcome.may_miss)
    }

    #[doc = doc!("Outcome.fault")]
    #[getter]
    fn fault(&self) -> Option<&'static str> {
        either!(&self.outcome, outcome => outcome.fault).map(fault_name)
    }

    fn __repr__(&self) -> String {
        let mut answers: Vec<String> = self.touches().iter().map(PyTouch::described).collect();
        if self.may_miss() {
            answers.push("a miss".to_owned());
        }
        if let Some(fault) = self.fault() {
            answers.push(format!("fault {fault}"));
        }
        format!("<Outcome of {}: {}>", self.hypothesis, answers.join(", "))
    }
}

fn touches<V: Vector>(touches: &[Touch<V>]) -> Vec<PyTouch> {
    touches.iter().map(|touch| PyTouch(V::within(*touch))).collect()
}

#[pymethods]
impl PyTouch {
    #[doc = doc!("Touch.feature")]
    #[getter]
    fn feature(&self) -> (&'static str, u32) {
        let feature = either!(&self.0, touch => touch.feature);
        (feature.kind(), feature.number())
    }

    #[doc = doc!("Touch.depth")]
    #[getter]
    fn depth(&self) -> (f64, f64) {
        let depth = either!(&self.0, touch => touch.depth);
        (depth.low, depth.high)
    }

    #[doc = doc!("Touch.normals")]
    #[getter]
    fn normals(&self) -> PyResult<(f64, f64)> {
        match &self.0 {
            In::Plane(touch) => Ok((touch.normals.start, touch.normals.start + touch.normals.width)),
            In::Space(_) => Err(plane_only("normals", "a touch in space", "ask for normal_cap")),
        }
    }

    #[doc = doc!("Touch.normal_cap")]
    #[getter]
    fn normal_cap<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray1<f64>>, f64)> {
        either!(&self.0, touch => {
            let (axis, angle) = touch.normals.cap();
            Ok((vector_array(py, axis)?, angle))
        })
    }

    fn __repr__(&self) -> String {
        format!("<Touch: {}>", self.described())
    }
}

impl PyTouch {
    fn described(&self) -> String {
        let ((kind, number), (low, high)) = (self.feature(), self.depth());
        let [low, high] = [low, high].map(|depth| decimal(depth, decimals(depth)));
        format!("{kind} {number} at depth {low} to {high}")
    }
}
