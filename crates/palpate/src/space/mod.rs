//! Everything that knows SE(3).

mod angle_index;
mod bvh;
mod case;
mod cell;
#[cfg(test)]
mod cell_tests;
mod cones;
mod crossing;
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
mod outlines;
mod pieces;
mod pose;
mod pose_set;
mod prior;
mod quantized;
#[cfg(test)]
mod query_tests;
#[cfg(test)]
mod reading_tests;
mod regions;
mod roundness;
mod scale;
mod segments;
mod sensed;
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
pub use pose::Pose;
pub use pose_set::PoseSet;
pub use prior::{Lying, Prior};
pub use solid::{Sewn, sewn};
pub use thesis::ThesisPose;

pub(crate) use hypotheses::explain;
