//! All poses of an answer: a guaranteed enclosure in cells, and witnesses inside.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};
use std::sync::{Arc as Shared, OnceLock};

use glam::DVec2;

use super::arc::{Arc, wrap};
use super::case::{Case, PivotPose};
use super::cell::{Cell, Conditions};
use super::model::{Model, Symmetry};
use super::pose::Pose;
use super::region::{self, DIRECTIONS};
use super::solve::{self, Witness};
use super::thesis::ThesisPose;
use crate::dimension::Poses;
use crate::feature::Feature;
use crate::hypothesis::{Count, choices};
use crate::recognize::Limit;

/// Pieces in which the pose of largest slack is looked for. Contacts on small arcs make thousands, which take seconds, for a
/// pose that is as good as any of its set.
const MOST_IMPROVED: usize = 100;

/// Assignments are counted by trying so many choices of features at most.
const MOST_ATTEMPTS: usize = 10_000;

/// The largest slack is found to this share of the bounds.
const SHARE_STEP: f64 = 1e-3;

/// Poses in which each contact lies on one of a few features.
#[derive(Debug, Clone)]
pub(crate) struct Piece {
    /// For each contact, in increasing order. One each: an interpretation.
    pub features: Vec<Vec<Feature>>,
    /// These hold every pose of the piece.
    pub cells: Vec<Cell>,
    /// One pose of the piece; `None`: no more than an enclosure, beside pieces that have one.
    pub witness: Option<Witness>,
    /// Poses outside the cells belong to other pieces.
    pub bounded: bool,
}

impl Piece {
    /// The piece where a symmetry of the model moves it: the same placed parts.
    pub fn moved(&self, symmetry: &Symmetry) -> Self {
        let image = |features: &Vec<Feature>| {
            let mut image = symmetry.features(features);
            image.sort_unstable();
            image
        };
        let moved = |witness: Witness| {
            let Witness { pose, .. } = witness;
            let y = symmetry.motion.apply(pose.y);
            Witness { pose: PivotPose { angle: pose.angle - symmetry.motion.angle(), y }, ..witness }
        };
        Self {
            features: self.features.iter().map(image).collect(),
            cells: self.cells.iter().map(|cell| cell.moved(symmetry.motion)).collect(),
            witness: self.witness.map(moved),
            bounded: self.bounded,
        }
    }

    /// Whether the pose satisfies every contact on features of the piece, bounds enlarged by `length` and `angle`.
    pub fn satisfied(&self, case: &Case, pose: PivotPose, length: f64, angle: f64) -> bool {
        let explained = |(contact, features): (usize, &Vec<Feature>)| {
            features.iter().any(|feature| explains(case, contact, *feature, pose, length, angle))
        };
        let inside = || self.cells.iter().any(|cell| cell.holds(pose, 0.0, 0.0));
        (!self.bounded || inside())
            && self.features.iter().enumerate().all(explained)
            && case.allows(pose, length)
    }
}

/// Whether contact `i` on `feature` is satisfied at `pose`, bounds enlarged by `length` and `angle`.
pub(crate) fn explains(
    case: &Case,
    contact: usize,
    feature: Feature,
    pose: PivotPose,
    length: f64,
    angle: f64,
) -> bool {
    case.site(contact, feature).is_some_and(|site| case.excess(contact, &site, pose, angle) <= length)
}

/// All poses of an interpretation or of a hypothesis (DESIGN §1), `world_from_model`.
///
/// Lengths in the model's unit, angles in radians.
#[derive(Debug, Clone)]
pub struct PoseSet {
    pub(super) case: Shared<Case>,
    pub(super) pieces: Shared<Vec<Piece>>,
    symmetric: bool,
    best: Shared<OnceLock<Pose>>,
}

impl PoseSet {
    /// `symmetric`: a pose counts as contained if a symmetry of the model takes it there.
    pub(crate) fn new(case: Shared<Case>, pieces: Vec<Piece>, symmetric: bool) -> Self {
        Self { case, pieces: Shared::new(pieces), symmetric, best: Shared::default() }
    }

    /// The model.
    pub(crate) fn model(&self) -> &Shared<Model> {
        &self.case.model
    }

    /// The world point about which its cells are described.
    pub(crate) fn pivot(&self) -> DVec2 {
        self.case.pivot
    }

    /// A length that covers rounding in its cells.
    pub(crate) fn outward(&self) -> f64 {
        self.case.outward()
    }

