"""Takes a replay page apart."""
from __future__ import annotations

import base64
import gzip
import json
import re
import struct

from my_simulations.editor.logs.state_log import MESSAGE, LogReader
from my_simulations.editor.topics.topic_frame import decode_frame


def replay_content(page, log):
    """The head of a page's data, and views of the messages by topic; writes the log to `log`."""
    text = re.search(r'id="data">(.*?)</script>', page.read_text(encoding="utf-8"), re.S).group(1)
    data = gzip.decompress(base64.b64decode(text))
    (size,) = struct.unpack_from("<I", data)
    head = json.loads(data[4:4 + size])
    log.write_bytes(data[4 + size:][:head["log"][1]])
    reader = LogReader(str(log))
    messages = {}
    for kind, content in reader.records(-1, 10 ** 6):
        if kind == MESSAGE:
            message, _ = decode_frame(content)
            messages.setdefault(message["topic"], []).append(message["view"])
    reader.close()
    return head, messages
