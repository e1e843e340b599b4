//! Planar models: faces (line segments), vertices, and their symmetries.
//!
//! Material is on the left of every face `start → end`, so that its normal points to the right. Corners that turn
//! left are therefore convex, those of a hole as well.

use glam::DVec2;

use super::outline::{self, Outline};
use super::segments;
use super::symmetry::{asymmetry, symmetries};
use super::tables::TableCache;
use super::{Arc, Pose};
use crate::part::{Mend, Surface, check_slacks, checked_name, mark};
use crate::{Error, Feature};

/// A line segment with its outward normal on the right of `start → end`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Face {
    /// First end, model frame.
    pub start: DVec2,
    /// Second end.
    pub end: DVec2,
    /// Unit outward normal.
    pub normal: DVec2,
    /// What it is to a probe.
    pub surface: Surface,
}

/// A corner of the outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Model frame.
    pub point: DVec2,
    /// The outward normals there, if the corner is convex and both its faces can be touched; `None` can't be touched.
    pub normals: Option<Arc>,
}

/// A rigid motion that maps the model onto itself, and where it takes each feature.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetry {
    /// `model * motion` is the same placed part.
    pub motion: Pose,
    /// `faces[k]` is the face on which face `k` comes to lie.
    pub faces: Vec<u32>,
    /// `vertices[k]` is the vertex on which vertex `k` comes to lie.
    pub vertices: Vec<u32>,
}

/// A part in the plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Its name.
    pub name: String,
    /// In face-number order.
    pub faces: Vec<Face>,
    /// In vertex-number order; of a polygon, face `k` begins at vertex `k`.
    pub vertices: Vec<Vertex>,
    /// Its faces bound a region (a polygon): inside and outside are known.
    pub closed: bool,
    /// The motions that map it onto itself, the identity first.
    pub symmetries: Vec<Symmetry>,
    /// How far the true outline may lie from the faces (flattening): added to each position error.
    pub position_slack: f64,
    /// How far the true normal may be from the faces' (flattening), radians: added to each normal error.
    pub normal_slack: f64,
    /// What was mended when it was read.
    pub mends: Vec<Mend>,
    /// The largest distance between two of its vertices.
    pub size: f64,
    /// By how much its symmetries miss, at most: a corner its image, and a face's normal, radians.
    pub asymmetry: (f64, f64),
    /// Its pair tables, made when first needed.
    pub(super) tables: TableCache,
}

impl Symmetry {
    /// The feature on which `feature` comes to lie.
    #[must_use]
    pub fn feature(&self, feature: Feature) -> Feature {
        match feature {
            Feature::Face(number) => Feature::Face(self.faces[number as usize]),
            Feature::Vertex(number) => Feature::Vertex(self.vertices[number as usize]),
            Feature::Edge(_) => feature,
        }
    }

    /// The features on which `features` come to lie.
    #[must_use]
    pub fn features(&self, features: &[Feature]) -> Vec<Feature> {
        features.iter().map(|feature| self.feature(*feature)).collect()
    }
}

impl Face {
    /// The face from `start` to `end`, which must differ.
    pub(super) fn new(start: DVec2, end: DVec2, surface: Surface) -> Self {
        let along = (end - start).normalize_or_zero();
        Self { start, end, normal: -along.perp(), surface }
    }

    /// Its length.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.start.distance(self.end)
    }

    /// Whether a probe can touch it.
    #[must_use]
    pub fn is_touchable(&self) -> bool {
        self.surface == Surface::Touchable
    }
}

impl Vertex {
    /// The corner where `before` ends and `after` begins.
    pub(super) fn between(before: &Face, after: &Face) -> Self {
        let convex = outline::turn(before.start, after.start, after.end) > 0.0;
        let touchable = before.is_touchable() && after.is_touchable();
        let normals = (convex && touchable).then(|| Self::cone(before, after));
        Self { point: after.start, normals }
    }

    /// From the first face's normal on to the second's, counter-clockwise.
    pub(super) fn cone(before: &Face, after: &Face) -> Arc {
        Arc { start: before.normal.to_angle(), width: before.normal.angle_to(after.normal).abs() }
    }
}

