//! Ambiguity trees: over synthetic relations against all trees there are, and on random problems.

mod common;
#[path = "common/parts.rs"]
mod parts;

use std::collections::BTreeSet;
use std::sync::Arc;

use common::{Noise, contacts, star, uniform};
use fastrand::Rng;
use glam::{DVec2, dvec2};
use palpate::ambiguity::{Optimum, Relation, Set, plan_tree_until};
use palpate::plane::{Model, Pose};
use palpate::{
    AmbiguityTree, Answers, Contact, Evidence, Feature, Hypothesis, Normal, PlanSettings, Planner, Sensor,
    Settings, Status, TreeMethod, TreeSettings, judge, plan_tree, recognize, verification_path,
};

const POSITION_ERROR: f64 = 0.5;
const NORMAL_ERROR: f64 = 0.07;

/// A relation as a matrix: which are not separated, and which make the line unusable.
struct Matrix {
    left: Vec<Vec<bool>>,
    faults: Vec<bool>,
}

impl Matrix {
    /// With some probability two are not separated; some may all be missed, so that none of these are.
    fn random(random: &mut Rng, n: usize) -> Self {
        let density = random.f64();
        let missed: Vec<bool> = (0..n).map(|_| random.u8(0..3) == 0).collect();
        let faulty = random.u8(0..3) == 0;
        let faults = (0..n).map(|_| faulty && random.u8(0..4) == 0).collect();
        let mut left = vec![vec![false; n]; n];
        for k in 0..n {
            for j in 0..k {
                let one = random.f64() < density || (missed[k] && missed[j]);
                (left[k][j], left[j][k]) = (one, one);
            }
        }
        Self { left, faults }
    }

    fn relation(&self) -> Relation {
        let set = |row: &Vec<bool>| row.iter().enumerate().map(|(k, one)| Set::from(*one) << k).sum::<Set>();
        Relation::new(set(&self.faults), &self.left.iter().map(set).collect::<Vec<_>>())
    }

    /// Its classes among some, by joining labels until nothing changes.
    fn classes(&self, members: &[usize]) -> Option<Vec<Vec<usize>>> {
        if members.iter().any(|k| self.faults[*k]) {
            return None;
        }
        let mut label: Vec<usize> = (0..self.left.len()).collect();
        for _ in members {
            for &k in members {
                for &j in members {
                    if self.left[k][j] {
                        let least = label[k].min(label[j]);
                        (label[k], label[j]) = (least, least);
                    }
                }
            }
        }
        let labels: BTreeSet<usize> = members.iter().map(|k| label[*k]).collect();
        Some(
            labels
                .into_iter()
                .map(|one| members.iter().copied().filter(|k| label[*k] == one).collect())
                .collect(),
        )
    }
}

/// Summed and worst touches of every tree there is, those that stop early included.
fn all_trees(pool: &[Matrix], members: &[usize]) -> BTreeSet<(usize, usize)> {
    let n = members.len();
    let mut all = BTreeSet::from([(n * (n - 1), n - 1)]);
    for classes in
        pool.iter().filter_map(|matrix| matrix.classes(members)).filter(|classes| classes.len() > 1)
    {
        let mut some = BTreeSet::from([(n, 0)]);
        for class in &classes {
            let below = all_trees(pool, class);
            some = some
                .iter()
                .flat_map(|(sum, worst)| below.iter().map(move |one| (sum + one.0, one.1.max(*worst))))
                .collect();
        }
        all.extend(some.into_iter().map(|(sum, worst)| (sum, worst + 1)));
    }
    all
}

#[test]
fn the_best_tree_is_the_best_of_all() {
    let mut random = Rng::with_seed(1);
    for _ in 0..4_000 {
        let n = random.usize(1..6);
        let count = random.usize(0..6);
        let pool: Vec<Matrix> = (0..count).map(|_| Matrix::random(&mut random, n)).collect();
        let relations: Vec<Relation> = pool.iter().map(Matrix::relation).collect();
        let value = Optimum::new(n, &relations).value((1 << n) - 1);
        let everyone: Vec<usize> = (0..n).collect();
        let best = *all_trees(&pool, &everyone).first().expect("one that stops at once");
        assert_eq!((value.touches, value.worst), best, "of {n} hypotheses with {relations:?}");
    }
}

