//! Recognition: every part and pose that explains the contacts (thesis, chapter 2).

use std::sync::Arc as Shared;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec2;
use rayon::prelude::*;

use crate::contact::GRAZING;
use crate::dimension::Dimension;
use crate::hypothesis::{Count, Hypothesis};
use crate::tree::Counters;
use crate::{Error, Evidence};

/// Set from outside to have a search given up.
pub type Halt = Shared<AtomicBool>;

/// What ended a search before it knew all: the first of them where there are several.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Limit {
    /// It was told to stop, by a limit of time or by the user.
    Time,
    /// [`Settings::effort`] was spent.
    Effort,
    /// Within [`Settings::tolerance`] a pose can neither be found nor excluded.
    Tolerance,
    /// There are more hypotheses than [`Settings::max_hypotheses`].
    Hypotheses,
}

impl Limit {
    /// Its name, as in Python.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Effort => "effort",
            Self::Tolerance => "tolerance",
            Self::Hypotheses => "hypotheses",
        }
    }
}

/// How to recognize. The defaults are stated here and nowhere else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Contacts may lie on faces.
    pub faces: bool,
    /// Contacts may lie on edges (in space); `None`: if a tip has a radius.
    pub edges: Option<bool>,
    /// Contacts may lie on vertices; `None`: if a tip has a radius.
    pub vertices: Option<bool>,
    /// τ, relative to the size of the part: what is valid within it counts as valid.
    pub tolerance: f64,
    /// More hypotheses than this are counted, not returned.
    pub max_hypotheses: usize,
    /// Cells of poses to examine for one model, about; `None`: what the plane and space have each.
    pub effort: Option<u64>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { faces: true, edges: None, vertices: None, tolerance: 1e-6, max_hypotheses: 1000, effort: None }
    }
}

impl Settings {
    /// Whether contacts may lie on vertices.
    pub(crate) fn vertices<V: Dimension>(&self, evidence: &Evidence<V>) -> bool {
        self.vertices.unwrap_or_else(|| evidence.has_tips())
    }

    /// Whether contacts may lie on edges.
    pub(crate) fn edges<V: Dimension>(&self, evidence: &Evidence<V>) -> bool {
        self.edges.unwrap_or_else(|| evidence.has_tips())
    }
}

/// All that one model has to say to the evidence.
#[derive(Debug)]
pub struct Explanations<V: Dimension = DVec2> {
    /// The pose sets of its hypotheses.
    pub hypotheses: Vec<V::PoseSet>,
    /// Of the interpretation tree.
    pub counters: Counters,
    /// Boxes of poses examined where the tree was given up.
    pub num_boxes: u64,
    /// What left something undecided, if that is so.
    pub stopped_by: Option<Limit>,
}

impl<V: Dimension> Explanations<V> {
    /// No pose of the model explains the contacts.
    #[must_use]
    pub fn nothing() -> Self {
        Self { hypotheses: Vec::new(), counters: Counters::default(), num_boxes: 0, stopped_by: None }
    }
}

/// What was done for one model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ModelReport {
    /// Of the interpretation tree.
    pub counters: Counters,
    /// Boxes of poses examined, where the tree was too large.
    pub num_boxes: u64,
    /// Hypotheses found.
    pub num_hypotheses: usize,
}

/// Every hypothesis.
#[derive(Debug, Clone)]
pub struct Recognition<V: Dimension = DVec2> {
    /// In the order of the models.
    pub hypotheses: Vec<Hypothesis<V>>,
    /// If there is none: contacts (by number) that no model and pose explains together. The smallest such set up to
    /// ten contacts; above, one from which none can be left out. Misses and prior count as they are.
    pub conflict: Option<Vec<usize>>,
    /// One for each model.
    pub reports: Vec<ModelReport>,
    /// Every hypothesis is returned, and proved. If not, there are more than were asked for, or a search met its limit before it
    /// knew.
    pub complete: bool,
    /// If it is not complete: by which limit.
    pub stopped_by: Option<Limit>,
}

impl<V: Dimension> Recognition<V> {
    /// How many interpretations all hypotheses have.
    #[must_use]
    pub fn interpretation_count(&self) -> Count {
        let none = Count { at_least: 0, exact: self.complete };
        self.hypotheses.iter().map(Hypothesis::interpretation_count).fold(none, |sum, count| sum + count)
    }
}

