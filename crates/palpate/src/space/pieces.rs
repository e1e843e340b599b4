//! Faces cut into triangles, and those joined to convex pieces.
//!
//! Corners are seen along the coordinate axis that is nearest to the face's normal, so that their coordinates are taken
//! over as they are; all decisions are exact.

use std::collections::HashMap;

use glam::{DVec2, DVec3};
use robust::Coord;

/// A face as seen along a coordinate axis, counter-clockwise from outside.
pub(super) struct View<'a> {
    points: &'a [DVec3],
    /// Which coordinates are seen, the first to the right.
    axes: [usize; 2],
    normal: DVec3,
}

/// A corner counts as on a side if it is beyond it by no more than this share of the largest coordinate.
const ROUNDING: f64 = 1e-13;

impl<'a> View<'a> {
    /// From the side to which the normal points.
    pub(super) fn new(points: &'a [DVec3], normal: DVec3) -> Self {
        let hidden = normal.abs().max_position();
        let [x, y] = [(hidden + 1) % 3, (hidden + 2) % 3];
        Self { points, axes: if normal[hidden] > 0.0 { [x, y] } else { [y, x] }, normal }
    }

    /// A point as it is seen.
    pub(super) fn at(&self, number: u32) -> DVec2 {
        let point = self.points[number as usize];
        DVec2::new(point[self.axes[0]], point[self.axes[1]])
    }

    /// Positive if it turns left at `b`. The sign is exact.
    pub(super) fn turn(&self, a: u32, b: u32, c: u32) -> f64 {
        let coord = |k: u32| {
            let point = self.at(k);
            Coord { x: point.x, y: point.y }
        };
        robust::orient2d(coord(a), coord(b), coord(c))
    }

    /// Cuts a face into triangles; `None` if its loops touch or cross as they are seen. The first loop is the outer one.
    pub(super) fn triangles(&self, loops: &[Vec<u32>]) -> Option<Vec<[u32; 3]>> {
        let mut outline = self.joined(loops)?;
        let mut triangles = Vec::with_capacity(outline.len());
        let mut from = 0;
        while outline.len() > 3 {
            let n = outline.len();
            let is_reflex =
                |k: usize| self.turn(outline[(k + n - 1) % n], outline[k], outline[(k + 1) % n]) <= 0.0;
            // Cuts make corners no less convex: those that may be in the way are known for the whole round.
            let reflex: Vec<u32> = (0..n).filter(|&k| is_reflex(k)).map(|k| outline[k]).collect();
            // All ears that can be cut in one round; those next to one another wait for the next.
            let mut keep = vec![true; n];
            let mut num_left = n;
            let mut k = from % n;
            for _ in 0..n {
                let (before, after) = ((k + n - 1) % n, (k + 1) % n);
                if num_left > 3
                    && keep[before]
                    && keep[after]
                    && self.is_ear(outline[before], outline[k], outline[after], &reflex)
                {
                    triangles.push([outline[before], outline[k], outline[after]]);
                    keep[k] = false;
                    num_left -= 1;
                }
                k = after;
            }
            if num_left == n {
                return None;
            }
            let mut kept = keep.into_iter();
            outline.retain(|_| kept.next().unwrap_or(true));
            from += 1;
        }
        let &[a, b, c] = outline.as_slice() else { return None };
        if self.turn(a, b, c) <= 0.0 {
            return None;
        }
        triangles.push([a, b, c]);
        Some(triangles)
    }

    /// Whether a corner can be cut off: no other corner is in its triangle, or on the cut.
    fn is_ear(&self, a: u32, b: u32, c: u32, reflex: &[u32]) -> bool {
        let holds =
            |k: u32| self.turn(a, b, k) >= 0.0 && self.turn(b, c, k) >= 0.0 && self.turn(c, a, k) >= 0.0;
        self.turn(a, b, c) > 0.0 && !reflex.iter().any(|&k| k != a && k != b && k != c && holds(k))
    }

    /// One outline that goes around the holes as well, over bridges that are run along on both sides.
    fn joined(&self, loops: &[Vec<u32>]) -> Option<Vec<u32>> {
        let (outer, holes) = loops.split_first()?;
        let mut outline = outer.clone();
        // The rightmost hole first: no hole that is still to come lies between it and the outline to its right.
        let mut starts: Vec<(u32, &Vec<u32>)> = Vec::new();
        for hole in holes {
            starts.push((hole.iter().copied().max_by(|&a, &b| self.order(a, b))?, hole));
        }
        starts.sort_by(|a, b| self.order(b.0, a.0));
        for (start, hole) in starts {
            let place = self.bridge(start, hole, &outline)?;
            let first = hole.iter().position(|&k| k == start)?;
            let around = hole[first..].iter().chain(&hole[..first]).copied().chain([start]);
            let detour: Vec<u32> = around.chain([outline[place]]).collect();
            let rest = outline.split_off(place + 1);
            outline.extend(detour);
            outline.extend(rest);
        }
        Some(outline)
    }

