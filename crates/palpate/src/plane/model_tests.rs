//! Laws of models: cleaning, refusals, corners, symmetries.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, dvec2};

use super::super::Pose;
use super::{Model, Surface};

/// Outer loop, holes, and what the message must say.
type Refused = (Vec<DVec2>, Vec<Vec<DVec2>>, &'static str);

/// A small generator of numbers in `[0, 1)` (splitmix64), so that tests repeat.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn pose(&mut self) -> Pose {
        Pose::new(TAU * self.next(), 200.0 * dvec2(self.next(), self.next()))
    }

    /// A star-shaped outline about the origin.
    fn star(&mut self, corners: usize) -> Vec<DVec2> {
        let step = TAU / corners as f64;
        (0..corners)
            .map(|k| (20.0 + 60.0 * self.next()) * DVec2::from_angle(step * (k as f64 + 0.8 * self.next())))
            .collect()
    }
}

fn regular(n: usize, radius: f64) -> Vec<DVec2> {
    (0..n).map(|k| radius * DVec2::from_angle(TAU * k as f64 / n as f64)).collect()
}

fn points(coordinates: &[(f64, f64)]) -> Vec<DVec2> {
    coordinates.iter().map(|&(x, y)| dvec2(x, y)).collect()
}

fn square(low: f64, high: f64) -> Vec<DVec2> {
    points(&[(low, low), (high, low), (high, high), (low, high)])
}

fn polygon(vertices: &[DVec2]) -> Model {
    Model::polygon("part", vertices, &[], &[], 0.0, 0.0).expect("a clean outline")
}

fn refusal(vertices: &[DVec2], holes: &[Vec<DVec2>]) -> String {
    Model::polygon("part", vertices, holes, &[], 0.0, 0.0).expect_err("must be refused").to_string()
}

fn corners(model: &Model) -> Vec<DVec2> {
    model.vertices.iter().map(|vertex| vertex.point).collect()
}

fn untouchable(model: &Model) -> Vec<[DVec2; 2]> {
    let faces = model.faces.iter().filter(|face| face.surface == Surface::Untouchable);
    faces.map(|face| [face.start, face.end]).collect()
}

#[test]
fn a_regular_polygon_has_as_many_symmetries_as_corners() {
    for n in [3, 4, 6, 7, 200, 2000] {
        assert_eq!(polygon(&regular(n, 50.0)).symmetries.len(), n);
    }
}

#[test]
fn symmetries_of_shapes_known_by_eye() {
    let s_shape =
        points(&[(0., 0.), (30., 0.), (30., 20.), (40., 20.), (40., 30.), (10., 30.), (10., 10.), (0., 10.)]);
    assert_eq!(polygon(&s_shape).symmetries.len(), 2);
    assert_eq!(polygon(&points(&[(0., 0.), (50., 0.), (13., 29.)])).symmetries.len(), 1);
    let kite = points(&[(0., -40.), (15., 0.), (0., 10.), (-15., 0.)]);
    assert_eq!(polygon(&kite).symmetries.len(), 1, "mirror images do not count");

    let with_hole =
        |low, high| Model::polygon("part", &square(-30., 30.), &[square(low, high)], &[], 0., 0.).unwrap();
    assert_eq!(with_hole(-10., 10.).symmetries.len(), 4);
    assert_eq!(with_hole(-10., 11.).symmetries.len(), 1);
    let half_blind = Model::polygon("part", &square(-30., 30.), &[], &[0, 2], 0., 0.).unwrap();
    assert_eq!(half_blind.symmetries.len(), 2, "surface kinds are kept");
}

