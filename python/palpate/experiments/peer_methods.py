"""Other ways to find a part by its contacts, each made as strong as its kind allows; only for comparison.

Each is prepared for a part, `METHODS[name].prepare(solid, scale)`, and then asked for poses `(p, 4, 4)`, the
best first: `ask(contacts, seed)`. Contacts have a normal and no tip radius, and one pair of bounds; `scale`
is the ratio of the two, the length that counts as much as a radian. A method whose package is missing raises
`ImportError` or `OSError` while it is prepared. Particles are all answers; other methods answer every pose
that they find and that explains each contact within 1.2 of its bounds, else the best alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from .peer_truth import APART
from .solid_particles import (
    Places,
    Readings,
    Settings,
    distinct,
    in_ball,
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
#: What is tried, so that each method takes a second or so.
NUM_STARTS, NUM_FINISHED = 3000, 60
NUM_ALIGNED = 4000
NUM_RANSAC, NUM_DRAWS, NUM_ICP = 8, 50_000, 1000
NUM_SHAKEN = 100
RING = 3.0  # around a contact, parts being 200 across
EXPLAINED = 1.2
LOST = 1e4


class Method(NamedTuple):
    """How a peer is made ready for a part, and with which settings, in words."""

    prepare: Callable[[Solid, float], Ask]
    package: str
    settings: str


def particles(solid: Solid, scale: float, *, count: int) -> Ask:
    """A scaling series (Petrovskaya and Khatib 2011): all particles at the end are its answers."""
    settings = Settings(num_first=3 * count, num_particles=count, most_kept=count // 2, rounds=25, even=True)
    places = _places(solid, scale)
    return lambda contacts, seed: search(solid, contacts, seed, settings, only_valid=False, places=places)


def _places(solid: Solid, scale: float) -> Places:
    return touchable(solid, np.random.default_rng(0), 20_000, 0.0, scale)


def _ordered(places: Places, readings: Readings, poses: Array) -> Array:
    """The best first, without what is the same; those that explain the contacts, else the best alone."""
    if not len(poses):
        return poses
    worst = worst_of(places, readings, poses, (1.0, 1.0))
    order = np.argsort(worst, kind="stable")
    good = order[worst[order] <= EXPLAINED]
    return distinct(poses[good if len(good) else order[:1]], readings.centers, APART)


def _moved_on(places: Places, readings: Readings, poses: Array) -> Array:
    """By least squares on distances and normals: ends of other errors are not yet the best by the bounds."""
    # ICP may end nowhere.
    away = np.linalg.norm(poses[:, :3, 3] - readings.centers.mean(axis=0), axis=1)
    poses = poses[np.isfinite(poses).all(axis=(1, 2)) & (away < LOST)]
    for _ in range(8 if len(poses) else 0):
        poses = step(places, readings, poses)
    return poses


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


def least_squares(solid: Solid, scale: float) -> Ask:
    """Least squares of distances and normals from many starts; the best of them finished by SciPy."""
    from scipy.optimize import least_squares as solve

    places = _places(solid, scale)

    def ask(contacts: Sequence[Any], seed: int) -> Array:
        readings = Readings.of(contacts)
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

        poses = _starts(solid, readings, random, NUM_STARTS)
        for _ in range(12):
            poses = step(places, readings, poses)
        order = np.argsort(worst_of(places, readings, poses, (1.0, 1.0)), kind="stable")
        apart = distinct(poses[order], readings.centers, APART)
        ends = []
        for start in apart[:NUM_FINISHED]:
            found = solve(left, np.zeros(6), args=(start,), max_nfev=15, diff_step=1e-4, x_scale=1.0)
            ends.append(moved(start, found.x))
        # Those that are not among the best are minima of their own all the same.
        return _ordered(places, readings, np.concatenate([np.array(ends).reshape(-1, 4, 4), apart]))

    return ask


def open3d_ransac(solid: Solid, scale: float) -> Ask:
    """Open3D: RANSAC over contacts on random places, tested by lengths and normals, then ICP to planes."""
    import open3d

    places = _places(solid, scale)
    registration = open3d.pipelines.registration
    drawn = solid.places(np.random.default_rng(0), CLOUD)
    cloud = _open3d_cloud(open3d, drawn.points, drawn.normals)
    some = 300

    def ask(contacts: Sequence[Any], seed: int) -> Array:
        readings = Readings.of(contacts)
        source = _open3d_cloud(open3d, readings.centers, readings.normals)
        count = len(contacts)
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
        for _ in range(NUM_RANSAC):
            found = registration.registration_ransac_based_on_correspondence(
                source,
                cloud,
                open3d.utility.Vector2iVector(pairs.astype(np.int32)),
                spacing,
                registration.TransformationEstimationPointToPoint(False),
                3,
                checks,
                registration.RANSACConvergenceCriteria(NUM_DRAWS, 0.999),
            )
            poses.append(np.linalg.inv(found.transformation))
        poses += list(_starts(solid, readings, np.random.default_rng([seed, 1]), NUM_ICP))
        points, normals = _rings(readings)
        rings = _open3d_cloud(open3d, points, normals)
        for number, pose in enumerate(poses):
            turned = np.linalg.inv(pose)
            for distance in (2.0 * spacing, 0.3 * spacing):
                turned = registration.registration_icp(
                    rings,
                    cloud,
                    distance,
                    turned,
                    registration.TransformationEstimationPointToPlane(),
                    registration.ICPConvergenceCriteria(max_iteration=20),
                ).transformation
            poses[number] = np.linalg.inv(turned)
        return _ordered(places, readings, _moved_on(places, readings, np.array(poses)))

    return ask


def _open3d_cloud(open3d: Any, points: Array, normals: Array) -> Any:
    cloud = open3d.geometry.PointCloud()
    cloud.points = open3d.utility.Vector3dVector(points)
    cloud.normals = open3d.utility.Vector3dVector(normals)
    return cloud


def opencv_ppf(solid: Solid, scale: float) -> Ask:
    """OpenCV's surface matching by pairs of points (Drost 2010), its poses refined by least squares."""
    import cv2

    places = _places(solid, scale)
    drawn = solid.places(np.random.default_rng(0), CLOUD)
    detector = cv2.ppf_match_3d.PPF3DDetector(0.08, 0.08, 30.0)  # finer ones take a minute to train
    detector.trainModel(np.concatenate([drawn.points, drawn.normals], axis=1).astype(np.float32))

    def ask(contacts: Sequence[Any], seed: int) -> Array:
        readings = Readings.of(contacts)
        poses = [np.zeros((0, 4, 4))]
        for centers, normals in _shaken(readings, np.random.default_rng([seed, 1])):
            scene = np.concatenate([centers, normals], axis=1).astype(np.float32)
            try:
                # Every contact is a reference; the finest grid that it takes keeps all of them.
                matched = detector.match(scene, 1.0, 0.01)
            except cv2.error:
                continue
            poses += [np.asarray(one.pose, dtype=float)[None] for one in matched]
        found = np.concatenate(poses)
        if not len(found):
            return found
        return _ordered(places, readings, _moved_on(places, readings, found))

    return ask


