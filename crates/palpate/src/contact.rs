//! Evidence: contacts, misses and the prior.

use glam::DVec2;

use crate::Error;
use crate::dimension::Dimension;
use crate::plane::Pose;

/// A sensed outward surface normal and the bound on its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normal<V = DVec2> {
    /// Unit outward normal, world frame.
    pub direction: V,
    /// The true normal is within this angle of `direction`; radians, `[0, π/2]`.
    pub error: f64,
}

/// The tip rests on the part: its centre is within `position_error` of `center`.
///
/// A measured surface point is the case `tip_radius == 0`. Lengths in the models' unit, world frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact<V = DVec2> {
    /// Sensed centre of the tip.
    pub center: V,
    /// Radius of the tip, `>= 0`.
    pub tip_radius: f64,
    /// The true centre is within this distance of `center`.
    pub position_error: f64,
    /// Sensed outward normal, if the probe reads one.
    pub normal: Option<Normal<V>>,
    /// Unit direction of travel, pointing into the part: the true normal `n` has `-approach·n >= 0`.
    pub approach: Option<V>,
    /// Where the guarded move began: the path from `start` to the contact was free.
    pub start: Option<V>,
}

/// A guarded move that touched nothing: the tip swept `start..end` freely.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Miss<V = DVec2> {
    /// Where the move began, world frame.
    pub start: V,
    /// Where it ended.
    pub end: V,
    /// Radius of the tip, `>= 0`.
    pub tip_radius: f64,
    /// How far the tip may have left its line, `>= 0`.
    pub path_error: f64,
}

/// What is known of the pose beforehand, in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// The middle of the range of poses.
    pub world_from_model: Pose,
    /// Each component of the translation is within this of the middle's.
    pub translation: f64,
    /// The rotation is within this angle of the middle's; radians, `[0, π]`.
    pub rotation: f64,
}

/// All that was observed.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence<V: Dimension = DVec2> {
    /// Touches.
    pub contacts: Vec<Contact<V>>,
    /// Guarded moves that touched nothing.
    pub misses: Vec<Miss<V>>,
    /// What was known beforehand.
    pub prior: Option<V::Prior>,
}

impl<V: Dimension> Default for Evidence<V> {
    /// Nothing.
    fn default() -> Self {
        Self { contacts: Vec::new(), misses: Vec::new(), prior: None }
    }
}

impl<V: Dimension> Evidence<V> {
    /// Whether any contact was made by a tip that has a radius.
    pub(crate) fn has_tips(&self) -> bool {
        self.contacts.iter().any(|contact| contact.tip_radius > 0.0)
    }
}

/// A normal and an approach may agree in no more than the ends of their ranges; this much, radians, is granted to
/// rounding there.
pub(crate) const GRAZING: f64 = 1e-9;

fn finite<V: Dimension>(argument: &str, value: V) -> Result<V, Error> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Error::new(argument, "must be finite", value, "give finite coordinates"))
    }
}

pub(crate) fn nonnegative(argument: &str, value: f64) -> Result<f64, Error> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(Error::new(
            argument,
            "must be a finite number, zero or more",
            value,
            "give the bound as a length",
        ))
    }
}

pub(crate) fn within(argument: &str, value: f64, largest: f64, remedy: &str) -> Result<f64, Error> {
    if (0.0..=largest).contains(&value) {
        Ok(value)
    } else {
        let problem = format!("must be an angle in radians from 0 to {largest:.4}");
        Err(Error::new(argument, problem, value, remedy))
    }
}

fn direction<V: Dimension>(argument: &str, value: V) -> Result<V, Error> {
    finite(argument, value)?
        .try_normalize()
        .ok_or_else(|| Error::new(argument, "must not be zero", value, "give a direction, of any length"))
}

impl<V: Dimension> Normal<V> {
    /// A normal along `toward`, of any length but zero.
    ///
    /// # Errors
    /// If `toward` is zero or not finite, or `error` is outside `[0, π/2]`.
    pub fn new(toward: V, error: f64) -> Result<Self, Error> {
        Ok(Self {
            direction: direction("normal", toward)?,
            error: within(
                "normal_error",
                error,
                std::f64::consts::FRAC_PI_2,
                "give radians, or leave the normal out if nothing is known of it",
            )?,
        })
    }
}

impl<V: Dimension> Contact<V> {
    /// A contact of a tip of radius `tip_radius` centred within `position_error` of `center`.
    ///
    /// # Errors
    /// If a number is not finite or negative.
    pub fn new(center: V, tip_radius: f64, position_error: f64) -> Result<Self, Error> {
        Ok(Self {
            center: finite("center", center)?,
            tip_radius: nonnegative("tip_radius", tip_radius)?,
            position_error: nonnegative("position_error", position_error)?,
            normal: None,
            approach: None,
            start: None,
        })
    }

    /// The same contact with a sensed normal.
    #[must_use]
    pub fn with_normal(self, normal: Normal<V>) -> Self {
        Self { normal: Some(normal), ..self }
    }

    /// The same contact, reached along `toward`, of any length but zero.
    ///
    /// # Errors
    /// If `toward` is zero or not finite.
    pub fn with_approach(self, toward: V) -> Result<Self, Error> {
        Ok(Self { approach: Some(direction("approach", toward)?), ..self })
    }

    /// The same contact, whose guarded move began at `start`.
    ///
    /// # Errors
    /// If `start` is not finite.
    pub fn with_start(self, start: V) -> Result<Self, Error> {
        Ok(Self { start: Some(finite("start", start)?), ..self })
    }
}

impl<V: Dimension> Miss<V> {
    /// A free sweep from `start` to `end`.
    ///
    /// # Errors
    /// If a number is not finite or negative.
    pub fn new(start: V, end: V, tip_radius: f64, path_error: f64) -> Result<Self, Error> {
        Ok(Self {
            start: finite("start", start)?,
            end: finite("end", end)?,
            tip_radius: nonnegative("tip_radius", tip_radius)?,
            path_error: nonnegative("path_error", path_error)?,
        })
    }
}

impl Prior {
    /// Poses around `world_from_model`.
    ///
    /// # Errors
    /// If a bound is negative, not finite, or a rotation above `π`.
    pub fn new(world_from_model: Pose, translation: f64, rotation: f64) -> Result<Self, Error> {
        Ok(Self {
            world_from_model,
            translation: nonnegative("translation", translation)?,
            rotation: within(
                "rotation",
                rotation,
                std::f64::consts::PI,
                "give radians; π leaves the rotation free",
            )?,
        })
    }
}
