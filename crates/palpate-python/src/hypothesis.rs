//! Hypotheses, interpretations and their poses.

use std::sync::OnceLock;

use numpy::{PyArray2, PyArray3};
use palpate::plane::{Pose, PoseSet};
use palpate::{Count, Hypothesis, Interpretation};
use pyo3::prelude::*;

use crate::convert::{pose, pose_array, poses_array, vector, vectors_array, whole};
use crate::interpretations::PyInterpretations;
use crate::model::PyModel;
use crate::thesis::PyThesisPose;

type Any<'py> = Bound<'py, PyAny>;
type Array2<'py> = Bound<'py, PyArray2<f64>>;

/// One answer: interpretations of one model whose poses run into each other.
#[pyclass(name = "Hypothesis", module = "palpate._core", frozen)]
pub(crate) struct PyHypothesis {
    pub(crate) hypothesis: Hypothesis,
    pub(crate) model: Py<PyModel>,
    count: OnceLock<Count>,
}

/// A model with one feature for each contact, and the poses that satisfy them.
#[pyclass(name = "Interpretation", module = "palpate._core", frozen)]
pub(crate) struct PyInterpretation {
    pub(crate) interpretation: Interpretation,
    pub(crate) model: Py<PyModel>,
}

/// All poses of a hypothesis or of an interpretation.
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
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<PyModel> {
        self.model.clone_ref(py)
    }

    #[getter]
    fn model_number(&self) -> usize {
        self.hypothesis.model_number
    }

    #[getter]
    fn interpretations(slf: &Bound<'_, Self>) -> PyInterpretations {
        PyInterpretations::new(vec![slf.clone().unbind()])
    }

    #[getter]
    fn interpretation_count(&self, py: Python<'_>) -> u64 {
        self.count(py).at_least
    }

    #[getter]
    fn interpretation_count_exact(&self, py: Python<'_>) -> bool {
        self.count(py).exact
    }

    #[getter]
    fn world_from_model<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py>> {
        pose_array(py, py.detach(|| self.hypothesis.world_from_model()))
    }

    #[getter]
    fn poses(&self) -> PyPoseSet {
        PyPoseSet(self.hypothesis.poses.clone())
    }

    #[getter]
    fn marginal(&self) -> bool {
        self.hypothesis.marginal()
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let best = py.detach(|| self.hypothesis.world_from_model());
        let marginal = if self.hypothesis.marginal() { ", marginal" } else { "" };
        let (name, at) = (&self.hypothesis.model.name, best.translation);
        format!(
            "<Hypothesis: {name:?} at ({:.6}, {:.6}), turned {:.6} rad{marginal}>",
            at.x,
            at.y,
            best.angle()
        )
    }
}

#[pymethods]
impl PyInterpretation {
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<PyModel> {
        self.model.clone_ref(py)
    }

    #[getter]
    fn model_number(&self) -> usize {
        self.interpretation.model_number
    }

    #[getter]
    fn assignment(&self) -> Vec<(&'static str, u32)> {
        self.interpretation.assignment.iter().map(|feature| (feature.kind(), feature.number())).collect()
    }

    #[getter]
    fn world_from_model<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py>> {
        pose_array(py, py.detach(|| self.interpretation.poses.largest_slack()))
    }

    #[getter]
    fn poses(&self) -> PyPoseSet {
        PyPoseSet(self.interpretation.poses.clone())
    }

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
    fn contains(&self, py: Python<'_>, world_from_model: &Any<'_>) -> PyResult<bool> {
        let pose = pose("world_from_model", world_from_model)?;
        Ok(py.detach(|| self.0.contains(pose)))
    }

    #[pyo3(signature = (n, seed=None), text_signature = "($self, n, seed=0)")]
    fn sample<'py>(
        &self,
        py: Python<'py>,
        n: &Any<'py>,
        seed: Option<&Any<'py>>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let n = whole("n", n, 0)? as usize;
        let seed = seed.map_or(Ok(0), |seed| whole("seed", seed, 0))?;
        poses_array(py, &py.detach(|| self.0.sample(n, seed)))
    }

    #[getter]
    fn rotation_bound(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.0.rotation_bound())
    }

    fn excursion(&self, py: Python<'_>, point: &Any<'_>) -> PyResult<f64> {
        let point = vector("point", point)?;
        Ok(py.detach(|| self.0.excursion(point)))
    }

    fn outline<'py>(&self, py: Python<'py>, point: &Any<'py>) -> PyResult<Array2<'py>> {
        let point = vector("point", point)?;
        vectors_array(py, &py.detach(|| self.0.outline(point)))
    }

    #[getter]
    fn witness<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py>> {
        pose_array(py, self.0.witness())
    }

    #[getter]
    fn marginal(&self) -> bool {
        self.0.marginal()
    }

    #[getter]
    fn thesis_pose(&self) -> Option<PyThesisPose> {
        self.0.thesis_pose().map(PyThesisPose)
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let bound = self.rotation_bound(py);
        format!("<PoseSet {}: rotations within {bound:.6} rad>", place(self.0.witness()))
    }
}

/// A pose for a person to read: no more digits than that, and no negative zeros.
fn place(pose: Pose) -> String {
    let [x, y, angle] = [pose.translation.x, pose.translation.y, pose.angle()].map(|value| {
        let millionths = (value * 1e6).round();
        if millionths == 0.0 { 0.0 } else { millionths / 1e6 }
    });
    format!("at ({x}, {y}), turned {angle} rad")
}