#[test]
fn dominated_relations_are_not_needed_and_bounds_hold() {
    let mut random = Rng::with_seed(2);
    for _ in 0..1_000 {
        let n = random.usize(2..9);
        let relations: Vec<Relation> = (0..12).map(|_| Matrix::random(&mut random, n).relation()).collect();
        let dominated = |k: usize| {
            let by = |j: usize| {
                relations[j].dominates(&relations[k]) && (j < k || !relations[k].dominates(&relations[j]))
            };
            (0..relations.len()).any(|j| j != k && by(j))
        };
        let fewer: Vec<Relation> =
            (0..relations.len()).filter(|k| !dominated(*k)).map(|k| relations[k].clone()).collect();
        let root = (1 << n) - 1;
        let value = Optimum::new(n, &relations).value(root);
        let other = Optimum::new(n, &fewer).value(root);
        assert_eq!((value.touches, value.worst), (other.touches, other.worst));
        let most = relations.iter().map(Relation::most_outcomes).max().expect("a dozen").max(2);
        let expected = value.touches as f64 / n as f64;
        assert!(
            expected >= (n as f64).ln() / (most as f64).ln() - 1e-12,
            "{expected} of {n} with {most} outcomes"
        );
        assert!(most.pow(value.worst as u32) >= n);
    }
}

#[test]
fn most_outcomes_is_over_all_subsets() {
    let mut random = Rng::with_seed(3);
    for _ in 0..1_000 {
        let n = random.usize(1..8);
        let relation = Matrix::random(&mut random, n).relation();
        let classes = (0..1 << n).filter_map(|subset| relation.classes(subset)).map(|classes| classes.len());
        assert_eq!(relation.most_outcomes(), classes.max().expect("the empty set"));
    }
}

fn sensor() -> Sensor {
    Sensor::new(POSITION_ERROR, Some(NORMAL_ERROR), 60_f64.to_radians()).expect("bounds are valid")
}

fn settings() -> PlanSettings {
    PlanSettings { effort: 3_000, ..PlanSettings::default() }
}

fn tree(hypotheses: &[Hypothesis], method: TreeMethod) -> AmbiguityTree {
    let tree_settings = TreeSettings { method, ..TreeSettings::default() };
    plan_tree(hypotheses, &sensor(), &settings(), &tree_settings).expect("hypotheses")
}

/// From two or three contacts on one of some parts; 2 to 10 hypotheses.
fn problem(seed: u64) -> Vec<Hypothesis> {
    let mut random = Rng::with_seed(seed);
    let noise = Noise { position_error: POSITION_ERROR, normal_error: Some(NORMAL_ERROR), tip_radius: 0.0 };
    let objects: Vec<Arc<Model>> = parts::OBJECTS.map(parts::part).into_iter().collect();
    loop {
        let models =
            if random.bool() { objects.clone() } else { (5..8).map(|k| star(&mut random, k)).collect() };
        let truth = models[random.usize(0..models.len())].clone();
        let problem = contacts(&mut random, truth, 2, &noise);
        let found =
            recognize(&models, &problem.evidence, &Settings::default()).expect("well-formed").hypotheses;
        if (2..=10).contains(&found.len()) {
            return found;
        }
    }
}

/// Touches until a hypothesis is identified, found by going down the tree.
fn touches(tree: &AmbiguityTree, hypothesis: usize) -> usize {
    let (mut node, mut count) = (tree.root(), 0);
    loop {
        let next: Vec<usize> = node
            .branches
            .iter()
            .filter(|branch| branch.members.contains(&hypothesis))
            .map(|branch| branch.node.expect("it has members"))
            .collect();
        match next[..] {
            [one] => node = &tree.nodes[one],
            _ => return count + node.members.len() - 1,
        }
        count += 1;
    }
}

