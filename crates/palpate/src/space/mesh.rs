//! Triangles made into a clean mesh, or refused with the reason.

use std::collections::{BTreeSet, HashSet};

use glam::DVec3;

use super::near_misses;
use super::scale::Scale;
use super::weld::{apply, joints, report_welded, welded};
use crate::Error;
use crate::part::{Mend, Surface};

/// Passes of splitting, at most: each mends what the one before has uncovered.
const MOST_PASSES: usize = 16;

/// Passes of welding, at most.
const MOST_WELDS: usize = 4;

/// Triangles over points that are distinct.
#[derive(Debug)]
pub(super) struct Mesh {
    /// As given; not all of them are used.
    pub(super) points: Vec<DVec3>,
    /// Point numbers.
    pub(super) triangles: Vec<[u32; 3]>,
    /// What each triangle is to a probe.
    pub(super) surfaces: Vec<Surface>,
    /// Distances at which points are one.
    pub(super) scale: Scale,
    /// How far each point is from the corners as given that it stands for, if they were welded where the surface ended.
    pub(super) moved: Vec<f64>,
    /// How far points are from the edges that were split there.
    pub(super) deviation: f64,
    /// It was closed as given, and is not any more.
    pub(super) is_torn: bool,
}

/// A use of an edge by a triangle: half-edge `3 t + k` runs from corner `k` of triangle `t` to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Use {
    /// The lower point number, then the higher.
    pub(super) ends: [u32; 2],
    /// The half-edge.
    pub(super) half: u32,
    /// Whether it runs from the lower number to the higher.
    pub(super) forward: bool,
}

impl Mesh {
    /// A mesh that is clean, or refused.
    pub(super) fn new(
        vertices: &[DVec3],
        triangles: &[[u32; 3]],
        surfaces: Vec<Surface>,
        mends: &mut Vec<Mend>,
    ) -> Result<Self, Error> {
        let mesh = Self::cleaned(vertices, triangles, surfaces, mends)?;
        if mesh.triangles.is_empty() {
            let value = format!("{} triangles", triangles.len());
            let remedy = "give triangles with area that bound a solid, not a sheet with two sides";
            return Err(Error::new("triangles", "leave no area once cleaned", value, remedy));
        }
        near_misses::refuse(&mesh)?;
        Ok(mesh)
    }

    /// Doubled points welded, and where the surface ends those that rounding parts; triangles without area, repeated ones
    /// and inner walls dropped; edges split where a corner of another triangle lies on them. Nothing may be left.
    pub(super) fn cleaned(
        vertices: &[DVec3],
        triangles: &[[u32; 3]],
        surfaces: Vec<Surface>,
        mends: &mut Vec<Mend>,
    ) -> Result<Self, Error> {
        check_numbers(vertices, triangles)?;
        let finite = vertices.iter().position(|point| !point.is_finite());
        if let Some(k) = finite {
            let problem = format!("vertex {k} has a coordinate that is not finite");
            let value = super::scale::at(vertices[k]);
            return Err(Error::new("vertices", problem, value, "give finite coordinates"));
        }
        let used = triangles.iter().flatten().map(|&k| vertices[k as usize]);
        let scale = Scale::new("vertices", used)?;
        let mut mesh = Self {
            points: vertices.to_vec(),
            triangles: triangles.to_vec(),
            surfaces,
            scale,
            moved: vec![0.0; vertices.len()],
            deviation: 0.0,
            is_torn: false,
        };
        mesh.weld(mends);
        let was_closed = mesh.open_edges().is_empty();
        let flat = mesh.drop_flat();
        mesh.weld_ends(mends);
        let flat = flat + mesh.drop_flat();
        report(mends, flat, "triangle(s) without area dropped");
        mesh.drop_repeated(mends);
        mesh.split_edges(mends);
        mesh.is_torn = was_closed && !mesh.open_edges().is_empty();
        Ok(mesh)
    }

