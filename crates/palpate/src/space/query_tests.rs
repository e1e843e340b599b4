//! Laws of distances, sides, hits, loose faces, symmetries and roundness.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3, dvec2, dvec3};

use super::Roundness;
use super::shapes::{
    Cells, Random, Shape, both, cuboid, extruded, hull, mesh, mirrored, moved, regular, tetrahedron,
};
use super::{Model, Pose};
use crate::part::Surface;

/// The distance to a triangle by its regions (Ericson 2005, 5.1.5), another way than the model's.
pub(super) fn triangle_distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return ap.length();
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return bp.length();
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (ap - d1 / (d1 - d3) * ab).length();
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return cp.length();
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (ap - d2 / (d2 - d6) * ac).length();
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return (bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).length();
    }
    let total = va + vb + vc;
    (ap - vb / total * ab - vc / total * ac).length()
}

fn corners(model: &Model, triangle: [u32; 3]) -> [DVec3; 3] {
    triangle.map(|k| model.vertices[k as usize].point)
}

fn some_models(random: &mut Random) -> Vec<Model> {
    let mut models = Vec::new();
    for k in 0..40 {
        let shape = if k % 2 == 0 { hull(random, 8 + k) } else { Cells::random(random, 3, 0.5).shape() };
        models.push(mesh(&moved(&shape, random.pose())));
    }
    models
}

#[test]
fn the_nearest_point_is_on_the_surface_and_nothing_is_nearer() {
    let mut random = Random(11);
    for model in some_models(&mut random) {
        for _ in 0..100 {
            let point = model.vertices[0].point + random.point(-100.0, 100.0);
            let nearest = model.nearest(point);
            let oracle = model.triangles.iter().map(|(t, _)| triangle_distance(point, corners(&model, *t)));
            let tol = 1e-12 * 300.0;
            assert!((nearest.distance - oracle.fold(f64::INFINITY, f64::min)).abs() < tol);
            assert!((nearest.point.distance(point) - nearest.distance).abs() < tol);
            let faces: Vec<f64> = model.faces.iter().map(|face| face.distance(&model, point)).collect();
            assert!((faces[nearest.face as usize] - nearest.distance).abs() < tol);
            let least = faces.iter().copied().fold(f64::INFINITY, f64::min);
            assert!((least - nearest.distance).abs() < tol);
            let reach = random.within(0.0, 80.0);
            let (mut found, expected) = (vec![7], (0..).zip(&faces).filter(|(_, d)| **d <= reach));
            model.faces_within(point, reach, &mut found);
            assert_eq!(found[1..], expected.map(|(k, _)| k).collect::<Vec<u32>>());
            for (face, distance) in model.faces.iter().zip(&faces) {
                let height = (face.normal.dot(point) - face.offset).abs();
                assert_eq!(
                    face.is_before(&model, point),
                    (height - distance).abs() < tol,
                    "{height} {distance}"
                );
            }
        }
    }
}

