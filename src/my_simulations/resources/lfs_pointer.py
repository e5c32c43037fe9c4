"""Recognises Git LFS pointers: small texts in place of files that `git lfs pull` fetches."""
from __future__ import annotations

_BEGINNING = b"version https://git-lfs.github.com/spec/"

LFS_POINTER = "this is a Git LFS pointer instead of the file"
LFS_HINT = "run `git lfs pull` in its repository"


def is_lfs_pointer(data: bytes) -> bool:
    """Whether the content of a file, or its beginning, is a Git LFS pointer.

    Source: Git LFS specification, "The Pointer".
    """
    return data.startswith(_BEGINNING)


def is_lfs_pointer_file(path: str) -> bool:
    """Whether a file is a Git LFS pointer. Raises OSError: it cannot be read."""
    with open(path, "rb") as stream:
        return is_lfs_pointer(stream.read(len(_BEGINNING)))
