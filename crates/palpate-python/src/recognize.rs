//! Recognition and its answer.

use std::sync::{Arc, OnceLock};

use palpate::plane::Model;
use palpate::{Count, Error, Evidence, ModelReport, Recognition, Settings};
use pyo3::PyClass;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::contact::PyContact;
use crate::convert::{members, number, raise, refuse, text, whole};
use crate::evidence::{PyMiss, PyPrior};
use crate::hypothesis::PyHypothesis;
use crate::interpretations::PyInterpretations;
use crate::interrupt::interruptible;
use crate::model::PyModel;

type Any<'py> = Bound<'py, PyAny>;

#[doc = doc!("Recognition")]
#[pyclass(name = "Recognition", module = "palpate._core", frozen)]
pub(crate) struct PyRecognition {
    found: Recognition,
    hypotheses: Vec<Py<PyHypothesis>>,
    count: OnceLock<Count>,
}

#[doc = doc!("recognize")]
#[pyfunction]
#[pyo3(
    signature = (models, contacts, *, features=None, misses=None, prior=None, tolerance=None, max_hypotheses=None),
    text_signature = "(models, contacts, *, features=None, misses=(), prior=None, tolerance=1e-06, max_hypotheses=1000)"
)]
#[expect(clippy::too_many_arguments, reason = "Python's keyword arguments")]
pub(crate) fn recognize(
    py: Python<'_>,
    models: &Any<'_>,
    contacts: &Any<'_>,
    features: Option<&Any<'_>>,
    misses: Option<&Any<'_>>,
    prior: Option<&Any<'_>>,
    tolerance: Option<&Any<'_>>,
    max_hypotheses: Option<&Any<'_>>,
) -> PyResult<PyRecognition> {
    let parts = all::<PyModel>("models", models, "Model", "give a list, as load_models does")?;
    let evidence = Evidence {
        contacts: all::<PyContact>("contacts", contacts, "Contact", "give a list of palpate.Contact")?
            .iter()
            .map(|contact| contact.get().0)
            .collect(),
        misses: misses
            .map_or(Ok(Vec::new()), |misses| {
                all::<PyMiss>("misses", misses, "Miss", "give a list of palpate.Miss")
            })?
            .iter()
            .map(|miss| miss.get().0)
            .collect(),
        prior: prior.map(one_prior).transpose()?,
    };
    let settings = settings(features, tolerance, max_hypotheses)?;
    let models: Vec<Arc<Model>> = parts.iter().map(|part| Arc::clone(&part.get().model)).collect();
    let found = interruptible(py, |halt| palpate::recognize_until(&models, &evidence, &settings, halt))?
        .map_err(raise)?;
    PyRecognition::new(py, found, &parts)
}

/// What is given stands in the place of the core's defaults.
fn settings(
    features: Option<&Any<'_>>,
    tolerance: Option<&Any<'_>>,
    max_hypotheses: Option<&Any<'_>>,
) -> PyResult<Settings> {
    let mut settings = Settings::default();
    if let Some(features) = features {
        let kinds = kinds(features)?;
        settings.faces = kinds.iter().any(|kind| kind == "face");
        settings.vertices = Some(kinds.iter().any(|kind| kind == "vertex"));
    }
    if let Some(tolerance) = tolerance {
        settings.tolerance = number("tolerance", tolerance)?;
    }
    if let Some(count) = max_hypotheses {
        settings.max_hypotheses = whole("max_hypotheses", count, 1)? as usize;
    }
    Ok(settings)
}

/// Names of kinds of features.
pub(crate) fn kinds(features: &Any<'_>) -> PyResult<Vec<String>> {
    const REMEDY: &str = "give (\"face\",), (\"vertex\",) or (\"face\", \"vertex\")";
    let given = members("features", features, "names", REMEDY)?;
    let kinds: Vec<String> = given
        .iter()
        .enumerate()
        .map(|(k, kind)| text(&format!("features[{k}]"), kind))
        .collect::<PyResult<_>>()?;
    for kind in &kinds {
        match kind.as_str() {
            "face" | "vertex" => {}
            "edge" => return Err(raise(Error::new("features", "no edges in the plane", "'edge'", REMEDY))),
            _ => return Err(raise(Error::new("features", "unknown kind", format!("'{kind}'"), REMEDY))),
        }
    }
    Ok(kinds)
}

