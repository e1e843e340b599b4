//! Laws of pair tables: nothing true is outside a range, and ranges are no wider than they must be.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use glam::DVec3;

use super::model::Model;
use super::quantized::Quantizer;
use super::sensed::Sensed;
use super::tables::{FeatureTables, Kinds};
use super::test_solids::{Random, ball, frame, hulls, l_prism, normals, random_solid, regular_prism, touch};
use crate::recognize::Halt;
use crate::tree::{Counters, FeaturePairs, PairRange, Range, search};

const ALL: Kinds = Kinds { faces: true, edges: true, vertices: true };

/// By sine and cosine: not what the tables use.
fn angle_between(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

fn holds(range: Range, value: f64) -> bool {
    range.low <= value && value <= range.high
}

fn encloses(outer: &PairRange, inner: &PairRange) -> bool {
    let ranges = |pair: &PairRange| [pair.distance, pair.angle, pair.direction, pair.direction_back];
    ranges(outer)
        .iter()
        .zip(ranges(inner))
        .all(|(outer, inner)| outer.low <= inner.low && inner.high <= outer.high)
}

/// The ranges of a pair in all the ways in which they are had: exact, from what bounds them, stored.
fn ways(tables: &FeatureTables, first: usize, second: usize) -> [PairRange; 3] {
    [tables.exact(first, second), tables.bounded(first, second), tables.pair(first, second)]
}

#[test]
fn what_two_features_can_have_is_inside_their_ranges() {
    let mut random = Random(1);
    for _ in 0..300 {
        let model = random_solid(&mut random);
        let tables = FeatureTables::new(&model, ALL);
        let features = tables.features();
        for _ in 0..60 {
            let [i, j] = [0; 2].map(|_| random.below(features.len()));
            let known = ways(&tables, i, j);
            assert!(encloses(&known[2], &known[0]), "stored {known:?}");
            for _ in 0..40 {
                let (x, n) = touch(&mut random, &model, features[i]);
                let (y, m) = touch(&mut random, &model, features[j]);
                for range in &known {
                    assert!(holds(range.distance, x.distance(y)), "{range:?}");
                    assert!(holds(range.angle, angle_between(n, m)), "{range:?} {}", angle_between(n, m));
                    assert!(holds(range.direction, n.dot(y - x)), "{range:?}");
                    assert!(holds(range.direction_back, m.dot(x - y)), "{range:?}");
                }
            }
        }
    }
}

/// The distance between two convex sets: weights of the corners are moved from one to another, each time by the best
/// amount, again and again; from the nearest corners, since between faces at a sharp angle that takes long.
fn apart(sets: [&[DVec3]; 2]) -> f64 {
    let corners = || (0..sets[0].len()).flat_map(|k| (0..sets[1].len()).map(move |l| [k, l]));
    let between = |[k, l]: &[usize; 2]| sets[0][*k].distance(sets[1][*l]);
    let start = corners().min_by(|a, b| between(a).total_cmp(&between(b))).expect("corners");
    let mut weights =
        [0, 1].map(|k| (0..sets[k].len()).map(|l| f64::from(u8::from(l == start[k]))).collect::<Vec<f64>>());
    let place = |weights: &[Vec<f64>; 2], k: usize| -> DVec3 {
        weights[k].iter().zip(sets[k]).map(|(weight, corner)| *weight * *corner).sum()
    };
    for _ in 0..1000 {
        for k in 0..2 {
            for a in 0..sets[k].len() {
                for b in 0..a {
                    let offset = place(&weights, k) - place(&weights, 1 - k);
                    let along = sets[k][b] - sets[k][a];
                    let best = -offset.dot(along) / along.length_squared();
                    let moved = best.clamp(-weights[k][b], weights[k][a]);
                    weights[k][a] -= moved;
                    weights[k][b] += moved;
                }
            }
        }
    }
    place(&weights, 0).distance(place(&weights, 1))
}

/// The least of `cost` over points of two convex sets: weight is moved from one corner to another, by steps ever
/// smaller, from the best of many starts and some others.
fn least(random: &mut Random, sets: [&[DVec3]; 2], cost: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    let value = |at: &[Vec<f64>; 2]| {
        let [x, y] = [0, 1].map(|k| at[k].iter().zip(sets[k]).map(|(w, c)| *w * *c).sum());
        cost(x, y)
    };
    let pure = |k: usize, count: usize| (0..count).map(|l| f64::from(u8::from(k == l))).collect();
    let [many, few] = sets.map(|set| -> Vec<Vec<f64>> {
        let scattered: Vec<Vec<f64>> = (0..40).map(|_| random.shares(set.len())).collect();
        (0..set.len()).map(|k| pure(k, set.len())).chain(scattered).collect()
    });
    let mut starts: Vec<[Vec<f64>; 2]> =
        many.iter().flat_map(|x| few.iter().map(|y| [x.clone(), y.clone()])).collect();
    starts.sort_by(|a, b| value(a).total_cmp(&value(b)));
    let mut overall = f64::INFINITY;
    for mut at in starts.into_iter().step_by(100) {
        let (mut best, mut step) = (value(&at), 0.5);
        while step > 1e-6 {
            let mut better = false;
            for k in 0..2 {
                for a in 0..sets[k].len() {
                    for b in (0..sets[k].len()).filter(|b| *b != a) {
                        let mut next = at.clone();
                        let moved = next[k][a].min(step);
                        next[k][a] -= moved;
                        next[k][b] += moved;
                        let reached = value(&next);
                        if reached < best {
                            (at, best, better) = (next, reached, true);
                        }
                    }
                }
            }
            if !better {
                step *= 0.5;
            }
        }
        overall = overall.min(best);
    }
    overall
}

#[test]
fn ends_of_ranges_are_attained() {
    let mut random = Random(2);
    for _ in 0..100 {
        let model = random_solid(&mut random);
        let tables = FeatureTables::new(&model, ALL);
        let features = tables.features();
        for _ in 0..4 {
            let [i, j] = [0; 2].map(|_| random.below(features.len()));
            let known = tables.exact(i, j);
            let [first, second] = [i, j].map(|k| hulls(&model, features[k]));
            let cones = [i, j].map(|k| normals(&model, features[k]));
            let pairs = || first.iter().flat_map(|a| second.iter().map(move |b| (a, b)));
            let corners =
                || pairs().flat_map(|(a, b)| a.iter().flat_map(move |x| b.iter().map(move |y| *y - *x)));

            let nearest = pairs().map(|(a, b)| apart([a, b])).fold(f64::INFINITY, f64::min);
            assert!(nearest >= known.distance.low, "{nearest} {known:?}");
            assert!(nearest - known.distance.low <= 1e-3 * model.size, "{nearest} {known:?}");
            let furthest = corners().map(DVec3::length).fold(0.0, f64::max);
            assert!((furthest - known.distance.high).abs() <= 1e-9 * model.size, "{furthest} {known:?}");

            for (sign, end) in [(1.0, known.angle.low), (-1.0, known.angle.high)] {
                let angle = least(&mut random, [&cones[0], &cones[1]], |n, m| sign * angle_between(n, m));
                assert!(
                    (sign * angle - end).abs() <= 5e-3,
                    "{angle} {known:?} {cones:?} {:?} {:?}",
                    features[i],
                    features[j]
                );
            }
            for (sign, end) in [(1.0, known.direction.low), (-1.0, known.direction.high)] {
                let offsets: Vec<DVec3> = corners().collect();
                let along = |n: DVec3, _| {
                    let n = n.normalize_or_zero();
                    offsets.iter().map(|offset| sign * n.dot(*offset)).fold(f64::INFINITY, f64::min)
                };
                let value = sign * least(&mut random, [&cones[0], &[DVec3::ZERO]], along);
                assert!((value - end).abs() <= 2e-3 * model.size, "{value} {end} {known:?}");
            }
        }
    }
}

#[test]
fn a_feature_and_itself() {
    for model in [l_prism(), frame(), regular_prism(5, 10.0, 7.0)] {
        let tables = FeatureTables::new(&model, ALL);
        for (number, feature) in tables.features().iter().enumerate() {
            assert_eq!(tables.feature(number), *feature);
            let own = tables.pair(number, number);
            assert_eq!((own.distance.low, own.angle.low), (0.0, 0.0));
            if feature.kind() == "face" {
                assert!(own.angle.high < 1e-4 && own.direction.high < 2e-4 * model.size, "{own:?}");
            }
        }
    }
}

#[test]
fn distances_known_by_eye() {
    let model = frame();
    let faces = Kinds { edges: false, vertices: false, ..ALL };
    let tables = FeatureTables::new(&model, faces);
    // Faces 0 and 1 are the two levels, 2..6 the outer sides from y = 0 on, 6.. those of the hole.
    let least = |i, j| tables.exact(i, j).distance.low;
    assert!((least(0, 1) - 9.0).abs() < 1e-4, "an interior point is nearest");
    assert_eq!(least(0, 2), 0.0, "they share an edge");
    assert!((least(2, 4) - 30.0).abs() < 1e-4);
    let inner: Vec<f64> = (6..10).map(|k| least(2, k)).collect();
    assert!(inner.iter().any(|gap| (gap - 8.0).abs() < 1e-4), "{inner:?}");
    assert!(inner.iter().any(|gap| (gap - 20.0).abs() < 1e-4), "{inner:?}");
}

#[test]
fn a_side_through_a_face_and_a_corner_above_one() {
    use super::gap::Piece;
    use glam::dvec3;
    let floor = [(-4., -4.), (4., -4.), (4., 4.), (-4., 4.)].map(|(x, y)| dvec3(x, y, 0.));
    let floor = Piece::new(floor.to_vec(), DVec3::Z);
    let side = |a: DVec3, b: DVec3| Piece::new(vec![a, b], DVec3::ZERO);
    let through = side(dvec3(0., 0., -3.), dvec3(1., 1., 5.));
    assert_eq!(floor.distance(&through, 100.0), 0.0);
    assert_eq!(through.distance(&floor, 100.0), 0.0);
    let above = side(dvec3(0., 0., 1.), dvec3(0.5, 0., 5.));
    assert_eq!(floor.distance(&above, 100.0), 1.0);
    let beside = side(dvec3(7., 0., -3.), dvec3(7., 0., 5.));
    assert_eq!(beside.distance(&floor, 100.0), 3.0);
    assert_eq!(beside.distance(&floor, 2.0), 2.0, "never more than the bound");
}

#[test]
fn stored_ranges_hold_what_they_are_made_of_and_little_more() {
    let mut random = Random(3);
    for _ in 0..20_000 {
        let longest = 10.0_f64.powf(6.0 * random.next() - 3.0);
        let quantizer = Quantizer::new(longest);
        let mut range = |low: f64, high: f64| {
            let [a, b] = [0; 2].map(|_| match random.below(8) {
                0 => low,
                1 => high,
                _ => low + (high - low) * random.next(),
            });
            Range { low: a.min(b), high: a.max(b) }
        };
        let pair = PairRange {
            distance: range(0.0, longest),
            angle: range(0.0, PI),
            direction: range(-longest, longest),
            direction_back: range(-longest, longest),
        };
        let stored = quantizer.unpack(quantizer.pack(&pair));
        let (angle, length) = quantizer.steps();
        assert!(encloses(&stored, &pair), "{stored:?} {pair:?}");
        let wider = PairRange {
            distance: pair.distance.widened(1.001 * length),
            angle: pair.angle.widened(1.001 * angle),
            direction: pair.direction.widened(1.001 * length),
            direction_back: pair.direction_back.widened(1.001 * length),
        };
        assert!(encloses(&wider, &stored), "{stored:?} {pair:?}");
    }
}

#[test]
fn the_index_misses_nothing_and_leaves_most_out() {
    let mut random = Random(4);
    let mut models: Vec<Model> = (0..30).map(|_| random_solid(&mut random)).collect();
    models.extend([ball(3, 20.0), regular_prism(60, 20.0, 5.0)]);
    for model in &models {
        let tables = FeatureTables::new(model, ALL);
        let count = tables.features().len();
        for _ in 0..60 {
            let first = random.below(count);
            let low = (PI * random.next() - 0.2).max(0.0);
            let angle = Range { low, high: (low + 0.5 * random.next()).min(PI) };
            let near: Vec<usize> = tables.near_angle(first, angle).expect("a narrow range").collect();
            let again: Vec<usize> = tables.near_angle(first, angle).expect("a narrow range").collect();
            assert_eq!(near, again);
            let mut sorted = near.clone();
            sorted.sort_unstable();
            sorted.dedup();
            assert_eq!(sorted.len(), near.len(), "none comes twice");
            for second in 0..count {
                let meets = tables.pair(first, second).angle.meets(angle);
                assert!(!meets || sorted.binary_search(&second).is_ok(), "{first} {second} {angle:?}");
            }
        }
    }
    let faces = Kinds { edges: false, vertices: false, ..ALL };
    let ball = ball(3, 20.0);
    let tables = FeatureTables::new(&ball, faces);
    let narrow = Range { low: 1.0, high: 1.05 };
    let visited: usize = (0..512).map(|k| tables.near_angle(k, narrow).expect("narrow").count()).sum();
    assert!(visited < 512 * 512 / 4, "{visited} of {}", 512 * 512);
    assert!(tables.near_angle(0, Range { low: 0.0, high: PI }).is_none());
}

/// A direction at exactly this angle to another.
fn tilted(random: &mut Random, normal: DVec3, angle: f64) -> DVec3 {
    let across = random.direction().cross(normal).normalize_or_zero();
    angle.cos() * normal + angle.sin() * across
}

/// A part, features that are touched, and what is sensed of them with errors at their bounds.
fn touched(random: &mut Random, model: &Model, tables: &FeatureTables) -> (Vec<usize>, Vec<Sensed>) {
    let features = tables.features();
    let pose = random.pose();
    let count = 2 + random.below(4);
    let chosen: Vec<usize> = (0..count).map(|_| random.below(features.len())).collect();
    let sensed = chosen.iter().map(|&number| {
        let (point, normal) = touch(random, model, features[number]);
        let bound = 3.0 * random.next().powi(3);
        let angle = PI * random.next().powi(4);
        let point = pose.apply(point) + bound * random.direction();
        let normal = pose.rotation * normal;
        let known = (random.below(5) > 0).then(|| (tilted(random, normal, angle), angle));
        Sensed { point, bound, normal: known }
    });
    let sensed = sensed.collect();
    (chosen, sensed)
}

#[test]
fn a_true_assignment_is_never_pruned() {
    let mut random = Random(5);
    for _ in 0..500 {
        let model = random_solid(&mut random);
        let tables = FeatureTables::new(&model, ALL);
        for _ in 0..20 {
            let (chosen, sensed) = touched(&mut random, &model, &tables);
            let candidates = chosen.iter().map(|number| vec![*number]).collect();
            let contacts = tables.contact_pairs(&sensed, candidates);
            let mut counters = Counters::default();
            let found = search(&tables, &contacts, u64::MAX, &Halt::default(), &mut counters, &mut |_| {
                ControlFlow::Break(())
            });
            assert!(found.is_break(), "stored: {counters:?} {chosen:?}");
            let found =
                search(&Bounded(&tables), &contacts, u64::MAX, &Halt::default(), &mut counters, &mut |_| {
                    ControlFlow::Break(())
                });
            assert!(found.is_break(), "bounded: {counters:?} {chosen:?}");
        }
    }
}

/// Tables that store nothing, as those of large models.
struct Bounded<'a>(&'a FeatureTables);

