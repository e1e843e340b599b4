"""See it: a session as a page that needs no network, or in the viewer.

`python examples/05_see_it.py FOLDER` writes `session.html` there; with `--serve` it opens the viewer instead
and prints its address. Needs `palpate[view]`.
"""

import math
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import palpate
from palpate.view import Session, save_page, serve

models = palpate.load_models(["robot-hand", "human-hand", "telephone", "boot", "camera", "beer-bottle"])
sensor = palpate.Sensor(position_error=0.5, normal_error=math.radians(4), max_incidence=math.radians(60))
session = Session(models, sensor, contacts=palpate.standard_contacts("human-hand"), seed=2)
session.recognize()
while len(session.state.hypotheses) > 1:
    session.plan()
    session.grow_tree()
    session.touch()  # simulated, at a pose that is drawn from those left
for number, state in enumerate(session.states):
    print(number, state.said)
assert len(session.state.hypotheses) == 1

arguments = [argument for argument in sys.argv[1:] if argument != "--serve"]
if "--serve" in sys.argv:
    serve(session)
elif arguments:
    save_page(session, Path(arguments[0]) / "session.html")
else:
    with TemporaryDirectory() as folder:
        save_page(session, Path(folder) / "session.html")
        assert (Path(folder) / "session.html").stat().st_size > 500_000
