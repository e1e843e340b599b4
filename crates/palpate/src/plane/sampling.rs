//! Valid poses of a pose set: spread at random, and at its extremes.

use glam::DVec2;

use super::arc::wrap;
use super::case::PivotPose;
use super::cell::Cell;
use super::pose::Pose;
use super::pose_set::{Piece, PoseSet};

/// A corner that is not valid is drawn toward the witness to this share of the way.
const SHARE_STEP: f64 = 1.0 / 256.0;

/// Corners at which no end of a face is farther out than at a chosen one by more than this share of its range are left out.
const SAME: f64 = 0.05;

impl PoseSet {
    /// `n` valid poses, spread over the set; the same for the same seed.
    #[must_use]
    pub fn sample(&self, n: usize, seed: u64) -> Vec<Pose> {
        let mut random = fastrand::Rng::with_seed(seed);
        let cells: Vec<(&Piece, &Cell)> = self
            .pieces
            .iter()
            .filter(|piece| piece.witness.is_some())
            .flat_map(|piece| piece.cells.iter().map(move |cell| (piece, cell)))
            .collect();
        let mut total = 0.0;
        let cumulated: Vec<f64> = cells
            .iter()
            .map(|(_, cell)| {
                let half = cell.y_half() + self.case.length_tolerance;
                total += (cell.rotations().width + self.case.angle_tolerance) * half.x * half.y;
                total
            })
            .collect();
        let draw = |_| {
            let at = random.f64() * total;
            let chosen = cumulated.partition_point(|sum| *sum < at).min(cells.len().saturating_sub(1));
            let pose = cells.get(chosen).map(|(piece, cell)| self.draw(piece, cell, &mut random));
            pose.map_or_else(|| self.witness(), |pose| self.case.pose(pose))
        };
        (0..n).map(draw).collect()
    }

    /// A valid pose of the piece, near a random point of the cell.
    ///
    /// Random weights on the corners reach all of the cell; if the point is not valid it is drawn toward the witness,
    /// which is.
    fn draw(&self, piece: &Piece, cell: &Cell, random: &mut fastrand::Rng) -> PivotPose {
        let witness =
            piece.witness.map_or(PivotPose { angle: cell.mid, y: cell.y_mid() }, |found| found.pose);
        let mut pose = witness;
        for _ in 0..24 {
            pose = random_pose(cell, random);
            if self.is_valid(piece, pose) {
                return pose;
            }
        }
        for _ in 0..40 {
            pose = PivotPose {
                angle: witness.angle + 0.7 * wrap(pose.angle - witness.angle),
                y: witness.y + 0.7 * (pose.y - witness.y),
            };
            if self.is_valid(piece, pose) {
                return pose;
            }
        }
        witness
    }

    /// Valid poses at which the ends of faces are as far out, or in, as they go, or nearly so; no two much alike.
    pub(crate) fn extremes(&self) -> Vec<Pose> {
        let corners: Vec<(&Piece, PivotPose)> = self
            .pieces
            .iter()
            .filter(|piece| piece.witness.is_some())
            .flat_map(|piece| piece.cells.iter().map(move |cell| (piece, cell)))
            .flat_map(|(piece, cell)| cell.corners().map(move |(s, y)| (piece, cell.pose(s, y))))
            .collect();
        let Some((_, first)) = corners.first() else { return Vec::new() };
        let mid = first.angle;
        let mut chosen: Vec<usize> = Vec::new();
        for face in &self.case.model.faces {
            for end in [face.start, face.end] {
                // How far out the end is: linear in the pivot point and, nearly, in the rotation.
                let lever = face.normal.dot((end - first.y).perp());
                let out = |(_, pose): &(&Piece, PivotPose)| {
                    lever * wrap(pose.angle - mid).sin() - face.normal.dot(pose.y)
                };
                let outs: Vec<f64> = corners.iter().map(out).collect();
                let low = outs.iter().copied().fold(f64::INFINITY, f64::min);
                let high = outs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let near = SAME * (high - low);
                for sign in [1.0, -1.0] {
                    let extreme = if sign > 0.0 { high } else { low };
                    if chosen.iter().all(|k| (outs[*k] - extreme).abs() > near) {
                        chosen.extend(outs.iter().position(|out| *out == extreme));
                    }
                }
            }
        }
        chosen.into_iter().map(|k| self.case.pose(self.drawn_in(corners[k].0, corners[k].1))).collect()
    }

    /// The pose if it is valid, else one between it and the witness of its piece, which is.
    fn drawn_in(&self, piece: &Piece, pose: PivotPose) -> PivotPose {
        let witness = piece.witness.map_or(pose, |found| found.pose);
        let between = |share: f64| PivotPose {
            angle: witness.angle + share * wrap(pose.angle - witness.angle),
            y: witness.y + share * (pose.y - witness.y),
        };
        if self.is_valid(piece, pose) {
            return pose;
        }
        let (mut low, mut high) = (0.0, 1.0);
        while high - low > SHARE_STEP {
            let share = 0.5 * (low + high);
            if self.is_valid(piece, between(share)) { low = share } else { high = share }
        }
        between(low)
    }

    fn is_valid(&self, piece: &Piece, pose: PivotPose) -> bool {
        piece.satisfied(&self.case, pose, self.case.length_tolerance, self.case.angle_tolerance)
    }
}

fn random_pose(cell: &Cell, random: &mut fastrand::Rng) -> PivotPose {
    let corners: arrayvec::ArrayVec<(f64, DVec2), 128> = cell.corners().take(128).collect();
    if corners.is_empty() {
        let mut side = || 2.0 * random.f64() - 1.0;
        let angle = cell.mid + cell.half * side();
        let y = cell.y_mid() + cell.y_half() * DVec2::new(side(), side());
        return PivotPose { angle, y };
    }
    // Every point is a mixture of four corners (Carathéodory); of all of them, mixtures crowd in the middle.
    let mut total = 0.0;
    let (mut s, mut y) = (0.0, DVec2::ZERO);
    for _ in 0..4 {
        let (corner_s, corner_y) = corners[random.usize(0..corners.len())];
        let weight = -(1.0 - random.f64()).ln();
        total += weight;
        s += weight * corner_s;
        y += weight * corner_y;
    }
    cell.pose(s / total, y / total)
}
