//! The thesis's own search (3.1 to 3.3, 4.1), its formulas as MATH 1.3 corrects them.
//!
//! Lines through one face, the generator, and through as many other faces as possible: in the projection space of each
//! generator, at each critical slope, the faces that overlap an end of the generator are pierced in the middle of what
//! they share.
//!
//! It is not complete (row 70): what is seen only between ends of other faces it does not find. A hypothesis stands at
//! the pose of its first interpretation.
//!
//! Where the thesis is silent: faces that can't be touched are no edges; slopes that differ by less than m over the
//! part's size count as equal; the generator and all that is pierced share more than twice m and the path error (row 58);
//! a face counts as pierced only at slopes at which it does not skid (row 55).

use std::f64::consts::PI;
use std::ops::ControlFlow;

use super::sheaves::{Edge, Placed, ProjectionSpace};
use crate::best::Best;
use crate::plan::PlanSettings;
use crate::plane::pose::Pose;
use crate::plane::thesis::Placement;
use crate::scene::Scene;

/// What the thesis's search did, in its own units (3.5).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct EllisCounters {
    /// M: faces of all hypotheses that no contact is assigned to.
    pub unsensed: u64,
    /// K: faces that one is assigned to.
    pub sensed: u64,
    /// Inner products of normals, for candidate sets.
    pub inner_products: u64,
    /// Generators whose candidate sets were searched.
    pub generators: u64,
    /// ΣN: the members of these candidate sets, the generators not counted.
    pub candidates: u64,
    /// Critical slopes examined.
    pub critical_points: u64,
    /// Those within the bounds, near ones compacted.
    pub critical_kept: u64,
    /// Projections of candidates tested against the generator's.
    pub overlaps: u64,
    /// Paths evaluated.
    pub paths: u64,
}

impl EllisCounters {
    /// The thesis's count of inner products, `M(M−1)/2 + MK` (row 68): every generator with every face, once.
    #[must_use]
    pub fn predicted_inner_products(&self) -> u64 {
        self.unsensed * self.unsensed.saturating_sub(1) / 2 + self.unsensed * self.sensed
    }

    /// The thesis's count of critical points, `4N + 3` for each generator (3.5).
    #[must_use]
    pub fn predicted_critical_points(&self) -> u64 {
        4 * self.candidates + 3 * self.generators
    }
}

/// A generator and its candidate set, by their places among the edges.
pub(crate) struct Generator {
    edge: usize,
    candidates: Vec<usize>,
    num_hypotheses: usize,
}

/// Where the best line offered lies in the projection space of its generator.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Chosen {
    /// The generator's place.
    pub generator: usize,
    pub slope: f64,
    pub position: f64,
}

/// The faces among which to search, and what the search did.
pub(crate) struct Search {
    edges: Vec<Edge>,
    /// In the order in which they are searched.
    pub generators: Vec<Generator>,
    pub counters: EllisCounters,
    pub chosen: Option<Chosen>,
}

impl Search {
    pub fn new(scene: &Scene, members: &[usize]) -> Self {
        let edges = edges(scene, members);
        let mut counters = EllisCounters::default();
        let generators = generators(scene, &edges, &mut counters);
        Self { edges, generators, counters, chosen: None }
    }

    /// Only the generator that is this face of that member; none, if the face is no generator.
    pub fn keep_only(&mut self, member: usize, face: usize) {
        let edges = &self.edges;
        let is_wanted = |edge: &Edge| edge.member == member && edge.face == face;
        self.generators.retain(|generator| is_wanted(&edges[generator.edge]));
    }

    /// The projection space of a generator.
    pub fn space_of(&self, scene: &Scene, generator: &Generator) -> ProjectionSpace {
        ProjectionSpace::new(scene, &self.edges, generator.edge, &generator.candidates)
    }

    /// Searches every generator's candidate set; stops as soon as a path is good enough.
    pub fn run(&mut self, best: &mut Best<'_>, settings: &PlanSettings, late: &dyn Fn() -> bool) {
        for generator in 0..self.generators.len() {
            let space = self.space_of(best.scene, &self.generators[generator]);
            self.counters.generators += 1;
            self.counters.candidates += space.sheaves.len() as u64 - 1;
            if self.pierce(generator, &space, best, settings, late).is_break() {
                return;
            }
        }
    }

