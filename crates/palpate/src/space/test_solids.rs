//! Solids for tests, put together by hand or read from triangles.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::{DMat3, DVec3, dvec3};

use super::model::{Edge, Face, Model, Vertex};
use super::pose::{Pose, rotation};
use crate::feature::Feature;
use crate::part::Surface;

/// A small generator of numbers in `[0, 1)` (splitmix64), so that tests repeat.
pub(super) struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number below `count`.
    #[expect(clippy::cast_sign_loss, reason = "both are positive")]
    pub fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
    }

    /// Evenly on the sphere.
    pub fn direction(&mut self) -> DVec3 {
        let (z, turn) = (2.0 * self.next() - 1.0, TAU * self.next());
        let r = (1.0 - z * z).sqrt();
        dvec3(r * turn.cos(), r * turn.sin(), z)
    }

    pub fn pose(&mut self) -> Pose {
        let (turn, place) = (TAU * self.next(), 300.0 * self.next());
        Pose::new(turn * self.direction(), place * self.direction())
    }

    /// Positive shares of one, at times all but on a side or at a corner.
    pub fn shares(&mut self, count: usize) -> Vec<f64> {
        let power = [0.3, 1.0, 4.0, 30.0][self.below(4)];
        let shares: Vec<f64> = (0..count).map(|_| self.next().powf(power) + 1e-300).collect();
        let sum: f64 = shares.iter().sum();
        shares.iter().map(|share| share / sum).collect()
    }

    /// A point of a convex set given by its corners.
    pub fn point_of(&mut self, corners: &[DVec3]) -> DVec3 {
        self.shares(corners.len()).iter().zip(corners).map(|(share, corner)| *share * *corner).sum()
    }
}

/// The convex sets that make up a feature.
pub(super) fn hulls(model: &Model, feature: Feature) -> Vec<Vec<DVec3>> {
    let point = |number: &u32| model.vertices[*number as usize].point;
    let number = feature.number() as usize;
    match feature {
        Feature::Face(_) => {
            model.faces[number].pieces.iter().map(|piece| piece.iter().map(point).collect()).collect()
        }
        Feature::Edge(_) => vec![model.edges[number].ends.iter().map(point).collect()],
        Feature::Vertex(_) => vec![vec![model.vertices[number].point]],
    }
}

/// The corners of its cone of normals.
pub(super) fn normals(model: &Model, feature: Feature) -> Vec<DVec3> {
    let number = feature.number() as usize;
    match feature {
        Feature::Face(_) => vec![model.faces[number].normal],
        Feature::Edge(_) => model.edges[number].normals.expect("convex").to_vec(),
        Feature::Vertex(_) => model.vertices[number].normals.clone().expect("convex"),
    }
}

/// A point of a feature and one of its normals.
pub(super) fn touch(random: &mut Random, model: &Model, feature: Feature) -> (DVec3, DVec3) {
    let hulls = hulls(model, feature);
    let hull = random.below(hulls.len());
    let point = random.point_of(&hulls[hull]);
    (point, random.point_of(&normals(model, feature)).normalize_or_zero())
}

/// A face: its loops, and its convex pieces.
type Shell = (Vec<Vec<u32>>, Vec<Vec<u32>>);

