//! Planning: the path that tells the hypotheses apart best (thesis, chapter 3).

use std::f64::consts::PI;

use glam::DVec2;

use crate::best::Best;
use crate::hypothesis::Hypothesis;
use crate::line::Line;
use crate::path::{Path, judged};
use crate::plane::Scene;
use crate::plane::planners;
use crate::recognize::{check_reach, check_tip};
use crate::{Dimension, Error};

pub use crate::plane::planners::EllisCounters;
use crate::sensor::Sensor;

/// Where candidate paths come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Planner {
    /// Quick: lines in evenly spaced directions, the most promising judged; where that tells nothing, `grimson` and then
    /// `complete`.
    #[default]
    Auto,
    /// All lines, by branch and bound: no usable path of margin ≥ m is better.
    Complete,
    /// The thesis's own search: lines through generators, at critical slopes (3.1 to 3.3, 4.1).
    Ellis,
    /// Grimson's: renderings in fixed directions, searched by divide and conquer (5.4.2).
    Grimson {
        /// Buckets of each rendering.
        cells: usize,
        /// Directions, evenly spaced.
        directions: usize,
    },
    /// Schneiter's: from the boundary of the union to that of the intersection, past blocking boundaries (5.4.3).
    Schneiter {
        /// Cells along each side of the plane's grid.
        cells: usize,
    },
}

impl Planner {
    /// Grimson's, with the usual grid.
    pub const GRIMSON: Self = Self::Grimson { cells: Self::USUAL_GRID[0], directions: Self::USUAL_GRID[1] };

    /// Cells and directions.
    const USUAL_GRID: [usize; 2] = [256, 72];

    /// Schneiter's, with the usual grid.
    pub const SCHNEITER: Self = Self::Schneiter { cells: 256 };

    /// A grid is to have enough cells to show a part, and few enough to fit into memory.
    fn check(self) -> Result<(), Error> {
        let within = |argument: &str, value: usize, [low, high]: [usize; 2]| {
            if (low..=high).contains(&value) {
                return Ok(());
            }
            let problem = format!("must be from {low} to {high}");
            Err(Error::new(argument, problem, value, "leave it out for the usual grid"))
        };
        match self {
            Self::Grimson { cells, directions } => {
                within("cells", cells, [8, 16384])?;
                within("directions_tried", directions, [1, 7200])
            }
            Self::Schneiter { cells } => within("cells", cells, [8, 2048]),
            Self::Auto | Self::Complete | Self::Ellis => Ok(()),
        }
    }
}

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
pub struct PlanSettings {
    /// Where candidates come from.
    pub planner: Planner,
    /// When one is good enough.
    pub stop: Stop,
    /// Two opposite corners of the area at whose border paths begin; `None`: anywhere outside of all hypotheses.
    pub workspace: Option<[DVec2; 2]>,
    /// A unit vector and an angle: directions of travel within it are allowed. `None`: all.
    pub directions: Option<(DVec2, f64)>,
    /// m, relative to the size of the largest part.
    pub margin: f64,
    /// Boxes of lines that `complete` may examine, lines that the thesis's planners may judge, at most.
    pub effort: u64,
    /// For what is drawn at random.
    pub seed: u64,
    /// Faces may be touched.
    pub faces: bool,
    /// Vertices may be touched; `None`: if the tip has a radius.
    pub vertices: Option<bool>,
    /// Never touch a face that a contact is assigned to (thesis 1.1).
    pub avoid_assigned: bool,
    /// Lines that were moved along before. One within m of them is no answer, unless it is certain to tell something.
    pub tried: Vec<Line>,
}

impl Default for PlanSettings {
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
            vertices: None,
            avoid_assigned: false,
            tried: Vec::new(),
        }
    }
}