    /// Every feature that a contact may lie on.
    pub(crate) fn assigned_features(&self) -> impl Iterator<Item = Feature> + '_ {
        self.pieces.iter().flat_map(|piece| piece.features.iter().flatten().copied())
    }

    /// They hold every pose.
    pub(crate) fn cells(&self) -> impl Iterator<Item = &Cell> {
        self.pieces.iter().flat_map(|piece| &piece.cells)
    }

    fn witnesses(&self) -> impl Iterator<Item = Witness> + '_ {
        self.pieces.iter().filter_map(|piece| piece.witness)
    }

    /// Whether `world_from_model` explains every contact, up to τ: the exact predicate. For a hypothesis, up to the
    /// model's symmetry.
    #[must_use]
    pub fn contains(&self, world_from_model: Pose) -> bool {
        let (length, angle) = (2.0 * self.case.length_tolerance, 2.0 * self.case.angle_tolerance);
        let symmetries = &self.case.model.symmetries;
        let num_tried = if self.symmetric { symmetries.len() } else { 1 };
        symmetries[..num_tried].iter().any(|symmetry| {
            let pose = self.case.pivot_pose(world_from_model.compose(symmetry.motion));
            self.pieces.iter().any(|piece| piece.satisfied(&self.case, pose, length, angle))
        })
    }

    /// A pose of the set: the proof that it is not empty.
    ///
    /// # Panics
    /// Never: a pose set without a witness is not made.
    #[must_use]
    pub fn witness(&self) -> Pose {
        let mut witnesses = self.witnesses();
        let witness = witnesses.next().expect("a pose set has a witness");
        let proven = std::iter::once(witness).chain(witnesses).find(|witness| !witness.marginal);
        self.case.pose(proven.unwrap_or(witness).pose)
    }

    /// The limit that the search met in it, if it did, so that a witness may not be valid.
    pub(crate) fn undecided(&self) -> Option<Limit> {
        self.witnesses().filter_map(|witness| witness.undecided).min()
    }

    /// Whether every witness needs the tolerance τ.
    #[must_use]
    pub fn marginal(&self) -> bool {
        self.witnesses().all(|witness| witness.marginal)
    }

    /// The pose at which the worst reading uses the smallest share of its bounds, to 1/1000; where contacts may lie on one of
    /// several features, with the features that a witness is nearest to. Of a set of very many pieces, the first hundred
    /// are looked at.
    #[must_use]
    pub fn largest_slack(&self) -> Pose {
        *self.best.get_or_init(|| {
            let mut best = (1.0, self.witness());
            let with_witness = self.pieces.iter().filter(|piece| piece.witness.is_some());
            for piece in with_witness.take(MOST_IMPROVED) {
                self.improve(piece, &mut best);
            }
            best.1
        })
    }

    /// Bisects the share of the bounds at which the piece still has a pose.
    fn improve(&self, piece: &Piece, best: &mut (f64, Pose)) {
        let Some(witness) = piece.witness else { return };
        let excess = |contact: usize, feature: Feature| {
            let site = self.case.site(contact, feature);
            site.map_or(f64::INFINITY, |site| {
                self.case.excess(contact, &site, witness.pose, self.case.angle_tolerance)
            })
        };
        let nearest = |(contact, features): (usize, &Vec<Feature>)| {
            let least = features.iter().min_by(|a, b| excess(contact, **a).total_cmp(&excess(contact, **b)));
            least.map(|feature| (contact, *feature))
        };
        let chosen: Vec<(usize, Feature)> = piece.features.iter().enumerate().filter_map(nearest).collect();
        let pairs = || chosen.iter().copied();
        let find = |share: f64| {
            let scaled = self.case.scaled(share);
            let pose = self.case.pose(solve::quick_witness(&Conditions::new(&scaled, pairs())?)?.pose);
            self.contains(pose).then_some(pose)
        };
        // A piece that can't beat the best is left at the first step.
        let first = best.0 - SHARE_STEP;
        let Some(pose) = (first >= 0.0).then(|| find(first)).flatten() else { return };
        *best = (first, pose);
        let mut low = 0.0;
        while best.0 - low > SHARE_STEP {
            let share = 0.5 * (low + best.0);
            match find(share) {
                Some(pose) => *best = (share, pose),
                None => low = share,
            }
        }
    }

    /// The thesis's own pose and bounds of its first assignment; `None` where they are not defined: contacts on vertices
    /// or without normals, all faces parallel.
    #[must_use]
    pub fn thesis_pose(&self) -> Option<ThesisPose> {
        ThesisPose::new(&self.case, &self.assignments().next()?)
    }

    /// The poses of one of its assignments, alone.
    pub(crate) fn of_assignment(&self, assignment: &[Feature]) -> Self {
        let single = |piece: &&Piece| {
            piece.features.iter().zip(assignment).all(|(features, feature)| features.as_slice() == [*feature])
        };
        let piece = match self.pieces.iter().find(single) {
            Some(piece) => piece.clone(),
            None => self.decide(assignment),
        };
        Self::new(Shared::clone(&self.case), vec![piece], false)
    }

    /// The piece of one assignment that shares poses with others. It was found valid: at a witness, or within the cells
    /// of a piece; if only up to τ, that is its witness.
    fn decide(&self, assignment: &[Feature]) -> Piece {
        let (length, angle) = (self.case.length_tolerance, self.case.angle_tolerance);
        let pairs = || assignment.iter().copied().enumerate();
        let conditions = Conditions::new(&self.case, pairs());
        let at_a_witness = || {
            let explained = |pose| {
                pairs().all(|(contact, feature)| explains(&self.case, contact, feature, pose, length, angle))
            };
            let mut images = self.witnesses().flat_map(|witness| {
                let pose = self.case.pose(witness.pose);
                let image = move |motion: Pose| Witness {
                    pose: self.case.pivot_pose(pose.compose(motion)),
                    marginal: true,
                    ..witness
                };
                self.case.model.symmetries.iter().map(move |symmetry| image(symmetry.motion))
            });
            images.find(|witness| explained(witness.pose))
        };
        let within_a_piece = || {
            let conditions = conditions.as_ref()?;
            self.pieces.iter().find_map(|piece| solve::witness_within(conditions, &piece.cells))
        };
        let witness =
            conditions.as_ref().and_then(solve::witness).or_else(at_a_witness).or_else(within_a_piece);
        Piece {
            features: assignment.iter().map(|feature| vec![*feature]).collect(),
            cells: conditions.as_ref().map(solve::cells).unwrap_or_default(),
            witness,
            bounded: false,
        }
    }

    /// The features that explain each contact at the witness of a piece: every choice among them is valid.
    fn explanations(&self, piece: &Piece) -> Option<Vec<Vec<Feature>>> {
        let witness = piece.witness?;
        let (length, angle) = (self.case.length_tolerance, self.case.angle_tolerance);
        let explaining = |(contact, features): (usize, &Vec<Feature>)| {
            let valid =
                |feature: &&Feature| explains(&self.case, contact, **feature, witness.pose, length, angle);
            features.iter().filter(valid).copied().collect()
        };
        Some(piece.features.iter().enumerate().map(explaining).collect())
    }

    /// Its assignments one by one, each once, found as they are asked for; one of each that the model's symmetries repeat.
    pub(crate) fn assignments(&self) -> impl Iterator<Item = Vec<Feature>> + use<> {
        self.attempts().flatten()
    }

    /// First every choice among the features that explain the contacts at a witness: all are valid. Then every other
    /// choice in every piece, decided one by one: `None` if it is not valid, or listed already.
    fn attempts(&self) -> impl Iterator<Item = Option<Vec<Feature>>> + use<> {
        let (certain, open) = (self.clone(), self.clone());
        let model = Shared::clone(&self.case.model);
        let stands_for_itself = self.case.prior.is_some();
        let mut listed = BTreeSet::new();
        let count = self.pieces.len();
        let certain = (0..count)
            .filter_map(move |number| certain.explanations(&certain.pieces[number]))
            .flat_map(|sets| choices(sets).map(|choice| (None, choice)));
        let open_pieces = open.clone();
        let several =
            move |number: &usize| open_pieces.pieces[*number].features.iter().any(|set| set.len() > 1);
        let open_choices = open.clone();
        let undecided = (0..count).filter(several).flat_map(move |number| {
            choices(open_choices.pieces[number].features.clone()).map(move |choice| (Some(number), choice))
        });
        certain.chain(undecided).map(move |(piece, choice)| {
            let first = if stands_for_itself { choice.clone() } else { model.representative(choice.clone()) };
            let valid = |number: usize| open.is_valid_in(&choice, &open.pieces[number]);
            (!listed.contains(&first) && piece.is_none_or(valid)).then(|| {
                listed.insert(first.clone());
                first
            })
        })
    }

    /// Whether a pose within the cells of the piece satisfies the assignment.
    fn is_valid_in(&self, assignment: &[Feature], piece: &Piece) -> bool {
        Conditions::new(&self.case, assignment.iter().copied().enumerate())
            .is_some_and(|conditions| solve::witness_within(&conditions, &piece.cells).is_some())
    }

    /// Counted one by one up to a limit of attempts; beyond, at least the largest product of certain ones.
    pub(crate) fn assignment_count(&self) -> Count {
        let (mut counted, mut num_attempts) = (0, 0);
        for attempt in self.attempts().take(MOST_ATTEMPTS) {
            num_attempts += 1;
            counted += u64::from(attempt.is_some());
        }
        if num_attempts < MOST_ATTEMPTS {
            return Count { at_least: counted, exact: true };
        }
        let products = self.pieces.iter().filter_map(|piece| self.explanations(piece));
        let sizes = products.map(|product| {
            product.iter().fold(1_u64, |size, features| size.saturating_mul(features.len() as u64))
        });
        Count { at_least: sizes.fold(counted, u64::max), exact: false }
    }

    /// No two poses of the set differ by more, radians, at most π.
    #[must_use]
    pub fn rotation_bound(&self) -> f64 {
        let mut arcs: Vec<Arc> = self.cells().map(Cell::rotations).collect();
        arcs.sort_by(|a, b| wrap(a.start).total_cmp(&wrap(b.start)));
        let arcs = merge(arcs);
        let mut largest: f64 = 0.0;
        for (k, a) in arcs.iter().enumerate() {
            largest = largest.max(a.width);
            for b in &arcs[k + 1..] {
                // The farthest two members of two arcs: ends, or a pair half a turn apart.
                let apart = wrap(b.middle() - a.middle()).abs() + a.half_width() + b.half_width();
                largest = largest.max(apart);
            }
        }
        (largest + 4.0 * f64::EPSILON * TAU).min(PI)
    }

    /// No two poses of the set move the model point further apart.
    #[must_use]
    pub fn excursion(&self, point_model: DVec2) -> f64 {
        let supports = self.supports(point_model);
        let half = DIRECTIONS / 2;
        let widest = (0..half).map(|k| supports[k] + supports[k + half]).fold(0.0, f64::max);
        // The direction of the true diameter is within half a step of one that was tried.
        widest.max(0.0) / (PI / DIRECTIONS as f64).cos()
    }

    /// A convex polygon, counter-clockwise, that holds every place of the model point, world frame.
    #[must_use]
    pub fn outline(&self, point_model: DVec2) -> Vec<DVec2> {
        let mut outline = region::polygon(&self.supports(point_model));
        for corner in &mut outline {
            *corner += self.case.pivot;
        }
        outline
    }

    /// The largest `v·p`, from the pivot, of the point over all poses, for each of the directions.
    fn supports(&self, point_model: DVec2) -> [f64; DIRECTIONS] {
        let mut supports = [f64::NEG_INFINITY; DIRECTIONS];
        for cell in self.cells() {
            region::grow(&mut supports, cell, point_model, self.case.outward());
        }
        supports
    }
}

