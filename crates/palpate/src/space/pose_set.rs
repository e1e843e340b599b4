//! All poses of an answer in space: a guaranteed enclosure in cells, and witnesses inside.

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::sync::{Arc as Shared, OnceLock};

use glam::{DMat3, DVec3};

use super::case::{Case, Datum, PivotPose};
use super::cell::{Cell, Conditions, Linearized};
use super::extent::{Along, Extent};
use super::first_cells;
use super::model::{Model, Symmetry};
use super::pose::{self, Pose};
use super::site::{self, Sites};
use super::solve::{self, Witness};
use super::thesis::ThesisPose;
use crate::dimension::Poses;
use crate::feature::Feature;
use crate::hypothesis::{Count, choices};
use crate::recognize::Limit;

/// Assignments are counted by deciding so many choices of features at most.
const MOST_ATTEMPTS: usize = 200;

/// Cells examined for each of them.
const MOST_FOR_ATTEMPT: u32 = 100;

/// What a choice of features for each contact is found to be.
enum Attempt {
    Valid(Vec<Feature>),
    /// Or listed already.
    Invalid,
    Undecided,
}

/// Cells are divided so many times at most for a closer look at how far the set reaches.
const MOST_DIVIDED: usize = 200;

/// Cells of an enclosure, all pieces together; each piece has one at least.
const MOST_CELLS: usize = 256;

/// For lines a set is divided into so many cells at most, and a cell only while its linear conditions are loose by more than
/// this share of the part's size.
const MOST_PLACED: usize = 16;
const LOOSE: f64 = 1e-3;

/// Above so many cells that were left undivided, they are not divided for a closer look.
const MOST_MEASURED: usize = 1000;

/// Steps between two samples.
const SAMPLE_STEPS: usize = 6;

/// Poses in which each contact lies on one of a few features.
#[derive(Debug, Clone)]
pub(crate) struct Piece {
    /// For each contact, in increasing order. One each: an interpretation.
    pub features: Vec<Vec<Feature>>,
    /// The sites of each contact's features.
    pub sites: Vec<(usize, Sites)>,
    pub witness: Option<Witness>,
    /// If there are any, the piece is what lies in them.
    pub bounds: Vec<Cell>,
}

impl Piece {
    pub fn new(
        case: &Case,
        features: Vec<Vec<Feature>>,
        witness: Option<Witness>,
        bounds: Vec<Cell>,
    ) -> Self {
        let sites = case.sites_of(features.iter().map(Vec::as_slice).enumerate());
        Self { features, sites, witness, bounds }
    }

    /// Whether each contact lies on one feature.
    fn is_single(&self) -> bool {
        self.features.iter().all(|features| features.len() == 1)
    }

    /// Whether a pose of it is known.
    pub(super) fn is_decided(&self) -> bool {
        self.witness.is_some_and(|witness| witness.is_decided())
    }

    /// The piece where a symmetry of the model moves it: the same placed parts.
    pub(super) fn moved(&self, case: &Case, symmetry: &Symmetry) -> Self {
        let image = |features: &Vec<Feature>| {
            let mut image = symmetry.features(features);
            image.sort_unstable();
            image
        };
        let turn = symmetry.motion.rotation;
        let moved = |witness: Witness| {
            let PivotPose { rotation, y } = witness.pose;
            Witness { pose: PivotPose { rotation: turn * rotation, y: symmetry.motion.apply(y) }, ..witness }
        };
        let features = self.features.iter().map(image).collect();
        let bounds = self.bounds.iter().map(|cell| cell.moved(symmetry.motion)).collect();
        Self::new(case, features, self.witness.map(moved), bounds)
    }

    /// Its conditions.
    pub fn conditions<'a>(&self, case: &'a Case) -> Conditions<'a> {
        Conditions { case, sites: self.sites.clone(), slack: 0.0, angle: case.angle_tolerance }
    }

    /// Whether the pose satisfies every contact on features of the piece, bounds enlarged by `length` and `angle`.
    pub(super) fn satisfied(&self, case: &Case, pose: PivotPose, length: f64, angle: f64) -> bool {
        let inside = || self.bounds.iter().any(|cell| cell.holds(pose, length, angle));
        (self.bounds.is_empty() || inside())
            && self.sites.iter().all(|(contact, sites)| case.excess(*contact, sites, pose, angle) <= length)
            && case.allows(pose, length)
    }
}

