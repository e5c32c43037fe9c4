"""Thousands of requests at once: sim time goes on, others are answered, memory stays."""
from __future__ import annotations

import asyncio
import itertools
import threading
import time
from typing import Dict, Iterator, List

import aiohttp
import pytest
from editor_case import Case, box, cases
from heap import memory

from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.simulator.simulator import Simulator

PAGES, REQUESTS = 4, 5000
MOST_MB = 60.0
"""Growth by the queues of answers of four pages, and by this program's copies."""

KINDS = ({"type": "folders"}, {"type": "copy", "names": ["a"]}, {"type": "library"},
         {"type": "autosave", "action": "list"}, {"type": "undo"}, {"type": "none"},
         {"type": "edit", "op": {"kind": "?"}})

case = pytest.fixture(cases)


class Stall(threading.Thread):
    """Notes the longest time for which sim time stood still, in seconds."""

    def __init__(self, simulator: Simulator) -> None:
        super().__init__(daemon=True)
        self._clock = simulator.clock
        self._stopping = threading.Event()
        self.longest = 0.0

    def run(self) -> None:
        """Look until `stop`."""
        seen, since = self._clock.sim_ns, time.monotonic()
        while not self._stopping.wait(0.005):
            now = self._clock.sim_ns
            self.longest = max(self.longest, time.monotonic() - since)
            if now != seen:
                seen, since = now, time.monotonic()

    def stop(self) -> float:
        """End; the longest time."""
        self._stopping.set()
        self.join()
        return self.longest


async def flood(session: aiohttp.ClientSession, url: str, kinds: List[Dict[str, object]]) -> int:
    """Send all requests and then read the answers; how many were refused as too many."""
    async with session.ws_connect(f"{url}ws", max_msg_size=0) as socket:
        for number, kind in enumerate(kinds):
            await socket.send_json({**kind, "id": number})
        waiting, busy = set(range(len(kinds))), 0
        while waiting:
            message = await socket.receive_json(timeout=120.0)
            if message["type"] == "reply":
                waiting.remove(message["id"])
                busy += not message["ok"] and message["issues"][0]["code"] == "busy"
        return busy


def requests() -> Iterator[Dict[str, object]]:
    """Requests of all kinds, without end."""
    return itertools.cycle(KINDS)


def test_a_flood_at_the_editor_stops_neither_time_nor_others(case, monkeypatch, record):
    monkeypatch.setattr("editor_case.InlineEngine", ProcessEngine)
    made: Case = case(box("a"), paused=False, check_outgoing=False)

    async def scenario(browser):
        async def all_pages():
            kinds = list(itertools.islice(requests(), REQUESTS))
            return sum(await asyncio.gather(*(flood(browser.session, made.url, kinds)
                                              for _ in range(PAGES))))

        flooding = asyncio.ensure_future(all_pages())
        waits = []
        while not flooding.done():
            began = time.monotonic()
            await browser.ask("folders")
            waits.append(time.monotonic() - began)
        return await flooding, max(waits)

    before, sim_before = memory(), made.sim.clock.sim_ns
    stall = Stall(made.sim)
    stall.start()
    busy, wait = made.browse(scenario)
    longest = stall.stop()
    grown = (memory() - before) / 1024
    assert made.sim.clock.sim_ns > sim_before
    assert grown < MOST_MB
    record("flood: editor", requests=PAGES * REQUESTS, busy=busy, growth_mb=round(grown, 1),
           stall_s=round(longest, 2), longest_wait_of_another_s=round(wait, 2))
