//! Pair tables of the features of a solid and of contacts in space (thesis 2.2.1–2.2.2, corrected by MATH 1.1, rows
//! 1–19, and 2.2).
//!
//! Up to [`MOST_STORED`] features, the ranges of every pair are stored in 16 bytes, one order of the two: 18 MB at
//! most. Above, they are computed when asked for, the distance from bounding balls and boxes, so that memory is linear
//! in the features and their corners: less than a kilobyte for each.

use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, OnceLock};

use glam::DVec3;
use rayon::prelude::*;

use super::angle_index::AngleIndex;
use super::gap::Piece;
use super::model::{Face, Model};
use super::quantized::{Packed, Quantizer};
use super::sensed::{Sensed, sensed_range};
use super::spherical::Cone;
use crate::feature::Feature;
use crate::part::Surface;
use crate::recognize::Halt;
use crate::tree::{ContactPairs, FeaturePairs, PairRange, Range};

/// Above this many features the ranges of a pair are computed when asked for.
pub(crate) const MOST_STORED: usize = 1500;

/// Lengths are rounded outward by so much of the largest distance of a corner from the origin.
const ROUNDING: f64 = 1e-12;

/// The same for a least distance between sides, which may be nearly parallel.
const LEAST_ROUNDING: f64 = 1e-7;

/// Which kinds of features a table has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Kinds {
    pub faces: bool,
    pub edges: bool,
    pub vertices: bool,
}

impl Kinds {
    /// A number below 8.
    pub fn number(self) -> u8 {
        u8::from(self.faces) + 2 * u8::from(self.edges) + 4 * u8::from(self.vertices)
    }
}

/// A feature as the tables see it.
#[derive(Debug)]
pub(super) struct Element {
    pub feature: Feature,
    /// Its convex hull is that of the feature: the corners of a face's outer loop, the ends of an edge, a vertex.
    pub points: Vec<DVec3>,
    /// They make up the feature.
    pub pieces: Vec<Piece>,
    pub cone: Cone,
    /// What bounds it: a ball and a box.
    center: DVec3,
    radius: f64,
    half_size: DVec3,
    /// No corner of a face is further from its plane.
    flatness: f64,
}

/// The features that can be touched, of the kinds asked for, with the ranges of every ordered pair.
#[derive(Debug)]
pub(crate) struct FeatureTables {
    pub(super) elements: Vec<Element>,
    /// Pairs `first ≤ second`, row by row; none if they are computed when asked for.
    pub(super) pairs: Vec<Packed>,
    quantizer: Quantizer,
    index: AngleIndex,
    /// The largest distance of a corner from the origin: the scale of rounding.
    reach: f64,
}

/// The tables of a model, by the kinds of features asked for: made once, with the model (thesis 2.2: "offline").
#[derive(Debug, Clone, Default)]
pub(crate) struct TableCache(pub(super) [OnceLock<Arc<FeatureTables>>; 8]);

impl PartialEq for TableCache {
    /// Tables follow from the model: they make no two models differ.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Model {
    /// The tables of the kinds of features asked for.
    pub(crate) fn feature_tables(&self, kinds: Kinds) -> Arc<FeatureTables> {
        self.feature_tables_until(kinds, &Halt::default())
    }

    /// The same; soon after `stop` is set those that compute the ranges of pairs when asked for, which are not kept.
    pub(crate) fn feature_tables_until(&self, kinds: Kinds, stop: &Halt) -> Arc<FeatureTables> {
        let slot = &self.tables.0[usize::from(kinds.number())];
        if let Some(known) = slot.get() {
            return Arc::clone(known);
        }
        let (made, whole) = FeatureTables::until(self, kinds, stop);
        let made = Arc::new(made);
        if whole { Arc::clone(slot.get_or_init(|| made)) } else { made }
    }
}

impl FeatureTables {
    #[cfg(test)]
    pub fn new(model: &Model, kinds: Kinds) -> Self {
        Self::until(model, kinds, &Halt::default()).0
    }

    /// And whether they are whole: they are without pairs if `stop` is set meanwhile.
    fn until(model: &Model, kinds: Kinds, stop: &Halt) -> (Self, bool) {
        let mut tables = Self::unfilled(model, kinds);
        if tables.elements.len() > MOST_STORED {
            return (tables, true);
        }
        let pairs = tables.filled(stop);
        let whole = pairs.is_some();
        tables.pairs = pairs.unwrap_or_default();
        (tables, whole)
    }

