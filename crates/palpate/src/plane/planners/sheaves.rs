//! Projection space (3.1 to 3.3): the lines through a face, the generator, by their slope and where they cross it.
//!
//! With the generator on the X axis and its outward normal along +Y a line is `x = q + α·y`, traveled downward (row 57):
//! its position q and its slope α are a point of projection space. Every point P becomes a line `q = P_X − α·P_Y`
//! (eq. 3.1), every face the sheaf between those of its ends. Slopes at which two of these lines cross are critical.
//!
//! Pose uncertainty enters as printed: the inner projection is what the images at the two extreme rotations share
//! (3.3.1), which is no guarantee (row 65); that is for the judge to give.

use glam::{DVec2, dvec2};

use crate::line::Line;
use crate::plane::arc::wrap;
use crate::plane::pose::Pose;
use crate::scene::Scene;
use crate::tree::Range;

/// A face of a hypothesis where the thesis places it.
pub(crate) struct Edge {
    /// Its hypothesis, as a place among those planned for.
    pub member: usize,
    pub face: usize,
    pub sensed: bool,
    /// Half the range of its hypothesis' rotations.
    pub half: f64,
    pub nominal: Placed,
    pub extremes: [Placed; 2],
}

/// A face at one pose, moved out by the tip's radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placed {
    pub ends: [DVec2; 2],
    pub normal: DVec2,
}

/// The lines that meet one face, as a region of projection space.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheaf {
    /// Its hypothesis, as a place among those planned for.
    pub hypothesis: usize,
    /// Its number in the model.
    pub face: usize,
    /// A contact is assigned to it.
    pub sensed: bool,
    /// Its ends at the nominal pose, moved out by the tip's radius; the generator's frame.
    pub ends: [DVec2; 2],
    /// The same at the two extreme poses.
    extremes: [Placed; 2],
    max_incidence: f64,
}

/// Where an end of a candidate meets an end of the generator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CriticalPoint {
    /// q, on the axis.
    pub position: f64,
    /// α'.
    pub slope: f64,
    /// The candidate's place among the sheaves.
    pub sheaf: usize,
}

/// Positions that several sheaves share at one slope.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlap {
    /// Between these. Low above high: none.
    pub positions: Range,
    /// The generator's sheaf, and those that overlap one of its ends; places among the sheaves.
    pub sheaves: Vec<usize>,
}

/// The projection space of one generator and its candidate set.
#[derive(Debug, Clone, PartialEq)]
pub struct ProjectionSpace {
    /// The generator's, then those of its candidate set.
    pub sheaves: Vec<Sheaf>,
    /// `p_world = world_from_generator * p_generator`: the generator on the X axis from the origin down, its normal on +Y.
    pub world_from_generator: Pose,
    /// The steepest line that does not skid on the generator at any of its rotations has this slope.
    pub max_slope: f64,
    /// Slopes that are closer count as one.
    apart: f64,
    /// What is shared is to be wider than this for a path.
    clearance: f64,
    /// Ends that meet exactly at a critical slope do so up to its compaction.
    near: f64,
}

impl ProjectionSpace {
    /// That of a generator and its candidate set, by their places among the edges.
    pub(crate) fn new(scene: &Scene, edges: &[Edge], generator: usize, candidates: &[usize]) -> Self {
        let Placed { ends: [origin, _], normal } = edges[generator].nominal;
        let world_from_generator = Pose { rotation: -normal.perp(), translation: origin };
        let max_incidence = scene.sensor.max_incidence;
        let members = std::iter::once(&generator).chain(candidates);
        Self {
            sheaves: members
                .map(|edge| Sheaf::new(&edges[*edge], world_from_generator, max_incidence))
                .collect(),
            world_from_generator,
            max_slope: (max_incidence - edges[generator].half).max(0.0).tan(),
            apart: scene.margin / scene.size,
            clearance: 2.0 * (scene.sensor.path_error + scene.margin),
            near: 2.0 * scene.margin,
        }
    }

    /// The generator's sheaf.
    #[must_use]
    pub fn generator(&self) -> &Sheaf {
        &self.sheaves[0]
    }

    /// Where ends of candidates meet ends of the generator, at slopes within the bounds.
    #[must_use]
    pub fn critical_points(&self) -> Vec<CriticalPoint> {
        self.meetings().filter(|point| point.slope.abs() <= self.max_slope).collect()
    }

    /// The slopes of the critical points, the bounds and zero: near ones compacted, from zero outward (4.1).
    #[must_use]
    pub fn critical_slopes(&self) -> Vec<f64> {
        self.compacted(self.examined_slopes())
    }

    /// Critical slopes whether within the bounds or not, as they come.
    pub(crate) fn examined_slopes(&self) -> Vec<f64> {
        let bounds = [-self.max_slope, self.max_slope, 0.0];
        bounds.into_iter().chain(self.meetings().map(|point| point.slope)).collect()
    }

    /// Those within the bounds, near ones compacted, from zero outward.
    pub(crate) fn compacted(&self, mut slopes: Vec<f64>) -> Vec<f64> {
        slopes.retain(|slope| slope.abs() <= self.max_slope);
        slopes.sort_by(|a, b| a.abs().total_cmp(&b.abs()).then(a.total_cmp(b)));
        // The last one kept on either side of zero.
        let mut last = [f64::INFINITY; 2];
        slopes.retain(|slope| {
            let near = last.iter().any(|kept| (slope - kept).abs() < self.apart);
            if !near {
                last[usize::from(*slope < 0.0)] = *slope;
            }
            !near
        });
        slopes
    }