impl FeaturePairs for Bounded<'_> {
    fn pair(&self, first: usize, second: usize) -> PairRange {
        self.0.bounded(first, second)
    }

    fn near_angle(&self, first: usize, angle: Range) -> Option<impl Iterator<Item = usize>> {
        self.0.near_angle(first, angle)
    }
}

#[test]
fn the_search_finds_the_truth_among_all_and_prunes_the_most() {
    let mut random = Random(6);
    let mut share = 0.0;
    for _ in 0..60 {
        let model = random_solid(&mut random);
        let tables = FeatureTables::new(&model, ALL);
        let features = tables.features();
        let pose = random.pose();
        let chosen = [0; 3].map(|_| random.below(features.len()));
        let sensed = chosen.map(|number| {
            let (point, normal) = touch(&mut random, &model, features[number]);
            let normal = tilted(&mut random, pose.rotation * normal, 0.02);
            Sensed {
                point: pose.apply(point) + 0.1 * random.direction(),
                bound: 0.1,
                normal: Some((normal, 0.02)),
            }
        });
        let all: Vec<usize> = (0..features.len()).collect();
        let contacts = tables.contact_pairs(&sensed, vec![all; 3]);
        let (mut counters, mut found) = (Counters::default(), false);
        let done = search(&tables, &contacts, u64::MAX, &Halt::default(), &mut counters, &mut |assignment| {
            found |= assignment == chosen;
            ControlFlow::Continue(())
        });
        assert!(done.is_continue() && found, "{chosen:?}");
        share += counters.feasible as f64 / (features.len() as f64).powi(3);
    }
    assert!(share / 60.0 < 0.1, "{}", share / 60.0);
}

