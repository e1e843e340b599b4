//! Pose cells that keep, for each contact, the set of features it may lie on (DESIGN §2).
//!
//! Where assignments explode (finely faceted parts, contacts without normals) the tree of assignments is not walked.
//! Boxes of poses are divided instead, each with the features that every contact may lie on somewhere in the box,
//! until few assignments are left in the box, or until it is small against the sensor's bounds.

use std::collections::BinaryHeap;

use super::arc::Arc;
use super::case::{Case, Datum, PivotPose};
use super::cell::{Cell, Conditions};
use super::pose_set::explains;
use super::site::Site;
use super::solve::{self, Witness};
use crate::feature::Feature;
use crate::nearest::Nearest;
use crate::recognize::Limit;

/// A box is left as assignments when there are at most so many.
const FEW: usize = 4;

/// A box is small when nothing in it moves by more than this share of the largest bound, or by less, down to the finest
/// share of the smallest bound, as long as there are few boxes. A set that is so large that too many boxes would be needed
/// is left in larger ones.
const SMALL: f64 = 0.25;
const SMALLEST: f64 = 1.0 / 64.0;

/// Division begins with boxes in which things move by this share of the part.
const FIRST: f64 = 1.0 / 16.0;

/// So many small boxes are enough to describe a set.
const ENOUGH_BOXES: usize = 1000;

/// So many boxes are not divided once more: each halving makes up to eight of one.
const TOO_MANY_BOXES: usize = 20_000;

/// Boxes examined at most for a witness of a group of boxes.
const MOST_SOUGHT: usize = 50_000;

/// Boxes examined at most.
const MOST_BOXES: u64 = 2_000_000;

/// Of the boxes examined for a witness, one in so many is solved for the features nearest to it.
const SOLVED_EVERY: usize = 32;

/// A box of poses and the features that each contact may lie on in it.
#[derive(Debug, Clone)]
pub(crate) struct Bundle {
    pub cell: Cell,
    /// For each contact, in increasing order.
    pub features: Vec<Vec<Feature>>,
    pub witness: Option<Witness>,
}

/// What the division left.
#[derive(Debug, Default)]
pub(crate) struct Subdivision {
    /// Boxes with few assignments.
    pub sparse: Vec<Bundle>,
    /// Small boxes with many.
    pub dense: Vec<Bundle>,
    /// Boxes examined.
    pub examined: u64,
    /// What left boxes that are not small, if there are any: every pose is in a box that is left all the same.
    pub stopped_by: Option<Limit>,
}

/// For each contact the features it may lie on in a box, with their sites.
type Options = Vec<Vec<(Feature, Site)>>;

/// Divides the poses with rotations in `rotations`; `features` are those that can be touched, in order.
pub(crate) fn subdivide(case: &Case, features: &[Feature], rotations: Arc) -> Subdivision {
    let largest = case.data.iter().map(|datum| datum.bound).fold(0.0, f64::max);
    let smallest = case.data.iter().map(|datum| datum.bound).fold(f64::INFINITY, f64::min);
    let finest = (SMALLEST * smallest).max(0.25 * case.length_tolerance);
    let wanted = (SMALL * largest).max(finest);
    let mut small = (FIRST * case.model.size).max(wanted);
    let mut left = Subdivision::default();
    let all = Bundle {
        cell: root(case, rotations),
        features: vec![features.to_vec(); case.data.len()],
        witness: None,
    };
    left.divide(case, all, small);
    while !left.dense.is_empty()
        && small > finest
        && left.dense.len() < if small > wanted { TOO_MANY_BOXES } else { ENOUGH_BOXES }
    {
        small = (0.5 * small).max(finest);
        for bundle in std::mem::take(&mut left.dense) {
            left.divide(case, bundle, small);
        }
    }
    for bundle in &mut left.dense {
        bundle.witness = bundle.find_witness(case);
    }
    left
}

impl Subdivision {
    /// Divides a bundle into boxes with few assignments and boxes in which nothing moves by more than `small`.
    fn divide(&mut self, case: &Case, bundle: Bundle, small: f64) {
        let reach = reach(case);
        let options = bundle.options(case);
        let mut stack = vec![(bundle.cell, options)];
        while let Some((cell, options)) = stack.pop() {
            self.examined += 1;
            let spent = (self.examined > case.effort.unwrap_or(MOST_BOXES)).then_some(Limit::Effort);
            if let Some(limit) = case.late().or(spent) {
                // Kept as it is, so that nothing true is lost.
                self.stopped_by = Some(limit);
                self.dense.push(Bundle::new(cell, &options));
                continue;
            }
            let Some(options) = restrict(case, &cell, &options) else { continue };
            let assignments = options.iter().map(Vec::len).fold(1_usize, usize::saturating_mul);
            if assignments <= FEW {
                self.sparse.push(Bundle::new(cell, &options));
            } else if cell.motion(reach) <= small {
                self.dense.push(Bundle::new(cell, &options));
            } else {
                stack.extend(halves(&cell, reach).map(|half| (half, options.clone())));
            }
        }
    }
}

