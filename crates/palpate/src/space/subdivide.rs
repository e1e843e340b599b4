//! Pose cells that keep, for each contact, the set of features it may lie on (DESIGN §2).
//!
//! Where assignments explode (finely faceted parts, contacts without normals) the tree of assignments is not walked to
//! its leaves. Two contacts choose their features, which leaves a ball of rotations; the cells in it are divided until each
//! contact is left with features that hang together, or the cell is small against the sensor's bounds.

use rayon::prelude::*;

use super::case::Case;
use super::cell::{Cell, Conditions};
use super::first_cells::first_cells;
use super::hypotheses::{canonical, sensed};
use super::pose_set::Piece;
use super::solve;
use super::tables::FeatureTables;
use crate::feature::Feature;
use crate::groups::Groups;
use crate::tree::FeaturePairs;

/// A cell is small when nothing in it moves by more than this share of the least bound.
const SMALL: f64 = 0.5;

/// Cells examined for one model, and first for each choice of features of two contacts.
const MOST_CELLS: u64 = 50_000;
const LEAST_CELLS: u64 = 50;

/// Cells examined for a witness in a cell whose features hang together, before it is divided, and in a small cell.
const MOST_FOR_WITNESS: u32 = 16;
const MOST_IN_SMALL: u32 = 1_000;

/// What the division left.
#[derive(Debug, Default)]
pub(crate) struct Subdivision {
    pub pieces: Vec<Piece>,
    /// Cells examined.
    pub examined: u64,
    /// Every pose is in a piece that is left.
    pub complete: bool,
}

/// What each contact may lie on by itself: everything, but for the prior.
pub(crate) fn candidates(case: &Case, tables: &FeatureTables) -> Vec<Vec<usize>> {
    let features = tables.features();
    let all: Vec<usize> = (0..features.len()).collect();
    let Some(prior) = case.prior else { return vec![all; case.data.len()] };
    let tilt = prior.lying.map_or(0.0, |lying| lying.tilt);
    let radius = (prior.rotation + tilt).min(std::f64::consts::PI);
    let height = prior.lying.map_or(0.0, |lying| lying.height);
    let shift = if prior.lying.is_some() {
        prior.translation.hypot(height)
    } else {
        prior.translation * 3_f64.sqrt()
    };
    let placed = prior.world_from_model;
    let possible = |contact: usize, number: usize| {
        let datum = &case.data[contact];
        case.sites(contact, features[number]).iter().any(|site| {
            let turn = 2.0 * (0.5 * radius).sin() * (site.middle.length() + site.reach);
            let near = turn + shift + datum.bound + case.length_tolerance;
            let place = placed.inverse().apply(case.pivot + datum.lever);
            let caps =
                datum.reading.caps(radius + case.angle_tolerance, |axis| placed.rotation.transpose() * axis);
            site.distance(place, &caps) <= near
        })
    };
    (0..case.data.len())
        .map(|contact| all.iter().copied().filter(|number| possible(contact, *number)).collect())
        .collect()
}

/// Divides all poses.
pub(crate) fn subdivide(case: &Case, tables: &FeatureTables) -> Subdivision {
    let candidates = candidates(case, tables);
    let features: Vec<Vec<Feature>> = candidates
        .iter()
        .map(|numbers| numbers.iter().map(|number| tables.feature(*number)).collect())
        .collect();
    if features.iter().any(Vec::is_empty) {
        return Subdivision { complete: true, ..Subdivision::default() };
    }
    let touching = Touching::new(case);
    let parts: Vec<Subdivision> = match best_pair(case) {
        Some((a, b)) => {
            let others = (0..case.data.len()).filter(|contact| *contact != a && *contact != b);
            let order: Vec<usize> = [a, b].into_iter().chain(others).collect();
            let readings: Vec<_> = order.iter().map(|&contact| sensed(case, &case.data[contact])).collect();
            let in_order = order.iter().map(|&contact| candidates[contact].clone()).collect();
            let contacts = tables.contact_pairs(&readings, in_order);
            let agree = |later: usize, earlier: usize, second: usize, first: usize| {
                contacts.pairs[later][earlier].meets(&tables.pair(first, second))
            };
            let choices: Vec<(usize, usize)> = contacts.candidates[0]
                .iter()
                .flat_map(|&first| contacts.candidates[1].iter().map(move |&second| (first, second)))
                .filter(|&(first, second)| {
                    let chosen = [first, second].map(|number| tables.feature(number));
                    agree(1, 0, second, first) && canonical(case, &chosen)
                })
                .collect();
            let chosen = |(first, second): (usize, usize)| {
                let mut features = vec![Vec::new(); order.len()];
                features[a] = vec![tables.feature(first)];
                features[b] = vec![tables.feature(second)];
                for (later, &contact) in order.iter().enumerate().skip(2) {
                    let left = contacts.candidates[later]
                        .iter()
                        .filter(|&&one| agree(later, 0, one, first) && agree(later, 1, one, second));
                    features[contact] = left.map(|&one| tables.feature(one)).collect();
                }
                features.iter().all(|features| !features.is_empty()).then_some(features)
            };
            let choices: Vec<Vec<Vec<Feature>>> = choices.into_par_iter().filter_map(chosen).collect();
            divide_all(case, &touching, &choices)
        }
        None => vec![divide(case, &touching, &features, MOST_CELLS)],
    };
    let mut all = Subdivision { complete: true, ..Subdivision::default() };
    for part in parts {
        all.pieces.extend(part.pieces);
        all.examined += part.examined;
        all.complete &= part.complete;
    }
    all
}

