//! The best path so far: to it planners offer lines, and it asks the judge.

use std::cmp::Ordering;

use glam::DVec2;

use crate::dimension::Dimension;
use crate::judge::{Outcome, Verdict};
use crate::line::Line;
use crate::path::{Path, judged, rounded_margin, rounded_score};
use crate::plan::Stop;
use crate::scene::{Scene, Shadow};

/// What makes a path the best.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Aim {
    /// Its score: pairs that it does not separate.
    #[default]
    Score,
    /// `Σ (size of a class)²`, `n` times the expected size of a branch of the ambiguity tree. No less than the pairs
    /// that are not separated, so that what bounds these bounds it as well.
    Branches,
}

/// Is told of lines.
pub type Listener<'a, V> = &'a mut dyn FnMut(&Line<V>);

/// The best path so far.
pub struct Best<'a, V: Dimension = DVec2> {
    pub scene: &'a Scene<V>,
    pub members: &'a [usize],
    pub path: Option<Path<V>>,
    pub num_judged: u64,
    pub aim: Aim,
    /// What `path` leaves, as the aim counts it.
    left: usize,
    /// Lines are judged even if they can't become the best.
    pub thorough: bool,
    /// Is told of every line that is judged, whether it can be used or not.
    pub listener: Option<Listener<'a, V>>,
}

impl<'a, V: Dimension> Best<'a, V> {
    pub fn new(scene: &'a Scene<V>, members: &'a [usize]) -> Self {
        Self {
            scene,
            members,
            path: None,
            num_judged: 0,
            aim: Aim::Score,
            left: 0,
            thorough: false,
            listener: None,
        }
    }

    /// The number of pairs that the best path leaves, as the aim counts them; more than any if there is none.
    pub fn num_left(&self) -> usize {
        let n = self.members.len();
        if self.path.is_some() { self.left } else { n * n + 1 }
    }

    /// Whether a line that leaves so many pairs at least need not be judged.
    pub fn hopeless(&self, left: usize) -> bool {
        !self.thorough && left > self.num_left()
    }

    /// Judges a line; it becomes the best if it is better. Whether it is.
    pub fn offer(&mut self, line: &Line<V>) -> bool {
        self.num_judged += 1;
        if let Some(listener) = &mut self.listener {
            listener(line);
        }
        let Some(outcomes) = self.scene.outcomes(line, self.members, 0.0) else { return false };
        let verdict = Verdict::new(&outcomes, &self.scene.sensor);
        let left = match self.aim {
            Aim::Score => verdict.num_left(),
            Aim::Branches => verdict.classes().iter().map(|class| class.len().pow(2)).sum(),
        };
        let certain = verdict.num_left() < self.members.len().pow(2);
        if left > self.num_left() || (!certain && self.scene.was_tried(line)) {
            return false;
        }
        if left == self.left && self.comes_after(line, &outcomes, &verdict) {
            return false;
        }
        let path = judged(self.scene, self.members, line, None);
        // What was not judged to the end is no path.
        if path.fault.is_some() || (V::Shadow::SLOW && self.scene.is_halted()) {
            return false;
        }
        let order = |known: &Path<V>| left.cmp(&self.left).then_with(|| path.order(known, self.scene.margin));
        let better = self.path.as_ref().is_none_or(|known| order(known) == Ordering::Less);
        if better {
            self.path = Some(path);
            self.left = left;
        }
        better
    }

    /// Whether a line is known to come after the best path, before its own margin is.
    fn comes_after(&self, line: &Line<V>, outcomes: &[Outcome<V>], verdict: &Verdict) -> bool {
        let Some(known) = &self.path else { return false };
        let (scene, members) = (self.scene, self.members);
        let expected = || {
            let score = scene.expected_score(line, members, outcomes, f64::INFINITY);
            rounded_score(score, members.len()).total_cmp(&rounded_score(known.expected_score, members.len()))
        };
        match verdict.score().total_cmp(&known.score).then_with(expected) {
            Ordering::Less => false,
            Ordering::Greater => true,
            Ordering::Equal => {
                let least = rounded_margin(known.margin, scene.margin) - 0.5;
                least > 0.0 && !scene.keeps(line, members, verdict, least * scene.margin)
            }
        }
    }

    pub fn enough(&self, stop: Stop) -> bool {
        self.path.as_ref().is_some_and(|path| path.enough(stop, self.scene.margin))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::Ordering::Relaxed;

    use glam::{DVec2, dvec2};

    use super::*;
    use crate::plane::Model;
    use crate::recognize::Halt;
    use crate::{Contact, Evidence, Normal, PlanSettings, Sensor, Settings, plan, recognize};

    /// In the plane no outcome is cut short. A proof goes by what was offered, and would be wrong without it.
    #[test]
    fn what_was_judged_to_the_end_counts_though_time_is_up() {
        let block = |height: f64| {
            let corners = [(0.0, 0.0), (50.0, 0.0), (50.0, height), (0.0, height)].map(DVec2::from);
            Arc::new(Model::polygon("block", &corners, &[], &[], 0.0, 0.0).expect("an outline"))
        };
        let touched =
            [(dvec2(20.0, 0.0), -DVec2::Y), (dvec2(0.0, 10.0), -DVec2::X), (dvec2(50.0, 10.0), DVec2::X)];
        let contacts = touched.map(|(at, normal)| {
            let normal = Normal::new(normal, 0.05).expect("bounds are valid");
            Contact::new(at, 0.0, 0.5).expect("bounds are valid").with_normal(normal)
        });
        let evidence = Evidence { contacts: contacts.into(), ..Evidence::default() };
        let models = [block(20.0), block(40.0)];
        let hypotheses = recognize(&models, &evidence, &Settings::default()).expect("well-formed").hypotheses;
        let sensor = Sensor::new(0.5, Some(0.05), 1.0).expect("bounds are valid");
        let settings = PlanSettings::default();
        let path = plan(&hypotheses, &sensor, &settings).expect("well-formed").path.expect("they differ");

        let halt = Halt::default();
        halt.store(true, Relaxed);
        let scene = Scene::new(&hypotheses, &sensor, &settings).until(&halt);
        let members = scene.everyone();
        assert!(Best::new(&scene, &members).offer(&path.line));
    }
}