/// The length at which rotations are measured: the longest lever, or a share of the part where contacts lie close
/// together and the normals say more than the points.
fn reach(case: &Case) -> f64 {
    let lever = |datum: &Datum| datum.lever.length() + datum.radius;
    case.data.iter().map(lever).fold(0.25 * case.model.size, f64::max)
}

/// Across rotations where they move more than the box is wide.
fn halves(cell: &Cell, reach: f64) -> [Cell; 2] {
    if cell.half * reach > cell.y_half().max_element() { cell.split_rotations() } else { cell.split_box() }
}

/// A box with a witness among the bundles, or the certificate that there is none.
///
/// The box whose middle misses least is divided first. A box in which nothing moves by τ/4 is valid up to τ.
pub(crate) fn seek(case: &Case, bundles: &[Bundle]) -> Option<Bundle> {
    let reach = reach(case);
    let mut open = BinaryHeap::new();
    let mut num_opened = 0;
    let mut add = |open: &mut BinaryHeap<Nearest<(Cell, Options)>>, cell: Cell, options: &Options| {
        if let Some(options) = restrict(case, &cell, options) {
            num_opened += 1;
            let miss = miss(case, &cell, &options);
            open.push(Nearest { miss, number: num_opened, value: (cell, options) });
        }
    };
    for bundle in bundles {
        add(&mut open, bundle.cell.clone(), &bundle.options(case));
    }
    for num_examined in 0.. {
        let (cell, options) = open.pop()?.value;
        let mut bundle = Bundle::new(cell, &options);
        bundle.witness = bundle.find_witness(case);
        if bundle.witness.is_some() {
            return Some(bundle);
        }
        if num_examined % SOLVED_EVERY == 0
            && let Some(found) = solve_nearest(case, &bundle.cell, &options, bundles)
        {
            return Some(found);
        }
        let fine = (bundle.cell.motion(reach) <= 0.5 * case.length_tolerance).then_some(Limit::Tolerance);
        let spent = (num_examined >= MOST_SOUGHT).then_some(Limit::Effort);
        if let Some(limit) = case.late().or(fine).or(spent) {
            return Some(bundle.settled(case, limit));
        }
        for half in halves(&bundle.cell, reach) {
            add(&mut open, half, &options);
        }
    }
    None
}

/// Solves for the features nearest at the middle of the cell: where the set is thin, sampling would not meet it.
fn solve_nearest(case: &Case, cell: &Cell, options: &Options, bundles: &[Bundle]) -> Option<Bundle> {
    let middle = PivotPose { angle: cell.mid, y: cell.y_mid() };
    let nearest = |(contact, sites): (usize, &Vec<(Feature, Site)>)| {
        let excess = |site: &Site| case.excess(contact, site, middle, case.angle_tolerance);
        let first = sites.iter().min_by(|a, b| excess(&a.1).total_cmp(&excess(&b.1)))?;
        Some((contact, first.0))
    };
    let conditions = Conditions::new(case, options.iter().enumerate().filter_map(nearest))?;
    let witness = solve::quick_witness(&conditions)?;
    let holds = |bundle: &&Bundle| {
        bundle.cell.holds(witness.pose, case.length_tolerance, case.angle_tolerance)
            && bundle.valid(case, witness.pose, case.length_tolerance, case.angle_tolerance)
    };
    bundles.iter().find(holds).map(|bundle| Bundle { witness: Some(witness), ..bundle.clone() })
}

/// By how much the middle of the cell misses the worst contact, or the prior or free space.
fn miss(case: &Case, cell: &Cell, options: &Options) -> f64 {
    let middle = PivotPose { angle: cell.mid, y: cell.y_mid() };
    let contacts = options.iter().enumerate().map(|(contact, sites)| {
        let excess = sites.iter().map(|(_, site)| case.excess(contact, site, middle, case.angle_tolerance));
        excess.fold(f64::INFINITY, f64::min)
    });
    let sweeps = case.sweeps.iter().map(|sweep| sweep.intrusion(&case.model, middle).0);
    contacts.chain(sweeps).fold(case.prior_excess(middle), f64::max)
}

/// All pivot points at which any contact can be near the model.
fn root(case: &Case, rotations: Arc) -> Cell {
    let mut cell = Cell::whole(rotations.middle(), rotations.half_width());
    let datum = &case.data[0];
    let reach = datum.lever.length() + datum.bound + datum.radius + case.length_tolerance;
    let points = case.model.faces.iter().flat_map(|face| [face.start, face.end]);
    let (low, high) = points.fold((cell.y_high, cell.y_low), |(low, high), at| (low.min(at), high.max(at)));
    cell.y_low = low - reach;
    cell.y_high = high + reach;
    cell
}

