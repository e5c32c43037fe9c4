"""A real node and a real Chromium, and a person's hands on mouse and keyboard."""
from __future__ import annotations

import math
import os
import shutil
import signal
import subprocess
import time
import xmlrpc.client
from unittest import mock

from free_ports import free_port
from playwright.sync_api import sync_playwright

from my_simulations.editor.transport import address_file

SECONDS = 120.0
"""Until something must have happened; a machine under load draws a picture in seconds."""
FIRST_VIEW = "#view=5,-5,2,2.3561945,-0.2756999"
"""A link to the view of an empty world: from (5, -5, 2) to the origin."""
ANEW = "loaded anew"
CLEARING = f"""if (window.name === '{ANEW}') {{
  window.name = '';
  localStorage.clear();
  sessionStorage.clear();
}}"""
"""Runs before the scripts of a page, and after the last of the page before it."""
CHROMIUM = ("chromium-headless-shell", "chromium", "chromium-browser")
"""Names of its programs: the first is without windows, and what the pages do is the same."""
WEBGL_FLAGS = ("--use-angle=gl-egl", "--ignore-gpu-blocklist", "--disable-gpu-compositing")
"""Mesa computes WebGL, in half of the time of SwiftShader. Only that: to compose the page as well
would take twice as long."""
SWIFTSHADER_FLAGS = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                     "--disable-gpu-compositing")
"""What Chromium itself has for machines without a GPU."""
UNUSED_FEATURES = ("WebUIOmniboxPopup", "WebUIOmniboxAimPopup")
"""Hidden pages of Chromium's address bar. Each window would load them, which takes a quarter of the
time that the editor needs to open."""
PLAYWRIGHTS_OWN = ("AvoidUnnecessaryBeforeUnloadCheckSync", "DestroyProfileOnBrowserClose",
                   "HttpsUpgrades", "HttpsFirstBalancedModeAutoEnable", "LensOverlay",
                   "MediaRouter", "PaintHolding", "ThirdPartyStoragePartitioning",
                   "AvoidCorsURLLoaderRestartOnRedirect", "OptimizationHints",
                   "NetworkTimeServiceQuerying", "AimEnabled", "PreconnectToSearch")
"""Features that Playwright disables: Chromium applies only the last of several such switches."""
WIDTH, HEIGHT = 1366, 768
"""A small laptop's screen."""


def wait_for(condition, what, seconds=SECONDS):
    """The first true value of `condition()`; an AssertionError that says `what` is missing."""
    until, pause = time.monotonic() + seconds, 0.02
    while True:
        began = time.monotonic()
        found = condition()
        if found:
            return found
        now = time.monotonic()
        assert now < until, f"{what} did not happen within {seconds} s"
        # To ask the page takes time from what is waited for, a picture of it the most.
        time.sleep(max(pause, min(now - began, 0.5)))
        pause = min(1.5 * pause, 0.1)


class Node:
    """`roslaunch` of a world on a master of its own, with a home folder of its own."""

    def __init__(self, folder, world, *arguments):
        self.home = str(folder)
        self.worlds = os.path.join(self.home, "my_simulations", "worlds")
        self.typed = os.path.join(self.home, "typed_here")
        os.makedirs(self.worlds, exist_ok=True)
        os.makedirs(self.typed, exist_ok=True)
        port = free_port()
        self.master = f"http://127.0.0.1:{port}"
        environment = {name: value for name, value in os.environ.items()
                       if name not in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")
                       and not name.startswith("XDG_")}
        environment.update(HOME=self.home, ROS_MASTER_URI=self.master, ROS_HOSTNAME="127.0.0.1",
                           ROS_HOME=os.path.join(self.home, ".ros"))
        self.log = open(os.path.join(self.home, "roslaunch.log"), "a+", encoding="utf-8")
        self.process = subprocess.Popen(
            ["roslaunch", "-p", str(port), "gazebo_ros", "empty_world.launch", "gui:=true",
             "paused:=true", f"world_name:={world}", *arguments],
            env=environment, cwd=self.typed, stdout=self.log, stderr=subprocess.STDOUT,
            start_new_session=True)
        try:
            public = wait_for(self._editor_url, "the editor's address")
        except AssertionError as fault:
            raise AssertionError(f"{fault}; roslaunch said {self.said()}") from fault
        self.url = address_file.with_token(public,
                                           os.path.join(self.home, ".cache", "my_simulations"))

    def _editor_url(self):
        assert self.process.poll() is None, self.said()
        try:
            code, _, url = xmlrpc.client.ServerProxy(self.master).getParam(
                "/test", "/gazebo/my_simulations/editor_url")
        except OSError:
            return None
        return url if code == 1 else None

    def said(self):
        self.log.seek(0)
        return self.log.read()

    def ask(self, service, service_class, **fields):
        """Calls a service of /gazebo the way any client does."""
        import rospy

        # Each node has a master of its own; rospy asks the one of the environment at each call.
        with mock.patch.dict(os.environ, ROS_MASTER_URI=self.master):
            rospy.wait_for_service(f"/gazebo/{service}", SECONDS)
            return rospy.ServiceProxy(f"/gazebo/{service}", service_class)(**fields)

    def close(self):
        # Killed, roslaunch would leave its nodes behind, with their ports.
        for number, seconds in ((signal.SIGINT, SECONDS), (signal.SIGKILL, 5.0)):
            if self.process.poll() is None:
                os.killpg(self.process.pid, number)
                try:
                    self.process.wait(seconds)
                except subprocess.TimeoutExpired:
                    continue
        self.log.close()


