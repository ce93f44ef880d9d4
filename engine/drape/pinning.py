"""Pins of cloth that is sewn: they take hold once seams are closed and the avatar has its true shape."""

from dataclasses import replace

from toile.engine.drape.merging import restart_near
from toile.engine.drape.state import DrapeState, node_mask


def take_hold(drape: DrapeState) -> None:
    """Pin the material vertices that wait for it where they are now."""
    if drape.pin_when_sewn is None or drape.pins_hold or drape.over():
        return
    stepper, cloth = drape.stepper, drape.cloth
    held = node_mask(len(stepper.x), cloth.node[drape.pin_when_sewn])
    radius = None if stepper.collisions is None else stepper.collisions.least_body_radius
    restart_near(drape, replace(cloth, positions=stepper.x.copy(), pinned=cloth.pinned | held), radius)
    drape.pins_hold = True