#[test]
fn unknown_normals_restrict_nothing_but_distance() {
    let sensed = |x: f64| Sensed { point: DVec3::X * x, bound: 1.0, normal: None };
    let range = super::sensed::sensed_range(&sensed(0.0), &sensed(10.0));
    assert!(holds(range.distance, 8.0) && holds(range.distance, 12.0) && !holds(range.distance, 12.1));
    assert_eq!(range.angle, Range { low: 0.0, high: PI });
    assert_eq!(range.direction.low, f64::NEG_INFINITY);
}

/// Tables whose making is stopped hold what is true all the same, and are not kept for later.
#[test]
fn tables_that_are_stopped_are_not_kept() {
    let model = ball(2, 50.0);
    let stop = Halt::default();
    stop.store(true, std::sync::atomic::Ordering::Relaxed);
    let stopped = model.feature_tables_until(ALL, &stop);
    assert!(stopped.pairs.is_empty() && !stopped.features().is_empty());
    let tables = model.feature_tables(ALL);
    assert!(!tables.pairs.is_empty());
    let count = tables.features().len();
    for (i, j) in (0..count).map(|i| (i, (7 * i + 3) % count)) {
        let (cheap, exact) = (stopped.pair(i, j), tables.exact(i, j));
        let cheap = PairRange { distance: cheap.distance.widened(1e-5), ..cheap };
        assert!(encloses(&cheap, &exact), "{cheap:?} {exact:?}");
    }
    assert!(std::sync::Arc::ptr_eq(&tables, &model.feature_tables_until(ALL, &stop)), "made once");
}

