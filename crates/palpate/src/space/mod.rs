//! Everything that knows SE(3).

mod angle_index;
mod bvh;
mod case;
mod cell;
#[cfg(test)]
mod cell_tests;
mod cones;
mod corners;
mod crossing;
mod dimension;
mod distance;
mod edges;
mod extent;
mod facets;
mod first_cells;
mod free;
mod gap;
mod hypotheses;
mod linear;
mod lp;
mod mesh;
mod model;
mod motions;
mod near_misses;
mod orient;
mod outcome;
#[cfg(test)]
mod outcome_tests;
mod outlines;
mod pieces;
mod planners;
mod pose;
mod pose_set;
mod prior;
mod quantized;
#[cfg(test)]
mod query_tests;
#[cfg(test)]
mod ray_cases;
#[cfg(test)]
mod ray_tests;
mod rays;
#[cfg(test)]
mod reading_tests;
mod regions;
mod rims;
mod roundness;
mod scale;
mod scene;
mod segments;
mod sensed;
mod shadow;
#[cfg(test)]
mod shapes;
mod site;
mod solid;
mod solve;
mod sphere;
mod spherical;
mod subdivide;
mod symmetry;
mod table_bytes;
mod tables;
#[cfg(test)]
mod tables_tests;
#[cfg(test)]
mod test_solids;
mod thesis;
mod weld;

pub use bvh::Nearest;
pub use model::{Edge, Face, Model, Roundness, Symmetry, Vertex};
pub use planners::{Chart, LinearizationError, linearization_error, predicted_hit_rate};
pub use pose::Pose;
pub use pose_set::PoseSet;
pub use prior::{Lying, Prior};
pub(crate) use shadow::Shadow;
pub use solid::{Sewn, sewn};
pub use sphere::Cap;
pub use thesis::ThesisPose;

pub(crate) use hypotheses::explain;
