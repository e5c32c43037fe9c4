"""Where cases run: `--on slurm`, `--on dask://HOST:PORT`, `--on dask:FILE`."""
from __future__ import annotations

import os
from dataclasses import dataclass

from ..errors import CommandError

SLURM = "slurm"
_PORT = 8786  # Dask's usual one


@dataclass(frozen=True)
class TlsFiles:
    """PEM files; "" for those of Dask's configuration (`distributed.comm.tls`)."""

    ca: str = ""
    cert: str = ""
    key: str = ""


def scheduler_address(where: str) -> str:
    """The address of a Dask scheduler for Dask, or its scheduler file; "" for none.

    Raises CommandError: it is no place where cases can run, or has no encryption.
    """
    kind, colon, rest = where.partition(":")
    if not where:
        return ""
    if kind in ("dask", "tls") and rest.startswith("//") and rest != "//":
        host = rest[2:]
        return f"tls://{host}" if ":" in host.rpartition("]")[2] else f"tls://{host}:{_PORT}"
    if kind == "dask" and rest and not rest.startswith("//"):
        path = os.path.abspath(os.path.expanduser(rest))
        if not os.path.isfile(path):
            raise CommandError(f"there is no scheduler file {path}")
        return path
    if kind in ("tcp", "ws") and colon:
        raise CommandError(
            f"--on {where}: {kind}:// is neither encrypted nor asks for a certificate, and anyone"
            " who can connect to such a scheduler can run programs as you, on every worker; start"
            " it with TLS and name it with dask:// (doc/scale.md)")
    raise CommandError(f"--on {where}: known are slurm, dask://HOST:PORT and dask:FILE")
