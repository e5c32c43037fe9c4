#!/usr/bin/env python3
"""Prints what the world editor costs. Run it in a shell that has sourced the workspace.

usage: editor.py [ROW …]   rows: page slow idle frames moving meshes stl release (default: all)

The browser is a headless Chromium that draws with the processor, as where there is no graphics
card: SwiftShader computes WebGL, and the page itself is composed without WebGL. The switch for
SwiftShader alone would let it compose the page too, which takes five to ten times as long.
Nothing here fails on a slow machine.
"""
from __future__ import annotations

import asyncio
import contextlib
import math
import os
import shutil
import statistics
import tempfile
import threading
import time
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple

from bench import EMPTY
from row_table import Row, Rows, shown_with_ros
from server import Server, children, processor, wait

from my_simulations.editor.transport import address_file

CHROMIUM = (os.environ.get("CHROMIUM") or shutil.which("chromium-headless-shell")
            or shutil.which("chromium") or "chromium")
SHAPES = ("<box><size>.5 .5 .5</size></box>", "<sphere><radius>.3</radius></sphere>",
          "<cylinder><radius>.3</radius><length>.5</length></cylinder>")


def drifting(count: int, rate: float, gravity: float = 0.001,
             shapes: Sequence[str] = SHAPES) -> str:
    """Bodies that never rest and never meet: they sink from high above, m/s^2."""
    models = []
    for n in range(count):
        shape = f"<geometry>{shapes[n % len(shapes)]}</geometry>"
        models.append(
            f"<model name='m{n}'><allow_auto_disable>0</allow_auto_disable>"
            f"<pose>{n % 32 - 16} {n // 32 - 16} 200 0 0 0</pose><link name='link'>"
            f"<collision name='c'>{shape}</collision><visual name='v'>{shape}</visual>"
            "</link></model>")
    return f"""<?xml version='1.0'?><sdf version='1.6'><world name='default'>
      <gravity>0 0 {-gravity}</gravity><physics type='ode'><max_step_size>0.001</max_step_size>
      <real_time_update_rate>{rate}</real_time_update_rate></physics>
      <include><uri>model://sun</uri></include><gui><camera name='user_camera'>
      <pose>-30 -30 215 0 0.3 0.785</pose></camera></gui>{"".join(models)}</world></sdf>"""


def editor_url() -> str:
    """Ask the running node for its editor's address."""
    import rospy
    from my_simulations_msgs.srv import OpenEditor

    rospy.wait_for_service("/gazebo/open_editor", 30)
    return address_file.with_token(rospy.ServiceProxy("/gazebo/open_editor", OpenEditor)().url)


