//! The ambiguity tree.

use std::sync::Arc;

use palpate::{Answers, Branch, Status, TreeMethod};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::raise;
use crate::dimension::AnyTree;
use crate::interrupt::interruptible;
use crate::options::{GROWN, JUDGED, Options, PLACED, SEARCHED};
use crate::path::PyPath;
use crate::plan::{hypotheses, sensor};

type Any<'py> = Bound<'py, PyAny>;

#[doc = doc!("AmbiguityTree")]
#[pyclass(name = "AmbiguityTree", module = "palpate._core", frozen)]
pub(crate) struct PyTree {
    tree: Arc<AnyTree>,
    tip_radius: f64,
}

#[doc = doc!("AmbiguityNode")]
#[pyclass(name = "AmbiguityNode", module = "palpate._core", frozen)]
pub(crate) struct PyNode {
    tree: Arc<AnyTree>,
    tip_radius: f64,
    number: usize,
}

#[doc = doc!("AmbiguityBranch")]
#[pyclass(name = "AmbiguityBranch", module = "palpate._core", frozen)]
pub(crate) struct PyBranch {
    tree: Arc<AnyTree>,
    tip_radius: f64,
    branch: Branch,
}

#[doc = doc!("plan_tree")]
#[pyfunction]
#[pyo3(
    signature = (hypotheses, sensor, **options),
    text_signature = "(hypotheses, sensor, *, method='greedy', max_nodes=None, planner='auto', stop='perfect', workspace=None, directions=None, time_limit=None, effort=None, seed=0, features=None, avoid_assigned=False, margin=0.001, cells=None, directions_tried=None)"
)]
pub(crate) fn plan_tree<'py>(
    py: Python<'py>,
    hypotheses: &Any<'py>,
    sensor: &Any<'py>,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<PyTree> {
    let sensor = self::sensor(sensor)?;
    let tree = likewise!(self::hypotheses(hypotheses)?, hypotheses => {
        let options = Options::read("plan_tree", options, &[JUDGED, PLACED, SEARCHED, GROWN])?;
        let (settings, tree, deadline) = (&options.settings, options.tree, options.deadline());
        let tree = interruptible(py, |halt| {
            palpate::plan_tree_until(&hypotheses, &sensor, settings, &tree, &|| deadline.late(halt))
        })?;
        tree.map_err(raise)?
    });
    Ok(PyTree { tree: Arc::new(tree), tip_radius: sensor.tip_radius })
}

#[pymethods]
impl PyTree {
    #[doc = doc!("AmbiguityTree.root")]
    #[getter]
    fn root(&self) -> PyNode {
        PyNode { tree: Arc::clone(&self.tree), tip_radius: self.tip_radius, number: 0 }
    }

    #[doc = doc!("AmbiguityTree.nodes")]
    #[getter]
    fn nodes(&self) -> Vec<PyNode> {
        (0..either!(&*self.tree, tree => tree.nodes.len()))
            .map(|number| PyNode { number, ..self.root() })
            .collect()
    }

    #[doc = doc!("AmbiguityTree.names")]
    #[getter]
    fn names(&self) -> Vec<String> {
        either!(&*self.tree, tree => tree.names.clone())
    }

