//! Recognition and its answer.

use std::sync::OnceLock;

use glam::{DVec2, DVec3};
use palpate::{Count, Error, Evidence, Limit, ModelReport, Recognition, Settings};
use pyo3::PyClass;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::contact::PyContact;
use crate::convert::{members, number, raise, refuse, text, whole};
use crate::dimension::{AnyRecognition, In, Side, Vector};
use crate::evidence::{PyMiss, PyPrior};
use crate::hypothesis::PyHypothesis;
use crate::interpretations::PyInterpretations;
use crate::interrupt::interruptible_until;
use crate::model::PyModel;
use crate::options::{Deadline, time_limit as seconds};

type Any<'py> = Bound<'py, PyAny>;

#[doc = doc!("Recognition")]
#[pyclass(name = "Recognition", module = "palpate._core", frozen)]
pub(crate) struct PyRecognition {
    found: AnyRecognition,
    hypotheses: Vec<Py<PyHypothesis>>,
    count: OnceLock<Count>,
}

#[doc = doc!("recognize")]
#[pyfunction]
#[pyo3(
    signature = (models, contacts, *, features=None, misses=None, prior=None, tolerance=None, max_hypotheses=None, time_limit=None, effort=None),
    text_signature = "(models, contacts, *, features=None, misses=(), prior=None, tolerance=1e-06, max_hypotheses=1000, time_limit=None, effort=None)"
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
    time_limit: Option<&Any<'_>>,
    effort: Option<&Any<'_>>,
) -> PyResult<PyRecognition> {
    let deadline = Deadline::after(time_limit.map(seconds).transpose()?);
    let given = Given {
        models: all("models", models, "Model", "give a list, as load_models does")?,
        contacts: all("contacts", contacts, "Contact", "give a list of palpate.Contact")?,
        misses: misses
            .map_or(Ok(Vec::new()), |misses| all("misses", misses, "Miss", "give a list of palpate.Miss"))?,
        prior: prior.map(one_prior).transpose()?,
    };
    let in_space = given.dimension() == DVec3::DIMENSION;
    let mut settings = settings(features, in_space, tolerance, max_hypotheses)?;
    settings.effort = effort.map(|effort| whole("effort", effort, 1)).transpose()?;
    if in_space {
        given.recognize::<DVec3>(py, &settings, deadline)
    } else {
        given.recognize::<DVec2>(py, &settings, deadline)
    }
}

/// Those whose first says whether all is of the plane or of space.
const FIRST: &str = "models";

/// What is to be recognized, of the plane or of space.
struct Given<'py> {
    models: Vec<Bound<'py, PyModel>>,
    contacts: Vec<Bound<'py, PyContact>>,
    misses: Vec<Bound<'py, PyMiss>>,
    prior: Option<Bound<'py, PyPrior>>,
}

impl Given<'_> {
    /// That of the models; without any, that of the contacts.
    fn dimension(&self) -> usize {
        let of_models = self.models.first().map(|model| model.get().model.dimension());
        let of_contacts = || self.contacts.first().map(|contact| contact.get().0.dimension());
        of_models.or_else(of_contacts).unwrap_or(DVec2::DIMENSION)
    }

    /// All of one dimension: that of the first.
    fn check_models<V: Vector>(&self) -> PyResult<()> {
        let part = |model: &Bound<'_, PyModel>| {
            let name = either!(&model.get().model, model => model.name.clone());
            (name, model.get().model.dimension())
        };
        for (k, model) in self.models.iter().enumerate() {
            let (name, dimension) = part(model);
            if dimension != V::DIMENSION {
                let (first, of_first) = part(&self.models[0]);
                let problem = format!(
                    "{name:?} is of dimension {dimension}, the first of the models, {first:?}, of dimension {of_first}"
                );
                let remedy = "don't mix the plane and space";
                return Err(refuse(&format!("models[{k}]"), &problem, model.as_any(), remedy));
            }
        }
        Ok(())
    }

    fn recognize<V: Vector>(
        &self,
        py: Python<'_>,
        settings: &Settings,
        deadline: Deadline,
    ) -> PyResult<PyRecognition> {
        self.check_models::<V>()?;
        let models = sorted::<V, _, _, _>("models", FIRST, &self.models, |one| &one.model)?;
        let evidence = Evidence::<V> {
            contacts: sorted::<V, _, _, _>("contacts", FIRST, &self.contacts, |one| &one.0)?,
            misses: sorted::<V, _, _, _>("misses", FIRST, &self.misses, |one| &one.0)?,
            prior: self
                .prior
                .as_ref()
                .map(|prior| of::<V, _, _, _>("prior", FIRST, prior, |one| &one.0))
                .transpose()?,
        };
        let found = interruptible_until(py, deadline, |halt| {
            palpate::recognize_until(&models, &evidence, settings, halt)
        })?
        .map_err(raise)?;
        PyRecognition::new(py, found, &self.models)
    }
}

