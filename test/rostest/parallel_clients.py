"""Several clients at once: every call gets its own right answer."""
import threading
import unittest

import support
from support import pose

CLIENTS, ROUNDS = 8, 15


class ParallelClients(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()

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
