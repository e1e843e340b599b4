"""How long recognition in space takes: one part, libraries, and how both grow.

    python -m palpate.experiments.solid_speed --parts target/parts --page docs/speed.md

Contacts are ±0.5 and ±4°, all around parts that are 200 across. Models and their pair tables, which are made
once and kept, are timed apart. Times are of the clock, on all cores; each is the least of three.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from . import pages
from .public_parts import load_parts
from .random_solids import prism, random_solid
from .solid_problems import Bounds, draw_contacts, random_pose
from .solids import Array, Solid

BOUNDS = Bounds(position_error=0.5, normal_error=math.radians(4.0))
NUM_CONTACTS = 6
NUM_PROBLEMS = 60
MOST_FACES = 300
LIBRARIES = (10, 32, 100, 316, 1000)
PER_LIBRARY = 7
#: Prisms of so many sides: one part whose faces grow.
SIDES = (16, 32, 64, 128, 256, 512)
PER_PRISM = 9
REPEATS = 3


def least_seconds(models: Sequence[Any], contacts: Sequence[Any]) -> float:
    """Of recognition, the least of a few runs: what disturbs a run only makes it longer."""
    import palpate

    times = []
    for _ in range(REPEATS):
        started = time.perf_counter()
        palpate.recognize(models, contacts)
        times.append(time.perf_counter() - started)
    return min(times)


def touched(random: np.random.Generator, solid: Solid) -> list[Any]:
    """Contacts with a part somewhere, for the core."""
    import palpate

    truth = random_pose(random, 300.0)
    drawn = draw_contacts(random, solid, truth, bounds=BOUNDS, count=NUM_CONTACTS, manners=("around",))
    return [
        palpate.Contact(
            one.center, one.normal, position_error=one.position_error, normal_error=one.normal_error
        )
        for one in drawn
    ]


def model_of(solid: Solid, name: str) -> Any:
    """The core's model, its pair tables made."""
    import palpate

    model = palpate.Model.mesh(solid.vertices, solid.triangles, name=name)
    palpate.recognize([model], touched(np.random.default_rng(0), solid), time_limit=5.0)
    return model


def regular(sides: int) -> Solid:
    """A prism over a regular polygon, 200 across."""
    angles = 2.0 * math.pi * np.arange(sides) / sides
    outline: Array = 90.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return prism(f"prism of {sides} sides", outline, 80.0)


def one_part(solids: Sequence[Solid]) -> str:
    """Recognition and enclosures of one part after another."""
    import palpate

    random = np.random.default_rng(1)
    times: dict[str, list[float]] = {"making": [], "recognize": [], "enclosures": []}
    hypotheses, incomplete = [], 0
    few = [solid for solid in solids if 20 <= solid.num_faces <= MOST_FACES]
    for number in range(NUM_PROBLEMS):
        solid = few[int(random.integers(len(few)))]
        started = time.perf_counter()
        model = model_of(solid, f"{number}")
        times["making"].append(time.perf_counter() - started)
        contacts = touched(random, solid)
        times["recognize"].append(least_seconds([model], contacts))
        found = palpate.recognize([model], contacts)
        hypotheses.append(len(found.hypotheses))
        incomplete += not found.complete
        started = time.perf_counter()
        for one in found.hypotheses:
            one.poses.excursion(solid.vertices[0])
            _ = one.poses.rotation_bound
        times["enclosures"].append((time.perf_counter() - started) / max(1, len(found.hypotheses)))
    titles = {
        "making": "model and pair tables, once",
        "recognize": "hypotheses with witnesses",
        "enclosures": "bounds of a hypothesis, when first asked for",
    }
    rows = [
        [titles[name], *(pages.duration(float(q)) for q in np.quantile(values, [0.5, 0.9, 1.0]))]
        for name, values in times.items()
    ]
    faces = int(np.median([solid.num_faces for solid in few]))
    return (
        f"{NUM_PROBLEMS} problems on {len(few)} public parts of 20 to {MOST_FACES} faces, median {faces}; "
        f"{NUM_CONTACTS} contacts; {np.median(hypotheses):g} hypotheses in the median; "
        f"incomplete: {incomplete}.\n\n" + pages.table(["one part", "median", "90 %", "largest"], rows)
    )


def growth(sizes: Sequence[int], medians: Sequence[float]) -> float:
    """The exponent of a power of the size, by least squares of logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(medians), 1)[0])


def libraries(solids: Sequence[Solid]) -> str:
    """Libraries of more and more parts, of which one is true."""
    random = np.random.default_rng(2)
    made = [random_solid(random) for _ in range(max(0, max(LIBRARIES) - len(solids)))]
    everything = [*solids, *made]
    order = random.permutation(len(everything))[: max(LIBRARIES)]
    kept = [everything[one] for one in order]
    models = [model_of(solid, f"{number}") for number, solid in enumerate(kept)]
    rows, medians = [], []
    for count in LIBRARIES:
        times = []
        for _ in range(PER_LIBRARY):
            true = int(random.integers(count))
            contacts = touched(random, kept[true])
            times.append(least_seconds(models[:count], contacts))
        medians.append(float(np.median(times)))
        faces = sum(solid.num_faces for solid in kept[:count])
        rows.append([f"{count:,}", f"{faces:,}", pages.duration(medians[-1]), pages.duration(max(times))])
    table = pages.table(["parts", "faces", "median", "largest"], rows)
    return f"{table}\n\nTime grows as parts to the power of {growth(LIBRARIES, medians):.2f}."


def faces() -> str:
    """One part with more and more faces."""
    random = np.random.default_rng(3)
    rows, medians = [], []
    for sides in SIDES:
        solid = regular(sides)
        model = model_of(solid, f"{sides}")
        problems = [touched(random, solid) for _ in range(PER_PRISM)]
        times = [least_seconds([model], one) for one in problems]
        medians.append(float(np.median(times)))
        rows.append([f"{sides}", pages.duration(medians[-1]), pages.duration(max(times))])
    table = pages.table(["sides of a prism", "median", "largest"], rows)
    return f"{table}\n\nTime grows as sides to the power of {growth(SIDES, medians):.2f}."


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="solid_speed", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--parts", type=Path, required=True, help="folder of public_parts")
    parser.add_argument("--page", type=Path, required=True, help="page that is written anew")
    options = parser.parse_args()
    solids = load_parts(options.parts)
    if not solids:
        parser.error(f"--parts: {str(options.parts)!r} has no parts; fetch them with public_parts")
    text = "\n\n".join([one_part(solids), libraries(solids), faces()])
    pages.rewrite(options.page, "solids", f"{text}\n\nMeasured on {pages.machine()}.")


if __name__ == "__main__":
    main()
