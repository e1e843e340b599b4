//! Where the centre of a tip may be when it rests on a feature, in the model's frame.

use arrayvec::ArrayVec;
use glam::DVec2;

use super::arc::{Arc, wrap};
use super::model::Model;
use crate::feature::Feature;

/// The places of a tip's centre on one feature (MATH 2.3.4): a face moved out by the radius, or an arc around a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Site {
    /// A face, moved outward by the tip's radius.
    Segment { start: DVec2, along: DVec2, length: f64 },
    /// The circle of the tip's radius around a convex vertex, over the vertex's normals.
    Arc { middle: DVec2, radius: f64, normals: Arc },
}

impl Site {
    /// Of a feature that can be touched; `None` if it can't be.
    pub fn new(model: &Model, feature: Feature, radius: f64) -> Option<Self> {
        match feature {
            Feature::Face(number) => {
                let face = model.faces.get(number as usize)?;
                let span = face.end - face.start;
                let length = span.length();
                (face.surface == crate::part::Surface::Touchable).then(|| Self::Segment {
                    start: face.start + radius * face.normal,
                    along: span / length,
                    length,
                })
            }
            Feature::Vertex(number) => {
                let vertex = model.vertices.get(number as usize)?;
                vertex.normals.map(|normals| Self::Arc { middle: vertex.point, radius, normals })
            }
            Feature::Edge(_) => None,
        }
    }

    /// The outward normals there, model frame.
    pub fn normals(&self) -> Arc {
        match *self {
            Self::Segment { along, .. } => Arc { start: (-along.perp()).to_angle(), width: 0.0 },
            Self::Arc { normals, .. } => normals,
        }
    }

    /// The rotations under which one of its normals falls into `sensed` (world frame): P1 of MATH 2.1.1.
    pub fn rotations(&self, sensed: Option<Arc>) -> Arc {
        let own = self.normals();
        match sensed {
            Some(sensed) if sensed.width + own.width < std::f64::consts::TAU => {
                Arc { start: wrap(sensed.start - own.start - own.width), width: sensed.width + own.width }
            }
            _ => Arc::FULL,
        }
    }

    /// The part of it whose normals fall into `allowed` (model frame).
    pub fn restrict(&self, allowed: Option<Arc>) -> ArrayVec<Self, 2> {
        match (*self, allowed) {
            (Self::Arc { middle, radius, normals }, Some(allowed)) => normals
                .intersect(allowed)
                .into_iter()
                .map(|normals| Self::Arc { middle, radius, normals })
                .collect(),
            (site, _) => std::iter::once(site).collect(),
        }
    }

    /// One site around its part whose normals fall into `allowed`; `None` if there is none.
    pub fn restrict_hull(&self, allowed: Option<Arc>) -> Option<Self> {
        match self.restrict(allowed).as_slice() {
            [] => None,
            [part] => Some(*part),
            _ => Some(*self),
        }
    }

    /// Its point nearest to `point`.
    pub fn nearest(&self, point: DVec2) -> DVec2 {
        match *self {
            Self::Segment { start, along, length } => {
                start + along * (point - start).dot(along).clamp(0.0, length)
            }
            Self::Arc { middle, radius, normals } => {
                let offset = point - middle;
                if radius == 0.0 || offset == DVec2::ZERO {
                    return middle + radius * DVec2::from_angle(normals.start);
                }
                if normals.distance(offset.to_angle()) == 0.0 {
                    return middle + offset * (radius / offset.length());
                }
                let ends = [normals.start, normals.start + normals.width];
                let [first, last] = ends.map(|angle| middle + radius * DVec2::from_angle(angle));
                if point.distance_squared(first) <= point.distance_squared(last) { first } else { last }
            }
        }
    }

    /// The largest value of `direction · x` over its convex hull; `direction` is a unit vector.
    pub fn support(&self, direction: DVec2) -> f64 {
        match *self {
            Self::Segment { start, along, length } => {
                direction.dot(start) + (length * direction.dot(along)).max(0.0)
            }
            Self::Arc { middle, radius, normals } => {
                let beyond = normals.distance(direction.to_angle());
                direction.dot(middle) + radius * beyond.cos()
            }
        }
    }

    /// Directions whose supports bound it well: along and across.
    pub fn directions(&self) -> [DVec2; 4] {
        let along = match *self {
            Self::Segment { along, .. } => along,
            Self::Arc { normals, .. } => DVec2::from_angle(normals.middle()),
        };
        [along.perp(), -along.perp(), along, -along]
    }

    /// Whether it is convex (an arc of a tip with a radius is not).
    pub fn convex(&self) -> bool {
        match *self {
            Self::Segment { .. } => true,
            Self::Arc { radius, .. } => radius == 0.0,
        }
    }

    /// The middle of its bounding box and the box's half sizes.
    pub fn bounds(&self) -> (DVec2, DVec2) {
        let side = |direction: DVec2| self.support(direction);
        let high = DVec2::new(side(DVec2::X), side(DVec2::Y));
        let low = -DVec2::new(side(-DVec2::X), side(-DVec2::Y));
        (0.5 * (low + high), 0.5 * (high - low))
    }
}
