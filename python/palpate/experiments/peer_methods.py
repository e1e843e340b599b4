"""Other ways to find a part by its contacts, each made as strong as its kind allows; only for comparison.

Each is prepared for a part, `METHODS[name](solid)`, and then asked for poses `(p, 4, 4)`, the best first:
`ask(contacts, seed)`. Contacts have a normal and no tip radius, and one pair of bounds. A method whose
package is missing raises `ImportError` while it is prepared.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .solid_particles import (
    STRONG,
    Places,
    Readings,
    Settings,
    distinct,
    rotations,
    search,
    step,
    touchable,
    worst_of,
)
from .solids import Array, Solid

Ask = Callable[[Sequence[Any], int], Array]

#: Points of the surface that methods of clouds are given.
CLOUD = 4000
NUM_STARTS = 60
MOST_ANSWERS = 20
RING = 3.0  # around a contact, parts being 200 across


def particles(solid: Solid) -> Ask:
    """Annealed tolerances (Petrovskaya and Khatib 2011): all particles at the end are its answers."""
    return lambda contacts, seed: search(solid, contacts, seed, STRONG, only_valid=False)


def few_particles(solid: Solid) -> Ask:
    """The same with a sixth of the particles."""
    few = Settings(num_first=4000, num_particles=1300, most_kept=600)
    return lambda contacts, seed: search(solid, contacts, seed, few, only_valid=False)


def _places(solid: Solid, contacts: Sequence[Any], seed: int) -> tuple[Places, Readings]:
    readings = Readings.of(contacts)
    scale = float(readings.position_errors.max() / readings.normal_errors.max())
    return touchable(solid, np.random.default_rng(seed), 20_000, 0.0, scale), readings


def _ordered(places: Places, readings: Readings, poses: Array) -> Array:
    """The best first, without what is the same; those that explain the contacts, else the best alone."""
    worst = worst_of(places, readings, poses, (1.0, 1.0))
    order = np.argsort(worst, kind="stable")
    good = order[worst[order] <= 1.2]
    return distinct(poses[good if len(good) else order[:1]], readings.centers, 2.0)[:MOST_ANSWERS]


def _starts(  # noqa: PLR0917 - on what, for what
    solid: Solid, readings: Readings, random: np.random.Generator, count: int
) -> Array:
    """Poses that lay a random contact on a random place with its normal, turned about it at random."""
    drawn = solid.places(random, count)
    chosen = random.integers(len(readings.centers), size=count)
    normals, sensed = drawn.normals, readings.normals[chosen]
    axis = normals + sensed
    axis += 1e-9 * random.normal(size=axis.shape)
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    half_turns = rotations(np.pi * axis)  # takes one to the other
    spins = rotations(random.uniform(-np.pi, np.pi, size=(count, 1)) * sensed)
    poses = np.broadcast_to(np.eye(4), (count, 4, 4)).copy()
    poses[:, :3, :3] = spins @ half_turns
    shift = readings.centers[chosen] - np.einsum("pij,pj->pi", poses[:, :3, :3], drawn.points)
    poses[:, :3, 3] = shift
    return poses


def least_squares(solid: Solid) -> Ask:
    """Levenberg–Marquardt on distances and normals from many starts (SciPy); all ends within the bounds."""
    from scipy.optimize import least_squares as solve

    def ask(contacts: Sequence[Any], seed: int) -> Array:
        places, readings = _places(solid, contacts, seed)
        random = np.random.default_rng([seed, 1])
        pivot = readings.centers.mean(axis=0)
        reach = float(np.linalg.norm(readings.centers - pivot, axis=1).max())

        def moved(start: Array, way: Array) -> Array:
            turn = rotations(way[None, :3] / reach)[0]
            pose = np.eye(4)
            pose[:3, :3] = turn @ start[:3, :3]
            pose[:3, 3] = turn @ (start[:3, 3] - pivot) + pivot + way[3:]
            return pose

        def left(way: Array, start: Array) -> Array:
            pose = moved(start, way)
            centers = (readings.centers - pose[:3, 3]) @ pose[:3, :3]
            own = readings.normals @ pose[:3, :3]
            _, near = places.tree.query(np.concatenate([centers, places.scale * own], axis=1))
            offset, normals = centers - places.points[near], places.normals[near]
            height = np.einsum("ni,ni->n", offset, normals)
            aside = np.linalg.norm(offset - height[:, None] * normals, axis=1)
            return np.concatenate(
                [
                    height / readings.position_errors,
                    np.maximum(aside - places.spacing, 0.0) / readings.position_errors,
                    ((own - normals) / readings.normal_errors[:, None]).ravel(),
                ]
            )

        ends = []
        for start in _starts(solid, readings, random, NUM_STARTS):
            found = solve(left, np.zeros(6), args=(start,), max_nfev=25, diff_step=1e-4, x_scale=1.0)
            ends.append(moved(start, found.x))
        return _ordered(places, readings, np.array(ends))

    return ask


def open3d_ransac(solid: Solid) -> Ask:
    """Open3D: RANSAC over contacts on random places, tested by lengths and normals, then ICP to planes."""
    import open3d

    registration = open3d.pipelines.registration
    drawn = solid.places(np.random.default_rng(0), CLOUD)
    cloud = _open3d_cloud(open3d, drawn.points, drawn.normals)
    some = 300

    def ask(contacts: Sequence[Any], seed: int) -> Array:
        readings = Readings.of(contacts)
        source = _open3d_cloud(open3d, readings.centers, readings.normals)
        count, error = len(contacts), float(readings.position_errors.max())
        # Places are farther apart than errors are: what is near is as near as that.
        spacing = float(np.sqrt(solid.areas.sum() / some))
        random = np.random.default_rng(seed)
        chosen = random.choice(CLOUD, size=some, replace=False)
        pairs = np.stack([np.repeat(np.arange(count), some), np.tile(chosen, count)], axis=1)
        checks = [
            registration.CorrespondenceCheckerBasedOnEdgeLength(0.85),
            registration.CorrespondenceCheckerBasedOnNormal(0.25),
        ]
        open3d.utility.random.seed(seed)
        poses = []
        for _ in range(4):
            found = registration.registration_ransac_based_on_correspondence(
                source,
                cloud,
                open3d.utility.Vector2iVector(pairs.astype(np.int32)),
                spacing,
                registration.TransformationEstimationPointToPoint(False),
                3,
                checks,
                registration.RANSACConvergenceCriteria(50_000, 0.999),
            )
            turned = found.transformation
            for distance in (spacing, 0.3 * spacing, 4.0 * error):
                turned = registration.registration_icp(
                    source,
                    cloud,
                    distance,
                    turned,
                    registration.TransformationEstimationPointToPlane(),
                    registration.ICPConvergenceCriteria(max_iteration=20),
                ).transformation
            poses.append(np.linalg.inv(turned))
        places, readings = _places(solid, contacts, seed)
        return _ordered(places, readings, np.array(poses))

    return ask


def _open3d_cloud(open3d: Any, points: Array, normals: Array) -> Any:
    cloud = open3d.geometry.PointCloud()
    cloud.points = open3d.utility.Vector3dVector(points)
    cloud.normals = open3d.utility.Vector3dVector(normals)
    return cloud


def opencv_ppf(solid: Solid) -> Ask:
    """OpenCV's surface matching by pairs of points (Drost 2010), its poses refined by least squares."""
    import cv2

    drawn = solid.places(np.random.default_rng(0), CLOUD)
    detector = cv2.ppf_match_3d.PPF3DDetector(0.07, 0.07, 30.0)  # finer ones take minutes to train
    detector.trainModel(np.concatenate([drawn.points, drawn.normals], axis=1).astype(np.float32))

    def ask(contacts: Sequence[Any], seed: int) -> Array:
        places, readings = _places(solid, contacts, seed)
        scene = np.concatenate([readings.centers, readings.normals], axis=1).astype(np.float32)
        try:
            # Every contact is a reference; the finest grid that it takes keeps all of them.
            matched = detector.match(scene, 1.0, 0.01)
        except cv2.error:
            return np.zeros((0, 4, 4))
        poses = np.array([np.asarray(one.pose, dtype=float) for one in matched]).reshape(-1, 4, 4)
        if not len(poses):
            return poses
        for _ in range(8):
            poses = step(places, readings, poses)
        return _ordered(places, readings, poses)

    return ask