    /// From left to right, then upward.
    fn order(&self, a: u32, b: u32) -> std::cmp::Ordering {
        let (a, b) = (self.at(a), self.at(b));
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
    }

    /// The place in the outline from which a corner of a hole is seen.
    fn bridge(&self, start: u32, hole: &[u32], outline: &[u32]) -> Option<usize> {
        let here = self.at(start);
        // To its left other holes may be in the way.
        let is_right = |&place: &usize| self.order(outline[place], start).is_gt();
        let mut places: Vec<usize> = (0..outline.len()).filter(is_right).collect();
        let distance_sq = |place: usize| self.at(outline[place]).distance_squared(here);
        places.sort_by(|&a, &b| distance_sq(a).total_cmp(&distance_sq(b)));
        let n = outline.len();
        places.into_iter().find(|&place| {
            let [before, corner, after] =
                [outline[(place + n - 1) % n], outline[place], outline[(place + 1) % n]];
            self.is_between(before, corner, after, start)
                && !self.is_crossed(start, corner, outline)
                && !self.is_crossed(start, corner, hole)
        })
    }

    /// Whether a point is seen from a corner into the material.
    fn is_between(&self, before: u32, corner: u32, after: u32, point: u32) -> bool {
        let left_of_in = self.turn(before, corner, point) > 0.0;
        let left_of_out = self.turn(corner, after, point) > 0.0;
        if self.turn(before, corner, after) > 0.0 {
            left_of_in && left_of_out
        } else {
            left_of_in || left_of_out
        }
    }

    /// Whether a loop meets the way between two points elsewhere than at these.
    fn is_crossed(&self, a: u32, b: u32, outline: &[u32]) -> bool {
        let apart = |x: f64, y: f64| x > 0.0 && y > 0.0 || x < 0.0 && y < 0.0;
        let is_on = |k: u32| {
            let (from_a, from_b) = (self.at(k) - self.at(a), self.at(k) - self.at(b));
            k != a && k != b && self.turn(a, b, k) == 0.0 && from_a.dot(from_b) < 0.0
        };
        let mut sides = outline.iter().zip(outline.iter().cycle().skip(1));
        sides.any(|(&c, &d)| {
            if is_on(c) || is_on(d) {
                return true;
            }
            let shares_end = [c, d].iter().any(|&k| k == a || k == b);
            let of_line = [self.turn(a, b, c), self.turn(a, b, d)];
            let of_side = [self.turn(c, d, a), self.turn(c, d, b)];
            let in_line = of_line == [0.0; 2];
            !(shares_end || in_line || apart(of_line[0], of_line[1]) || apart(of_side[0], of_side[1]))
        })
    }

    /// Triangles of a face joined to convex polygons: whatever cut is not needed goes, in order (Hertel and Mehlhorn
    /// 1983: at most four times as many pieces as are possible).
    ///
    /// A triangle that is turned around, as slivers of a face that can't be cut may be, stays by itself. Where corners are off
    /// the plane, what is convex as seen along an axis need not be so along the normal, as pieces are used: a short side would
    /// cut off what is far from it. The triangles stay then.
    pub(super) fn pieces(&self, triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
        let joined = self.joined_triangles(triangles);
        if joined.iter().all(|piece| self.is_convex(piece)) {
            return joined;
        }
        triangles.iter().map(|triangle| triangle.to_vec()).collect()
    }

    /// Whether no corner is beyond a side, seen along the normal.
    fn is_convex(&self, piece: &[u32]) -> bool {
        let at = |k: &u32| self.points[*k as usize];
        let reach = piece.iter().map(|k| at(k).abs().max_element()).fold(0.0, f64::max);
        let mut sides = piece.iter().zip(piece.iter().cycle().skip(1));
        piece.len() == 3
            || sides.all(|(a, b)| {
                let inward = self.normal.cross(at(b) - at(a));
                let least = -ROUNDING * reach * inward.length();
                piece.iter().all(|c| inward.dot(at(c) - at(a)) >= least)
            })
    }

