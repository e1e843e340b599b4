//! Rigid motions of the plane.

use glam::{DVec2, dvec2};

use crate::Error;

/// A rigid motion: `p_world = world_from_model * p_model`, rotation first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Rotation as the unit vector `(cos θ, sin θ)`.
    pub rotation: DVec2,
    /// Translation, in the target frame.
    pub translation: DVec2,
}

impl Pose {
    /// The identity.
    pub const IDENTITY: Self = Self { rotation: DVec2::X, translation: DVec2::ZERO };

    /// Rotation by `angle` (radians, counter-clockwise), then `translation`.
    #[must_use]
    pub fn new(angle: f64, translation: DVec2) -> Self {
        Self { rotation: DVec2::from_angle(angle), translation }
    }

    /// From a homogeneous 3×3 matrix, given by rows.
    ///
    /// # Errors
    /// If it is not a rigid motion to 1e-6: mirror, scale, shear, projection, or a number that is not finite.
    pub fn from_rows(argument: &str, rows: [[f64; 3]; 3]) -> Result<Self, Error> {
        let [[a, b, x], [c, d, y], last] = rows;
        let defect = [a - d, b + c, a * a + c * c - 1.0, last[0], last[1], last[2] - 1.0]
            .into_iter()
            .fold(0.0, |worst: f64, e| worst.max(e.abs()));
        if !(defect <= 1e-6 && x.is_finite() && y.is_finite()) {
            let value = format!("{rows:?}");
            let problem = "must be a rigid motion, a homogeneous 3x3 matrix";
            return Err(Error::new(argument, problem, value, "give [[c,-s,x],[s,c,y],[0,0,1]] with c²+s²=1"));
        }
        let length = a.hypot(c);
        Ok(Self { rotation: dvec2(a / length, c / length), translation: dvec2(x, y) })
    }

    /// As a homogeneous 3×3 matrix, by rows.
    #[must_use]
    pub fn to_rows(self) -> [[f64; 3]; 3] {
        let DVec2 { x: c, y: s } = self.rotation;
        [[c, -s, self.translation.x], [s, c, self.translation.y], [0.0, 0.0, 1.0]]
    }

    /// The rotation angle in `(-π, π]`.
    #[must_use]
    pub fn angle(self) -> f64 {
        self.rotation.to_angle()
    }

    /// `p_target = target_from_source * p_source`.
    #[must_use]
    pub fn apply(self, point: DVec2) -> DVec2 {
        self.rotation.rotate(point) + self.translation
    }

    /// `target_from_source = target_from_mid * mid_from_source`.
    #[must_use]
    pub fn compose(self, mid_from_source: Self) -> Self {
        Self {
            rotation: self.rotation.rotate(mid_from_source.rotation),
            translation: self.apply(mid_from_source.translation),
        }
    }

    /// `source_from_target`.
    #[must_use]
    pub fn inverse(self) -> Self {
        let rotation = dvec2(self.rotation.x, -self.rotation.y);
        Self { rotation, translation: -rotation.rotate(self.translation) }
    }
}