impl Poses<DVec2> for PoseSet {
    fn marginal(&self) -> bool {
        self.marginal()
    }

    fn proved(&self) -> bool {
        self.witnesses().any(|witness| witness.is_decided())
    }

    fn witness(&self) -> Pose {
        self.witness()
    }

    fn sample(&self, count: usize, seed: u64) -> Vec<Pose> {
        self.sample(count, seed)
    }

    fn largest_slack(&self) -> Pose {
        self.largest_slack()
    }

    fn assignment_count(&self) -> Count {
        self.assignment_count()
    }

    fn assignments(&self) -> Box<dyn Iterator<Item = Vec<Feature>> + Send> {
        Box::new(self.assignments())
    }

    fn assigned_features(&self) -> Vec<Feature> {
        self.assigned_features().collect()
    }

    fn of_assignment(&self, assignment: &[Feature]) -> Self {
        self.of_assignment(assignment)
    }
}

/// Joins arcs that overlap; `arcs` are in order of their starts.
fn merge(arcs: Vec<Arc>) -> Vec<Arc> {
    let mut merged: Vec<Arc> = Vec::new();
    for arc in arcs {
        if let Some(last) = merged.last_mut() {
            let offset = (arc.start - last.start).rem_euclid(TAU);
            if offset <= last.width {
                last.width = last.width.max(offset + arc.width).min(TAU);
                continue;
            }
        }
        merged.push(arc);
    }
    merged
}
