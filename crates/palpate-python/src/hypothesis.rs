//! Hypotheses, interpretations and their poses.

use std::sync::OnceLock;

use glam::{DVec2, DVec3};
use numpy::{PyArray2, PyArray3};
use palpate::{Count, Dimension, Interpretation, plane, space};
use pyo3::prelude::*;

use crate::convert::{
    decimal, decimals, plane_only, pose, pose_array, poses_array, refuse, vector, vectors_array, whole,
};
use crate::dimension::{AnyHypothesis, In, Motion, Vector};
use crate::interpretations::PyInterpretations;
use crate::model::PyModel;
use crate::thesis::PyThesisPose;

type Any<'py> = Bound<'py, PyAny>;
type Array2<'py> = Bound<'py, PyArray2<f64>>;

/// Poses in one sample: 720 MB as an array. What memory can't hold would end the process, not raise.
const MOST_SAMPLES: u64 = 10_000_000;

pub(crate) type AnyInterpretation = In<Interpretation<DVec2>, Interpretation<DVec3>>;

#[doc = doc!("Hypothesis")]
#[pyclass(name = "Hypothesis", module = "palpate._core", frozen)]
pub(crate) struct PyHypothesis {
    pub(crate) hypothesis: AnyHypothesis,
    pub(crate) model: Py<PyModel>,
    count: OnceLock<Count>,
}

#[doc = doc!("Interpretation")]
#[pyclass(name = "Interpretation", module = "palpate._core", frozen)]
pub(crate) struct PyInterpretation {
    pub(crate) interpretation: AnyInterpretation,
    pub(crate) model: Py<PyModel>,
}

#[doc = doc!("PoseSet")]
#[pyclass(name = "PoseSet", module = "palpate._core", frozen)]
pub(crate) struct PyPoseSet(In<plane::PoseSet, space::PoseSet>);

impl PyHypothesis {
    pub(crate) fn new(hypothesis: AnyHypothesis, model: Py<PyModel>) -> Self {
        Self { hypothesis, model, count: OnceLock::new() }
    }

    pub(crate) fn count(&self, py: Python<'_>) -> Count {
        py.detach(|| *self.count.get_or_init(|| either!(&self.hypothesis, one => one.interpretation_count())))
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
        either!(&self.hypothesis, one => one.model_number)
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
        either!(&self.hypothesis, one => pose_array(py, py.detach(|| one.world_from_model())))
    }

    #[doc = doc!("Hypothesis.poses")]
    #[getter]
    fn poses(&self) -> PyPoseSet {
        PyPoseSet(likewise!(&self.hypothesis, one => one.poses.clone()))
    }

    #[doc = doc!("Hypothesis.marginal")]
    #[getter]
    fn marginal(&self) -> bool {
        either!(&self.hypothesis, one => one.marginal())
    }

    #[doc = doc!("Hypothesis.proved")]
    #[getter]
    fn proved(&self) -> bool {
        either!(&self.hypothesis, one => one.proved())
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let doubt = match (self.proved(), self.marginal()) {
            (false, _) => ", not proved",
            (true, true) => ", marginal",
            (true, false) => "",
        };
        let place = either!(&self.hypothesis, one => {
            let best = py.detach(|| one.world_from_model());
            format!("{:?} {}", one.model.name, place(best, one.model.size))
        });
        format!("<Hypothesis: {place}{doubt}>")
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
        either!(&self.interpretation, one => one.model_number)
    }

    #[doc = doc!("Interpretation.assignment")]
    #[getter]
    fn assignment(&self) -> Vec<(&'static str, u32)> {
        let assignment = either!(&self.interpretation, one => &one.assignment);
        assignment.iter().map(|feature| (feature.kind(), feature.number())).collect()
    }

    #[doc = doc!("Interpretation.world_from_model")]
    #[getter]
    fn world_from_model<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py>> {
        either!(&self.interpretation, one => pose_array(py, py.detach(|| one.poses.largest_slack())))
    }

