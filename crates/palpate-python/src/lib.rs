//! Python bindings: convert, call without the interpreter's lock, raise. Nothing is decided here.

#![expect(clippy::doc_markdown, reason = "texts for Python, whose sections name arguments and errors bare")]

#[macro_use]
mod dimension;
#[macro_use]
mod docs;

mod contact;
mod convert;
mod evidence;
mod first_contact;
mod hypothesis;
mod interpretations;
mod interrupt;
mod lines;
mod model;
mod options;
mod path;
mod plan;
mod predictions;
mod projection;
mod recognize;
mod sensor;
mod thesis;
mod tree;

use pyo3::prelude::*;

/// The compiled core of palpate; import from `palpate` instead.
#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::contact::PyContact;
    #[pymodule_export]
    use crate::evidence::{PyMiss, PyPrior};
    #[pymodule_export]
    use crate::first_contact::PyFirstContact;
    #[pymodule_export]
    use crate::hypothesis::{PyHypothesis, PyInterpretation, PyPoseSet};
    #[pymodule_export]
    use crate::interpretations::PyInterpretations;
    #[pymodule_export]
    use crate::lines::PyLines;
    #[pymodule_export]
    use crate::model::PyModel;
    #[pymodule_export]
    use crate::path::{PyOutcome, PyPath, PyTouch};
    #[pymodule_export]
    use crate::plan::{
        PyPlanReport, judge, plan, plan_report, refuting_moves, verification_path, verification_report,
    };
    #[pymodule_export]
    use crate::predictions::{linearization_error, predicted_hit_rate};
    #[pymodule_export]
    use crate::projection::{PyOverlap, PyProjectionSpace, PySheaf, projection_space};
    #[pymodule_export]
    use crate::recognize::{PyRecognition, recognize};
    #[pymodule_export]
    use crate::sensor::PySensor;
    #[pymodule_export]
    use crate::thesis::PyThesisPose;
    #[pymodule_export]
    use crate::tree::{PyBranch, PyNode, PyTree, plan_tree};

    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
