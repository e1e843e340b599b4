"""Projection space against plain geometry: poses, faces and lines computed anew, lines sampled densely."""

import math

import numpy as np
import pytest
from conftest import hypotheses_of, pose, usual_sensor

import palpate

INCIDENCE = math.radians(60)
MARGIN = 1e-3


def boots():
    contacts = palpate.standard_contacts("boot")
    return palpate.recognize(palpate.load_models("boot"), contacts).hypotheses, contacts


class Drawn:
    """Where the thesis places each face: at the nominal pose, then at the two extreme ones."""

    def __init__(self, hypotheses, contacts, *, tip_radius):
        self.faces = {}
        self.half = {}
        for number, hypothesis in enumerate(hypotheses):
            thesis = hypothesis.poses.thesis_pose
            half = self.half[number] = thesis.residual_rotation / 2
            poses = [self.placed(hypothesis, contacts, thesis.rotation + turn) for turn in (0, -half, half)]
            model = hypothesis.model
            for face, (ends, normal) in enumerate(zip(model.faces, model.face_normals, strict=True)):
                moved = ends + tip_radius * normal
                self.faces[number, face] = [
                    (moved @ one[:2, :2].T + one[:2, 2], one[:2, :2] @ normal) for one in poses
                ]

    @staticmethod
    def placed(hypothesis, contacts, angle):
        """The pose of a rotation at which two contacts lie on the lines of their faces."""
        rotation = pose(angle)[:2, :2]
        faces = [index for _, index in hypothesis.interpretations[0].assignment]
        normals = hypothesis.model.face_normals[faces] @ rotation.T
        on_faces = np.array([hypothesis.model.faces[face][0] for face in faces]) @ rotation.T
        centers = np.array([contact.center for contact in contacts])
        return pose(angle, *np.linalg.solve(normals, np.sum(normals * (centers - on_faces), axis=1)))

    def seen_from(self, generator):
        """The ends and normals of every face in the generator's frame, shapes `(3, 2, 2)` and `(3, 2)`."""
        (start, end), normal = self.faces[generator][0]
        x = (start - end) / math.dist(start, end)
        axes = np.column_stack([x, normal])
        return {
            key: (
                np.array([(ends - start) @ axes for ends, _ in known]),
                np.array([n @ axes for _, n in known]),
            )
            for key, known in self.faces.items()
        }


def hits(ends, slope, positions):
    """Which of the lines `x = position + slope * y` have the ends of a face on either side."""
    sides = ends[:, 0] - slope * ends[:, 1] - np.asarray(positions)[:, None]
    return sides.min(axis=1) * sides.max(axis=1) <= 0


@pytest.fixture(scope="module", params=[0.0, 3.0], ids=["point", "ball"])
def case(request):
    """Three boots, the projection space of a slanted face of the second, and its faces drawn anew."""
    hypotheses, contacts = boots()
    sensor = usual_sensor(tip_radius=request.param)
    space = palpate.projection_space(hypotheses, sensor, (1, 7))
    drawn = Drawn(hypotheses, contacts, tip_radius=request.param)
    return space, drawn.seen_from((1, 7)), drawn, max(h.model.size for h in hypotheses)


def test_the_frame_and_the_ends(case):
    space, seen, drawn, _ = case
    assert space.generator == (1, 7) and (space.sheaves[0].hypothesis, space.sheaves[0].face) == (1, 7)
    (start, end), normal = drawn.faces[1, 7][0]
    assert np.allclose(space.world_from_generator @ [0, 0, 1], [*start, 1])
    assert np.allclose(space.world_from_generator @ [0, 1, 0], [*normal, 0])
    assert np.allclose(space.sheaves[0].ends, [[0, 0], [-math.dist(start, end), 0]])
    assert space.max_slope == pytest.approx(math.tan(INCIDENCE - drawn.half[1]))
    for sheaf in space.sheaves:
        nominal, *extremes = seen[sheaf.hypothesis, sheaf.face][0]
        assert np.allclose(sheaf.ends, nominal) and np.allclose(sheaf.extreme_ends, extremes)


def test_the_candidate_set_is_of_faces_that_one_line_may_pierce(case):
    space, seen, drawn, _ = case
    members = {(sheaf.hypothesis, sheaf.face): sheaf for sheaf in space.sheaves}
    for key, (_, normals) in seen.items():
        apart = math.acos(np.clip(normals[0, 1], -1, 1))
        widest = 2 * INCIDENCE + drawn.half[1] + drawn.half[key[0]]
        if abs(apart - widest) > 1e-9:
            assert (key in members) == (apart < widest)
    assert sum(sheaf.sensed for sheaf in space.sheaves) in range(1, 7)
    assert len(space.sheaves) > 12