    /// All but the pairs.
    pub(super) fn unfilled(model: &Model, kinds: Kinds) -> Self {
        let elements = elements(model, kinds);
        let points = || elements.iter().flat_map(|element| &element.points);
        let reach = points().map(|point| point.length()).fold(0.0, f64::max);
        let middle = center(points());
        let radius = points().map(|point| point.distance(middle)).fold(0.0, f64::max);
        let index = AngleIndex::new(elements.iter().map(|element| &element.cone));
        let flatness = elements.iter().map(|element| element.flatness).fold(0.0, f64::max);
        // No end of a range is larger: the diameter of a ball about all, and what is added to either end.
        let longest = 2.0 * (radius + flatness) + LEAST_ROUNDING * reach + f64::MIN_POSITIVE;
        Self { elements, pairs: Vec::new(), quantizer: Quantizer::new(longest), index, reach }
    }

    /// Every pair `first ≤ second`, row by row; nothing if `stop` is set meanwhile.
    fn filled(&self, stop: &Halt) -> Option<Vec<Packed>> {
        let count = self.elements.len();
        let row = |first: usize| {
            let seconds = if stop.load(Relaxed) { count..count } else { first..count };
            seconds.map(move |second| self.quantizer.pack(&self.exact(first, second)))
        };
        let pairs: Vec<Packed> = (0..count).into_par_iter().flat_map_iter(row).collect();
        (pairs.len() == count * (count + 1) / 2).then_some(pairs)
    }

    /// All of them, in increasing order.
    pub fn features(&self) -> Vec<Feature> {
        self.elements.iter().map(|element| element.feature).collect()
    }

    /// The feature with a table number.
    pub fn feature(&self, number: usize) -> Feature {
        self.elements[number].feature
    }

    /// The tables of contacts, each of which may lie on its candidates by itself.
    pub fn contact_pairs(&self, sensed: &[Sensed], candidates: Vec<Vec<usize>>) -> ContactPairs {
        debug_assert!(candidates.iter().flatten().all(|&number| number < self.elements.len()));
        let pairs = sensed.iter().enumerate().map(|(second, later)| {
            sensed[..second].iter().map(|earlier| sensed_range(earlier, later)).collect()
        });
        ContactPairs { candidates, pairs: pairs.collect() }
    }

    /// Ranges of a pair, exact but for rounding outward (MATH 2.2).
    pub(super) fn exact(&self, first: usize, second: usize) -> PairRange {
        let [first, second] = [&self.elements[first], &self.elements[second]];
        let (least, most) = distances(first, second);
        let low = if least > 0.0 { least - LEAST_ROUNDING * self.reach } else { 0.0 };
        self.pair_range(first, second, Range { low, high: most })
    }

    /// The same with distances from what bounds the two.
    pub(super) fn bounded(&self, first: usize, second: usize) -> PairRange {
        let [first, second] = [&self.elements[first], &self.elements[second]];
        self.pair_range(first, second, bounded_distance(first, second))
    }

    fn pair_range(&self, first: &Element, second: &Element, distance: Range) -> PairRange {
        let rounding = ROUNDING * self.reach + first.flatness + second.flatness;
        let distance = distance.widened(rounding);
        PairRange {
            distance: Range { low: distance.low.max(0.0), high: distance.high },
            angle: first.cone.angle(&second.cone),
            direction: along_normals(first, second).widened(rounding),
            direction_back: along_normals(second, first).widened(rounding),
        }
    }
}

impl FeaturePairs for FeatureTables {
    fn pair(&self, first: usize, second: usize) -> PairRange {
        if self.pairs.is_empty() {
            return self.bounded(first, second);
        }
        let (low, high) = (first.min(second), first.max(second));
        // Rows before this one have one pair less each.
        let row = low * self.elements.len() - low * low.saturating_sub(1) / 2;
        let stored = self.quantizer.unpack(self.pairs[row + high - low]);
        if first <= second {
            return stored;
        }
        PairRange { direction: stored.direction_back, direction_back: stored.direction, ..stored }
    }

    fn near_angle(&self, first: usize, angle: Range) -> Option<impl Iterator<Item = usize>> {
        // A sphere nearly covered is better walked in order.
        (angle.high - angle.low < 0.75 * std::f64::consts::PI).then(|| {
            let (step, _) = self.quantizer.steps();
            self.index.near(&self.elements[first].cone, angle.widened(2.0 * step))
        })
    }
}

