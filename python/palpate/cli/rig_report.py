"""Pictures of a run through the rig."""

from __future__ import annotations

from collections.abc import Iterator

from palpate import Model, Result
from palpate.cli.console import patiently
from palpate.cli.rig_options import RigFlags
from palpate.contacts.entry import mm_per
from palpate.loop.route import Array
from palpate.rig import RigProbe


def draw_rig(
    result: Result, probe: RigProbe, flags: RigFlags, *, truth: Model, pose: Array, unit: str
) -> Iterator[str]:
    """Draw the recording and write the film, as asked; a line for each."""
    if not len(probe.recording):
        if flags.record is not None or flags.film is not None:
            yield "the rig was not moved: there is nothing to record or film"
        return
    if flags.record is not None:
        from palpate.plots import plot_recording, save_figure

        record = flags.record
        patiently(lambda: save_figure(plot_recording(probe.recording), record), saying="drawing")
        yield f"recording: {record}"
    if flags.film is not None:
        from palpate.rig.film import save_film

        save_film(
            flags.film,
            probe.recording,
            result,
            model=truth,
            world_from_model=pose,
            tip_radius=probe.spec.bearing.radius,
            unit_mm=mm_per(unit, "unit"),
        )
        yield f"film: {flags.film}"