impl Touched {
    /// The tip's centre is no farther from a model point.
    fn farthest(&self, point_model: DVec3) -> f64 {
        let to_corner = (point_model - self.low).abs().max((self.high - point_model).abs()).length();
        let across = point_model.distance(0.5 * (self.low + self.high)) + self.radius;
        to_corner.min(across) + self.most
    }
}

/// All poses of an interpretation or of a hypothesis in space (DESIGN §1), `world_from_model`.
///
/// Lengths in the model's unit, angles in radians.
#[derive(Debug, Clone)]
pub struct PoseSet {
    case: Shared<Case>,
    pieces: Shared<Vec<Piece>>,
    symmetric: bool,
    best: Shared<OnceLock<Pose>>,
    /// In one chart where that can be, for each piece.
    cells: Shared<OnceLock<Vec<Vec<Cell>>>>,
    fine_cells: Shared<OnceLock<Vec<Vec<Cell>>>>,
    rotation_bound: Shared<OnceLock<f64>>,
    touched: Shared<OnceLock<Vec<Touched>>>,
}

/// Where a tip's centre may be in the model's frame: no farther than `most` from what is both in a box and in a ball about
/// the middle of it.
#[derive(Debug)]
struct Touched {
    low: DVec3,
    high: DVec3,
    radius: f64,
    most: f64,
}

impl PoseSet {
    /// `symmetric`: a pose counts as contained if a symmetry of the model takes it there.
    pub(crate) fn new(case: Shared<Case>, pieces: Vec<Piece>, symmetric: bool) -> Self {
        let pieces = aligned(&case, pieces);
        Self {
            case,
            pieces: Shared::new(pieces),
            symmetric,
            best: Shared::default(),
            cells: Shared::default(),
            fine_cells: Shared::default(),
            rotation_bound: Shared::default(),
            touched: Shared::default(),
        }
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Shared<Model> {
        &self.case.model
    }

    fn witnesses(&self) -> impl Iterator<Item = Witness> + '_ {
        self.pieces.iter().filter_map(|piece| piece.witness)
    }

    /// Whether `world_from_model` explains every contact, up to τ: the exact predicate. For a hypothesis, up to the
    /// model's symmetry.
    #[must_use]
    pub fn contains(&self, world_from_model: Pose) -> bool {
        let symmetries = &self.case.model.symmetries;
        let num_tried = if self.symmetric { symmetries.len() } else { 1 };
        let image = |motion: Pose| self.case.pivot_pose(world_from_model.compose(motion));
        symmetries[..num_tried].iter().any(|symmetry| self.holds(image(symmetry.motion)))
    }

    /// Whether the pose itself, not an image of it, explains every contact, up to τ.
    fn holds(&self, pose: PivotPose) -> bool {
        let (length, angle) = (2.0 * self.case.length_tolerance, 2.0 * self.case.angle_tolerance);
        self.pieces.iter().any(|piece| piece.satisfied(&self.case, pose, length, angle))
    }

    /// A pose of the set: the proof that it is not empty.
    ///
    /// # Panics
    /// Never: a pose set without a witness is not made.
    #[must_use]
    pub fn witness(&self) -> Pose {
        let surest = self
            .witnesses()
            .min_by_key(|one| (!one.is_decided(), one.marginal))
            .expect("a pose set has a witness");
        self.case.pose(surest.pose)
    }

    /// The limit that the search met before a pose was known, if none is.
    pub(crate) fn undecided(&self) -> Option<Limit> {
        let limit = self.witnesses().filter_map(|witness| witness.undecided).min();
        limit.filter(|_| !self.proved())
    }

