"""Pages of other sites, in a real Chromium whose user has the editor open: they reach nothing."""
from __future__ import annotations

import http.server
import json
import os
import re
import threading
from urllib.parse import urlsplit

import pytest
from editor_case import box, cases
from free_ports import free_port
from support import WEBGL_FLAGS, wait_for

from my_simulations.editor.editor_options import TOKEN_VARIABLE
from my_simulations.editor.transport.access_guard import Guard

ROUTES = {
    "GET /ws": "ws",
    "GET /": "",
    "GET /protocol.json": "protocol.json",
    "GET /{part}/{inside}": "js/main.js",
    "GET /three/{inside}": "three/build/three.module.js",
    "GET /v/{stamp}/{part}/{inside}": "v/0123456789abcdef/js/main.js",
    "GET /v/{stamp}/three/{inside}": "v/0123456789abcdef/three/build/three.module.js",
    "GET /resource/{root}/{inside}": "resource/0123456789/a.png",
    "GET /solid/{id}.stl": "solid/x.stl",
    "GET /solid/{id}.ply": "solid/x.ply",
    "GET /thumb/{id}.png": "thumb/0123456789abcdef.png",
    "PUT /thumb/{id}.png": "thumb/0123456789abcdef.png",
    "PUT /upload/{name}": "upload/evil.stl",
    "GET /export/{name}": "export/evil.world",
}
"""What hostile pages try, by route; a route without a row fails the test."""

FEW_PROCESSES = ("--renderer-process-limit=1", "--disable-site-isolation-trials")
"""A frame that is refused is a page of Chromium's own, which would have a process of its own: what
a server is asked is the same."""

SECURITY = os.path.join(os.path.dirname(__file__), "..", "..", "doc", "security.md")

ATTACK = """
async (base, routes, secrets) => {
  const found = [];
  const soon = (promise) => Promise.race([promise, new Promise((done) => setTimeout(done, 4000))]);
  const tried = [];
  const attempt = (what, work) => { tried.push(soon((async () => {
    try { if (await work()) found.push(what); } catch { /* refused */ }
  })())); };
  const element = (tag, field, url) => new Promise((done) => {
    const made = document.createElement(tag);
    if (tag === 'link') made.rel = 'stylesheet';
    made.onload = () => done(tag !== 'iframe' || Boolean(made.contentDocument?.body?.innerHTML));
    made.onerror = () => done(false);
    made[field] = url;
    document.body.append(made);
  });
  const form = (method, enctype, url) => new Promise((done) => {
    const frame = document.createElement('iframe');
    frame.name = `f${Math.random()}`;
    const made = document.createElement('form');
    Object.assign(made, {method, enctype, action: url, target: frame.name});
    document.body.append(frame, made);
    frame.onload = () => done(false);
    made.submit();
  });
  const socket = (url) => new Promise((done) => {
    const made = new WebSocket(url);
    made.onopen = () => done(true);
    made.onerror = () => done(false);
  });
  for (const route of routes) {
    for (const secret of secrets) {
      const url = base + route + secret;
      attempt(`socket ${url}`, () => socket(url.replace('http', 'ws')));
      for (const method of ['GET', 'HEAD', 'POST', 'PUT', 'DELETE', 'OPTIONS']) {
        const body = ['POST', 'PUT'].includes(method) ? 'solid evil' : undefined;
        attempt(`${method} ${url}`, async () => (await fetch(url,
          {method, body, credentials: 'include'})).ok);
        if (['GET', 'HEAD', 'POST'].includes(method)) {
          attempt(`no-cors ${method} ${url}`, async () => (await fetch(url,
            {method, body, mode: 'no-cors', credentials: 'include'})).type !== 'opaque');
        }
      }
      for (const [tag, field] of [['img', 'src'], ['script', 'src'], ['link', 'href'],
        ['iframe', 'src'], ['video', 'src'], ['object', 'data']]) {
        attempt(`${tag} ${url}`, () => element(tag, field, url));
      }
      attempt(`form ${url}`, () => form('POST', 'text/plain', url));
      attempt(`form GET ${url}`, () => form('GET', 'text/plain', url));
      attempt(`beacon ${url}`, () => { navigator.sendBeacon(url, 'evil'); return false; });
      attempt(`events ${url}`, () => new Promise((done) => {
        const made = new EventSource(url, {withCredentials: true});
        made.onopen = () => done(true);
        made.onerror = () => { made.close(); done(false); };
      }));
    }
  }
  await Promise.all(tried);
  return {found, tried: tried.length};
}
"""

case = pytest.fixture(cases)