impl Model {
    /// A part bounded by `vertices`, less its `holes`. Face `k` begins at vertex `k` and runs to the next of its loop;
    /// the loops follow one another, the outer one first.
    ///
    /// Whatever can be mended is, and `mends` says so: loops that run the wrong way round, a repeated first point,
    /// doubled points, points on straight runs. `untouchable` numbers faces as given, face `k` beginning at the `k`-th
    /// given point; they are followed through the mending.
    ///
    /// ```
    /// use glam::dvec2;
    /// use palpate::plane::Model;
    ///
    /// let corners = [dvec2(0.0, 0.0), dvec2(30.0, 0.0), dvec2(30.0, 20.0), dvec2(0.0, 20.0)];
    /// let plate = Model::polygon("plate", &corners, &[], &[], 0.0, 0.0).unwrap();
    /// assert_eq!(plate.faces[1].normal, dvec2(1.0, 0.0));
    /// assert_eq!(plate.symmetries.len(), 2);
    /// ```
    ///
    /// # Errors
    /// Fewer than three distinct points, numbers that are not finite, no area, loops that turn back on, cross or touch
    /// themselves or each other, a hole outside the outline or inside another hole, a face number out of range, an
    /// empty name, a slack out of range.
    pub fn polygon(
        name: impl Into<String>,
        vertices: &[DVec2],
        holes: &[Vec<DVec2>],
        untouchable: &[usize],
        position_slack: f64,
        normal_slack: f64,
    ) -> Result<Self, Error> {
        let name = checked_name(name.into())?;
        check_slacks(position_slack, normal_slack)?;
        let mut surfaces =
            vec![Surface::Touchable; vertices.len() + holes.iter().map(Vec::len).sum::<usize>()];
        mark(&mut surfaces, "untouchable", untouchable, Surface::Untouchable)?;

        let mut mends = Vec::new();
        let loops = outline::clean(vertices, holes, &surfaces, &mut mends)?;
        let model = Self::of_features(name, features_of(&loops), true);
        Ok(Self { position_slack, normal_slack, mends, ..model })
    }

    /// A part given by loose faces, each with its normal on the right of `start → end`. Numbers in `seams` and
    /// `untouchable` are places in `segments`. Ends that coincide form one vertex.
    ///
    /// ```
    /// use glam::dvec2;
    /// use palpate::{Surface, plane::Model};
    ///
    /// let bracket = [[dvec2(0.0, 0.0), dvec2(40.0, 0.0)], [dvec2(40.0, 0.0), dvec2(40.0, 15.0)]];
    /// let model = Model::segments("bracket", &bracket, &[], &[0], 0.0, 0.0).unwrap();
    /// assert_eq!(model.faces[0].surface, Surface::Untouchable);
    /// assert_eq!(model.vertices.len(), 3);
    /// ```
    ///
    /// # Errors
    /// No segment that is there, numbers that are not finite, a segment number out of range or named both as a seam
    /// and as untouchable, an empty name, a slack out of range.
    pub fn segments(
        name: impl Into<String>,
        segments: &[[DVec2; 2]],
        seams: &[usize],
        untouchable: &[usize],
        position_slack: f64,
        normal_slack: f64,
    ) -> Result<Self, Error> {
        let name = checked_name(name.into())?;
        check_slacks(position_slack, normal_slack)?;
        let mut surfaces = vec![Surface::Touchable; segments.len()];
        mark(&mut surfaces, "seams", seams, Surface::Seam)?;
        mark(&mut surfaces, "untouchable", untouchable, Surface::Untouchable)?;

        let mut mends = Vec::new();
        let model = Self::of_features(name, segments::join(segments, &surfaces, &mut mends)?, false);
        Ok(Self { position_slack, normal_slack, mends, ..model })
    }

    fn of_features(name: String, (faces, vertices): (Vec<Face>, Vec<Vertex>), closed: bool) -> Self {
        let size = largest_distance(&vertices);
        let symmetries = symmetries(&faces, &vertices, size);
        let asymmetry = asymmetry(&faces, &vertices, &symmetries);
        Self {
            name,
            faces,
            vertices,
            closed,
            symmetries,
            position_slack: 0.0,
            normal_slack: 0.0,
            mends: Vec::new(),
            size,
            asymmetry,
            tables: TableCache::default(),
        }
    }
}

impl Model {
    /// Of the assignments that the symmetries take into this one, the first.
    pub(crate) fn representative(&self, assignment: Vec<Feature>) -> Vec<Feature> {
        self.symmetries.iter().map(|symmetry| symmetry.features(&assignment)).min().unwrap_or(assignment)
    }
}

/// Face `k` begins at vertex `k`.
fn features_of(loops: &[Outline]) -> (Vec<Face>, Vec<Vertex>) {
    let (mut faces, mut vertices) = (Vec::new(), Vec::new());
    for outline in loops {
        let first = faces.len();
        faces.extend(
            outline.edges().map(|(corner, next)| Face::new(corner.point, next.point, corner.surface)),
        );
        let of_loop = &faces[first..];
        let before = of_loop.iter().cycle().skip(of_loop.len() - 1);
        vertices.extend(before.zip(of_loop).map(|(before, after)| Vertex::between(before, after)));
    }
    (faces, vertices)
}

fn largest_distance(vertices: &[Vertex]) -> f64 {
    let mut largest_sq = 0.0_f64;
    for (k, vertex) in vertices.iter().enumerate() {
        let farthest_sq = vertices[..k].iter().map(|other| vertex.point.distance_squared(other.point));
        largest_sq = farthest_sq.fold(largest_sq, f64::max);
    }
    largest_sq.sqrt()
}

#[cfg(test)]
#[path = "model_tests.rs"]
mod tests;