    /// Whether every witness needs the tolerance τ.
    #[must_use]
    pub fn marginal(&self) -> bool {
        self.witnesses().all(|witness| witness.marginal)
    }

    /// The pose, of those that a few steps from the witnesses reach, at which the worst reading uses the smallest
    /// share of its bounds.
    #[must_use]
    pub fn largest_slack(&self) -> Pose {
        *self.best.get_or_init(|| {
            let (mut best, mut least) = (self.witness(), f64::INFINITY);
            if self.is_untouched() {
                return best;
            }
            for piece in self.pieces.iter() {
                let Some(witness) = piece.witness else { continue };
                let conditions = piece.conditions(&self.case);
                for pose in solve::centred(&conditions, witness.pose) {
                    let used = conditions.used(pose);
                    // An image of it may be outside of the prior.
                    if used < least && self.holds(pose) {
                        (best, least) = (self.case.pose(pose), used);
                    }
                }
            }
            best
        })
    }

    /// `count` poses of the set, spread over it, the same for the same seed; each is valid. The walk goes from pose to pose
    /// along random directions, as far as the set reaches, and begins at the witnesses.
    #[must_use]
    pub fn sample(&self, count: usize, seed: u64) -> Vec<Pose> {
        let mut rng = fastrand::Rng::with_seed(seed);
        let (length, angle) = (self.case.length_tolerance, self.case.angle_tolerance);
        let proved = self.witnesses().any(|witness| witness.is_decided());
        let mut walks: Vec<(usize, PivotPose)> = self
            .pieces
            .iter()
            .enumerate()
            .filter_map(|(number, piece)| Some((number, piece.witness?)))
            // Where a search was cut short its pose may be none.
            .filter(|(_, witness)| witness.is_decided() || !proved)
            .map(|(number, witness)| (number, witness.pose))
            .collect();
        let mut extents: Vec<Option<(f64, f64)>> = vec![None; walks.len()];
        (0..count)
            .map(|k| {
                let at = if walks.len() <= count { k % walks.len() } else { rng.usize(..walks.len()) };
                let (number, mut pose) = walks[at];
                let (turn_reach, shift_reach) = *extents[at].get_or_insert_with(|| self.extent(number));
                for _ in 0..SAMPLE_STEPS {
                    let turn = direction(&mut rng) * turn_reach * rng.f64();
                    let shift = direction(&mut rng) * shift_reach * rng.f64();
                    let (mut low, mut high) = (-1.0, 1.0);
                    for _ in 0..24 {
                        let t = low + (high - low) * rng.f64();
                        let next = PivotPose {
                            rotation: pose::rotation(t * turn) * pose.rotation,
                            y: pose.y + t * shift,
                        };
                        if self.pieces[number].satisfied(&self.case, next, length, angle) {
                            pose = next;
                            break;
                        }
                        if t < 0.0 { low = t } else { high = t }
                    }
                }
                // What is summed over many turns is a rotation only up to rounding.
                pose.rotation = pose::proper(pose.rotation);
                walks[at].1 = pose;
                self.case.pose(pose)
            })
            .collect()
    }

    /// How far a piece may reach: in angle and in length.
    fn extent(&self, number: usize) -> (f64, f64) {
        let cells = solve::boxes(&self.case, &self.pieces[number]);
        let turn = cells.iter().flat_map(|a| cells.iter().take(64).map(move |b| farthest(a, b)));
        let low = cells.iter().fold(DVec3::INFINITY, |low, cell| low.min(cell.y - cell.y_half));
        let high = cells.iter().fold(DVec3::NEG_INFINITY, |high, cell| high.max(cell.y + cell.y_half));
        let size = self.case.model.size;
        (turn.fold(1e-9, f64::max).min(PI), (high - low).length().clamp(1e-9 * size, 4.0 * self.case.scale))
    }

