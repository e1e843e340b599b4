//! What may be known of a pose in space beforehand.

use glam::DVec3;

use super::Pose;
use crate::Error;
use crate::contact::{nonnegative, within};
use crate::plan::unit;

/// The part lies on a plane, such as a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lying {
    /// Unit normal of the plane, world frame.
    pub normal: DVec3,
    /// The translation along the normal is within this of the middle's.
    pub height: f64,
    /// The part may tilt by this angle; radians, `[0, π]`.
    pub tilt: f64,
}

/// What is known of the pose beforehand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// The middle of the range of poses.
    pub world_from_model: Pose,
    /// Each component of the translation is within this of the middle's; of a part that lies on a plane, the distance
    /// along the plane.
    pub translation: f64,
    /// The rotation is within this angle of the middle's; radians, `[0, π]`. Of a part that lies on a plane, the turn
    /// about the plane's normal, after the tilt.
    pub rotation: f64,
    /// It lies on a plane.
    pub lying: Option<Lying>,
}

impl Prior {
    /// Poses around `world_from_model`.
    ///
    /// # Errors
    /// If a bound is negative, not finite, or a rotation above `π`.
    pub fn new(world_from_model: Pose, translation: f64, rotation: f64) -> Result<Self, Error> {
        let remedy = "give radians; π leaves the rotation free";
        Ok(Self {
            world_from_model,
            translation: nonnegative("translation", translation)?,
            rotation: within("rotation", rotation, std::f64::consts::PI, remedy)?,
            lying: None,
        })
    }

    /// Poses around `world_from_model` of a part that lies on a plane whose normal is `normal`, of any length but zero.
    ///
    /// # Errors
    /// As [`Prior::new`], or if `normal` is zero or not finite.
    pub fn on_plane(self, normal: DVec3, height: f64, tilt: f64) -> Result<Self, Error> {
        let normal = unit(normal).ok_or_else(|| {
            Error::new("normal", "must not be zero", normal, "give the plane's normal, of any length")
        })?;
        let height = nonnegative("height", height)?;
        let tilt = within("tilt", tilt, std::f64::consts::PI, "give radians; 0 for a part that can't tilt")?;
        Ok(Self { lying: Some(Lying { normal, height, tilt }), ..self })
    }
}
