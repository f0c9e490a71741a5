"""What becomes of a server whose client is interrupted, forked, threaded, dropped or wrong about the program."""

import gc
import multiprocessing
import os
import pickle
import signal
import tempfile
import threading
import time
import unittest
import warnings
from pathlib import Path

import numpy as np

import phyvisgen
from phyvisgen.counted import counted
from small_task import TASK


def ask_and_linger(server, answers, release):
    try:
        server.observe(False)
        answers.put("answered")
    except phyvisgen.ServeError as error:
        answers.put(str(error))
    release.wait(60)


class Interrupted(unittest.TestCase):
    def test_an_answer_that_was_not_waited_for_is_no_later_requests(self):
        def interrupt(*_):
            raise KeyboardInterrupt

        before = signal.signal(signal.SIGALRM, interrupt)
        self.addCleanup(signal.signal, signal.SIGALRM, before)
        with phyvisgen.Server(TASK, render=False) as server:
            server.reset(1, 0)
            rows = np.tile(server.state().arrays["a"], (2000, 1))
            signal.setitimer(signal.ITIMER_REAL, 0.05)
            with self.assertRaises(KeyboardInterrupt):
                server.follow(rows)
            with self.assertRaisesRegex(phyvisgen.ServeError, "was interrupted .* start a new one"):
                server.reset(1, 0)

    def test_a_killed_program_is_named(self):
        with phyvisgen.Server(TASK, render=False) as server:
            server._connection._process.kill()
            for _ in range(2):
                with self.assertRaisesRegex(phyvisgen.ServeError, "the server ended .signal SIGKILL."):
                    server.reset(1, 0)


class Shared(unittest.TestCase):
    def test_a_forked_process_is_refused_and_holds_up_nothing(self):
        fork = multiprocessing.get_context("fork")
        answers, release = fork.Queue(), fork.Event()
        server = phyvisgen.Server(TASK, render=False)
        server.reset(1, 0)
        child = fork.Process(target=ask_and_linger, args=(server, answers, release))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of forks beside threads
            child.start()
        self.assertIn("started by another process", answers.get(timeout=60))
        self.assertEqual(server.observe(False).head["n_steps"], 0)
        closing = threading.Thread(target=server.close, daemon=True)
        closing.start()
        closing.join(30)
        self.assertFalse(closing.is_alive())  # though the child still holds the pipe
        release.set()
        child.join()

    def test_threads_get_their_own_answers(self):
        with phyvisgen.Server(TASK, render=False, worlds=2) as server:
            expected = [server.world(i).reset(1, i).arrays["environment_state"] for i in range(2)]
            wrong = []

            def observe(i):
                for _ in range(200):
                    if not np.array_equal(server.world(i).observe(False).arrays["environment_state"], expected[i]):
                        wrong.append(i)

            threads = [threading.Thread(target=observe, args=(i,), daemon=True) for i in range(2)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join(60)
            self.assertEqual((wrong, [thread.is_alive() for thread in threads]), ([], [False, False]))

    def test_it_cannot_be_pickled(self):
        with phyvisgen.Server(TASK, width=32, height=24) as server:
            with self.assertRaisesRegex(TypeError, "neither pickled nor copied; make it.*in the process that uses it"):
                pickle.dumps(server)


class Dropped(unittest.TestCase):
    def test_what_is_not_closed_leaves_no_process_and_no_file(self):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ResourceWarning)
            gc.collect()
            before = set(os.listdir("/proc/self/fd"))
            server = phyvisgen.Server(TASK, width=32, height=24)
            process = server._connection._process.pid
            del server
            gc.collect()
        self.assertEqual(set(os.listdir("/proc/self/fd")), before)
        deadline = time.monotonic() + 30
        while time.monotonic() < deadline and os.waitpid(process, os.WNOHANG) == (0, 0):
            time.sleep(0.01)
        self.assertLess(time.monotonic(), deadline)


class Program(unittest.TestCase):
    def serve(self, script):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        program = Path(folder.name) / "phyvisgen"
        program.write_text(script)
        program.chmod(0o755)
        phyvisgen.Server(TASK, render=False, program=program).close()

    def greet(self, head):
        self.serve(f"#!/bin/sh\nprintf '\\{len(head):03o}\\000\\000\\000\\000\\000\\000\\000%s' '{head}'\ncat > /dev/null\n")

    def test_what_is_no_program_of_this_version_is_named(self):
        with self.assertRaisesRegex(phyvisgen.ServeError, "phyvisgen cannot be started .*; set PHYVISGEN_PROGRAM"):
            self.serve("\0")
        with self.assertRaisesRegex(phyvisgen.ServeError, "does not answer as `phyvisgen serve` does"):
            self.greet("hello")
        with self.assertRaisesRegex(phyvisgen.ServeError, "speaks protocol 7, this package 1; update the older"):
            self.greet('{"protocol": 7}')
        with self.assertRaisesRegex(phyvisgen.ServeError, "program, 0.1, does not say 'columns'.*whichever is older"):
            self.greet('{"protocol": 1, "program": "0.1"}')


class Requests(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = phyvisgen.Server(TASK, render=False)

    @classmethod
    def tearDownClass(cls):
        cls.server.close()

    def test_a_request_that_cannot_be_sent_loses_nothing(self):
        start = self.server.reset(1, 0).arrays["agent_pos"]
        for error, sentence, call in (
            (ValueError, "`step` holds what is not a finite number", lambda: self.server.step(start * np.nan)),
            (ValueError, "`step` holds what is not a finite number", lambda: self.server.request("step", action=[np.inf])),
            (ValueError, "takes [0-9]+ bytes, it may take 16777216; ask for fewer", lambda: self.server.follow(np.full((10**6, 9), 0.1))),
            (ValueError, "array of 2 dimensions is needed, this one has 1", lambda: self.server.follow(start)),
            (ValueError, "array of 1 dimension is needed, this one has 0", lambda: self.server.step(0.1)),
            (TypeError, "integer", lambda: self.server.reset(1.7, 0)),
            (TypeError, "neither a number, a text nor an array", lambda: self.server.request("step", action=TASK)),
            (phyvisgen.ServeError, "makes no pictures", lambda: self.server.step(start, pictures=True)),
            (phyvisgen.ServeError, "no camera of that name", lambda: self.server.step(start, pictures="back")),
            (phyvisgen.ServeError, "may be 1000 at most", lambda: self.server.step(start + 1e300)),
            (phyvisgen.ServeError, "`world` is a whole number from 0 to 0", lambda: self.server.request("observe", world=3)),
        ):
            with self.assertRaisesRegex(error, sentence):
                call()
        after = self.server.observe(False)
        self.assertEqual((after.head["n_steps"], after.events), (0, []))

    def test_numbers_of_numpy_are_numbers(self):
        start = self.server.reset(np.int64(1), np.uint8(0)).arrays["agent_pos"]
        (answer,) = self.server.together([{"do": "step", "world": np.int64(0), "action": start.astype(np.float32)}])
        self.assertGreater(answer.head["n_steps"], 0)
        with phyvisgen.Server(TASK, render=False, perturb={"friction": np.float64(0.5)}) as server:
            self.assertEqual(server.facts.task, "push_beaker")


class Words(unittest.TestCase):
    def test_a_number_has_its_noun(self):
        self.assertEqual([counted(n, "episode") for n in (0, 1, 2)], ["0 episodes", "1 episode", "2 episodes"])
        self.assertEqual([counted(n, "vertex", "vertices") for n in (1, 2)], ["1 vertex", "2 vertices"])


if __name__ == "__main__":
    unittest.main()