    /// Cells that hold every pose, up to τ, for each piece: made when first asked for.
    fn cells(&self) -> &[Vec<Cell>] {
        self.cells.get_or_init(|| {
            if self.is_coarse() {
                let (length, angle) = (2.0 * self.case.length_tolerance, 2.0 * self.case.angle_tolerance);
                let of_piece = |piece: &Piece| {
                    if !piece.bounds.is_empty() {
                        let around = piece.bounds.iter();
                        return around.map(|cell| cell.widened(length, angle, Vec::new())).collect();
                    }
                    let conditions = piece.conditions(&self.case).relaxed();
                    if self.is_untouched() {
                        vec![first_cells::whole(&conditions)]
                    } else {
                        solve::cells(&conditions, None, &[], 1)
                    }
                };
                return self.pieces.iter().map(of_piece).collect();
            }
            let base = self.witnesses().next().map(|witness| witness.pose.rotation);
            let enclose = |piece: &Piece| {
                let conditions = piece.conditions(&self.case).relaxed();
                solve::cells(&conditions, base, &piece.bounds, MOST_CELLS.div_ceil(self.pieces.len()))
            };
            self.pieces.iter().map(enclose).collect()
        })
    }

    /// Whether there was no time to look for a pose of it.
    fn is_untouched(&self) -> bool {
        self.undecided() == Some(Limit::Time)
    }

    /// Whether its extents are those of its cells as the search left them.
    fn is_coarse(&self) -> bool {
        !self.proved() || self.pieces.iter().map(|piece| piece.bounds.len()).sum::<usize>() > MOST_MEASURED
    }

    /// The cells, divided where their conditions say too little of how far the set reaches: made when first asked for.
    fn fine_cells(&self) -> &[Vec<Cell>] {
        self.fine_cells.get_or_init(|| {
            let mut extent = self.extent_of(self.cells(), MOST_DIVIDED);
            if let Some(start) = one_chart(self.cells()) {
                extent.diameter(|axis, cell| turned(cell, axis, start));
            }
            let Some(first) = self.cells().iter().flatten().next() else { return extent.into_cells() };
            let points = self.case.model.vertices.iter().map(|vertex| vertex.point);
            let apart = |point: &DVec3| point.distance(first.y);
            let farthest = points.max_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or(first.y);
            extent.diameter(|axis, cell| placed(cell, axis, first.rotation(), farthest));
            extent.into_cells()
        })
    }

    /// Cells that hold every pose, and the linear conditions of those that have any, for lines: divided where the conditions
    /// are loose, as long as they are few.
    pub(super) fn placed(&self) -> Vec<(Cell, Option<Linearized>)> {
        let conditions: Vec<Conditions<'_>> =
            self.pieces.iter().map(|piece| piece.conditions(&self.case).relaxed()).collect();
        // Cells of a search that was cut short don't say which sites are left in them: all may be.
        let every = |piece: usize| {
            let sites = conditions[piece].sites.iter();
            sites.map(|(_, sites)| (0..sites.len() as u32).collect()).collect::<Vec<Vec<u32>>>()
        };
        let of_piece = |(piece, cells): (usize, &Vec<Cell>)| {
            let placed = |cell: &Cell| {
                let left = if cell.left.is_empty() { every(piece) } else { cell.left.clone() };
                (piece, Cell { left, ..cell.clone() })
            };
            cells.iter().map(placed).collect::<Vec<_>>()
        };
        let mut cells: Vec<(usize, Cell)> = self.cells().iter().enumerate().flat_map(of_piece).collect();
        let loose = |cell: &Cell| cell.looseness() * 0.5 * self.case.model.size;
        while cells.len() < MOST_PLACED {
            let widest = (0..cells.len()).max_by(|a, b| loose(&cells[*a].1).total_cmp(&loose(&cells[*b].1)));
            let Some(widest) = widest.filter(|k| loose(&cells[*k].1) > LOOSE * self.case.model.size) else {
                break;
            };
            let (piece, cell) = cells.swap_remove(widest);
            cells.extend(solve::halved(&conditions[piece], &cell).map(|half| (piece, half)));
        }
        let linearized = |(piece, cell): (usize, Cell)| {
            let made = cell.is_linear().then(|| cell.linearized(&cell.rows(&conditions[piece], false)));
            (cell, made)
        };
        cells.into_iter().map(linearized).collect()
    }

