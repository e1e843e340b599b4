"""What a ball meets first in space, by numpy alone: a march by the distance to the triangles."""

import math

import numpy as np

from palpate.experiments.solid_sweeps import to_triangles


class PlacedSolid:
    """A part at a pose."""

    def __init__(self, model, world_from_model):
        placed = model.vertices @ world_from_model[:3, :3].T + world_from_model[:3, 3]
        self.corners = placed[model.triangles]
        self.middle = placed.mean(axis=0)

    def distances(self, points):
        """From the surface, of points `(n, 3)`."""
        count, many = len(points), len(self.corners)
        pairs = to_triangles(np.repeat(points, many, axis=0), np.tile(self.corners, (count, 1, 1)))
        return pairs.reshape(count, many).min(axis=1)

    def marched(self, starts, directions, *, radius, last, slack=1e-7):
        """How far balls go on lines `(n, 3)`, till they are within `slack` of touching or at `last`, `(n,)`.

        nan where a ball goes on and on beside the part.
        """
        depths, open_ones = np.zeros(len(starts)), np.arange(len(starts))
        for _ in range(3000):
            places = starts[open_ones] + depths[open_ones, None] * directions[open_ones]
            free = self.distances(places) - radius
            depths[open_ones] = np.minimum(depths[open_ones] + np.maximum(free, 0.0), last[open_ones])
            open_ones = open_ones[(free > slack) & (depths[open_ones] < last[open_ones])]
            if not len(open_ones):
                return depths
        depths[open_ones] = math.nan
        return depths


def lines(placed, model, *, count, seed):
    """Random lines `(n, 3)` from a sphere around the part, most of which meet it."""
    random = np.random.default_rng(seed)

    def directions():
        drawn = random.normal(size=(count, 3))
        return drawn / np.linalg.norm(drawn, axis=1)[:, None]

    starts = placed.middle + 1.2 * model.size * directions()
    aims = placed.middle + 0.5 * model.size * random.uniform(size=(count, 1)) * directions()
    ways = aims - starts
    return starts, ways / np.linalg.norm(ways, axis=1)[:, None]
