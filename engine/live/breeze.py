"""Wind that somebody turns up, down and off while cloth is in it."""

from toile.engine.forces.air_flow import AirFlow
from toile.engine.forces.force import StepState
from toile.engine.forces.wind import Wind
from toile.geometry.arrays import Float, Int

CALM = AirFlow(velocity=(0.0, 0.0, 0.0), resistance=0.0)


class Breeze(Wind):
    """Wind as `blow` says; a vacuum at first."""

    def __init__(self, faces: Int, node_count: int) -> None:
        super().__init__(faces, node_count, CALM)

    def blow(self, air: AirFlow | None) -> None:
        """Let this air flow from here on; None is a vacuum."""
        self.flow = air or CALM

    def begin(self, step: StepState, x: Float) -> bool:
        """Take what `Wind` takes, where there is air at all."""
        return self.flow is not CALM and super().begin(step, x)
