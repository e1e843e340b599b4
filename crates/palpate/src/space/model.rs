//! Solid models: planar faces, edges, vertices, and their symmetries.
//!
//! A loop of a face runs counter-clockwise as seen from outside, the loops of its holes clockwise: material is on
//! the left of every directed edge, in the face's plane.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::Pose;
use super::bvh::BvhCache;
use super::cones::vertices;
use super::corners::Places;
use super::crossing;
use super::edges::edges;
use super::facets;
use super::roundness::roundness;
use super::solid::{self, Solid};
use super::symmetry::{Parts, Symmetries, symmetries};
use super::tables::TableCache;
use crate::part::{Mend, Surface, check_slacks, checked_name, mark};
use crate::{Error, Feature};

/// A planar face: one outer loop, holes, and the same area in convex pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// Unit outward normal, model frame.
    pub normal: DVec3,
    /// Its plane is `normal · x = offset`. No corner is further from it than the model's `position_slack` grants.
    pub offset: f64,
    /// Vertex numbers, the outer loop first, then the holes.
    pub loops: Vec<Vec<u32>>,
    /// Vertex numbers of convex polygons, counter-clockwise from outside, that make up the face.
    pub pieces: Vec<Vec<u32>>,
    /// What it is to a probe.
    pub surface: Surface,
}

/// A line where two faces meet, or where a loose face ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// Vertex numbers; it runs with the loop of the first face.
    pub ends: [u32; 2],
    /// The face on its left and the one on its right; `None`: a loose face ends here.
    pub faces: [Option<u32>; 2],
    /// The normals of the two faces, if it is convex and both can be touched: a tip may rest on it with any normal of
    /// the arc between them. `None` can't be touched: reflex, between coplanar faces, or where a loose face ends.
    pub normals: Option<[DVec3; 2]>,
}

/// A corner.
#[derive(Debug, Clone, PartialEq)]
pub struct Vertex {
    /// Model frame.
    pub point: DVec3,
    /// The corners of its cone of outward normals, a convex spherical polygon, counter-clockwise as seen from outside,
    /// if a tip can rest on it: `n` is in the cone iff `n · (q − point) ≤ 0` for every near point `q` of the part.
    pub normals: Option<Vec<DVec3>>,
}

/// A rigid motion that maps the model onto itself, and where it takes each feature.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetry {
    /// `model * motion` is the same placed part.
    pub motion: Pose,
    /// `faces[k]` is the face on which face `k` comes to lie.
    pub faces: Vec<u32>,
    /// The same of edges.
    pub edges: Vec<u32>,
    /// The same of vertices.
    pub vertices: Vec<u32>,
}

/// A continuous symmetry, within the model's slacks (a part that is round up to its tessellation).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Roundness {
    /// Any turn about the line through `point` along `direction` (unit) maps it onto itself.
    Axis {
        /// A point of the axis, model frame.
        point: DVec3,
        /// Its unit direction.
        direction: DVec3,
    },
    /// Any turn about `center` does.
    Ball {
        /// Model frame.
        center: DVec3,
    },
}

/// A part in space.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Its name.
    pub name: String,
    /// In face-number order.
    pub faces: Vec<Face>,
    /// In edge-number order.
    pub edges: Vec<Edge>,
    /// In vertex-number order.
    pub vertices: Vec<Vertex>,
    /// Triangles of vertex numbers that make up all faces but seams, and the face of each.
    pub triangles: Vec<([u32; 3], u32)>,
    /// Its faces bound a region: inside and outside are known.
    pub closed: bool,
    /// The motions that map it onto itself, the identity first.
    pub symmetries: Vec<Symmetry>,
    /// Continuous symmetries.
    pub roundness: Option<Roundness>,
    /// How far the true surface may lie from the faces (tessellation): added to each position error.
    pub position_slack: f64,
    /// How far the true normal may be from the faces' (tessellation), radians: added to each normal error.
    pub normal_slack: f64,
    /// What was mended when it was read.
    pub mends: Vec<Mend>,
    /// The largest distance between two of its vertices.
    pub size: f64,
    /// By how much its symmetries miss, at most: a corner its image, and a normal where it should be, radians.
    pub asymmetry: (f64, f64),
    /// How well its corners are known, tessellation aside.
    pub(super) precision: f64,
    /// Its pair tables, made when first needed.
    pub(super) tables: TableCache,
    /// Its triangles by where they are, made when first needed.
    pub(super) bvh: BvhCache,
}

impl Symmetry {
    /// The feature on which `feature` comes to lie.
    #[must_use]
    pub fn feature(&self, feature: Feature) -> Feature {
        match feature {
            Feature::Face(number) => Feature::Face(self.faces[number as usize]),
            Feature::Edge(number) => Feature::Edge(self.edges[number as usize]),
            Feature::Vertex(number) => Feature::Vertex(self.vertices[number as usize]),
        }
    }

