"""The client of OpenPI policies, against a server of their own messages."""

import socket
import threading
import unittest
from unittest.mock import Mock

import numpy as np

import phyvisgen
from phyvisgen.server import Answer
from small_task import TASK


class OpenPi(unittest.TestCase):
    def test_chunks_of_a_server_are_done_in_order(self):
        try:
            from websockets.sync.server import serve

            from phyvisgen.openpi import OpenPiPolicy, pack, unpack
        except ImportError as error:
            self.skipTest(str(error))
        asked = []

        def answer(connection):
            connection.send(pack({"name": "test"}))
            for frame in connection:
                asked.append(unpack(frame))
                state = asked[-1]["observation/state"]
                connection.send(pack({"actions": np.stack([state + k for k in range(3)])}))

        class Recorder:
            class facts:
                steps_per_period = 1

            def __init__(self):
                self.actions = []

            def step(self, action, pictures):
                self.actions.append(action)
                return seen

        seen = phyvisgen.Answer(
            {}, {"agent_pos": np.array([1.0, 2.0]), "environment_state": np.zeros(7), "pictures/front": np.zeros((4, 4, 3), np.uint8)}
        )
        with serve(answer, "localhost", 0, compression=None) as server:
            thread = threading.Thread(target=server.serve_forever)
            thread.start()
            port = server.socket.getsockname()[1]
            policy = OpenPiPolicy(f"ws://localhost:{port}", "push the beaker", ("front",), executed=2)
            self.assertEqual(policy.metadata, {"name": "test"})
            recorder = Recorder()
            for _ in range(3):
                policy.step(recorder, seen)
            policy.close()
            server.shutdown()
            thread.join()
        np.testing.assert_array_equal(recorder.actions, [[1, 2], [2, 3], [1, 2]])
        self.assertEqual(len(asked), 2)
        self.assertEqual(asked[0]["prompt"], "push the beaker")
        self.assertEqual(asked[0]["observation/images/front"].shape, (4, 4, 3))

    def test_actions_that_are_none_are_refused(self):
        try:
            from phyvisgen.openpi import OpenPiPolicy, pack
        except ImportError as error:
            self.skipTest(str(error))
        policy = OpenPiPolicy.__new__(OpenPiPolicy)
        policy.name, policy._prompt, policy._executed = "ws://there", "", None
        seen = Answer({}, {"agent_pos": np.zeros(2), "environment_state": np.zeros(0)})
        for wrong in ([], [[]], "left", [[1, np.nan]], [[[1.0]]], [[1.0], [1.0, 2.0]]):
            policy._socket = Mock(recv=Mock(return_value=pack({"actions": wrong})))
            with self.assertRaisesRegex(phyvisgen.ServeError, "ws://there answered `actions` that are no rows"):
                policy._ask(seen)

    def test_a_server_of_policies_that_cannot_be_reached_is_named(self):
        try:
            from websockets.sync.server import serve

            from phyvisgen.openpi import OpenPiPolicy
        except ImportError as error:
            self.skipTest(str(error))
        with socket.socket() as free:
            free.bind(("localhost", 0))
            port = free.getsockname()[1]  # bound, but nothing listens
            with self.assertRaisesRegex(
                phyvisgen.ServeError, f"ws://localhost:{port}: .*no program listens.*; start the server.*--policy ws://HOST:PORT"
            ) as refused:
                OpenPiPolicy(f"ws://localhost:{port}", "")
        self.assertNotIn("Errno", str(refused.exception))
        for address in ("ws://", "ws://localhost:abc", "ws://localhost:99999"):
            with self.assertRaisesRegex(ValueError, f"--policy {address} is no address; write ws://HOST:PORT"):
                OpenPiPolicy(address, "")
        with serve(lambda connection: connection.close(), "localhost", 0, compression=None) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            with self.assertRaisesRegex(phyvisgen.ServeError, "does not speak OpenPI's protocol.*; start the server"):
                OpenPiPolicy(f"ws://localhost:{server.socket.getsockname()[1]}", "")
            server.shutdown()

    def test_a_socket_on_which_no_server_listens_is_named(self):
        with self.assertRaisesRegex(phyvisgen.ServeError, "socket /nowhere/task .*; start one there: phyvisgen serve TASK"):
            phyvisgen.Server(socket="/nowhere/task")


if __name__ == "__main__":
    unittest.main()