#[test]
fn a_symmetry_maps_each_feature_onto_its_image() {
    let gear: Vec<DVec2> =
        regular(24, 50.0).iter().enumerate().map(|(k, p)| if k % 4 < 2 { *p } else { 0.8 * *p }).collect();
    let model = polygon(&gear);
    assert_eq!(model.symmetries.len(), 6);
    for symmetry in &model.symmetries {
        for (k, face) in model.faces.iter().enumerate() {
            let image = &model.faces[symmetry.faces[k] as usize];
            assert!(symmetry.motion.apply(face.start).distance(image.start) < 1e-9);
            assert!(symmetry.motion.apply(face.end).distance(image.end) < 1e-9);
        }
        for (k, vertex) in model.vertices.iter().enumerate() {
            let image = &model.vertices[symmetry.vertices[k] as usize];
            assert!(symmetry.motion.apply(vertex.point).distance(image.point) < 1e-9);
            assert_eq!(vertex.normals.is_some(), image.normals.is_some());
        }
    }
}

#[test]
fn symmetries_are_closed_under_composition_and_sorted() {
    let model = polygon(&regular(12, 40.0));
    assert_eq!(model.symmetries[0].motion, Pose::IDENTITY);
    let angles: Vec<f64> = model.symmetries.iter().map(|s| s.motion.angle().rem_euclid(TAU)).collect();
    assert!(angles.is_sorted(), "{angles:?}");
    for a in &model.symmetries {
        for b in &model.symmetries {
            let both: Vec<u32> = b.faces.iter().map(|&k| a.faces[k as usize]).collect();
            let found = model.symmetries.iter().find(|s| s.faces == both).expect("closed");
            let motion = a.motion.compose(b.motion);
            assert!(motion.rotation.distance(found.motion.rotation) < 1e-12);
            assert!(motion.translation.distance(found.motion.translation) < 1e-9);
        }
    }
}

#[test]
fn a_rigid_motion_keeps_the_symmetries() {
    let mut random = Random(1);
    for order in [1_usize, 2, 3, 5] {
        let sector = random.star(4);
        let outline: Vec<DVec2> = (0..order)
            .flat_map(|k| {
                let about = DVec2::from_angle(TAU * k as f64 / order as f64);
                // The star's angles are squeezed into one sector.
                sector.iter().map(move |p| {
                    let angle = p.to_angle().rem_euclid(TAU) / order as f64;
                    about.rotate(p.length() * DVec2::from_angle(angle))
                })
            })
            .collect();
        for _ in 0..20 {
            let pose = random.pose();
            let moved: Vec<DVec2> = outline.iter().map(|&p| pose.apply(p)).collect();
            assert_eq!(polygon(&moved).symmetries.len(), order);
        }
    }
}

#[test]
fn loose_faces_count_their_normals() {
    let wings = [[dvec2(-30., 5.), dvec2(-10., 0.)], [dvec2(30., -5.), dvec2(10., 0.)]];
    let model = Model::segments("wings", &wings, &[], &[], 0., 0.).unwrap();
    assert_eq!(model.symmetries.len(), 2);
    let turned = [wings[0], [wings[1][1], wings[1][0]]];
    assert_eq!(Model::segments("wings", &turned, &[], &[], 0., 0.).unwrap().symmetries.len(), 1);
    let seamed = [wings[0], wings[1], [dvec2(-10., 0.), dvec2(10., 0.)]];
    let model = Model::segments("wings", &seamed, &[2], &[], 0., 0.).unwrap();
    assert_eq!(model.symmetries.len(), 2, "a seam is not there");
    assert_eq!(model.symmetries[1].faces, [1, 0, 2]);
}

