//! Interpretations as a lazy sequence: they are found as they are asked for.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, PoisonError};

use palpate::Count;
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyRange;

use crate::dimension::In;
use crate::hypothesis::{AnyInterpretation, PyHypothesis, PyInterpretation};

type Listing = Box<dyn Iterator<Item = AnyInterpretation> + Send>;

#[doc = doc!("Interpretations")]
#[pyclass(name = "Interpretations", module = "palpate._core", frozen)]
pub(crate) struct PyInterpretations(Vec<Py<PyHypothesis>>);

/// An iteration over them.
#[pyclass(module = "palpate._core", frozen)]
struct InterpretationIterator {
    hypotheses: Vec<Py<PyHypothesis>>,
    place: Mutex<Place>,
}

/// Where an iteration stands.
#[derive(Default)]
struct Place {
    hypothesis: usize,
    running: Option<Listing>,
}

impl InterpretationIterator {
    /// The next interpretation and the number of its hypothesis.
    fn advance(&self) -> Option<(usize, AnyInterpretation)> {
        let mut place = self.place.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            let number = place.hypothesis;
            let hypothesis = &self.hypotheses.get(number)?.get().hypothesis;
            let running = place.running.get_or_insert_with(|| match hypothesis {
                In::Plane(one) => Box::new(one.interpretations().map(In::Plane)),
                In::Space(one) => Box::new(one.interpretations().map(In::Space)),
            });
            if let Some(found) = running.next() {
                return Some((number, found));
            }
            *place = Place { hypothesis: number + 1, running: None };
        }
    }

    fn wrap(&self, py: Python<'_>, (number, interpretation): (usize, AnyInterpretation)) -> PyInterpretation {
        PyInterpretation { interpretation, model: self.hypotheses[number].get().model.clone_ref(py) }
    }
}

#[pymethods]
impl InterpretationIterator {
    fn __iter__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    fn __next__(&self, py: Python<'_>) -> Option<PyInterpretation> {
        py.detach(|| self.advance()).map(|found| self.wrap(py, found))
    }
}

impl PyInterpretations {
    pub(crate) fn new(hypotheses: Vec<Py<PyHypothesis>>) -> Self {
        Self(hypotheses)
    }

    fn count(&self, py: Python<'_>) -> Count {
        let none = Count { at_least: 0, exact: true };
        self.0.iter().fold(none, |sum, hypothesis| sum + hypothesis.get().count(py))
    }

    /// The interpretations of these numbers, found in one pass.
    fn pick(&self, py: Python<'_>, numbers: &[usize]) -> PyResult<Vec<PyInterpretation>> {
        let iterator = self.__iter__(py);
        let wanted: BTreeSet<usize> = numbers.iter().copied().collect();
        let end = wanted.last().map_or(0, |last| last + 1);
        let pass = || (0..end).map_while(|number| Some((number, iterator.advance()?)));
        let found: BTreeMap<_, _> =
            py.detach(|| pass().filter(|(number, _)| wanted.contains(number)).collect());
        let pick = |number| {
            let found = found.get(number).ok_or_else(|| PyIndexError::new_err("no such interpretation"));
            Ok(iterator.wrap(py, found?.clone()))
        };
        numbers.iter().map(pick).collect()
    }
}

#[pymethods]
impl PyInterpretations {
    fn __len__(&self, py: Python<'_>) -> usize {
        self.count(py).at_least.min(i64::MAX as u64) as usize
    }

    fn __bool__(&self) -> bool {
        !self.0.is_empty()
    }

    fn __iter__(&self, py: Python<'_>) -> InterpretationIterator {
        let hypotheses = self.0.iter().map(|hypothesis| hypothesis.clone_ref(py)).collect();
        InterpretationIterator { hypotheses, place: Mutex::default() }
    }

    fn __getitem__<'py>(&self, py: Python<'py>, key: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        // A range knows negative numbers and slices.
        let numbers = PyRange::new(py, 0, self.__len__(py).try_into()?)?.as_any().get_item(key)?;
        if let Ok(number) = numbers.extract::<usize>() {
            return Ok(self.pick(py, &[number])?.pop().into_pyobject(py)?.into_any());
        }
        let numbers: Vec<usize> =
            numbers.try_iter()?.map(|number| number?.extract()).collect::<PyResult<_>>()?;
        self.pick(py, &numbers)?.into_pyobject(py)
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let Count { at_least, exact } = self.count(py);
        format!("<Interpretations: {}{at_least}>", if exact { "" } else { "at least " })
    }
}
