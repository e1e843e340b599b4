//! Solids for tests, as vertices and triangles.
#![expect(
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "cells beside a grid have numbers below 0; draws have not"
)]

use std::f64::consts::TAU;

use glam::{DMat3, DVec2, DVec3, dvec3};

use super::pieces::View;
use super::{Model, Pose};

/// Vertices and triangles.
pub(super) type Shape = (Vec<DVec3>, Vec<[u32; 3]>);

/// A small generator of numbers in `[0, 1)` (splitmix64), so that tests repeat.
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn below(&mut self, count: u32) -> u32 {
        (f64::from(count) * self.next()) as u32
    }

    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    pub(super) fn point(&mut self, low: f64, high: f64) -> DVec3 {
        dvec3(self.within(low, high), self.within(low, high), self.within(low, high))
    }

    pub(super) fn direction(&mut self) -> DVec3 {
        loop {
            let point = self.point(-1.0, 1.0);
            if (0.1..1.0).contains(&point.length()) {
                return point / point.length();
            }
        }
    }

    pub(super) fn pose(&mut self) -> Pose {
        Pose::new(TAU * self.next() * self.direction(), self.point(-100.0, 100.0))
    }
}

pub(super) fn moved((points, triangles): &Shape, pose: Pose) -> Shape {
    (points.iter().map(|point| pose.apply(*point)).collect(), triangles.clone())
}

/// The triangles of both.
pub(super) fn both(a: &Shape, b: &Shape) -> Shape {
    let first = a.0.len() as u32;
    let shifted = b.1.iter().map(|triangle| triangle.map(|k| k + first));
    (a.0.iter().chain(&b.0).copied().collect(), a.1.iter().copied().chain(shifted).collect())
}

/// Turned inside out.
pub(super) fn mirrored((points, triangles): &Shape) -> Shape {
    (points.clone(), triangles.iter().map(|&[a, b, c]| [a, c, b]).collect())
}

pub(super) fn cuboid(low: DVec3, high: DVec3) -> Shape {
    let pick = |k: u32, bit: u32, low: f64, high: f64| if k >> bit & 1 == 1 { high } else { low };
    let corner =
        |k: u32| dvec3(pick(k, 0, low.x, high.x), pick(k, 1, low.y, high.y), pick(k, 2, low.z, high.z));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    ((0..8).map(corner).collect(), triangles.collect())
}

/// The first loop of the plane is the outer one, counter-clockwise, the others are holes, clockwise.
pub(super) fn extruded(loops: &[Vec<DVec2>], height: f64) -> Shape {
    let floor: Vec<DVec3> = loops.iter().flatten().map(|point| point.extend(0.0)).collect();
    let n = floor.len() as u32;
    let mut numbered = Vec::new();
    let mut first = 0;
    for outline in loops {
        numbered.push((first..first + outline.len() as u32).collect::<Vec<u32>>());
        first += outline.len() as u32;
    }
    let top = View::new(&floor, DVec3::Z).triangles(&numbered).expect("loops that don't cross");
    let mut triangles: Vec<[u32; 3]> = top.iter().map(|triangle| triangle.map(|k| k + n)).collect();
    triangles.extend(top.iter().map(|&[a, b, c]| [a, c, b]));
    for outline in &numbered {
        for (&a, &b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
            triangles.extend([[a, b, b + n], [a, b + n, a + n]]);
        }
    }
    let points = floor.iter().copied().chain(floor.iter().map(|point| *point + height * DVec3::Z));
    (points.collect(), triangles)
}

pub(super) fn regular(n: usize, radius: f64) -> Vec<DVec2> {
    (0..n).map(|k| radius * DVec2::from_angle(TAU * k as f64 / n as f64)).collect()
}

