"""The fixed joint between the palm of a gripper and the object that it holds."""
from __future__ import annotations

from ..context import Context, PluginError


class PalmJoint:
    """Holds at most one object.

    The world stores whether the joint exists: it ends with the object, with a reset, and may be
    there again after a saved state was restored.

    Args:
        context: that of the plugin.
        palm: the name of the palm link.
        name: the name of the joint, unique for the link's model.
        holder: the gripper in messages.
    """

    def __init__(self, context: Context, palm: str, name: str, holder: str) -> None:
        self._context, self._palm, self._holder = context, palm, holder
        self._joint = f"{context.scoped(palm).rpartition('::')[0]}::{name}"

    @property
    def held(self) -> str:
        """The scoped name of the held link; "" for none."""
        return self._context.attached_link(self._joint)

    def attach(self, link: str) -> bool:
        """Fix a link to the palm as it is now; return whether it is held."""
        context = self._context
        try:
            context.attach(self._joint, context.scoped(self._palm), link)
        except PluginError as fault:   # the object was deleted in this moment
            context.warn(f"{self._holder} cannot hold {link}: {fault}")
            return False
        context.info(f"{self._holder} holds {link}")
        return True

    def detach(self) -> None:
        """Release the object."""
        held = self.held
        self._context.detach(self._joint)
        self._context.info(f"{self._holder} lets go of {held}")