def _shaken(readings: Readings, random: np.random.Generator) -> list[tuple[Array, Array]]:
    """The contacts as they were read, and moved at random within their bounds."""
    count = len(readings.centers)
    given = [(readings.centers, readings.normals)]
    for _ in range(NUM_SHAKEN - 1):
        centers = readings.centers + readings.position_errors[:, None] * in_ball(random, count)
        normals = readings.normals + readings.normal_errors[:, None] * in_ball(random, count)
        given.append((centers, normals / np.linalg.norm(normals, axis=1, keepdims=True)))
    return given


def _rings(readings: Readings) -> tuple[Array, Array]:
    """Each contact and six points around it in its tangent plane, and the normals of all of them."""
    around = np.pi / 3.0 * np.arange(6)
    points = [readings.centers]
    for center, normal in zip(readings.centers, readings.normals, strict=True):
        first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        first /= np.linalg.norm(first)
        second = np.cross(normal, first)
        points.append(center + RING * (np.outer(np.cos(around), first) + np.outer(np.sin(around), second)))
    return np.concatenate(points), np.concatenate([readings.normals, np.repeat(readings.normals, 6, axis=0)])


def small_gicp_restarts(solid: Solid, scale: float) -> Ask:
    """small_gicp: point-to-plane ICP to the cloud of the part from many starts; the ends that fit best."""
    import small_gicp

    places = _places(solid, scale)
    drawn = solid.places(np.random.default_rng(0), CLOUD)
    target = small_gicp.PointCloud(drawn.points)
    tree = small_gicp.KdTree(target)
    small_gicp.estimate_normals(target, tree, 8)

    def ask(contacts: Sequence[Any], seed: int) -> Array:
        readings = Readings.of(contacts)
        # It asks for more points than there are contacts: a ring around each says its normal, too.
        source = small_gicp.PointCloud(_rings(readings)[0])
        starts = _starts(solid, readings, np.random.default_rng([seed, 1]), NUM_ALIGNED)
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
            poses.append(np.linalg.inv(found.T_target_source))
        return _ordered(places, readings, _moved_on(places, readings, np.array(poses).reshape(-1, 4, 4)))

    return ask


METHODS: dict[str, Method] = {
    **{
        f"scaling series, {count:,} particles": Method(
            partial(particles, count=count),
            "numpy",
            f"{3 * count:,} first poses from pairs of contacts on pairs of places that fit them, then "
            f"{count:,}, moved by least squares while tolerances are wide; at the end 25 rounds at random",
        )
        for count in (500, 2000, 8000)
    },
    "least squares, many starts": Method(
        least_squares,
        "scipy",
        f"{NUM_STARTS:,} starts that lay a contact on the part with its normal, 12 steps each on distances "
        f"and normals; the {NUM_FINISHED} best minima finished by SciPy",
    ),
    "Open3D": Method(
        open3d_ransac,
        "open3d",
        f"RANSAC by triples of contacts and places, tested by lengths and normals, {NUM_RANSAC} times with "
        f"{NUM_DRAWS:,} draws, and {NUM_ICP:,} starts; from each ICP of points to planes, with a ring of "
        "six points around each contact; the ends moved on by least squares",
    ),
    "OpenCV surface matching": Method(
        opencv_ppf,
        "opencv-contrib-python-headless",
        f"pairs of points with normals (PPF), every contact a reference, {NUM_SHAKEN} times with the "
        "contacts moved within their bounds; its poses moved on by least squares",
    ),
    "small_gicp": Method(
        small_gicp_restarts,
        "small_gicp",
        f"ICP of points to planes from {NUM_ALIGNED:,} starts, with a ring of six points around each contact "
        "that says its normal; the ends moved on by least squares",
    ),
}