#[test]
fn outlines_turn_the_right_way_round() {
    let mut random = Random(2);
    for _ in 0..50 {
        let outer = random.star(9);
        let hole: Vec<DVec2> = regular(5, 5.0).iter().map(|&p| random.next() * 0.1 + p).collect();
        let given = |flip: bool, loop_: &[DVec2]| {
            let mut points = loop_.to_vec();
            if flip {
                points.reverse();
            }
            points
        };
        for flips in [(false, false), (true, false), (false, true), (true, true)] {
            let (outer, hole) = (given(flips.0, &outer), given(flips.1, &hole));
            let model = Model::polygon("part", &outer, &[hole], &[], 0., 0.).unwrap();
            let area = |faces: &[super::Face]| faces.iter().map(|f| f.start.perp_dot(f.end)).sum::<f64>();
            assert!(area(&model.faces[..9]) > 0.0 && area(&model.faces[9..]) < 0.0);
            assert_eq!(model.mends.len(), usize::from(flips.0) + usize::from(!flips.1));
            for (face, vertex) in model.faces.iter().zip(&model.vertices) {
                assert_eq!(face.start, vertex.point);
                assert!(
                    (face.normal.length() - 1.0).abs() < 1e-12
                        && (face.end - face.start).perp_dot(face.normal) < 0.
                );
            }
        }
    }
}

#[test]
fn cleaning_restores_a_littered_outline_and_then_changes_nothing() {
    let mut random = Random(3);
    for _ in 0..100 {
        let clean = random.star(8);
        let mut littered = Vec::new();
        for (k, &point) in clean.iter().enumerate() {
            littered.push(point);
            if random.next() < 0.3 {
                littered.push(point + 1e-9 * dvec2(random.next(), random.next()));
            }
            for share in [0.25, 0.5] {
                if random.next() < 0.5 {
                    littered.push(point.lerp(clean[(k + 1) % 8], share));
                }
            }
        }
        let (expected, found) = (polygon(&clean), polygon(&littered));
        assert_eq!(corners(&found).len(), 8);
        assert!(corners(&found).iter().zip(corners(&expected)).all(|(a, b)| a.distance(b) < 1e-7));
        let again = polygon(&corners(&found));
        assert_eq!(again.faces, found.faces);
        assert!(again.mends.is_empty());
    }
}

#[test]
fn a_face_cut_open_at_the_first_point_is_joined() {
    let model = polygon(&points(&[(5., 0.), (10., 0.), (10., 10.), (0., 10.), (0., 0.), (5., 0.)]));
    assert_eq!(corners(&model), points(&[(10., 0.), (10., 10.), (0., 10.), (0., 0.)]));
    assert_eq!(model.mends.len(), 2, "{:?}", model.mends);
}

#[test]
fn untouchable_faces_are_followed_through_the_mending() {
    // Clockwise, with a doubled point and a point on the face from (10, 10) to (10, 0).
    let given = points(&[(0., 0.), (0., 10.), (0., 10.), (10., 10.), (10., 5.), (10., 0.)]);
    let blind = |numbers: &[usize]| Model::polygon("part", &given, &[], numbers, 0., 0.).unwrap();
    assert_eq!(untouchable(&blind(&[0])), [[dvec2(0., 10.), dvec2(0., 0.)]]);
    assert_eq!(untouchable(&blind(&[1])), [[DVec2::ZERO; 2]; 0], "it has no length");
    assert_eq!(untouchable(&blind(&[2])), [[dvec2(10., 10.), dvec2(0., 10.)]]);
    let half = blind(&[4]);
    assert_eq!((half.faces.len(), untouchable(&half)), (5, vec![[dvec2(10., 0.), dvec2(10., 5.)]]));
    assert_eq!(blind(&[3, 4]).faces.len(), 4);
    assert!(half.vertices.iter().filter(|v| v.normals.is_some()).count() == 3);

    let hole = square(2., 4.);
    let model = Model::polygon("part", &given, &[hole], &[6], 0., 0.).unwrap();
    assert_eq!(untouchable(&model), [[dvec2(4., 2.), dvec2(2., 2.)]]);
}