    fn joined_triangles(&self, triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
        let mut pieces: Vec<Vec<u32>> = triangles.iter().map(|triangle| triangle.to_vec()).collect();
        let mut owner: HashMap<[u32; 2], usize> = HashMap::new();
        let forward = |[a, b, c]: &[u32; 3]| self.turn(*a, *b, *c) > 0.0;
        for (k, [a, b, c]) in triangles.iter().copied().enumerate().filter(|(_, one)| forward(one)) {
            for side in [[a, b], [b, c], [c, a]] {
                owner.insert(side, k);
            }
        }
        for &[a, b, c] in triangles {
            for [u, v] in [[a, b], [b, c], [c, a]] {
                let (Some(&left), Some(&right)) = (owner.get(&[u, v]), owner.get(&[v, u])) else { continue };
                if left == right {
                    continue;
                }
                let Some(joined) = self.without_cut(&pieces[left], &pieces[right], u, v) else { continue };
                owner.remove(&[u, v]);
                owner.remove(&[v, u]);
                // The larger piece keeps its number, so that few sides change theirs.
                let (larger, smaller) =
                    if pieces[left].len() < pieces[right].len() { (right, left) } else { (left, right) };
                let gone = std::mem::take(&mut pieces[smaller]);
                for (&from, &to) in gone.iter().zip(gone.iter().cycle().skip(1)) {
                    if let Some(of_side) = owner.get_mut(&[from, to]) {
                        *of_side = larger;
                    }
                }
                pieces[larger] = joined;
            }
        }
        pieces.retain(|piece| !piece.is_empty());
        pieces
    }

    /// Two convex pieces without the cut `u → v` of the first between them, if they are convex together.
    fn without_cut(&self, left: &[u32], right: &[u32], u: u32, v: u32) -> Option<Vec<u32>> {
        let rotated = |piece: &[u32], first: u32| -> Option<Vec<u32>> {
            let place = piece.iter().position(|&k| k == first)?;
            Some(piece[place..].iter().chain(&piece[..place]).copied().collect())
        };
        // From v around to u, and from u around to v.
        let (left, right) = (rotated(left, v)?, rotated(right, u)?);
        let before_u = left[left.len() - 2];
        let before_v = right[right.len() - 2];
        let convex = self.turn(before_u, u, right[1]) >= 0.0 && self.turn(before_v, v, left[1]) >= 0.0;
        convex.then(|| left[..left.len() - 1].iter().chain(&right[..right.len() - 1]).copied().collect())
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, dvec3};

    use super::View;

    /// A face of a scanned part that can't be cut: a sliver is turned around, corners are off the plane. Every place of its
    /// triangles is in a piece, as pieces are used: within all of their sides.
    #[test]
    fn pieces_hold_all_of_a_face_that_cannot_be_cut() {
        let points = [
            dvec3(24.846_660_118_542_392, 35.177_579_586_631_3, 43.795_395_870_351_94),
            dvec3(24.134_040_037_075_483, 35.257_465_672_428_83, 50.920_447_657_441_89),
            dvec3(24.100_404_533_872_997, 35.257_465_672_428_83, 51.256_663_194_611_12),
            dvec3(24.100_402_286_468_66, 35.256_497_001_162_79, 51.256_663_755_712_59),
            dvec3(24.100_440_210_648_24, 35.257_465_672_428_83, 51.256_663_755_712_59),
            dvec3(24.890_464_230_500_566, -58.574_250_416_622_725, 48.881_319_178_385_05),
            dvec3(24.890_464_230_500_566, 35.257_465_672_428_83, 43.351_301_682_783_64),
            dvec3(24.847_169_550_930_513, 35.257_465_672_428_83, 43.784_529_166_040_04),
        ];
        let triangles = [[5, 0, 1], [5, 6, 0], [6, 7, 0], [5, 1, 4], [4, 1, 2], [4, 2, 3]];
        let normal = dvec3(0.995_026_489_635_780_7, 0.005_859_437_668_435_947, 0.099_438_181_365_637_78);
        let pieces = View::new(&points, normal).pieces(&triangles);
        let at = |k: &u32| points[*k as usize];
        let holds = |place: DVec3, piece: &Vec<u32>| {
            let mut sides = piece.iter().map(at).zip(piece.iter().cycle().skip(1).map(at));
            sides.all(|(a, b)| normal.cross(b - a).dot(place - a) >= -1e-9)
        };
        for [a, b, c] in &triangles[..4] {
            for (u, v, w) in [(0.2, 0.3, 0.5), (0.6, 0.2, 0.2), (0.1, 0.8, 0.1), (0.3, 0.3, 0.4)] {
                let place = u * at(a) + v * at(b) + w * at(c);
                assert!(pieces.iter().any(|piece| holds(place, piece)), "{place} is lost");
            }
        }
    }
}