class Browser:
    """Chromium without a screen; WebGL is computed."""

    def __init__(self):
        self._playwright = sync_playwright().start()
        self._browser = self.launch(*WEBGL_FLAGS)

    def launch(self, *flags):
        """A Chromium with other flags, for the caller to close."""
        binary = next(filter(None, map(shutil.which, CHROMIUM)), None)
        off = "--disable-features=" + ",".join((*PLAYWRIGHTS_OWN, *UNUSED_FEATURES))
        return self._playwright.chromium.launch(executable_path=binary,
                                                args=["--no-sandbox", off, *flags])

    def open(self, url, **options):
        return Editor(self._browser, url, **options)

    def close(self):
        self._browser.close()
        self._playwright.stop()


class Editor:
    """One page with the editor; `faults` are errors of its scripts.

    Its user has asked for less motion: a second of flight to a view costs that of processor. So do
    pixels: by default its screen has half as many a line as the layout; tests of pictures have all.
    """

    def __init__(self, browser, url, size=(WIDTH, HEIGHT), color_scheme="dark", wait=True,
                 motion="reduce", scale=0.5, **options):
        self.context = browser.new_context(viewport={"width": size[0], "height": size[1]},
                                           device_scale_factor=scale,
                                           color_scheme=color_scheme, accept_downloads=True,
                                           reduced_motion=motion, **options)
        self.context.set_default_timeout(1000.0 * SECONDS)
        self.context.add_init_script(CLEARING)
        self.page = self.context.new_page()
        self.faults = []
        self.said = []
        self.page.on("pageerror", lambda fault: self.faults.append(str(fault)))
        self.page.on("console", lambda message: self.said.append(message.text))
        # The first view frames what is there; hands need one that they know.
        self._address = url if "#" in url else url + FIRST_VIEW
        self.page.goto(self._address)
        if wait:
            self.wait_for_world()

    def load_anew(self):
        """As a new page: all that is kept is Chromium's process, with the scripts it compiled."""
        self.page.mouse.move(0, 0)
        self.page.evaluate(f"(address) => {{ window.name = '{ANEW}';"
                           " history.replaceState(null, '', address); }", self._address)
        self.page.reload()
        self.faults.clear()
        self.said.clear()
        self.wait_for_world()

    def wait_for_world(self):
        self.until("Boolean(window.editor && editor.store.document && editor.view)", "the world")
        self.until("performance.getEntriesByName('first-picture').length > 0",
                   "the first picture")

    def close(self):
        self.context.close()

    def get(self, expression):
        return self.page.evaluate(expression)

    def until(self, expression, what):
        try:
            return wait_for(lambda: self.get(expression), what)
        except AssertionError as fault:
            raise AssertionError(f"{fault}; the page said {self.faults + self.said}") from fault

    def frame(self):
        """Waits until what the page knows by now is drawn."""
        self.get("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def rest(self):
        """Waits until nothing moves in the view any more, and its picture is finished."""
        self.frame()
        self.until("editor.view.fps === 0", "rest of the view")

    def settled_picture(self, clip):
        """Return a picture of a part of the page at rest. The screen shows a drawn frame later."""
        pictures = [b""]

        def stays():
            self.frame()
            pictures.append(self.page.screenshot(clip=clip))
            return pictures[-1] == pictures[-2]

        self.rest()
        wait_for(stays, "two pictures that are alike")
        return pictures[-1]

    # -- what a person sees ------------------------------------------------------------------------

    def names(self):
        return self.get("editor.store.document.models.map((model) => model.name)")

    def model(self, name):
        """The model's document, with its pose as the simulator last told it."""
        return self.get(f"(() => {{ const store = editor.store; const model = "
                        f"store.model({name!r}); return model && "
                        f"{{...model, pose: store.worldPose({name!r})}}; }})()")

    def button(self, name):
        return self.page.get_by_role("button", name=name, exact=True)

    def row(self, name):
        return self.page.get_by_role("treeitem", name=name, exact=True)

    def field(self, name):
        return self.page.get_by_role("textbox", name=name, exact=True)

    # -- hands -------------------------------------------------------------------------------------

    def pixel(self, point):
        """Where a point of the world is on the page, as the camera looks now."""
        box = self.page.locator("#view").bounding_box()
        x, y = projected(point, self.get("editor.view.camera"), box["width"], box["height"])
        return box["x"] + x, box["y"] + y

    def click(self, point, **options):
        self.page.mouse.click(*self.pixel(point), **options)

    def place(self, tool, point=(0.0, 0.0, 0.0)):
        """Clicks a tool of the bar, then a point (m); returns the name of the new entity."""
        before = set(self.names())
        lights = set(self.get("editor.store.document.lights.map((light) => light.name)"))
        self.button(tool).click()
        x, y = self.pixel(point)
        self.page.mouse.move(x - 40, y - 25)
        self.page.mouse.move(x, y, steps=5)
        self.page.mouse.click(x, y)
        name = wait_for(lambda: next(iter(
            (set(self.names()) - before) |
            (set(self.get("editor.store.document.lights.map((light) => light.name)")) - lights)),
            None), f"the new {tool}")
        # The new entity arrives first, then the history; the page selects it after the reply.
        self.until(f"editor.store.history.undo[0]?.toLowerCase() === 'insert {name}'",
                   f"{name} in the history")
        self.until(f"editor.store.selection.join() === '{name}'", f"the selection of {name}")
        return name

    def drag(self, start, end, keys=()):
        """Presses at a point of the world, moves to another in small steps, lets go."""
        self.page.mouse.move(*self.pixel(start))
        for key in keys:
            self.page.keyboard.down(key)
        self.page.mouse.down()
        (x0, y0), (x1, y1) = self.pixel(start), self.pixel(end)
        for step in range(1, 13):
            self.page.mouse.move(x0 + (x1 - x0) * step / 12, y0 + (y1 - y0) * step / 12)
        self.page.mouse.up()
        for key in keys:
            self.page.keyboard.up(key)


ACROSS = math.radians(60.0)


def projected(point, camera, width, height):
    """A point's pixel in a view that is 60 degrees wide, x right, y down.

    `camera` has `position` in m, and `yaw` and `pitch` (up) in rad.
    """
    level = math.cos(camera["pitch"])
    forward = (level * math.cos(camera["yaw"]), level * math.sin(camera["yaw"]),
               math.sin(camera["pitch"]))
    right = _unit(_cross(forward, (0.0, 0.0, 1.0)))
    up = _cross(right, forward)
    ray = [part - eye for part, eye in zip(point, camera["position"])]
    depth = _dot(ray, forward)
    assert depth > 0.1, f"{point} lies behind the camera"
    scale = width / 2.0 / math.tan(ACROSS / 2.0) / depth
    return width / 2.0 + scale * _dot(ray, right), height / 2.0 - scale * _dot(ray, up)


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def _cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _unit(a):
    length = math.sqrt(_dot(a, a))
    return tuple(part / length for part in a)


def yaw_of(pose):
    """Turn about z of a pose of seven numbers, in degrees."""
    x, y, z, w = pose[3:]
    return math.degrees(math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))
