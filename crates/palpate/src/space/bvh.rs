//! Triangles by where they are: a binary tree of boxes.

use std::sync::OnceLock;

use glam::DVec3;

use super::model::Model;
use super::rims::Rims;

/// Triangles in a leaf, at most.
const LEAF: usize = 4;

/// Boxes are wider than computed by this share of the model's reach.
const OUTWARD: f64 = 1e-13;

/// The nearest point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// How far it is.
    pub distance: f64,
    /// The face on which it lies; the first of those that share it.
    pub face: u32,
    /// Where it is, model frame.
    pub point: DVec3,
}

/// A box, and what is in it.
#[derive(Debug, Clone)]
pub(super) struct Node {
    low: DVec3,
    high: DVec3,
    /// Of a leaf, the first of its triangles; else the second child. The first child follows its parent.
    first: u32,
    /// Of a leaf, how many triangles; else 0.
    count: u32,
}

/// The tree.
#[derive(Debug, Clone)]
pub(super) struct Bvh {
    nodes: Vec<Node>,
    /// Where the corners of each triangle are, leaf by leaf.
    corners: Vec<[DVec3; 3]>,
    /// The face of each of them.
    faces: Vec<u32>,
    /// Which triangle of the model each of them is.
    numbers: Vec<u32>,
    /// What a ball may meet beside them, made when first needed.
    rims: OnceLock<Rims>,
}

/// The tree of a model, made once.
#[derive(Debug, Clone, Default)]
pub(super) struct BvhCache(OnceLock<Bvh>);

impl PartialEq for BvhCache {
    /// The tree follows from the model: it makes no two models differ.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Model {
    /// Its triangles by where they are.
    pub(super) fn bvh(&self) -> &Bvh {
        self.bvh.0.get_or_init(|| Bvh::new(self))
    }
}

impl Bvh {
    fn new(model: &Model) -> Self {
        let corners: Vec<[DVec3; 3]> = model
            .triangles
            .iter()
            .map(|(triangle, _)| triangle.map(|k| model.vertices[k as usize].point))
            .collect();
        let reach = corners.iter().flatten().map(|point| point.abs().max_element()).fold(0.0, f64::max);
        let mut order: Vec<u32> = (0..corners.len() as u32).collect();
        let mut nodes = Vec::with_capacity(corners.len());
        let middles: Vec<DVec3> = corners.iter().map(|[a, b, c]| (*a + *b + *c) / 3.0).collect();
        split(&mut nodes, &mut order, 0, &corners, &middles, OUTWARD * reach);
        let by_leaf = |k: &u32| corners[*k as usize];
        let faces = order.iter().map(|&k| model.triangles[k as usize].1).collect();
        let corners = order.iter().map(by_leaf).collect();
        Self { nodes, corners, faces, numbers: order, rims: OnceLock::new() }
    }

    /// The box around all.
    pub(super) fn around(&self) -> (DVec3, DVec3) {
        (self.nodes[0].low, self.nodes[0].high)
    }

    /// Edges and vertices of its model that a ball may meet, at triangles by their places in the leaves.
    pub(super) fn rims(&self, model: &Model) -> &Rims {
        self.rims.get_or_init(|| Rims::new(model, &self.numbers))
    }

    /// No corner is further from a point.
    pub(super) fn reach(&self, point: DVec3) -> f64 {
        let root = &self.nodes[0];
        (point - root.low).abs().max((root.high - point).abs()).length()
    }

    /// Visits the triangles whose boxes have a `bound` of no more than the least that was found, the nearest boxes
    /// first. `measure` is given the corners and the face of a triangle, and answers with the new least.
    pub(super) fn descend(
        &self,
        least: f64,
        bound: impl Fn(DVec3, DVec3) -> f64,
        mut measure: impl FnMut(&[DVec3; 3], u32) -> f64,
    ) {
        self.descend_placed(least, bound, |corners, face, _| measure(corners, face));
    }

    /// The same; `measure` is given the place of the triangle in the leaves as well.
    pub(super) fn descend_placed(
        &self,
        mut least: f64,
        bound: impl Fn(DVec3, DVec3) -> f64,
        mut measure: impl FnMut(&[DVec3; 3], u32, usize) -> f64,
    ) {
        let of_node = |k: u32| bound(self.nodes[k as usize].low, self.nodes[k as usize].high);
        let mut open = vec![(of_node(0), 0_u32)];
        while let Some((below, k)) = open.pop() {
            if below > least {
                continue;
            }
            let node = &self.nodes[k as usize];
            if node.count > 0 {
                for t in node.first as usize..(node.first + node.count) as usize {
                    least = measure(&self.corners[t], self.faces[t], t);
                }
                continue;
            }
            let (near, far) = ((of_node(k + 1), k + 1), (of_node(node.first), node.first));
            let (near, far) = if near.0 <= far.0 { (near, far) } else { (far, near) };
            open.extend([far, near]);
        }
    }

    /// The nearest point of the triangles.
    pub(super) fn nearest(&self, point: DVec3) -> Nearest {
        let mut best = Nearest { distance: f64::INFINITY, face: 0, point };
        let bound = |low: DVec3, high: DVec3| (low - point).max(point - high).max(DVec3::ZERO).length();
        self.descend(f64::INFINITY, bound, |corners, face| {
            let (distance, found) = super::distance::to_triangle(point, corners);
            if distance < best.distance || distance == best.distance && face < best.face {
                best = Nearest { distance, face, point: found };
            }
            best.distance
        });
        best
    }
}

/// Adds a node over `order`, which begins at `first` of the whole, and all below it.
fn split(
    nodes: &mut Vec<Node>,
    order: &mut [u32],
    first: usize,
    corners: &[[DVec3; 3]],
    middles: &[DVec3],
    outward: f64,
) {
    let all = || order.iter().flat_map(|&k| corners[k as usize]);
    let low = all().fold(DVec3::INFINITY, DVec3::min) - outward;
    let high = all().fold(DVec3::NEG_INFINITY, DVec3::max) + outward;
    let place = nodes.len();
    nodes.push(Node { low, high, first: first as u32, count: order.len() as u32 });
    if order.len() <= LEAF {
        return;
    }
    let spread = |k: &u32| middles[*k as usize];
    let least = order.iter().map(spread).fold(DVec3::INFINITY, DVec3::min);
    let most = order.iter().map(spread).fold(DVec3::NEG_INFINITY, DVec3::max);
    let axis = (most - least).max_position();
    let half = order.len() / 2;
    // Equal middles are told apart by their numbers, so that the tree is the same each time.
    order.select_nth_unstable_by(half, |&a, &b| {
        middles[a as usize][axis].total_cmp(&middles[b as usize][axis]).then(a.cmp(&b))
    });
    let (left, right) = order.split_at_mut(half);
    split(nodes, left, first, corners, middles, outward);
    let second = nodes.len() as u32;
    split(nodes, right, first + half, corners, middles, outward);
    nodes[place].first = second;
    nodes[place].count = 0;
}
