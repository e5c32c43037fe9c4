"""Where the editor listens, and the address that leads there."""
from __future__ import annotations

import errno
import socket
from typing import List

from ...errors import CommandError, warning
from ..editor_options import DEFAULT_PORT, EditorOptions
from . import address_file

_NEXT_PORTS = 100
"""How many ports after the default one are tried."""


def open_listening_socket(options: EditorOptions) -> socket.socket:
    """Open a listening socket; log a warning if its port is in use. Raises CommandError."""
    listener = _bound(options)
    port = int(listener.getsockname()[1])
    if options.port not in (0, port):
        options.log(warning(
            "editor-port", f"port {options.port} is in use, perhaps by another simulator; this"
            f" editor listens at port {port}", hint="browser tabs at the"
            " other port do not show this world"))
    return listener


def _bound(options: EditorOptions) -> socket.socket:
    """A socket at the port of the options, or at the next free one if that is the default port."""
    host = options.host.strip("[]")
    after = [*range(options.port + 1, options.port + _NEXT_PORTS), 0]
    ports = [options.port] + (after if options.port == DEFAULT_PORT else [])
    for port in ports:
        try:
            family, kind, _, _, address = socket.getaddrinfo(
                host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
            listener = socket.socket(family, kind)
        except OSError as fault:
            raise CommandError(f"the editor cannot listen at {host!r}: {fault}") from fault
        try:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.bind(address)
            listener.listen(64)
            return listener
        except OSError as fault:
            listener.close()
            if fault.errno != errno.EADDRINUSE or port == ports[-1]:
                raise CommandError(f"the editor cannot listen at {host}:{port}: "
                                   f"{fault.strerror}") from fault
    raise AssertionError("there is a port to try")


def url_of(listener: socket.socket, host: str, token: str) -> str:
    """What to open in a browser."""
    port = listener.getsockname()[1]
    shown = {"0.0.0.0": socket.gethostname(), "::": socket.gethostname()}.get(host, host)
    shown = f"[{shown}]" if ":" in shown else shown
    return f"http://{shown}:{port}/" + (f"?token={token}" if token else "")


def save_address(url: str, options: EditorOptions) -> List[str]:
    """Keep an address with its token for gzclient; returns the files that do."""
    try:
        return address_file.write(url, options.cache_dir)
    except OSError as fault:
        options.log(warning(
            "editor-address", "cannot keep the editor's address with its token: "
            f"{fault}; gzclient cannot open it (start with editor_token:=false)"))
        return []
