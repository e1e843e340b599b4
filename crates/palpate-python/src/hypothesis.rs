//! Hypotheses, interpretations and their poses.

use std::sync::OnceLock;

use glam::DVec2;
use numpy::{PyArray2, PyArray3};
use palpate::plane::{Pose, PoseSet};
use palpate::{Count, Hypothesis, Interpretation};
use pyo3::prelude::*;

use crate::convert::{
    decimal, decimals, pose, pose_array, poses_array, refuse, vector, vectors_array, whole,
};
use crate::interpretations::PyInterpretations;
use crate::model::PyModel;
use crate::thesis::PyThesisPose;

type Any<'py> = Bound<'py, PyAny>;
type Array2<'py> = Bound<'py, PyArray2<f64>>;

/// Poses in one sample: 720 MB as an array. What memory can't hold would end the process, not raise.
const MOST_SAMPLES: u64 = 10_000_000;

#[doc = doc!("Hypothesis")]
#[pyclass(name = "Hypothesis", module = "palpate._core", frozen)]
pub(crate) struct PyHypothesis {
    pub(crate) hypothesis: Hypothesis,
    pub(crate) model: Py<PyModel>,
    count: OnceLock<Count>,
}

#[doc = doc!("Interpretation")]
#[pyclass(name = "Interpretation", module = "palpate._core", frozen)]
pub(crate) struct PyInterpretation {
    pub(crate) interpretation: Interpretation,
    pub(crate) model: Py<PyModel>,
}

#[doc = doc!("PoseSet")]
#[pyclass(name = "PoseSet", module = "palpate._core", frozen)]
pub(crate) struct PyPoseSet(PoseSet);

impl PyHypothesis {
    pub(crate) fn new(hypothesis: Hypothesis, model: Py<PyModel>) -> Self {
        Self { hypothesis, model, count: OnceLock::new() }
    }

    pub(crate) fn count(&self, py: Python<'_>) -> Count {
        py.detach(|| *self.count.get_or_init(|| self.hypothesis.interpretation_count()))
    }
}

#[pymethods]
impl PyHypothesis {
    #[doc = doc!("Hypothesis.model")]
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<PyModel> {
        self.model.clone_ref(py)
    }

    #[doc = doc!("Hypothesis.model_number")]
    #[getter]
    fn model_number(&self) -> usize {
        self.hypothesis.model_number
    }

    #[doc = doc!("Hypothesis.interpretations")]
    #[getter]
    fn interpretations(slf: &Bound<'_, Self>) -> PyInterpretations {
        PyInterpretations::new(vec![slf.clone().unbind()])
    }

    #[doc = doc!("Hypothesis.interpretation_count")]
    #[getter]
    fn interpretation_count(&self, py: Python<'_>) -> u64 {
        self.count(py).at_least
    }

    #[doc = doc!("Hypothesis.interpretation_count_exact")]
    #[getter]
    fn interpretation_count_exact(&self, py: Python<'_>) -> bool {
        self.count(py).exact
    }

    #[doc = doc!("Hypothesis.world_from_model")]
    #[getter]
    fn world_from_model<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py>> {
        pose_array(py, py.detach(|| self.hypothesis.world_from_model()))
    }

    #[doc = doc!("Hypothesis.poses")]
    #[getter]
    fn poses(&self) -> PyPoseSet {
        PyPoseSet(self.hypothesis.poses.clone())
    }

    #[doc = doc!("Hypothesis.marginal")]
    #[getter]
    fn marginal(&self) -> bool {
        self.hypothesis.marginal()
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let best = py.detach(|| self.hypothesis.world_from_model());
        let marginal = if self.hypothesis.marginal() { ", marginal" } else { "" };
        let model = &self.hypothesis.model;
        format!("<Hypothesis: {:?} {}{marginal}>", model.name, place(best, model.size))
    }
}

#[pymethods]
impl PyInterpretation {
    #[doc = doc!("Interpretation.model")]
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<PyModel> {
        self.model.clone_ref(py)
    }

    #[doc = doc!("Interpretation.model_number")]
    #[getter]
    fn model_number(&self) -> usize {
        self.interpretation.model_number
    }