def test_projections_are_what_sampled_lines_hit(case):
    space, seen, _, _ = case
    slopes = np.linspace(-space.max_slope, space.max_slope, 17)
    positions, step = np.linspace(-700, 700, 14001, retstep=True)
    empty = edge_on = 0
    for sheaf in space.sheaves:
        ends, _ = seen[sheaf.hypothesis, sheaf.face]
        for slope, inner, outer in zip(slopes, sheaf.inner(slopes), sheaf.outer(slopes), strict=True):
            at_both = hits(ends[1], slope, positions), hits(ends[2], slope, positions)
            if min(map(np.sum, at_both)) < 2:
                edge_on += 1
                continue
            for found, expected in ((inner, np.logical_and(*at_both)), (outer, np.logical_or(*at_both))):
                inside = positions[expected]
                if len(inside):
                    assert np.abs(found - [inside[0], inside[-1]]).max() <= step
                else:
                    empty += 1
                    assert np.isnan(found).all() or found[1] - found[0] <= step
            assert 699 > abs(outer).max()
    assert empty > 0 and edge_on < 0.02 * len(slopes) * len(space.sheaves)


def test_lines_skid_where_they_meet_an_extreme_pose_at_more_than_the_incidence(case):
    space, seen, _, _ = case
    slopes = np.linspace(-2, 2, 101)
    back = np.stack([slopes, np.ones(101)]) / np.hypot(slopes, 1)
    mixed = 0
    for sheaf in space.sheaves:
        incidence = np.arccos(np.clip(seen[sheaf.hypothesis, sheaf.face][1][1:] @ back, -1, 1)).max(axis=0)
        clear = abs(incidence - INCIDENCE) > 1e-9
        assert np.array_equal(sheaf.skids(slopes)[clear], incidence[clear] > INCIDENCE)
        mixed += 0 < sheaf.skids(slopes).sum() < 101
    assert mixed > 5


def test_critical_points_are_where_an_end_passes_an_end_of_the_generator(case):
    space, seen, _, _ = case
    slopes, step = np.linspace(-space.max_slope, space.max_slope, 8001, retstep=True)
    points = space.critical_points
    num_found = 0
    for at, _ in space.sheaves[0].ends:
        flips = []
        for sheaf in space.sheaves[1:]:
            for x, y in seen[sheaf.hypothesis, sheaf.face][0][0]:
                # The line through the generator's end has the other end on its left, then on its right.
                sides = np.sign(x - at - slopes * y)
                if max(abs(x - at), abs(y)) > 1e-6:
                    flips += [slopes[k] + step / 2 for k in np.flatnonzero(sides[1:] != sides[:-1])]
        found = points[np.isclose(points[:, 0], at), 1]
        assert len(found) == len(flips)
        assert np.abs(np.sort(found) - np.sort(flips)).max() <= 0.51 * step
        num_found += len(found)
    assert num_found == len(points) > 20


def test_critical_slopes_go_from_zero_outward_and_are_compacted(case):
    space, _, _, _ = case
    kept, wanted = (
        space.critical_slopes,
        [0.0, -space.max_slope, space.max_slope, *space.critical_points[:, 1]],
    )
    assert kept[0] == 0.0
    assert (np.diff(np.abs(kept)) >= 0).all() and np.abs(kept).max() == space.max_slope
    assert set(kept) <= set(wanted)
    apart = np.abs(kept[:, None] - kept)
    assert apart[~np.eye(len(kept), dtype=bool)].min() >= MARGIN
    assert max(np.abs(kept - slope).min() for slope in wanted) < MARGIN


def test_overlaps_are_of_all_that_is_pierced_beside_an_end(case):
    space, seen, _, size = case
    num_shared = 0
    for slope in space.critical_slopes[:20]:
        low, high = space.sheaves[0].inner([slope])[0]
        beside = 2 * MARGIN * size
        overlaps = space.overlaps(slope)
        assert len(overlaps) == 2
        for overlap, place in zip(overlaps, (low + beside, high - beside), strict=True):
            pierced = [0]
            for number, sheaf in enumerate(space.sheaves[1:], start=1):
                _, *extremes = seen[sheaf.hypothesis, sheaf.face][0]
                # A hair to either side: where they differ, rounding may decide.
                hit = [all(hits(ends, slope, [place + h])[0] for ends in extremes) for h in (-1e-7, 0, 1e-7)]
                if len(set(hit)) > 1:
                    hit[1] = number in overlap.sheaves
                first, last = sheaf.inner([slope])[0]
                if hit[1] and last - first > beside and not sheaf.skids([slope])[0]:
                    pierced.append(number)
            assert overlap.sheaves == pierced
            lows, highs = np.transpose([space.sheaves[number].inner([slope])[0] for number in pierced])
            shared = (lows.max(), highs.min())
            assert overlap.positions == (shared if shared[0] <= shared[1] else None)
            num_shared += len(pierced) > 2
    assert num_shared > 5


