//! Lines in evenly spaced directions: at each, the places where the line changes what it meets first are explicit, and one
//! line in each interval between them stands for all (MATH 2.3.1, 2.3.2).
//!
//! Nominal poses propose. A few more poses of each hypothesis sort out, and the judge, who knows all poses, decides.

use crate::part::Surface;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

use glam::DVec2;

use crate::best::Best;
use crate::line::Line;
use crate::plan::Stop;
use crate::plane::arc::wrap;
use crate::scene::Scene;

/// Directions of the first round, and of the second, if the first finds nothing that is good enough.
const ROUNDS: [usize; 2] = [72, 360];

/// So many proposals are looked at from all views, at most.
const MOST_LOOKED_AT: usize = 600;

/// So many are judged, at most, in a round, unless the search is to be thorough.
const MOST_JUDGED: usize = 48;

/// Lines that meet the same features count as one; of each kind so many are kept.
const KEPT_OF_A_KIND: usize = 3;

/// A line, and how many pairs it leaves as far as was looked.
#[derive(Debug, Clone, Copy)]
struct Proposal {
    angle: f64,
    aside: f64,
    left: usize,
    width: f64,
}

/// What a line may meet of one placed part: between two places across the line, at a depth that grows with the place.
struct Piece {
    member: usize,
    number: u32,
    from: f64,
    to: f64,
    depth: f64,
    slope: f64,
    normal: f64,
    skids: bool,
}

/// Offers the most promising lines to `best`.
pub(crate) fn sweep(best: &mut Best<'_>, stop: Stop, late: &dyn Fn() -> bool) {
    for count in ROUNDS {
        let mut proposals = proposals(best.scene, best.members, count);
        proposals.truncate(MOST_LOOKED_AT);
        let scene = best.scene;
        proposals.retain_mut(|proposal| {
            let line = scene.line(proposal.angle, proposal.aside);
            let left = line.and_then(|line| scene.glance(&line, best.members));
            proposal.left = left.unwrap_or(usize::MAX);
            left.is_some()
        });
        proposals.sort_by(|a, b| a.left.cmp(&b.left).then(b.width.total_cmp(&a.width)));
        let most = if best.thorough { MOST_LOOKED_AT } else { MOST_JUDGED };
        for proposal in proposals.iter().take(most) {
            if best.enough(stop) || best.hopeless(proposal.left) || late() {
                break;
            }
            if let Some(line) = scene.line(proposal.angle, proposal.aside) {
                best.offer(&line);
            }
        }
        if best.enough(stop) || late() {
            return;
        }
    }
}

/// One line for each interval of each direction, those that leave least at the nominal poses first.
fn proposals(scene: &Scene, members: &[usize], count: usize) -> Vec<Proposal> {
    let mut kinds: BTreeMap<u64, Vec<Proposal>> = BTreeMap::new();
    for angle in scene.directions(count).0 {
        let pieces = pieces(scene, members, angle);
        in_direction(scene, members.len(), &pieces, angle, &mut kinds);
    }
    let mut all: Vec<Proposal> = kinds.into_values().flatten().collect();
    all.sort_by(|a, b| {
        a.left.cmp(&b.left).then(b.width.total_cmp(&a.width)).then(a.angle.total_cmp(&b.angle))
    });
    all
}

/// Every face, moved out by the tip's radius, that looks toward lines of this direction, and every vertex that sticks out.
fn pieces(scene: &Scene, members: &[usize], angle: f64) -> Vec<Piece> {
    let along = DVec2::from_angle(angle);
    let aside = along.perp();
    let radius = scene.sensor.tip_radius;
    let mut pieces = Vec::new();
    for (place, &member) in members.iter().enumerate() {
        let pose = scene.views[member][0];
        for (number, face) in scene.shadows[member].model().faces.iter().enumerate() {
            let normal = pose.rotation.rotate(face.normal);
            let speed = normal.dot(along);
            if speed >= 0.0 || face.surface == Surface::Seam {
                continue;
            }
            let ends = [face.start, face.end].map(|end| pose.apply(end) + radius * normal - scene.middle);
            let ends = ends.map(|end| (aside.dot(end), along.dot(end)));
            let (first, second) =
                if ends[0].0 <= ends[1].0 { (ends[0], ends[1]) } else { (ends[1], ends[0]) };
            let width = second.0 - first.0;
            if width <= 0.0 {
                continue;
            }
            let normal = normal.to_angle();
            let incidence = wrap(normal - (-along).to_angle()).abs();
            pieces.push(Piece {
                member: place,
                number: number as u32,
                from: first.0,
                to: second.0,
                depth: first.1,
                slope: (second.1 - first.1) / width,
                normal,
                skids: incidence > scene.sensor.max_incidence || face.surface != Surface::Touchable,
            });
        }
        if radius > 0.0 {
            pieces.extend(round_pieces(scene, place, member, along));
        }
    }
    pieces
}

