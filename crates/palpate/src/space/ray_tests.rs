//! First contacts against ways to find them that know distances only, and by hand.

use glam::{DVec3, dvec3};

use super::ray_cases::{Case, Tally, aim, along_face, changed, clear, middle, parts, radius};
use super::shapes::{Cells, Random, cuboid, mesh};
use super::{Model, Pose};
use crate::{Feature, Line};

#[test]
fn it_is_where_a_march_by_the_distance_ends() {
    let mut random = Random(31);
    let (mut aimed, mut tally) = (Tally::default(), Tally::default());
    for model in parts(&mut random) {
        for k in 0..400 {
            let radius = radius(&mut random, &model);
            let start = clear(&mut random, &model, radius);
            let is_aimed = k % 4 == 0;
            let off = if is_aimed { 0.0 } else { (0.3 * model.size + 1.3 * radius) * random.next().powi(2) };
            let target = aim(&mut random, &model).0 + off * random.direction();
            let Some(direction) = (target - start).try_normalize() else { continue };
            let pose = random.pose();
            let line = Line { start: pose.apply(start), direction: pose.rotation * direction };
            let case = Case { model: &model, world_from_model: pose, line, radius };
            let found = case.checked(Case::traced);
            if is_aimed { &mut aimed } else { &mut tally }.add(&case, found);
        }
    }
    assert!(tally.contacts > 4000 && tally.nothing > 500 && tally.grazing < 30, "{tally:?}");
    assert!(tally.kinds.len() == 6 && tally.kinds.values().all(|count| *count > 200), "{tally:?}");
    // Those through edges and corners as well, of which a point grazes many.
    assert!(aimed.contacts > 1500 && aimed.grazing < 400, "{aimed:?}");
}

#[test]
fn grazing_and_parallel_to_faces() {
    let mut random = Random(32);
    let mut tally = Tally::default();
    for model in parts(&mut random) {
        for _ in 0..60 {
            let radius = radius(&mut random, &model).max(1e-3 * model.size);
            let (target, face) = aim(&mut random, &model);
            let normal = model.faces[face as usize].normal;
            // Along the face, or across it at an edge, at just the radius, or nearly.
            let direction =
                if random.below(3) == 0 { random.direction() } else { along_face(&mut random, &model, face) };
            let away = if random.below(3) == 0 { random.direction() } else { normal };
            let away = away.reject_from_normalized(direction).normalize_or_zero();
            let off = [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3][random.below(6) as usize];
            let off = if random.below(2) == 0 { off } else { -off };
            let reach = 3.0 * (model.size + radius);
            let start = target + radius * (1.0 + off) * away - reach * direction;
            if model.signed_distance(start) < 1.001 * radius {
                continue;
            }
            let case = Case {
                model: &model,
                world_from_model: Pose::IDENTITY,
                line: Line { start, direction },
                radius,
            };
            let found = case.checked(Case::searched);
            tally.add(&case, found);
        }
    }
    assert!(tally.contacts > 400 && tally.nothing > 50 && tally.grazing > 100, "{tally:?}");
}

/// However it is turned: a ball that touches a face just where it, or one of its triangles, ends.
#[test]
fn where_a_face_ends_it_is_the_face() {
    let mut random = Random(35);
    let mut num_there = 0;
    for model in parts(&mut random) {
        for ([a, b, c], face) in &model.triangles {
            let normal = model.faces[*face as usize].normal;
            for ends in [[a, b], [b, c], [c, a]] {
                let [from, to] = ends.map(|end| model.vertices[*end as usize].point);
                let radius = 1e-3 * model.size * 100_f64.powf(random.next());
                let place = [0.0, 1.0, random.next(), random.next()][random.below(4) as usize];
                let center = from + place * (to - from) + radius * normal;
                let direction = random.direction();
                let direction = if direction.dot(normal) < 0.0 { direction } else { -direction };
                let start = center - 0.1 * model.size * direction;
                if direction.dot(normal) > -0.01
                    || model.nearest(center).distance < radius * (1.0 - 1e-9)
                    || model.signed_distance(start) <= radius
                {
                    continue;
                }
                let pose = random.pose();
                let line = Line { start: pose.apply(start), direction: pose.rotation * direction };
                let met = model.first_contact(pose, &line, radius).expect("it is there");
                assert!(met.depth < 0.1 * model.size * (1.0 + 1e-9), "{met:?} late");
                if met.depth < 0.1 * model.size * (1.0 - 1e-9) {
                    continue;
                }
                num_there += 1;
                let is_there = (pose.rotation * normal).distance(met.normal) < 1e-12;
                assert!(is_there && met.feature.kind() == "face", "{met:?} for face {face}");
            }
        }
    }
    assert!(num_there > 2000, "{num_there}");
}