class Site:
    """A web server with an empty page, at a port of its own."""

    def __init__(self):
        class Page(http.server.BaseHTTPRequestHandler):
            def do_GET(self):
                self.send_response(200)
                self.send_header("Content-Type", "text/html")
                self.end_headers()
                self.wfile.write(b"<!DOCTYPE html><title>evil</title><body></body>")

            def log_message(self, *_):
                pass

        self._server = http.server.ThreadingHTTPServer(("127.0.0.1", free_port()), Page)
        self.port = self._server.server_address[1]
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def close(self):
        self._server.shutdown()
        self._server.server_close()


@pytest.fixture
def site():
    made = Site()
    yield made
    made.close()


@pytest.fixture
def asked(monkeypatch):
    """What the guard was asked, and what it said: (path, method, headers, refusal)."""
    requests = []
    problem = Guard._problem

    def recorded(guard, request):
        said = problem(guard, request)
        requests.append((request.path, request.method, dict(request.headers), said))
        return said

    monkeypatch.setattr(Guard, "_problem", recorded)
    return requests


def routes_of(server):
    """`METHOD /path` of all that the server answers."""
    for route in server._editor.application.router.routes():
        if route.method != "HEAD":
            yield f"{route.method} {route.resource.canonical}"


def test_every_route_is_attacked_and_described(case):
    served = set(routes_of(case(box("a")).server))
    assert served == set(ROUTES)
    with open(SECURITY, encoding="utf-8") as stream:
        described = set(re.findall(r"^\| `((?:GET|PUT) /[^`]*)` \|", stream.read(), re.MULTILINE))
    assert described == served


@pytest.mark.parametrize("token", [None, ""], ids=["token", "no token"])
def test_a_hostile_page_reaches_nothing(case, site, asked, browser, monkeypatch, token):
    monkeypatch.delenv(TOKEN_VARIABLE, raising=False)
    made = case(box("a"), token=token)
    port = urlsplit(made.url).port
    chromium = browser.launch(*WEBGL_FLAGS, "--host-resolver-rules=MAP *.example 127.0.0.1",
                              *FEW_PROCESSES)
    context = chromium.new_context()
    victim = context.new_page()
    victim.goto(made.url)
    wait_for(lambda: victim.evaluate("Boolean(window.editor && editor.store.document)"),
             "the world in the user's own page", 120.0)
    before = victim.evaluate("editor.store.document")
    own = len(asked)
    origins = {
        "another port": (f"http://127.0.0.1:{site.port}/", f"http://127.0.0.1:{port}/"),
        "another name": (f"http://localhost:{site.port}/", f"http://127.0.0.1:{port}/"),
        "another site": (f"http://evil.example:{site.port}/", f"http://127.0.0.1:{port}/"),
        "its own name for us": (f"http://evil.example:{site.port}/",
                                f"http://evil.example:{port}/"),
    }
    figures = {}
    for what, (page_url, base) in origins.items():
        # Names and origins are checked before the token: to try a wrong one once is enough.
        secrets = ["", "?token=wrong"] if token is None and what == "another port" else [""]
        page = context.new_page()
        page.goto(page_url)
        said = page.evaluate(f"([base, routes, secrets]) => ({ATTACK})(base, routes, secrets)",
                             [base, sorted(set(ROUTES.values())), secrets])
        assert said["found"] == [], what
        figures[what] = said["tried"]
        page.close()
    foreign = [one for one in asked[own:]
               if one[2].get("Sec-Fetch-Site", "cross-site") not in ("same-origin", "none")]
    assert len(foreign) > 100 and [one[:2] for one in foreign if not one[3]] == []
    assert victim.evaluate("editor.store.document") == before
    assert victim.evaluate("editor.store.connected")
    for folder in ("uploads", "thumbnails"):
        assert not list((made.folder).rglob(f"{folder}/*"))
    print(json.dumps({"requests that reached the guard": len(foreign), **figures}))
    chromium.close()


def test_a_rebound_name_shows_nothing(case, asked, browser, monkeypatch):
    """A name that was made to point here after its page was loaded: one origin with it."""
    monkeypatch.delenv(TOKEN_VARIABLE, raising=False)
    made = case(box("a"), token="")
    port = urlsplit(made.url).port
    chromium = browser.launch("--host-resolver-rules=MAP *.example 127.0.0.1", *FEW_PROCESSES)
    page = chromium.new_page()
    for route in sorted(set(ROUTES.values())):
        answer = page.goto(f"http://rebound.example:{port}/{route}")
        assert answer.status == 403, route
    # The page was loaded before the name pointed here; now all requests are of its own origin.
    base = f"http://rebound.example:{port}/"
    page.route(base + "evil.html", lambda route: route.fulfill(
        content_type="text/html", body="<!DOCTYPE html><title>evil</title><body></body>"))
    page.goto(base + "evil.html")
    said = page.evaluate(f"([base, routes, secrets]) => ({ATTACK})(base, routes, secrets)",
                         [base, sorted(set(ROUTES.values())), [""]])
    assert said["found"] == []
    assert asked and all(problem for *_, problem in asked)
    chromium.close()