@contextlib.contextmanager
def browser() -> Iterator[Any]:
    """A headless Chromium's page of a lab's screen."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=[
            "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-compositing",
            "--no-sandbox"])
        try:
            yield chromium.new_page(viewport={"width": 1366, "height": 768})
        finally:
            chromium.close()


def opened(page: Any, url: str) -> float:
    """Load the editor; ms from the request to the first picture of the world."""
    page.goto(url)
    found: List[float] = []

    def pictured() -> bool:
        found.extend(page.evaluate(
            "performance.getEntriesByName('first-picture').map(mark => mark.startTime)"))
        return bool(found)

    wait(pictured, 60, "picture")
    return found[0]


def chromium_pids(word: str = "") -> List[int]:
    """The processes of the browser that this program started, with a word in their command line."""
    found = []
    for pid in children(os.getpid()):
        with contextlib.suppress(OSError), open(f"/proc/{pid}/cmdline", "rb") as stream:
            command = stream.read()
            if b"chromium" in command.split(b"\0", 1)[0] and word.encode() in command:
                found.append(pid)
    return found


def page_load() -> List[Row]:
    took = []
    with Server(EMPTY):
        url = editor_url()
        for _ in range(4):
            with browser() as page:
                took.append(opened(page, url) / 1e3)
    # The first one also finds the server's files cold.
    middle = statistics.median(took)
    return [("page load to first picture, empty world", f"{middle:.2f} s, first {took[0]:.2f} s",
             "2 s", middle <= 2)]


def slow_page() -> List[Row]:
    """Load the page through a line of 1.6 Mbit/s with a round trip of 150 ms, as on a phone."""
    with Server(EMPTY), browser() as page:
        session = page.context.new_cdp_session(page)
        session.send("Network.enable")
        session.send("Network.emulateNetworkConditions", {
            "offline": False, "latency": 150, "downloadThroughput": 1.6e6 / 8,
            "uploadThroughput": 0.75e6 / 8})
        took = opened(page, editor_url()) / 1e3
    return [("page load to first picture at 1.6 Mbit/s", f"{took:.2f} s", "5 s", took <= 5)]


def share(pids: List[int], seconds: float) -> float:
    """Per cent of one core that some processes take."""
    before, since = processor(pids), time.perf_counter()
    time.sleep(seconds)  # the thing measured, not a wait for something
    return (processor(pids) - before) / (time.perf_counter() - since) * 100


def idle() -> List[Row]:
    import rospy
    from std_srvs.srv import Empty

    with Server(EMPTY) as server, browser() as page:
        opened(page, editor_url())
        rospy.ServiceProxy("/gazebo/pause_physics", Empty)()
        time.sleep(4.0)  # let start-up work end
        node = server.pids()
        page_share = share(chromium_pids(), 10.0)
        with_page = share(node, 10.0)
        page.close()
        time.sleep(1.0)
        alone = share(node, 10.0)
    return [("idle page, paused world: the browser", f"{page_share:.1f} %", "2 %", page_share < 2),
            ("idle page, paused world: the node",
             f"{with_page:.1f} % ({alone:.1f} % without a page)", "2 %", with_page < 2)]


def sim_speed(seconds: float) -> float:
    """Simulated seconds in a second of wall time."""
    import rospy
    from gazebo_msgs.srv import GetWorldProperties

    rospy.wait_for_service("/gazebo/get_world_properties", 30)
    ask = rospy.ServiceProxy("/gazebo/get_world_properties", GetWorldProperties)
    began, sim = time.perf_counter(), ask().sim_time
    time.sleep(seconds)
    return float((ask().sim_time - sim) / (time.perf_counter() - began))


async def _listen(url: str, seconds: float) -> Tuple[int, int]:
    """Be a page that only listens; frames and bytes of them in some seconds."""
    import aiohttp

    frames = size = 0
    address, _, query = url.partition("?")  # the query has the token
    async with aiohttp.ClientSession() as session:
        async with session.ws_connect(f"{address}ws?{query}", max_msg_size=0) as socket:
            await socket.send_json({"type": "hello", "id": 1, "version": 1})
            until = time.perf_counter() + seconds
            while time.perf_counter() < until:
                message = await socket.receive(timeout=5)
                if message.type == aiohttp.WSMsgType.BINARY:
                    frames, size = frames + 1, size + len(message.data)
    return frames, size


def listening(url: str, seconds: float) -> Any:
    """The same in a process of its own, so that it does not slow us."""
    import concurrent.futures

    pool = concurrent.futures.ProcessPoolExecutor(1)
    future = pool.submit(_listen_main, url, seconds)
    pool.shutdown(wait=False)
    return future


def _listen_main(url: str, seconds: float) -> Tuple[int, int]:
    return asyncio.run(_listen(url, seconds))


def frames() -> List[Row]:
    with Server(drifting(1000, 0.0)):
        url = editor_url()
        speeds: Dict[bool, List[float]] = {False: [], True: []}
        count = size = 0
        for _ in range(3):
            speeds[False].append(sim_speed(4.0))
            future = listening(url, 6.0)
            time.sleep(1.0)
            speeds[True].append(sim_speed(4.0))
            count, size = future.result()
    without, with_page = (statistics.median(speeds[key]) for key in (False, True))
    cost = (1 - with_page / without) * 100
    rate = size / 6.0 / 1e6
    return [("1000 moving bodies: cost of frames", f"{cost:.1f} % of {without:.2f} real time",
             "10 %", cost <= 10),
            ("1000 moving bodies: bandwidth", f"{rate:.2f} MB/s, {count / 6.0:.0f} frames/s",
             "1.2 MB/s", rate <= 1.2)]


WATCH = """() => { window.tasks = []; new PerformanceObserver((list) => {
  for (const entry of list.getEntries()) window.tasks.push(entry.duration);
}).observe({type: 'longtask', buffered: false});
window.late = []; window.addEventListener('pointermove', (event) =>
  window.late.push(performance.now() - event.timeStamp), {capture: true}); }"""


MENU = """() => new Promise((done) => {
  const seen = new PerformanceObserver((list) => {
    const press = list.getEntries().find(({name}) => name === 'pointerdown');
    if (!press) return;
    seen.disconnect();
    done(press.duration);
  });
  seen.observe({type: 'event', durationThreshold: 16});
  setTimeout(() => done(16), 3000);  // quicker ones are not told
})"""
"""Resolves with the ms from the next press to the moment at which its effect is on the screen."""


def picture_costs(page: Any, seconds: float) -> Tuple[float, float, float]:
    """Pictures in a second; processor time of one on the main thread and in what draws, s."""
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})

    def reading() -> List[float]:
        metrics = session.send("Performance.getMetrics")["metrics"]
        thread = next(one["value"] for one in metrics if one["name"] == "TaskDuration")
        return [page.evaluate("window.editor.view.pictures"), thread,
                processor(chromium_pids("--type=gpu-process")), time.perf_counter()]

    before = reading()
    time.sleep(seconds)  # the thing measured, not a wait for something
    pictures, thread, drawing, took = (b - a for a, b in zip(before, reading()))
    return pictures / took, thread / max(pictures, 1), drawing / max(pictures, 1)


def moving() -> List[Row]:
    # What sinks so slowly that no pixel changes would not be drawn at all.
    with Server(drifting(1000, 1000.0, 0.3, SHAPES[:1]), "-u"), browser() as page:
        opened(page, editor_url())
        # Shaders are compiled by the first pictures of each size.
        page.mouse.move(700, 400)
        for n in range(20):
            page.mouse.wheel(0, 20 if n % 2 else -20)
            wait(lambda: page.evaluate("window.editor.view.fps > 0"), 60, "picture")
        wait(lambda: page.evaluate("window.editor.view.fps === 0"), 60, "rest")
        page.evaluate("window.editor.actions.play(), null")
        time.sleep(3.0)
        # First of all: what sinks is out of sight after 20 s.
        pictures, thread, drawing = picture_costs(page, 5.0)
        page.evaluate(WATCH)
        for n in range(24):
            page.mouse.move(500 + 10 * n, 400)
            time.sleep(0.25)
        tasks = page.evaluate("window.tasks")
        late = page.evaluate("window.late")
        menu, at_once = [], []
        for _ in range(7):
            # What sinks is out of sight after 20 s, and then pictures would be quick.
            page.evaluate("window.editor.actions.resetPoses(), null")
            menu.append(_menu(page, _travel))
            at_once.append(_menu(page, lambda page, x, y: page.mouse.move(x, y)))
    longest = max(tasks, default=0.0)
    opens = statistics.median(menu)
    return [("1000 moving boxes, software GL: pictures", f"{pictures:.1f} /s", "6 /s",
             pictures >= 6),
            ("1000 moving boxes: page's main thread", f"{thread * 1e3:.1f} ms a picture",
             "16 ms", thread <= 0.016),
            ("1000 moving boxes, software GL: the process that draws",
             f"{drawing * 1e3:.0f} ms of processor time a picture", "-", True),
            ("1000 moving boxes, software GL: longest handler",
             f"{longest:.0f} ms" if longest else "none over 50 ms", "100 ms", longest <= 100),
            ("1000 moving boxes, software GL: mouse heard after",
             f"{statistics.median(late):.0f} ms median, {max(late):.0f} ms most", "-", True),
            ("1000 moving boxes, software GL: a menu opens",
             f"{opens:.0f} ms median, {max(menu):.0f} ms most", "100 ms", opens <= 100),
            ("the same, when the mouse has jumped there from the view",
             f"{statistics.median(at_once):.0f} ms median, {max(at_once):.0f} ms most", "-", True)]


def _travel(page: Any, x: float, y: float) -> None:
    """Move the mouse from the middle of the view as a quick hand does: 0.4 s, and 0.1 s of rest."""
    for n in range(26):
        share = 10 * (n / 25) ** 3 - 15 * (n / 25) ** 4 + 6 * (n / 25) ** 5  # of least jerk
        page.mouse.move(700 + share * (x - 700), 400 + share * (y - 400))
        time.sleep(0.016)
    time.sleep(0.1)


def _menu(page: Any, go: Callable[[Any, float, float], None]) -> float:
    """Press on a menu with the mouse; ms until it is seen."""
    box = page.locator("#menubar [role=menuitem]").first.bounding_box()
    page.evaluate(f"window.opening = ({MENU})(), null")
    go(page, box["x"] + 8, box["y"] + 8)
    page.mouse.down()
    page.mouse.up()
    took = float(page.evaluate("window.opening"))
    page.keyboard.press("Escape")
    page.mouse.move(700, 400)
    time.sleep(0.5)
    wait(lambda: page.evaluate("window.editor.view.fps > 0"), 60, "pictures as before")
    return took


def mesh_world(folder: str) -> str:
    """A house full of meshes: 40 files of 20,480 triangles, each in the world five times."""
    import trimesh

    models = []
    for n in range(40):
        path = os.path.join(folder, f"mesh_{n}.stl")
        ball = trimesh.creation.icosphere(5, 0.4)
        ball.apply_scale((1.0, 0.4 + 0.03 * n, 0.8))
        ball.export(path)
        for copy in range(5):
            models.append(
                f"<model name='m{n}_{copy}'><static>1</static><pose>{n % 8 - 4} {n // 8 - 2} "
                f"{copy + 0.5} 0 0 0</pose><link name='link'><visual name='v'><geometry><mesh>"
                f"<uri>{path}</uri></mesh></geometry></visual></link></model>")
    return ("<?xml version='1.0'?><sdf version='1.6'><world name='default'>"
            f"<include><uri>model://sun</uri></include>{''.join(models)}</world></sdf>")


def gpu_megabytes() -> float:
    """Memory of the browser's process that draws."""
    for pid in chromium_pids("--type=gpu-process"):
        with contextlib.suppress(OSError), open(f"/proc/{pid}/statm", encoding="ascii") as memory:
            return int(memory.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
    return 0.0


def meshes() -> List[Row]:
    with tempfile.TemporaryDirectory() as folder, Server(mesh_world(folder)), browser() as page:
        first = opened(page, editor_url()) / 1e3
        began = time.perf_counter()
        wait(lambda: page.evaluate("window.editor.view.waiting === 0"), 120, "meshes")
        whole = first + time.perf_counter() - began
        page.evaluate("window.editor.view.redraw()")
        wait(lambda: page.evaluate("window.editor.view.fps === 0"), 60, "rest")
        megabytes = gpu_megabytes()
    return [("200 meshes of 40 files: page load to first picture", f"{first:.2f} s", "5 s",
             first <= 5),
            ("200 meshes of 40 files: all of them drawn", f"{whole:.2f} s", "-", True),
            ("200 meshes of 40 files: GPU process", f"{megabytes:.0f} MB", "500 MB",
             megabytes <= 500)]


def stl_world(folder: str, files: int, subdivisions: int) -> str:
    """STL files of uneven balls, each in the world once, beside each other."""
    import numpy as np
    import trimesh

    models = []
    for n in range(files):
        ball = trimesh.creation.icosphere(subdivisions, 0.4)
        waves = np.sin((3 + n % 7) * ball.vertices * 5).sum(axis=1, keepdims=True)
        ball.vertices *= 1.0 + 0.1 * waves
        path = os.path.join(folder, f"ball_{n}.stl")
        ball.export(path)
        models.append(
            f"<model name='m{n}'><static>1</static><pose>{n % 20 - 10} {n // 20 - 5} 0.5 0 0 0"
            "</pose><link name='link'><visual name='v'><geometry><mesh>"
            f"<uri>{path}</uri></mesh></geometry></visual></link></model>")
    return ("<?xml version='1.0'?><sdf version='1.6'><world name='default'>"
            f"<include><uri>model://sun</uri></include>{''.join(models)}</world></sdf>")


def orbit(page: Any, seconds: float) -> Tuple[float, float]:
    """Turn the camera with the mouse; pictures in a second, processor time of each drawing, s."""
    page.mouse.move(600, 400)
    page.mouse.down(button="middle")
    pids = chromium_pids("--type=gpu-process")
    before, used = page.evaluate("window.editor.view.pictures"), processor(pids)
    began, turn = time.perf_counter(), 0
    while time.perf_counter() - began < seconds:
        turn += 1
        page.mouse.move(600 + 200 * math.sin(turn / 30), 400)
    pictures = page.evaluate("window.editor.view.pictures") - before
    took, used = time.perf_counter() - began, processor(pids) - used
    page.mouse.up(button="middle")
    return pictures / took, used / max(pictures, 1)


def stl_files() -> List[Row]:
    rows: List[Row] = []
    for name, files, subdivisions, bar in (("one STL of 65 MB", 1, 8, 10.0),
                                           ("200 STL files of 1 MB", 200, 5, 15.0)):
        with tempfile.TemporaryDirectory() as folder, \
                Server(stl_world(folder, files, subdivisions)), browser() as page:
            first = opened(page, editor_url()) / 1e3
            began = time.perf_counter()
            wait(lambda: page.evaluate("window.editor.view.waiting === 0"), 120, "meshes")
            whole = first + time.perf_counter() - began
            wait(lambda: page.evaluate("window.editor.view.fps === 0"), 60, "rest")
            at_rest = page.evaluate("window.editor.view.drawnTriangles")
            orbit(page, 2.0)  # compiles shaders
            rate, drawing = orbit(page, 6.0)
            turning = page.evaluate("window.editor.view.drawnTriangles")
        rows += [(f"{name}: page load to first picture", f"{first:.2f} s", "3 s", first <= 3),
                 (f"{name}: all drawn", f"{whole:.2f} s", "-", True),
                 (f"{name}: pictures while the camera turns",
                  f"{rate:.1f} /s, {drawing * 1e3:.0f} ms of processor time",
                  f"{bar:.0f} /s", rate >= bar),
                 (f"{name}: triangles of a picture with its shadows",
                  f"{turning} while the camera turns, {at_rest} at rest", "-", True)]
    return rows


SPY = """() => { const {connection} = window.editor;
const ask = connection.request.bind(connection);
connection.request = (type, fields) => {
  if (type === 'edit') window.target = fields.op.poses?.dragged;
  return ask(type, fields); };
window.addEventListener('pointerup', () => {
  window.released = performance.timeOrigin + performance.now(); }, {capture: true}); }"""


class Poller:
    """Asks where a model is, all the time, in a thread."""

    def __init__(self, name: str) -> None:
        import rospy
        from gazebo_msgs.srv import GetModelState

        self.seen: List[Tuple[float, float, float]] = []
        self._ask = rospy.ServiceProxy("/gazebo/get_model_state", GetModelState, persistent=True)
        self._name = name
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self) -> None:
        while not self._stop.wait(0.001):
            place = self._ask(self._name, "").pose.position
            self.seen.append((time.time(), place.x, place.y))

    def reached(self, target: List[float], since: float) -> Optional[float]:
        """Seconds from `since` to the first answer that says `target`."""
        for when, x, y in list(self.seen):
            if when >= since and abs(x - target[0]) + abs(y - target[1]) < 1e-5:
                return when - since
        return None

    def close(self) -> None:
        self._stop.set()
        self._thread.join()


