"""`gazebo`: server and client in one; the server stays in the foreground."""
from __future__ import annotations

import sys
from typing import List, Optional

from . import gzclient, gzserver


def main(argv: Optional[List[str]] = None) -> int:
    """Run the server with the client's line before it.

    Returns:
        As `gzserver`.
    """
    words = sys.argv if argv is None else argv
    gzclient.main()
    return gzserver.main(words, program="gazebo")


if __name__ == "__main__":
    sys.exit(main())
