//! The projection space in which the thesis's search finds its path (3.1 to 3.3).

use crate::Error;
use crate::best::Best;
use crate::hypothesis::Hypothesis;
use crate::path::Path;
use crate::plan::{PlanSettings, check};
use crate::plane::planners::Search;
use crate::scene::Scene;
use crate::sensor::Sensor;

pub use crate::plane::planners::{CriticalPoint, Overlap, ProjectionSpace, Sheaf};

/// The projection space of one generator, and the best path found through it.
#[derive(Debug, Clone, PartialEq)]
pub struct Projection {
    /// The generator and its candidate set.
    pub space: ProjectionSpace,
    /// `None`: none that can be used was found, or there is nothing to tell apart.
    pub path: Option<ProjectedPath>,
}

/// A path as a point of projection space.
#[derive(Debug, Clone, PartialEq)]
pub struct ProjectedPath {
    /// What it would tell.
    pub path: Path,
    /// q: where its line crosses the generator's axis.
    pub position: f64,
    /// α.
    pub slope: f64,
}

/// A face of a hypothesis, by their numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FaceOf {
    /// The hypothesis' place among those given.
    pub hypothesis: usize,
    /// The face's number in its model.
    pub face: usize,
}

/// The projection space of a generator, with the best path that the thesis's search finds through it.
///
/// Without a generator it is the one through which the best path of all goes; where no path can be used, the one that is
/// searched first. `settings.planner` does not matter.
///
/// # Errors
/// As [`crate::plan()`]; a generator that does not exist, that can't be touched, or that a contact is assigned to; no
/// generator at all.
pub fn projection_space(
    hypotheses: &[Hypothesis],
    sensor: &Sensor,
    generator: Option<FaceOf>,
    settings: &PlanSettings,
) -> Result<Projection, Error> {
    projection_space_until(hypotheses, sensor, generator, settings, &|| false)
}

/// The same with the best path found before `late` says that time is up.
///
/// # Errors
/// As [`projection_space`].
pub fn projection_space_until(
    hypotheses: &[Hypothesis],
    sensor: &Sensor,
    generator: Option<FaceOf>,
    settings: &PlanSettings,
    late: &dyn Fn() -> bool,
) -> Result<Projection, Error> {
    check(hypotheses, sensor, settings)?;
    if let Some(wanted) = generator {
        check_generator(hypotheses, wanted)?;
    }
    let scene = Scene::new(hypotheses, sensor, settings);
    let members = scene.everyone();
    let mut search = Search::new(&scene, &members);
    if let Some(wanted) = generator {
        search.keep_only(wanted.hypothesis, wanted.face);
    }
    if search.generators.is_empty() {
        return Err(none_is_left(generator));
    }
    let mut best = Best::new(&scene, &members);
    if members.len() > 1 {
        search.run(&mut best, settings, late);
    }
    let chosen = search.chosen.as_ref();
    let generator = &search.generators[chosen.map_or(0, |chosen| chosen.generator)];
    let path = best.path.zip(chosen).map(|(path, chosen)| ProjectedPath {
        path,
        position: chosen.position,
        slope: chosen.slope,
    });
    Ok(Projection { space: search.space_of(&scene, generator), path })
}

fn check_generator(hypotheses: &[Hypothesis], wanted: FaceOf) -> Result<(), Error> {
    let FaceOf { hypothesis, face } = wanted;
    let refuse = |problem: &str, remedy: String| {
        Err(Error::new("generator", problem, format!("({hypothesis}, {face})"), remedy))
    };
    let Some(given) = hypotheses.get(hypothesis) else {
        let remedy = format!("give (hypothesis, face), the hypothesis below {}", hypotheses.len());
        return refuse("there is no such hypothesis", remedy);
    };
    let faces = &given.model.faces;
    match faces.get(face) {
        None => refuse("its part has no such face", format!("give a face below {}", faces.len())),
        Some(known) if !known.is_touchable() => {
            refuse("the face can't be touched", "give another one".to_owned())
        }
        Some(_) => Ok(()),
    }
}

/// A face is a generator unless it can't be touched or was sensed.
fn none_is_left(wanted: Option<FaceOf>) -> Error {
    match wanted {
        Some(FaceOf { hypothesis, face }) => Error::new(
            "generator",
            "a contact is assigned to the face",
            format!("({hypothesis}, {face})"),
            "give one that was not sensed",
        ),
        None => Error::new(
            "hypotheses",
            "every face that can be touched has a contact",
            "no generator",
            "give hypotheses with a face that was not sensed",
        ),
    }
}