    /// The world point that cells are seen from.
    pub(super) fn pivot(&self) -> DVec3 {
        self.case.pivot
    }

    /// A length that covers rounding.
    pub(super) fn outward(&self) -> f64 {
        self.case.outward()
    }

    /// By how much one pose may miss another for which it stands, a length and an angle: without a prior, where a symmetry of
    /// the model takes one to the other.
    pub(super) fn asymmetry(&self) -> (f64, f64) {
        if self.case.prior.is_none() { self.case.model.asymmetry } else { (0.0, 0.0) }
    }

    /// The features that contacts are assigned to.
    pub(super) fn assigned_features(&self) -> impl Iterator<Item = Feature> + '_ {
        self.pieces.iter().flat_map(|piece| piece.features.iter().flatten()).copied()
    }

    fn extent_of(&self, cells: &[Vec<Cell>], most_divided: usize) -> Extent<'_> {
        let conditions = self.pieces.iter().map(|piece| piece.conditions(&self.case).relaxed());
        Extent::new(conditions.collect(), cells, most_divided)
    }

    /// No two poses of the set differ by more, radians, at most π.
    #[must_use]
    pub fn rotation_bound(&self) -> f64 {
        *self.rotation_bound.get_or_init(|| {
            let coarse = self.is_coarse();
            let all = if coarse { self.cells() } else { self.fine_cells() };
            let cells = || all.iter().flatten();
            let bound = if coarse && cells().nth(MOST_MEASURED).is_some() {
                PI
            } else if let Some(start) = one_chart(all).filter(|_| !coarse) {
                let mut extent = self.extent_of(self.fine_cells(), 0);
                extent.diameter(|axis, cell| turned(cell, axis, start))
            } else {
                let pairs =
                    cells().enumerate().flat_map(|(k, a)| cells().take(k + 1).map(|b| farthest(a, b)));
                pairs.fold(0.0, f64::max)
            };
            bound.min(self.case.most_turn())
        })
    }

    /// No two poses of the set move the model point further apart.
    #[must_use]
    pub fn excursion(&self, point_model: DVec3) -> f64 {
        let about_contacts = self.touched().iter().map(|touched| touched.farthest(point_model));
        let most = 2.0 * about_contacts.fold(f64::INFINITY, f64::min);
        let bound = if self.is_coarse() {
            // In a ball about the pivot.
            let reach = |cell: &Cell| point_model.distance(cell.y) + cell.y_half.length();
            2.0 * self.cells().iter().flatten().map(reach).fold(0.0, f64::max)
        } else {
            let cells = self.fine_cells();
            let Some(base) = cells.iter().flatten().next().map(Cell::rotation) else { return 0.0 };
            self.extent_of(cells, 0).diameter(|axis, cell| placed(cell, axis, base, point_model))
        };
        bound.min(most) + 4.0 * self.case.outward()
    }

    /// For each contact, where its tip's centre is: what lies so far from it stays so near to the contact.
    fn touched(&self) -> &[Touched] {
        self.touched.get_or_init(|| {
            let of_contact = |(contact, datum): (usize, &Datum)| {
                let sites = || self.pieces.iter().flat_map(|piece| piece.sites[contact].1.iter());
                let (low, high) = site::around_all(sites());
                let middle = 0.5 * (low + high);
                let radius = sites().map(|site| site.farthest_from(middle)).fold(0.0, f64::max);
                Touched { low, high, radius, most: datum.bound + 2.0 * self.case.length_tolerance }
            };
            self.case.data.iter().enumerate().map(of_contact).collect()
        })
    }

    /// The thesis's own pose and bounds of its first assignment; `None` where they are not defined: contacts on edges or
    /// vertices or without normals, no three faces independent.
    #[must_use]
    pub fn thesis_pose(&self) -> Option<ThesisPose> {
        ThesisPose::new(&self.case, &self.assigned().next()?)
    }

    /// The poses of one of its assignments, alone.
    pub(crate) fn of_assignment(&self, assignment: &[Feature]) -> Self {
        let single = |piece: &&Piece| {
            piece.features.iter().zip(assignment).all(|(features, feature)| features.as_slice() == [*feature])
        };
        let known = self.pieces.iter().filter(|piece| piece.is_decided()).find(single).cloned();
        let piece = known.unwrap_or_else(|| {
            let features = assignment.iter().map(|feature| vec![*feature]).collect();
            let mut piece = Piece::new(&self.case, features, None, Vec::new());
            let guess = || self.witnesses().next().map(|witness| Witness::guess(witness.pose, Limit::Effort));
            piece.witness = self.decide(&piece).or_else(guess);
            piece
        });
        Self::new(Shared::clone(&self.case), vec![piece], false)
    }

    /// A pose of an assignment in the set: one that is known, one in a piece that may hold it, or any.
    fn decide(&self, piece: &Piece) -> Option<Witness> {
        let conditions = piece.conditions(&self.case);
        let holds = |one: &&Piece| {
            let mut pairs = one.features.iter().zip(&piece.features);
            !one.bounds.is_empty() && pairs.all(|(all, alone)| all.contains(&alone[0]))
        };
        let within = |one: &Piece| {
            let found = solve::witness_within(&conditions, &one.bounds, &mut { MOST_FOR_ATTEMPT });
            found.filter(Witness::is_decided)
        };
        let in_a_piece = || self.pieces.iter().filter(holds).find_map(within);
        let known = |length: f64, angle: f64| {
            let holds = |one: &Witness| piece.satisfied(&self.case, one.pose, length, angle);
            self.witnesses().filter(Witness::is_decided).find(holds)
        };
        let (length, angle) = (2.0 * self.case.length_tolerance, 2.0 * self.case.angle_tolerance);
        let rounding = self.case.rounding();
        let surely = known(rounding, rounding / self.case.scale);
        surely
            .map(|witness| Witness { marginal: false, ..witness })
            .or_else(in_a_piece)
            .or_else(|| known(length, angle).map(|witness| Witness { marginal: true, ..witness }))
            .or_else(|| solve::witness(&conditions, solve::MOST_EXAMINED))
    }

    /// Its assignments one by one, each once, found as they are asked for; one of each that the model's symmetries repeat. None
    /// if it is not proved.
    fn assigned(&self) -> impl Iterator<Item = Vec<Feature>> + Send + use<> {
        let attempts = self.proved().then(|| self.attempts());
        attempts.into_iter().flatten().filter_map(|attempt| match attempt {
            Attempt::Valid(assignment) => Some(assignment),
            Attempt::Invalid | Attempt::Undecided => None,
        })
    }

    fn attempts(&self) -> impl Iterator<Item = Attempt> + Send + use<> {
        let set = self.clone();
        let mut listed = BTreeSet::new();
        let all = (0..self.pieces.len()).flat_map({
            let set = self.clone();
            move |number| choices(set.pieces[number].features.clone()).map(move |choice| (number, choice))
        });
        all.map(move |(number, choice)| {
            let piece = &set.pieces[number];
            let known = piece.is_single() && piece.is_decided();
            let first = if set.case.prior.is_some() {
                choice.clone()
            } else {
                set.case.model.representative(choice.clone())
            };
            if listed.contains(&first) {
                return Attempt::Invalid;
            }
            if !known {
                let features = choice.iter().map(|feature| vec![*feature]).collect();
                let one = Piece::new(&set.case, features, None, Vec::new());
                let conditions = one.conditions(&set.case);
                let found = if piece.bounds.is_empty() {
                    solve::witness(&conditions, MOST_FOR_ATTEMPT)
                } else {
                    solve::witness_within(&conditions, &piece.bounds, &mut { MOST_FOR_ATTEMPT })
                };
                match found {
                    None => return Attempt::Invalid,
                    Some(witness) if !witness.is_decided() => return Attempt::Undecided,
                    Some(_) => {}
                }
            }
            listed.insert(first.clone());
            Attempt::Valid(first)
        })
    }
}

