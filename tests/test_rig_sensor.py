"""Each source of the rig's errors against its own bound, over hundreds of sensors that are drawn."""

from dataclasses import replace

import numpy as np
import pytest

from palpate.rig import SIZE, RigSpec, bounds_of, without_errors
from palpate.rig import rig_sensor as sensor_of
from palpate.rig.beam import Beam
from palpate.rig.calibration import calibrated
from palpate.rig.gauges import Gauges, count_force
from palpate.rig.specification import BURSTS


def bounds(spec=None, dimension=2):
    return bounds_of(spec or RigSpec(), dimension=dimension, size=SIZE[dimension])


def test_the_beam_is_that_of_elementary_mechanics():
    """Against the bending line, integrated twice from the moment."""
    beam = Beam()
    at = np.linspace(0.0, beam.length, 200_001)
    curvature = 9.0 * (beam.length - at) / (beam.modulus * beam.inertia)
    step = at[1] - at[0]
    slope = np.concatenate([[0.0], np.cumsum((curvature[1:] + curvature[:-1]) / 2.0) * step])
    bent = np.concatenate([[0.0], np.cumsum((slope[1:] + slope[:-1]) / 2.0) * step])
    assert beam.deflection(9.0) == pytest.approx(bent[-1], rel=1e-6)
    assert beam.slope(9.0) == pytest.approx(slope[-1], rel=1e-6)
    assert beam.strain_per_force * 9.0 == pytest.approx(
        float(np.interp(beam.gauge_at, at, curvature)) * beam.side / 2.0, rel=1e-6
    )


def test_drift_and_creep_are_no_faster_than_the_specification_says():
    electronics = RigSpec().electronics
    for seed in range(20):
        gauges = Gauges(Beam(), electronics, dimension=3, random=np.random.default_rng(seed))
        times = np.arange(0.0, 1200.0, 0.5)
        drifted = np.array([gauges.drifted(time) for time in times])
        assert np.abs(np.diff(drifted, axis=0)).max() <= electronics.drift * 0.5 * (1.0 + 1e-9)
        # Of a force that stays what crept in the end is the share that is said.
        still = replace(electronics, noise=0.0, drift=0.0, bits=24)
        gauges = Gauges(Beam(), still, dimension=2, random=np.random.default_rng(seed))
        load = np.repeat([[9.0, 0.0]], BURSTS, axis=0)
        first, *_, last = [gauges.read(load, 0.1) for _ in range(1500)]
        lost = np.linalg.solve(gauges.sensitivity, first - last)
        assert 0.98 * electronics.creep < lost[0] / 9.0 <= electronics.creep


@pytest.mark.parametrize("dimension", [2, 3])
def test_calibrated_gains_are_within_their_bound(dimension):
    spec, most, worst = RigSpec(), bounds(dimension=dimension).gain, 0.0
    for seed in range(150):
        random = [np.random.default_rng([seed, k]) for k in range(2)]
        gauges = Gauges(spec.beam, spec.electronics, dimension=dimension, random=random[0])
        inverse, _ = calibrated(gauges, spec, random=random[1])
        worst = max(worst, float(np.linalg.norm(inverse @ gauges.sensitivity - np.eye(dimension), 2)))
    assert 0.05 * most < worst <= most


def test_averages_of_noise_and_rounding_are_within_their_bound():
    """A reading of a constant force, against the force that its channels feel."""
    spec = without_errors(RigSpec(), "drift", "creep")
    most, ticks = bounds(spec).forces["noise and rounding of the reading"], round(0.25 * 60)
    worst = 0.0
    for seed in range(300):
        random = np.random.default_rng(seed)
        gauges = Gauges(spec.beam, spec.electronics, dimension=2, random=random)
        load = random.uniform(-12.0, 12.0, 2)
        felt = [gauges.read(np.repeat(load[None], BURSTS, axis=0), 1 / 60) for _ in range(ticks)]
        expected = gauges.sensitivity @ load + gauges._offset
        off = np.linalg.solve(gauges.sensitivity, np.mean(felt, axis=0) - expected)
        worst = max(worst, float(np.hypot(*off)))
    assert 0.05 * most < worst <= most


@pytest.mark.parametrize("missing", [(), ("drift",), ("creep",), ("drift", "creep")])
def test_a_better_sensor_has_smaller_bounds(missing):
    every, fewer = bounds(), bounds(without_errors(RigSpec(), *missing))
    assert fewer.normal_error <= every.normal_error and fewer.position_error <= every.position_error
    assert (fewer.normal_error < every.normal_error) == bool(missing)


def test_the_derived_sensor_is_in_the_unit_that_is_asked_for():
    mm, inch = sensor_of(), sensor_of(unit="in")
    assert mm.position_error == pytest.approx(25.4 * inch.position_error)
    assert mm.tip_radius == pytest.approx(25.4 * inch.tip_radius) and mm.normal_error == inch.normal_error
    assert count_force(RigSpec().electronics) == pytest.approx(32.0 / 2048)