    #[doc = doc!("Interpretation.poses")]
    #[getter]
    fn poses(&self) -> PyPoseSet {
        PyPoseSet(likewise!(&self.interpretation, one => one.poses.clone()))
    }

    #[doc = doc!("Interpretation.marginal")]
    #[getter]
    fn marginal(&self) -> bool {
        either!(&self.interpretation, one => one.poses.marginal())
    }

    fn __repr__(&self) -> String {
        let features: Vec<String> =
            self.assignment().iter().map(|(kind, number)| format!("{kind} {number}")).collect();
        let name = either!(&self.interpretation, one => &one.model.name);
        format!("<Interpretation: {name:?} on {}>", features.join(", "))
    }
}

#[pymethods]
impl PyPoseSet {
    #[doc = doc!("PoseSet.contains")]
    fn contains(&self, py: Python<'_>, world_from_model: &Any<'_>) -> PyResult<bool> {
        either!(&self.0, poses => {
            let pose = pose("world_from_model", world_from_model)?;
            Ok(py.detach(|| poses.contains(pose)))
        })
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
        either!(&self.0, poses => poses_array(py, &py.detach(|| poses.sample(n, seed))))
    }

    #[doc = doc!("PoseSet.rotation_bound")]
    #[getter]
    fn rotation_bound(&self, py: Python<'_>) -> f64 {
        py.detach(|| either!(&self.0, poses => poses.rotation_bound()))
    }

    #[doc = doc!("PoseSet.excursion")]
    fn excursion(&self, py: Python<'_>, point: &Any<'_>) -> PyResult<f64> {
        either!(&self.0, poses => {
            let point = vector("point", point)?;
            Ok(py.detach(|| poses.excursion(point)))
        })
    }

    #[doc = doc!("PoseSet.outline")]
    fn outline<'py>(&self, py: Python<'py>, point: &Any<'py>) -> PyResult<Array2<'py>> {
        let poses = self.planar("outline", "ask for excursion, or sample the poses")?;
        let point = vector("point", point)?;
        vectors_array(py, &py.detach(|| poses.outline(point)))
    }

    #[doc = doc!("PoseSet.witness")]
    #[getter]
    fn witness<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py>> {
        either!(&self.0, poses => pose_array(py, poses.witness()))
    }

    #[doc = doc!("PoseSet.marginal")]
    #[getter]
    fn marginal(&self) -> bool {
        either!(&self.0, poses => poses.marginal())
    }

    #[doc = doc!("PoseSet.thesis_pose")]
    #[getter]
    fn thesis_pose(&self) -> Option<PyThesisPose> {
        let thesis = match &self.0 {
            In::Plane(poses) => In::Plane(poses.thesis_pose()?),
            In::Space(poses) => In::Space(poses.thesis_pose()?),
        };
        Some(PyThesisPose(thesis))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let bound = self.rotation_bound(py);
        // The part's size is not known here; a place is told to as many digits as it, or its range, needs.
        let place = either!(&self.0, poses => {
            let witness = poses.witness();
            let range = py.detach(|| poses.excursion(origin()));
            place(witness, witness.translation.largest_coordinate().max(range))
        });
        format!("<PoseSet {place}: rotations within {bound:.6} rad>")
    }
}

impl PyPoseSet {
    /// For what is known of the plane only.
    fn planar(&self, what: &str, remedy: &str) -> PyResult<&plane::PoseSet> {
        match &self.0 {
            In::Plane(poses) => Ok(poses),
            In::Space(_) => Err(plane_only(what, "poses in space", remedy)),
        }
    }
}

/// A pose for a person to read: to a millionth, or as many digits more as a part of `size` needs.
fn place<M: Motion>(pose: M, size: f64) -> String {
    let translation = pose.translation();
    let at: Vec<String> =
        translation.coordinates().iter().map(|length| decimal(*length, decimals(size))).collect();
    format!("at ({}), turned {} rad", at.join(", "), decimal(pose.angle(), 6))
}

fn origin<V: Vector>() -> V {
    V::default()
}