/// What each of the objects holds, all of the dimension of the first of some.
pub(crate) fn sorted<V, T, P, S>(
    argument: &str,
    first: &str,
    given: &[Bound<'_, T>],
    held: impl Fn(&T) -> &In<P, S>,
) -> PyResult<Vec<<V as Side<P, S>>::One>>
where
    V: Vector + Side<P, S, One: Clone>,
    T: PyClass<Frozen = pyo3::pyclass::boolean_struct::True> + Sync,
{
    let one =
        |(k, one): (usize, &Bound<'_, T>)| of::<V, _, _, _>(&format!("{argument}[{k}]"), first, one, &held);
    given.iter().enumerate().map(one).collect()
}

/// What an object holds, if it is of the dimension.
fn of<V, T, P, S>(
    argument: &str,
    first: &str,
    given: &Bound<'_, T>,
    held: impl Fn(&T) -> &In<P, S>,
) -> PyResult<<V as Side<P, S>>::One>
where
    V: Vector + Side<P, S, One: Clone>,
    T: PyClass<Frozen = pyo3::pyclass::boolean_struct::True> + Sync,
{
    let complain = || {
        let other = DVec2::DIMENSION + DVec3::DIMENSION - V::DIMENSION;
        let problem =
            format!("is of dimension {other}, the first of the {first} of dimension {}", V::DIMENSION);
        refuse(argument, &problem, given.as_any(), "don't mix the plane and space")
    };
    <V as Side<P, S>>::of(held(given.get())).cloned().ok_or_else(complain)
}

/// What is given stands in the place of the core's defaults.
fn settings(
    features: Option<&Any<'_>>,
    in_space: bool,
    tolerance: Option<&Any<'_>>,
    max_hypotheses: Option<&Any<'_>>,
) -> PyResult<Settings> {
    let mut settings = Settings::default();
    if let Some(features) = features {
        let kinds = kinds(features, in_space)?;
        let named = |name: &str| kinds.iter().any(|kind| kind == name);
        settings.faces = named("face");
        settings.edges = Some(named("edge"));
        settings.vertices = Some(named("vertex"));
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
pub(crate) fn kinds(features: &Any<'_>, in_space: bool) -> PyResult<Vec<String>> {
    let remedy = if in_space {
        "give some of (\"face\", \"edge\", \"vertex\")"
    } else {
        "give (\"face\",), (\"vertex\",) or (\"face\", \"vertex\")"
    };
    let given = members("features", features, "names", remedy)?;
    let kinds: Vec<String> = given
        .iter()
        .enumerate()
        .map(|(k, kind)| text(&format!("features[{k}]"), kind))
        .collect::<PyResult<_>>()?;
    if kinds.is_empty() {
        return Err(raise(Error::new("features", "must not be empty", "()", remedy)));
    }
    for kind in &kinds {
        match kind.as_str() {
            "face" | "vertex" => {}
            "edge" if in_space => {}
            "edge" => return Err(raise(Error::new("features", "no edges in the plane", "'edge'", remedy))),
            _ => return Err(raise(Error::new("features", "unknown kind", format!("'{kind}'"), remedy))),
        }
    }
    Ok(kinds)
}

fn one_prior<'py>(prior: &Any<'py>) -> PyResult<Bound<'py, PyPrior>> {
    let complain = |_| refuse("prior", "must be a Prior", prior, "give palpate.Prior, or leave it out");
    prior.cast::<PyPrior>().cloned().map_err(complain)
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
    fn new<V: Vector>(py: Python<'_>, found: Recognition<V>, parts: &[Bound<'_, PyModel>]) -> PyResult<Self> {
        let hypotheses = found.hypotheses.iter().map(|hypothesis| {
            let model = parts[hypothesis.model_number].clone().unbind();
            Py::new(py, PyHypothesis::new(V::within(hypothesis.clone()), model))
        });
        let hypotheses = hypotheses.collect::<PyResult<_>>()?;
        Ok(Self { found: V::within(found), hypotheses, count: OnceLock::new() })
    }

    fn count(&self, py: Python<'_>) -> Count {
        py.detach(|| *self.count.get_or_init(|| either!(&self.found, found => found.interpretation_count())))
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
        either!(&self.found, found => found.conflict.clone())
    }

    #[doc = doc!("Recognition.complete")]
    #[getter]
    fn complete(&self) -> bool {
        either!(&self.found, found => found.complete)
    }

    #[doc = doc!("Recognition.stopped_by")]
    #[getter]
    fn stopped_by(&self) -> Option<&'static str> {
        either!(&self.found, found => found.stopped_by.map(Limit::name))
    }

    #[doc = doc!("Recognition.counters")]
    #[getter]
    fn counters<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        either!(&self.found, found => &found.reports).iter().map(|report| counters(py, report)).collect()
    }

    fn __repr__(&self) -> String {
        let more = match self.stopped_by() {
            None => String::new(),
            Some("hypotheses") => " of more".into(),
            Some(limit) => format!(", not all is decided, stopped by {limit}"),
        };
        let plural = if self.hypotheses.len() == 1 { "hypothesis" } else { "hypotheses" };
        match self.conflict() {
            Some(contacts) => format!("<Recognition: no hypothesis, contacts {contacts:?} in conflict>"),
            None => format!("<Recognition: {} {plural}{more}>", self.hypotheses.len()),
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
