//! Triangles of one plane put together.
//!
//! **What a region may be.** Its corners lie within `single_tol` of one plane, and that plane is known to `TURN_TOL`.
//! Let every corner be within `d` of the plane that is found and of the true one. The height of one plane above the
//! other is then an affine function on the region which at its corners, hence on their convex hull, is at most `2 d`.
//! The hull has a width of at least `A / D` in every direction (area over diameter), so that the function's slope is
//! at most `4 d D / A`: the tangent of the angle between the planes. Where corners were welded, `d` is what they are off
//! the plane and how far they were moved, together.

use glam::DVec3;

use super::mesh::Mesh;
use super::scale::Scale;
use crate::part::Surface;

/// The most by which a region's plane may be turned against the true one, radians.
pub(super) const TURN_TOL: f64 = 1e-3;

/// Triangles whose normals are further apart are no part of one region: cosine.
const FACING: f64 = 0.9;

/// Triangles no higher than so many times what single precision may make of a point have no normal of their own.
const SLIVER: f64 = 8.0;

/// A plane, `normal · x = offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plane {
    /// Unit.
    pub(super) normal: DVec3,
    /// Along it from the origin.
    pub(super) offset: f64,
    /// No corner of the region is further from it.
    pub(super) deviation: f64,
    /// `D / A` of the region.
    slenderness: f64,
}

/// Triangles of one plane that hang together.
#[derive(Debug)]
pub(super) struct Region {
    /// Triangle numbers.
    pub(super) triangles: Vec<u32>,
    /// Where they lie.
    pub(super) plane: Plane,
    /// What they are to a probe.
    pub(super) surface: Surface,
}

impl Region {
    /// How far its corners are from those as given, at most.
    pub(super) fn moved(&self, mesh: &Mesh) -> f64 {
        let corners = self.triangles.iter().flat_map(|&t| mesh.triangles[t as usize]);
        corners.map(|k| mesh.moved[k as usize]).fold(0.0, f64::max)
    }
}

impl Plane {
    /// Of points with the area vector of what they bound: the normal is the area's (Newell), the offset amid the points.
    pub(super) fn new(area: DVec3, points: impl Iterator<Item = DVec3> + Clone) -> Self {
        let normal = area.normalize_or_zero();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for point in points {
            let height = normal.dot(point);
            (low, high) = (low.min(height), high.max(height));
            (least, most) = (least.min(point), most.max(point));
        }
        let slenderness = least.distance(most) / area.length();
        Self { normal, offset: 0.5 * (low + high), deviation: 0.5 * (high - low), slenderness }
    }

    /// Whether it is that of a sliver, whose normal says nothing.
    pub(super) fn is_narrow(&self, scale: Scale) -> bool {
        self.slenderness * 0.5 * SLIVER * scale.single_tol >= 1.0
    }

    /// The angle by which it may be turned against the true plane, radians, if corners were moved by no more than `moved`.
    pub(super) fn turn(&self, moved: f64) -> f64 {
        (4.0 * (self.deviation + moved) * self.slenderness).atan()
    }
}

/// All of them; each triangle is in one. Large triangles first, as their planes are known best.
pub(super) fn regions(mesh: &Mesh, twins: &[Option<u32>]) -> Vec<Region> {
    let areas: Vec<DVec3> = (0..mesh.triangles.len()).map(|t| 0.5 * mesh.area_vector(t)).collect();
    let mut seeds: Vec<usize> = (0..areas.len()).collect();
    seeds.sort_by(|&a, &b| areas[b].length_squared().total_cmp(&areas[a].length_squared()));
    let mut growth = Growth { mesh, twins, areas, is_taken: vec![false; mesh.triangles.len()] };
    let mut regions: Vec<Region> = seeds.into_iter().filter_map(|seed| growth.region(seed)).collect();
    // In the order in which the triangles were given.
    for region in &mut regions {
        region.triangles.sort_unstable();
    }
    regions.sort_by_key(|region| region.triangles[0]);
    regions
}

struct Growth<'a> {
    mesh: &'a Mesh,
    twins: &'a [Option<u32>],
    areas: Vec<DVec3>,
    is_taken: Vec<bool>,
}

impl Growth<'_> {
    /// The region about a triangle, if it is in none yet.
    fn region(&mut self, seed: usize) -> Option<Region> {
        if std::mem::replace(&mut self.is_taken[seed], true) {
            return None;
        }
        let mut triangles = vec![seed as u32];
        let mut plane = self.plane(&triangles);
        // Each round has a better plane than the one before, as it is that of a larger region.
        loop {
            let known = triangles.len();
            self.grow(&mut triangles, &plane);
            if triangles.len() == known {
                break;
            }
            let wider = self.plane(&triangles);
            if wider.deviation > self.mesh.scale.single_tol || wider.turn(0.0) > TURN_TOL {
                for t in triangles.drain(known..) {
                    self.is_taken[t as usize] = false;
                }
                break;
            }
            plane = wider;
        }
        Some(Region { triangles, plane, surface: self.mesh.surfaces[seed] })
    }

    /// Adds what hangs together with the region and lies in the plane.
    fn grow(&mut self, triangles: &mut Vec<u32>, plane: &Plane) {
        let mut next = 0;
        while let Some(&t) = triangles.get(next) {
            next += 1;
            for half in 3 * t..3 * t + 3 {
                let Some(twin) = self.twins[half as usize] else { continue };
                let other = (twin / 3) as usize;
                let opposed = self.mesh.ends(half)[0] == self.mesh.ends(twin)[1];
                let alike = self.mesh.surfaces[other] == self.mesh.surfaces[t as usize];
                if opposed && alike && !self.is_taken[other] && self.lies_in(other, plane) {
                    self.is_taken[other] = true;
                    triangles.push(other as u32);
                }
            }
        }
    }

    fn lies_in(&self, triangle: usize, plane: &Plane) -> bool {
        let single_tol = self.mesh.scale.single_tol;
        let height = |point: DVec3| (plane.normal.dot(point) - plane.offset).abs();
        if self.mesh.corners(triangle).into_iter().any(|point| height(point) > single_tol) {
            return false;
        }
        let area = self.areas[triangle];
        area.dot(plane.normal) > FACING * area.length() || self.mesh.height(triangle) <= SLIVER * single_tol
    }

    fn plane(&self, triangles: &[u32]) -> Plane {
        let area = triangles.iter().map(|&t| self.areas[t as usize]).sum();
        Plane::new(area, triangles.iter().flat_map(|&t| self.mesh.corners(t as usize)))
    }
}