    /// Offers the lines through one generator.
    fn pierce(
        &mut self,
        generator: usize,
        space: &ProjectionSpace,
        best: &mut Best<'_>,
        settings: &PlanSettings,
        late: &dyn Fn() -> bool,
    ) -> ControlFlow<()> {
        let examined = space.examined_slopes();
        self.counters.critical_points += examined.len() as u64;
        let slopes = space.compacted(examined);
        self.counters.critical_kept += slopes.len() as u64;
        for slope in slopes {
            if late() {
                return ControlFlow::Break(());
            }
            let Some(overlaps) = space.overlaps(slope) else { continue };
            self.counters.overlaps += space.sheaves.len() as u64 - 1;
            for position in space.starts(&overlaps) {
                let (angle, aside) = best.scene.numbers(&space.line(slope, position));
                let Some(line) = best.scene.line(angle, aside) else { continue };
                if best.num_judged >= settings.effort {
                    return ControlFlow::Break(());
                }
                if best.offer(&line) {
                    self.chosen = Some(Chosen { generator, slope, position });
                }
                self.counters.paths += 1;
                if best.enough(settings.stop) {
                    return ControlFlow::Break(());
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// The thesis's search among the members of `best`.
pub(crate) fn ellis(best: &mut Best<'_>, settings: &PlanSettings, late: &dyn Fn() -> bool) -> EllisCounters {
    let mut search = Search::new(best.scene, best.members);
    search.run(best, settings, late);
    search.counters
}

fn edges(scene: &Scene, members: &[usize]) -> Vec<Edge> {
    let mut edges = Vec::new();
    for (place, &member) in members.iter().enumerate() {
        let placement = Placement::new(&scene.poses[member], &scene.views[member]);
        for (number, face) in scene.shadows[member].model().faces.iter().enumerate() {
            if !face.is_touchable() {
                continue;
            }
            let at = |pose: Pose| {
                let normal = pose.rotation.rotate(face.normal);
                let ends =
                    [face.start, face.end].map(|end| pose.apply(end) + scene.sensor.tip_radius * normal);
                Placed { ends, normal }
            };
            edges.push(Edge {
                member: place,
                face: number,
                sensed: placement.sensed[number],
                half: placement.half,
                nominal: at(placement.nominal),
                extremes: placement.extremes.map(at),
            });
        }
    }
    edges
}

/// The candidate set of each face that was not sensed, those with the most hypotheses in it first.
///
/// Two faces can be pierced by one line if their normals are within 2Ω, and both rotation half ranges, of each other
/// (row 56). Sensed faces are candidates too (row 68).
fn generators(scene: &Scene, edges: &[Edge], counters: &mut EllisCounters) -> Vec<Generator> {
    let mut sets: Vec<Vec<usize>> = edges.iter().map(|_| Vec::new()).collect();
    counters.sensed = edges.iter().filter(|edge| edge.sensed).count() as u64;
    counters.unsensed = edges.len() as u64 - counters.sensed;
    for (k, a) in edges.iter().enumerate() {
        for (j, b) in edges[..k].iter().enumerate().filter(|(_, b)| !(a.sensed && b.sensed)) {
            counters.inner_products += 1;
            let widest = 2.0 * scene.sensor.max_incidence + a.half + b.half;
            if a.nominal.normal.dot(b.nominal.normal) >= widest.min(PI).cos() {
                sets[k].push(j);
                sets[j].push(k);
            }
        }
    }
    let mut generators: Vec<Generator> = sets
        .into_iter()
        .enumerate()
        .filter(|(edge, _)| !edges[*edge].sensed)
        .map(|(edge, mut candidates)| {
            candidates.sort_unstable();
            let mut present: Vec<usize> = candidates.iter().map(|k| edges[*k].member).collect();
            present.push(edges[edge].member);
            present.sort_unstable();
            present.dedup();
            Generator { edge, candidates, num_hypotheses: present.len() }
        })
        .collect();
    generators.sort_by_key(|one| (usize::MAX - one.num_hypotheses, one.edge));
    generators
}
