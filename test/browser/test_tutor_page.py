"""The tutor's page of a class: tiles of students, and the way into a student's world."""
from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

from support import SECONDS, wait_for

from my_simulations.grading.box_support import isolation_fault

REPOSITORY = Path(__file__).resolve().parents[2]


def test_a_tile_shows_a_world_and_leads_into_it(browser, tmp_path):
    assert isolation_fault() == ""
    folder = tmp_path / "course"
    folder.mkdir()
    port = 20000 + os.getpid() % 20000
    (folder / "lab.yaml").write_text(f"students: [anna]\nport: {port}\n"
                                     "launch: my_simulations world.launch\n")
    process = subprocess.Popen([sys.executable, str(REPOSITORY / "scripts" / "class"), "start",
                                str(folder / "lab.yaml")], stdout=subprocess.PIPE, text=True)
    try:
        address = process.stdout.readline().strip().partition(": ")[2]
        tutor = browser.open(address, wait=False)
        page = tutor.page
        wait_for(lambda: page.locator("article.running").count() == 1, "a running world")
        assert page.locator("h1").inner_text() == "lab"
        wait_for(lambda: "default, " in page.locator("article").inner_text(), "its name")
        with page.context.expect_page(timeout=1000.0 * SECONDS) as opened:
            page.get_by_role("link", name="Join").click()
        world = opened.value
        wait_for(lambda: world.evaluate("window.editor?.store?.document?.name") == "default",
                 "the student's world")
        wait_for(lambda: "Browsers\n1" in page.locator("article").inner_text(), "its browser")
        world.close()
        page.get_by_role("button", name="Stop").click()
        wait_for(lambda: "stopped by the tutor" in page.locator("article").inner_text(),
                 "the end of the world")
        assert tutor.faults == []
        tutor.close()
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait(SECONDS)
        process.stdout.close()
