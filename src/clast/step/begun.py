"""What a step begins with."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from clast.block.inertia import BlockFrames
from clast.contact.contacts import Contacts
from clast.contact.detection import detect
from clast.model.model import Floats, Model
from clast.model.state import State
from clast.step.method import Method
from clast.step.reach import reach_within_step
from clast.step.workspace import Workspace


@dataclass(frozen=True)
class Begun:
    """A step that has begun: all that it starts from."""

    model: Model
    method: Method
    state: State
    frames: BlockFrames
    velocity: Floats
    """Velocity that enters the equations, shape (n, 6)."""
    step: float
    """h, s."""
    workspace: Workspace

    @cached_property
    def drift(self) -> Floats:
        """Displacement that the velocities would bring, shape (n, 6)."""
        return self.step * self.velocity

    def contacts(self, travel: Floats) -> Contacts:
        """Return the contacts that blocks may close which move by ``travel`` (n,) at most, m."""
        return detect(
            self.model,
            self.method.corner_rule,
            self.method.displacement,
            self.state,
            self.frames.centroid,
            reach_within_step(self.method, travel),
            self.drift,
            self.workspace.near,
        )
