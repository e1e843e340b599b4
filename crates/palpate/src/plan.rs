//! Planning: the path that tells the hypotheses apart best (thesis, chapter 3).

use std::f64::consts::PI;

use glam::DVec2;

use crate::Error;
use crate::best::Best;
use crate::dimension::Dimension;
use crate::hypothesis::Hypothesis;
use crate::line::Line;
use crate::path::{Path, judged};
use crate::recognize::{Halt, check_reach, check_tip};
use crate::scene::Scene;
use crate::sensor::Sensor;

pub use crate::plane::planners::EllisCounters;
pub use crate::planner::Planner;
pub use crate::prepared::Prepared;

/// When a path is good enough.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Stop {
    /// Nothing less than a path that separates all.
    #[default]
    Perfect,
    /// It identifies so many hypotheses, whichever of them is true.
    Unique(usize),
    /// It identifies this share of them.
    Share(f64),
}

/// How to plan. The defaults are stated here and nowhere else.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanSettings<V = DVec2> {
    /// Where candidates come from.
    pub planner: Planner,
    /// When one is good enough.
    pub stop: Stop,
    /// Two opposite corners, the lower one first, of the area at whose border paths begin; `None`: anywhere outside of all hypotheses.
    pub workspace: Option<[V; 2]>,
    /// A unit vector and an angle: directions of travel within it are allowed. `None`: all.
    pub directions: Option<(V, f64)>,
    /// m, relative to the size of the largest part.
    pub margin: f64,
    /// Boxes of lines that `complete` may examine, lines that the thesis's planners may judge, at most.
    pub effort: u64,
    /// For what is drawn at random.
    pub seed: u64,
    /// Faces may be touched.
    pub faces: bool,
    /// Edges may be touched, in space; `None`: if the tip has a radius.
    pub edges: Option<bool>,
    /// Vertices may be touched; `None`: if the tip has a radius.
    pub vertices: Option<bool>,
    /// Never touch a face that a contact is assigned to (thesis 1.1).
    pub avoid_assigned: bool,
    /// Lines that were moved along before. One within m of them is no answer, unless it is certain to tell something.
    pub tried: Vec<Line<V>>,
}

impl<V> Default for PlanSettings<V> {
    fn default() -> Self {
        Self {
            planner: Planner::default(),
            stop: Stop::default(),
            workspace: None,
            directions: None,
            margin: 1e-3,
            effort: 2_000_000,
            seed: 0,
            faces: true,
            edges: None,
            vertices: None,
            avoid_assigned: false,
            tried: Vec::new(),
        }
    }
}

/// The answer of a planner.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan<V: Dimension = DVec2> {
    /// The best path found; `None`: none that can be used was found.
    pub path: Option<Path<V>>,
    /// No usable path of margin ≥ m has a score below this.
    pub bound: f64,
    /// No usable path of margin ≥ m has a better score than the one found (`docs/theory.md`, T13).
    pub proved: bool,
    /// Lines judged.
    pub num_judged: u64,
    /// Boxes of lines examined.
    pub num_boxes: u64,
    /// What the thesis's own search did, if it was asked for.
    pub counters: Option<EllisCounters>,
}

/// The best path found by the planner among the hypotheses.
///
/// # Errors
/// No hypotheses, or a setting out of range.
pub fn plan<V: Dimension>(
    hypotheses: &[Hypothesis<V>],
    sensor: &Sensor,
    settings: &PlanSettings<V>,
) -> Result<Plan<V>, Error> {
    plan_until(hypotheses, sensor, settings, &Halt::default())
}

/// The best path found before `halt` is set.
///
/// # Errors
/// As [`plan`].
pub fn plan_until<V: Dimension>(
    hypotheses: &[Hypothesis<V>],
    sensor: &Sensor,
    settings: &PlanSettings<V>,
    halt: &Halt,
) -> Result<Plan<V>, Error> {
    check(hypotheses, sensor, settings)?;
    let scene = Scene::new(hypotheses, sensor, settings).until(halt);
    Ok(plan_among(&scene, &scene.everyone(), settings, &|| scene.is_halted()))
}

/// What a line of your own would tell, and whether it can be used. `length`: as long as needed, if not given.
///
/// A direction that is a unit vector is kept bit for bit: the line of a path gives that path again.
///
/// # Errors
/// No hypotheses, a direction of no length, a length that is not above zero, numbers that are not finite.
pub fn judge<V: Dimension>(
    hypotheses: &[Hypothesis<V>],
    sensor: &Sensor,
    line: Line<V>,
    length: Option<f64>,
    settings: &PlanSettings<V>,
) -> Result<Path<V>, Error> {
    check(hypotheses, sensor, settings)?;
    if let Some(length) = length.filter(|length| !(length.is_finite() && *length > 0.0)) {
        let remedy = "leave it out to go past the last possible contact";
        return Err(Error::new("length", "must be above zero and finite", length, remedy));
    }
    let scene = Scene::new(hypotheses, sensor, settings);
    let line = checked_line(line, scene.size)?;
    Ok(judged(&scene, &scene.everyone(), &line, length))
}

