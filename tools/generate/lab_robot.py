#!/usr/bin/env python3
"""Writes urdf/robo.urdf from urdf/robo.urdf.xacro, without its comments."""
from __future__ import annotations

import pathlib
import re
import subprocess

URDF = pathlib.Path(__file__).resolve().parents[2] / "urdf"
HEAD = ('<?xml version="1.0" ?>\n<!-- The lab robot as plain URDF. Made from robo.urdf.xacro by'
        " tools/generate/lab_robot.py; change it there. -->\n")


def main() -> None:
    """Needs the command xacro: source the workspace first."""
    made = subprocess.run(["xacro", str(URDF / "robo.urdf.xacro")], check=True,
                          stdout=subprocess.PIPE, text=True).stdout
    text = re.sub(r"\n\s*<!--.*?-->", "", made[made.index("<robot"):], flags=re.DOTALL)
    (URDF / "robo.urdf").write_text(HEAD + text, encoding="utf-8")


if __name__ == "__main__":
    main()
