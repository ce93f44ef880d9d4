"""Whether a body jumps in its motion, told before its garments are draped."""

from toile.dressing.body.avatar import Avatar
from toile.engine.film.plan import FilmPlan


def jump_of(avatar: Avatar) -> str | None:
    """Return one sentence about the first jump that no cloth can follow, or None."""
    motion = avatar.motion
    if motion is None:
        return None
    span = 1.0 / motion.fps
    for frame in range(len(motion.frames) - 1):
        speed, vertex = motion.speed(frame * span, span)
        if speed > FilmPlan.speed_max:
            rest = "leave out frame 0 if it is a rest pose, or " if frame == 0 and not motion.lead else ""
            return (
                f"the body jumps after {motion.name(frame)}: its vertex {vertex} moves {speed * span:.2f} m "
                f"in {span:.3g} s; the film will end there: {rest}give more frames in between"
            )
    return None
