//! Laws of solid models: faces, edges, corners, mending, refusals.

use std::f64::consts::TAU;

use glam::{DMat3, DVec2, DVec3, dvec2, dvec3};

use super::super::edges::edges;
use super::super::shapes::{
    Cells, Random, Shape, both, cuboid, extruded, hull, hull_of, mesh, mirrored, moved, regular, tetrahedron,
};
use super::{Model, Surface, volume};

fn counts(model: &Model) -> [usize; 3] {
    [model.faces.len(), model.edges.len(), model.vertices.len()]
}

fn refusal(vertices: &[DVec3], triangles: &[[u32; 3]]) -> String {
    Model::mesh("part", vertices, triangles, &[], 0.0, 0.0).expect_err("must be refused").to_string()
}

fn area(points: &[DVec3]) -> f64 {
    let sides = points.iter().zip(points.iter().cycle().skip(1));
    let sum: DVec3 = sides.map(|(a, b)| (*a - points[0]).cross(*b - points[0])).sum();
    0.5 * sum.length()
}

fn l_bracket() -> Shape {
    let outline = [(0., 0.), (40., 0.), (40., 10.), (10., 10.), (10., 50.), (0., 50.)];
    let hole: Vec<DVec2> = regular(6, 3.0).iter().rev().map(|p| *p + dvec2(25.0, 5.0)).collect();
    extruded(&[outline.iter().map(|&(x, y)| dvec2(x, y)).collect(), hole], 15.0)
}

/// What must hold of every closed model.
fn check(model: &Model, what: &str) {
    assert!(model.closed, "{what}: not closed, {:?}", model.mends);
    let at = |k: &u32| model.vertices[*k as usize].point;
    let tol = 1e-9 * model.size;
    for (number, face) in (0..).zip(&model.faces) {
        let outline = |outline: &Vec<u32>| outline.iter().map(at).collect::<Vec<_>>();
        for corner in face.loops.iter().flatten().map(at) {
            assert!((face.normal.dot(corner) - face.offset).abs() < tol, "{what}: corner off its face");
        }
        let of_loops: f64 = face.loops[0..1].iter().map(|k| area(&outline(k))).sum::<f64>()
            - face.loops[1..].iter().map(|k| area(&outline(k))).sum::<f64>();
        let of_pieces: f64 = face.pieces.iter().map(|k| area(&outline(k))).sum();
        let mine = model.triangles.iter().filter(|(_, face)| *face == number);
        let of_triangles: f64 = mine.map(|(triangle, _)| area(&triangle.map(|k| at(&k)))).sum();
        assert!((of_loops - of_pieces).abs() < tol * model.size, "{what}: {of_loops} {of_pieces}");
        assert!((of_loops - of_triangles).abs() < tol * model.size);
        for piece in &face.pieces {
            let n = piece.len();
            for k in 0..n {
                let [a, b, c] = [0, 1, 2].map(|j| at(&piece[(k + j) % n]));
                assert!(
                    (b - a).cross(c - b).dot(face.normal) > -tol * model.size,
                    "{what}: piece not convex"
                );
            }
        }
    }
    for edge in &model.edges {
        let [left, right] = edge.faces.map(|face| &model.faces[face.expect("closed") as usize]);
        let [a, b] = edge.ends.map(|k| at(&k));
        let runs = |face: &super::Face, from: u32, to: u32| {
            face.loops.iter().any(|outline| {
                outline.iter().zip(outline.iter().cycle().skip(1)).any(|(&a, &b)| (a, b) == (from, to))
            })
        };
        assert!(runs(left, edge.ends[0], edge.ends[1]) && runs(right, edge.ends[1], edge.ends[0]), "{what}");
        // A little outward from the edge's middle along the normals' middle is void, and inward material.
        if let Some([first, second]) = edge.normals {
            assert_eq!([first, second], [left.normal, right.normal]);
            let out = (first + second).normalize();
            let (middle, step) = (0.5 * (a + b), 1e-4 * model.size);
            let distance = model.signed_distance(middle + step * out);
            assert!((distance - step).abs() < 1e-6 * step, "{what}: {distance} {step}");
            assert!(first.cross(second).dot(b - a) > 0.0, "{what}");
        }
    }
}

