"""The streaming front: keyframes in, events out."""

from __future__ import annotations

from panoplan.config import Config
from panoplan.errors import InputError
from panoplan.estimator.assemble import assemble
from panoplan.estimator.state import State, Walk
from panoplan.estimator.step import finish, step
from panoplan.types.events import Event
from panoplan.types.keyframe import Keyframe
from panoplan.types.plan import FloorPlan


class FloorPlanEstimator:
    """Estimates a floor plan while a camera walks.

    Args:
        config: settings; the default preset where omitted.
        walk: what is known of the walk in advance.
        state: where to go on, from an earlier estimator with the same settings.
    """

    def __init__(
        self,
        config: Config | None = None,
        walk: Walk | None = None,
        *,
        state: State | None = None,
    ) -> None:
        self.config = config or Config()
        self.state = state or State(walk or Walk())
        self._ids = {camera.keyframe for camera in self.state.cameras}

    def update(self, keyframe: Keyframe) -> tuple[Event, ...]:
        """Takes in the next keyframe.

        Returns:
            What happened, in order.

        Raises:
            InputError: a keyframe with this id was given before, or the walk knows the rooms of
                fewer keyframes.
            ConfigError: the warm-up is a fraction of a walk whose length is not known.
        """
        if keyframe.id in self._ids:
            raise InputError(f"keyframe {keyframe.id}", "an id given before", "a new id")
        rooms = self.state.walk.rooms
        if rooms is not None and len(self.state.cameras) >= len(rooms):
            raise InputError("rooms of the walk", f"{len(rooms)}", "one for each keyframe")
        self.state, events = step(self.state, keyframe, self.config)
        self._ids.add(keyframe.id)
        return events

    def finish(self) -> tuple[Event, ...]:
        """Shapes every room not shaped yet; the walk may go on afterwards."""
        self.state, events = finish(self.state, self.config)
        return events

    def plan(self) -> FloorPlan:
        """The plan as it stands."""
        return assemble(self.state, self.config)
