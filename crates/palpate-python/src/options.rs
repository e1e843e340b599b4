//! Keyword arguments that planning functions share. What is given stands in the place of the core's defaults.

use std::time::{Duration, Instant};

use glam::DVec3;
use palpate::Line;
use palpate::recognize::Halt;
use palpate::{PlanSettings, Planner, Stop, TreeMethod, TreeSettings};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyBoolMethods, PyDict};

use crate::convert::{corners, members, number, raise, refuse, text, vector, whole};
use crate::dimension::Vector;
use crate::recognize::kinds;

type Any<'py> = Bound<'py, PyAny>;

/// What the judge must know.
pub(crate) const JUDGED: &[&str] = &["features", "avoid_assigned", "margin", "seed"];
/// Where paths may run.
pub(crate) const PLACED: &[&str] = &["workspace", "directions"];
/// How a planner searches.
pub(crate) const SEARCHED: &[&str] =
    &["planner", "stop", "time_limit", "effort", "cells", "directions_tried"];
/// What was done before.
pub(crate) const REMEMBERED: &[&str] = &["tried"];
/// How a tree is built.
pub(crate) const GROWN: &[&str] = &["method", "max_nodes"];

/// A year: longer than any search, and no sum of it with a time overflows.
const LONGEST: f64 = 3.2e7;

/// Settings of the core, and what is not its business.
pub(crate) struct Options<V> {
    pub settings: PlanSettings<V>,
    pub tree: TreeSettings,
    pub time_limit: Option<Duration>,
    cells: Option<usize>,
    directions_tried: Option<usize>,
}

impl<V: Vector> Options<V> {
    /// Those of a call of `function`, which takes the names in `known`.
    pub fn read(function: &str, given: Option<&Bound<'_, PyDict>>, known: &[&[&str]]) -> PyResult<Self> {
        let mut options = Self {
            settings: PlanSettings::default(),
            tree: TreeSettings::default(),
            time_limit: None,
            cells: None,
            directions_tried: None,
        };
        for (name, value) in given.into_iter().flatten() {
            let name: String = name.extract()?;
            if !known.iter().any(|names| names.contains(&name.as_str())) {
                let message = format!("{function}() got an unexpected keyword argument '{name}'");
                return Err(PyTypeError::new_err(message));
            }
            options.set(&name, &value)?;
        }
        options.set_grid()?;
        Ok(options)
    }

    fn set(&mut self, name: &str, value: &Any<'_>) -> PyResult<()> {
        const OPTIONAL: [&str; 8] = [
            "features",
            "workspace",
            "directions",
            "time_limit",
            "effort",
            "cells",
            "directions_tried",
            "max_nodes",
        ];
        if value.is_none() && OPTIONAL.contains(&name) {
            return Ok(());
        }
        let settings = &mut self.settings;
        match name {
            "planner" => settings.planner = planner::<V>(value)?,
            "stop" => settings.stop = stop(value)?,
            "workspace" => settings.workspace = Some(corners("workspace", value)?),
            "directions" => settings.directions = Some(directions(value)?),
            "tried" => settings.tried = lines("tried", value)?,
            "time_limit" => self.time_limit = Some(time_limit(value)?),
            "effort" => settings.effort = whole(name, value, 1)?,
            "seed" => settings.seed = whole(name, value, 0)?,
            "margin" => settings.margin = number(name, value)?,
            "avoid_assigned" => settings.avoid_assigned = truth(name, value)?,
            "cells" => self.cells = Some(whole(name, value, 1)? as usize),
            "directions_tried" => self.directions_tried = Some(whole(name, value, 1)? as usize),
            "method" => self.tree.method = method(value)?,
            "max_nodes" => self.tree.max_nodes = whole(name, value, 0)? as usize,
            _ => {
                let in_space = V::DIMENSION == DVec3::DIMENSION;
                let kinds = kinds(value, in_space)?;
                if kinds.is_empty() {
                    let others =
                        if in_space { "\"edge\", \"vertex\" or several" } else { "\"vertex\" or both" };
                    let remedy = format!("give \"face\", {others}");
                    return Err(refuse("features", "must not be empty", value, &remedy));
                }
                let named = |name: &str| kinds.iter().any(|kind| kind == name);
                settings.faces = named("face");
                settings.edges = Some(named("edge"));
                settings.vertices = Some(named("vertex"));
            }
        }
        Ok(())
    }

    /// Puts the grid into the planner that has one.
    fn set_grid(&mut self) -> PyResult<()> {
        let mut rest = [("cells", self.cells), ("directions_tried", self.directions_tried)];
        match &mut self.settings.planner {
            Planner::Grimson { cells, directions } => {
                *cells = rest[0].1.take().unwrap_or(*cells);
                *directions = rest[1].1.take().unwrap_or(*directions);
            }
            Planner::Schneiter { cells } => *cells = rest[0].1.take().unwrap_or(*cells),
            _ => {}
        }
        match rest.into_iter().find_map(|(name, value)| Some((name, value?))) {
            Some((name, value)) => {
                let problem = "the planner has no such grid";
                let remedy = "leave it out, or plan with \"grimson\" or, for cells, \"schneiter\"";
                Err(raise(palpate::Error::new(name, problem, value, remedy)))
            }
            None => Ok(()),
        }
    }

    /// When the search, which begins now, must end.
    pub fn deadline(&self) -> Deadline {
        Deadline::after(self.time_limit)
    }
}

/// Past its deadline, a call looks so often whether the work has ended.
const LEAST_PAUSE: Duration = Duration::from_millis(1);