def test_no_path_fits_where_the_generator_is_seen_edge_on(case):
    space, _, _, _ = case
    assert math.isnan(space.sheaves[0].inner([40.0])[0, 0]) and space.overlaps(40.0) == []


@pytest.mark.parametrize("name", ["boot", "human-hand", "camera"])
def test_the_path_is_that_of_the_planner_ellis(name):
    hypotheses, sensor = hypotheses_of(name), usual_sensor()
    space = palpate.projection_space(hypotheses, sensor)
    assert space.path == palpate.plan(hypotheses, sensor, planner="ellis")
    back = np.linalg.inv(space.world_from_generator)
    x, y = back[:2, :2] @ space.path.direction
    assert y < 0 and x / y == pytest.approx(space.path_slope, abs=1e-9)
    at = (back @ [*space.path.start, 1])[:2]
    assert at[0] - space.path_slope * at[1] == pytest.approx(space.path_position, abs=1e-9)
    assert space.path_slope in space.critical_slopes
    middles = [sum(o.positions) / 2 for o in space.overlaps(space.path_slope) if o.positions]
    assert space.path_position in middles
    again = palpate.projection_space(hypotheses, sensor, space.generator)
    assert again.path == space.path and again.sheaves == space.sheaves


def test_settings_reach_the_search():
    hypotheses, sensor = hypotheses_of("human-hand"), usual_sensor()
    down = {"directions": ((0, -1), 0.5), "workspace": [[-300, -300], [300, 300]], "avoid_assigned": True}
    space = palpate.projection_space(hypotheses, sensor, stop=("unique", 2), seed=3, effort=500, **down)
    assert space.path.direction[1] <= -math.cos(0.5) and space.path.start[1] == pytest.approx(300)
    wide = palpate.projection_space(hypotheses, sensor, margin=0.02)
    fine = palpate.projection_space(hypotheses, sensor, wide.generator, margin=1e-5, time_limit=60)
    assert len(wide.critical_slopes) < len(fine.critical_slopes)
    assert palpate.projection_space(hypotheses, sensor, features=("vertex",), effort=50).path is None


def test_one_hypothesis_and_loose_faces_have_a_space_without_a_path():
    hypotheses, _ = boots()
    lone = palpate.projection_space(hypotheses[:1], usual_sensor())
    assert lone.path is None and lone.path_slope is None and lone.path_position is None
    assert "0 of hypothesis 0" in repr(lone) and "Sheaf of face 0" in repr(lone.sheaves[0])
    assert repr(lone.overlaps(0)[0]).startswith("<Overlap of ")
    touches = [
        palpate.Contact(p, n, position_error=0.5, normal_error=0.07)
        for p, n in (((20, 0), (0, 1)), ((40, 8), (1, 0)))
    ]
    rail = palpate.Model.segments([[[40, 0], [0, 0]], [[40, 0], [40, 15]], [[0, 30], [40, 30]]])
    found = palpate.recognize([rail], touches).hypotheses
    assert len(found) == 1
    # The third face is the only one without a contact.
    space = palpate.projection_space(found, usual_sensor())
    assert space.generator == (0, 2) and space.path is None and len(space.sheaves) > 1


def test_every_array_is_read_only_and_every_sheaf_is_itself(case):
    space, _, _, _ = case
    sheaf, other = space.sheaves[:2]
    arrays = [space.world_from_generator, space.critical_points, space.critical_slopes, sheaf.ends]
    arrays += [sheaf.extreme_ends, sheaf.inner([0.0]), sheaf.outer([0.0]), sheaf.skids([0.0])]
    assert not any(array.flags.writeable for array in arrays)
    assert [array.shape for array in arrays[4:]] == [(2, 2, 2), (1, 2), (1, 2), (1,)]
    assert sheaf == space.sheaves[0] and sheaf != other
    assert space.overlaps(0)[0] == space.overlaps(0)[0]