    fn meetings(&self) -> impl Iterator<Item = CriticalPoint> {
        let ends = self.generator().ends;
        let candidates = self.sheaves.iter().enumerate().skip(1);
        candidates.flat_map(move |(sheaf, candidate)| {
            let at = move |p: DVec2| {
                ends.map(|r| {
                    let slope = (p.x - r.x) / (p.y - r.y);
                    CriticalPoint { position: r.x - slope * r.y, slope, sheaf }
                })
            };
            candidate.ends.into_iter().flat_map(at)
        })
    }

    /// Whether a path of this slope fits through the generator, whatever its pose.
    #[must_use]
    pub fn is_open(&self, slope: f64) -> bool {
        self.is_wide(self.generator().inner(slope))
    }

    fn is_wide(&self, positions: Range) -> bool {
        positions.high - positions.low > self.clearance
    }

    /// What the generator shares with all that overlap its left end, and the same for its right end, by their inner
    /// projections; `None` if the slope is not open.
    #[must_use]
    pub fn overlaps(&self, slope: f64) -> Option<[Overlap; 2]> {
        if !self.is_open(slope) {
            return None;
        }
        let inner = self.generator().inner(slope);
        let mut shared = [(); 2].map(|()| Overlap { positions: inner, sheaves: vec![0] });
        for (number, candidate) in self.sheaves.iter().enumerate().skip(1) {
            let image = candidate.inner(slope);
            if !self.is_wide(image) || candidate.skids(slope) {
                continue;
            }
            let at_ends = [
                image.low <= inner.low + self.near && image.high > inner.low + self.clearance,
                image.high >= inner.high - self.near && image.low < inner.high - self.clearance,
            ];
            for (overlap, _) in shared.iter_mut().zip(at_ends).filter(|(_, at_end)| *at_end) {
                overlap.positions = overlap.positions.intersection(image);
                overlap.sheaves.push(number);
            }
        }
        Some(shared)
    }

    /// The middles of what the overlaps share, where a path fits through.
    pub(crate) fn starts(&self, overlaps: &[Overlap; 2]) -> Vec<f64> {
        let wide = overlaps.iter().map(|overlap| overlap.positions).filter(|range| self.is_wide(*range));
        let mut middles: Vec<f64> = wide.map(|range| 0.5 * (range.low + range.high)).collect();
        middles.dedup();
        middles
    }

    /// The line that comes down to a position on the X axis; world frame.
    pub(crate) fn line(&self, slope: f64, position: f64) -> Line {
        let Pose { rotation: x, translation: origin } = self.world_from_generator;
        let direction = -(slope * x + x.perp()) / slope.hypot(1.0);
        Line { start: origin + position * x, direction }
    }
}

impl Sheaf {
    fn new(edge: &Edge, world_from_generator: Pose, max_incidence: f64) -> Self {
        let Pose { rotation: x, translation: origin } = world_from_generator;
        let turned = |vector: DVec2| dvec2(x.dot(vector), x.perp().dot(vector));
        let seen = |placed: &Placed| Placed {
            ends: placed.ends.map(|end| turned(end - origin)),
            normal: turned(placed.normal),
        };
        Self {
            hypothesis: edge.member,
            face: edge.face,
            sensed: edge.sensed,
            ends: seen(&edge.nominal).ends,
            extremes: [seen(&edge.extremes[0]), seen(&edge.extremes[1])],
            max_incidence,
        }
    }

    /// Its ends at the two extreme poses, as `ends` is at the nominal one.
    #[must_use]
    pub fn extreme_ends(&self) -> [[DVec2; 2]; 2] {
        [self.extremes[0].ends, self.extremes[1].ends]
    }

    /// The inner projection (3.3.1): what the images at the two extreme poses share; low above high if nothing.
    #[must_use]
    pub fn inner(&self, slope: f64) -> Range {
        let [a, b] = self.images(slope);
        a.intersection(b)
    }

    /// The outer projection (3.3.1): from the first to the last of the images at the two extreme poses.
    #[must_use]
    pub fn outer(&self, slope: f64) -> Range {
        let [a, b] = self.images(slope);
        Range { low: a.low.min(b.low), high: a.high.max(b.high) }
    }

    /// Positions of the lines of a slope that meet the face, at either extreme pose.
    fn images(&self, slope: f64) -> [Range; 2] {
        [0, 1].map(|pose| {
            let [a, b] = self.extremes[pose].ends.map(|end| end.x - slope * end.y);
            Range { low: a.min(b), high: a.max(b) }
        })
    }

    /// Whether a line of this slope meets the face at more than Ω at either extreme pose, or from behind (row 55).
    #[must_use]
    pub fn skids(&self, slope: f64) -> bool {
        let back = dvec2(slope, 1.0).to_angle();
        let away = |placed: &Placed| wrap(placed.normal.to_angle() - back).abs();
        self.extremes.iter().any(|placed| away(placed) > self.max_incidence)
    }
}