def release() -> List[Row]:
    took = []
    with Server(EMPTY), browser() as page:
        opened(page, editor_url())
        page.evaluate("window.editor.actions.edit({kind: 'insert', shape: 'box', name: 'dragged', "
                      "pose: [0, 0, 0.5, 0, 0, 0, 1]})")
        wait(lambda: page.evaluate("Boolean(window.editor.store.model('dragged'))"), 10, "box")
        page.evaluate("window.editor.actions.pause(), window.editor.actions.translateMode(), null")
        page.evaluate(SPY)
        poller = Poller("dragged")
        try:
            for n in range(15):
                took.append(_drag(page, poller, 1 if n % 2 else -1))
        finally:
            poller.close()
    middle = statistics.median(took) * 1e3
    return [("mouse release to get_model_state", f"{middle:.0f} ms median, "
             f"{max(took) * 1e3:.0f} ms most", "50 ms", middle <= 50)]


def _drag(page: Any, poller: Poller, way: int) -> float:
    """Drag the box by its body; s from the release to the first answer with the new pose."""
    x, y = page.evaluate("window.editor.view.pixelOf('dragged')")
    page.mouse.move(x, y)
    page.mouse.down()
    for step in range(1, 9):
        page.mouse.move(x + way * 12 * step, y)
    page.evaluate("window.target = null")
    page.mouse.up()
    wait(lambda: page.evaluate("window.target"), 10, "end of the drag")
    target, released = page.evaluate("[window.target, window.released / 1e3]")
    wait(lambda: poller.reached(target, released) is not None, 10, "pose")
    return float(poller.reached(target, released) or 0.0)


ROWS: Rows = {
    "page": page_load, "idle": idle, "frames": frames, "moving": moving,
    "meshes": meshes, "slow": slow_page, "stl": stl_files, "release": release}

if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as home:
        # Its own home: no thumbnails, autosaves or added folders of the user's.
        os.environ["HOME"] = home
        shown_with_ros(ROWS, __doc__)
