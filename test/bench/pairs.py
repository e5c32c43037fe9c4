"""Measures scenes alternately with this engine and bare PyBullet, each in a separate process."""
from __future__ import annotations

import statistics
import subprocess
import sys
from typing import Dict, List, Optional, Sequence, Tuple

KINDS = ("ours", "bare")


def measured(script: str, kind: str, scene: str) -> Tuple[float, str]:
    """Processor time of a step, us, and what else `script --child KIND SCENE` prints after it."""
    done = subprocess.run([sys.executable, script, "--child", kind, scene], check=True,
                          stdout=subprocess.PIPE, text=True, timeout=1800)
    took, _, rest = done.stdout.strip().splitlines()[-1].partition(" ")
    return float(took), rest


def rows(script: str, scenes: Sequence[str], arguments: List[str], last: str = "",
         medians: Optional[Dict[str, Tuple[float, float]]] = None) -> int:
    """Print two rows a scene, with the median of the pairs' ratios.

    `arguments`: those of the command line: how many pairs, and words in the names of scenes; `last`
    is the head of the column for what a run tells besides its time; `medians` receives the time of
    a step of ours, us, and the median of the ratios, by scene.
    """
    pairs, words = int(arguments[0]) if arguments else 5, arguments[1:]
    print(f"{'scene':<24} {'':<5} {'us a step':>10} {'spread':>17} {'of bare':>8}  {last}".rstrip())
    for scene in scenes:
        if words and not any(word in scene for word in words):
            continue
        runs = [[measured(script, kind, scene) for kind in KINDS] for _ in range(pairs)]
        ratio = statistics.median(ours[0] / bare[0] for ours, bare in runs)
        if medians is not None:
            medians[scene] = statistics.median(ours[0] for ours, _ in runs), ratio
        for n, kind in enumerate(KINDS):
            times = [run[n][0] for run in runs]
            told = "; ".join(sorted({run[n][1] for run in runs}))
            shown = f"{ratio:>8.2f}" if kind == "ours" else " " * 8
            print(f"{scene:<24} {kind:<5} {statistics.median(times):>10.1f} {min(times):>8.1f}"
                  f"{max(times):>9.1f} {shown}  {told}".rstrip(), flush=True)
    return 0