#[test]
fn tiny_huge_and_far_away() {
    let mut random = Random(33);
    let mut tally = Tally::default();
    for model in parts(&mut random) {
        if !model.closed {
            continue;
        }
        for (factor, shift, away) in
            [(1e-7, 0.0, 1.0), (1e7, 0.0, 1.0), (1.0, 1e5, 1.0), (1.0, 0.0, 1e7), (1e-3, 10.0, 1e4)]
        {
            let model = changed(&model, factor, shift * DVec3::new(1.0, -0.3, 0.7));
            for _ in 0..40 {
                let radius = radius(&mut random, &model);
                let start = middle(&model) + 2.0 * away * (model.size + radius) * random.direction();
                let target = aim(&mut random, &model).0 + 1.2 * radius * random.next() * random.direction();
                let Some(direction) = (target - start).try_normalize() else { continue };
                let line = Line { start, direction };
                let case = Case { model: &model, world_from_model: Pose::IDENTITY, line, radius };
                let found = case.checked(Case::traced);
                tally.add(&case, found);
            }
        }
    }
    assert!(tally.contacts > 2000, "{tally:?}");
}

/// As files of single precision give them: corners off their planes, edges not quite straight.
#[test]
fn corners_off_their_planes() {
    let mut random = Random(36);
    let mut tally = Tally::default();
    for model in parts(&mut random) {
        let pose = random.pose();
        let rounded = |point: DVec3| pose.apply(point).as_vec3().as_dvec3();
        let points: Vec<DVec3> = model.vertices.iter().map(|vertex| rounded(vertex.point)).collect();
        let triangles: Vec<[u32; 3]> = model.triangles.iter().map(|(corners, _)| *corners).collect();
        let model = Model::mesh("rounded", &points, &triangles, &[], 0.0, 0.0).expect("a mesh");
        for _ in 0..200 {
            let radius = [0.0, 1e-9, 1e-7, 1e-5, 0.01, 0.3][random.below(6) as usize] * model.size;
            let start = clear(&mut random, &model, radius);
            let target = aim(&mut random, &model).0 + radius * random.next() * random.direction();
            let Some(direction) = (target - start).try_normalize() else { continue };
            let line = Line { start, direction };
            let case = Case { model: &model, world_from_model: Pose::IDENTITY, line, radius };
            let found = case.checked(Case::traced);
            tally.add(&case, found);
        }
    }
    // With what the faces are off, many move by more than rounding allows for: they are grazing, within their bounds.
    assert!(tally.contacts > 1000 && tally.contacts + tally.grazing > 3900, "{tally:?}");
}

/// Whole numbers as coordinates of a union of boxes.
fn whole_cells(random: &mut Random, count: usize) -> Cells {
    let mut cells = Cells::random(random, count, 0.4);
    for planes in &mut cells.planes {
        let mut at = -10.0;
        for plane in planes.iter_mut() {
            *plane = at;
            at += f64::from(1 + random.below(4));
        }
    }
    cells
}

