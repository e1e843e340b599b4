"""The rig's force sensor over thousands of contacts: its errors against the physics, and its bounds.

Problem `k` of kind `g` is one guarded move at a random place of a part, from a few millimetres before it;
kinds differ in which errors the sensor has. Truth is what the physics says: where the tip is while it is
read, and the normal of the place that bears most.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from palpate import Fault, Hit, Model, bundled_parts, bundled_solids
from palpate.experiments.campaign import Row
from palpate.experiments.experiment import SEEDS, Experiment, Picture
from palpate.experiments.pages import share, table
from palpate.experiments.shapes import Array
from palpate.plots.style import COLORS
from palpate.probe import random_pose
from palpate.rig import FROM_ABOVE, SIZE, RigProbe, RigSpec, without_errors
from palpate.rig.gauges import turned

REPEATS = 500
RUN_IN = 12.0  # mm before the first touch
BEYOND = 10.0  # mm behind it
MOST_INCIDENCE = math.radians(60)
MOST_TRIES = 5000
THESIS = {"normal_deg": 0.5, "position": 0.5}  # A.1: of a truly planar contact

# Kinds: dimension, errors that the sensor has not, and how they are called. Four of them are the same, so
# that 2,000 contacts have every error.
EVERY = "drift, creep and noise"
KINDS: tuple[tuple[int, tuple[str, ...], str], ...] = (
    *((2, (), EVERY),) * 4,
    (2, ("drift",), "no drift"),
    (2, ("creep",), "no creep"),
    (2, ("noise",), "no noise"),
    (2, ("drift", "creep", "noise"), "none of them"),
    (3, (), "solids: all of them"),
)


def task(number: int) -> Row:
    """One guarded move."""
    kind = number % SEEDS % len(KINDS)
    dimension, missing, name = KINDS[kind]
    random = np.random.default_rng([number, 7])
    models = bundled_parts() if dimension == 2 else bundled_solids()
    spec = without_errors(RigSpec(), *missing)
    for _ in range(MOST_TRIES):
        model = models[random.integers(len(models))]
        aimed = aim(model, random, spec.bearing.radius)
        if aimed is not None:
            break
    else:
        raise AssertionError("no place was found")
    pose, start, end, incidence, feature = aimed
    probe = RigProbe(model, pose, spec=spec, seed=int(random.integers(2**32)))
    reply = probe.touch(start, end)
    row: Row = {
        "kind": name,
        "part": model.name,
        "feature": feature,
        "incidence_deg": math.degrees(incidence),
        "reply": type(reply).__name__,
        "reason": reply.reason if isinstance(reply, Fault) else None,
        "seconds": probe.clock,
        "bounds": {
            "normal_deg": math.degrees(probe.bounds.normal_error),
            "planar_deg": math.degrees(probe.bounds.planar_normal_error),
            "position": probe.bounds.position_error,
        },
    }
    return {**row, **(errors(probe, reply, model=model, pose=pose) if isinstance(reply, Hit) else {})}


def aim(
    model: Model, random: np.random.Generator, radius: float
) -> tuple[Array, Array, Array, float, str] | None:
    """A pose, and a move that touches a random place of a face first, or something before it.

    None: it begins too near, or touches too steeply, or leaves the workspace.
    """
    d = model.dimension
    area = np.array([np.zeros(d), SIZE[d]])
    try:
        pose = random_pose(model, area, room=4.0 * radius, random=random)
    except ValueError:
        return None
    number = int(random.integers(len(model.faces)))
    corners = np.asarray(model.faces[number])
    if d == 3:
        own = model.triangles[model.triangle_faces == number]
        corners = model.vertices[own[random.integers(len(own))]]
    place = random.dirichlet(np.ones(len(corners))) @ corners
    place = pose[:d, :d] @ place + pose[:d, d]
    normal = pose[:d, :d] @ model.face_normals[number]
    direction = -turned(normal, MOST_INCIDENCE * random.uniform(), random)
    if d == 3 and -direction[2] < math.cos(FROM_ABOVE[1]):
        return None
    far = place + radius * normal - 2.0 * RUN_IN * direction
    if model.distance(pose, far) <= radius:
        return None
    met = model.first_contact(pose, far, direction, radius)
    if met is None or met.depth < RUN_IN:
        return None
    incidence = math.acos(max(-1.0, min(1.0, float(-direction @ met.normal))))
    start, end = met.center - RUN_IN * direction, met.center + BEYOND * direction
    if incidence > MOST_INCIDENCE or not all(
        (area[0] <= p).all() and (p <= area[1]).all() for p in (start, end)
    ):
        return None
    return pose, start, end, incidence, met.feature[0]


def errors(probe: RigProbe, hit: Hit, *, model: Model, pose: Array) -> Row:
    """Of a reading, against the physics."""
    rows, contact = probe.recording.rows, hit.contact
    read = [row for row in rows if row.state == "reading"]
    last = [row for row in read if row.time > read[-1].time - probe.spec.control.reading]
    rest = np.mean([row.tip for row in last], axis=0)
    # Where it touched first: on from where it was a few ticks before anything was felt.
    felt = next(k for k, row in enumerate(rows) if np.isfinite(row.normal).all())
    before = rows[max(0, felt - 3)].tip
    first = model.first_contact(pose, before, np.asarray(contact.approach), probe.spec.bearing.radius)
    told: dict[str, Any] = {
        "rest": math.dist(contact.center, rest),
        "first": math.dist(contact.center, first.center) if first is not None else None,
        "corner": contact.normal is None,
        "peak": probe.overshoots[-1],
    }
    if contact.normal is not None:
        normal = np.mean([row.normal for row in last], axis=0)
        sine = float(np.hypot.reduce(contact.normal - (contact.normal @ normal) / (normal @ normal) * normal))
        told["normal_deg"] = math.degrees(math.asin(min(1.0, sine)))
    return told


def markdown(rows: list[Row]) -> str:
    """Errors and bounds of each kind."""
    names = list(dict.fromkeys(name for _, _, name in KINDS))
    ends: list[list[str]] = []
    told: list[list[str]] = []
    for name in names:
        some = [row for row in rows if row["kind"] == name]
        if not some:
            continue
        hits = [row for row in some if row["reply"] == "Hit"]
        normals = np.array([row["normal_deg"] for row in hits if "normal_deg" in row])
        places = np.array([max(row["rest"], row["first"]) for row in hits])
        beyond = sum(
            row.get("normal_deg", 0.0) > row["bounds"]["normal_deg"]
            or max(row["rest"], row["first"]) > row["bounds"]["position"]
            for row in hits
        )
        bounds = some[0]["bounds"]
        ends.append(
            [
                name,
                f"{len(some):,}",
                f"{len(hits):,}",
                str(sum(row["corner"] for row in hits)),
                str(sum(row["reply"] == "Skid" for row in some)),
                str(sum(row["reply"] == "Fault" for row in some)),
                str(sum(row["reply"] not in ("Hit", "Skid", "Fault") for row in some)),
                f"**{beyond}**",
            ]
        )
        told.append(
            [
                name,
                *_spread(normals, 3),
                f"{bounds['normal_deg']:.3f}",
                share(float((normals <= THESIS["normal_deg"]).mean())),
                *_spread(places, 3),
                f"{bounds['position']:.3f}",
                share(float((places <= THESIS["position"]).mean())),
            ]
        )
    faults = sorted({row["reason"] for row in rows if row["reason"]})
    return "\n\n".join(
        [
            "Guarded moves of a ball bearing of 5 mm at random places of the bundled parts (the thesis's "
            "are drawn anew), touched at up to 60° of incidence, solids from above. *Beyond* counts readings "
            "beyond a derived bound, in place or normal. The bounds of each rig are those that follow from "
            "what it has; without noise, the rounding of the converter averages out no more.",
            table(["errors", "moves", "read", "without normal", "skids", "faults", "other", "beyond"], ends),
            "*Without normal* are contacts in corners that stick in, which rolling the tip found out. "
            "*Other*: the tip touched something where the move was to begin. "
            + (f"Faults: {'; '.join(faults)}." if faults else "There was no fault."),
            "Errors in degrees and mm: the middle one, the largest of 99 %, the largest; then the derived "
            "bound and the share of readings within the thesis's ±0.5° and ±0.5 mm. Of the place it is the "
            "larger of two: from where the tip rested while it was read, and from where it touched first.",
            table(
                [
                    "errors",
                    "normal: median",
                    "99 %",
                    "largest",
                    "bound",
                    "±0.5°",
                    "place: median",
                    "99 %",
                    "largest",
                    "bound",
                    "±0.5 mm",
                ],
                told,
            ),
        ]
    )


def _spread(values: Array, digits: int) -> list[str]:
    found = (np.median(values), np.quantile(values, 0.99), values.max())
    return [f"{value:.{digits}f}" for value in found]


def pictures(rows: list[Row]) -> list[Picture]:
    """Shares of readings by their errors, with the bounds."""
    import matplotlib as mpl

    from palpate.plots.style import FAINT, RC, new_figure, svg_of

    hits = [row for row in rows if row["reply"] == "Hit"]
    sides = (
        ("normal error (°)", "normal_deg", "normal_deg"),
        ("place error (mm)", "place", "position"),
    )
    with mpl.rc_context(RC):
        figure = new_figure((8.6, 3.6))
        for number, (label, key, bound) in enumerate(sides):
            axes = figure.add_subplot(1, 2, number + 1)
            for k, name in enumerate(dict.fromkeys(name for _, _, name in KINDS)):
                some = [row for row in hits if row["kind"] == name]
                values = [max(r["rest"], r["first"]) if key == "place" else r.get(key) for r in some]
                kept = np.sort([value for value in values if value is not None])
                if len(kept):
                    axes.plot(kept, np.linspace(0, 1, len(kept)), lw=1.2, color=COLORS[k], label=name)
            axes.axvline(THESIS[bound], color=FAINT, lw=1.0, ls=(0, (4, 3)))
            axes.axvline(hits[0]["bounds"][bound], color="#111111", lw=1.2)
            axes.annotate("thesis", (THESIS[bound], 0.04), rotation=90, ha="right", color="#555555")
            axes.annotate("bound", (hits[0]["bounds"][bound], 0.04), rotation=90, ha="right")
            axes.set_xlabel(label)
            axes.set_xlim(left=0.0)
            axes.set_ylabel("share of readings" if number == 0 else "")
            axes.spines[["top", "right"]].set_visible(False)
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3)
        svg = svg_of(figure)
    caption = f"Errors of the rig's readings. The bound is that of a rig with {EVERY}, in the plane."
    return [Picture("rig-sensor", svg, caption)]


EXPERIMENT = Experiment(
    title="The rig: errors of its force sensor",
    task=task,
    table=markdown,
    groups=len(KINDS),
    repeats=REPEATS,
    pictures=pictures,
    of_thesis=False,
)
