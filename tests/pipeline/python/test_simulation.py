"""Scenes stepped from Python: the bits of `simulate`, numbers by hand, views, mistakes."""

import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

import phyvisgen
from small_task import TASK

DATA = Path(__file__).resolve().parents[3] / "data/validation"
G = 9.80665  # [m/s^2] of these scenes
HEAD = """
schema: 1
name: small
time_step: 10 ms
gravity: [0, 0, -9.80665]
contact: {activation_distance: 1 mm, stiffness: 10 MPa, friction_velocity: 1e-6}
solver: {velocity_tolerance: 1e-8, cg_tolerance: 1e-8}
"""
# an arm that drives turn, which pushes a box over the floor into a towel
PUSH = HEAD + """
duration: 0.2 s
bodies:
  - {name: floor, kind: half_space}
  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, pose: {position: [0, 0, 0.2]}, collides: false}
  - {name: arm, kind: rigid, shape: {box: {size: [0.02, 0.02, 0.2]}}, mass: 0.2, pose: {position: [0, 0, 0.13]}}
  - {name: cube, kind: rigid, shape: {box: {size: [0.04, 0.04, 0.04]}}, mass: 0.1, pose: {position: [-0.04, 0, 0.0205]}}
  - name: pad
    kind: soft
    shape: {bar: {size: [0.02, 0.04, 0.02], divisions: [1, 2, 1], nodes_per_element: 4}}
    material: {density: 1000, youngs_modulus: 100 kPa, poisson_ratio: 0.3}
    pose: {position: [-0.09, 0, 0.0105]}
joints:
  - name: hinge
    type: revolute
    parent: base
    child: arm
    child_frame: {position: [0, 0, 0.07]}
    axis: [0, 1, 0]
    drive: {stiffness: 50, damping: 1, target: [0, 20 deg], target_times: [0, 0.2]}
"""


def serve(scene, **options):
    return phyvisgen.Simulation(scene, render=options.pop("render", False), **options)


