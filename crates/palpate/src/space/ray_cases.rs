//! Lines past parts, and first contacts on them found by distances alone.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::{Display, Formatter, Result};

use glam::{DVec2, DVec3, dvec2, dvec3};

use super::distance::on_segment;
use super::query_tests::triangle_distance;
use super::shapes::{Cells, Random, both, cuboid, extruded, hull, mesh, mirrored, regular, tetrahedron};
use super::{Face, Model, Pose};
use crate::part::Surface;
use crate::{Feature, FirstContact, Line};

/// What is allowed for in places, as a share of the scale.
const PLACE: f64 = 1e-9;

/// A contact is grazing if it comes, goes, or moves by more than that when the radius changes by this share of the scale.
const GRAZING: f64 = 1e-11;

/// A part, where it is, and a line that is clear of it.
pub(super) struct Case<'a> {
    pub(super) model: &'a Model,
    pub(super) world_from_model: Pose,
    pub(super) line: Line<DVec3>,
    pub(super) radius: f64,
}

/// What became of one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Found {
    Contact,
    Nothing,
    Grazing,
}

impl Case<'_> {
    /// The largest of all lengths and coordinates.
    fn scale(&self) -> f64 {
        let start = self.line.start.abs().max(self.world_from_model.translation.abs());
        let farthest = self.model.vertices.iter().map(|vertex| vertex.point.abs());
        farthest.fold(start, DVec3::max).max_element().max(self.model.size).max(self.radius)
    }

    /// By how much the radius is changed; faces may be off their triangles.
    fn slack(&self) -> f64 {
        GRAZING * self.scale() + 2.0 * self.model.position_slack
    }

    /// What is allowed for in places: what a face is off its triangles, as seen along the line.
    fn place(&self, met: Option<&FirstContact<DVec3>>) -> f64 {
        let steep = met.map_or(1.0, |met| met.normal.dot(self.line.direction).abs().max(1e-3));
        PLACE * self.scale() + 2.0 * self.model.position_slack / steep
    }

    fn distance(&self, depth: f64) -> f64 {
        let place = self.world_from_model.inverse().apply(self.line.at(depth));
        self.model.signed_distance(place)
    }

    /// Where a point goes through a loose face, well inside of its rim.
    fn pierced(&self) -> Option<f64> {
        let model_from_world = self.world_from_model.inverse();
        let start = model_from_world.apply(self.line.start);
        let direction = model_from_world.rotation * self.line.direction;
        let of_face = |face: &Face| {
            let speed = face.normal.dot(direction);
            let depth = (face.offset - face.normal.dot(start)) / speed;
            let place = start + depth * direction;
            let mut turns = 0.0;
            for outline in &face.loops {
                let at = |number: &u32| self.model.vertices[*number as usize].point;
                for (a, b) in outline.iter().map(at).zip(outline.iter().map(at).cycle().skip(1)) {
                    let nearest = on_segment(place, a, b);
                    if nearest.distance(place) < 1e-6 * self.scale() {
                        return None;
                    }
                    let (a, b) = (a - place, b - place);
                    turns += face.normal.dot(a.cross(b)).atan2(a.dot(b)) / TAU;
                }
            }
            (speed.abs() > 1e-6 && depth > 0.0 && turns > 0.5).then_some(depth)
        };
        let there = self.model.faces.iter().filter(|face| face.surface != Surface::Seam);
        there.filter_map(of_face).reduce(f64::min)
    }

    /// Where a ball of this radius stops that goes as far as the distance lets it, again and again.
    pub(super) fn traced(&self, radius: f64, last: f64) -> Option<f64> {
        let (mut depth, slack) = (0.0, GRAZING * self.scale());
        for _ in 0..1_000_000 {
            if depth > last {
                return None;
            }
            let free = self.distance(depth) - radius;
            if free < slack {
                return Some(depth);
            }
            depth += free;
        }
        panic!("the march does not end: {self}");
    }

    /// The same by the distances to each triangle, which are convex along the line: their least, and the way down to it.
    pub(super) fn searched(&self, radius: f64, last: f64) -> Option<f64> {
        let model_from_world = self.world_from_model.inverse();
        let first = |corners: [DVec3; 3]| {
            let distance =
                |depth: f64| triangle_distance(model_from_world.apply(self.line.at(depth)), corners);
            let (mut low, mut high) = (0.0, last);
            let golden = 0.5 * (5_f64.sqrt() - 1.0);
            for _ in 0..90 {
                let [a, b] = [high - golden * (high - low), low + golden * (high - low)];
                if distance(a) <= distance(b) { high = b } else { low = a }
            }
            if distance(high) > radius {
                return f64::INFINITY;
            }
            let mut low = 0.0;
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if distance(middle) <= radius { high = middle } else { low = middle }
            }
            high
        };
        let of_triangle = |(corners, _): &([u32; 3], u32)| {
            first(corners.map(|corner| self.model.vertices[corner as usize].point))
        };
        Some(self.model.triangles.iter().map(of_triangle).fold(f64::INFINITY, f64::min))
            .filter(|d| d.is_finite())
    }

    /// The longest way to a contact.
    fn last(&self) -> f64 {
        self.world_from_model.apply(self.model.vertices[0].point).distance(self.line.start)
            + 2.0 * self.scale()
    }

    /// What is met, compared with a contact that was found otherwise for a radius that is a little smaller or larger.
    pub(super) fn checked(&self, oracle: impl Fn(&Self, f64, f64) -> Option<f64>) -> Found {
        let met = self.model.first_contact(self.world_from_model, &self.line, self.radius);
        if let Some(met) = &met {
            self.check_contact(met);
        }
        let (last, place, slack) = (self.last(), self.place(met.as_ref()), self.slack());
        let depth = met.map_or(f64::INFINITY, |met| met.depth);
        // No sooner than what is nearly touched, no later than what surely is.
        let soonest = oracle(self, self.radius + slack, last).unwrap_or(f64::INFINITY);
        let latest = match self.radius - 2.0 * slack {
            radius if radius > 0.0 => oracle(self, radius, last),
            radius if self.model.closed => self.traced(radius, last),
            _ => self.pierced(),
        };
        let latest = latest.unwrap_or(f64::INFINITY);
        assert!(depth >= soonest - place, "{depth} before {soonest}: {self}");
        assert!(depth <= latest + place, "{depth} after {latest}: {self}");
        match met {
            _ if latest > soonest + place => Found::Grazing,
            Some(_) => Found::Contact,
            None => Found::Nothing,
        }
    }

    fn check_contact(&self, met: &FirstContact<DVec3>) {
        let (model, radius, place) = (self.model, self.radius, self.place(Some(met)));
        let model_from_world = self.world_from_model.inverse();
        let center = model_from_world.apply(self.line.at(met.depth));
        let direction = model_from_world.rotation * self.line.direction;
        let normal = model_from_world.rotation * met.normal;
        assert!((normal.length() - 1.0).abs() < 1e-12 && normal.dot(direction) <= 1e-9, "{self}");
        let off = (model.nearest(center).distance - radius).abs();
        assert!(met.depth >= 0.0 && off < place, "{off} off its place, more than {place}: {self}");
        let foot = center - radius * normal;
        let at = |number: u32| model.vertices[number as usize].point;
        let (off, touchable) = match met.feature {
            Feature::Face(number) => {
                let face = &model.faces[number as usize];
                assert!(face.surface != Surface::Seam);
                let cosine = face.normal.dot(normal);
                assert!((cosine.abs() - 1.0).abs() < 1e-12 && (cosine > 0.0 || !model.closed), "{self}");
                (face.distance(model, foot), cosine > 0.0 && face.is_touchable())
            }
            Feature::Edge(number) => {
                let edge = &model.edges[number as usize];
                let nearest = on_segment(foot, at(edge.ends[0]), at(edge.ends[1]));
                if let Some([left, right]) = edge.normals {
                    let along = (at(edge.ends[1]) - at(edge.ends[0])).normalize_or_zero();
                    let turns = left.cross(normal).dot(along).min(normal.cross(right).dot(along));
                    // The face beside it is then touched, too, to rounding.
                    assert!(turns.min(0.0).powi(2) * radius < 1e-12 * self.scale(), "{turns}: {self}");
                }
                (foot.distance(nearest), edge.normals.is_some())
            }
            Feature::Vertex(number) => {
                let vertex = &model.vertices[number as usize];
                (foot.distance(vertex.point), vertex.normals.is_some())
            }
        };
        assert!(off < place, "{off} off {:?}: {self}", met.feature);
        assert_eq!(met.touchable, touchable, "{self}");
        // A point touches faces only.
        assert!(radius > 0.0 || matches!(met.feature, Feature::Face(_)), "{self}");
    }
}

