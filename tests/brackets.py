"""Parts in space that several tests touch, and contacts of them."""

import math

import numpy as np

import palpate

ARMS = [[0, 0], [60, 0], [60, 15], [15, 15], [15, 40], [0, 40]]
FANS = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
SQUARE = [[0, 0], [30, 0], [30, 30], [0, 30]]


def prism(outline, fans, height):
    """Vertices and triangles of the solid over an outline, bottom first."""
    n = len(outline)
    vertices = np.array([[x, y, z] for z in (0.0, height) for x, y in outline])
    bottom = [(a, c, b) for a, b, c in fans]
    top = [(n + a, n + b, n + c) for a, b, c in fans]
    sides = [(k, (k + 1) % n, n + (k + 1) % n) for k in range(n)]
    sides += [(k, n + (k + 1) % n, n + k) for k in range(n)]
    return vertices, np.array(bottom + top + sides)


def bracket(**changes):
    return palpate.Model.mesh(*prism(ARMS, FANS, 25), name="bracket", **changes)


def cube(**changes):
    return palpate.Model.mesh(*prism(SQUARE, FANS[:2], 30), **({"name": "cube"} | changes))


def turned(x, y, z, shift=(0, 0, 0)):
    """A turn about each axis in turn, then a shift, as a homogeneous matrix."""
    motion = np.eye(4)
    for axis, angle in enumerate((x, y, z)):
        c, s = math.cos(angle), math.sin(angle)
        turn = np.eye(4)
        i, j = [k for k in range(3) if k != axis]
        turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
        motion = turn @ motion
    motion[:3, 3] = shift
    return motion


POSE = turned(0.4, -0.9, 2.1, (110, -40, 70))

# Points of the bracket, inside its faces, with their outward normals; model frame.
POINTS = [
    ((30, 8, 25), (0, 0, 1)),
    ((7, 30, 25), (0, 0, 1)),
    ((60, 8, 12), (1, 0, 0)),
    ((30, 0, 10), (0, -1, 0)),
    ((8, 40, 15), (0, 1, 0)),
    ((40, 15, 5), (0, 1, 0)),
]


def touches(points=POINTS, pose=POSE, errors=(0.5, 0.07)):
    placed = [(pose[:3, :3] @ point + pose[:3, 3], pose[:3, :3] @ normal) for point, normal in points]
    return [palpate.Contact(*one, position_error=errors[0], normal_error=errors[1]) for one in placed]