#[test]
fn convex_corners_have_the_normals_between_their_faces() {
    let l_shape = points(&[(0., 0.), (20., 0.), (20., 10.), (10., 10.), (10., 20.), (0., 20.)]);
    let model = Model::polygon("part", &l_shape, &[square(2., 4.)], &[], 0., 0.).unwrap();
    let convex: Vec<bool> = model.vertices.iter().map(|v| v.normals.is_some()).collect();
    assert_eq!(convex, [true, true, true, false, true, true, false, false, false, false]);
    for (k, vertex) in model.vertices[..6].iter().enumerate() {
        let Some(normals) = vertex.normals else { continue };
        assert!((normals.width - FRAC_PI_2).abs() < 1e-12);
        assert!(normals.distance(model.faces[(k + 5) % 6].normal.to_angle()) < 1e-12);
        assert!(normals.distance(model.faces[k].normal.to_angle()) < 1e-12);
    }
    let star_hole = points(&[(-30., -30.), (0., -10.), (30., -30.), (0., 30.)]);
    let model = Model::polygon("part", &square(-50., 50.), &[star_hole], &[], 0., 0.).unwrap();
    let convex = model.vertices.iter().find(|v| v.point == dvec2(0., -10.)).unwrap();
    assert!(convex.normals.is_some(), "a corner that juts into the hole is convex");
}