fn check_tree(hypotheses: &[Hypothesis], tree: &AmbiguityTree) {
    let n = hypotheses.len();
    for node in &tree.nodes {
        let divided = node.status == Status::Divided;
        assert_eq!(node.path.is_some(), divided);
        assert_eq!(node.status == Status::Solved, node.members.len() == 1);
        if !divided {
            assert!(node.branches.is_empty());
            continue;
        }
        let mut members: Vec<usize> =
            node.branches.iter().flat_map(|branch| branch.members.clone()).collect();
        members.sort_unstable();
        assert_eq!(members, node.members, "each in one branch");
        check_branches(hypotheses, tree, node);
    }
    let all: Vec<usize> = (0..n).map(|k| touches(tree, k)).collect();
    let expected = all.iter().sum::<usize>() as f64 / n as f64;
    assert!((tree.expected_touches - expected).abs() < 1e-12);
    assert_eq!(Some(&tree.worst_touches), all.iter().max());
    assert!(tree.entropy_bound <= tree.expected_touches + 1e-12 && tree.worst_bound <= tree.worst_touches);
    assert!(tree.lower_bound <= tree.expected_touches);
    let num_solved = tree.nodes.iter().filter(|node| node.status == Status::Solved).count();
    assert_eq!(tree.identified.iter().sum::<usize>(), num_solved);
    assert_eq!(tree.identified.len(), tree.depth() + 1);
    assert_eq!(tree.solved(), num_solved == n);
    let text = tree.to_text();
    assert!((0..n).all(|k| text.contains(&format!("I{} {}", k + 1, hypotheses[k].model.name))), "{text}");
}

/// Judged anew, without the others, the path has the same classes; a miss leads to one of them at most.
fn check_branches(hypotheses: &[Hypothesis], tree: &AmbiguityTree, node: &palpate::Node) {
    let path = node.path.as_ref().expect("divided");
    let some: Vec<Hypothesis> = node.members.iter().map(|k| hypotheses[*k].clone()).collect();
    let again = judge(&some, &sensor(), path.line, None, &settings()).expect("a line");
    assert_eq!(again.fault, None);
    assert_eq!(again.classes, path.classes);
    let misses = |answers| matches!(answers, Answers::NoContact | Answers::Either);
    let missed: Vec<_> = node.branches.iter().filter(|branch| misses(branch.answers)).collect();
    assert!(missed.len() <= 1);
    for place in &again.no_contact {
        assert!(missed[0].members.contains(&node.members[*place]));
    }
    let unexpected = node.branches.iter().filter(|branch| branch.answers == Answers::Unexpected);
    assert_eq!(unexpected.count(), 1);
    for next in node.branches.iter().filter_map(|branch| branch.node.map(|next| (branch, next))) {
        assert_eq!(next.0.members, tree.nodes[next.1].members);
        assert_eq!(tree.nodes[next.1].level, node.level + 1);
    }
}

#[test]
fn trees_of_random_problems() {
    let (mut num_solved, mut num_deep) = (0, 0);
    for seed in 0..24 {
        let hypotheses = problem(seed);
        let greedy = tree(&hypotheses, TreeMethod::Greedy);
        let optimal = tree(&hypotheses, TreeMethod::Optimal);
        let ahead = tree(&hypotheses, TreeMethod::Ahead);
        check_tree(&hypotheses, &greedy);
        check_tree(&hypotheses, &ahead);
        check_tree(&hypotheses, &optimal);
        let order = |tree: &AmbiguityTree| (tree.expected_touches * 1e6, tree.worst_touches);
        assert!(order(&optimal) <= order(&greedy), "seed {seed}: {} {}", optimal.to_text(), greedy.to_text());
        assert!(order(&ahead) <= order(&greedy));
        assert!(optimal.entropy_bound <= optimal.expected_touches + 1e-12);
        num_solved += usize::from(optimal.solved());
        num_deep += usize::from(greedy.worst_touches > 1);
        if seed % 8 == 0 {
            assert_eq!(greedy, tree(&hypotheses, TreeMethod::Greedy));
            assert_eq!(ahead, tree(&hypotheses, TreeMethod::Ahead));
            assert_eq!(optimal, tree(&hypotheses, TreeMethod::Optimal));
        }
    }
    assert!(num_solved > 12 && num_deep > 0, "{num_solved} solved, {num_deep} need more than one touch");
}