impl Display for Case<'_> {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        let met = self.model.first_contact(self.world_from_model, &self.line, self.radius);
        let Line { start, direction } = self.line;
        let corners: Vec<DVec3> = self.model.vertices.iter().map(|vertex| vertex.point).collect();
        write!(
            out,
            "radius {:e} from {start:?} along {direction:?}, {met:?}, pose {:?}, part of size {}: {:?} {corners:?} {:?}",
            self.radius,
            self.world_from_model,
            self.model.size,
            self.model.faces.len(),
            self.model.triangles
        )
    }
}

/// Loose faces: some of the sides of some boxes, a few of them seams or untouchable, and one that has a hole.
fn loose(random: &mut Random) -> Model {
    let mut loops: Vec<Vec<Vec<DVec3>>> = Vec::new();
    for _ in 0..3 {
        let low = random.point(-40.0, 30.0);
        let (points, triangles) = cuboid(low, low + random.point(5.0, 30.0));
        for pair in triangles.chunks(2).filter(|_| random.next() < 0.6) {
            let [[a, b, c], [_, _, d]] = [pair[0], pair[1]];
            loops.push(vec![[a, b, c, d].map(|k| points[k as usize]).to_vec()]);
        }
    }
    let ring = |radius: f64, turn: f64| -> Vec<DVec3> {
        regular(7, radius).iter().map(|p| dvec3(p.x, turn * p.y, 70.0)).collect()
    };
    loops.push(vec![ring(25.0, 1.0), ring(11.0, -1.0)]);
    let number = |random: &mut Random| random.below(loops.len() as u32 - 1) as usize;
    let (seam, untouchable) = (number(random), number(random));
    let seams = if seam == untouchable { vec![] } else { vec![seam] };
    Model::facets("loose", &loops, &seams, &[untouchable], 0.0, 0.0).expect("loose faces")
}