/// A normal is in a vertex's cone iff a small ball that rests there along it does not reach into the part.
fn check_cones(model: &Model, random: &mut Random, per_vertex: usize, what: &str) -> [usize; 2] {
    let mut seen = [0; 2];
    let radius = 1e-3 * model.size;
    for vertex in &model.vertices {
        for _ in 0..per_vertex {
            // Half of them from the cone.
            let normal = match &vertex.normals {
                Some(corners) if random.next() < 0.5 => {
                    corners.iter().map(|corner| random.next() * *corner).sum::<DVec3>().normalize()
                }
                _ => random.direction(),
            };
            let distance = model.signed_distance(vertex.point + radius * normal);
            let depth = radius - distance;
            let inside = vertex.normals.as_ref().is_some_and(|corners| {
                let next = corners.iter().cycle().skip(1);
                corners.iter().zip(next).all(|(a, b)| a.cross(*b).dot(normal) >= 0.0)
            });
            // So close to the cone's rim neither says anything.
            if depth > 1e-9 * radius && depth < 1e-4 * radius {
                continue;
            }
            assert_eq!(inside, depth <= 1e-9 * radius, "{what}: {vertex:?} {normal} {depth:e}");
            seen[usize::from(inside)] += 1;
        }
    }
    seen
}

#[test]
fn a_cube_is_known_by_heart() {
    let model = mesh(&cuboid(DVec3::ZERO, DVec3::splat(2.0)));
    assert!(model.mends.is_empty(), "{:?}", model.mends);
    assert_eq!(counts(&model), [6, 12, 8]);
    assert!(model.edges.iter().all(|edge| edge.normals.is_some()));
    for vertex in &model.vertices {
        let normals = vertex.normals.as_ref().expect("convex");
        assert_eq!(normals.len(), 3);
        assert!(normals[0].cross(normals[1]).dot(normals[2]) > 0.9, "counter-clockwise from outside");
    }
    assert_eq!((model.size, model.position_slack, model.normal_slack), (12_f64.sqrt(), 0.0, 0.0));
    assert_eq!(model.signed_distance(dvec3(1.0, 1.0, 0.75)), -0.75);
    assert_eq!(model.signed_distance(dvec3(1.0, 1.0, 3.0)), 1.0);
    assert_eq!(model.nearest(dvec3(3.0, 3.0, 1.0)).distance, 2_f64.sqrt());
}

#[test]
fn shapes_known_by_eye() {
    let mut random = Random(1);
    for _ in 0..5 {
        let pose = random.pose();
        let bracket = mesh(&moved(&l_bracket(), pose));
        assert_eq!(counts(&bracket), [14, 36, 24]);
        check(&bracket, "bracket");
        let touchable = bracket.vertices.iter().filter(|vertex| vertex.normals.is_some()).count();
        // Ten corners of the outline are convex; of a hole's rim none has a hull with an inside that is void.
        assert_eq!(touchable, 10);
        let convex = bracket.edges.iter().filter(|edge| edge.normals.is_some()).count();
        assert_eq!(convex, 5 + 12 + 12);

        let (low, high) = (DVec3::splat(-5.0), DVec3::splat(5.0));
        let pocket = Cells {
            planes: [vec![-5.0, -2.0, 2.0, 5.0], vec![-5.0, -2.0, 2.0, 5.0], vec![-5.0, -2.0, 2.0, 5.0]],
            is_full: (0..27).map(|k| k != 22).collect(),
        };
        let with_pocket = mesh(&moved(&pocket.shape(), pose));
        assert_eq!(counts(&with_pocket), [11, 24, 16]);
        check(&with_pocket, "pocket");
        let outside = with_pocket.vertices.iter().filter(|vertex| vertex.normals.is_some()).count();
        assert_eq!(outside, 8);

        let cavity = both(&cuboid(low, high), &cuboid(0.3 * low, 0.3 * high));
        let cavity = mesh(&moved(&cavity, pose));
        assert_eq!(counts(&cavity), [12, 24, 16]);
        check(&cavity, "cavity");
        let said = cavity.mends.iter().map(|mend| ["inside out", "sealed"].map(|word| mend.0.contains(word)));
        assert_eq!(said.collect::<Vec<_>>(), [[true, false], [false, true]], "{:?}", cavity.mends);
        assert!((cavity.signed_distance(pose.apply(DVec3::ZERO)) - 1.5).abs() < 1e-12 * 100.0);
        assert!(cavity.signed_distance(pose.apply(dvec3(3.0, 0.0, 0.0))) < -1.4);
    }
    for n in [3, 5, 8, 200] {
        let prism = mesh(&extruded(&[regular(n, 20.0)], 30.0));
        assert_eq!(counts(&prism), [n + 2, 3 * n, 2 * n]);
        check(&prism, "prism");
        assert_eq!(
            prism.faces.iter().map(|face| face.pieces.len()).max(),
            Some(1),
            "convex faces are one piece"
        );
    }
}

