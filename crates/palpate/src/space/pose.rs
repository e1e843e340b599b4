//! Rigid motions of space.

use glam::{DMat3, DVec3};

use crate::Error;

/// A rigid motion: `p_world = world_from_model * p_model`, rotation first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Rotation matrix.
    pub rotation: DMat3,
    /// Translation, in the target frame.
    pub translation: DVec3,
}

impl Pose {
    /// The identity.
    pub const IDENTITY: Self = Self { rotation: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// Rotation by `vector` (its length is the angle in radians, its direction the axis), then `translation`.
    #[must_use]
    pub fn new(vector: DVec3, translation: DVec3) -> Self {
        Self { rotation: rotation(vector), translation }
    }

    /// From a homogeneous 4×4 matrix, given by rows.
    ///
    /// # Errors
    /// If it is not a rigid motion to 1e-6: mirror, scale, shear, projection, or a number that is not finite.
    pub fn from_rows(argument: &str, rows: [[f64; 4]; 4]) -> Result<Self, Error> {
        let column = |k: usize| DVec3::new(rows[0][k], rows[1][k], rows[2][k]);
        let given = DMat3::from_cols(column(0), column(1), column(2));
        let gram = given.transpose() * given - DMat3::IDENTITY;
        let last = [rows[3][0], rows[3][1], rows[3][2], rows[3][3] - 1.0];
        let defect = gram
            .to_cols_array()
            .into_iter()
            .chain(last)
            .fold(0.0, |worst: f64, e| if e.is_nan() { f64::INFINITY } else { worst.max(e.abs()) });
        if !(defect <= 1e-6 && given.determinant() > 0.0 && column(3).is_finite()) {
            let problem = "must be a rigid motion, a homogeneous 4x4 matrix";
            let remedy = "give [[R, t], [0, 0, 0, 1]] with a rotation matrix R, its determinant 1";
            return Err(Error::new(argument, problem, format!("{rows:?}"), remedy));
        }
        Ok(Self { rotation: orthonormal(given), translation: column(3) })
    }

    /// As a homogeneous 4×4 matrix, by rows.
    #[must_use]
    pub fn to_rows(self) -> [[f64; 4]; 4] {
        let row = |k: usize| {
            let r = self.rotation.row(k);
            [r.x, r.y, r.z, self.translation[k]]
        };
        [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
    }

    /// `p_target = target_from_source * p_source`.
    #[must_use]
    pub fn apply(self, point: DVec3) -> DVec3 {
        self.rotation * point + self.translation
    }

    /// `target_from_source = target_from_mid * mid_from_source`.
    #[must_use]
    pub fn compose(self, mid_from_source: Self) -> Self {
        Self {
            rotation: self.rotation * mid_from_source.rotation,
            translation: self.apply(mid_from_source.translation),
        }
    }

    /// `source_from_target`.
    #[must_use]
    pub fn inverse(self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// The angle of its rotation, radians, `[0, π]`.
    #[must_use]
    pub fn angle(self) -> f64 {
        angle(self.rotation)
    }
}

/// Whether a rotation is by no more than `angle`, up to rounding, without the angle itself.
pub(crate) fn within(rotation: DMat3, angle: f64) -> bool {
    let trace = rotation.x_axis.x + rotation.y_axis.y + rotation.z_axis.z;
    angle >= std::f64::consts::PI || 0.5 * (trace - 1.0) >= angle.cos() - 1e-12
}

/// The rotation about `vector` by its length, radians.
pub(crate) fn rotation(vector: DVec3) -> DMat3 {
    match vector.try_normalize() {
        Some(axis) => DMat3::from_axis_angle(axis, vector.length()),
        None => DMat3::IDENTITY,
    }
}

/// The rotation near a matrix that is one up to rounding.
pub(crate) fn proper(matrix: DMat3) -> DMat3 {
    DMat3::from_quat(glam::DQuat::from_mat3(&matrix).normalize())
}

/// The vector of a rotation: its axis times its angle, of length at most π.
pub(crate) fn vector(rotation: DMat3) -> DVec3 {
    let turn = glam::DQuat::from_mat3(&rotation).normalize();
    let turn = if turn.w < 0.0 { -turn } else { turn };
    turn.to_scaled_axis()
}

/// The angle of a rotation, radians, `[0, π]`: accurate at either end.
pub(crate) fn angle(rotation: DMat3) -> f64 {
    let skew = DVec3::new(
        rotation.y_axis.z - rotation.z_axis.y,
        rotation.z_axis.x - rotation.x_axis.z,
        rotation.x_axis.y - rotation.y_axis.x,
    );
    let trace = rotation.x_axis.x + rotation.y_axis.y + rotation.z_axis.z;
    skew.length().atan2(trace - 1.0)
}

/// The rotation nearest to what is one up to 1e-6: a Newton step of the polar decomposition, twice.
fn orthonormal(matrix: DMat3) -> DMat3 {
    let step = |m: DMat3| (m + m.inverse().transpose()) * 0.5;
    step(step(matrix))
}