    #[doc = doc!("Interpretation.assignment")]
    #[getter]
    fn assignment(&self) -> Vec<(&'static str, u32)> {
        self.interpretation.assignment.iter().map(|feature| (feature.kind(), feature.number())).collect()
    }

    #[doc = doc!("Interpretation.world_from_model")]
    #[getter]
    fn world_from_model<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py>> {
        pose_array(py, py.detach(|| self.interpretation.poses.largest_slack()))
    }

    #[doc = doc!("Interpretation.poses")]
    #[getter]
    fn poses(&self) -> PyPoseSet {
        PyPoseSet(self.interpretation.poses.clone())
    }

    #[doc = doc!("Interpretation.marginal")]
    #[getter]
    fn marginal(&self) -> bool {
        self.interpretation.poses.marginal()
    }

    fn __repr__(&self) -> String {
        let features: Vec<String> = self
            .interpretation
            .assignment
            .iter()
            .map(|feature| format!("{} {}", feature.kind(), feature.number()))
            .collect();
        format!("<Interpretation: {:?} on {}>", self.interpretation.model.name, features.join(", "))
    }
}

#[pymethods]
impl PyPoseSet {
    #[doc = doc!("PoseSet.contains")]
    fn contains(&self, py: Python<'_>, world_from_model: &Any<'_>) -> PyResult<bool> {
        let pose = pose("world_from_model", world_from_model)?;
        Ok(py.detach(|| self.0.contains(pose)))
    }

    #[doc = doc!("PoseSet.sample")]
    #[pyo3(signature = (n, seed=None), text_signature = "($self, n, seed=0)")]
    fn sample<'py>(
        &self,
        py: Python<'py>,
        n: &Any<'py>,
        seed: Option<&Any<'py>>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let wanted = whole("n", n, 0)?;
        if wanted > MOST_SAMPLES {
            return Err(refuse(
                "n",
                "is more than ten million",
                n,
                "sample in parts, each with its own seed",
            ));
        }
        let n = wanted as usize;
        let seed = seed.map_or(Ok(0), |seed| whole("seed", seed, 0))?;
        poses_array(py, &py.detach(|| self.0.sample(n, seed)))
    }

    #[doc = doc!("PoseSet.rotation_bound")]
    #[getter]
    fn rotation_bound(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.0.rotation_bound())
    }

    #[doc = doc!("PoseSet.excursion")]
    fn excursion(&self, py: Python<'_>, point: &Any<'_>) -> PyResult<f64> {
        let point = vector("point", point)?;
        Ok(py.detach(|| self.0.excursion(point)))
    }

    #[doc = doc!("PoseSet.outline")]
    fn outline<'py>(&self, py: Python<'py>, point: &Any<'py>) -> PyResult<Array2<'py>> {
        let point = vector("point", point)?;
        vectors_array(py, &py.detach(|| self.0.outline(point)))
    }

    #[doc = doc!("PoseSet.witness")]
    #[getter]
    fn witness<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py>> {
        pose_array(py, self.0.witness())
    }

    #[doc = doc!("PoseSet.marginal")]
    #[getter]
    fn marginal(&self) -> bool {
        self.0.marginal()
    }

    #[doc = doc!("PoseSet.thesis_pose")]
    #[getter]
    fn thesis_pose(&self) -> Option<PyThesisPose> {
        self.0.thesis_pose().map(PyThesisPose)
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let bound = self.rotation_bound(py);
        let witness = self.0.witness();
        // The part's size is not known here; a place is told to as many digits as it, or its range, needs.
        let range = py.detach(|| self.0.excursion(DVec2::ZERO));
        let scale = witness.translation.abs().max_element().max(range);
        format!("<PoseSet {}: rotations within {bound:.6} rad>", place(witness, scale))
    }
}

/// A pose for a person to read: to a millionth, or as many digits more as a part of `size` needs.
fn place(pose: Pose, size: f64) -> String {
    let [x, y] = pose.translation.to_array().map(|length| decimal(length, decimals(size)));
    format!("at ({x}, {y}), turned {} rad", decimal(pose.angle(), 6))
}