/// A line of the caller's, its direction made unit, among parts of this size.
pub(crate) fn checked_line<V: Dimension>(line: Line<V>, size: f64) -> Result<Line<V>, Error> {
    let Some(direction) = unit(line.direction).filter(|_| line.start.is_finite()) else {
        return Err(Error::new(
            "direction",
            "must not be zero",
            line.direction,
            "give a direction, of any length",
        ));
    };
    check_reach("start", line.start.coordinates(), size)?;
    Ok(Line { direction, ..line })
}

/// Made unit, whatever its length, but zero.
#[must_use]
pub fn normalized<V: Dimension>(direction: V) -> Option<V> {
    let largest = direction.largest_coordinate();
    if largest.is_finite() { (direction / largest).try_normalize() } else { None }
}

/// The direction itself, if it is a unit vector to rounding.
pub(crate) fn unit<V: Dimension>(direction: V) -> Option<V> {
    let is_unit = (direction.dot(direction) - 1.0).abs() <= 4.0 * f64::EPSILON;
    if is_unit { Some(direction) } else { normalized(direction) }
}

/// Plans among some of the hypotheses; the path's numbers are places in `members`. `late` says that time is up.
pub(crate) fn plan_among<V: Dimension>(
    scene: &Scene<V>,
    members: &[usize],
    settings: &PlanSettings<V>,
    late: &dyn Fn() -> bool,
) -> Plan<V> {
    plan_with(Best::new(scene, members), settings, late)
}

/// Plans as `best` says: among its members, by its aim.
pub(crate) fn plan_with<V: Dimension>(
    mut best: Best<'_, V>,
    settings: &PlanSettings<V>,
    late: &dyn Fn() -> bool,
) -> Plan<V> {
    let none = |bound| Plan { path: None, bound, proved: true, num_judged: 0, num_boxes: 0, counters: None };
    if best.members.len() < 2 {
        return none(1.0);
    }
    if best.scene.begins_inside(best.members) {
        return none(best.members.len() as f64);
    }
    let (proof, counters) = V::propose(&mut best, settings, late);
    let perfect = best.path.as_ref().is_some_and(|path| path.score <= 1.0);
    let path = best.path;
    // Where lines were tried, none may be left that can be used though some could.
    let answered = path.is_some() || settings.tried.is_empty();
    Plan {
        bound: if perfect { 1.0 } else { proof.bound },
        proved: perfect || (proof.proved && answered),
        path,
        num_judged: best.num_judged,
        num_boxes: proof.num_boxes,
        counters,
    }
}

pub(crate) fn check<V: Dimension>(
    hypotheses: &[Hypothesis<V>],
    sensor: &Sensor,
    settings: &PlanSettings<V>,
) -> Result<(), Error> {
    if hypotheses.is_empty() {
        return Err(Error::new(
            "hypotheses",
            "must not be empty",
            "[]",
            "give found.hypotheses of a recognition",
        ));
    }
    settings.planner.check::<V>()?;
    let size = hypotheses.iter().map(|one| V::size(&one.model)).fold(0.0, f64::max);
    check_reach("position_error", &[sensor.position_error], size)?;
    check_reach("path_error", &[sensor.path_error], size)?;
    check_tip("tip_radius", sensor.tip_radius, size)?;
    if let Some(stem) = sensor.stem {
        if V::AXES.len() < 3 {
            return Err(Error::new("stem", "is of space only", stem.direction, "leave it out in the plane"));
        }
        check_reach("stem", &[stem.radius, stem.length], size)?;
    }
    if !(1e-6..=0.1).contains(&settings.margin) {
        let remedy = "give a share of the part's size from 1e-6 to 0.1, such as 1e-3";
        return Err(Error::new("margin", "is out of range", settings.margin, remedy));
    }
    if let Some([low, high]) = settings.workspace
        && !(low.is_finite() && high.is_finite() && is_below(low, high))
    {
        let value = format!("{low}, {high}");
        return Err(Error::new(
            "workspace",
            "must be two opposite corners, the lower one first",
            value,
            "give the least of all coordinates, then the largest",
        ));
    }
    if let Some([low, high]) = settings.workspace {
        check_reach("workspace", &[low.coordinates(), high.coordinates()].concat(), size)?;
    }
    if let Some((axis, half)) = settings.directions {
        if normalized(axis).is_none() {
            let components = ["dx", "dy", "dz"][..V::AXES.len()].join(", ");
            let remedy = format!("give (({components}), half_angle), of any length but zero");
            return Err(Error::new("directions", "must not point nowhere", axis, remedy));
        }
        if !(0.0..=PI).contains(&half) {
            let remedy = "give radians; π allows all directions";
            return Err(Error::new("directions", "the half angle must be from 0 to π", half, remedy));
        }
    }
    if let Stop::Share(share) = settings.stop
        && !(share > 0.0 && share <= 1.0)
    {
        return Err(Error::new(
            "stop",
            "the share must be above 0 and at most 1",
            share,
            "give (\"share\", 0.5)",
        ));
    }
    Ok(())
}

/// Whether each coordinate is less than the other's.
fn is_below<V: Dimension>(low: V, high: V) -> bool {
    low.coordinates().iter().zip(high.coordinates()).all(|(low, high)| low < high)
}
