"""The closed loop: acquire, recognize, plan, touch, recognize anew (thesis 4.1)."""

from palpate.loop.drawn import random_contacts
from palpate.loop.identify import identify
from palpate.loop.replay import replay
from palpate.loop.result import Found, Result, Step
from palpate.loop.route import perimeter_route

__all__ = ["Found", "Result", "Step", "identify", "perimeter_route", "random_contacts", "replay"]
