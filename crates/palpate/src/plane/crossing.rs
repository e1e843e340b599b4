//! Loops that cross, touch or lie wrongly inside one another. All decisions are exact.

use glam::DVec2;

use super::outline::{Outline, at, turn};
use crate::Error;

/// A face of one of several loops.
struct Edge {
    start: DVec2,
    end: DVec2,
    low: DVec2,
    high: DVec2,
    /// Which loop.
    outline: usize,
    /// Which place in it.
    place: usize,
    /// Its number as given.
    given: usize,
}

/// Refuses loops, the first of which is the outer one, that do not bound a part.
pub(super) fn refuse(loops: &[Outline]) -> Result<(), Error> {
    let edges = edges_by_x(loops);
    for (k, edge) in edges.iter().enumerate() {
        for other in edges[k + 1..].iter().take_while(|other| other.low.x <= edge.high.x) {
            if meet(edge, other) && !adjoin(edge, other, loops) {
                return Err(crossing(edge, other, loops));
            }
        }
    }
    for (k, hole) in loops.iter().enumerate().skip(1) {
        let point = hole.corners[0].point;
        if !contains(&loops[0], point) {
            let remedy = "give it as a part of its own, or drop it";
            return Err(Error::new(&*hole.argument, "lies outside the outer outline", at(point), remedy));
        }
        if let Some(around) = (1..loops.len()).find(|&j| j != k && contains(&loops[j], point)) {
            let problem = format!("lies inside {}", loops[around].argument);
            return Err(Error::new(
                &*hole.argument,
                problem,
                at(point),
                "give an island as a part of its own",
            ));
        }
    }
    Ok(())
}

fn edges_by_x(loops: &[Outline]) -> Vec<Edge> {
    let mut edges = Vec::new();
    for (outline, corners) in loops.iter().enumerate() {
        edges.extend(corners.edges().enumerate().map(|(place, (a, b))| Edge {
            start: a.point,
            end: b.point,
            low: a.point.min(b.point),
            high: a.point.max(b.point),
            outline,
            place,
            given: a.given,
        }));
    }
    edges.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
    edges
}

/// Whether two closed segments share a point.
fn meet(a: &Edge, b: &Edge) -> bool {
    let boxes_meet = a.low.cmple(b.high).all() && b.low.cmple(a.high).all();
    boxes_meet && divides(a, b) && divides(b, a)
}

/// Whether the line of `a` meets the segment `b`.
fn divides(a: &Edge, b: &Edge) -> bool {
    let (first, second) = (turn(a.start, a.end, b.start), turn(a.start, a.end, b.end));
    !(first > 0.0 && second > 0.0 || first < 0.0 && second < 0.0)
}

/// Whether they follow one another in one loop, and so share a corner rightly: spikes are refused elsewhere.
fn adjoin(a: &Edge, b: &Edge, loops: &[Outline]) -> bool {
    let n = loops[a.outline].corners.len();
    a.outline == b.outline && ((a.place + 1) % n == b.place || (b.place + 1) % n == a.place)
}

fn crossing(a: &Edge, b: &Edge, loops: &[Outline]) -> Error {
    let (a, b) = if a.given <= b.given { (a, b) } else { (b, a) };
    let (of_a, of_b) = (&loops[a.outline].argument, &loops[b.outline].argument);
    let value = format!("{} to {} and {} to {}", at(a.start), at(a.end), at(b.start), at(b.end));
    if a.outline == b.outline {
        let problem = format!("crosses or touches itself: faces {} and {}", a.given, b.given);
        return Error::new(of_a.as_str(), problem, value, "give a simple outline, its corners in order");
    }
    let problem = format!("crosses or touches {of_a}: faces {} and {}", b.given, a.given);
    Error::new(of_b.as_str(), problem, value, "make the loops disjoint, or join them into one")
}

/// Whether `point`, which is not on the loop, is inside.
fn contains(outline: &Outline, point: DVec2) -> bool {
    let left_of = |a: DVec2, b: DVec2| turn(a, b, point) > 0.0;
    let crossed = outline.edges().filter(|(a, b)| {
        let (a, b) = (a.point, b.point);
        (a.y <= point.y) != (b.y <= point.y) && left_of(a, b) == (a.y < b.y)
    });
    crossed.count() % 2 == 1
}