pub(super) fn tetrahedron() -> Shape {
    let corners = [dvec3(1., 1., 1.), dvec3(1., -1., -1.), dvec3(-1., 1., -1.), dvec3(-1., -1., 1.)];
    (corners.to_vec(), vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
}

/// The hull of random points on a stretched sphere.
pub(super) fn hull(random: &mut Random, count: usize) -> Shape {
    let stretch = DMat3::from_diagonal(random.point(10.0, 60.0));
    hull_of((0..count).map(|_| stretch * random.direction()).collect())
}

fn coord(point: DVec3) -> robust::Coord3D<f64> {
    robust::Coord3D { x: point.x, y: point.y, z: point.z }
}

/// The hull of points, no four of them in a plane.
pub(super) fn hull_of(points: Vec<DVec3>) -> Shape {
    let count = points.len();
    let mut triangles = Vec::new();
    for a in 0..count {
        for b in a + 1..count {
            for c in b + 1..count {
                let [p, q, r] = [a, b, c].map(|k| coord(points[k]));
                // Above the plane it is negative.
                let heights = points.iter().map(|point| -robust::orient3d(p, q, r, coord(*point)));
                let beyond = |sign: f64| heights.clone().filter(|height| sign * height > 0.0).count();
                if beyond(1.0) == 0 {
                    triangles.push([a as u32, b as u32, c as u32]);
                } else if beyond(-1.0) == 0 {
                    triangles.push([a as u32, c as u32, b as u32]);
                }
            }
        }
    }
    (points, triangles)
}

/// A union of boxes: some of the cells of a grid that is not even.
pub(super) struct Cells {
    /// The grid's planes across each axis.
    pub(super) planes: [Vec<f64>; 3],
    /// Which cells are material.
    pub(super) is_full: Vec<bool>,
}

impl Cells {
    pub(super) fn random(random: &mut Random, count: usize, share: f64) -> Self {
        let planes = [(); 3].map(|()| {
            let mut at = -30.0;
            let mut planes = vec![at];
            for _ in 0..count {
                at += random.within(3.0, 20.0);
                planes.push(at);
            }
            planes
        });
        Self { planes, is_full: (0..count.pow(3)).map(|_| random.next() < share).collect() }
    }

    fn count(&self) -> i64 {
        self.planes[0].len() as i64 - 1
    }

    pub(super) fn is_full(&self, cell: [i64; 3]) -> bool {
        let n = self.count();
        cell.iter().all(|k| (0..n).contains(k))
            && self.is_full[(cell[0] + n * (cell[1] + n * cell[2])) as usize]
    }

    fn cells(&self) -> impl Iterator<Item = [i64; 3]> + '_ {
        let n = self.count();
        (0..n.pow(3)).map(move |k| [k % n, k / n % n, k / n / n]).filter(|cell| self.is_full(*cell))
    }

    pub(super) fn volume(&self) -> f64 {
        let width = |axis: usize, k: i64| self.planes[axis][k as usize + 1] - self.planes[axis][k as usize];
        self.cells().map(|cell| (0..3).map(|axis| width(axis, cell[axis])).product::<f64>()).sum()
    }

    pub(super) fn holds(&self, point: DVec3) -> bool {
        let cell = [0, 1, 2]
            .map(|axis| self.planes[axis].iter().filter(|plane| **plane < point[axis]).count() as i64 - 1);
        self.is_full(cell)
    }

    /// The sides of full cells towards empty ones.
    pub(super) fn shape(&self) -> Shape {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for cell in self.cells() {
            for axis in 0..3 {
                for up in [false, true] {
                    let mut beside = cell;
                    beside[axis] += if up { 1 } else { -1 };
                    if self.is_full(beside) {
                        continue;
                    }
                    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                    let first = points.len() as u32;
                    for (du, dv) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
                        let mut corner = cell;
                        corner[axis] += i64::from(up);
                        corner[u] += du;
                        corner[v] += dv;
                        points.push(DVec3::from([0, 1, 2].map(|k| self.planes[k][corner[k] as usize])));
                    }
                    let sides = [[0, 1, 2], [0, 2, 3]].map(|side: [u32; 3]| side.map(|k| k + first));
                    triangles.extend(if up { sides } else { sides.map(|[a, b, c]| [a, c, b]) });
                }
            }
        }
        (points, triangles)
    }
}

pub(super) fn mesh(shape: &Shape) -> Model {
    Model::mesh("part", &shape.0, &shape.1, &[], 0.0, 0.0).expect("a mesh")
}