#[test]
fn large_models_store_no_pairs() {
    let model = ball(5, 50.0);
    let tables = model.feature_tables(ALL);
    assert_eq!(tables.features().len(), 8192 + 12_288 + 4098);
    assert!(tables.pairs.is_empty());
    let mut random = Random(7);
    for _ in 0..2000 {
        let [i, j] = [0; 2].map(|_| random.below(tables.features().len()));
        let (cheap, exact) = (tables.pair(i, j), tables.exact(i, j));
        let cheap = PairRange { distance: cheap.distance.widened(1e-5), ..cheap };
        assert!(encloses(&cheap, &exact), "{cheap:?} {exact:?}");
    }
    assert!(model.tables_to_bytes(true, true, true).len() < 100);
}

#[test]
fn tables_come_back_from_bytes() {
    for number in 0..8 {
        let kinds = Kinds { faces: number & 1 > 0, edges: number & 2 > 0, vertices: number & 4 > 0 };
        let model = l_prism();
        let bytes = model.tables_to_bytes(kinds.faces, kinds.edges, kinds.vertices);
        let other = l_prism();
        let (read, tables) = FeatureTables::from_bytes(&other, &bytes).expect("the same model");
        assert_eq!((read, &tables.pairs), (kinds, &model.feature_tables(kinds).pairs));
        other.tables_from_bytes(&bytes).expect("the same model");
        for first in 0..tables.features().len() {
            for second in 0..tables.features().len() {
                assert_eq!(tables.pair(first, second), model.feature_tables(kinds).pair(first, second));
            }
        }
    }
}