/// The features that are left for each contact in the cell, or nothing if one has none, or if the prior or free
/// space excludes all of the cell.
fn restrict(case: &Case, cell: &Cell, options: &Options) -> Option<Options> {
    let middle = PivotPose { angle: cell.mid, y: cell.y_mid() };
    let left: Option<Options> = options
        .iter()
        .enumerate()
        .map(|(contact, sites)| {
            let x = case.place(contact, middle);
            let datum = &case.data[contact];
            let near = datum.bound + cell.motion(datum.lever.length()) + 0.5 * case.length_tolerance;
            let possible = |site: &Site| {
                case.rotations(contact, site, case.angle_tolerance).distance(cell.mid) <= cell.half
                    && site.nearest(x).distance(x) <= near
            };
            let left: Vec<_> = sites.iter().filter(|(_, site)| possible(site)).copied().collect();
            (!left.is_empty()).then_some(left)
        })
        .collect();
    // A pose moves the model's origin by no more than a lever of that length.
    let prior = case.prior_excess(middle);
    let moved = cell.motion(cell.y_low.abs().max(cell.y_high.abs()).length());
    let turned = cell.half * case.model.size;
    let allowed = prior <= moved + turned + case.length_tolerance;
    let free = || {
        case.sweeps
            .iter()
            .all(|sweep| sweep.free(&case.model, middle, cell.motion(sweep.reach()) + case.length_tolerance))
    };
    left.filter(|_| allowed && free())
}

impl Bundle {
    /// The features with their sites.
    fn options(&self, case: &Case) -> Options {
        let site = |contact, feature: &Feature| Some((*feature, case.site(contact, *feature)?));
        let of_contact = |(contact, features): (usize, &Vec<Feature>)| {
            features.iter().filter_map(|feature| site(contact, feature)).collect()
        };
        self.features.iter().enumerate().map(of_contact).collect()
    }

    fn new(cell: Cell, options: &Options) -> Self {
        let features = options.iter().map(|sites| sites.iter().map(|(feature, _)| *feature).collect());
        Self { cell, features: features.collect(), witness: None }
    }

    /// With its middle as the witness, valid up to τ where nothing in the box moves by as much.
    fn settled(mut self, case: &Case, limit: Limit) -> Self {
        let pose = PivotPose { angle: self.cell.mid, y: self.cell.y_mid() };
        let valid = self.valid(case, pose, case.length_tolerance, case.angle_tolerance);
        self.witness = Some(Witness { pose, marginal: true, undecided: (!valid).then_some(limit) });
        self
    }

    /// Looks for a valid pose at the middle of the box and half way to its corners.
    fn find_witness(&self, case: &Case) -> Option<Witness> {
        let (middle, half) = (self.cell.y_mid(), self.cell.y_half());
        let offsets = (0..9).map(|k| {
            let sign = |bit: usize| {
                if k == 8 {
                    0.0
                } else if (k >> bit) & 1 == 0 {
                    -0.5
                } else {
                    0.5
                }
            };
            [sign(0), sign(1), sign(2)]
        });
        offsets
            .rev()
            .map(|[turn, x, y]| PivotPose {
                angle: self.cell.mid + turn * self.cell.half,
                y: middle + half * glam::dvec2(x, y),
            })
            .find(|pose| self.valid(case, *pose, case.rounding(), case.rounding() / case.scale))
            .map(|pose| Witness { pose, marginal: false, undecided: None })
    }

    fn valid(&self, case: &Case, pose: PivotPose, length: f64, angle: f64) -> bool {
        let explained = |(contact, features): (usize, &Vec<Feature>)| {
            features.iter().any(|feature| explains(case, contact, *feature, pose, length, angle))
        };
        self.features.iter().enumerate().all(explained) && case.allows(pose, length)
    }

    /// Every assignment of the box.
    pub fn assignments(&self) -> Vec<Vec<Feature>> {
        let mut assignments = vec![Vec::new()];
        for features in &self.features {
            assignments = assignments
                .iter()
                .flat_map(|start| {
                    features.iter().map(move |feature| [start.as_slice(), &[*feature]].concat())
                })
                .collect();
        }
        assignments
    }

    /// Whether the two may share an assignment.
    pub fn compatible(&self, other: &[Vec<Feature>]) -> bool {
        let meet = |(mine, theirs): (&Vec<Feature>, &Vec<Feature>)| {
            mine.iter().any(|feature| theirs.binary_search(feature).is_ok())
        };
        self.features.iter().zip(other).all(meet)
    }
}
