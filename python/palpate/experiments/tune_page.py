"""What `palpate tune` recommends for the bundled sets, for the docs.

python -m palpate.experiments.tune_page docs/closed-loop.md
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from palpate import load_models, part_names
from palpate.cli.tune import HEADINGS, advice_lines, cells
from palpate.experiments import campaign
from palpate.experiments.pages import rewrite, table
from palpate.experiments.thesis_sensor import sensor_of
from palpate.experiments.tune import Costs, document, tune
from palpate.usual import NORMAL_ERROR_DEG, POSITION_ERROR

SETS: dict[str, tuple[list[str], float, float]] = {
    "The six objects (4.2)": (list(part_names())[:6], POSITION_ERROR, NORMAL_ERROR_DEG),
    "The parts of the drill (4.3)": (list(part_names())[6:], 4.0, 5.0),
}
COSTS = Costs(speed=100.0, per_touch=1.0)


def section(problems: int, out: Path, cluster: str | None) -> str:
    """A table and the recommendation for each set."""
    return "\n\n".join(_of(title, problems, out=out, cluster=cluster) for title in SETS)


def _of(title: str, problems: int, *, out: Path, cluster: str | None) -> str:
    names, position_error, normal_error_deg = SETS[title]
    models = load_models(names)
    sensor = sensor_of(position_error=position_error, normal_error_deg=normal_error_deg)
    advice = tune(models, sensor, COSTS, problems=problems, out=out, cluster=cluster)
    made: dict[str, Any] = document(advice, models, sensor, unit="mm", seed=0)
    flags = (
        f"--position-error {position_error:g} --normal-error-deg {normal_error_deg:g} --problems {problems}"
    )
    command = f"    palpate tune {' '.join(names)} {flags}"
    rows = table(HEADINGS, [cells(one) for one in made["tried"]])
    said = "\n".join(f"> {line}  " for line in advice_lines(made, unit="mm"))
    return f"**{title}.**\n\n{command}\n\n{rows}\n\n{said}"


def main() -> None:
    """Write the part anew."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("page", type=Path)
    parser.add_argument("--problems", type=int, default=30)
    parser.add_argument("--cluster", help=campaign.CLUSTER_HELP)
    parser.add_argument("--out", type=Path, default=Path("out/tune"), help="folder of the rows")
    options = parser.parse_args()
    rewrite(options.page, "tune", section(options.problems, options.out, options.cluster))


if __name__ == "__main__":
    main()