/// The tip's circles around vertices, as if flat at their nearest points: what a line should keep away from.
fn round_pieces(
    scene: &Scene,
    place: usize,
    member: usize,
    along: DVec2,
) -> impl Iterator<Item = Piece> + '_ {
    let pose = scene.views[member][0];
    let radius = scene.sensor.tip_radius;
    scene.shadows[member].model().vertices.iter().enumerate().map(move |(number, vertex)| {
        let at = pose.apply(vertex.point) - scene.middle;
        let center = along.perp().dot(at);
        Piece {
            member: place,
            number: u32::MAX - number as u32,
            from: center - radius,
            to: center + radius,
            depth: along.dot(at) - radius,
            slope: 0.0,
            normal: (-along).to_angle(),
            skids: scene.sensor.max_incidence < FRAC_PI_2 && !scene.rules.vertices,
        }
    })
}

/// The intervals of one direction, by what the lines in them meet first.
fn in_direction(
    scene: &Scene,
    num_members: usize,
    pieces: &[Piece],
    angle: f64,
    kinds: &mut BTreeMap<u64, Vec<Proposal>>,
) {
    let mut events: Vec<(f64, usize)> =
        pieces.iter().enumerate().flat_map(|(k, piece)| [(piece.from, k), (piece.to, k)]).collect();
    events.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut active: Vec<Vec<usize>> = vec![Vec::new(); num_members];
    let mut first: Vec<Option<usize>> = vec![None; num_members];
    let narrowest = 2.0 * (scene.sensor.path_error + scene.margin);
    for (k, &(from, piece)) in events.iter().enumerate() {
        let list = &mut active[pieces[piece].member];
        match list.iter().position(|one| *one == piece) {
            Some(at) => drop(list.swap_remove(at)),
            None => list.push(piece),
        }
        let to = events.get(k + 1).map_or(from, |next| next.0);
        let (aside, width) = (0.5 * (from + to), to - from);
        if width <= narrowest {
            continue;
        }
        for (slot, list) in first.iter_mut().zip(&active) {
            let depth = |k: &usize| pieces[*k].depth + pieces[*k].slope * (aside - pieces[*k].from);
            *slot = list.iter().copied().min_by(|a, b| depth(a).total_cmp(&depth(b)));
        }
        if first.iter().flatten().any(|one| pieces[*one].skids) {
            continue;
        }
        let left = num_left(scene, pieces, &first, aside);
        let proposal = Proposal { angle, aside, left, width };
        let kind = kinds.entry(kind_of(pieces, &first)).or_default();
        kind.push(proposal);
        kind.sort_by(|a, b| a.left.cmp(&b.left).then(b.width.total_cmp(&a.width)));
        kind.truncate(KEPT_OF_A_KIND);
    }
}

/// Pairs that the line leaves at the nominal poses.
fn num_left(scene: &Scene, pieces: &[Piece], first: &[Option<usize>], aside: f64) -> usize {
    let seen: Vec<Option<(f64, f64)>> = first
        .iter()
        .map(|one| {
            let piece = &pieces[(*one)?];
            Some((piece.depth + piece.slope * (aside - piece.from), piece.normal))
        })
        .collect();
    scene.num_alike(&seen)
}

/// A number for the features that are met (FNV-1a).
fn kind_of(pieces: &[Piece], first: &[Option<usize>]) -> u64 {
    first.iter().fold(0xcbf2_9ce4_8422_2325, |hash, one| {
        let number = one.map_or(u64::from(u32::MAX) / 2, |k| u64::from(pieces[k].number));
        (hash ^ number).wrapping_mul(0x0100_0000_01b3)
    })
}

impl Scene {
    /// Ordered pairs of equal readings, each with itself included; a reading is depth and normal, or a miss.
    pub(crate) fn num_alike(&self, seen: &[Option<(f64, f64)>]) -> usize {
        let mut left = seen.len();
        for (k, a) in seen.iter().enumerate() {
            left += 2 * seen[..k].iter().filter(|b| self.alike(*a, **b, 0.0, 0.0)).count();
        }
        left
    }

    /// Whether two exact readings, either wrong by its bounds, may be the same, or are so even if they differ by `depth` and
    /// `angle` more.
    pub(crate) fn alike(&self, a: Option<(f64, f64)>, b: Option<(f64, f64)>, depth: f64, angle: f64) -> bool {
        match (a, b) {
            (None, None) => true,
            (Some(a), Some(b)) => {
                self.sensor.confuses((a.0 - b.0).abs() + depth, || wrap(a.1 - b.1).abs() + angle)
            }
            _ => false,
        }
    }

    /// Pairs that a line leaves, seen from all views: no judgement can be better. `None` if one of them makes it unusable.
    fn glance(&self, line: &Line, members: &[usize]) -> Option<usize> {
        let mut seen: Vec<Vec<Option<(f64, f64)>>> = Vec::with_capacity(members.len());
        for &member in members {
            let mut readings = Vec::new();
            for pose in &self.views[member] {
                let found = self.contact(member, *pose, line);
                if let Some(found) = found
                    && (-line.direction).angle_to(found.normal).abs() > self.sensor.max_incidence
                {
                    return None;
                }
                readings.push(found.map(|found| (found.depth, found.normal.to_angle())));
            }
            seen.push(readings);
        }
        let mut left = members.len();
        for (k, some) in seen.iter().enumerate() {
            let alike = |others: &&Vec<Option<(f64, f64)>>| {
                some.iter().any(|a| others.iter().any(|b| self.alike(*a, *b, 0.0, 0.0)))
            };
            left += 2 * seen[..k].iter().filter(alike).count();
        }
        Some(left)
    }
}