#[test]
fn slivers_have_exact_distances() {
    let mut random = Random(12);
    for _ in 0..2000 {
        let thin = 10_f64.powf(random.within(-8.5, 0.0));
        let corners = [DVec3::ZERO, DVec3::X, dvec3(random.next(), thin, 0.0)];
        let pose = Pose::new(TAU * random.direction(), random.point(-0.5, 0.5));
        let point = dvec3(random.within(-0.5, 1.5), random.within(-1.0, 1.0), random.within(-0.5, 0.5));
        let (distance, _) = super::distance::to_triangle(pose.apply(point), &corners.map(|c| pose.apply(c)));
        // In the triangle's own frame its plane is that of x and y.
        let flat = point.truncate();
        let [a, b, c] = corners.map(DVec3::truncate);
        let side = |a: DVec2, b: DVec2| {
            let place = ((flat - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            (a + place * (b - a)).distance(flat)
        };
        let left = |a: DVec2, b: DVec2| (b - a).perp_dot(flat - a) >= 0.0;
        let inside = left(a, b) && left(b, c) && left(c, a);
        let beside = if inside { 0.0 } else { side(a, b).min(side(b, c)).min(side(c, a)) };
        assert!((distance - beside.hypot(point.z)).abs() < 1e-14, "{thin:e}");
    }
}

#[test]
fn segments_are_as_far_as_their_densest_points() {
    let mut random = Random(13);
    let (mut crossing, mut apart) = (0, 0);
    for model in some_models(&mut random) {
        for _ in 0..30 {
            let origin = model.nearest(model.vertices[0].point + random.point(-60.0, 60.0)).point;
            let ends = [0; 2].map(|_| origin + random.point(-40.0, 40.0));
            let found = model.segment_distance(ends[0], ends[1]);
            let step = ends[0].distance(ends[1]) / 400.0;
            let at = |k: i32| model.signed_distance(ends[0].lerp(ends[1], f64::from(k) / 400.0));
            let sampled: Vec<f64> = (0..=400).map(at).collect();
            let least = sampled.iter().map(|d| d.abs()).fold(f64::INFINITY, f64::min);
            assert!(found <= least + 1e-10 && found >= least - 0.5 * step - 1e-10, "{found} {least}");
            let crosses = sampled.iter().any(|d| *d > 0.0) && sampled.iter().any(|d| *d < 0.0);
            if crosses {
                assert_eq!(found, 0.0);
            }
            crossing += usize::from(crosses);
            apart += usize::from(found > 0.0);

            let along = ends[1] - ends[0];
            let hit = model.first_hit(ends[0], along);
            let oracle = model.triangles.iter().filter_map(|(t, _)| ray(ends[0], along, corners(&model, *t)));
            let oracle = oracle.fold(f64::INFINITY, f64::min);
            match hit {
                Some(hit) => {
                    assert!((hit.distance - oracle).abs() < 1e-7, "{} {oracle}", hit.distance);
                    assert!(model.nearest(hit.point).distance < 1e-9);
                    assert!(model.faces[hit.face as usize].distance(&model, hit.point) < 1e-9);
                    assert_eq!(found == 0.0, hit.distance <= along.length());
                }
                None => assert_eq!(oracle, f64::INFINITY),
            }
        }
    }
    assert!(crossing > 200 && apart > 200, "{crossing} {apart}");
}

/// Where a ray meets a triangle, by its plane and three signs.
fn ray(origin: DVec3, along: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let normal = (b - a).cross(c - a);
    let place = normal.dot(a - origin) / normal.dot(along);
    let point = origin + place * along;
    let left = |a: DVec3, b: DVec3| (b - a).cross(point - a).dot(normal) >= 0.0;
    (place >= 0.0 && left(a, b) && left(b, c) && left(c, a)).then(|| place * along.length())
}

#[test]
fn rays_do_not_slip_through_edges() {
    let model = mesh(&cuboid(DVec3::splat(-1.0), DVec3::ONE));
    for target in [dvec3(1.0, 1.0, 0.3), DVec3::ONE, dvec3(0.0, 0.0, 1.0), dvec3(0.2, 0.2, 1.0)] {
        let hit = model.first_hit(3.0 * target, -target).expect("is met");
        assert!((hit.distance - 2.0 * target.length()).abs() < 1e-14, "{}", hit.distance);
        assert_eq!(model.first_hit(3.0 * target, target), None);
    }
    assert_eq!(model.segment_distance(dvec3(2.0, -2.0, 2.0), dvec3(2.0, 2.0, 2.0)), 2_f64.sqrt());
}

/// The order of a model's group, with all that must hold of it.
fn order(shape: &Shape, random: &mut Random) -> usize {
    let model = mesh(&moved(shape, random.pose()));
    assert_eq!(model.symmetries[0].motion, Pose::IDENTITY);
    for symmetry in &model.symmetries {
        for (k, vertex) in model.vertices.iter().enumerate() {
            let image = &model.vertices[symmetry.vertices[k] as usize];
            let miss = symmetry.motion.apply(vertex.point).distance(image.point);
            assert!(miss <= model.asymmetry.0.max(1e-30) && miss < 1e-9 * model.size);
            assert_eq!(vertex.normals.is_some(), image.normals.is_some());
        }
        for (k, face) in model.faces.iter().enumerate() {
            let image = &model.faces[symmetry.faces[k] as usize];
            assert!((symmetry.motion.rotation * face.normal).distance(image.normal) < 1e-9);
            assert!(face.loops.len() == image.loops.len());
        }
        for (k, edge) in model.edges.iter().enumerate() {
            let image = &model.edges[symmetry.edges[k] as usize];
            let mut ends = edge.ends.map(|k| symmetry.vertices[k as usize]);
            ends.sort_unstable();
            let mut of_image = image.ends;
            of_image.sort_unstable();
            assert_eq!((ends, edge.normals.is_some()), (of_image, image.normals.is_some()));
        }
    }
    if model.symmetries.len() <= 60 {
        for a in &model.symmetries {
            for b in &model.symmetries {
                let both: Vec<u32> = b.vertices.iter().map(|&k| a.vertices[k as usize]).collect();
                assert_eq!(model.symmetries.iter().filter(|s| s.vertices == both).count(), 1, "a group");
            }
        }
    }
    let distinct: std::collections::BTreeSet<&Vec<u32>> =
        model.symmetries.iter().map(|s| &s.vertices).collect();
    assert_eq!(distinct.len(), model.symmetries.len());
    model.symmetries.len()
}

fn unit_cells(rows: &[&[&str]]) -> Shape {
    let n = rows.len();
    let is_full = (0..n * n * n).map(|k| rows[k / n / n][k / n % n].as_bytes()[k % n] == b'#').collect();
    let planes: Vec<f64> = (0..=n).map(|k| 10.0 * k as f64).collect();
    Cells { planes: [planes.clone(), planes.clone(), planes], is_full }.shape()
}

#[test]
fn groups_known_by_eye() {
    let mut random = Random(14);
    let cube = cuboid(DVec3::splat(-9.0), DVec3::splat(9.0));
    assert_eq!(order(&cube, &mut random), 24);
    assert_eq!(order(&tetrahedron(), &mut random), 12);
    assert_eq!(order(&cuboid(DVec3::ZERO, dvec3(1.0, 2.0, 3.0)), &mut random), 4);
    for n in [3, 5, 6, 7, 50, 200, 500] {
        assert_eq!(order(&extruded(&[regular(n, 20.0)], 17.0), &mut random), 2 * n);
    }
    assert_eq!(order(&extruded(&[regular(4, 20.0)], 17.0), &mut random), 8);
    assert_eq!(order(&extruded(&[regular(600, 20.0)], 17.0), &mut random), 600, "a subgroup");
    // A cavity that is not in the middle, a hole that is.
    let hollow = both(&cube, &mirrored(&cuboid(DVec3::splat(1.0), DVec3::splat(2.0))));
    assert_eq!(order(&hollow, &mut random), 3);
    let hole: Vec<DVec2> = regular(4, 3.0).into_iter().rev().collect();
    let square = regular(4, 20.0);
    assert_eq!(order(&extruded(&[square.clone(), hole], 17.0), &mut random), 8);
    let off: Vec<DVec2> = regular(4, 3.0).into_iter().rev().map(|p| p + dvec2(5.0, 0.0)).collect();
    assert_eq!(order(&extruded(&[square, off], 17.0), &mut random), 2);
    // Pieces of four cells that have mirror images, but no symmetry, or one half turn.
    let tripod = unit_cells(&[&["##", "#."], &["#.", ".."]]);
    assert_eq!(order(&tripod, &mut random), 3);
    let screw = unit_cells(&[&["##", ".#"], &["..", ".#"]]);
    assert_eq!(order(&screw, &mut random), 2);
    assert_eq!(order(&hull(&mut random, 20), &mut random), 1);
    let (vertices, triangles) = cube;
    let blind = Model::mesh("part", &vertices, &triangles, &[0, 1], 0.0, 0.0).expect("clean");
    assert_eq!(blind.symmetries.len(), 4, "surface kinds are kept");
}

fn quads(low: DVec3, high: DVec3) -> Vec<Vec<Vec<DVec3>>> {
    let (points, triangles) = cuboid(low, high);
    let quad = |pair: &[[u32; 3]]| {
        let [[a, b, c], [_, _, d]] = [pair[0], pair[1]];
        vec![[a, b, c, d].map(|k| points[k as usize]).to_vec()]
    };
    triangles.chunks(2).map(quad).collect()
}

fn facets(loops: &[Vec<Vec<DVec3>>], seams: &[usize], untouchable: &[usize]) -> Result<Model, crate::Error> {
    Model::facets("part", loops, seams, untouchable, 0.0, 0.0)
}

#[test]
fn loose_faces_make_boxes_open_and_closed() {
    let (low, high) = (DVec3::ZERO, dvec3(4.0, 5.0, 6.0));
    let closed = facets(&quads(low, high), &[], &[]).expect("clean");
    let as_mesh = mesh(&cuboid(low, high));
    assert_eq!((&closed.edges, &closed.vertices), (&as_mesh.edges, &as_mesh.vertices));
    assert!(closed.closed && closed.symmetries.len() == 4);
    let open = facets(&quads(low, high)[1..], &[], &[]).expect("clean");
    assert!(!open.closed && open.edges.len() == 12);
    assert_eq!(open.edges.iter().filter(|edge| edge.normals.is_none()).count(), 4);
    assert_eq!(open.vertices.iter().filter(|vertex| vertex.normals.is_none()).count(), 4);
    let lid = facets(&quads(low, high), &[0], &[]).expect("clean");
    assert!(!lid.closed && lid.faces[0].surface == Surface::Seam);
    assert!(lid.triangles.iter().all(|(_, face)| *face != 0), "a seam is not there");
    assert_eq!(lid.edges.len(), 12);
    assert_eq!(lid.edges.iter().filter(|edge| edge.normals.is_none()).count(), 4);
    assert!(lid.edges.iter().filter(|edge| edge.normals.is_none()).all(|edge| edge.faces.contains(&Some(0))));
    assert_eq!(lid.symmetries.len(), 2);
    let blind = facets(&quads(low, high), &[], &[5]).expect("clean");
    assert!(blind.closed && blind.edges.iter().filter(|edge| edge.normals.is_none()).count() == 4);
    // A seam through the box is not where the part ends.
    let mut halves = quads(low, high);
    let middle = [(0.0, 0.0), (0.0, 6.0), (5.0, 6.0), (5.0, 0.0)].map(|(y, z)| dvec3(2.0, y, z));
    halves.push(vec![middle.to_vec()]);
    let halves = facets(&halves, &[6], &[]).expect("clean");
    assert!(halves.closed && halves.vertices.iter().filter(|vertex| vertex.normals.is_some()).count() == 8);
    assert_eq!(halves.edges.iter().filter(|edge| edge.normals.is_some()).count(), 12 + 4);
}

#[test]
fn loose_faces_with_holes_and_divided_sides() {
    let mut random = Random(15);
    let pose = random.pose();
    let place = |loops: Vec<Vec<DVec2>>| -> Vec<Vec<DVec3>> {
        loops.iter().map(|k| k.iter().map(|p| pose.apply(p.extend(0.0))).collect()).collect()
    };
    let square =
        |low: f64, high: f64| vec![dvec2(low, low), dvec2(high, low), dvec2(high, high), dvec2(low, high)];
    let plate = facets(&[place(vec![square(0.0, 9.0), square(2.0, 4.0), square(5.0, 8.0)])], &[], &[])
        .expect("clean");
    assert_eq!((plate.faces[0].loops.len(), plate.edges.len(), plate.closed), (3, 12, false));
    assert!(plate.mends.iter().any(|mend| mend.0.starts_with("loops[0], holes[0]")), "{:?}", plate.mends);
    for (x, y, distance) in
        [(1.0, 1.0, 0.0), (3.0, 3.0, 1.0), (6.5, 6.5, 1.5), (-3.0, -4.0, 5.0), (3.0, 2.5, 0.5)]
    {
        let point = pose.apply(dvec3(x, y, 0.0));
        assert!((plate.faces[0].distance(&plate, point) - distance).abs() < 1e-12, "{x} {y}");
    }
    // Two plates share half of a side.
    let beside = vec![dvec2(9.0, 0.0), dvec2(12.0, 0.0), dvec2(12.0, 4.0), dvec2(9.0, 4.0)];
    let two = facets(&[place(vec![square(0.0, 9.0)]), place(vec![beside])], &[], &[]).expect("clean");
    assert_eq!(two.edges.len(), 4 + 4);
    assert_eq!(two.edges.iter().filter(|edge| edge.faces[1].is_some()).count(), 1);

    let mut bent = place(vec![square(0.0, 9.0)]);
    bent[0][2] += pose.rotation * dvec3(0.0, 0.0, 0.01);
    let refused = facets(&[bent], &[], &[]).expect_err("not planar").to_string();
    assert!(refused.contains("not planar") && refused.contains("e-3"), "{refused}");
    let crossing = place(vec![square(0.0, 9.0), square(7.0, 12.0)]);
    let refused = facets(&[crossing], &[], &[]).expect_err("crossing").to_string();
    assert!(refused.starts_with("loops[0], holes[0]"), "{refused}");
    let inward: Vec<_> = quads(DVec3::ZERO, DVec3::ONE)
        .into_iter()
        .map(|mut k| {
            k[0].reverse();
            k
        })
        .collect();
    assert!(facets(&inward, &[], &[]).expect_err("inward").to_string().contains("inside"));
    assert!(facets(&quads(DVec3::ZERO, DVec3::ONE), &[0, 1, 2, 3, 4, 5], &[]).is_err());
    assert!(facets(&[], &[], &[]).is_err());
    assert!(facets(&[vec![vec![DVec3::ZERO, DVec3::X]]], &[], &[]).is_err());
}

/// A body of revolution of a profile of radii and heights, with so many sides.
fn turned(profile: &[(f64, f64)], sides: usize) -> Shape {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    let n = sides as u32;
    for &(radius, height) in profile {
        points.extend(regular(sides, radius).iter().map(|point| point.extend(height)));
    }
    for ring in 0..profile.len() as u32 {
        let above = (ring + 1) % profile.len() as u32;
        for k in 0..n {
            let [a, b] = [ring * n + k, ring * n + (k + 1) % n];
            let [c, d] = [above * n + k, above * n + (k + 1) % n];
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    (points, triangles)
}

fn round(shape: &Shape, position_slack: f64, normal_slack: f64, pose: Pose) -> Option<Roundness> {
    let (points, triangles) = moved(shape, pose);
    Model::mesh("part", &points, &triangles, &[], position_slack, normal_slack).expect("clean").roundness
}

#[test]
fn parts_are_round_within_their_slacks_only() {
    let mut random = Random(16);
    for sides in [12, 30, 47] {
        let half = PI / sides as f64;
        let sagitta = |radius: f64| radius * (1.0 - half.cos());
        // A bush with a cone, a bore and a groove.
        let profile = [
            (5.0, 0.0),
            (20.0, 0.0),
            (20.0, 8.0),
            (14.0, 8.0),
            (14.0, 11.0),
            (18.0, 15.0),
            (9.0, 22.0),
            (5.0, 22.0),
        ];
        let pose = random.pose();
        let shapes = [(turned(&profile, sides), 20.0), (extruded(&[regular(sides, 7.0)], 3.0), 7.0)];
        for (shape, radius) in shapes {
            let found = round(&shape, sagitta(radius), half, pose).expect("is round");
            let Roundness::Axis { point, direction } = found else { panic!("{found:?}") };
            let axis = pose.rotation * DVec3::Z;
            assert!(direction.cross(axis).length() < 1e-9);
            assert!((point - pose.translation).reject_from_normalized(axis).length() < 1e-9);
            assert_eq!(round(&shape, 0.99 * sagitta(radius), half, pose), None);
            assert_eq!(round(&shape, sagitta(radius), 0.99 * half, pose), None);
            assert_eq!(round(&shape, 0.0, 0.0, pose), None);
            // A keyway, or one side that is a little off, is not round.
            let mut dented = shape.clone();
            for k in [0, 1] {
                dented.0[k] *= 1.001;
            }
            assert_eq!(round(&dented, sagitta(radius), half, pose), None);
        }
    }
    let cube = cuboid(-DVec3::ONE, DVec3::ONE);
    assert_eq!(round(&cube, 0.1, 0.1, random.pose()), None);
    assert!(matches!(round(&cube, 3_f64.sqrt() - 1.0, 1.0, random.pose()), Some(Roundness::Ball { .. })));
    // A hull of points on a sphere is round as far as its faces are from it.
    let sphere: Vec<DVec3> = (0..60).map(|_| 10.0 * random.direction()).collect();
    let shape = super::shapes::hull_of(sphere);
    let lowest = shape.1.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|k| shape.0[k as usize]);
        (b - a).cross(c - a).normalize().dot(a)
    });
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    let (slack, turn) = (10.0 - lowest, (lowest / 10.0).acos());
    let pose = random.pose();
    let found = round(&shape, 1.0001 * slack, 1.0001 * turn, pose);
    assert!(
        matches!(found, Some(Roundness::Ball { center }) if center.distance(pose.translation) < 1e-9),
        "{found:?}"
    );
    assert_eq!(round(&shape, 0.999 * slack, turn, pose), None);
    assert_eq!(round(&shape, slack, 0.999 * turn, pose), None);
}
