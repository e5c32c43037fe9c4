"""Which instances of which batches a camera sees."""
from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from my_simulations.sensing.api import CameraSpec
from my_simulations.sensing.camera.batches import INSTANCE
from my_simulations.sensing.camera.instance_table import InstanceTable

VIEW = np.eye(4)   # the camera is at the origin and looks along -z


def at(x, y, z):
    made = np.eye(4)
    made[:3, 3] = x, y, z
    return made


def batch(rows, center=(0.0, 0.0, 0.0), radius=0.5, casts_shadow=True, local=None):
    return SimpleNamespace(rows=np.array(rows), center=np.array(center), radius=radius,
                           casts_shadow=casts_shadow,
                           local=np.array([np.eye(4)] * len(rows)) if local is None else local,
                           instance=np.array(([[0.0] * 4] * 3, 0, [radius] * 4, [0.0] * 3,
                                              [0.0] * 3), INSTANCE))


def seen(batches, links, placed=None, spec=None, casters=False):
    table = InstanceTable(batches)
    links = np.array(links).reshape(-1, 4, 4)
    found = table.seen(VIEW, links, len(links) if placed is None else placed, spec, casters)
    return [(one, instances["link"].tolist(), centers[:, 2].tolist())
            for one, instances, centers in found]


def test_only_instances_in_view_are_seen():
    first, second = batch([0, 1, 2]), batch([1], center=(0.0, 0.0, 9.0))
    links = [at(0, 0, -5), at(0, 0, 5), at(99, 0, -5)]
    spec = CameraSpec(width=64, height=64, hfov=1.0, near=0.1, far=100.0)
    assert seen([first, second], links, spec=spec) == [(first, [0], [-5.0]), (second, [], [])]


def test_instances_without_a_place_are_left_out():
    one = batch([0, 1, 2, -1])
    links = [at(0, 0, -1), at(0, 0, -2), at(0, 0, -9)]   # the last is that of row -1, an actor
    assert seen([one], links, placed=2) == [(one, [0, 1, -1], [-1.0, -2.0, -9.0])]
    assert seen([batch([0])], [])[0][1:] == ([], [])


@pytest.mark.parametrize("casters", [False, True])
def test_shadows_are_cast_by_batches_that_cast_some(casters):
    one, other = batch([0], casts_shadow=False), batch([0])
    found = seen([one, other], [at(0, 0, -1)], casters=casters)
    assert [rows for _, rows, _ in found] == [[] if casters else [0], [0]]


def test_instances_have_the_colors_of_their_batch():
    first, second = batch([0, 1], radius=0.25), batch([0], radius=0.5)
    found = InstanceTable([first, second]).seen(VIEW, np.array([at(0, 0, -1)] * 2), 2, None, False)
    assert [instances["diffuse"].tolist() for _, instances, _ in found] == [
        [[0.25] * 4] * 2, [[0.5] * 4]]


def test_frames_include_the_place_in_the_link():
    one = batch([0, 0], center=(0.0, 0.0, -1.0), local=np.array([at(1, 0, 0), at(0, 2, 0)]))
    (_, instances, centers), = InstanceTable([one]).seen(VIEW, np.array([at(0, 0, -3)]), 1, None,
                                                         False)
    assert instances["rows"][:, :, 3].tolist() == [[1, 0, -3], [0, 2, -3]]
    assert centers[:, 2].tolist() == [-4.0, -4.0]


def test_a_scene_without_batches_has_no_instances():
    assert seen([], [at(0, 0, -1)]) == []
