"""A step as forces see it, for tests: every position is where the step may end, and has its velocity."""

from dataclasses import dataclass

import numpy as np

from toile.engine.forces.step_request import StepRequest
from toile.geometry.arrays import Float


@dataclass(frozen=True)
class MovingStep:
    """A step from `origin` [m], shape (n, 3): one that ends at x has the velocity (x - origin) / h there."""

    request: StepRequest
    origin: Float

    @property
    def start(self) -> Float:
        return self.origin

    @property
    def h(self) -> Float:
        return np.full(len(self.origin), self.request.h)

    def velocity_at(self, x: Float) -> Float:
        return (x - self.origin) / self.request.h