    /// The features on which `features` come to lie.
    #[must_use]
    pub fn features(&self, features: &[Feature]) -> Vec<Feature> {
        features.iter().map(|feature| self.feature(*feature)).collect()
    }
}

impl Model {
    /// Of the assignments that the symmetries take into this one, the first.
    pub(crate) fn representative(&self, assignment: Vec<Feature>) -> Vec<Feature> {
        self.symmetries.iter().map(|symmetry| symmetry.features(&assignment)).min().unwrap_or(assignment)
    }
}

impl Face {
    /// Whether a probe can touch it.
    #[must_use]
    pub fn is_touchable(&self) -> bool {
        self.surface == Surface::Touchable
    }
}

impl Model {
    /// A part bounded by triangles, given as numbers of `vertices` and counter-clockwise as seen from outside. Triangles
    /// that lie in one plane and hang together become one face. `untouchable` numbers triangles, as given.
    ///
    /// Whatever can be mended is, and `mends` says so: doubled vertices, triangles without area, repeated ones, two that
    /// face each other, corners on the inside of another triangle's edge, triangles wound against their neighbours,
    /// surfaces turned inside out. A closed surface within another one bounds a cavity.
    ///
    /// Corners at which the surface ends are welded if they are no further apart than single precision may have parted them:
    /// 5e-7 of the size, or of the distance from the origin up to ten sizes. By how much they were moved is in the slacks.
    /// Corners that all meet are left alone, as is whatever is 1e-5 of the size apart. Of an open surface it is not known
    /// what is inside: none of its triangles is turned but a few that are wound against all others.
    ///
    /// Corners may be off their face's plane, and points that are dropped off their edge, by a few roundings of single
    /// precision (5e-7 of the size). What that is beyond 1e-9 of the size is added to `position_slack`, and the angle
    /// by which a plane may be turned for it, if beyond 1e-7, to `normal_slack`; see the module on regions for the proof.
    ///
    /// ```
    /// use glam::dvec3;
    /// use palpate::space::Model;
    ///
    /// let corners = [dvec3(0.0, 0.0, 0.0), dvec3(3.0, 0.0, 0.0), dvec3(0.0, 4.0, 0.0), dvec3(0.0, 0.0, 5.0)];
    /// let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// let model = Model::mesh("corner", &corners, &triangles, &[], 0.0, 0.0).unwrap();
    /// assert!(model.closed);
    /// assert_eq!((model.faces.len(), model.edges.len(), model.vertices.len()), (4, 6, 4));
    /// ```
    ///
    /// # Errors
    /// Numbers that are not finite, a vertex or triangle number out of range, no triangle that has an area, edges that lie
    /// beside one another too far apart to be welded, a surface that is turned inside out where it crosses itself, a size or
    /// a distance from the origin that leaves no digits, an empty name, a slack out of range.
    pub fn mesh(
        name: impl Into<String>,
        vertices: &[DVec3],
        triangles: &[[u32; 3]],
        untouchable: &[usize],
        position_slack: f64,
        normal_slack: f64,
    ) -> Result<Self, Error> {
        let name = checked_name(name.into())?;
        check_slacks(position_slack, normal_slack)?;
        let mut surfaces = vec![Surface::Touchable; triangles.len()];
        mark(&mut surfaces, "untouchable", untouchable, Surface::Untouchable)?;

        let mut mends = Vec::new();
        let solid = solid::of_triangles(vertices, triangles, surfaces, &mut mends)?;
        Self::of_solid(name, solid, position_slack, normal_slack, mends)
    }