/// Convex and not, with holes and cavities, touching themselves along edges, loose, with untouchable faces.
pub(super) fn parts(random: &mut Random) -> Vec<Model> {
    let bore: Vec<DVec2> = regular(9, 6.0).into_iter().rev().collect();
    let star: Vec<DVec2> = (0..14)
        .map(|k| {
            dvec2(if k % 2 == 0 { 40.0 } else { 18.0 }, 0.0)
                .rotate(DVec2::from_angle(TAU * f64::from(k) / 14.0))
        })
        .collect();
    let hollow = both(
        &cuboid(DVec3::splat(-20.0), DVec3::splat(20.0)),
        &mirrored(&cuboid(DVec3::splat(-9.0), dvec3(9.0, 15.0, 12.0))),
    );
    let mut models =
        vec![mesh(&tetrahedron()), mesh(&hollow), mesh(&extruded(&[star.clone(), bore.clone()], 25.0))];
    let (points, triangles) = extruded(&[star, bore], 12.0);
    let some: Vec<usize> = (0..triangles.len()).filter(|_| random.next() < 0.2).collect();
    models.push(Model::mesh("blind", &points, &triangles, &some, 0.0, 0.0).expect("a mesh"));
    models.extend((0..4).map(|k| mesh(&hull(random, 6 + 3 * k))));
    models.extend((0..6).map(|k| mesh(&Cells::random(random, 2 + k % 3, 0.5).shape())));
    models.extend((0..6).map(|_| loose(random)));
    models
}

/// A part of another size, and somewhere else.
pub(super) fn changed(model: &Model, factor: f64, shift: DVec3) -> Model {
    let loops: Vec<Vec<Vec<DVec3>>> = model
        .faces
        .iter()
        .map(|face| {
            let at = |k: &u32| factor * model.vertices[*k as usize].point + shift;
            face.loops.iter().map(|outline| outline.iter().map(at).collect()).collect()
        })
        .collect();
    let of = |surface: Surface| -> Vec<usize> {
        (0..model.faces.len()).filter(|k| model.faces[*k].surface == surface).collect()
    };
    Model::facets("part", &loops, &of(Surface::Seam), &of(Surface::Untouchable), 0.0, 0.0)
        .expect("the same part")
}

/// A point of the surface, at times on an edge or a vertex, and a face there.
pub(super) fn aim(random: &mut Random, model: &Model) -> (DVec3, u32) {
    let ([a, b, c], face) = model.triangles[random.below(model.triangles.len() as u32) as usize];
    let [a, b, c] = [a, b, c].map(|k| model.vertices[k as usize].point);
    let (u, v) = (random.next(), random.next());
    let point = match random.below(5) {
        0 => a,
        1 => a + u * (b - a),
        _ => a + (u + v).min(2.0 - u - v) * (u / (u + v) * (b - a) + v / (u + v) * (c - a)),
    };
    (point, face)
}

/// The middle of a part's box.
pub(super) fn middle(model: &Model) -> DVec3 {
    let (low, high) = model.bvh().around();
    0.5 * (low + high)
}

/// A place outside of the part that is clear of it, in its box or around it.
pub(super) fn clear(random: &mut Random, model: &Model, radius: f64) -> DVec3 {
    loop {
        let reach = [0.5, 1.0, 3.0, 30.0][random.below(4) as usize] * (model.size + radius);
        let place = middle(model) + reach * random.next() * random.direction();
        if model.signed_distance(place) > radius + 1e-6 * (model.size + radius) {
            return place;
        }
    }
}

pub(super) fn radius(random: &mut Random, model: &Model) -> f64 {
    [0.0, 1e-4, 0.02, 0.1, 0.5, 4.0][random.below(6) as usize] * model.size * (0.5 + random.next())
}

/// A direction along a face's plane.
pub(super) fn along_face(random: &mut Random, model: &Model, face: u32) -> DVec3 {
    let normal = model.faces[face as usize].normal;
    random.direction().reject_from_normalized(normal).normalize_or_zero()
}

#[derive(Debug, Default)]
pub(super) struct Tally {
    pub(super) contacts: usize,
    pub(super) nothing: usize,
    pub(super) grazing: usize,
    pub(super) kinds: BTreeMap<(&'static str, bool), usize>,
}

impl Tally {
    pub(super) fn add(&mut self, case: &Case, found: Found) {
        match found {
            Found::Contact => self.contacts += 1,
            Found::Nothing => self.nothing += 1,
            Found::Grazing => self.grazing += 1,
        }
        if let Some(met) = case.model.first_contact(case.world_from_model, &case.line, case.radius) {
            *self.kinds.entry((met.feature.kind(), met.touchable)).or_default() += 1;
        }
    }
}
