//! Everything that knows SE(2).

mod arc;
mod case;
mod cell;
mod crossing;
mod dimension;
mod distance;
mod free;
mod hypotheses;
mod model;
mod outcome;
pub(crate) mod outline;
pub(crate) mod planners;
mod pose;
mod pose_set;
mod rays;
mod region;
mod sampling;
mod scene;
mod segments;
mod shadow;
mod site;
mod solve;
mod subdivide;
mod symmetry;
mod tables;
mod thesis;

pub use arc::Arc;
pub use model::{Face, Model, Symmetry, Vertex};
pub use pose::Pose;
pub use pose_set::PoseSet;
pub use thesis::ThesisPose;

pub(crate) use case::Case;
pub(crate) use hypotheses::explain;
pub(crate) use shadow::Shadow;