/// Every model and pose that explains all contacts, keeps clear of all misses, and agrees with the prior.
///
/// For each model: pair tables of its features and of the contacts prune the interpretation tree by distance, angle
/// and direction (thesis 2.2); each feasible assignment is decided over all poses and given its pose set (MATH 2.1);
/// assignments that one pose satisfies are joined (DESIGN §1).
///
/// ```
/// use glam::dvec2;
/// use palpate::{Contact, Evidence, Normal, Settings, plane::Model, recognize};
///
/// let corners = [dvec2(0.0, 0.0), dvec2(60.0, 0.0), dvec2(60.0, 40.0), dvec2(0.0, 20.0)];
/// let part = Model::polygon("wedge", &corners, &[], &[], 0.0, 0.0)?.into();
/// let touch = |x, y, toward| Ok::<_, palpate::Error>(Contact::new(dvec2(x, y), 0.0, 0.5)?.with_normal(Normal::new(toward, 0.07)?));
/// let contacts = vec![touch(30.0, 0.0, dvec2(0.0, -1.0))?, touch(60.0, 30.0, dvec2(1.0, 0.0))?];
/// let found = recognize(&[part], &Evidence { contacts, ..Evidence::default() }, &Settings::default())?;
/// assert!(found.hypotheses.iter().any(|one| one.poses.contains(palpate::plane::Pose::IDENTITY)));
/// # Ok::<(), palpate::Error>(())
/// ```
///
/// # Errors
/// No models, no contacts, no kind of feature, a tolerance out of range, or a contact whose normal contradicts its
/// approach.
pub fn recognize<V: Dimension>(
    models: &[Shared<V::Model>],
    evidence: &Evidence<V>,
    settings: &Settings,
) -> Result<Recognition<V>, Error> {
    recognize_until(models, evidence, settings, &Shared::default())
}

/// The same, but given up soon after `stop` is set: the answer is then not complete.
///
/// # Errors
/// As [`recognize`].
pub fn recognize_until<V: Dimension>(
    models: &[Shared<V::Model>],
    evidence: &Evidence<V>,
    settings: &Settings,
    stop: &Halt,
) -> Result<Recognition<V>, Error> {
    check(models, evidence, settings)?;
    let explanations: Vec<Explanations<V>> =
        models.par_iter().map(|model| V::explain(model, evidence, settings, stop)).collect();
    let reports = explanations.iter().map(|one| ModelReport {
        counters: one.counters,
        num_boxes: one.num_boxes,
        num_hypotheses: one.hypotheses.len(),
    });
    let reports: Vec<ModelReport> = reports.collect();
    let of_searches = explanations.iter().filter_map(|one| one.stopped_by).min();
    let mut hypotheses = Vec::new();
    for (model_number, one) in explanations.into_iter().enumerate() {
        hypotheses.extend(one.hypotheses.into_iter().map(|poses| Hypothesis {
            model: Shared::clone(&models[model_number]),
            model_number,
            poses,
        }));
    }
    let too_many = (hypotheses.len() > settings.max_hypotheses).then_some(Limit::Hypotheses);
    hypotheses.truncate(settings.max_hypotheses);
    let late = || stop.load(Relaxed).then_some(Limit::Time);
    let stopped_by = late().or(of_searches).or(too_many);
    let complete = stopped_by.is_none();
    let conflict = (complete && hypotheses.is_empty()).then(|| conflict(models, evidence, settings, stop));
    // Given up in the middle of it: then it is not known.
    let conflict = conflict.filter(|_| late().is_none());
    Ok(Recognition { hypotheses, conflict, reports, complete, stopped_by })
}

fn check<V: Dimension>(
    models: &[Shared<V::Model>],
    evidence: &Evidence<V>,
    settings: &Settings,
) -> Result<(), Error> {
    if models.is_empty() {
        return Err(Error::new("models", "must not be empty", "[]", "give at least one model"));
    }
    if evidence.contacts.is_empty() {
        return Err(Error::new("contacts", "must not be empty", "[]", "give at least one contact"));
    }
    if !settings.faces && settings.edges != Some(true) && settings.vertices == Some(false) {
        return Err(Error::new(
            "features",
            "must not be empty",
            "()",
            "give \"face\", in space \"edge\", or \"vertex\"",
        ));
    }
    if !(1e-9..=1e-2).contains(&settings.tolerance) {
        let remedy = "give a share of the part's size from 1e-9 to 0.01, such as 1e-6";
        return Err(Error::new("tolerance", "is out of range", settings.tolerance, remedy));
    }
    check_lengths(models, evidence)?;
    let slack = models.iter().map(|model| V::normal_slack(model)).fold(0.0, f64::max);
    for (number, contact) in evidence.contacts.iter().enumerate() {
        if let (Some(normal), Some(approach)) = (contact.normal, contact.approach)
            && normal.direction.angle_between(-approach)
                > std::f64::consts::FRAC_PI_2 + normal.error + slack + GRAZING
        {
            let value = format!("normal {}, approach {approach}", normal.direction);
            let problem = "the normal points along the approach, out of the part's far side";
            let remedy = "normals point out of the part, the approach into it; leave a faulty normal out";
            return Err(Error::new(format!("contacts[{number}]"), problem, value, remedy));
        }
    }
    Ok(())
}

