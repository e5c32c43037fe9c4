"""Several clients at once: every call gets its own right answer."""
import io
import struct
import threading
import time

import rosgraph
import rospy
import support
from gazebo_msgs.srv import GetModelState, GetModelStateRequest
from rosgraph_msgs.msg import Clock
from support import pose

from my_simulations.ros.service_connection import ServiceConnection

CLIENTS, ROUNDS = 8, 15
FLOOD = 20000
"""Requests that are sent without waiting for an answer."""


class ParallelClients(support.GazeboCase):
    def tearDown(self):
        self.gazebo.clear()

    def in_parallel(self, work):
        """Run work(client number, own proxies) in every client; its faults are the test's."""
        faults = []

        def run(number):
            try:
                work(number, support.Gazebo(persistent=number % 2 == 0))
            except Exception as fault:
                faults.append(fault)

        threads = [threading.Thread(target=run, args=(n,)) for n in range(CLIENTS)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(2 * support.SECONDS)
            self.assertFalse(thread.is_alive(), "a client was never answered")
        if faults:
            raise faults[0]

    def test_each_client_sees_its_own_models_come_and_go(self):
        def work(number, gazebo):
            for n in range(ROUNDS):
                name, x = f"box_{number}_{n}", 3.0 * number
                answer = gazebo.spawn(name, where=pose(x, 0.0, 0.1))
                assert answer.success, answer.status_message
                assert name in gazebo.names()
                assert gazebo.place(name, pose(x + 1.0, 5.0, 0.1)).success
                found = gazebo.get_model_state(name, "")
                assert abs(found.pose.position.y - 5.0) < 0.01, found
                assert gazebo.delete_model(name).success
                assert name not in gazebo.names()

        self.in_parallel(work)
        self.assertEqual(self.gazebo.names(), ["ground_plane"])

    def test_of_many_spawns_of_one_name_one_wins(self):
        results, lock = [], threading.Lock()

        def work(number, gazebo):
            answer = gazebo.spawn("contested", where=pose(number, 0.0, 0.1))
            with lock:
                results.append((answer.success, answer.status_message))

        self.in_parallel(work)
        self.assertEqual(sum(success for success, _ in results), 1, results)
        self.assertEqual(self.gazebo.names().count("contested"), 1)

    def test_of_many_deletes_of_one_model_one_wins(self):
        self.gazebo.spawn("contested")
        results, lock = [], threading.Lock()

        def work(_number, gazebo):
            answer = gazebo.delete_model("contested")
            with lock:
                results.append(answer.success)

        self.in_parallel(work)
        self.assertEqual(sum(results), 1)

    def test_a_flood_of_requests_stops_neither_time_nor_others(self):
        self.gazebo.spawn("box")
        self.gazebo.unpause_physics()
        arrived = []
        clock = rospy.Subscriber("/clock", Clock, lambda _: arrived.append(time.monotonic()),
                                 queue_size=None)
        support.wait_for(lambda: arrived, "the clock")
        begun, before = time.monotonic(), self.gazebo.sim_time()
        counts, others = [], []
        clients = [threading.Thread(target=flooded, args=(FLOOD // CLIENTS, counts))
                   for _ in range(CLIENTS)]
        for client in clients:
            client.start()
        while any(client.is_alive() for client in clients):
            asked = time.monotonic()
            self.assertLess(asked, begun + 10 * support.SECONDS, "the flood has no end")
            self.assertIn("box", self.gazebo.names())
            others.append(time.monotonic() - asked)
        took, advanced = time.monotonic() - begun, self.gazebo.sim_time() - before
        clock.unregister()
        seen = [begun, *(at for at in arrived if begun < at < begun + took), begun + took]
        print(f"{FLOOD} requests in {took:.1f} s, meanwhile {advanced:.1f} s of sim time; longest"
              f" without a clock message {max(b - a for a, b in zip(seen, seen[1:])):.2f} s,"
              f" longest wait of another client {max(others):.2f} s")
        self.assertEqual(counts, [FLOOD // CLIENTS] * CLIENTS)
        self.assertGreater(advanced, 0.0)
        self.assertGreater(len(others), 1)


def flooded(count, counts):
    """Send that many requests at once, read the answers, and add how many succeeded to `counts`."""
    connection = ServiceConnection(rosgraph.get_master_uri(), rospy.get_name(),
                                   "/gazebo/get_model_state", GetModelState)
    try:
        body = io.BytesIO()
        GetModelStateRequest("box", "").serialize(body)
        request = struct.pack("<I", len(body.getvalue())) + body.getvalue()
        sender = threading.Thread(target=connection._socket.sendall, args=(request * count,))
        sender.start()
        good = 0
        for _ in range(count):
            done = connection._exactly(1)
            answer = GetModelState._response_class().deserialize(connection._receive_bytes())
            good += done == b"\1" and answer.success
        sender.join()
        counts.append(good)
    finally:
        connection.close()
