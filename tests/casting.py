"""What a tip on a line meets first, found by another library: shapely's buffers and intersections."""

import math

import numpy as np
from shapely.geometry import LineString, Polygon

FAR = 1e4
ARC = 256  # pieces of a quarter of a circle


def placed(world_from_model, points):
    return points @ world_from_model[:2, :2].T + world_from_model[:2, 2]


class Placed:
    """A part at a pose, grown by the tip."""

    def __init__(self, model, world_from_model, tip_radius):
        self.tip_radius = tip_radius
        self.faces = [placed(world_from_model, face) for face in model.faces]
        self.normals = model.face_normals @ world_from_model[:2, :2].T
        self.corners = placed(world_from_model, model.vertices)
        whole = Polygon(self.corners)
        self.grown = whole.buffer(tip_radius, quad_segs=ARC) if tip_radius else whole
        self.border = self.grown.boundary

    def first(self, start, direction):
        """Depth, feature, normal and incidence of the first touch; None for a miss."""
        met = self.border.intersection(LineString([start, start + FAR * direction]))
        if met.is_empty:
            return None
        points = np.vstack([np.asarray(part.coords) for part in getattr(met, "geoms", [met])])
        depth = min(float(direction @ (point - start)) for point in points)
        center = start + depth * direction
        feature, normal = self.nearest(center)
        return depth, feature, normal, math.acos(min(1.0, max(-1.0, float(-direction @ normal))))

    def nearest(self, center):
        """What lies next to the tip, and the normal there."""
        found = [self.to_face(center, face) for face in self.faces]
        face = min(range(len(found)), key=found.__getitem__)
        away, share = found[face]
        if not self.tip_radius or 0.0 < share < 1.0:
            return ("face", face), self.normals[face]
        corner = self.faces[face][int(share)]
        vertex = int(np.argmin(np.hypot(*(self.corners - corner).T)))
        return ("vertex", vertex), (center - corner) / away

    @staticmethod
    def to_face(center, face):
        """Distance, and where along the face its nearest point is."""
        along = face[1] - face[0]
        share = min(1.0, max(0.0, float(along @ (center - face[0]) / (along @ along))))
        return math.dist(center, face[0] + share * along), share
