//! Recognize and localize a known part by touch, with guarantees.
//!
//! From a few contacts of a probe, [`recognize()`] finds every model and every pose that explains them: nothing true is
//! lost, nothing false is kept (up to a stated tolerance). Lengths are in the unit of the models, angles in radians.

#![forbid(unsafe_code)]

pub mod ambiguity;
mod best;
pub mod contact;
pub mod dimension;
pub mod error;
pub mod feature;
mod groups;
pub mod hypothesis;
pub mod judge;
mod line;
mod nearest;
pub mod part;
pub mod path;
pub mod plan;
pub mod plane;
mod planner;
mod polytope;
mod prepared;
pub mod projection;
pub mod recognize;
pub mod refute;
mod scene;
pub mod sensor;
pub mod space;
mod sweep;
pub mod tree;
pub mod why;
mod witness;

pub use ambiguity::{
    AmbiguityTree, Answers, Branch, Node, Status, TreeMethod, TreeSettings, Verification, plan_tree,
    plan_tree_until, verification_along, verification_path, verification_until,
};
pub use contact::{Contact, Evidence, Miss, Normal, Prior};
pub use dimension::{Dimension, Poses};
pub use error::Error;
pub use feature::Feature;
pub use hypothesis::{Count, Hypothesis, Interpretation};
pub use judge::{Fault, Normals, Outcome, Reading, Touch, Verdict};
pub use line::{FirstContact, Line};
pub use part::{Mend, Surface};
pub use path::Path;
pub use plan::{EllisCounters, Plan, PlanSettings, Planner, Prepared, Stop, judge, plan, plan_until};
pub use projection::{
    FaceOf, Overlap, Projection, ProjectionSpace, Sheaf, projection_space, projection_space_until,
};
pub use recognize::{Explanations, Limit, ModelReport, Recognition, Settings, recognize, recognize_until};
pub use refute::{Move, refuting_moves};
pub use sensor::{Sensor, Stem};
pub use why::Why;