fn one_prior(prior: &Any<'_>) -> PyResult<palpate::Prior> {
    match prior.cast::<PyPrior>() {
        Ok(prior) => Ok(prior.get().0),
        Err(_) => Err(refuse("prior", "must be a Prior", prior, "give palpate.Prior, or leave it out")),
    }
}

/// The members of a sequence, all of one class.
pub(crate) fn all<'py, T: PyClass>(
    argument: &str,
    value: &Any<'py>,
    class: &str,
    remedy: &str,
) -> PyResult<Vec<Bound<'py, T>>> {
    let cast = |(k, member): (usize, Any<'py>)| {
        let problem = format!("must be a {class}");
        member
            .cast_into::<T>()
            .map_err(|error| refuse(&format!("{argument}[{k}]"), &problem, &error.into_inner(), remedy))
    };
    members(argument, value, class, remedy)?.into_iter().enumerate().map(cast).collect()
}

impl PyRecognition {
    fn new(py: Python<'_>, found: Recognition, parts: &[Bound<'_, PyModel>]) -> PyResult<Self> {
        let hypotheses = found.hypotheses.iter().map(|hypothesis| {
            let model = parts[hypothesis.model_number].clone().unbind();
            Py::new(py, PyHypothesis::new(hypothesis.clone(), model))
        });
        let hypotheses = hypotheses.collect::<PyResult<_>>()?;
        Ok(Self { found, hypotheses, count: OnceLock::new() })
    }

    fn count(&self, py: Python<'_>) -> Count {
        py.detach(|| *self.count.get_or_init(|| self.found.interpretation_count()))
    }
}

#[pymethods]
impl PyRecognition {
    #[doc = doc!("Recognition.hypotheses")]
    #[getter]
    fn hypotheses(&self, py: Python<'_>) -> Vec<Py<PyHypothesis>> {
        self.hypotheses.iter().map(|hypothesis| hypothesis.clone_ref(py)).collect()
    }

    #[doc = doc!("Recognition.interpretations")]
    #[getter]
    fn interpretations(&self, py: Python<'_>) -> PyInterpretations {
        PyInterpretations::new(self.hypotheses(py))
    }

    #[doc = doc!("Recognition.interpretation_count")]
    #[getter]
    fn interpretation_count(&self, py: Python<'_>) -> u64 {
        self.count(py).at_least
    }

    #[doc = doc!("Recognition.interpretation_count_exact")]
    #[getter]
    fn interpretation_count_exact(&self, py: Python<'_>) -> bool {
        self.count(py).exact
    }

    #[doc = doc!("Recognition.conflict")]
    #[getter]
    fn conflict(&self) -> Option<Vec<usize>> {
        self.found.conflict.clone()
    }

    #[doc = doc!("Recognition.complete")]
    #[getter]
    fn complete(&self) -> bool {
        self.found.complete
    }

    #[doc = doc!("Recognition.counters")]
    #[getter]
    fn counters<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.found.reports.iter().map(|report| counters(py, report)).collect()
    }

    fn __repr__(&self) -> String {
        let more = if self.found.complete { "" } else { " of more" };
        match &self.found.conflict {
            Some(contacts) => format!("<Recognition: no hypothesis, contacts {contacts:?} in conflict>"),
            None => format!("<Recognition: {} hypotheses{more}>", self.hypotheses.len()),
        }
    }
}

/// What was done for one model.
fn counters<'py>(py: Python<'py>, report: &ModelReport) -> PyResult<Bound<'py, PyDict>> {
    let counts = PyDict::new(py);
    for (name, count) in [
        ("nodes", report.counters.nodes),
        ("pruned_by_distance", report.counters.pruned_by_distance),
        ("pruned_by_angle", report.counters.pruned_by_angle),
        ("pruned_by_direction", report.counters.pruned_by_direction),
        ("feasible", report.counters.feasible),
        ("pose_boxes", report.num_boxes),
        ("hypotheses", report.num_hypotheses as u64),
    ] {
        counts.set_item(name, count)?;
    }
    Ok(counts)
}