/// Divides each of the choices, first within few cells; those that need more share what is left.
fn divide_all(case: &Case, touching: &Touching, choices: &[Vec<Vec<Feature>>]) -> Vec<Subdivision> {
    let within = |most: u64, choice: &Vec<Vec<Feature>>| divide(case, touching, choice, most);
    let mut parts: Vec<Subdivision> = choices.par_iter().map(|choice| within(LEAST_CELLS, choice)).collect();
    let spent: u64 = parts.iter().map(|part| part.examined).sum();
    let unfinished = parts.iter().filter(|part| !part.complete).count() as u64;
    let most = MOST_CELLS.saturating_sub(spent) / unfinished.max(1);
    if most > LEAST_CELLS {
        parts.par_iter_mut().zip(choices).filter(|(part, _)| !part.complete).for_each(|(part, choice)| {
            let before = part.examined;
            *part = within(most, choice);
            part.examined += before;
        });
    }
    parts
}

/// The two contacts whose normals leave the least of the rotations.
fn best_pair(case: &Case) -> Option<(usize, usize)> {
    let mut best: Option<(f64, (usize, usize))> = None;
    for (k, a) in case.data.iter().enumerate() {
        for (j, b) in case.data[..k].iter().enumerate() {
            if let (Some((one, _)), Some((other, _))) = (a.reading.sensed, b.reading.sensed) {
                let across = one.cross(other).length();
                if across > 0.1 && best.is_none_or(|(most, _)| across > most) {
                    best = Some((across, (j, k)));
                }
            }
        }
    }
    best.map(|(_, pair)| pair)
}

fn divide(case: &Case, touching: &Touching, features: &[Vec<Feature>], most: u64) -> Subdivision {
    let mut left = Subdivision { complete: true, ..Subdivision::default() };
    let pairs = features.iter().enumerate().map(|(contact, features)| (contact, features.as_slice()));
    let Some(conditions) = Conditions::new(case, pairs) else { return left };
    let reach = conditions.reach();
    let least = case.data.iter().map(|datum| datum.bound).fold(f64::INFINITY, f64::min);
    let small = (SMALL * least).max(0.5 * case.length_tolerance);
    let mut open = first_cells(&conditions);
    while let Some(cell) = open.pop() {
        if left.examined >= most || case.stopped() {
            left.complete = false;
            break;
        }
        left.examined += 1;
        let Some(cell) = solve::contracted(&conditions, cell) else { continue };
        let small = cell.motion(reach) <= small;
        if small || cell.is_narrow() {
            let features = of_cell(&conditions, &cell);
            if small || features.iter().all(|features| touching.hang_together(features)) {
                let mut piece = Piece::new(case, features, None, vec![cell.clone()]);
                let given = if small { MOST_IN_SMALL } else { MOST_FOR_WITNESS };
                let mut budget = given;
                piece.witness = solve::witness_within(&piece.conditions(case), &piece.bounds, &mut budget);
                left.examined += u64::from(given - budget);
                match piece.witness {
                    None => continue,
                    Some(witness) if small || !witness.undecided => {
                        left.pieces.push(piece);
                        continue;
                    }
                    Some(_) => {}
                }
            }
        }
        open.extend(cell.split(reach, false));
    }
    left
}

/// The features whose sites are left in a cell, in increasing order.
fn of_cell(conditions: &Conditions<'_>, cell: &Cell) -> Vec<Vec<Feature>> {
    let of_contact = |((_, sites), left): (&(usize, Vec<super::site::Site>), &Vec<u32>)| {
        let mut features: Vec<Feature> = left.iter().map(|number| sites[*number as usize].feature).collect();
        features.sort_unstable();
        features.dedup();
        features
    };
    conditions.sites.iter().zip(&cell.left).map(of_contact).collect()
}

/// Which features have a corner in common.
struct Touching {
    /// The corners of each face, edge and vertex.
    faces: Vec<Vec<u32>>,
    edges: Vec<[u32; 2]>,
}

impl Touching {
    fn new(case: &Case) -> Self {
        let faces = case.model.faces.iter().map(|face| face.loops.concat());
        Self { faces: faces.collect(), edges: case.model.edges.iter().map(|edge| edge.ends).collect() }
    }

    fn corners(&self, feature: Feature) -> Vec<u32> {
        match feature {
            Feature::Face(number) => self.faces[number as usize].clone(),
            Feature::Edge(number) => self.edges[number as usize].to_vec(),
            Feature::Vertex(number) => vec![number],
        }
    }

    /// Whether one can go from each of the features to any other over corners.
    fn hang_together(&self, features: &[Feature]) -> bool {
        if features.len() == 1 {
            return true;
        }
        let mut corners: Vec<(u32, usize)> = features
            .iter()
            .enumerate()
            .flat_map(|(k, feature)| self.corners(*feature).into_iter().map(move |corner| (corner, k)))
            .collect();
        corners.sort_unstable();
        let mut groups = Groups::new(features.len());
        for pair in corners.windows(2) {
            if pair[0].0 == pair[1].0 {
                groups.unite(pair[0].1, pair[1].1);
            }
        }
        (1..features.len()).all(|k| groups.root(k) == 0)
    }
}
