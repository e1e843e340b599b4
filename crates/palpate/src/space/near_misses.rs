//! Edges that are left over beside one another: triangles that hang together in all but their corners.
//!
//! Such a mesh is no solid, and read as loose faces it has no edge on which a tip could rest: it is refused.

use std::collections::{HashMap, HashSet};

use glam::DVec3;

use super::mesh::Mesh;
use super::scale::at;
use super::weld::between;
use crate::Error;
use crate::groups::Groups;

/// Edges of different pieces whose ends are this close, as a share of the size, were meant to be one.
const NEAR: f64 = 1e-3;

/// The same as a share of their length.
const BESIDE: f64 = 0.1;

/// Within one piece the same holds up to so many times the distance at which corners are welded: what lies further apart may
/// be a slit.
const WITHIN: f64 = 10.0;

/// An edge at which the surface ends.
struct Rim {
    /// Of the points at its ends, the lower first.
    numbers: [u32; 2],
    ends: [DVec3; 2],
    /// The piece of the surface that ends there.
    piece: usize,
    /// How far the ends of one beside it may be, at most.
    reach: f64,
}

/// Refuses a mesh if half or more of the edges at which it ends lie beside one another.
pub(super) fn refuse(mesh: &Mesh) -> Result<(), Error> {
    let rims = rims(mesh);
    let gaps: Vec<Option<f64>> = gaps(&rims, mesh.scale.single_tol);
    let count = gaps.iter().flatten().count();
    let Some(first) = gaps.iter().position(Option::is_some).filter(|_| 2 * count >= rims.len()) else {
        return Ok(());
    };
    let widest = gaps.iter().flatten().copied().fold(0.0, f64::max);
    let problem = format!(
        "{count} of {} edges at which the surface ends lie beside another one, their ends up to {widest:.1e} apart: too near \
         to be meant, but not welded (corners up to {:.1e} apart are, if no triangle loses one)",
        rims.len(),
        mesh.scale.single_tol
    );
    let place = format!("an edge at {}", at(rims[first].ends[0]));
    let remedy = if mesh.scale.is_far() {
        "weld the corners where the mesh is made, with its origin close to it"
    } else {
        "weld the corners where the mesh is made"
    };
    Err(Error::new("vertices", problem, place, remedy))
}

fn rims(mesh: &Mesh) -> Vec<Rim> {
    let open = mesh.open_edges();
    if open.is_empty() {
        return Vec::new();
    }
    let mut pieces = Groups::new(mesh.points.len());
    for [a, b, c] in mesh.triangles.iter().map(|triangle| triangle.map(|k| k as usize)) {
        pieces.unite(a, b);
        pieces.unite(b, c);
    }
    let rim = |half: u32| {
        let [a, b] = mesh.ends(half);
        let numbers = [a.min(b), a.max(b)];
        let piece = pieces.root(numbers[0] as usize);
        let ends = numbers.map(|k| mesh.points[k as usize]);
        Rim { numbers, ends, piece, reach: (NEAR * mesh.scale.size).min(BESIDE * ends[0].distance(ends[1])) }
    };
    open.into_iter().map(rim).collect()
}

/// For each how far the ends of the nearest one beside it are from its own. Two that meet in one end, and have an edge from one to
/// the other at the other end, are sides of a hole: if that is lower than the tolerance, it closes when straight runs lose their
/// corners.
fn gaps(rims: &[Rim], tol: f64) -> Vec<Option<f64>> {
    // Edges beside one another are nearly as long, so that their cells are as wide or differ by one step.
    let level = |rim: &Rim| rim.reach.log2().floor() as i32;
    let cell =
        |point: DVec3, level: i32| (point / 2_f64.powi(level + 1)).floor().to_array().map(|x| x as i64);
    let middle = |rim: &Rim| 0.5 * (rim.ends[0] + rim.ends[1]);
    let mut cells: HashMap<(i32, [i64; 3]), Vec<usize>> = HashMap::new();
    for (k, rim) in rims.iter().enumerate() {
        cells.entry((level(rim), cell(middle(rim), level(rim)))).or_default().push(k);
    }
    let sides: HashSet<[u32; 2]> = rims.iter().map(|rim| rim.numbers).collect();
    let gap = |(k, rim): (usize, &Rim)| {
        let mut least: Option<f64> = None;
        for level in level(rim) - 1..=level(rim) + 1 {
            let (low, high) = (middle(rim) - rim.reach, middle(rim) + rim.reach);
            for cell in between(cell(low, level), cell(high, level)) {
                let others = cells.get(&(level, cell)).into_iter().flatten().filter(|&&j| j != k);
                for other in others.map(|&j| &rims[j]) {
                    let [a, b] = other.ends;
                    let apart = |a: DVec3, b: DVec3| a.distance(rim.ends[0]).max(b.distance(rim.ends[1]));
                    let gap = apart(a, b).min(apart(b, a));
                    let within = if other.piece == rim.piece { WITHIN * tol } else { f64::INFINITY };
                    let is_hole = gap <= tol && third(rim, other).is_some_and(|side| sides.contains(&side));
                    if gap <= rim.reach.min(within) && !is_hole && least.is_none_or(|least| gap < least) {
                        least = Some(gap);
                    }
                }
            }
        }
        least
    };
    rims.iter().enumerate().map(gap).collect()
}

/// The side that makes a triangle of two that meet in one end.
fn third(rim: &Rim, other: &Rim) -> Option<[u32; 2]> {
    let rest = |rim: &Rim, other: &Rim| rim.numbers.into_iter().find(|k| !other.numbers.contains(k));
    let meets = rim.numbers.iter().any(|k| other.numbers.contains(k));
    let [a, b] = [rest(rim, other)?, rest(other, rim)?];
    meets.then_some([a.min(b), a.max(b)])
}