#[test]
fn hulls_are_convex_everywhere() {
    let mut random = Random(2);
    let mut seen = [0; 2];
    for k in 0..150 {
        let shape = hull(&mut random, 5 + k % 16);
        let model = mesh(&moved(&shape, random.pose()));
        check(&model, "hull");
        assert!(model.edges.iter().all(|edge| edge.normals.is_some()));
        assert!(model.vertices.iter().all(|vertex| vertex.normals.is_some()));
        let [out, inside] = check_cones(&model, &mut random, 10, "hull");
        seen = [seen[0] + out, seen[1] + inside];
    }
    assert!(seen[0] > 3000 && seen[1] > 3000, "{seen:?}");
}

/// Whether a normal is one of a place of the model that is no farther from a point, each to within a bound.
fn has_place(model: &Model, normal: DVec3, point: DVec3, far: f64, turn: f64) -> bool {
    let near = |a: DVec3, b: DVec3| {
        let along = ((point - a).dot(b - a) / a.distance_squared(b).max(1e-300)).clamp(0.0, 1.0);
        point.distance(a.lerp(b, along)) <= far
    };
    let at = |k: u32| model.vertices[k as usize].point;
    let in_cone = |corners: &Vec<DVec3>| {
        let mut next = corners.iter().zip(corners.iter().cycle().skip(1));
        next.all(|(a, b)| a.cross(*b).normalize_or_zero().dot(normal) >= -turn)
    };
    let on_vertex = model
        .vertices
        .iter()
        .any(|vertex| vertex.point.distance(point) <= far && vertex.normals.as_ref().is_some_and(in_cone));
    let on_edge = model.edges.iter().any(|edge| {
        edge.normals.is_some_and(|[a, b]| {
            let across = a.cross(b).normalize_or_zero();
            let within = across.cross(a).dot(normal) >= -turn && b.cross(across).dot(normal) >= -turn;
            near(at(edge.ends[0]), at(edge.ends[1])) && within && across.dot(normal).abs() <= turn
        })
    });
    let on_face = model.faces.iter().any(|face| {
        face.normal.dot(normal) >= turn.cos() && (face.normal.dot(point) - face.offset).abs() <= far
    });
    on_vertex || on_edge || on_face
}

/// Corners that are as close together as they are known make faces with dents, edges that stand on a face, and corners on
/// the inside of edges. However they lie, the part sticks out somewhere in each direction, and there a tip may rest. What is no
/// larger than the distance at which points are one may tear the surface; then hardly a direction is lost.
#[test]
fn a_corner_beside_slivers_can_be_touched_with_every_normal() {
    let mut random = Random(12);
    let (mut slack, mut lost_where_torn, mut torn) = (0, 0, 0);
    for k in 0..150 {
        let stretch = DMat3::from_diagonal(random.point(10.0, 60.0));
        let mut points: Vec<DVec3> = (0..5 + k % 5).map(|_| stretch * random.direction()).collect();
        for corner in 0..3 {
            let spread = [1e-7, 1e-6, 1e-5][k % 3] * random.within(0.5, 2.0);
            let middle = points[corner];
            points.extend((0..3).map(|_| middle + spread * random.direction()));
        }
        let Ok(model) = Model::mesh("slivers", &points, &hull_of(points.clone()).1, &[], 0.0, 0.0) else {
            continue;
        };
        slack += usize::from(model.position_slack > 0.0);
        for _ in 0..200 {
            let normal = random.direction();
            let out = points.iter().copied().max_by(|a, b| a.dot(normal).total_cmp(&b.dot(normal)));
            let (far, turn) = (1e-4 + model.position_slack, 1e-7 + model.normal_slack);
            let has_place = has_place(&model, normal, out.expect("there are"), far, turn);
            assert!(has_place || !model.closed, "{k}: {normal}");
            torn += usize::from(!model.closed);
            lost_where_torn += usize::from(!has_place);
        }
    }
    assert!(slack > 50 && torn > 1000 && lost_where_torn <= 2, "{slack} {torn} {lost_where_torn}");
}

