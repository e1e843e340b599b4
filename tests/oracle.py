"""Brute force in the plane, to hold the recognizer against: fine rotations, at each of them plain geometry.

Nothing here is shared with the package: arrays, `scipy.optimize.linprog` and `shapely`.
"""

import heapq
import itertools
from dataclasses import dataclass

import numpy as np
import shapely
from scipy.optimize import linprog

# At a fixed rotation the translations that satisfy contact i are the stadium of radius ε_i about C_i − R F_i.
# Two stadiums meet if and only if their segments are no farther apart than ε_i + ε_j.


def faces_of(model, radius=0.0):
    """Ends of the faces moved out by a tip's radius, shape `(f, 2, 2)`, and the angles of their normals."""
    faces = np.array(model.faces)
    along = faces[:, 1] - faces[:, 0]
    normals = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.linalg.norm(along, axis=1, keepdims=True)
    return faces + radius * normals[:, None], np.arctan2(normals[:, 1], normals[:, 0])


def turned(points, angles):
    """Points of shape `(..., 2)` turned by angles that broadcast against `(...)`."""
    c, s = np.cos(angles), np.sin(angles)
    return np.stack(
        [c * points[..., 0] - s * points[..., 1], s * points[..., 0] + c * points[..., 1]], axis=-1
    )


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def point_segment(p, a, b):
    span, offset = b - a, p - a
    t = np.clip((offset * span).sum(-1) / np.maximum((span * span).sum(-1), 1e-300), 0.0, 1.0)
    return np.linalg.norm(offset - t[..., None] * span, axis=-1)


def segment_segment(a, b, c, d):
    """Distance of the segments ab and cd, shapes `(..., 2)`."""
    ends = [point_segment(a, c, d), point_segment(b, c, d), point_segment(c, a, b), point_segment(d, a, b)]
    apart = cross(b - a, c - a) * cross(b - a, d - a) < 0.0
    astride = cross(d - c, a - c) * cross(d - c, b - c) < 0.0
    return np.where(apart & astride, 0.0, np.min(ends, axis=0))


def wrap(angle):
    return (angle + np.pi) % (2 * np.pi) - np.pi


@dataclass
class Verdict:
    """Assignments that are surely valid, and those that may be: within the tolerance, or not decided."""

    sure: set
    possible: set

    @property
    def undecided(self):
        return self.possible - self.sure


def rotation_range(contact, normal_angle, slack):
    """Middle and half width of the rotations that a normal leaves."""
    if contact.normal is None:
        return 0.0, np.pi
    sensed = np.arctan2(contact.normal[1], contact.normal[0])
    return wrap(sensed - normal_angle), min(contact.normal_error + slack, np.pi)


def common_rotations(contacts, normal_angles, slack):
    """The rotations that all normals leave, one interval or None; readings are narrower than half a turn."""
    known = [
        rotation_range(contact, angle, slack)
        for contact, angle in zip(contacts, normal_angles, strict=True)
        if contact.normal is not None
    ]
    if not known:
        return -np.pi, np.pi
    middle = known[0][0]
    offsets = [(wrap(m - middle), half) for m, half in known]
    low, high = max(o - half for o, half in offsets), min(o + half for o, half in offsets)
    return (middle + low, middle + high) if low <= high else None


def decide_pairs(model, contacts, *, tolerance=1e-6):
    """Every assignment of two contacts to faces: least distance of the two segments over the rotations."""
    length = tolerance * model.size
    limit = sum(contact.position_error for contact in contacts)
    parts = [faces_of(model, contact.tip_radius) for contact in contacts]
    lever = np.linalg.norm(np.array(contacts[1].center) - contacts[0].center)
    touchable = [k for k, kind in enumerate(model.face_surfaces) if kind == "touchable"]
    sure, possible = set(), set()
    for slack, found, bound in ((0.0, sure, limit), (1.01 * tolerance, possible, limit + 2.01 * length)):
        pairs, lows, highs = [], [], []
        for pair in itertools.product(touchable, repeat=2):
            rotations = common_rotations(contacts, [parts[k][1][face] for k, face in enumerate(pair)], slack)
            if rotations is None:
                continue
            count = max(2, int(np.ceil((rotations[1] - rotations[0]) / 0.02)))
            marks = np.linspace(*rotations, count)
            pairs += [pair] * (count - 1)
            lows += list(marks[:-1])
            highs += list(marks[1:])
        _bisect(
            contacts,
            [part[0] for part in parts],
            cells=(np.array(pairs, dtype=int).reshape(-1, 2), np.array(lows), np.array(highs)),
            bound=bound,
            lever=lever,
            finest=0.1 * length,
            found=found,
            # What is not decided at the finest may be valid.
            keep=slack > 0.0,
        )
    return Verdict(sure, possible | sure)