/// The answer of a planner.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The best path found; `None`: none that can be used was found.
    pub path: Option<Path>,
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
pub fn plan(hypotheses: &[Hypothesis], sensor: &Sensor, settings: &PlanSettings) -> Result<Plan, Error> {
    plan_until(hypotheses, sensor, settings, &|| false)
}

/// The best path found before `late` says that time is up.
///
/// # Errors
/// As [`plan`].
pub fn plan_until(
    hypotheses: &[Hypothesis],
    sensor: &Sensor,
    settings: &PlanSettings,
    late: &dyn Fn() -> bool,
) -> Result<Plan, Error> {
    check(hypotheses, sensor, settings)?;
    let scene = Scene::new(hypotheses, sensor, settings);
    Ok(plan_among(&scene, &scene.everyone(), settings, late))
}

/// What a line of your own would tell, and whether it can be used. `length`: as long as needed, if not given.
///
/// A direction that is a unit vector is kept bit for bit: the line of a path gives that path again.
///
/// # Errors
/// No hypotheses, a direction of no length, a length that is not above zero, numbers that are not finite.
pub fn judge(
    hypotheses: &[Hypothesis],
    sensor: &Sensor,
    line: Line,
    length: Option<f64>,
    settings: &PlanSettings,
) -> Result<Path, Error> {
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
pub(crate) fn checked_line(line: Line, size: f64) -> Result<Line, Error> {
    let Some(direction) = unit(line.direction).filter(|_| line.start.is_finite()) else {
        return Err(Error::new(
            "direction",
            "must not be zero",
            line.direction,
            "give a direction, of any length",
        ));
    };
    check_reach("start", &line.start.to_array(), size)?;
    Ok(Line { direction, ..line })
}

/// Made unit, whatever its length, but zero.
#[must_use]
pub fn normalized<V: Dimension>(direction: V) -> Option<V> {
    let largest = direction.largest_coordinate();
    if largest.is_finite() { (direction / largest).try_normalize() } else { None }
}

/// The direction itself, if it is a unit vector to rounding.
fn unit(direction: DVec2) -> Option<DVec2> {
    let is_unit = (direction.length_squared() - 1.0).abs() <= 4.0 * f64::EPSILON;
    if is_unit { Some(direction) } else { normalized(direction) }
}

/// Plans among some of the hypotheses; the path's numbers are places in `members`. `late` says that time is up.
pub(crate) fn plan_among(
    scene: &Scene,
    members: &[usize],
    settings: &PlanSettings,
    late: &dyn Fn() -> bool,
) -> Plan {
    plan_with(Best::new(scene, members), settings, late)
}

/// Plans as `best` says: among its members, by its aim.
pub(crate) fn plan_with(mut best: Best<'_>, settings: &PlanSettings, late: &dyn Fn() -> bool) -> Plan {
    if best.members.len() < 2 {
        return Plan { path: None, bound: 1.0, proved: true, num_judged: 0, num_boxes: 0, counters: None };
    }
    if best.scene.begins_inside(best.members) {
        let bound = best.members.len() as f64;
        return Plan { path: None, bound, proved: true, num_judged: 0, num_boxes: 0, counters: None };
    }
    let mut proof = planners::Proof { bound: 1.0, proved: false, num_boxes: 0 };
    let mut counters = None;
    match settings.planner {
        Planner::Auto | Planner::Complete => {
            planners::sweep(&mut best, settings.stop, late);
            let tells = |best: &Best<'_>| best.num_left() < best.members.len().pow(2);
            let twins = best.scene.one_part_at_one_pose(best.members);
            if twins && best.path.is_some() {
                proof = planners::Proof { bound: best.members.len() as f64, proved: true, num_boxes: 0 };
            } else if settings.planner == Planner::Auto && !tells(&best) {
                planners::grimson(&mut best, Planner::USUAL_GRID, settings, late);
            }
            if !proof.proved && (settings.planner == Planner::Complete || !tells(&best)) {
                proof = planners::complete(&mut best, settings, late);
            }
        }
        Planner::Ellis => counters = Some(planners::ellis(&mut best, settings, late)),
        Planner::Grimson { cells, directions } => {
            planners::grimson(&mut best, [cells, directions], settings, late);
        }
        Planner::Schneiter { cells } => planners::schneiter(&mut best, cells, settings, late),
    }
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

pub(crate) fn check(
    hypotheses: &[Hypothesis],
    sensor: &Sensor,
    settings: &PlanSettings,
) -> Result<(), Error> {
    if hypotheses.is_empty() {
        return Err(Error::new(
            "hypotheses",
            "must not be empty",
            "[]",
            "give found.hypotheses of a recognition",
        ));
    }
    settings.planner.check()?;
    let size = hypotheses.iter().map(|one| one.model.size).fold(0.0, f64::max);
    check_reach("position_error", &[sensor.position_error], size)?;
    check_reach("path_error", &[sensor.path_error], size)?;
    check_tip("tip_radius", sensor.tip_radius, size)?;
    if !(1e-6..=0.1).contains(&settings.margin) {
        let remedy = "give a share of the part's size from 1e-6 to 0.1, such as 1e-3";
        return Err(Error::new("margin", "is out of range", settings.margin, remedy));
    }
    if let Some([low, high]) = settings.workspace
        && !(low.is_finite() && high.is_finite() && low.cmplt(high).all())
    {
        let value = format!("{low}, {high}");
        return Err(Error::new(
            "workspace",
            "must be two opposite corners, the lower left one first",
            value,
            "give [[x0, y0], [x1, y1]]",
        ));
    }
    if let Some([low, high]) = settings.workspace {
        check_reach("workspace", &[low.to_array(), high.to_array()].concat(), size)?;
    }
    if let Some((axis, half)) = settings.directions {
        if normalized(axis).is_none() {
            let remedy = "give ((dx, dy), half_angle), of any length but zero";
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

/// Hypotheses made ready for many lines.
#[derive(Debug)]
pub struct Prepared {
    scene: Scene,
    members: Vec<usize>,
}

impl Prepared {
    /// For lines through all that the hypotheses may occupy.
    ///
    /// # Errors
    /// As [`plan`].
    pub fn new(hypotheses: &[Hypothesis], sensor: &Sensor, settings: &PlanSettings) -> Result<Self, Error> {
        check(hypotheses, sensor, settings)?;
        let scene = Scene::new(hypotheses, sensor, settings);
        let members = scene.everyone();
        Ok(Self { scene, members })
    }

    /// The radius of a circle around everything.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.scene.radius
    }

    /// The middle of that circle.
    #[must_use]
    pub fn middle(&self) -> DVec2 {
        self.scene.middle
    }

    /// The line of a direction that passes `aside` to the left of the middle of that circle; `None` if it is not allowed.
    #[must_use]
    pub fn line(&self, angle: f64, aside: f64) -> Option<Line> {
        self.scene.line(angle, aside)
    }

    /// No judgement of a line gives a score below this: what it leaves at one pose of each hypothesis. Quick.
    #[must_use]
    pub fn least_score(&self, line: &Line) -> f64 {
        let seen = |k: &usize| self.scene.contact(*k, self.scene.views[*k][0], line);
        let readings = self.members.iter().map(|k| seen(k).map(|at| (at.depth, at.normal.to_angle())));
        self.scene.num_alike(&readings.collect::<Vec<_>>()) as f64 / self.members.len() as f64
    }

    /// The score of a line; `None` if it can't be used.
    #[must_use]
    pub fn score(&self, line: &Line) -> Option<f64> {
        self.scene.verdict(line, &self.members, 0.0).map(|verdict| verdict.score())
    }

    /// All that is to say of a line.
    #[must_use]
    pub fn judge(&self, line: &Line) -> Path {
        judged(&self.scene, &self.members, line, None)
    }
}