#[test]
fn unions_of_boxes_keep_their_volume_and_have_the_cones_of_balls() {
    let mut random = Random(3);
    let mut seen = [0; 2];
    for k in 0..300 {
        let cells = Cells::random(&mut random, 2 + k % 5, [0.3, 0.5, 0.8][k % 7 % 3]);
        let shape = cells.shape();
        if shape.1.is_empty() {
            continue;
        }
        let pose = random.pose();
        let model = mesh(&moved(&shape, pose));
        check(&model, &format!("cells {k}"));
        let is_known = |text: &str| text.contains("doubled") || text.contains("sealed");
        assert!(model.mends.iter().all(|mend| is_known(&mend.0)), "{k}: {:?}", model.mends);
        let points: Vec<DVec3> = model.vertices.iter().map(|vertex| vertex.point).collect();
        let found = volume(&points, &model.triangles);
        assert!((found - cells.volume()).abs() < 1e-9 * cells.volume(), "{k}: {found} {}", cells.volume());
        for _ in 0..50 {
            let point = random.point(-40.0, 50.0);
            let distance = model.signed_distance(pose.apply(point));
            assert!((distance < 0.0) == cells.holds(point), "{k}: {point} {distance}");
        }
        let [out, inside] = check_cones(&model, &mut random, 6, &format!("cells {k}"));
        seen = [seen[0] + out, seen[1] + inside];
    }
    assert!(seen[0] > 5000 && seen[1] > 3000, "{seen:?}");
}

#[test]
fn windings_at_random_are_mended() {
    let mut random = Random(6);
    let mut num_turned = 0;
    for k in 0..200 {
        let cells = Cells::random(&mut random, 2 + k % 5, [0.3, 0.5, 0.8][k % 7 % 3]);
        let mut shape = cells.shape();
        if shape.1.is_empty() {
            continue;
        }
        for triangle in &mut shape.1 {
            if random.next() < 0.3 {
                triangle.swap(0, 1);
                num_turned += 1;
            }
        }
        let model = mesh(&moved(&shape, random.pose()));
        check(&model, &format!("turned {k}"));
        let points: Vec<DVec3> = model.vertices.iter().map(|vertex| vertex.point).collect();
        let found = volume(&points, &model.triangles);
        assert!((found - cells.volume()).abs() < 1e-9 * cells.volume(), "{k}: {found} {}", cells.volume());
    }
    assert!(num_turned > 1000);
}

