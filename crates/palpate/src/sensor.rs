//! The sensor of the next reading.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use crate::Error;

/// What carries the tip of a probe in space: a rod from the centre of the tip, always in the same direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stem {
    /// Unit vector from the tip along the rod, world frame.
    pub direction: DVec3,
    /// Its radius.
    pub radius: f64,
    /// How far it goes.
    pub length: f64,
}

impl Stem {
    /// A rod along `direction`, of any length but zero.
    ///
    /// # Errors
    /// A direction of no length; a radius that is negative, a length that is not above zero, or either not finite.
    pub fn new(direction: DVec3, radius: f64, length: f64) -> Result<Self, Error> {
        self::length("stem", radius)?;
        if !(length.is_finite() && length > 0.0) {
            return Err(Error::new(
                "stem",
                "its length must be above zero",
                length,
                "give how far it reaches",
            ));
        }
        let Some(direction) = direction.try_normalize() else {
            let remedy = "give the way from the tip along the rod, such as (0, 0, 1)";
            return Err(Error::new("stem", "its direction must not be zero", direction, remedy));
        };
        Ok(Self { direction, radius, length })
    }
}

/// Bounds of the next reading. Lengths in the models' unit, angles in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// The sensed centre of the tip is within this of the true one.
    pub position_error: f64,
    /// The sensed normal is within this angle of the true one; `None`: the sensor reads no normal.
    pub normal_error: Option<f64>,
    /// Ω, the skid angle: a touch is reliable if the way back is within it of the surface normal.
    pub max_incidence: f64,
    /// Radius of the tip.
    pub tip_radius: f64,
    /// How far the tip may leave its line.
    pub path_error: f64,
    /// What carries the tip, in space; `None`: nothing that may touch. The plane has none.
    pub stem: Option<Stem>,
}

impl Sensor {
    /// A sensor with a point for a tip that stays on its line.
    ///
    /// # Errors
    /// A bound that is negative or not finite, a normal error above π/2, an incidence outside `(0, π/2)`.
    pub fn new(position_error: f64, normal_error: Option<f64>, max_incidence: f64) -> Result<Self, Error> {
        length("position_error", position_error)?;
        if let Some(error) = normal_error
            && !(0.0..=FRAC_PI_2).contains(&error)
        {
            let remedy = "give radians, or leave it out if the sensor reads no normal";
            return Err(Error::new("normal_error", "must be an angle from 0 to π/2", error, remedy));
        }
        if !(max_incidence > 0.0 && max_incidence < FRAC_PI_2) {
            let remedy = "give radians, such as 1.047 for 60°";
            return Err(Error::new(
                "max_incidence",
                "must be an angle between 0 and π/2",
                max_incidence,
                remedy,
            ));
        }
        Ok(Self { position_error, normal_error, max_incidence, tip_radius: 0.0, path_error: 0.0, stem: None })
    }

    /// The same sensor with a tip of this radius, which may leave its line by `path_error`.
    ///
    /// # Errors
    /// A length that is negative or not finite.
    pub fn with_tip(self, tip_radius: f64, path_error: f64) -> Result<Self, Error> {
        length("tip_radius", tip_radius)?;
        length("path_error", path_error)?;
        Ok(Self { tip_radius, path_error, ..self })
    }

    /// Whether two exact readings so far apart in depth and in their normals, either wrong by its bounds, may be the same.
    pub(crate) fn confuses(&self, depth: f64, angle: impl FnOnce() -> f64) -> bool {
        depth <= 2.0 * self.position_error && self.normal_error.is_none_or(|error| angle() <= 2.0 * error)
    }
}

fn length(argument: &str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    Err(Error::new(argument, "must be a finite number, zero or more", value, "give the bound as a length"))
}