impl Poses<DVec3> for PoseSet {
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
        if !self.proved() {
            return Count { at_least: 0, exact: false };
        }
        let single = self.pieces.iter().all(Piece::is_single);
        let most = if single { usize::MAX } else { MOST_ATTEMPTS };
        let (mut at_least, mut num_attempts, mut decided) = (0, 0, true);
        for attempt in self.attempts().take(most) {
            num_attempts += 1;
            at_least += u64::from(matches!(attempt, Attempt::Valid(_)));
            decided &= !matches!(attempt, Attempt::Undecided);
        }
        // A set that is proved has a pose, and that an assignment.
        Count { at_least: at_least.max(1), exact: decided && num_attempts < most }
    }

    fn assignments(&self) -> Box<dyn Iterator<Item = Vec<Feature>> + Send> {
        Box::new(self.assigned())
    }

    fn assigned_features(&self) -> Vec<Feature> {
        self.pieces.iter().flat_map(|piece| piece.features.iter().flatten().copied()).collect()
    }

    fn of_assignment(&self, assignment: &[Feature]) -> Self {
        self.of_assignment(assignment)
    }
}

/// Pieces that meet through a symmetry, moved to where they meet: each to the image whose rotation is nearest to the
/// first one's. With a prior they stay, as it may exclude their images.
fn aligned(case: &Case, pieces: Vec<Piece>) -> Vec<Piece> {
    let first = pieces.iter().find_map(|piece| piece.witness).map(|witness| witness.pose.rotation);
    let Some(first) = first.filter(|_| case.prior.is_none() && pieces.len() > 1) else { return pieces };
    let align = |piece: Piece| {
        let Some(witness) = piece.witness else { return piece };
        let away = |symmetry: &&Symmetry| {
            pose::angle(symmetry.motion.rotation * witness.pose.rotation * first.transpose())
        };
        let nearest = case.model.symmetries.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        match nearest.filter(|symmetry| symmetry.motion != Pose::IDENTITY) {
            Some(symmetry) => piece.moved(case, symmetry),
            None => piece,
        }
    };
    pieces.into_iter().map(align).collect()
}