fn elements(model: &Model, kinds: Kinds) -> Vec<Element> {
    let point = |number: &u32| model.vertices[*number as usize].point;
    let of_face = |(number, face): (usize, &Face)| {
        let corners = |numbers: &Vec<u32>| numbers.iter().map(point).collect::<Vec<_>>();
        let all = face.loops.iter().flatten().map(point);
        let flatness = all.map(|corner| (face.normal.dot(corner) - face.offset).abs()).fold(0.0, f64::max);
        let pieces = face.pieces.iter().map(|piece| Piece::new(corners(piece), face.normal)).collect();
        let outer = face.loops.first().map(corners).unwrap_or_default();
        Element::new(Feature::Face(number as u32), outer, pieces, &[face.normal], flatness)
    };
    let touchable = model.faces.iter().enumerate().filter(|(_, face)| face.surface == Surface::Touchable);
    let edges = model.edges.iter().enumerate().filter_map(|(number, edge)| {
        let ends = edge.ends.iter().map(point).collect::<Vec<_>>();
        let pieces = vec![Piece::new(ends.clone(), DVec3::ZERO)];
        edge.normals.map(|normals| Element::new(Feature::Edge(number as u32), ends, pieces, &normals, 0.0))
    });
    let vertices = model.vertices.iter().enumerate().filter_map(|(number, vertex)| {
        let piece = Piece::new(vec![vertex.point], DVec3::ZERO);
        let feature = Feature::Vertex(number as u32);
        let normals = vertex.normals.as_ref()?;
        Some(Element::new(feature, vec![vertex.point], vec![piece], normals, 0.0))
    });
    let faces = touchable.map(of_face).filter(|_| kinds.faces);
    faces.chain(edges.filter(|_| kinds.edges)).chain(vertices.filter(|_| kinds.vertices)).collect()
}

impl Element {
    fn new(
        feature: Feature,
        points: Vec<DVec3>,
        pieces: Vec<Piece>,
        normals: &[DVec3],
        flatness: f64,
    ) -> Self {
        let center = center(points.iter());
        let offsets = || points.iter().map(|point| *point - center);
        let radius = offsets().map(DVec3::length).fold(0.0, f64::max);
        let half_size = offsets().map(DVec3::abs).fold(DVec3::ZERO, DVec3::max);
        Self { feature, pieces, cone: Cone::new(normals), center, radius, half_size, flatness, points }
    }

    /// Every corner of the first seen from every corner of the second.
    fn offsets<'a>(&'a self, second: &'a Self) -> impl Iterator<Item = DVec3> + 'a {
        self.points.iter().flat_map(|from| second.points.iter().map(move |to| *to - *from))
    }
}

/// The middle of the box about some points.
fn center<'a>(points: impl Iterator<Item = &'a DVec3> + Clone) -> DVec3 {
    let low = points.clone().fold(DVec3::INFINITY, |low, point| low.min(*point));
    let high = points.fold(DVec3::NEG_INFINITY, |high, point| high.max(*point));
    0.5 * (low + high)
}

/// Least and greatest distance between two features, interiors included (MATH 1.1, rows 7–13).
fn distances(first: &Element, second: &Element) -> (f64, f64) {
    let mut least_sq = f64::INFINITY;
    let mut most_sq: f64 = 0.0;
    for offset in first.offsets(second) {
        let length_sq = offset.length_squared();
        least_sq = least_sq.min(length_sq);
        most_sq = most_sq.max(length_sq);
    }
    let mut least = least_sq.sqrt();
    for piece in &first.pieces {
        for other in &second.pieces {
            if least > 0.0 {
                least = piece.distance(other, least);
            }
        }
    }
    (least, most_sq.sqrt())
}

/// A range of distances that holds the true one: between balls, and between boxes about the same middles.
fn bounded_distance(first: &Element, second: &Element) -> Range {
    let offset = second.center - first.center;
    let (apart, radii) = (offset.length(), first.radius + second.radius);
    let half_size = first.half_size + second.half_size;
    let gap = (offset.abs() - half_size).max(DVec3::ZERO).length();
    let span = (offset.abs() + half_size).length();
    Range { low: gap.max(apart - radii), high: span.min(apart + radii) }
}

/// Least and greatest `n · (y − x)` over normals `n` and points `x` of the first and points `y` of the second.
fn along_normals(first: &Element, second: &Element) -> Range {
    if let Some(normal) = first.cone.single() {
        let heights = |element: &Element| {
            element.points.iter().map(|point| normal.dot(*point)).fold(
                Range { low: f64::INFINITY, high: f64::NEG_INFINITY },
                |range, height| Range { low: range.low.min(height), high: range.high.max(height) },
            )
        };
        let [own, other] = [first, second].map(heights);
        return Range { low: other.low - own.high, high: other.high - own.low };
    }
    first.offsets(second).fold(Range { low: f64::INFINITY, high: f64::NEG_INFINITY }, |range, offset| Range {
        low: range.low.min(-first.cone.most(-offset)),
        high: range.high.max(first.cone.most(offset)),
    })
}