/// What is proved of the first path bounds every tree of paths with margin.
#[test]
fn no_tree_is_below_the_bound() {
    let settings = PlanSettings { planner: Planner::Complete, margin: 0.02, ..PlanSettings::default() };
    let mut num_told = 0;
    for hypotheses in (0..24).map(problem).filter(|some| tree(some, TreeMethod::Greedy).worst_touches > 1) {
        let plan = |method| {
            let tree_settings = TreeSettings { method, ..TreeSettings::default() };
            plan_tree(&hypotheses, &sensor(), &settings, &tree_settings).expect("hypotheses")
        };
        let (greedy, optimal) = (plan(TreeMethod::Greedy), plan(TreeMethod::Optimal));
        let size = hypotheses.iter().map(|one| one.model.size).fold(0.0, f64::max);
        let margin = optimal.root().path.as_ref().map_or(0.0, |path| path.margin);
        if margin >= settings.margin * size {
            assert!(greedy.lower_bound <= optimal.expected_touches, "{}", optimal.to_text());
            num_told += usize::from(greedy.lower_bound > 1.0);
        }
    }
    assert!(num_told > 0);
}

#[test]
fn a_tree_stopped_early_says_so() {
    let hypotheses =
        (0..40).map(problem).find(|some| tree(some, TreeMethod::Greedy).depth() > 1).expect("a few are");
    let mut before = f64::INFINITY;
    let full = tree(&hypotheses, TreeMethod::Greedy);
    for max_nodes in 0..=full.num_nodes() {
        let tree_settings = TreeSettings { max_nodes, ..TreeSettings::default() };
        let part = plan_tree(&hypotheses, &sensor(), &settings(), &tree_settings).expect("hypotheses");
        check_tree(&hypotheses, &part);
        let num_planned = part.nodes.iter().filter(|node| node.status == Status::Divided).count();
        assert!(num_planned <= max_nodes && part.expected_touches <= before);
        before = part.expected_touches;
    }
    assert_eq!(before, full.expected_touches);
    let late = plan_tree_until(&hypotheses, &sensor(), &settings(), &TreeSettings::default(), &|| true);
    let late = late.expect("hypotheses");
    assert_eq!(late.root().status, Status::Unexpanded);
    assert_eq!(late.worst_touches, hypotheses.len() - 1);
}

/// Contacts in the middle of some faces of a part where it was drawn.
fn touched(model: &Model, faces: &[usize]) -> Evidence {
    let mut evidence = Evidence::default();
    for face in faces.iter().map(|k| &model.faces[*k]) {
        let normal = Normal::new(face.normal, NORMAL_ERROR).expect("bounds are valid");
        let middle = face.start.midpoint(face.end);
        let contact = Contact::new(middle, 0.0, POSITION_ERROR).expect("bounds are valid");
        evidence.contacts.push(contact.with_normal(normal));
    }
    evidence
}

fn house() -> Arc<Model> {
    let corners =
        [dvec2(0.0, 0.0), dvec2(100.0, 0.0), dvec2(100.0, 70.0), dvec2(40.0, 110.0), dvec2(0.0, 70.0)];
    Arc::new(Model::polygon("house", &corners, &[], &[], 0.0, 0.0).expect("an outline"))
}

#[test]
fn what_can_not_be_told_apart_is_one_leaf() {
    let models = [house(), house()];
    let found =
        recognize(&models, &touched(&house(), &[0, 1, 2]), &Settings::default()).expect("well-formed");
    assert_eq!(found.hypotheses.len(), 2);
    for method in [TreeMethod::Greedy, TreeMethod::Ahead, TreeMethod::Optimal] {
        let settings = PlanSettings { margin: 0.01, ..PlanSettings::default() };
        let tree_settings = TreeSettings { method, ..TreeSettings::default() };
        let tree = plan_tree(&found.hypotheses, &sensor(), &settings, &tree_settings).expect("hypotheses");
        assert_eq!(tree.root().status, Status::Inseparable);
        assert_eq!((tree.expected_touches, tree.worst_touches, tree.lower_bound), (1.0, 1, 1.0));
        assert!(!tree.solved());
    }
}