/// A closed solid from the loops and convex pieces of its faces, counter-clockwise as seen from outside. A vertex has
/// a cone only if all of its edges are convex.
pub(super) fn solid(points: &[DVec3], shells: Vec<Shell>) -> Model {
    let at = |number: u32| points[number as usize];
    let mut faces = Vec::new();
    let mut sides: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for (loops, pieces) in shells {
        for corners in &loops {
            for (k, corner) in corners.iter().enumerate() {
                sides.insert([*corner, corners[(k + 1) % corners.len()]], faces.len());
            }
        }
        let outer = &loops[0];
        let middle = outer.iter().map(|corner| at(*corner)).sum::<DVec3>() / outer.len() as f64;
        let newell = (0..outer.len())
            .map(|k| (at(outer[k]) - middle).cross(at(outer[(k + 1) % outer.len()]) - middle));
        let normal = newell.sum::<DVec3>().normalize_or_zero();
        faces.push(Face { normal, offset: normal.dot(middle), loops, pieces, surface: Surface::Touchable });
    }
    let mut edges = Vec::new();
    let mut cones = vec![Some(Vec::new()); points.len()];
    for ([from, to], left) in sides.iter().filter(|([from, to], _)| from < to) {
        let right = sides[&[*to, *from]];
        let [a, b] = [*left, right].map(|face| faces[face].normal);
        let convex = a.cross(b).dot(at(*to) - at(*from)) > 0.0;
        let normals = convex.then_some([a, b]);
        for end in [*from, *to] {
            let cone = &mut cones[end as usize];
            match (cone.as_mut(), normals) {
                (Some(cone), Some(normals)) => cone.extend(normals),
                _ => *cone = None,
            }
        }
        let [left, right] = [*left, right].map(|face| Some(face as u32));
        edges.push(Edge { ends: [*from, *to], faces: [left, right], normals });
    }
    let vertices = points.iter().zip(cones);
    let vertices =
        vertices.map(|(point, cone)| Vertex { point: *point, normals: cone.map(around) }).collect();
    let size = points.iter().flat_map(|a| points.iter().map(|b| a.distance(*b))).fold(0.0, f64::max);
    Model {
        name: "solid".into(),
        faces,
        edges,
        vertices,
        triangles: Vec::new(),
        closed: true,
        symmetries: Vec::new(),
        roundness: None,
        position_slack: 0.0,
        normal_slack: 0.0,
        mends: Vec::new(),
        size,
        asymmetry: (0.0, 0.0),
        precision: 0.0,
        tables: super::tables::TableCache::default(),
        bvh: super::bvh::BvhCache::default(),
    }
}

/// Each normal once, counter-clockwise about their middle.
fn around(mut normals: Vec<DVec3>) -> Vec<DVec3> {
    let axis = normals.iter().sum::<DVec3>().normalize_or_zero();
    let (x, y) = axis.any_orthonormal_pair();
    normals.sort_by(|a, b| f64::atan2(a.dot(y), a.dot(x)).total_cmp(&f64::atan2(b.dot(y), b.dot(x))));
    normals.dedup();
    normals
}

/// The solid between an outline at height 0 and the same at `height`; `pieces` are of the outline.
fn prism(outline: &[(f64, f64)], holes: &[Vec<u32>], pieces: &[Vec<u32>], height: f64) -> Model {
    let count = outline.len() as u32;
    let holed: usize = holes.iter().map(Vec::len).sum();
    let level = |z: f64| outline.iter().map(move |(x, y)| dvec3(*x, *y, z));
    let points: Vec<DVec3> = level(0.0).chain(level(height)).collect();
    let outer: Vec<u32> = (0..count - holed as u32).collect();
    let loops: Vec<Vec<u32>> = std::iter::once(outer).chain(holes.iter().cloned()).collect();
    let lifted = |lists: &[Vec<u32>]| -> Vec<Vec<u32>> {
        lists.iter().map(|list| list.iter().map(|number| number + count).collect()).collect()
    };
    let turned = |lists: &[Vec<u32>]| -> Vec<Vec<u32>> {
        lists.iter().map(|list| list.iter().rev().copied().collect()).collect()
    };
    let mut shells = vec![(turned(&loops), turned(pieces)), (lifted(&loops), lifted(pieces))];
    for corners in &loops {
        for (k, &from) in corners.iter().enumerate() {
            let to = corners[(k + 1) % corners.len()];
            let side = vec![from, to, to + count, from + count];
            shells.push((vec![side.clone()], vec![side]));
        }
    }
    solid(&points, shells)
}

pub(super) fn regular_prism(sides: u32, radius: f64, height: f64) -> Model {
    let turn = |k: u32| TAU * f64::from(k) / f64::from(sides);
    let outline: Vec<(f64, f64)> =
        (0..sides).map(|k| (radius * turn(k).cos(), radius * turn(k).sin())).collect();
    prism(&outline, &[], &[(0..sides).collect()], height)
}

pub(super) fn l_prism() -> Model {
    let outline = [(0., 0.), (30., 0.), (30., 10.), (10., 10.), (10., 25.), (0., 25.)];
    prism(&outline, &[], &[vec![0, 1, 2, 3], vec![0, 3, 4, 5]], 12.0)
}

/// A box with a square hole through it.
pub(super) fn frame() -> Model {
    let outline = [(0., 0.), (40., 0.), (40., 30.), (0., 30.), (10., 8.), (25., 8.), (25., 20.), (10., 20.)];
    let pieces = [vec![0, 1, 5, 4], vec![1, 2, 6, 5], vec![2, 3, 7, 6], vec![3, 0, 4, 7]];
    prism(&outline, &[vec![7, 6, 5, 4]], &pieces, 9.0)
}