#[test]
fn the_size_is_the_largest_distance() {
    assert!((polygon(&square(0., 30.)).size - 30.0 * 2.0_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn what_can_not_be_mended_is_refused_with_the_reason() {
    let outer = square(0., 30.);
    let bow = points(&[(0., 0.), (10., 10.), (10., 0.), (0., 10.)]);
    let touching = points(&[(0., 0.), (20., 0.), (20., 10.), (10., 0.), (0., 10.)]);
    let spike = points(&[(0., 0.), (20., 0.), (20., 10.), (20., 30.), (20., 10.), (0., 10.)]);
    let cases: Vec<Refused> = vec![
        (points(&[(0., 0.), (1., 0.)]), vec![], "vertices: has fewer than three points (got 2 points)"),
        (points(&[(0., 0.), (1., 0.), (2., 0.)]), vec![], "has no area"),
        (points(&[(0., 0.), (1., 0.), (0., 0.), (1., 0.)]), vec![], "has no area"),
        (points(&[(3., 3.), (3., 3.), (3., 3.)]), vec![], "has no extent"),
        (points(&[(0., 0.), (1., f64::NAN), (2., 5.)]), vec![], "not finite (got (1, NaN))"),
        (points(&[(1e9, 0.), (1e9 + 1., 0.), (1e9, 1.)]), vec![], "from the origin"),
        (points(&[(0., 0.), (1e200, 0.), (0., 1e200)]), vec![], "its size must be"),
        (bow, vec![], "vertices: crosses or touches itself: faces 0 and 2"),
        (touching, vec![], "crosses or touches itself: faces 0 and 3"),
        (spike, vec![], "turns back on itself where face 3 begins"),
        (outer.clone(), vec![square(40., 50.)], "holes[0]: lies outside"),
        (outer.clone(), vec![square(-10., 50.)], "holes[0]: lies outside"),
        (outer.clone(), vec![square(20., 40.)], "holes[0]: crosses or touches vertices"),
        (outer.clone(), vec![square(0., 10.)], "holes[0]: crosses or touches vertices"),
        (outer.clone(), vec![square(5., 15.), square(10., 20.)], "holes[1]: crosses or touches holes[0]"),
        (outer.clone(), vec![square(5., 15.), square(5., 15.)], "holes[1]: crosses or touches holes[0]"),
        (outer.clone(), vec![square(5., 15.), square(6., 7.)], "holes[1]: lies inside holes[0]"),
        (outer.clone(), vec![square(6., 7.), square(5., 15.)], "holes[0]: lies inside holes[1]"),
        (outer, vec![vec![]], "holes[0]: has fewer than three points"),
    ];
    for (vertices, holes, expected) in cases {
        let message = refusal(&vertices, &holes);
        assert!(message.contains(expected), "{message}\nlacks {expected}");
        assert!(!message.contains('\n'));
    }
}

#[test]
fn attributes_out_of_range_are_refused() {
    let outer = square(0., 30.);
    let make = |name: &str, blind: &[usize], position_slack: f64, normal_slack: f64| {
        Model::polygon(name, &outer, &[], blind, position_slack, normal_slack).expect_err("refused").argument
    };
    assert_eq!(make(" ", &[], 0., 0.), "name");
    assert_eq!(make("part", &[4], 0., 0.), "untouchable");
    for slack in [-1e-9, f64::NAN, f64::INFINITY] {
        assert_eq!(make("part", &[], slack, 0.), "position_slack");
        assert_eq!(make("part", &[], 0., slack), "normal_slack");
    }
    assert_eq!(make("part", &[], 0., FRAC_PI_2), "normal_slack");
    let lines = [[DVec2::ZERO, dvec2(1., 0.)]];
    let make = |seams: &[usize], blind: &[usize]| {
        Model::segments("part", &lines, seams, blind, 0., 0.).expect_err("refused").to_string()
    };
    assert!(make(&[1], &[]).starts_with("seams: there is no face of this number among 1 (got 1)"));
    assert!(make(&[0], &[0]).starts_with("untouchable: a face can't be both"));
    assert!(make(&[0], &[]).starts_with("segments: has no face"));
    assert!(Model::segments("part", &[], &[], &[], 0., 0.).is_err());
}

#[test]
fn loose_faces_meet_in_vertices() {
    let [a, b, c, d] = [dvec2(0., 0.), dvec2(20., 0.), dvec2(20., 10.), dvec2(40., 10.)];
    let near_b = b + dvec2(1e-9, 0.0);
    let model = Model::segments("steps", &[[a, b], [near_b, c], [c, d]], &[], &[], 0., 0.).unwrap();
    assert!(!model.closed);
    assert_eq!(corners(&model), [a, b, c, d]);
    let touchable: Vec<bool> = model.vertices.iter().map(|v| v.normals.is_some()).collect();
    assert_eq!(touchable, [false, true, false, false]);
    // A third face there, a neighbour that can't be touched, or a seam in its place: no corner to touch.
    let blocked = Model::segments("steps", &[[a, b], [b, c], [b, d]], &[], &[], 0., 0.).unwrap();
    assert!(blocked.vertices[1].normals.is_none());
    let blind = Model::segments("steps", &[[a, b], [b, c]], &[], &[1], 0., 0.).unwrap();
    assert!(blind.vertices[1].normals.is_none());
    let seamed = Model::segments("steps", &[[a, b], [b, c], [c, d]], &[2], &[], 0., 0.).unwrap();
    assert_eq!((seamed.faces.len(), seamed.vertices.len()), (3, 3));
    let beside_seam = Model::segments("steps", &[[a, b], [b, c], [b, d]], &[2], &[], 0., 0.).unwrap();
    assert!(beside_seam.vertices[1].normals.is_some(), "a seam is not there");
}

#[test]
fn a_plate_without_thickness_has_round_ends() {
    let (a, b) = (dvec2(0., 0.), dvec2(20., 0.));
    let model = Model::segments("plate", &[[a, b], [b, a]], &[], &[], 0., 0.).unwrap();
    for (vertex, outward) in model.vertices.iter().zip([PI, 0.0]) {
        let normals = vertex.normals.expect("both sides can be touched");
        assert!((normals.width - PI).abs() < 1e-12 && normals.distance(outward) < 1e-12);
        assert!((normals.middle() - outward).cos() > 1.0 - 1e-12);
    }
    assert_eq!(model.symmetries.len(), 2);
}

#[test]
fn loose_faces_without_length_and_repeated_ones_are_dropped() {
    let (a, b) = (dvec2(0., 0.), dvec2(20., 0.));
    let model = Model::segments("part", &[[a, b], [b, b], [a, b], [b, a]], &[], &[3], 0., 0.).unwrap();
    assert_eq!((model.faces.len(), model.mends.len()), (2, 2));
    assert_eq!(model.faces[1].surface, Surface::Untouchable);
}