/// How far along a line the first of the cells begins, their borders included.
fn first_cell(cells: &Cells, line: &Line<DVec3>) -> Option<f64> {
    let n = cells.planes[0].len() - 1;
    let full = (0..n * n * n).filter(|k| cells.is_full[*k]).map(|k| [k % n, k / n % n, k / n / n]);
    let enters = |cell: [usize; 3]| {
        let (mut first, mut last) = (0.0_f64, f64::INFINITY);
        for (axis, (start, rate)) in
            line.start.to_array().into_iter().zip(line.direction.to_array()).enumerate()
        {
            let range = [cell[axis], cell[axis] + 1].map(|k| cells.planes[axis][k] - start);
            if rate == 0.0 {
                if range[0] > 0.0 || range[1] < 0.0 {
                    return None;
                }
                continue;
            }
            let [a, b] = range.map(|offset| offset / rate);
            (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
        }
        (first <= last).then_some(first)
    };
    full.filter_map(enters).reduce(f64::min)
}

/// Along the axes nothing is rounded, and touching is touching; else a point may pass what it only touches.
#[test]
fn a_point_slips_through_no_edge_and_no_corner() {
    let mut random = Random(34);
    let (mut inside, mut touching, mut past) = (0, 0, 0);
    for _ in 0..60 {
        let cells = whole_cells(&mut random, 4);
        let model = mesh(&cells.shape());
        for _ in 0..100 {
            // A corner of the grid, or a place on one of its lines.
            let mut target = DVec3::from([0, 1, 2].map(|axis| cells.planes[axis][random.below(5) as usize]));
            target[random.below(3) as usize] += [0.0, 0.5, 0.25][random.below(3) as usize];
            let direction = DVec3::from([(); 3].map(|()| f64::from(random.below(3)) - 1.0));
            if direction == DVec3::ZERO {
                continue;
            }
            let line = Line { start: target - 64.0 * direction, direction: direction.normalize_or_zero() };
            let found = model.first_contact(Pose::IDENTITY, &line, 0.0);
            let Some(expected) = first_cell(&cells, &line) else {
                assert_eq!(found, None, "{line:?}");
                past += 1;
                continue;
            };
            let further = line.at(expected + 1e-3);
            let corners = (0..8).map(|k| DVec3::from([0, 1, 2].map(|bit| f64::from(k >> bit & 1) - 0.5)));
            let goes_in = corners.into_iter().all(|corner| cells.holds(further + 1e-6 * corner));
            *(if goes_in { &mut inside } else { &mut touching }) += 1;
            if goes_in || direction.abs().element_sum() == 1.0 {
                let found = found.unwrap_or_else(|| panic!("{line:?} {expected}"));
                assert!((found.depth - expected).abs() < 1e-12, "{line:?} {expected} {found:?}");
                assert!(found.normal.dot(line.direction) < 0.0 && found.touchable);
            }
        }
    }
    assert!(inside > 1000 && touching > 1000 && past > 300, "{inside} {touching} {past}");
}

fn cube() -> Model {
    mesh(&cuboid(DVec3::ZERO, DVec3::splat(10.0)))
}

fn met(model: &Model, start: DVec3, direction: DVec3, radius: f64) -> Option<(f64, DVec3, Feature, bool)> {
    let line = Line { start, direction: direction.normalize_or_zero() };
    let met = model.first_contact(Pose::IDENTITY, &line, radius)?;
    Some((met.depth, met.normal, met.feature, met.touchable))
}

#[test]
fn on_a_cube_by_hand() {
    let cube = cube();
    let top = |start: DVec3, radius: f64| {
        met(&cube, start, DVec3::NEG_Z, radius).map(|met| (met.0, met.1, met.2.kind()))
    };
    for radius in [0.0, 2.0] {
        // Over the middle, a diagonal, an edge and a corner: a face.
        for (x, y) in [(5.0, 3.0), (5.0, 5.0), (0.0, 4.0), (10.0, 10.0)] {
            assert_eq!(top(dvec3(x, y, 20.0), radius), Some((10.0 - radius, DVec3::Z, "face")));
        }
        assert_eq!(top(dvec3(5.0, -radius - 1e-9, 20.0), radius), None);
    }
    let (depth, normal, kind) = top(dvec3(-1.2, 5.0, 20.0), 2.0).expect("an edge");
    assert!((depth - 8.4).abs() < 1e-14 && normal.distance(dvec3(-0.6, 0.0, 0.8)) < 1e-14 && kind == "edge");
    let (depth, normal, kind) = top(dvec3(-1.0, -1.0, 20.0), 1.5).expect("a corner");
    assert!((depth - 9.5).abs() < 1e-14 && kind == "vertex");
    assert!(normal.distance(dvec3(-1.0, -1.0, 0.5) / 1.5) < 1e-14);
    // At rest on it: further on it is touched at once, on the way back not at all.
    for radius in [0.0, 2.0] {
        let start = dvec3(5.0, 3.0, 10.0 + radius);
        assert_eq!(met(&cube, start, dvec3(0.3, 0.0, -1.0), radius).map(|met| met.0), Some(0.0));
        assert_eq!(met(&cube, start, dvec3(0.3, 0.0, 1.0), radius), None);
    }
}

#[test]
fn loose_faces_have_two_sides_and_seams_none() {
    let square =
        |z: f64| vec![vec![dvec3(0.0, 0.0, z), dvec3(9.0, 0.0, z), dvec3(9.0, 9.0, z), dvec3(0.0, 9.0, z)]];
    let model = Model::facets("sheets", &[square(0.0), square(5.0), square(8.0)], &[2], &[0], 0.0, 0.0)
        .expect("loose");
    for radius in [0.0, 1.0] {
        let down = met(&model, dvec3(3.0, 4.0, 20.0), DVec3::NEG_Z, radius);
        assert_eq!(down, Some((15.0 - radius, DVec3::Z, Feature::Face(1), true)), "the seam is not there");
        let up = met(&model, dvec3(3.0, 4.0, 1.0 + radius), DVec3::Z, radius);
        assert_eq!(up, Some((4.0 - 2.0 * radius, DVec3::NEG_Z, Feature::Face(1), false)));
        let below = met(&model, dvec3(3.0, 4.0, 4.0 - radius), DVec3::NEG_Z, radius);
        assert_eq!(
            below,
            Some((4.0 - 2.0 * radius, DVec3::Z, Feature::Face(0), false)),
            "in the way, untouchable"
        );
    }
    let (depth, _, feature, touchable) = met(&model, dvec3(-20.0, 4.0, 5.5), DVec3::X, 1.0).expect("its end");
    assert!(!touchable && feature.kind() == "edge" && (depth - (20.0 - 0.75_f64.sqrt())).abs() < 1e-14);
    assert_eq!(met(&model, dvec3(-20.0, 4.0, 5.0), DVec3::X, 0.0), None, "a point passes along a sheet");
    // A sheet of two faces that lie on one another is touched on the one that looks at the tip.
    let mut turned = square(5.0);
    turned[0].reverse();
    let sheet = Model::facets("sheet", &[turned, square(5.0)], &[], &[], 0.0, 0.0).expect("loose");
    for (start, direction, face) in [(9.0, DVec3::NEG_Z, 1), (1.0, DVec3::Z, 0)] {
        for radius in [0.0, 1.0] {
            let met = met(&sheet, dvec3(3.0, 4.0, start), direction, radius).expect("a sheet");
            assert_eq!((met.2, met.3), (Feature::Face(face), true));
        }
    }
}
