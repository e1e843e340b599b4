"""First contacts at random places of a model, for simulation (thesis 4.2)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate._core import Contact, Model, Sensor
from palpate.loop.dimension import DIMENSIONS, Array
from palpate.probe import Hit, Noise, SimulatedProbe

MOST_TRIES = 1000


def random_contacts(
    model: Model,
    world_from_model: ArrayLike,
    sensor: Sensor,
    *,
    count: int = 2,
    seed: int = 0,
    noise: Noise = "uniform",
) -> list[Contact]:
    """Contacts at random places of a placed part's faces, for simulation: a probe need not get there (4.2).

    The places are uniform over the outline or the surface. Two of the normals, of solids three, are
    independent, if there are as many, the sensor reads them and the part has such faces.

    Args:
        model: The true part.
        world_from_model: Its pose, shape `(d + 1, d + 1)`.
        sensor: Bounds of the errors, which are made as `SimulatedProbe` makes them.
        count: How many contacts; 1 or more.
        seed: Chooses the places and the errors.
        noise: As for `SimulatedProbe`.

    Raises:
        ValueError: As `SimulatedProbe`; a count below 1; a part without a face that can be touched.
    """
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise ValueError(f"count: must be a whole number, 1 or more (got {count!r}); give 2")
    SimulatedProbe(model, world_from_model, sensor, seed=seed, noise=noise)
    faces, simplices = _pieces(model)
    if not len(faces):
        raise ValueError(f"model: no face of {model.name!r} can be touched (got none); give another part")
    random = np.random.default_rng(seed)
    extents = _extents(simplices)
    dimension = DIMENSIONS[model.dimension]
    contacts: list[Contact] = []
    for attempt in range(MOST_TRIES):
        chosen = random.choice(len(faces), size=count, p=extents / extents.sum())
        places = [(int(faces[k]), _place_in(simplices[k], random)) for k in chosen]
        contacts = [
            _contact_at(
                model, world_from_model, sensor, face=face, place=place, seeds=[seed, attempt, k], noise=noise
            )
            for k, (face, place) in enumerate(places)
        ]
        if count < model.dimension or sensor.normal_error is None or dimension.independent(contacts):
            break
    return contacts


def _pieces(model: Model) -> tuple[NDArray[np.intp], Array]:
    """What can be touched: numbers of faces, with a segment or a triangle of each, shape `(n, d, d)`."""
    touchable = np.array([surface == "touchable" for surface in model.face_surfaces], dtype=bool)
    if model.dimension == 2:
        return np.flatnonzero(touchable), np.array(model.faces)[touchable]
    of_faces = np.asarray(model.triangle_faces)
    kept = touchable[of_faces]
    return of_faces[kept], model.vertices[model.triangles[kept]]


def _extents(simplices: Array) -> Array:
    """Their lengths or, twice, their areas, shape `(n,)`."""
    sides = simplices[:, 1:] - simplices[:, :1]
    if simplices.shape[1] == 2:
        return np.array([math.hypot(*side[0]) for side in sides])
    return np.asarray(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1))


def _place_in(simplex: Array, random: np.random.Generator) -> Array:
    """Uniform in a segment or a triangle; shape `(d,)`."""
    start = simplex[0]
    if len(simplex) == 2:
        return np.asarray(start + random.uniform() * (simplex[1] - start))
    a, b = random.uniform(size=2)
    a, b = (a, b) if a + b <= 1.0 else (1.0 - a, 1.0 - b)
    return np.asarray(start + a * (simplex[1] - start) + b * (simplex[2] - start))


def _contact_at(
    model: Model,
    world_from_model: ArrayLike,
    sensor: Sensor,
    *,
    face: int,
    place: Array,
    seeds: list[int],
    noise: Noise,
) -> Contact:
    """The face alone is touched, straight from in front, at a place of the model's own frame."""
    in_space = model.dimension == 3
    alone = Model.facets([model.face_loops[face]]) if in_space else Model.segments([model.faces[face]])
    pose = np.array(world_from_model, dtype=float)
    normal = pose[:-1, :-1] @ model.face_normals[face]
    place = pose[:-1, :-1] @ place + pose[:-1, -1]
    reach = model.size + sensor.tip_radius
    still = Sensor(sensor.position_error, sensor.normal_error, sensor.max_incidence, sensor.tip_radius)
    seed = int(np.random.SeedSequence(seeds).generate_state(1)[0])
    reply = SimulatedProbe(alone, pose, still, seed=seed, noise=noise).touch(
        place + reach * normal, place - reach * normal
    )
    if not isinstance(reply, Hit):
        raise AssertionError(f"a face was not met from in front: {reply!r}")
    contact = reply.contact
    return Contact.from_tip(
        contact.center,
        contact.tip_radius,
        position_error=contact.position_error,
        approach=contact.approach,
        normal=contact.normal,
        normal_error=contact.normal_error,
    )