#[test]
fn one_hypothesis_needs_no_touch() {
    let found =
        recognize(&[house()], &touched(&house(), &[0, 1, 2]), &Settings::default()).expect("well-formed");
    assert_eq!(found.hypotheses.len(), 1);
    for method in [TreeMethod::Greedy, TreeMethod::Ahead, TreeMethod::Optimal] {
        let tree = tree(&found.hypotheses, method);
        check_tree(&found.hypotheses, &tree);
        assert_eq!((tree.expected_touches, tree.entropy_bound, tree.worst_bound), (0.0, 0.0, 0));
    }
    assert!(plan_tree(&[], &sensor(), &settings(), &TreeSettings::default()).is_err());
}

#[test]
fn a_verification_path_touches_something_new() {
    let model = house();
    let found =
        recognize(&[house()], &touched(&model, &[0, 1, 2]), &Settings::default()).expect("well-formed");
    let hypothesis = &found.hypotheses[0];
    let path = verification_path(hypothesis, &sensor(), &settings())
        .expect("well-formed")
        .expect("two faces are left");
    assert!(path.margin > 1.0 && path.no_contact.is_empty() && path.fault.is_none());
    assert!(path.outcomes[0].touches.iter().all(|touch| [3, 4].map(Feature::Face).contains(&touch.feature)));
    for pose in hypothesis.poses.sample(50, 0) {
        let depths = (0..5).filter_map(|k| crossing(&model, pose, k, path.line.start, path.line.direction));
        let (_, first) = depths.min_by(|a, b| a.0.total_cmp(&b.0)).expect("it is not missed");
        assert!(first == 3 || first == 4);
    }
    let all =
        recognize(&[house()], &touched(&model, &[0, 1, 2, 3, 4]), &Settings::default()).expect("well-formed");
    let none = verification_path(&all.hypotheses[0], &sensor(), &settings()).expect("well-formed");
    assert_eq!(none, None, "every face has been touched");
}

/// Where a line crosses a face, and which face it was.
fn crossing(model: &Model, pose: Pose, face: usize, start: DVec2, direction: DVec2) -> Option<(f64, usize)> {
    let [a, b] = [model.faces[face].start, model.faces[face].end].map(|end| pose.apply(end) - start);
    let (left, right) = (direction.perp_dot(a), direction.perp_dot(b));
    (left * right < 0.0).then(|| (direction.dot(a.lerp(b, left / (left - right))), face))
}

/// Any reading of any pose leads down the branch of its hypothesis, whatever the errors within their bounds.
#[test]
fn readings_lead_down_their_branches() {
    let mut random = Rng::with_seed(4);
    let mut count = 0;
    for seed in 100..115 {
        let hypotheses = problem(seed);
        let tree = tree(&hypotheses, TreeMethod::Ahead);
        for (k, hypothesis) in hypotheses.iter().enumerate() {
            for pose in hypothesis.poses.sample(30, seed) {
                count += follow(&tree, hypothesis, k, pose, &mut random);
            }
        }
    }
    assert!(count > 1_500, "{count} readings");
}

fn follow(
    tree: &AmbiguityTree,
    hypothesis: &Hypothesis,
    number: usize,
    pose: Pose,
    random: &mut Rng,
) -> usize {
    let (mut node, mut count) = (tree.root(), 0);
    while let Some(path) = &node.path {
        let model = &hypothesis.model;
        let (start, direction) = (path.line.start, path.line.direction);
        let crossings =
            (0..model.faces.len()).filter_map(|face| crossing(model, pose, face, start, direction));
        let reading = crossings.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(depth, face)| {
            let mut signed = |bound: f64| bound * (1.0 - 1e-9) * uniform(random, -1.5, 1.5).clamp(-1.0, 1.0);
            let turn = DVec2::from_angle(signed(NORMAL_ERROR));
            let shift = signed(POSITION_ERROR) * DVec2::from_angle(uniform(random, 0.0, 7.0));
            let normal = turn.rotate(pose.rotation.rotate(model.faces[face].normal));
            path.reading(path.line.at(depth) + shift, Some(normal))
        });
        let left: Vec<usize> = path.outcome_of(reading).iter().map(|place| node.members[*place]).collect();
        let branch =
            node.branches.iter().find(|branch| branch.members.contains(&number)).expect("it is in one");
        assert!(left.contains(&number), "the truth is kept");
        assert!(left.iter().all(|one| branch.members.contains(one)), "nothing else is");
        node = &tree.nodes[branch.node.expect("it has members")];
        count += 1;
    }
    count
}