/// A rotation vector of the chart that all cells are in, if there is one.
fn one_chart(cells: &[Vec<Cell>]) -> Option<DVec3> {
    let mut cells = cells.iter().flatten();
    let first = cells.next()?;
    cells.all(|cell| cell.base == first.base).then_some(first.v)
}

/// Rotation vectors along an axis. Axis and angle shorten no way: rotations differ by no more than their vectors.
fn turned(cell: &Cell, axis: DVec3, start: DVec3) -> Along {
    Along { middle: axis.dot(cell.v - start), about: axis, direction: DVec3::ZERO, loose: 0.0 }
}

/// Places of a model point along an axis, both as seen at the rotation `base`.
///
/// The point is placed at Sᵀ(m − y) from the pivot; along the axis, (S S₀ᵀ axis)·(m − y): bilinear in the turn and the shift.
fn placed(cell: &Cell, axis: DVec3, base: DMat3, point_model: DVec3) -> Along {
    let along = cell.rotation() * base.transpose() * axis;
    let offset = point_model - cell.y;
    let (about, loose) = cell.turned(along, offset);
    Along { middle: along.dot(offset), about, direction: -along, loose }
}

/// The farthest apart that rotations of two cells may be, radians.
fn farthest(a: &Cell, b: &Cell) -> f64 {
    let apart = pose::angle(a.rotation() * b.rotation().transpose()) + a.radius() + b.radius();
    if a.base == b.base {
        return apart.min(((a.v - b.v).abs() + a.v_half + b.v_half).length());
    }
    apart
}

fn direction(rng: &mut fastrand::Rng) -> DVec3 {
    loop {
        let v = DVec3::new(rng.f64(), rng.f64(), rng.f64()) * 2.0 - 1.0;
        if (1e-6..=1.0).contains(&v.length_squared()) {
            return v / v.length();
        }
    }
}