class Written(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write(self, text, name="scene.yaml"):
        (self.folder / name).write_text(text)
        return self.folder / name


class Bits(Written):
    def simulated(self, scene):
        file = self.folder / "states.h5"
        subprocess.run([phyvisgen.find_program(), "simulate", scene, "-o", file], check=True, capture_output=True)
        return h5py.File(file)

    def compare(self, simulation, record, step):
        same = np.testing.assert_array_equal
        self.assertEqual(simulation.time, record["time"][step])
        same(simulation.poses, record["T_rigid"][step])
        same(simulation.nodes("pad"), record["X_deform/pad"][step])
        same(simulation.joints, record["joint/position"][step])
        same(simulation.targets, record["a"][step])
        contacts, forces = simulation.contacts(), simulation.forces()
        of_step = slice(*record["contact/offset"][step : step + 2])
        for name in ("bodies", "kind", "points", "normal", "gap", "normal_force", "friction_force"):
            same(getattr(contacts, name), record[f"contact/{name}"][of_step])
        same(forces.force, record["force/net"][step])
        same(forces.moment, record["force/torque"][step])
        same(forces.drive, record["joint/drive"][step])

    def test_a_scene_has_the_bits_of_simulate_whatever_was_done_before(self):
        scene = self.write(PUSH)
        with self.simulated(scene) as record, serve(scene) as simulation:
            touching = 0
            for step in range(10):
                simulation.step()
                self.compare(simulation, record, step)
                touching += len(simulation.contacts())
            self.assertGreater(touching, 0)
            simulation.step(10)
            self.compare(simulation, record, 19)
            simulation.step(7, targets=[-0.3])
            self.assertNotEqual(simulation.joints[0], record["joint/position"][19, 0])
            simulation.reset()
            self.assertEqual((simulation.time, simulation.n_steps, len(simulation.contacts())), (0.0, 0, 0))
            simulation.step(targets=record["a"][:20])  # those of a record are those of its steps
            self.compare(simulation, record, 19)

    def test_a_failed_step_leaves_it_as_it_was(self):
        with serve(self.write(PUSH)) as simulation, serve(self.write(PUSH)) as other:
            for each in (simulation, other):
                each.step(5)
            before = simulation.poses.copy(), simulation.contacts().normal_force.copy()
            with self.assertRaisesRegex(phyvisgen.StepFailure, "small.* s") as failure:
                simulation.step(targets=[100.0])
            self.assertEqual((failure.exception.n_done, simulation.n_steps), (0, 5))
            np.testing.assert_array_equal(simulation.poses, before[0])
            np.testing.assert_array_equal(simulation.contacts().normal_force, before[1])
            with self.assertRaises(phyvisgen.StepFailure) as failure:
                simulation.step(targets=[[0.1], [0.1], [100.0], [0.1]])
            self.assertEqual((failure.exception.n_done, simulation.n_steps), (2, 7))
            other.step(2, targets=[0.1])
            for each in (simulation, other):
                each.step(8)
            np.testing.assert_array_equal(simulation.poses, other.poses)
            np.testing.assert_array_equal(simulation.positions, other.positions)

    def test_a_socket_brings_the_same_arrays(self):
        scene, path = self.write(PUSH), self.folder / "scene.sock"
        process = subprocess.Popen(
            [phyvisgen.find_program(), "serve", scene, "--no-render", "--socket", path], stderr=subprocess.PIPE
        )
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        self.assertIn(b"serves small", process.stderr.readline())
        with serve(scene) as own:
            own.step(8)
            for _ in range(2):  # the second client begins anew
                with phyvisgen.Simulation(socket=path) as simulation:
                    simulation.step(8)
                    held = simulation.positions
                    np.testing.assert_array_equal(held, own.positions)
                    np.testing.assert_array_equal(simulation.velocities, own.velocities)
                    np.testing.assert_array_equal(simulation.contacts().points, own.contacts().points)
                    simulation.step()
                    simulation.positions
                    self.assertGreater(np.abs(held - simulation.positions).max(), 0)  # a view of the answer lasts


class Hand(Written):
    def test_a_block_at_rest_weighs_on_the_floor(self):
        with serve(DATA / "weight.yaml") as simulation:
            simulation.step(80)
            contacts, forces = simulation.contacts(), simulation.forces()
            for body, mass in (("box", 1.0), ("block", 0.064)):
                force, _ = forces.on(body)
                self.assertLess(np.abs(force - [0, 0, mass * G]).max(), 1e-3 * mass * G)
                normal, friction = contacts.between(body, "floor")
                np.testing.assert_allclose(normal + friction, force, atol=1e-12)
                np.testing.assert_array_equal(contacts.between("floor", body)[0], -normal)
            self.assertLess(abs(forces.on("floor")[0][2] + 1.064 * G), 1e-3 * 1.064 * G)
            self.assertLess(np.abs(forces.on("box")[1]).max(), 1e-3 * G * 0.05)
            np.testing.assert_array_equal(contacts.between("box", "block")[0], 0)
            self.assertLess(np.abs(simulation.velocities).max(), 1e-4)
            self.assertEqual(simulation.intersection(), "")

    def test_friction_holds_a_block_on_a_slope(self):
        scene = self.write(HEAD + """
bodies:
  - {name: slope, kind: half_space, normal: [1, 0, 2], friction: 0.7}
  - name: cube
    kind: rigid
    shape: {box: {size: [0.1, 0.1, 0.1]}}
    density: 1000
    friction: 0.7
    pose: {position: [0.022808, 0, 0.045616], rotation: [0, 0.46364760900080609, 0]}
""")
        up = np.array([1, 0, 2]) / 5**0.5  # normal of the slope, whose tangent is 0.5
        along = np.array([-2, 0, 1]) / 5**0.5
        with serve(scene) as simulation:
            simulation.step(60)
            normal, friction = simulation.contacts().between("cube", "slope")
            np.testing.assert_allclose(normal, G * up * 2 / 5**0.5, atol=1e-3 * G)  # m g cos
            np.testing.assert_allclose(friction, G * along / 5**0.5, atol=1e-3 * G)  # m g sin, up the slope
            contacts = simulation.contacts()
            np.testing.assert_allclose(contacts.normal, np.tile(up, (len(contacts), 1)), atol=1e-6)

    def test_a_free_fall_is_that_of_implicit_euler(self):
        with serve(DATA / "free_fall.yaml") as simulation:
            h = simulation.facts.time_step
            for n in (1, 6, 13):
                simulation.step(n - simulation.n_steps)
                self.assertAlmostEqual(simulation.pose("box")[2, 3], -G * h * h * n * (n + 1) / 2, 12)
                np.testing.assert_allclose(simulation.velocity("box"), [0, 0, -G * h * n, 0, 0, 0], atol=1e-9)

    def test_a_body_that_turns_and_moves_has_its_velocities(self):
        scene = self.write(HEAD + """
bodies:
  - {name: wheel, kind: moving, shape: {box: {size: [0.1, 0.1, 0.1]}}, velocity: [0.3, 0, 0], angular_velocity: [0, 0, 2]}
""")
        with serve(scene) as simulation:
            simulation.step(2)
            np.testing.assert_allclose(simulation.velocity("wheel")[:3], [0.3, 0, 0], atol=1e-12)
            # a turn by 0.02 rad in a step of 10 ms, of which backward differences see the sine over 0.02
            np.testing.assert_allclose(simulation.velocity("wheel")[3:], [0, 0, 2], rtol=1e-3, atol=1e-12)
            np.testing.assert_allclose(simulation.pose("wheel")[:, 3], [0.006, 0, 0], atol=1e-12)

    def test_a_weight_hangs_in_its_joint(self):
        scene = self.write(HEAD + """
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}, collides: false}
  - {name: weight, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 2, pose: {position: [0.3, 0, 0]}, collides: false}
joints:
  - {name: weld, type: fixed, parent: base, child: weight, child_frame: {position: [-0.3, 0, 0]}}
""")
        with serve(scene) as simulation:
            simulation.step(100)
            force, moment = simulation.forces().in_joint("weld")
            np.testing.assert_allclose(force, [0, 0, -2 * G], atol=1e-3 * 2 * G)
            np.testing.assert_allclose(moment, [0, 0.3 * 2 * G, 0], atol=1e-3 * 0.6 * G)

    def test_no_load_of_a_sliding_joint_is_known(self):
        with serve(DATA / "drive.yaml") as simulation:
            simulation.step(150)
            self.assertTrue(np.isnan(simulation.forces().in_joint("rail")[0]).all())
            drive = simulation.forces().drive[1]
            self.assertLess(abs(drive - 0), 1.001 * G)
            self.assertAlmostEqual(simulation.joint("rail"), simulation.joints[1])


class Views(Written):
    def test_views_are_of_shared_memory_read_only_and_hold_until_the_next_step(self):
        simulation = serve(self.write(PUSH))
        simulation.step(3)
        positions, pad = simulation.positions, simulation.nodes("pad")
        self.assertTrue(np.shares_memory(positions, pad))
        self.assertTrue(np.shares_memory(simulation.nodes("pad"), pad))  # asked twice, answered once
        self.assertEqual((positions.shape, simulation.velocities.shape), ((12, 3), (12, 3)))
        self.assertFalse(positions.flags.owndata)
        with self.assertRaises(ValueError):
            positions[0] = 0
        kept = positions.copy()
        simulation.contacts()
        simulation.forces()
        np.testing.assert_array_equal(positions, kept)
        simulation.step(3)
        np.testing.assert_array_equal(positions, kept)  # until the state is asked for again
        now = simulation.positions
        np.testing.assert_array_equal(positions, now)
        self.assertGreater(np.abs(now - kept).max(), 0)
        simulation.close()
        self.assertTrue(np.isfinite(positions).all())  # and after the end
        with self.assertRaisesRegex(phyvisgen.ServeError, "was closed"):
            simulation.step()

    def test_memory_grows_to_what_an_answer_takes(self):
        scene = self.write(HEAD + """
bodies:
  - name: block
    kind: soft
    shape: {bar: {size: [0.1, 0.1, 0.1], divisions: [12, 12, 12], nodes_per_element: 4}}
    material: {density: 1000, youngs_modulus: 100 kPa, poisson_ratio: 0.3}
    velocity: [0.5, 0, 0]
""")
        with serve(scene) as simulation:
            n = 13**3
            self.assertGreater(n * 6 * 8, 1 << 16)  # what it begins with
            self.assertEqual(simulation.positions.shape, (n, 3))
            self.assertEqual(np.ptp(simulation.positions, axis=0).max(), 0.1)
            np.testing.assert_array_equal(simulation.velocities, np.tile([0.5, 0, 0], (n, 1)))

    def test_pictures_are_those_of_render(self):
        scene = self.write(PUSH)
        small = {"width": 48, "height": 32, "samples": 2}
        words = [f"--{name}={value}" for name, value in small.items()]
        picture, states = self.folder / "picture.png", self.folder / "states.h5"
        program = phyvisgen.find_program()
        subprocess.run([program, "simulate", scene, "-o", states], check=True, capture_output=True)
        with serve(scene, render=True, **small) as simulation:
            self.assertEqual(simulation.facts.cameras, {"overview": (48, 32)})
            for frame, source in ((0, []), (4, ["--states", states, "--fps", "100", "--frames", "4"])):
                if source:
                    simulation.step(frame + 1)
                subprocess.run([program, "render", scene, *source, *words, "-o", picture], check=True, capture_output=True)
                rgb = subprocess.run(
                    ["ffmpeg", "-v", "error", "-i", picture, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
                    check=True, capture_output=True,
                ).stdout
                seen = simulation.render()
                self.assertGreater(np.ptp(seen), 0)
                np.testing.assert_array_equal(seen, np.frombuffer(rgb, np.uint8).reshape(32, 48, 3))


class Mistakes(Written):
    def test_a_mistake_is_one_sentence_and_changes_nothing(self):
        with serve(self.write(PUSH)) as simulation:
            simulation.step(2)
            before = simulation.poses.copy()
            for sentence, call in (
                ("no body `lid`; it has floor, base, arm, cube, pad", lambda: simulation.pose("lid")),
                ("pad, of kind soft, has no pose; ask nodes", lambda: simulation.pose("pad")),
                ("cube, of kind rigid, has no nodes; ask pose", lambda: simulation.nodes("cube")),
                ("no joint `elbow`; it has hinge", lambda: simulation.joint("elbow")),
                ("no body `lid`", lambda: simulation.forces().on("lid")),
                (r"targets has the shape \(2,\); the scene has 1 joint with", lambda: simulation.step(targets=[0.1, 0.2])),
                (r"the shape \(3, 1\)", lambda: simulation.step(2, targets=[[0.1]] * 3)),
                ("not a finite number", lambda: simulation.step(targets=[np.nan])),
                ("asked for 0 steps", lambda: simulation.step(0)),
                ("may take 16777216; ask for fewer steps", lambda: simulation.step(10**6, targets=[np.pi / 9])),
                ("no camera `front`; it has overview", lambda: simulation.render("front")),
            ):
                with self.assertRaisesRegex(ValueError, sentence):
                    call()
            with self.assertRaisesRegex(TypeError, "integer"):
                simulation.step(2.7)
            with self.assertRaisesRegex(phyvisgen.ServeError, "makes no pictures"):
                simulation.render()
            self.assertEqual(simulation.n_steps, 2)
            np.testing.assert_array_equal(simulation.poses, before)

    def test_what_cannot_be_served_says_why(self):
        with self.assertRaisesRegex(phyvisgen.ServeError, "push_beaker is a task; step it with phyvisgen.Server"):
            serve(TASK)
        with self.assertRaisesRegex(phyvisgen.ServeError, "free_fall is a scene; step it with phyvisgen.Simulation"):
            phyvisgen.Server(DATA / "free_fall.yaml", render=False)
        with self.assertRaisesRegex(phyvisgen.ServeError, "scene.yaml:.*gravitas"):
            serve(self.write(HEAD + "gravitas: 1\n"))
        overlapping = HEAD + "bodies:\n" + "".join(
            f"  - {{name: {name}, kind: rigid, shape: {{box: {{size: [0.1, 0.1, 0.1]}}}}, mass: 1}}\n" for name in "ab"
        )
        with self.assertRaisesRegex(phyvisgen.ServeError, "a and b.*intersect at the start"):
            serve(self.write(overlapping))
        with self.assertRaisesRegex(FileNotFoundError, "neither a scene file nor one of .*two_arms"):
            serve("ballet")
        words = [phyvisgen.find_program(), "serve", DATA / "free_fall.yaml", "--worlds", "2"]
        done = subprocess.run(words, capture_output=True, stdin=subprocess.DEVNULL)
        self.assertEqual(done.returncode, 2)
        self.assertTrue(re.search(rb"--worlds is for tasks; .*free_fall.yaml is a scene", done.stderr), done.stderr)


if __name__ == "__main__":
    unittest.main()
