//! Corners as they were given, where merging has lost what may be touched there.
//!
//! Triangles of nearly one plane become one face, and points on nearly straight runs are dropped. That moves the surface by
//! no more than the slacks say; but where corners are as close together as that, a small move turns what is small by
//! much: the face gets a dent beside a corner that sticks out, or goes on where the corner was, and no cone is left. Every
//! normal with which a tip may rest on a corner of the triangles as given must be, to within the slacks, one of a place of
//! the model nearby: of a face, an edge or a vertex. Where it is off by no more than rounding turns planes, it counts as a
//! slack; where it is off by more, the corner's own cone is added.

use glam::DVec3;

use super::cones::{joined, vertices};
use super::edges::edges;
use super::model::{Edge, Face, Vertex};
use super::motions::beyond;
use super::regions::TURN_TOL;
use super::solid::Draft;
use super::spherical::{ANGLE_ROUNDING, angle};

/// Corners of triangles as given on which a tip may rest.
pub(super) fn as_given(points: &[DVec3], drafts: &[Draft], is_torn: bool) -> Vec<Vertex> {
    let face = |draft: &Draft, triangle: [u32; 3]| {
        let [a, b, c] = triangle.map(|k| points[k as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        Face {
            normal,
            offset: normal.dot(a),
            loops: vec![triangle.to_vec()],
            pieces: Vec::new(),
            surface: draft.surface,
        }
    };
    let of_draft = |draft: &Draft| draft.given.iter().map(|t| face(draft, *t)).collect::<Vec<_>>();
    let faces: Vec<Face> = drafts.iter().flat_map(of_draft).collect();
    let (edges, bends, _) = edges(points, &faces);
    let mut given = vertices(points, &faces, &edges, &bends, is_torn);
    given.retain(|corner| corner.normals.is_some());
    given
}

/// What can be touched of a model that is being made.
pub(super) struct Places<'a> {
    pub(super) faces: &'a [Face],
    pub(super) edges: &'a [Edge],
    pub(super) vertices: Vec<Vertex>,
    /// Places that are no further apart are the same.
    pub(super) reach: f64,
}

impl Places<'_> {
    /// The vertices, with the cones of corners as given that no place there is has; and by how much the others may be off.
    pub(super) fn completed(mut self, given: Vec<Vertex>) -> (Vec<Vertex>, f64) {
        let mut worst = 0.0_f64;
        for corner in given {
            let Some(cone) = corner.normals.as_deref() else { continue };
            let turn = self.turn(corner.point, cone);
            if turn <= TURN_TOL {
                worst = worst.max(turn);
                continue;
            }
            match self.vertices.iter_mut().find(|vertex| vertex.point == corner.point) {
                Some(vertex) => {
                    let both = vertex.normals.as_deref().and_then(|known| joined(known, cone));
                    vertex.normals = both.or_else(|| Some(cone.to_vec()));
                }
                None => self.vertices.push(corner),
            }
        }
        (self.vertices, worst)
    }

    /// No normal of a cone is further from those of a place near the point, if there is a place.
    fn turn(&self, point: DVec3, cone: &[DVec3]) -> f64 {
        // A mean of normals is off by no more than the mean of what they are off, over its length.
        let middle = cone.iter().sum::<DVec3>().normalize_or_zero();
        let narrow = cone.iter().map(|normal| normal.dot(middle)).fold(1.0, f64::min);
        if narrow <= 0.0 {
            return f64::INFINITY;
        }
        let worst = |off: &dyn Fn(DVec3) -> f64| cone.iter().map(|normal| off(*normal)).fold(0.0, f64::max);
        let at = |k: u32| self.vertices[k as usize].point;
        let of_vertex = |vertex: &Vertex| {
            let normals = vertex.normals.as_ref().filter(|_| vertex.point.distance(point) <= self.reach)?;
            Some(worst(&|normal| beyond(normals, normal)))
        };
        let of_edge = |edge: &Edge| {
            let [a, b] = edge.ends.map(at);
            let normals = edge.normals.filter(|_| from_side(point, a, b) <= self.reach)?;
            Some(worst(&|normal| beyond(&normals, normal)))
        };
        let of_face = |face: &Face| {
            let is_near = face.is_touchable()
                && (face.normal.dot(point) - face.offset).abs() <= self.reach
                && face.pieces.iter().any(|piece| self.is_beside(point, piece, face.normal));
            is_near.then(|| worst(&|normal| angle(face.normal, normal)))
        };
        let of_vertices = self.vertices.iter().filter_map(of_vertex);
        let of_edges = self.edges.iter().filter_map(of_edge);
        let of_faces = self.faces.iter().filter_map(of_face);
        let mut least = f64::INFINITY;
        // Nearly all corners are vertices with the same cone.
        for turn in of_vertices.chain(of_edges).chain(of_faces) {
            least = least.min(turn);
            if least <= ANGLE_ROUNDING {
                break;
            }
        }
        least / narrow
    }

    /// Whether a point that is near the plane of a convex polygon is near the polygon.
    fn is_beside(&self, point: DVec3, polygon: &[u32], normal: DVec3) -> bool {
        let at = |k: u32| self.vertices[k as usize].point;
        let mut sides = polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(a, b)| [at(*a), at(*b)]);
        sides.clone().all(|[a, b]| normal.cross(b - a).dot(point - a) >= 0.0)
            || sides.any(|[a, b]| from_side(point, a, b) <= self.reach)
    }
}

/// How far a point is from the line between two others.
fn from_side(point: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = ((point - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
    point.distance(a.lerp(b, along))
}
