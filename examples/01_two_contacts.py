"""Two contacts, every part and pose that explains them, and the next touch.

A boot or a camera was touched twice. Each touch gave a point within 0.5 and an outward normal within 4°. What
is left is a few sets of poses; the planned path says beforehand what each answer will leave.
"""

import math

import palpate

models = palpate.load_models(["boot", "camera"])
bounds = {"position_error": 0.5, "normal_error": math.radians(4)}
contacts = [
    palpate.Contact((73.3, 3.4), (-0.06, -1.0), **bounds),
    palpate.Contact((74.4, 73.6), (0.99, 0.10), **bounds),
]
found = palpate.recognize(models, contacts)
for number, hypothesis in enumerate(found.hypotheses):
    turn = math.degrees(hypothesis.poses.rotation_bound)
    shift = max(hypothesis.poses.excursion(corner) for corner in hypothesis.model.vertices)
    print(
        f"{number}: {hypothesis.model.name}, turns by up to {turn:.1f}°, corners shift by up to {shift:.1f}"
    )

sensor = palpate.Sensor(**bounds, max_incidence=math.radians(60))
path = palpate.plan(found.hypotheses, sensor)
assert path is not None and path.guaranteed
print("from", path.start.round(1), "along", path.direction.round(3), "up to", round(path.length, 1))
for outcome in path.outcomes:
    for touch in outcome.touches:
        least, most = touch.depth
        print(f"if it is {outcome.hypothesis}: {touch.feature} after {least:.1f} to {most:.1f}")
    if outcome.may_miss:
        print(f"if it is {outcome.hypothesis}: maybe nothing")

tree = palpate.plan_tree(found.hypotheses, sensor)
print(tree.to_text())
assert tree.solved and tree.worst_touches == 1