/// Lengths of so many sizes of the largest model are no lengths of the same world.
const FARTHEST: f64 = 1e8;

/// Nor is a tip of so many.
const LARGEST_TIP: f64 = 1e4;

/// Lengths that leave no digits for models of this size.
pub(crate) fn check_reach(argument: &str, lengths: &[f64], size: f64) -> Result<(), Error> {
    within(argument, lengths, size, FARTHEST)
}

/// A tip against which models of this size have no shape.
pub(crate) fn check_tip(argument: &str, radius: f64, size: f64) -> Result<(), Error> {
    within(argument, &[radius], size, LARGEST_TIP)
}

fn within(argument: &str, lengths: &[f64], size: f64, most: f64) -> Result<(), Error> {
    let Some(length) = lengths.iter().find(|one| one.abs() > most * size) else { return Ok(()) };
    let problem = format!("is more than {most:e} times the size of the largest model, {size:.6}");
    let remedy = "give lengths in the models' unit, from an origin within reach";
    Err(Error::new(argument, problem, format!("{length:?}"), remedy))
}

/// Coordinates and radii that leave no digits for the part.
fn check_lengths<V: Dimension>(models: &[Shared<V::Model>], evidence: &Evidence<V>) -> Result<(), Error> {
    let size = models.iter().map(|model| V::size(model)).fold(0.0, f64::max);
    for (number, contact) in evidence.contacts.iter().enumerate() {
        let start = contact.start.unwrap_or(contact.center);
        let [center, start] = [contact.center, start].map(V::largest_coordinate);
        let lengths = [center, start, contact.position_error];
        check_reach(&format!("contacts[{number}]"), &lengths, size)?;
        check_tip(&format!("contacts[{number}]"), contact.tip_radius, size)?;
    }
    for (number, miss) in evidence.misses.iter().enumerate() {
        let [start, end] = [miss.start, miss.end].map(V::largest_coordinate);
        let lengths = [start, end, miss.path_error];
        check_reach(&format!("misses[{number}]"), &lengths, size)?;
        check_tip(&format!("misses[{number}]"), miss.tip_radius, size)?;
    }
    Ok(())
}

/// The largest number of contacts for which the smallest conflict is sought.
const MOST_EXHAUSTIVE: usize = 10;

/// Contacts that can't hold together (DESIGN §4).
fn conflict<V: Dimension>(
    models: &[Shared<V::Model>],
    evidence: &Evidence<V>,
    settings: &Settings,
    stop: &Halt,
) -> Vec<usize> {
    let explained = |members: &[usize]| {
        if stop.load(Relaxed) {
            return true;
        }
        let contacts = members.iter().map(|number| evidence.contacts[*number]).collect();
        let evidence = Evidence { contacts, ..evidence.clone() };
        models.par_iter().any(|model| {
            let found = V::explain(model, &evidence, settings, stop);
            !found.hypotheses.is_empty() || found.stopped_by.is_some()
        })
    };
    let count = evidence.contacts.len();
    if count <= MOST_EXHAUSTIVE {
        let mut subsets: Vec<Vec<usize>> =
            (1_u32..1 << count).map(|bits| (0..count).filter(|k| bits >> k & 1 == 1).collect()).collect();
        subsets.sort_by(|a, b| a.len().cmp(&b.len()).then_with(|| a.cmp(b)));
        return subsets.into_iter().find(|members| !explained(members)).unwrap_or_default();
    }
    let mut members: Vec<usize> = (0..count).collect();
    for number in 0..count {
        let rest: Vec<usize> = members.iter().copied().filter(|member| *member != number).collect();
        if !rest.is_empty() && !explained(&rest) {
            members = rest;
        }
    }
    members
}
