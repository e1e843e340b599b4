//! Edges and vertices that a ball may meet before a face.

use super::model::{Edge, Model};
use crate::Feature;
use crate::part::Surface;

/// Where the sine between two faces is above it, an edge that is no ridge is a groove; normals of slivers are not known
/// better than to 1e-7.
const SURE: f64 = 1e-6;

/// Edges and vertices, each at one of the triangles beside it.
///
/// A ball meets no groove of a closed part: it meets a face before, or both at once. It meets no vertex at which all edges
/// are grooves: if the part is within a half-space there, so is its hull, and an edge of that hull is a ridge.
#[derive(Debug, Clone)]
pub(super) struct Rims {
    /// Where those at a triangle begin, by the place of the triangle.
    first: Vec<u32>,
    features: Vec<Feature>,
}

impl Rims {
    /// Of triangles in the order of these numbers.
    pub(super) fn new(model: &Model, triangles: &[u32]) -> Self {
        let mut sides: Vec<([u32; 3], u32)> = Vec::with_capacity(2 * model.edges.len());
        let mut is_new_vertex = vec![false; model.vertices.len()];
        for (number, edge) in (0..).zip(&model.edges).filter(|(_, edge)| !is_groove(model, edge)) {
            sides.extend(edge.faces.iter().flatten().map(|&face| (side(face, edge.ends), number)));
            for end in edge.ends {
                is_new_vertex[end as usize] = true;
            }
        }
        sides.sort_unstable();
        let mut is_new_edge = vec![true; model.edges.len()];

        let mut rims = Self { first: Vec::with_capacity(triangles.len() + 1), features: Vec::new() };
        for &triangle in triangles {
            rims.first.push(rims.features.len() as u32);
            let ([a, b, c], face) = model.triangles[triangle as usize];
            for ends in [[a, b], [b, c], [c, a]] {
                let this = side(face, ends);
                let from = sides.partition_point(|(side, _)| *side < this);
                for (_, edge) in sides[from..].iter().take_while(|(side, _)| *side == this) {
                    if std::mem::take(&mut is_new_edge[*edge as usize]) {
                        rims.features.push(Feature::Edge(*edge));
                    }
                }
            }
            for vertex in [a, b, c] {
                if std::mem::take(&mut is_new_vertex[vertex as usize]) {
                    rims.features.push(Feature::Vertex(vertex));
                }
            }
        }
        rims.first.push(rims.features.len() as u32);
        rims
    }

    /// Those at the triangle in this place.
    pub(super) fn at(&self, place: usize) -> &[Feature] {
        &self.features[self.first[place] as usize..self.first[place + 1] as usize]
    }
}

/// A side of a face, whichever way it runs.
fn side(face: u32, [a, b]: [u32; 2]) -> [u32; 3] {
    [face, a.min(b), a.max(b)]
}

/// Whether more than half of the space about an edge of a closed part is material, for sure.
pub(super) fn is_groove(model: &Model, edge: &Edge) -> bool {
    let [Some(left), Some(right)] = edge.faces.map(|face| face.map(|face| &model.faces[face as usize]))
    else {
        return false;
    };
    let [from, to] = edge.ends.map(|end| model.vertices[end as usize].point);
    let along = (to - from).normalize_or_zero();
    let is_there = [left, right].iter().all(|face| face.surface != Surface::Seam);
    model.closed && is_there && left.normal.cross(right.normal).dot(along) < -SURE
}
