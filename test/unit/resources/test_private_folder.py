"""Folders and files that only their user can read."""
from __future__ import annotations

import os
import stat

from my_simulations.resources.private_folder import make_private
from my_simulations.simulator.safe_file import write_atomically


def mode(path):
    return stat.S_IMODE(os.stat(path).st_mode)


def test_a_private_folder_is_closed_to_others_also_if_it_existed(tmp_path):
    make_private(str(tmp_path / "a" / "b"))
    assert mode(tmp_path / "a" / "b") == 0o700
    os.chmod(tmp_path / "a" / "b", 0o755)
    make_private(str(tmp_path / "a" / "b"))
    assert mode(tmp_path / "a" / "b") == 0o700


def test_private_files_are_readable_by_their_user_alone(tmp_path):
    path = tmp_path / "new" / "file"
    for _ in range(2):
        write_atomically(str(path), b"x", overwrite=True, private=True)
        assert mode(path) == 0o600 and mode(path.parent) == 0o700
        os.chmod(path, 0o644)
    write_atomically(str(tmp_path / "public" / "file"), b"x", overwrite=False)
    mask = os.umask(0)
    os.umask(mask)
    assert mode(tmp_path / "public" / "file") == 0o666 & ~mask
