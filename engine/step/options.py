"""Options and outcome of the implicit step."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.air_flow import AirFlow
from toile.engine.forces.contact import ContactLaw
from toile.engine.forces.contact_pairs import SkinPart
from toile.engine.forces.force import Force
from toile.geometry.arrays import Float

LAW_BODY, LAW_SELF = ContactLaw(stiffness=2e6, edge_share=0.5), ContactLaw(stiffness=2e6, edge_share=1.0)
"""Usual contact laws: cloth of 120 g/m^2 that lies on a body sinks 0.6 micrometres into the radius."""


@dataclass(frozen=True, kw_only=True)
class StepOptions:
    """Numbers of the implicit step that do not change during a run; by default those of films.

    Attributes
    ----------
    gravity
        Downward acceleration [m/s^2].
    radius_body, radius_self
        Contact radius against the avatar and within the cloth [m], at least: thicker fabrics have more.
    law_body, law_self
        Contact laws against the avatar and within the cloth.
    friction
        Coulomb coefficients of named pairs, where they are not those of the fabrics: see `pair_friction`.
    growth_radius
        Contact radius against the avatar while it grows [m]: the farther the cloth keeps ahead of the
        growing body, the faster the body may grow.
    slip
        Elastic slip of friction [m]: how far a sticking contact gives before it slides.
    self_contact
        Whether the cloth can touch itself.
    air
        Wind, or still air that brakes the cloth; None is a vacuum.
    parts
        Parts of the avatar that are no body, with friction of their own.
    more_forces
        Makers of forces beside those of the cloth, called for every topology that the cloth takes on.
    """

    gravity: float = 9.81
    radius_body: float = 0.002
    radius_self: float = 0.001
    law_body: ContactLaw = LAW_BODY
    law_self: ContactLaw = LAW_SELF
    growth_radius: float = 0.002
    slip: float = 1e-3
    self_contact: bool = True
    air: AirFlow | None = None
    friction: Mapping[frozenset[str], float] = field(default_factory=dict)
    parts: tuple[SkinPart, ...] = ()
    more_forces: tuple[Callable[[Cloth], Force], ...] = ()


@dataclass
class StepOutcome:
    """Outcome of one step: motion [m] of the nodes, iterations, how much the guard held back.

    `converged` says whether the linear solver reached its tolerance in every iteration and the last iteration
    moved no node farther than the Newton tolerance, where more than one was allowed. `error` estimates what
    the step adds to the error of the positions, root mean square over the nodes [m]; None: not known.
    """

    moved: Float
    converged: bool = True
    newton_iterations: int = 0
    cg_iterations: int = 0
    contacts: int = 0
    limited: int = 0
    min_gap: float = np.inf
    error: float | None = None
