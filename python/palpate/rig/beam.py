"""The beam of the force sensor, by elementary mechanics (thesis A.1, MATH row 96).

A square cantilever. Lengths in mm, forces in N, stresses in MPa; the thesis's own 110 mm and 2.5 mm are what
this gives, rounded.
"""

from __future__ import annotations

from dataclasses import dataclass

ALUMINIUM = 71_000.0
"""Modulus of elasticity, MPa, as the thesis has it."""
DENSITY = 2.7e-6
"""Of aluminium, kg/mm³."""
TIP_SHARE = 33.0 / 140.0
"""Of a cantilever's mass, that moves as if it were at the tip (Rayleigh)."""


@dataclass(frozen=True)
class Beam:
    """A cantilever of square cross-section, loaded at the tip."""

    side: float = 5.0
    """Of the square, mm: gauges about 4 mm wide fit on it."""
    length: float = 107.0
    """From the base to the tip, mm."""
    gauge_at: float = 6.0
    """Middle of the gauges from the base, mm."""
    modulus: float = ALUMINIUM
    """MPa."""
    most_force: float = 22.0
    """At the tip, N: it was designed to yield there."""
    damping: float = 0.05
    """Of its swinging, as a share of the critical damping."""

    @property
    def inertia(self) -> float:
        """Second moment of area, h⁴/12, mm⁴."""
        return self.side**4 / 12.0

    @property
    def stiffness(self) -> float:
        """Of the tip, 3EI/L³, N/mm."""
        return 3.0 * self.modulus * self.inertia / self.length**3

    @property
    def strain_per_force(self) -> float:
        """Of the outer fibre at the gauges, (L − X)·(h/2)/(EI), 1/N."""
        return (self.length - self.gauge_at) * (self.side / 2.0) / (self.modulus * self.inertia)

    @property
    def tip_mass(self) -> float:
        """What of its mass moves with the tip, kg."""
        return TIP_SHARE * DENSITY * self.side**2 * self.length

    def deflection(self, force: float) -> float:
        """Of the tip, FL³/(3EI), mm."""
        return force / self.stiffness

    def slope(self, force: float) -> float:
        """Of the tip, FL²/(2EI), radians."""
        return force * self.length**2 / (2.0 * self.modulus * self.inertia)

    def length_for(self, force: float, strain: float) -> float:
        """The length at which a tip force makes this strain at the gauges, mm; the thesis's choice of L."""
        return self.gauge_at + strain * self.modulus * self.inertia / (force * self.side / 2.0)