    #[doc = doc!("AmbiguityTree.method")]
    #[getter]
    fn method(&self) -> &'static str {
        match either!(&*self.tree, tree => tree.method) {
            TreeMethod::Greedy => "greedy",
            TreeMethod::Ahead => "ahead",
            TreeMethod::Optimal => "optimal",
        }
    }

    #[doc = doc!("AmbiguityTree.expected_touches")]
    #[getter]
    fn expected_touches(&self) -> f64 {
        either!(&*self.tree, tree => tree.expected_touches)
    }

    #[doc = doc!("AmbiguityTree.worst_touches")]
    #[getter]
    fn worst_touches(&self) -> usize {
        either!(&*self.tree, tree => tree.worst_touches)
    }

    #[doc = doc!("AmbiguityTree.max_outcomes")]
    #[getter]
    fn max_outcomes(&self) -> usize {
        either!(&*self.tree, tree => tree.max_outcomes)
    }

    #[doc = doc!("AmbiguityTree.entropy_bound")]
    #[getter]
    fn entropy_bound(&self) -> f64 {
        either!(&*self.tree, tree => tree.entropy_bound)
    }

    #[doc = doc!("AmbiguityTree.worst_bound")]
    #[getter]
    fn worst_bound(&self) -> usize {
        either!(&*self.tree, tree => tree.worst_bound)
    }

    #[doc = doc!("AmbiguityTree.lower_bound")]
    #[getter]
    fn lower_bound(&self) -> f64 {
        either!(&*self.tree, tree => tree.lower_bound)
    }

    #[doc = doc!("AmbiguityTree.identified")]
    #[getter]
    fn identified(&self) -> Vec<usize> {
        either!(&*self.tree, tree => tree.identified.clone())
    }

    #[doc = doc!("AmbiguityTree.solved")]
    #[getter]
    fn solved(&self) -> bool {
        either!(&*self.tree, tree => tree.solved())
    }

    #[doc = doc!("AmbiguityTree.to_text")]
    fn to_text(&self) -> String {
        either!(&*self.tree, tree => tree.to_text())
    }

    #[doc = doc!("AmbiguityTree.to_json")]
    #[pyo3(signature = (*, unit=None))]
    fn to_json<'py>(slf: &Bound<'py, Self>, unit: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        slf.py().import("palpate.plan_json")?.call_method1("tree_json", (slf, unit))
    }

    fn __repr__(&self) -> String {
        let (n, expected, worst) = (self.names().len(), self.expected_touches(), self.worst_touches());
        format!("<AmbiguityTree of {n}: {expected:.2} touches expected, {worst} worst>")
    }
}

/// What the expression makes of the node that a `PyNode` stands for.
macro_rules! of_node {
    ($given:expr, $node:ident => $then:expr) => {
        either!(&*$given.tree, tree => {
            let $node = &tree.nodes[$given.number];
            $then
        })
    };
}

#[pymethods]
impl PyNode {
    #[doc = doc!("AmbiguityNode.number")]
    #[getter]
    fn number(&self) -> usize {
        self.number
    }

    #[doc = doc!("AmbiguityNode.members")]
    #[getter]
    fn members(&self) -> Vec<usize> {
        of_node!(self, node => node.members.clone())
    }

    #[doc = doc!("AmbiguityNode.level")]
    #[getter]
    fn level(&self) -> usize {
        of_node!(self, node => node.level)
    }

    #[doc = doc!("AmbiguityNode.path")]
    #[getter]
    fn path(&self) -> Option<PyPath> {
        let path = likewise!(&*self.tree, tree => tree.nodes[self.number].path.clone()?);
        Some(PyPath::among(path, self.members(), self.tip_radius))
    }

    #[doc = doc!("AmbiguityNode.branches")]
    #[getter]
    fn branches(&self) -> Vec<PyBranch> {
        let of = |branch: &Branch| PyBranch {
            tree: Arc::clone(&self.tree),
            tip_radius: self.tip_radius,
            branch: branch.clone(),
        };
        of_node!(self, node => node.branches.iter().map(of).collect())
    }

    #[doc = doc!("AmbiguityNode.status")]
    #[getter]
    fn status(&self) -> &'static str {
        match of_node!(self, node => node.status) {
            Status::Solved => "solved",
            Status::Divided => "divided",
            Status::Inseparable => "inseparable",
            Status::NoUsablePath => "no_usable_path",
            Status::Effort => "effort",
            Status::Unexpanded => "unexpanded",
        }
    }

    fn __repr__(&self) -> String {
        format!("<AmbiguityNode {}: {} of {:?}>", self.number, self.status(), self.members())
    }
}

#[pymethods]
impl PyBranch {
    #[doc = doc!("AmbiguityBranch.answers")]
    #[getter]
    fn answers(&self) -> &'static str {
        match self.branch.answers {
            Answers::Contact => "contact",
            Answers::NoContact => "no_contact",
            Answers::Either => "either",
            Answers::Unexpected => "unexpected",
        }
    }

    #[doc = doc!("AmbiguityBranch.members")]
    #[getter]
    fn members(&self) -> Vec<usize> {
        self.branch.members.clone()
    }

    #[doc = doc!("AmbiguityBranch.node")]
    #[getter]
    fn node(&self) -> Option<PyNode> {
        let number = self.branch.node?;
        Some(PyNode { tree: Arc::clone(&self.tree), tip_radius: self.tip_radius, number })
    }

    fn __repr__(&self) -> String {
        format!("<AmbiguityBranch: {} leaves {:?}>", self.answers(), self.branch.members)
    }
}