/// The hull of points in general position, by trying all triples.
pub(super) fn hull(points: &[DVec3]) -> Model {
    let count = points.len();
    let mut shells = Vec::new();
    for a in 0..count {
        for b in a + 1..count {
            for c in b + 1..count {
                let normal = (points[b] - points[a]).cross(points[c] - points[a]);
                let heights: Vec<f64> = (0..count)
                    .filter(|k| ![a, b, c].contains(k))
                    .map(|k| normal.dot(points[k] - points[a]))
                    .collect();
                let triangle = if heights.iter().all(|height| *height < 0.0) {
                    [a, b, c]
                } else if heights.iter().all(|height| *height > 0.0) {
                    [a, c, b]
                } else {
                    continue;
                };
                let triangle: Vec<u32> = triangle.iter().map(|k| *k as u32).collect();
                shells.push((vec![triangle.clone()], vec![triangle]));
            }
        }
    }
    solid(points, shells)
}

/// An octahedron whose faces were divided in four so many times, its corners on a sphere.
pub(super) fn ball(times: u32, radius: f64) -> Model {
    let mut points = vec![DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let mut triangles: Vec<[u32; 3]> =
        (0..4).flat_map(|k| [[k, (k + 1) % 4, 4], [(k + 1) % 4, k, 5]]).collect();
    for _ in 0..times {
        let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        let mut finer = Vec::new();
        for triangle in &triangles {
            let middle = [0, 1, 2].map(|k| {
                let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
                *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    points.push((points[a as usize] + points[b as usize]).normalize_or_zero());
                    points.len() as u32 - 1
                })
            });
            let [a, b, c] = *triangle;
            let [ab, bc, ca] = middle;
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    let points: Vec<DVec3> = points.iter().map(|point| radius * *point).collect();
    solid(&points, triangles.iter().map(|t| (vec![t.to_vec()], vec![t.to_vec()])).collect())
}

/// The same part under a stretch, a shear and a motion: what is convex or planar stays so.
pub(super) fn warped(random: &mut Random, model: &Model) -> Model {
    let mut column = |k: usize| {
        let mut axis = DVec3::from_array([0, 1, 2].map(|_| 0.3 * (2.0 * random.next() - 1.0)));
        axis[k] += 1.0;
        axis
    };
    let stretch = DMat3::from_cols(column(0), column(1), column(2));
    let motion = rotation(TAU * random.next() * random.direction()) * stretch;
    let place = 100.0 * random.next() * random.direction();
    let points: Vec<DVec3> = model.vertices.iter().map(|vertex| motion * vertex.point + place).collect();
    solid(&points, model.faces.iter().map(|face| (face.loops.clone(), face.pieces.clone())).collect())
}

/// Boxes, prisms, a part with a hole, tetrahedra and other hulls, each in some shape.
pub(super) fn random_solid(random: &mut Random) -> Model {
    let shape = match random.below(6) {
        0 => regular_prism(4, 20.0, 10.0 + 20.0 * random.next()),
        1 => regular_prism(3 + random.below(6) as u32, 20.0, 5.0 + 40.0 * random.next()),
        2 => l_prism(),
        3 => frame(),
        4 => hull(&(0..4).map(|_| 30.0 * random.direction()).collect::<Vec<_>>()),
        _ => hull(&(0..6 + random.below(5)).map(|_| 30.0 * random.direction()).collect::<Vec<_>>()),
    };
    let shape = if random.below(3) == 0 { shape } else { warped(random, &shape) };
    if random.below(2) == 0 { shape } else { read(&shape) }
}

/// The same part as it is read from triangles, with the cones of corners that are not convex all around.
fn read(model: &Model) -> Model {
    let points: Vec<DVec3> = model.vertices.iter().map(|vertex| vertex.point).collect();
    let pieces = model.faces.iter().flat_map(|face| &face.pieces);
    let fans = pieces.flat_map(|piece| (2..piece.len()).map(|k| [piece[0], piece[k - 1], piece[k]]));
    let triangles: Vec<[u32; 3]> = fans.collect();
    Model::mesh("solid", &points, &triangles, &[], 0.0, 0.0).expect("a clean solid")
}
