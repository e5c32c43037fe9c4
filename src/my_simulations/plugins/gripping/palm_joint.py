"""The fixed joint between the palm of a gripper and the object that it holds."""
from __future__ import annotations

from ..context import Context, PluginError


class PalmJoint:
    """Holds at most one object.

    Attributes:
        held: scoped name of the held link; "" for none.

    Args:
        context: that of the plugin.
        palm: the name of the palm link.
        name: the name of the joint, unique for the link's model.
        holder: the gripper in messages.
    """

    def __init__(self, context: Context, palm: str, name: str, holder: str) -> None:
        self._context, self._palm, self._name, self._holder = context, palm, name, holder
        self._joint = ""
        self.held = ""

    def attach(self, link: str) -> bool:
        """Fix a link to the palm as it is now; return whether it is held."""
        context, palm = self._context, self._context.scoped(self._palm)
        joint = f"{palm.rpartition('::')[0]}::{self._name}"
        try:
            context.attach(joint, palm, link)
        except PluginError as fault:   # the object was deleted in this moment
            context.warn(f"{self._holder} cannot hold {link}: {fault}")
            return False
        self._joint, self.held = joint, link
        context.info(f"{self._holder} holds {link}")
        return True

    def detach(self) -> None:
        """Release the object."""
        self._context.detach(self._joint)
        self._context.info(f"{self._holder} lets go of {self.held}")
        self.held = ""

    def forget(self) -> None:
        """Hold nothing after the world removed the joint."""
        self.held = ""

    @property
    def is_lost(self) -> bool:
        """Whether the joint of the held object was removed, for example with the object."""
        return bool(self.held) and not self._context.is_attached(self._joint)
