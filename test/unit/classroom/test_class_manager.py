"""When worlds of students are stopped."""
from __future__ import annotations

import asyncio
import time
from types import SimpleNamespace

from free_ports import free_ports

from my_simulations.classroom.class_file import read_class
from my_simulations.classroom.class_manager import ClassManager, MonitoredWorld
from my_simulations.classroom.monitor import Monitor
from my_simulations.classroom.world_states import RUNNING, STARTING


def test_a_world_is_idle_from_when_it_runs_however_long_it_took_to_start(tmp_path):
    file = tmp_path / "class.yaml"
    file.write_text(f"class: lab\nstudents: [anna]\nport: {free_ports(2)}\nidle_minutes: 1\n"
                    "launch: my_simulations world.launch\n")
    manager = ClassManager(read_class(str(file))[0], 1, lambda line: None)
    reasons = []
    world = SimpleNamespace(state=STARTING, active=time.monotonic() - 3600.0, is_alive=True,
                            reason="", poll=lambda: None, stop=reasons.append)
    monitored = manager._worlds["anna"]
    monitored.world.listening.close()
    monitor = Monitor(1)
    monitor.is_connected = True
    manager._worlds["anna"] = MonitoredWorld(world, monitor)

    async def poll():
        manager._poll()
        await asyncio.sleep(0)
        assert (world.state, reasons) == (RUNNING, [])
        world.active -= 3600.0
        manager._poll()
        while not reasons:
            await asyncio.sleep(0.01)

    asyncio.run(asyncio.wait_for(poll(), 60.0))
