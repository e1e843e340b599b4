//! Loops of points made into clean outlines, or refused with the reason.

use crate::part::{Mend, Surface};
use glam::DVec2;
use robust::Coord;

use super::crossing;
use crate::Error;

/// Points closer than this share of the part's size are one point, and points this close to a line are on it.
const MERGE_TOL: f64 = 1e-9;

/// Coordinates may be this many times the part's size: beyond, they no longer resolve [`MERGE_TOL`].
const FARTHEST: f64 = 1e6;

/// Lengths outside of these, squared and multiplied, would leave the range of numbers.
const SIZES: std::ops::RangeInclusive<f64> = 1e-50..=1e50;

/// A corner of a loop, and the face that begins there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corner {
    /// Where it is.
    pub(crate) point: DVec2,
    /// The number of the face as given.
    pub(crate) given: usize,
    /// What the face is to a probe.
    pub(super) surface: Surface,
}

/// A loop, and the argument it came from.
#[derive(Debug, Clone)]
pub(crate) struct Outline {
    /// As the caller names it.
    pub(super) argument: String,
    /// In order; the last is followed by the first.
    pub(crate) corners: Vec<Corner>,
}

/// Twice the signed area of the triangle: positive if it turns left at `b`. The sign is exact.
pub(super) fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// The distance at which points of this part are one; refuses points that can't be told apart reliably.
pub(super) fn merge_distance(argument: &str, points: impl Iterator<Item = DVec2>) -> Result<f64, Error> {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for point in points {
        if !point.is_finite() {
            let remedy = "give finite coordinates";
            return Err(Error::new(argument, "has a coordinate that is not finite", at(point), remedy));
        }
        (low, high) = (low.min(point), high.max(point));
    }
    let size = low.distance(high);
    if size == 0.0 {
        return Err(Error::new(
            argument,
            "has no extent: all points are the same",
            at(low),
            "give distinct points",
        ));
    }
    if !SIZES.contains(&size) {
        let problem = format!("its size must be between {:e} and {:e}", SIZES.start(), SIZES.end());
        return Err(Error::new(argument, problem, size, "choose another unit of length"));
    }
    let farthest = low.abs().max(high.abs()).max_element();
    if farthest > FARTHEST * size {
        let problem = format!("lies more than {FARTHEST:e} times its size from the origin");
        return Err(Error::new(argument, problem, farthest, "move the origin close to the part"));
    }
    Ok(MERGE_TOL * size)
}

/// The outer loop counter-clockwise and the holes clockwise, without doubled points and points on straight runs.
pub(crate) fn clean(
    vertices: &[DVec2],
    holes: &[Vec<DVec2>],
    surfaces: &[Surface],
    mends: &mut Vec<Mend>,
) -> Result<Vec<Outline>, Error> {
    let mut loops = vec![Outline::given("vertices".into(), vertices, surfaces, 0)?];
    let mut first = vertices.len();
    for (k, hole) in holes.iter().enumerate() {
        loops.push(Outline::given(format!("holes[{k}]"), hole, surfaces, first)?);
        first += hole.len();
    }
    let merge_tol = merge_distance("vertices", vertices.iter().copied())?;
    for hole in &loops[1..] {
        merge_distance(&hole.argument, hole.corners.iter().map(|corner| corner.point))?;
    }
    for outline in &mut loops {
        outline.merge_doubled(merge_tol, mends);
        outline.refuse_flat(merge_tol)?;
        outline.drop_straight(merge_tol, mends);
        outline.refuse_spikes(merge_tol)?;
    }
    crossing::refuse(&loops)?;
    for (k, outline) in loops.iter_mut().enumerate() {
        outline.orient(k == 0, mends);
    }
    Ok(loops)
}

impl Outline {
    fn given(argument: String, points: &[DVec2], surfaces: &[Surface], first: usize) -> Result<Self, Error> {
        if points.len() < 3 {
            let value = format!("{} points", points.len());
            return Err(Error::new(
                argument,
                "has fewer than three points",
                value,
                "give at least three corners",
            ));
        }
        let corner = |(k, &point)| Corner { point, given: first + k, surface: surfaces[first + k] };
        Ok(Self { argument, corners: points.iter().enumerate().map(corner).collect() })
    }

    /// Each corner with the next.
    pub(super) fn edges(&self) -> impl Iterator<Item = (&Corner, &Corner)> {
        self.corners.iter().zip(self.corners.iter().cycle().skip(1))
    }

    /// Where the `k`-th corner before, at and after `k` are.
    fn around(&self, k: usize) -> [DVec2; 3] {
        let n = self.corners.len();
        [(k + n - 1) % n, k, (k + 1) % n].map(|k| self.corners[k].point)
    }

