//! Pair tables of planar features and of planar contacts (thesis 2.2.1–2.2.2, corrected by MATH 1.1 and 2.2).

use crate::part::Surface;
use std::f64::consts::{PI, TAU};
use std::sync::{Arc as Shared, OnceLock};

use glam::DVec2;

use super::arc::{Arc, wrap};
use super::case::Case;
use super::distance::{segment_to_segment, to_segment};
use super::model::{Face, Model};
use crate::feature::Feature;
use crate::tree::{ContactPairs, FeaturePairs, PairRange, Range};

/// A range that everything meets.
const ALL: Range = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };

/// A feature as the tables see it: the segment that it is (a vertex is both ends at once) and its normals.
#[derive(Debug, Clone, Copy)]
struct Element {
    feature: Feature,
    start: DVec2,
    end: DVec2,
    normals: Arc,
}

/// The features that can be touched, of the kinds asked for, with the ranges of every ordered pair.
#[derive(Debug)]
pub(crate) struct FeatureTables {
    elements: Vec<Element>,
    pairs: Vec<PairRange>,
    /// Elements by the start of their normals, in `[-π, π)`: the index.
    by_angle: Vec<(f64, usize)>,
    /// The widest cone of normals.
    widest: f64,
}

/// The tables of a model, by the kinds of features asked for: made once, with the model (thesis 2.2: "offline").
#[derive(Debug, Clone, Default)]
pub(crate) struct TableCache([OnceLock<Shared<FeatureTables>>; 4]);

impl PartialEq for TableCache {
    /// Tables follow from the model: they make no two models differ.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Model {
    /// The tables of the kinds of features asked for.
    pub(crate) fn feature_tables(&self, faces: bool, vertices: bool) -> &FeatureTables {
        let kinds = usize::from(faces) + 2 * usize::from(vertices);
        self.tables.0[kinds].get_or_init(|| Shared::new(FeatureTables::new(self, faces, vertices)))
    }
}

/// Above this many features the ranges of a pair are computed when asked for (64 bytes a pair are not spent).
const MOST_STORED: usize = 1500;

impl FeatureTables {
    pub fn new(model: &Model, faces: bool, vertices: bool) -> Self {
        let elements = elements(model, faces, vertices);
        let stored = if elements.len() <= MOST_STORED { elements.as_slice() } else { &[] };
        let pairs =
            stored.iter().flat_map(|first| stored.iter().map(|second| pair_range(first, second))).collect();
        let mut by_angle: Vec<(f64, usize)> =
            elements.iter().enumerate().map(|(k, element)| (wrap(element.normals.start), k)).collect();
        by_angle.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let widest = elements.iter().map(|element| element.normals.width).fold(0.0, f64::max);
        Self { elements, pairs, by_angle, widest }
    }

    /// All of them, in increasing order.
    pub fn features(&self) -> Vec<Feature> {
        self.elements.iter().map(|element| element.feature).collect()
    }

    /// The feature with a table number.
    pub fn feature(&self, number: usize) -> Feature {
        self.elements[number].feature
    }

    /// The tables of the contacts of a case, against these features.
    pub fn contact_pairs(&self, case: &Case) -> ContactPairs {
        let sensed: Vec<Sensed> = (0..case.data.len()).map(|contact| Sensed::new(case, contact)).collect();
        let candidates = (0..sensed.len()).map(|contact| self.candidates(case, contact)).collect();
        let pairs = sensed.iter().enumerate().map(|(second, later)| {
            sensed[..second].iter().map(|earlier| sensed_range(earlier, later)).collect()
        });
        ContactPairs { candidates, pairs: pairs.collect() }
    }

    /// What contact `i` may lie on by itself: everything, but for the prior.
    fn candidates(&self, case: &Case, contact: usize) -> Vec<usize> {
        let possible = |element: &Element| {
            let Some(prior) = case.prior else { return true };
            let Some(site) = case.site(contact, element.feature) else { return false };
            let range =
                Arc::around(prior.world_from_model.angle(), prior.rotation).widen(case.angle_tolerance);
            if case.rotations(contact, &site, case.angle_tolerance).intersect(range).is_empty() {
                return false;
            }
            // Every place of the segment is near its place at the middle of the prior.
            let reach = element.start.length().max(element.end.length());
            let turn = 2.0 * (0.5 * prior.rotation.min(PI)).sin() * reach;
            let slack = prior.translation * std::f64::consts::SQRT_2
                + turn
                + case.data[contact].bound
                + case.data[contact].radius
                + case.length_tolerance;
            let [start, end] = [element.start, element.end].map(|point| prior.world_from_model.apply(point));
            to_segment(case.pivot + case.data[contact].lever, [start, end]) <= slack
        };
        (0..self.elements.len()).filter(|&k| possible(&self.elements[k])).collect()
    }
}