def _bisect(contacts, faces, *, cells, bound, lever, finest, found, keep):
    """Adds pairs whose segments come within `bound` at some rotation; the gap has slope `lever` at most."""
    pairs, lows, highs = cells
    while len(pairs):
        middles, halves = 0.5 * (lows + highs), 0.5 * (highs - lows)
        ends = [
            np.array(contacts[k].center) - turned(faces[k][pairs[:, k]], middles[:, None]) for k in range(2)
        ]
        gaps = segment_segment(ends[0][:, 0], ends[0][:, 1], ends[1][:, 0], ends[1][:, 1])
        done = gaps <= bound
        if keep:
            done |= halves * lever <= finest
        found.update(map(tuple, pairs[done].tolist()))
        left = ~done & (gaps - halves * lever <= bound) & (halves * lever > finest)
        left &= np.array([tuple(pair) not in found for pair in pairs.tolist()], dtype=bool)
        pairs = np.concatenate([pairs[left], pairs[left]])
        lows, highs = (
            np.concatenate([lows[left], middles[left]]),
            np.concatenate([middles[left], highs[left]]),
        )


#: Directions in which stadiums are bounded at first.
DIRECTIONS = np.array([[1, 0], [0, 1], [-1, 0], [0, -1], [0.6, 0.8], [-0.8, 0.6], [-0.6, -0.8], [0.8, -0.6]])


def least_excess(contacts, segments, *, gap):
    """Over all translations, the least of the greatest excess over the position errors, from below and above.

    `segments` are C_i − R F_i. A linear program over half-planes around the stadiums bounds it from below,
    the excess at its translation from above; half-planes are added there until the two are within `gap`.
    """
    errors = np.array([contact.position_error for contact in contacts])
    pairs = [(k, direction) for k in range(len(contacts)) for direction in DIRECTIONS]
    for _ in range(30):
        rows = [[*direction, -1.0] for _, direction in pairs]
        limits = [(segments[k] @ direction).max() + errors[k] for k, direction in pairs]
        solved = linprog([0, 0, 1], A_ub=rows, b_ub=limits, bounds=[(None, None)] * 3)
        assert solved.status == 0, solved.message
        place = solved.x[:2]
        nearest = [nearest_on(place, segment) for segment in segments]
        distances = np.array([np.linalg.norm(place - point) for point in nearest])
        above = (distances - errors).max()
        if above - solved.fun <= gap:
            break
        pairs += [
            (k, (place - nearest[k]) / distances[k]) for k in range(len(contacts)) if distances[k] > 0.0
        ]
    return solved.fun, above


def nearest_on(point, segment):
    span = segment[1] - segment[0]
    return segment[0] + np.clip((point - segment[0]) @ span / (span @ span), 0.0, 1.0) * span


def decide(model, contacts, *, tolerance=1e-6):
    """Every assignment of contacts to faces: linear programs over translations, rotations divided."""
    length = tolerance * model.size
    parts = [faces_of(model, contact.tip_radius) for contact in contacts]
    verdict = Verdict(set(), set())
    for assignment in pairwise(model, contacts, parts=parts, slack=2.01 * length):
        chosen = [part[0][face] for part, face in zip(parts, assignment, strict=True)]
        normals = [part[1][face] for part, face in zip(parts, assignment, strict=True)]
        answer = decide_assignment(contacts, chosen, normals, length=length, tolerance=tolerance)
        if answer:
            getattr(verdict, answer).add(assignment)
    verdict.possible |= verdict.sure
    return verdict


