"""`gzclient`: the place of the graphical editor."""
from __future__ import annotations

import sys
from typing import List, Optional

LINE = ("gzclient: there is no graphical editor yet; the world runs without it, see "
        "`rosservice list /gazebo` and `rostopic list /gazebo` for what it offers")


def main(argv: Optional[List[str]] = None) -> int:
    """Say where the world can be reached; any arguments are accepted.

    Returns:
        0, so that launch files with `gui:=true` run on.
    """
    del argv
    print(LINE, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