#[test]
fn meshes_are_mended_and_it_is_said() {
    let clean = cuboid(DVec3::ZERO, dvec3(4.0, 5.0, 6.0));
    let reference = mesh(&clean);
    let said = |shape: &Shape, words: &str| {
        let model = mesh(shape);
        assert!(model.mends.iter().any(|mend| mend.0.contains(words)), "{words}: {:?}", model.mends);
        assert_eq!(counts(&model), [6, 12, 8], "{words}");
        check(&model, words);
        assert_eq!((model.position_slack, model.normal_slack), (0.0, 0.0));
        for point in [dvec3(1.0, 2.0, 3.0), dvec3(7.0, 1.0, 2.0)] {
            assert_eq!(model.signed_distance(point), reference.signed_distance(point));
        }
    };
    said(&mirrored(&clean), "inside out");
    let mut one_turned = clean.clone();
    one_turned.1[3].swap(0, 1);
    said(&one_turned, "wound against");
    let mut repeated = clean.clone();
    repeated.1.push(repeated.1[4]);
    said(&repeated, "repeated");
    let soup = clean.1.iter().flatten().map(|&k| clean.0[k as usize]).collect();
    said(&(soup, (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()), "28 doubled");
    let mut needle = clean.clone();
    needle.0.push(clean.0[1] + dvec3(0.0, 0.0, 1e-12));
    needle.1.push([0, 1, 8]);
    said(&needle, "without area");
    // A T-junction: one triangle's side is cut where its neighbour's is not.
    let mut junction = clean.clone();
    let [a, b, c] = junction.1[0];
    junction.0.push(0.25 * clean.0[a as usize] + 0.75 * clean.0[b as usize]);
    junction.1[0] = [a, 8, c];
    junction.1.push([8, b, c]);
    said(&junction, "split");
}

#[test]
fn touching_boxes_lose_the_wall_between_them() {
    let left = cuboid(DVec3::ZERO, DVec3::splat(3.0));
    let right = cuboid(dvec3(3.0, 0.0, 0.0), dvec3(6.0, 3.0, 3.0));
    // The triangles of the common side are the same if they are cut along the same diagonal.
    let mut other = right.clone();
    for triangle in &mut other.1[8..10] {
        *triangle = [0, 0, 0];
    }
    other.1[8] = [0, 4, 2];
    other.1[9] = [4, 6, 2];
    let found: Vec<usize> = [&right, &other].map(|right| mesh(&both(&left, right)).faces.len()).to_vec();
    assert!(found.contains(&6), "{found:?}");

    // Where they touch in an edge only, nothing can rest on it, and both stay closed.
    let diagonal = mesh(&both(&left, &cuboid(dvec3(3.0, 3.0, 0.0), dvec3(6.0, 6.0, 3.0))));
    assert_eq!(counts(&diagonal), [12, 24, 14]);
    check(&diagonal, "diagonal");
    assert_eq!(diagonal.edges.iter().filter(|edge| edge.normals.is_none()).count(), 2);
    assert_eq!(diagonal.vertices.iter().filter(|vertex| vertex.normals.is_none()).count(), 2);
}

#[test]
fn an_edge_of_two_thin_wedges_can_be_touched_from_beyond_both() {
    let wedge = |from: f64, to: f64| {
        let corners = [DVec2::ZERO, 10.0 * DVec2::from_angle(from), 10.0 * DVec2::from_angle(to)];
        extruded(&[corners.to_vec()], 8.0)
    };
    let model = mesh(&both(&wedge(0.0, 0.5), &wedge(0.9, 1.4)));
    check(&model, "wedges");
    let at_origin = |k: u32| model.vertices[k as usize].point.truncate().length() < 1e-12;
    let common: Vec<_> = model.edges.iter().filter(|edge| edge.ends.iter().all(|&k| at_origin(k))).collect();
    assert_eq!(common.len(), 2);
    let [first, second] = common.iter().find_map(|edge| edge.normals).expect("convex from beyond");
    let arc = first.dot(second).acos();
    assert!((arc - (TAU / 2.0 - 1.4)).abs() < 1e-12, "{arc}");
    check_cones(&model, &mut Random(4), 200, "wedges");
}

#[test]
fn untouchable_triangles_are_faces_of_their_own() {
    let (vertices, triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
    let model = Model::mesh("part", &vertices, &triangles, &[0, 1], 0.0, 0.0).expect("clean");
    assert_eq!(counts(&model), [6, 12, 8]);
    assert_eq!(model.faces[0].surface, Surface::Untouchable);
    assert_eq!(model.edges.iter().filter(|edge| edge.normals.is_none()).count(), 4);
    assert_eq!(model.vertices.iter().filter(|vertex| vertex.normals.is_none()).count(), 4);
    let half = Model::mesh("part", &vertices, &triangles, &[0], 0.0, 0.0).expect("clean");
    assert_eq!(counts(&half), [7, 13, 8]);
    let (again, _, closed) = edges(&vertices, &model.faces);
    assert_eq!((again.len(), closed), (12, true));
}

#[test]
fn single_precision_costs_a_slack_but_no_face() {
    let mut random = Random(5);
    for _ in 0..100 {
        let shape = moved(&l_bracket(), random.pose());
        let rounded: Shape = (shape.0.iter().map(|point| point.as_vec3().as_dvec3()).collect(), shape.1);
        let model = mesh(&rounded);
        assert_eq!(counts(&model), [14, 36, 24]);
        assert!(model.closed && model.position_slack > 0.0 && model.position_slack < 2e-5);
        assert!(model.normal_slack > 0.0 && model.normal_slack < 1e-4, "{}", model.normal_slack);
        let corners = rounded.0.iter().map(|point| model.nearest(*point).distance);
        assert!(corners.fold(0.0, f64::max) <= model.position_slack);
    }
}

#[test]
fn smooth_surfaces_are_not_chained() {
    let n = 600;
    let model = mesh(&extruded(&[regular(n, 20.0)], 30.0));
    assert_eq!(model.faces.len(), n + 2);
    let fine = mesh(&extruded(&[regular(6000, 20.0)], 30.0));
    assert!(fine.faces.len() < 6002 && fine.position_slack <= 1e-6 * fine.size, "{}", fine.faces.len());
    assert!(fine.normal_slack > 0.0);
}

#[test]
fn nonsense_is_refused_or_read_but_nothing_breaks() {
    let mut random = Random(7);
    let mut num_read = 0;
    for _ in 0..3000 {
        let (num_points, num_triangles) = (3 + random.below(9), 1 + random.below(20));
        let vertices: Vec<DVec3> = (0..num_points).map(|_| random.point(-2.5, 2.5).round() * 10.0).collect();
        let triangles: Vec<[u32; 3]> =
            (0..num_triangles).map(|_| [0; 3].map(|_| random.below(num_points))).collect();
        let Ok(model) = Model::mesh("part", &vertices, &triangles, &[], 0.1, 0.1) else { continue };
        num_read += 1;
        let point = random.point(-50.0, 50.0);
        let distance = model.signed_distance(point);
        assert!(distance.abs() == model.nearest(point).distance && distance.is_finite());
        assert!(model.segment_distance(point, random.point(-50.0, 50.0)) <= distance.abs());
        assert!(model.faces.iter().all(|face| face.normal.is_normalized() && !face.pieces.is_empty()));
        assert!(model.vertices.iter().flat_map(|k| k.normals.iter().flatten()).all(|n| n.is_normalized()));
    }
    assert!(num_read > 1000, "{num_read}");
}

#[test]
fn what_is_no_solid_is_refused_with_the_reason() {
    let (vertices, triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
    let mut infinite = vertices.clone();
    infinite[3].y = f64::NAN;
    assert!(
        refusal(&infinite, &triangles).starts_with("vertices: vertex 3 has a coordinate that is not finite")
    );
    let out_of_range = refusal(&vertices, &[[0, 1, 2], [0, 9, 1]]);
    assert!(out_of_range.contains("triangle 1") && out_of_range.contains('9'), "{out_of_range}");
    assert!(refusal(&vertices, &[]).contains("is empty"));
    assert!(refusal(&vertices, &[[0, 0, 1]]).contains("no area"));
    assert!(refusal(&vertices, &[[0, 1, 2], [0, 2, 1]]).contains("two sides"));
    let far: Vec<DVec3> = vertices.iter().map(|point| *point + 1e9).collect();
    assert!(refusal(&far, &triangles).contains("origin"));
    assert!(Model::mesh(" ", &vertices, &triangles, &[], 0.0, 0.0).is_err());
    assert!(Model::mesh("part", &vertices, &triangles, &[12], 0.0, 0.0).is_err());
    assert!(Model::mesh("part", &vertices, &triangles, &[], -1.0, 0.0).is_err());
    let open = mesh(&(vertices, triangles[2..].to_vec()));
    assert!(!open.closed && open.signed_distance(DVec3::splat(0.5)) > 0.0);
    assert_eq!(tetrahedron().1.len(), 4);
}