    fn merge_doubled(&mut self, merge_tol: f64, mends: &mut Vec<Mend>) {
        let given = self.corners.len();
        let repeats_first = self.corners[0].point == self.corners[given - 1].point;
        let mut kept: Vec<Corner> = Vec::with_capacity(given);
        for &corner in &self.corners {
            match kept.last_mut() {
                // The face between the two has no length; the one that goes on from here stays.
                Some(last) if last.point.distance(corner.point) <= merge_tol => {
                    *last = Corner { point: last.point, ..corner };
                }
                _ => kept.push(corner),
            }
        }
        while kept.len() > 1 && kept[0].point.distance(kept[kept.len() - 1].point) <= merge_tol {
            kept.pop();
        }
        let merged = given - kept.len() - usize::from(repeats_first);
        if repeats_first {
            self.mended(mends, "the first point was repeated at the end: dropped");
        }
        if merged > 0 {
            self.mended(mends, &format!("{merged} doubled point(s), closer than {merge_tol:.1e}, merged"));
        }
        self.corners = kept;
    }

    /// Refuses a loop that lies on a line.
    fn refuse_flat(&self, merge_tol: f64) -> Result<(), Error> {
        let first = self.corners[0].point;
        let by_distance =
            |a: &DVec2, b: &DVec2| first.distance_squared(*a).total_cmp(&first.distance_squared(*b));
        let farthest = self.corners.iter().map(|corner| corner.point).max_by(by_distance).unwrap_or(first);
        let reach = merge_tol * first.distance(farthest);
        if self.corners.len() >= 3
            && self.corners.iter().any(|c| turn(first, farthest, c.point).abs() > reach)
        {
            return Ok(());
        }
        let value = format!("{} distinct points from {} to {}", self.corners.len(), at(first), at(farthest));
        Err(Error::new(
            &*self.argument,
            "has no area",
            value,
            "give at least three corners that are not in line",
        ))
    }

    /// Drops corners between two faces of one line and one surface.
    fn drop_straight(&mut self, merge_tol: f64, mends: &mut Vec<Mend>) {
        let given = self.corners.len();
        // What was dropped may put its neighbours in line: repeated until nothing changes, so that a clean outline
        // stays as it is.
        while self.drop_straight_once(merge_tol) {}
        let dropped = given - self.corners.len();
        if dropped > 0 {
            self.mended(mends, &format!("{dropped} point(s) in the middle of straight faces dropped"));
        }
        let first = (0..self.corners.len()).min_by_key(|&k| self.corners[k].given).unwrap_or(0);
        self.corners.rotate_left(first);
    }

    fn drop_straight_once(&mut self, merge_tol: f64) -> bool {
        let n = self.corners.len();
        let bent = |&k: &usize| {
            let [before, here, after] = self.around(k);
            !is_between(before, here, after, merge_tol)
        };
        // A face must not run on past the place where the loop is cut open.
        let first_bent = (0..n).find(bent).unwrap_or(0);
        self.corners.rotate_left(first_bent);

        let mut kept = vec![self.corners[0]];
        let mut run: Vec<DVec2> = Vec::new();
        for k in 1..n {
            let (here, after) = (self.corners[k], self.corners[(k + 1) % n].point);
            let from = kept[kept.len() - 1];
            run.push(here.point);
            let straight = run.iter().all(|&point| is_between(from.point, point, after, merge_tol));
            if !(straight && here.surface == from.surface) {
                kept.push(here);
                run.clear();
            }
        }
        let changed = kept.len() < n;
        self.corners = kept;
        changed
    }

    /// Refuses corners whose two faces lie on one another.
    fn refuse_spikes(&self, merge_tol: f64) -> Result<(), Error> {
        for (k, corner) in self.corners.iter().enumerate() {
            let [before, here, after] = self.around(k);
            let longer = before.distance(here).max(here.distance(after));
            let back = (here - before).dot(after - here) < 0.0;
            if back && turn(before, here, after).abs() <= merge_tol * longer {
                let problem = format!("turns back on itself where face {} begins", corner.given);
                let remedy = "drop the spike, or use segments for a plate without thickness";
                return Err(Error::new(&*self.argument, problem, at(here), remedy));
            }
        }
        Ok(())
    }

    /// Makes it run counter-clockwise, or clockwise.
    fn orient(&mut self, counter_clockwise: bool, mends: &mut Vec<Mend>) {
        let origin = self.corners[0].point;
        let area: f64 = self.edges().map(|(a, b)| (a.point - origin).perp_dot(b.point - origin)).sum();
        if (area > 0.0) == counter_clockwise {
            return;
        }
        // The first corner stays first; each face now begins where it used to end.
        let surfaces: Vec<(usize, Surface)> =
            self.corners.iter().rev().map(|c| (c.given, c.surface)).collect();
        self.corners[1..].reverse();
        for (corner, (given, surface)) in self.corners.iter_mut().zip(surfaces) {
            (corner.given, corner.surface) = (given, surface);
        }
        let found = if counter_clockwise { "clockwise" } else { "counter-clockwise" };
        self.mended(mends, &format!("ran {found}: reversed, its faces are numbered the other way round"));
    }

    fn mended(&self, mends: &mut Vec<Mend>, what: &str) {
        mends.push(Mend(format!("{}: {what}", self.argument)));
    }
}

/// Whether `b` lies on the straight way from `a` to `c`.
fn is_between(a: DVec2, b: DVec2, c: DVec2, merge_tol: f64) -> bool {
    (b - a).dot(c - b) > 0.0 && turn(a, b, c).abs() <= merge_tol * a.distance(c)
}

/// A point as it is shown in messages.
pub(super) fn at(point: DVec2) -> String {
    format!("({}, {})", point.x, point.y)
}