#[test]
fn bytes_of_other_models_and_damaged_ones_are_refused() {
    let model = regular_prism(3, 10.0, 5.0);
    let bytes = model.tables_to_bytes(true, true, false);
    for other in [l_prism(), regular_prism(3, 10.0, 5.0 + 1e-12)] {
        assert!(other.tables_from_bytes(&bytes).expect_err("foreign").to_string().contains("another model"));
    }
    for length in 0..bytes.len() {
        assert!(model.tables_from_bytes(&bytes[..length]).is_err(), "cut at {length}");
    }
    for place in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x10;
        assert!(model.tables_from_bytes(&damaged).is_err(), "damaged at {place}");
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(model.tables_from_bytes(&longer).is_err());
    assert!(model.tables_from_bytes(b"solid cube").is_err());
}

#[test]
#[ignore = "measures time: cargo test --release -- --ignored --nocapture pair_tables_measured"]
#[expect(clippy::disallowed_methods, reason = "a measurement, not an answer")]
fn pair_tables_measured() {
    let faces = Kinds { edges: false, vertices: false, ..ALL };
    let models = [
        ("prism of 300 faces", regular_prism(298, 50.0, 20.0), faces),
        ("ball of 512 faces", ball(3, 50.0), faces),
        ("ball of 128 faces, all kinds", ball(2, 50.0), ALL),
        ("prism of 200 faces, all kinds", regular_prism(198, 50.0, 20.0), ALL),
        ("ball of 8,192 faces, all kinds", ball(5, 50.0), ALL),
    ];
    for (name, model, kinds) in models {
        let start = std::time::Instant::now();
        let tables = FeatureTables::new(&model, kinds);
        let built = start.elapsed();
        let count = tables.features().len();
        let mut random = Random(8);
        let pairs: Vec<[usize; 2]> = (0..100_000).map(|_| [0; 2].map(|_| random.below(count))).collect();
        let start = std::time::Instant::now();
        let sum: f64 = pairs.iter().map(|[i, j]| tables.pair(*i, *j).distance.low).sum();
        let each = start.elapsed().as_nanos() as f64 / pairs.len() as f64;
        let narrow = Range { low: 1.0, high: 1.1 };
        let start = std::time::Instant::now();
        let firsts = (0..count).step_by(count.div_ceil(300));
        let near: usize = firsts.clone().map(|k| tables.near_angle(k, narrow).expect("narrow").count()).sum();
        let index = start.elapsed().as_nanos() as f64 / firsts.len() as f64 / 1000.0;
        let near = near as f64 / firsts.len() as f64;
        println!(
            "{name}: {count} features, built in {built:?}, {each:.0} ns a pair, index {index:.1} µs for {near:.0} ({sum:.0})"
        );
    }
}