    /// A part given by loose faces, each by its outer loop, counter-clockwise as seen from outside, and those of its holes.
    /// They need not close. Numbers in `seams` and `untouchable` are places in `loops`: a seam is not there, an untouchable
    /// face is in the way. Corners that coincide form one vertex; a corner on the inside of another face's side divides it.
    ///
    /// What the corners are off the planes of their faces is treated as in [`Model::mesh`], and corners of sides that only one
    /// face has are welded as there.
    ///
    /// ```
    /// use glam::dvec3;
    /// use palpate::space::Model;
    ///
    /// let floor = vec![dvec3(0.0, 0.0, 0.0), dvec3(9.0, 0.0, 0.0), dvec3(9.0, 5.0, 0.0), dvec3(0.0, 5.0, 0.0)];
    /// let wall = vec![dvec3(0.0, 5.0, 0.0), dvec3(9.0, 5.0, 0.0), dvec3(9.0, 5.0, 7.0), dvec3(0.0, 5.0, 7.0)];
    /// let model = Model::facets("corner", &[vec![floor], vec![wall]], &[], &[], 0.0, 0.0).unwrap();
    /// assert_eq!((model.faces.len(), model.edges.len(), model.closed), (2, 7, false));
    /// ```
    ///
    /// # Errors
    /// No face that is there, a face without area, one whose corners are off their plane, loops that cross or touch, a hole
    /// outside its face, faces that bound a region from inside, numbers that are not finite, a face number out of range or
    /// named both as a seam and as untouchable, an empty name, a slack out of range.
    pub fn facets(
        name: impl Into<String>,
        loops: &[Vec<Vec<DVec3>>],
        seams: &[usize],
        untouchable: &[usize],
        position_slack: f64,
        normal_slack: f64,
    ) -> Result<Self, Error> {
        let name = checked_name(name.into())?;
        check_slacks(position_slack, normal_slack)?;
        let mut surfaces = vec![Surface::Touchable; loops.len()];
        mark(&mut surfaces, "seams", seams, Surface::Seam)?;
        mark(&mut surfaces, "untouchable", untouchable, Surface::Untouchable)?;

        let mut mends = Vec::new();
        let solid = facets::of_loops(loops, &surfaces, &mut mends)?;
        Self::of_solid(name, solid, position_slack, normal_slack, mends)
    }

    fn of_solid(
        name: String,
        solid: Solid,
        position_slack: f64,
        normal_slack: f64,
        mends: Vec<Mend>,
    ) -> Result<Self, Error> {
        let Solid { points, faces, triangles, given, slacks, scale } = solid;
        let (edges, bends, all_paired) = edges(&points, &faces);
        let volume = volume(&points, &triangles);
        let no_volume = 1e-12 * largest_distance(&points).powi(3);
        if all_paired && volume < -no_volume {
            let remedy = "give loops counter-clockwise as seen from outside";
            return Err(Error::new(
                "loops",
                "bound a region from inside: their volume is negative",
                volume,
                remedy,
            ));
        }
        let vertices = vertices(&points, &faces, &edges, &bends, false);
        let reach = slacks.0 + scale.merge_tol;
        let places = Places { faces: &faces, edges: &edges, vertices, reach };
        let (vertices, turn) = places.completed(given);
        let slacks = solid::slacks(slacks.0, slacks.1.max(turn), scale);
        let size = largest_distance(&points);
        let (position_slack, normal_slack) = (position_slack + slacks.0, normal_slack + slacks.1);
        if slacks.1 > 0.0 && normal_slack >= FRAC_PI_2 {
            let problem = "are off or apart by so much that it is not known which way a narrow face faces";
            let value = format!("{:.1e}", slacks.0);
            return Err(Error::new("vertices", problem, value, "weld the corners where the mesh is made"));
        }
        check_slacks(position_slack, normal_slack)?;
        let parts = Parts {
            faces: &faces,
            edges: &edges,
            vertices: &vertices,
            size,
            precision: scale.precision(position_slack),
        };
        let Symmetries { group, miss } = symmetries(parts);
        let mut model = Self {
            name,
            faces,
            edges,
            vertices,
            triangles,
            closed: all_paired && volume > no_volume,
            symmetries: group,
            roundness: None,
            position_slack,
            normal_slack,
            mends,
            size,
            asymmetry: (miss.length, miss.turn),
            precision: scale.precision(slacks.0),
            tables: TableCache::default(),
            bvh: BvhCache::default(),
        };
        model.mends.extend(crossing::check(&model, scale.single_tol)?);
        model.roundness = roundness(&model);
        Ok(model)
    }
}

/// The volume that triangles bound, positive if they face outward.
fn volume(points: &[DVec3], triangles: &[([u32; 3], u32)]) -> f64 {
    let of_triangle = |(triangle, _): &([u32; 3], u32)| {
        let [a, b, c] = triangle.map(|k| points[k as usize] - points[0]);
        a.dot(b.cross(c)) / 6.0
    };
    triangles.iter().map(of_triangle).sum()
}

/// The largest distance between two points.
fn largest_distance(points: &[DVec3]) -> f64 {
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let middle = 0.5 * (low + high);
    let mut by_reach: Vec<(f64, DVec3)> = points.iter().map(|p| (p.distance(middle), *p)).collect();
    by_reach.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut largest = 0.0_f64;
    for (k, &(reach, point)) in by_reach.iter().enumerate() {
        // Two points are no further apart than both are from the middle.
        let far = by_reach[..k].iter().take_while(|other| other.0 + reach >= largest);
        largest = far.map(|other| point.distance(other.1)).fold(largest, f64::max);
    }
    largest
}

#[cfg(test)]
#[path = "model_tests.rs"]
mod tests;