/// When a search must end, if at all.
#[derive(Clone, Copy)]
pub(crate) struct Deadline(Option<Instant>);

impl Deadline {
    pub const NEVER: Self = Self(None);

    /// So long after now, if it is given.
    pub fn after(limit: Option<Duration>) -> Self {
        #[expect(clippy::disallowed_methods, reason = "the caller's time limit")]
        Self(limit.map(|limit| Instant::now() + limit))
    }

    /// What is left until then, but no more than `most`.
    pub fn left(self, most: Duration) -> Duration {
        #[expect(clippy::disallowed_methods, reason = "the caller's time limit")]
        self.0.map_or(most, |end| end.saturating_duration_since(Instant::now()).clamp(LEAST_PAUSE, most))
    }

    pub fn passed(self) -> bool {
        #[expect(clippy::disallowed_methods, reason = "the caller's time limit")]
        self.0.is_some_and(|end| Instant::now() >= end)
    }

    /// Passed, or halted from outside.
    pub fn late(self, halt: &Halt) -> bool {
        halt.load(std::sync::atomic::Ordering::Relaxed) || self.passed()
    }
}

/// A planner of the plane or of space. Whether it is of the dimension is for the core to say.
fn planner<V: Vector>(value: &Any<'_>) -> PyResult<Planner> {
    let unknown = || refuse("planner", "unknown planner", value, &Planner::remedy::<V>());
    Planner::named::<V>(&text("planner", value)?).ok_or_else(unknown)
}

fn method(value: &Any<'_>) -> PyResult<TreeMethod> {
    match text("method", value)?.as_str() {
        "greedy" => Ok(TreeMethod::Greedy),
        "ahead" => Ok(TreeMethod::Ahead),
        "optimal" => Ok(TreeMethod::Optimal),
        _ => Err(refuse("method", "unknown method", value, "give \"greedy\", \"ahead\" or \"optimal\"")),
    }
}

fn stop(value: &Any<'_>) -> PyResult<Stop> {
    let complain = || {
        let remedy = "give \"perfect\", (\"unique\", 2) or (\"share\", 0.5)";
        refuse("stop", "must say when a path is good enough", value, remedy)
    };
    if let Ok(name) = value.extract::<String>() {
        return if name == "perfect" { Ok(Stop::Perfect) } else { Err(complain()) };
    }
    let (name, amount) = value.extract::<(String, Any<'_>)>().map_err(|_| complain())?;
    match name.as_str() {
        "unique" => Ok(Stop::Unique(whole("stop", &amount, 1)? as usize)),
        "share" => Ok(Stop::Share(number("stop", &amount)?)),
        _ => Err(complain()),
    }
}

fn directions<V: Vector>(value: &Any<'_>) -> PyResult<(V, f64)> {
    let components = ["dx", "dy", "dz"][..V::DIMENSION].join(", ");
    let remedy = format!("give (({components}), half_angle), the angle in radians");
    let parts = members("directions", value, "a direction and a half angle", &remedy)?;
    let [axis, half] = parts.as_slice() else {
        return Err(refuse("directions", "must be a direction and a half angle", value, &remedy));
    };
    let axis: V = vector("directions[0]", axis)?;
    // Of a length whose square is no number it would be no direction.
    let extreme = !axis.dot(axis).is_normal();
    let axis = if extreme { palpate::plan::normalized(axis).unwrap_or(axis) } else { axis };
    Ok((axis, number("directions[1]", half)?))
}

/// Lines, each a start and a direction, which is made unit.
fn lines<V: Vector>(argument: &str, value: &Any<'_>) -> PyResult<Vec<Line<V>>> {
    let listed = members(argument, value, "lines", "give [(path.start, path.direction), ...]")?;
    let read = |(k, pair): (usize, &Any<'_>)| {
        let place = format!("{argument}[{k}]");
        let [start, direction] = ends(&place, pair)?;
        let start = vector(&format!("{place}[0]"), &start)?;
        Ok(Line { start, direction: crate::convert::direction(&format!("{place}[1]"), &direction)? })
    };
    listed.iter().enumerate().map(read).collect()
}

/// A start and a direction, as they are.
pub(crate) fn line<V: Vector>(argument: &str, value: &Any<'_>) -> PyResult<Line<V>> {
    let [start, direction] = ends(argument, value)?;
    let read = |k: usize, value: &Any<'_>| vector(&format!("{argument}[{k}]"), value);
    Ok(Line { start: read(0, &start)?, direction: read(1, &direction)? })
}

fn ends<'py>(argument: &str, value: &Any<'py>) -> PyResult<[Any<'py>; 2]> {
    let remedy = "give (path.start, path.direction)";
    let ends = members(argument, value, "a start and a direction", remedy)?;
    ends.try_into().map_err(|_| refuse(argument, "must be a start and a direction", value, remedy))
}

pub(crate) fn time_limit(value: &Any<'_>) -> PyResult<Duration> {
    let seconds = number("time_limit", value)?;
    if seconds > 0.0 && seconds.is_finite() {
        return Ok(Duration::from_secs_f64(seconds.min(LONGEST)));
    }
    Err(refuse("time_limit", "must be above zero and finite", value, "give seconds, or leave it out"))
}

fn truth(argument: &str, value: &Any<'_>) -> PyResult<bool> {
    let read = value.cast::<PyBool>().map(PyBoolMethods::is_true);
    read.map_err(|_| refuse(argument, "must be True or False", value, "give a bool"))
}