def decide_assignment(contacts, faces, normals, *, length, tolerance):
    """Whether the assignment is "sure" or "possible", or neither: None.

    Turning the placed part about the middle of the contacts moves it, seen from a contact, by no more than
    the angle times the contact's lever: the least excess changes no faster than that.
    """
    strict = common_rotations(contacts, normals, 0.0)
    rotations = common_rotations(contacts, normals, 1.01 * tolerance)
    centers = np.array([contact.center for contact in contacts])
    centers = centers - centers.mean(axis=0)
    reach = np.linalg.norm(centers, axis=1).max()
    cells = [(-np.inf, *rotations)] if rotations else []
    while cells:
        _, low, high = heapq.heappop(cells)
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        segments = [center - turned(face, middle) for center, face in zip(centers, faces, strict=True)]
        below, above = least_excess(contacts, segments, gap=0.01 * length)
        if above <= 0.0 and strict and strict[0] <= middle <= strict[1]:
            return "sure"
        if below > 1.01 * length + half * reach:
            continue
        if half * reach < 0.1 * length:
            return "possible"
        cells += [(below, low, middle), (below, middle, high)]
        heapq.heapify(cells)
    return None


def pairwise(model, contacts, *, parts, slack):
    """Assignments all of whose pairs may hold at one of many rotations: a necessary condition."""
    touchable = np.array([k for k, kind in enumerate(model.face_surfaces) if kind == "touchable"])
    centers = np.array([contact.center for contact in contacts])
    errors = np.array([contact.position_error for contact in contacts])
    half = 0.005
    ranges = [
        np.array([rotation_range(contact, part[1][face], 1e-5) for face in touchable])
        for contact, part in zip(contacts, parts, strict=True)
    ]
    found = set()
    for middle in np.arange(-np.pi, np.pi, 2 * half) + half:
        near = [touchable[np.abs(wrap(range_[:, 0] - middle)) <= range_[:, 1] + half] for range_ in ranges]
        if not all(len(faces) for faces in near):
            continue
        segments = [
            center - turned(part[0][faces], middle)
            for center, part, faces in zip(centers, parts, near, strict=True)
        ]
        partial = [()]
        for k in range(len(contacts)):
            meets = []
            for j in range(k):
                (a, b), (c, d) = (np.moveaxis(segments[i], 1, 0) for i in (j, k))
                gaps = segment_segment(a[:, None], b[:, None], c[None], d[None])
                lever = half * np.linalg.norm(centers[k] - centers[j])
                meets.append(gaps <= errors[j] + errors[k] + lever + slack)
            partial = [
                (*head, face)
                for head in partial
                for face in range(len(near[k]))
                if all(meets[j][chosen, face] for j, chosen in enumerate(head))
            ]
        found.update(tuple(int(near[k][face]) for k, face in enumerate(assignment)) for assignment in partial)
    return sorted(found)


def placed(model, pose):
    """The placed part as a shapely polygon, its holes cut out."""
    corners = [pose[:2, :2] @ face[0] + pose[:2, 2] for face in model.faces]
    loops, begin = [], 0
    for k, face in enumerate(model.faces):
        if k + 1 == len(model.faces) or not np.array_equal(face[1], model.faces[k + 1][0]):
            loops.append(corners[begin : k + 1])
            begin = k + 1
    return shapely.Polygon(loops[0], loops[1:])


def intrusion(part, start, end, clearance):
    """By how much a sweep is nearer to a placed part than its clearance, and how well that is known."""
    way = shapely.LineString([start, end])
    outline = part.boundary
    if not part.intersects(way):
        return clearance - part.distance(way), 0.0
    inner = part.intersection(way)
    pieces = [piece for piece in shapely.get_parts(inner) if piece.length > 0.0]
    if not pieces:
        return clearance, 0.0
    points = np.concatenate(
        [shapely.line_interpolate_point(piece, np.linspace(0, piece.length, 200)) for piece in pieces]
    )
    depth = shapely.distance(outline, points).max()
    # The depth changes no faster than the way along the sweep.
    return clearance + depth, max(piece.length for piece in pieces) / 199
