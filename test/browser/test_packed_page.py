"""The page whose modules the set-up has packed."""
from __future__ import annotations

SCRIPTS = """performance.getEntriesByType('resource').map(({name}) => new URL(name).pathname)
  .filter((path) => path.endsWith('.js')).length"""
BYTES = """[...performance.getEntriesByType('navigation'),
  ...performance.getEntriesByType('resource')].reduce((sum, one) => sum + one.transferSize, 0)"""
"""For the first picture, 450 kB take 2.3 s at 1.6 Mbit/s."""
PALETTE = "document.querySelector('.model-palette')"


def test_it_draws_edits_and_opens_what_comes_later(launch, browser):
    editor = browser.open(launch("worlds/empty.world").url)
    assert editor.get(SCRIPTS) < 30
    assert 0 < editor.get(BYTES) < 450_000
    assert editor.place("Box", (0.0, 0.0, 0.0)) == "unit_box"
    editor.page.keyboard.press("Control+m")
    editor.until(f"{PALETTE} && getComputedStyle({PALETTE}).position === 'absolute'",
                 "the model editor, in its style")
    assert editor.faults == []
    editor.close()