    /// The corners of a triangle.
    pub(super) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|k| self.points[k as usize])
    }

    /// Its normal, as long as twice its area.
    pub(super) fn area_vector(&self, triangle: usize) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// Its least height.
    pub(super) fn height(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.corners(triangle);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        if longest > 0.0 { self.area_vector(triangle).length() / longest } else { 0.0 }
    }

    /// The points where a half-edge begins and ends.
    pub(super) fn ends(&self, half: u32) -> [u32; 2] {
        let corners = self.triangles[half as usize / 3];
        [corners[half as usize % 3], corners[(half as usize + 1) % 3]]
    }

    /// All uses of edges, those of one edge side by side.
    pub(super) fn uses(&self) -> Vec<Use> {
        let mut uses = Vec::with_capacity(3 * self.triangles.len());
        for half in 0..3 * self.triangles.len() as u32 {
            let [a, b] = self.ends(half);
            uses.push(Use { ends: [a.min(b), a.max(b)], half, forward: a < b });
        }
        uses.sort_unstable();
        uses
    }

    fn weld(&mut self, mends: &mut Vec<Mend>) {
        let of_point = welded(&self.points, self.scale.merge_tol);
        let mut is_used = vec![false; self.points.len()];
        for corner in self.triangles.iter_mut().flatten() {
            is_used[*corner as usize] = true;
            *corner = of_point[*corner as usize];
        }
        let merged = (0..of_point.len()).filter(|&k| is_used[k] && of_point[k] as usize != k).count();
        let what = format!("doubled vertices, closer than {:.1e}, merged", self.scale.merge_tol);
        report(mends, merged, &what);
    }

    /// Welds corners where the surface ends that are within a few roundings of one another; again, as what is welded may be
    /// nearer to others than its corners were.
    fn weld_ends(&mut self, mends: &mut Vec<Mend>) {
        let mut of_point: Vec<u32> = (0..self.points.len() as u32).collect();
        let mut welded: BTreeSet<u32> = BTreeSet::new();
        for _ in 0..MOST_WELDS {
            let mut ends: Vec<u32> = self.open_edges().iter().flat_map(|&half| self.ends(half)).collect();
            ends.sort_unstable();
            ends.dedup();
            let outlines = self.triangles.iter().map(<[u32; 3]>::as_slice);
            let joints = joints(&self.points, &ends, outlines, self.scale.single_tol);
            if joints.is_empty() {
                break;
            }
            for joint in &joints {
                let before = joint.points.iter().map(|&k| self.moved[k as usize]).fold(0.0, f64::max);
                self.moved[joint.points[0] as usize] = before + joint.moved;
                welded.extend(&joint.points);
            }
            let place_of = apply(&mut self.points, &joints);
            for corner in self.triangles.iter_mut().flatten().chain(&mut of_point) {
                *corner = place_of[*corner as usize];
            }
        }
        let places: BTreeSet<u32> = welded.iter().map(|&k| of_point[k as usize]).collect();
        let most = places.iter().map(|&k| self.moved[k as usize]).fold(0.0, f64::max);
        report_welded(mends, welded.len(), places.len(), most, self.scale.single_tol);
    }

    /// A half-edge of each edge at which the surface ends: an odd number of triangles meets there.
    pub(super) fn open_edges(&self) -> Vec<u32> {
        let uses = self.uses();
        let groups = uses.chunk_by(|a, b| a.ends == b.ends).filter(|group| group.len() % 2 == 1);
        groups.map(|group| group[0].half).collect()
    }

    /// Drops triangles lower than points are told apart; how many.
    fn drop_flat(&mut self) -> usize {
        let keep: Vec<bool> = (0..self.triangles.len())
            .map(|t| {
                let [a, b, c] = self.triangles[t];
                a != b && b != c && c != a && self.height(t) > self.scale.merge_tol
            })
            .collect();
        self.retain(&keep)
    }

    fn retain(&mut self, keep: &[bool]) -> usize {
        let mut of_triangle = keep.iter();
        self.triangles.retain(|_| *of_triangle.next().unwrap_or(&true));
        let mut of_surface = keep.iter();
        self.surfaces.retain(|_| *of_surface.next().unwrap_or(&true));
        keep.iter().filter(|kept| !**kept).count()
    }

    /// Of triangles on the same corners one stays, or none if they face each other: a wall inside of the part.
    fn drop_repeated(&mut self, mends: &mut Vec<Mend>) {
        let key = |triangle: [u32; 3]| {
            let mut sorted = triangle;
            sorted.sort_unstable();
            let first = triangle.iter().position(|&k| k == sorted[0]).unwrap_or(0);
            (sorted, triangle[(first + 1) % 3] == sorted[1])
        };
        let mut order: Vec<([u32; 3], bool, usize)> = Vec::with_capacity(self.triangles.len());
        order.extend(self.triangles.iter().enumerate().map(|(t, &triangle)| {
            let (corners, forward) = key(triangle);
            (corners, forward, t)
        }));
        order.sort_unstable();
        let mut keep = vec![true; self.triangles.len()];
        let (mut num_repeated, mut num_walls) = (0, 0);
        for group in order.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
            let backward = group.partition_point(|entry| !entry.1);
            let forward = group.len() - backward;
            let kept =
                if forward == backward { None } else { Some(if forward > backward { backward } else { 0 }) };
            for (k, entry) in group.iter().enumerate() {
                keep[entry.2] = Some(k) == kept;
            }
            num_walls += forward.min(backward);
            num_repeated += group.len() - usize::from(kept.is_some()) - 2 * forward.min(backward);
        }
        self.retain(&keep);
        report(mends, num_repeated, "repeated triangle(s) dropped");
        report(
            mends,
            num_walls,
            "pair(s) of triangles that face each other dropped: walls without thickness",
        );
    }

    /// Splits open edges where an end of another open edge lies on them.
    fn split_edges(&mut self, mends: &mut Vec<Mend>) {
        let mut num_split = 0;
        for _ in 0..MOST_PASSES {
            let splits = self.splits();
            if splits.is_empty() {
                break;
            }
            num_split += splits.len();
            for (half, points) in splits {
                let [a, b] = self.ends(half);
                let triangle = half as usize / 3;
                let apex = self.triangles[triangle][(half as usize + 2) % 3];
                let starts = std::iter::once(a).chain(points.iter().copied());
                let ends: Vec<u32> = points.iter().copied().chain([b]).collect();
                for (k, (start, end)) in starts.zip(ends).enumerate() {
                    if k == 0 {
                        self.triangles[triangle] = [start, end, apex];
                    } else {
                        self.triangles.push([start, end, apex]);
                        self.surfaces.push(self.surfaces[triangle]);
                    }
                }
            }
            self.drop_flat();
        }
        report(mends, num_split, "edge(s) split where a corner of another triangle lies on them");
    }

    /// Half-edges to split and the points in their order along it; one a triangle.
    fn splits(&mut self) -> Vec<(u32, Vec<u32>)> {
        let open = self.open_edges();
        let mut ends: Vec<u32> = open.iter().flat_map(|&half| self.ends(half)).collect();
        ends.sort_unstable();
        ends.dedup();
        ends.sort_by(|&a, &b| self.points[a as usize].x.total_cmp(&self.points[b as usize].x));

        // An edge has two ends, however short it is.
        let edges: HashSet<[u32; 2]> = open.iter().map(|&half| sorted(self.ends(half))).collect();
        let apart = |a: u32, b: u32| edges.contains(&sorted([a, b]));

        let mut splits = Vec::new();
        let mut is_split = vec![false; self.triangles.len()];
        for half in open {
            if is_split[half as usize / 3] {
                continue;
            }
            let apex = self.triangles[half as usize / 3][(half as usize + 2) % 3];
            let mut on_edge = self.scale.points_on(&self.points, self.ends(half), &ends, apart);
            on_edge.retain(|(_, k)| *k != apex);
            if !on_edge.is_empty() {
                is_split[half as usize / 3] = true;
                self.deviation = on_edge.iter().map(|(off, _)| *off).fold(self.deviation, f64::max);
                splits.push((half, on_edge.into_iter().map(|(_, k)| k).collect()));
            }
        }
        splits
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

fn check_numbers(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<(), Error> {
    if triangles.is_empty() {
        return Err(Error::new("triangles", "is empty", "0 triangles", "give the triangles of the surface"));
    }
    for (t, triangle) in triangles.iter().enumerate() {
        if let Some(number) = triangle.iter().find(|&&number| number as usize >= vertices.len()) {
            let problem = format!("triangle {t} names a vertex that is not among the {}", vertices.len());
            return Err(Error::new("triangles", problem, number, "number the vertices from 0"));
        }
    }
    Ok(())
}

/// Says what was mended, if anything was.
pub(super) fn report(mends: &mut Vec<Mend>, count: usize, what: &str) {
    report_on(mends, "triangles", count, what);
}

/// The same of an argument.
pub(super) fn report_on(mends: &mut Vec<Mend>, argument: &str, count: usize, what: &str) {
    if count > 0 {
        mends.push(Mend(format!("{argument}: {count} {what}")));
    }
}