def _rings(readings: Readings) -> Array:
    """Each contact and six points around it in its tangent plane."""
    around = np.pi / 3.0 * np.arange(6)
    points = [readings.centers]
    for center, normal in zip(readings.centers, readings.normals, strict=True):
        first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        first /= np.linalg.norm(first)
        second = np.cross(normal, first)
        points.append(center + RING * (np.outer(np.cos(around), first) + np.outer(np.sin(around), second)))
    return np.concatenate(points)


def small_gicp_restarts(solid: Solid) -> Ask:
    """small_gicp: point-to-plane ICP to the cloud of the part from many starts; the ends that fit best."""
    import small_gicp

    drawn = solid.places(np.random.default_rng(0), CLOUD)
    target = small_gicp.PointCloud(drawn.points)
    tree = small_gicp.KdTree(target)
    small_gicp.estimate_normals(target, tree, 8)

    def ask(contacts: Sequence[Any], seed: int) -> Array:
        places, readings = _places(solid, contacts, seed)
        # It asks for more points than there are contacts: a ring around each says its normal, too.
        source = small_gicp.PointCloud(_rings(readings))
        starts = _starts(solid, readings, np.random.default_rng([seed, 1]), 4 * NUM_STARTS)
        poses = []
        for start in starts:
            found = small_gicp.align(
                target,
                source,
                tree,
                init_T_target_source=np.linalg.inv(start),
                registration_type="PLANE_ICP",
                max_correspondence_distance=40.0,
                num_threads=1,
            )
            if np.isfinite(found.T_target_source).all():
                poses.append(np.linalg.inv(found.T_target_source))
        return _ordered(places, readings, np.array(poses).reshape(-1, 4, 4))

    return ask


METHODS: dict[str, Callable[[Solid], Ask]] = {
    "particles, annealed": particles,
    "particles, few": few_particles,
    "least squares, 60 starts": least_squares,
    "Open3D RANSAC and ICP": open3d_ransac,
    "OpenCV PPF": opencv_ppf,
    "small_gicp, 240 starts": small_gicp_restarts,
}