impl FeaturePairs for FeatureTables {
    fn pair(&self, first: usize, second: usize) -> PairRange {
        let count = self.elements.len();
        match self.pairs.get(first * count + second) {
            Some(range) => *range,
            None => pair_range(&self.elements[first], &self.elements[second]),
        }
    }

    fn near_angle(&self, first: usize, angle: Range) -> Option<impl Iterator<Item = usize>> {
        // angle = (first's normal) − (second's): the second's normals start within this arc.
        let own = self.elements[first].normals;
        let low = own.start - angle.high - self.widest;
        let width = own.width + angle.high - angle.low + self.widest;
        // A circle nearly covered is better walked in order.
        (width < 0.75 * TAU).then(|| {
            let low = wrap(low - 1e-9);
            let from = self.by_angle.partition_point(|(start, _)| *start < low);
            let rotated = self.by_angle[from..].iter().chain(&self.by_angle[..from]);
            rotated
                .take_while(move |(start, _)| (start - low).rem_euclid(TAU) <= width + 2e-9)
                .map(|(_, number)| *number)
        })
    }
}

fn elements(model: &Model, faces: bool, vertices: bool) -> Vec<Element> {
    let of_face = |(number, face): (usize, &Face)| Element {
        feature: Feature::Face(number as u32),
        start: face.start,
        end: face.end,
        normals: Arc { start: face.normal.to_angle(), width: 0.0 },
    };
    let touchable = model.faces.iter().enumerate().filter(|(_, face)| face.surface == Surface::Touchable);
    let convex = model.vertices.iter().enumerate().filter_map(|(number, vertex)| {
        let feature = Feature::Vertex(number as u32);
        vertex.normals.map(|normals| Element { feature, start: vertex.point, end: vertex.point, normals })
    });
    let faces = touchable.map(of_face).filter(|_| faces);
    faces.chain(convex.filter(|_| vertices)).collect()
}

/// Ranges of a pair of features, interiors included (errata 7–13, 74; MATH 2.2).
fn pair_range(first: &Element, second: &Element) -> PairRange {
    let ends = |element: &Element| [element.start, element.end];
    let offsets = ends(first).map(|from| ends(second).map(|to| to - from));
    let lengths = offsets.as_flattened().iter().map(|offset| offset.length());
    let longest = lengths.fold(0.0, f64::max);
    let angle = Range {
        low: first.normals.start - second.normals.start - second.normals.width,
        high: first.normals.start + first.normals.width - second.normals.start,
    };
    PairRange {
        distance: Range { low: segment_to_segment(ends(first), ends(second)), high: longest },
        angle,
        direction: along_normals(first.normals, offsets.as_flattened()),
        direction_back: along_normals(
            second.normals,
            &offsets.as_flattened().iter().map(|o| -o).collect::<Vec<_>>(),
        ),
    }
}

/// Least and greatest `n·Δ` over normals `n` of a cone and offsets Δ.
fn along_normals(normals: Arc, offsets: &[DVec2]) -> Range {
    let most = |offset: DVec2| offset.length() * normals.distance(offset.to_angle()).cos();
    Range {
        low: offsets.iter().map(|offset| -most(-*offset)).fold(f64::INFINITY, f64::min),
        high: offsets.iter().map(|offset| most(*offset)).fold(f64::NEG_INFINITY, f64::max),
    }
}

/// A contact's surface point and normal with their bounds, τ included.
struct Sensed {
    point: DVec2,
    bound: f64,
    normals: Option<Arc>,
}

impl Sensed {
    /// The surface point is the tip's centre less the radius along the normal; where the normal is known only within
    /// a cone, the chord of the cone adds to the bound.
    fn new(case: &Case, contact: usize) -> Self {
        let datum = &case.data[contact];
        let normals = datum.normals.map(|normals| normals.widen(case.angle_tolerance));
        let bound = datum.bound + case.length_tolerance;
        match normals {
            Some(arc) if datum.radius > 0.0 && arc.half_width() < 1.0 => Self {
                point: datum.lever - datum.radius * DVec2::from_angle(arc.middle()),
                bound: bound + 2.0 * datum.radius * (0.5 * arc.half_width()).sin(),
                normals,
            },
            _ => Self { point: datum.lever, bound: bound + datum.radius, normals },
        }
    }
}

fn sensed_range(first: &Sensed, second: &Sensed) -> PairRange {
    let offset = second.point - first.point;
    let error = first.bound + second.bound;
    let length = offset.length();
    let angle = match (first.normals, second.normals) {
        (Some(a), Some(b)) => Range { low: a.start - b.start - b.width, high: a.start + a.width - b.start },
        _ => Range { low: -PI, high: PI },
    };
    let along = |normals: Option<Arc>, offset: DVec2| {
        normals.map_or(ALL, |normals| {
            let range = along_normals(normals, &[offset]);
            Range { low: range.low - error, high: range.high + error }
        })
    };
    PairRange {
        distance: Range { low: (length - error).max(0.0), high: length + error },
        angle,
        direction: along(first.normals, offset),
        direction_back: along(second.normals, -offset),
    }
}
