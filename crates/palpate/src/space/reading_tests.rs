//! Laws of reading: whatever rounding did to corners, a part keeps its faces and symmetries, or is refused.

use glam::{DVec2, DVec3, dvec2, dvec3};

use super::shapes::{Cells, Random, Shape, both, cuboid, extruded, hull, mesh, mirrored, moved, regular};
use super::{Model, Pose, sewn};
use crate::Error;

/// Triangles that share no corner.
fn loose((points, triangles): &Shape) -> Shape {
    let corners = triangles.iter().flatten().map(|&k| points[k as usize]).collect();
    (corners, (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

fn shaken(shape: &Shape, noise: f64, random: &mut Random) -> Shape {
    let shake = |point: &DVec3| *point + noise * random.point(-1.0, 1.0);
    (shape.0.iter().map(shake).collect(), shape.1.clone())
}

/// As a binary STL has them.
fn single(shape: &Shape) -> Shape {
    (shape.0.iter().map(|point| point.as_vec3().as_dvec3()).collect(), shape.1.clone())
}

fn read(shape: &Shape) -> Result<Model, Error> {
    Model::mesh("part", &shape.0, &shape.1, &[], 0.0, 0.0)
}

fn said(model: &Model, words: &str) -> bool {
    model.mends.iter().any(|mend| mend.0.contains(words))
}

fn bracket() -> Shape {
    let outline = [(0., 0.), (80., 0.), (80., 20.), (20., 20.), (20., 60.), (0., 60.)];
    let hole: Vec<DVec2> = regular(7, 6.0).iter().rev().map(|p| *p + dvec2(50.0, 10.0)).collect();
    extruded(&[outline.iter().map(|&(x, y)| dvec2(x, y)).collect(), hole], 25.0)
}

/// Parts of every kind, with the number of their symmetries.
fn parts(random: &mut Random) -> Vec<(Shape, usize)> {
    let cube = cuboid(DVec3::splat(-30.0), DVec3::splat(30.0));
    let bore: Vec<DVec2> = regular(24, 9.0).into_iter().rev().collect();
    vec![
        (bracket(), 1),
        (extruded(&[regular(6, 25.0)], 40.0), 12),
        (extruded(&[regular(48, 25.0)], 40.0), 96),
        (extruded(&[regular(24, 25.0), bore], 30.0), 48),
        (both(&cube, &mirrored(&cuboid(DVec3::splat(-9.0), DVec3::splat(9.0)))), 24),
        (hull(random, 12), 1),
    ]
}

#[test]
fn a_motion_and_single_precision_keep_faces_and_symmetries() {
    let mut random = Random(31);
    for round in 0..30 {
        for (k, (shape, order)) in parts(&mut random).into_iter().enumerate() {
            let drawn = mesh(&shape);
            let rounded = single(&moved(&shape, random.pose()));
            for shape in [&rounded, &loose(&rounded)] {
                let model = mesh(shape);
                let count = |model: &Model| [model.faces.len(), model.edges.len(), model.vertices.len()];
                assert_eq!((count(&model), model.closed), (count(&drawn), true), "{round} {k}");
                assert_eq!((model.symmetries.len(), drawn.symmetries.len()), (order, order), "{round} {k}");
                check_group(&model);
            }
        }
    }
}

/// What T10 asks of symmetries: they are a group in what they do with features, and miss by no more than is said.
fn check_group(model: &Model) {
    let num_tried = model.symmetries.len().min(12);
    for a in &model.symmetries[..num_tried] {
        for b in &model.symmetries {
            let through = |a: &[u32], b: &[u32]| b.iter().map(|&k| a[k as usize]).collect::<Vec<u32>>();
            let (vertices, faces, edges) =
                (through(&a.vertices, &b.vertices), through(&a.faces, &b.faces), through(&a.edges, &b.edges));
            let same = model.symmetries.iter().filter(|one| one.vertices == vertices);
            let found: Vec<_> = same.map(|one| (&one.faces, &one.edges)).collect();
            assert_eq!(found, [(&faces, &edges)], "a group");
        }
    }
    for symmetry in &model.symmetries {
        for (vertex, &image) in model.vertices.iter().zip(&symmetry.vertices) {
            let miss = symmetry.motion.apply(vertex.point).distance(model.vertices[image as usize].point);
            assert!(miss <= model.asymmetry.0.max(1e-30) && miss <= 6e-7 * model.size, "{miss}");
        }
        for (face, &image) in model.faces.iter().zip(&symmetry.faces) {
            let turn = (symmetry.motion.rotation * face.normal).distance(model.faces[image as usize].normal);
            assert!(turn <= model.asymmetry.1 + 1e-15, "{turn} {:?}", model.asymmetry);
        }
    }
}

#[test]
fn shaken_corners_are_welded_and_the_slacks_hold_what_it_costs() {
    let mut random = Random(32);
    for round in 0..40 {
        for (k, (shape, _)) in parts(&mut random).into_iter().enumerate() {
            let (drawn, pose) = (mesh(&shape), random.pose());
            let size = drawn.size;
            let noise = size * 10_f64.powf(random.within(-11.0, -7.2));
            let given = shaken(&loose(&moved(&shape, pose)), noise, &mut random);
            let model = mesh(&given);
            assert_eq!(model.faces.len(), drawn.faces.len(), "{round} {k} {noise:e}: {:?}", model.mends);
            assert!(model.closed && !said(&model, "turned"), "{:?}", model.mends);
            assert!(said(&model, "welded") || model.position_slack <= 1e-8 * size);
            let slack = model.position_slack.max(2e-9 * size);
            for (point, _) in on_triangles(&given, &mut random) {
                assert!(model.nearest(point).distance <= slack, "{round} {k} {noise:e} {point}");
            }
            // Faces keep the order of their first triangles.
            for (face, true_face) in model.faces.iter().zip(&drawn.faces) {
                let turn = face.normal.angle_between(pose.rotation * true_face.normal);
                assert!(turn <= model.normal_slack + 2e-7, "{round} {k} {noise:e}: {turn:e}");
            }
        }
    }
}

/// A point of each triangle with its normal, but of slivers.
fn on_triangles((points, triangles): &Shape, random: &mut Random) -> Vec<(DVec3, DVec3)> {
    let on = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|k| points[k as usize]);
        let across = (b - a).cross(c - a);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let (s, t) = (random.next(), random.next());
        let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
        let point = a + s * (b - a) + t * (c - a);
        (across.length() > 0.1 * longest).then(|| (point, across.normalize()))
    };
    triangles.iter().filter_map(on).collect()
}

#[test]
fn a_unit_of_the_last_place_is_welded_even_ten_sizes_from_the_origin() {
    let mut random = Random(33);
    for far in [0.0, 1.0, 10.0] {
        let shape = cuboid(DVec3::ZERO, dvec3(50.3, 40.7, 30.1));
        for _ in 0..20 {
            let at = far * 70.0 * random.direction();
            let placed = loose(&single(&moved(&shape, Pose::new(random.direction(), at))));
            let mut ulp = |x: f64| {
                let x = x as f32;
                f64::from([x.next_down(), x, x.next_up()][random.below(3) as usize])
            };
            let points = placed.0.iter().map(|point| dvec3(ulp(point.x), ulp(point.y), ulp(point.z)));
            let model = mesh(&(points.collect(), placed.1));
            assert_eq!((model.faces.len(), model.closed), (6, true), "{far}: {:?}", model.mends);
            assert_eq!(model.symmetries.len(), 4, "{far}");
            assert!(model.position_slack > 0.0 && model.position_slack < 2e-6 * far.max(1.0) * model.size);
        }
    }
}

#[test]
fn corners_too_far_apart_to_be_welded_are_refused_or_loose_as_given() {
    let mut random = Random(34);
    let mut seen = [0; 3];
    for round in 0..200 {
        let shape = moved(&bracket(), random.pose());
        let noise = 100.0 * 10_f64.powf(random.within(-7.5, -1.5));
        let given = shaken(&loose(&shape), noise, &mut random);
        match read(&given) {
            Ok(model) if model.closed => {
                assert!(noise < 1e-4 && model.faces.len() >= 15, "{round} {noise:e}");
                seen[0] += 1;
            }
            Ok(model) => {
                // Each triangle is a face, and faces where it was given to.
                assert!(noise > 1e-3 && !said(&model, "turned"), "{round} {noise:e} {:?}", model.mends);
                for (point, normal) in on_triangles(&given, &mut random) {
                    let found = model.nearest(point);
                    assert!(found.distance <= model.position_slack + 1e-9);
                    assert!(model.faces[found.face as usize].normal.dot(normal) > 0.99, "{round} {noise:e}");
                }
                seen[1] += 1;
            }
            Err(error) => {
                let text = error.to_string();
                assert!(text.contains("beside another one") && text.contains("weld the corners"), "{text}");
                assert!((2e-5..2.0).contains(&noise), "{noise:e}: {text}");
                seen[2] += 1;
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 10), "{seen:?}");
}

#[test]
fn details_of_a_hundred_thousandth_stay_apart() {
    let mut random = Random(35);
    for far in [0.0, 3.0, 9.0] {
        for _ in 0..20 {
            // A groove, and an open sheet with a step and a slit, all 1e-5 of the size.
            let detail = 1.2e-3;
            let outline =
                [(0., 0.), (100., 0.), (100., 60.), (50. + detail, 60.), (50. + detail, 60. - detail)];
            let rest = [(50., 60. - detail), (50., 60.), (0., 60.)];
            let outline: Vec<DVec2> = outline.iter().chain(&rest).map(|&(x, y)| dvec2(x, y)).collect();
            let shape = extruded(&[outline], 20.0);
            let pose = Pose::new(random.direction(), 100.0 * far * random.direction());
            let placed = moved(&shape, pose);
            assert_eq!(mesh(&placed).faces.len(), 10);
            assert_eq!(mesh(&loose(&placed)).faces.len(), 10);
            let open: Shape = (placed.0.clone(), placed.1[..placed.1.len() - 4].to_vec());
            let model = mesh(&open);
            assert!(!model.closed && !said(&model, "welded"), "{:?}", model.mends);
            assert_eq!(model.vertices.len(), 16);

            let slit =
                [dvec3(0.0, 0.0, 0.0), dvec3(9.0, 0.0, 0.0), dvec3(9.0, 1e-4, 0.0), dvec3(0.0, 5.0, 0.0)];
            let sheet = moved(
                &(slit.to_vec(), vec![[0, 1, 3], [0, 3, 2]]),
                Pose::new(random.direction(), DVec3::ONE),
            );
            let model = mesh(&sheet);
            assert_eq!((model.faces.len(), model.vertices.len()), (2, 4), "{:?}", model.mends);
        }
    }
}

#[test]
fn a_stray_corner_does_not_weld_the_part_away() {
    let mut random = Random(36);
    let shape = loose(&bracket());
    for exponent in 3..9 {
        let mut given = shape.clone();
        let place = random.below(given.0.len() as u32) as usize;
        given.0[place] = 10_f64.powi(exponent) * random.direction();
        match read(&given) {
            Ok(model) => assert!(!said(&model, "welded"), "{exponent}: {:?}", model.mends),
            Err(error) => assert!(!error.to_string().contains("slack"), "{error}"),
        }
    }
}

#[test]
fn what_is_open_is_not_turned_on_a_guess() {
    let (points, triangles) = cuboid(DVec3::ZERO, DVec3::splat(9.0));
    let normals = |triangles: &[[u32; 3]]| {
        let model = mesh(&(points.clone(), triangles.to_vec()));
        let mut normals: Vec<DVec3> = model.faces.iter().map(|face| face.normal.round()).collect();
        normals.sort_by_key(|normal| (normal.to_array().map(|x| x as i32), 0));
        (normals, model)
    };
    // One triangle of an open box against all others is an oversight; half of it is meant.
    let open = &triangles[2..];
    let (right, _) = normals(open);
    let mut one = open.to_vec();
    one[3].swap(0, 1);
    let (found, model) = normals(&one);
    assert!(found == right && said(&model, "1 triangle(s) wound against"), "{:?}", model.mends);
    let mut half = open.to_vec();
    half[..4].iter_mut().for_each(|triangle| triangle.swap(0, 1));
    let (found, model) = normals(&half);
    assert!(found != right && said(&model, "kept as given"), "{:?}", model.mends);
    // The walls of a cavity stay so if the surface around it is open, and are turned if there is none.
    let around = cuboid(DVec3::splat(-5.0), DVec3::splat(14.0));
    let cavity = mirrored(&(points.clone(), triangles.clone()));
    let opened = (around.0.clone(), around.1[1..].to_vec());
    let model = mesh(&both(&opened, &cavity));
    assert!(!model.closed && model.mends.is_empty(), "{:?}", model.mends);
    let apart = (around.0.iter().map(|point| *point + 100.0).collect(), opened.1);
    assert!(said(&mesh(&both(&apart, &cavity)), "inside out"));
    // A strip with one side only.
    let strip: Shape = (
        (0..10)
            .map(|k| {
                let angle = f64::from(k / 2) * std::f64::consts::TAU / 5.0;
                let width = if k % 2 == 0 { 3.0 } else { -3.0 };
                let out = 10.0 + width * (0.5 * angle).cos();
                dvec3(out * angle.cos(), out * angle.sin(), width * (0.5 * angle).sin())
            })
            .collect(),
        (0..5_u32)
            .flat_map(|k| {
                let [a, b] = [2 * k, 2 * k + 1];
                let [c, d] = if k == 4 { [1, 0] } else { [a + 2, b + 2] };
                [[a, b, c], [b, d, c]]
            })
            .collect(),
    );
    let model = mesh(&strip);
    assert!(said(&model, "one side only") && !said(&model, "turned"), "{:?}", model.mends);
    for (point, normal) in on_triangles(&strip, &mut Random(37)) {
        let face = model.nearest(point).face;
        assert!(model.faces[face as usize].normal.dot(normal) > 0.99);
    }
}

#[test]
fn a_surface_that_crosses_itself_is_said_or_refused() {
    let mut random = Random(38);
    let (points, triangles) = cuboid(DVec3::ZERO, DVec3::splat(20.0));
    for _ in 0..50 {
        let pose = random.pose();
        let overlap = moved(
            &cuboid(DVec3::ZERO, DVec3::splat(20.0)),
            Pose::new(random.direction(), DVec3::splat(11.0)),
        );
        let model = mesh(&moved(&both(&(points.clone(), triangles.clone()), &overlap), pose));
        assert!(model.closed && said(&model, "an edge passes through a face"), "{:?}", model.mends);

        let mut pulled = (points.clone(), triangles.clone());
        pulled.0[0] =
            dvec3(random.within(5.0, 15.0), random.within(5.0, 15.0), 20.0 + random.within(1.0, 9.0));
        let refused = read(&moved(&pulled, pose)).expect_err("is turned inside out").to_string();
        assert!(refused.contains("turned inside out") && refused.contains("mend the mesh"), "{refused}");
        let (corners, numbers) = moved(&pulled, pose);
        let slack = Model::mesh("part", &corners, &numbers, &[], 20.0, 0.0).expect("the slack explains it");
        assert!(said(&slack, "an edge passes through a face"));

        // Side by side, one on the other, or with a thin wall between them, nothing crosses.
        for at in
            [dvec3(20.0, 7.0, 3.0), dvec3(7.0, 3.0, 20.0), dvec3(20.0, 0.0, 20.0), dvec3(20.001, 3.0, 4.0)]
        {
            let beside = cuboid(at, at + 15.0);
            let model = mesh(&single(&moved(&both(&(points.clone(), triangles.clone()), &beside), pose)));
            assert!(!said(&model, "passes through"), "{:?}", model.mends);
        }
    }
    for k in 0..50 {
        let shape = Cells::random(&mut random, 2 + k % 4, 0.5).shape();
        if !shape.1.is_empty() {
            assert!(!said(&mesh(&moved(&shape, random.pose())), "passes through"));
        }
    }
}

#[test]
fn triangles_are_sewn_as_models_read_them() {
    let mut random = Random(39);
    for noise in [0.0, 1e-6, 1e-5] {
        let given = shaken(&loose(&moved(&bracket(), random.pose())), noise, &mut random);
        let (model, sewn) = (mesh(&given), sewn(&given.0, &given.1).expect("finite"));
        let again =
            Model::mesh("part", &sewn.vertices, &sewn.triangles, &[], sewn.position_slack, sewn.normal_slack);
        let again = again.expect("clean");
        assert!(again.closed && again.mends.is_empty(), "{:?}", again.mends);
        assert_eq!((&again.faces, &again.vertices), (&model.faces, &model.vertices));
        assert!(again.position_slack >= model.position_slack && again.normal_slack >= model.normal_slack);
        assert!(again.position_slack <= 2.0 * model.position_slack);
        assert_eq!(sewn.mends, model.mends);
    }
    let flat = [DVec3::ZERO, DVec3::X, 2.0 * DVec3::X];
    let nothing = sewn(&flat, &[[0, 1, 2]]).expect("finite");
    assert!(nothing.triangles.is_empty() && nothing.mends[0].0.contains("without area"));
}
