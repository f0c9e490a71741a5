#!/usr/bin/env python3
"""Compares imported MJCF files with MuJoCo: angles of the same file, simulated by both.

    scripts/python_env.sh mujoco mujoco numpy h5py
    .venv-mujoco/bin/python scripts/compare_mujoco.py build/bin/phyvisgen

Three models without contact: a pendulum, two links with armature, damping and a spring, and a position servo with kv
and a limited force. Each is simulated with a step and with half of it; MuJoCo's own result, by its Runge-Kutta
integrator with a step of 0.1 ms, is the reference. Exit code 1 where the largest error of an angle is above 2 mrad at
the smaller step, or does not fall by at least 1.7 when the step is halved: a wrong number of the import would leave an
error that does not depend on the step.
"""
import pathlib
import subprocess
import sys
import tempfile

import h5py
import mujoco
import numpy

DURATION = 1.0  # [s]
STEPS = (1e-3, 5e-4)  # [s]
REFERENCE_STEP = 1e-4  # [s]

PENDULUM = """
<mujoco model="pendulum"><option timestep="{step}"/><worldbody>
  <body name="bob" pos="0 0 1"><joint name="hinge" axis="0 1 0"/>
    <geom type="capsule" size="0.03" fromto="0 0 0 0.4 0 0" contype="0" conaffinity="0"/></body>
</worldbody></mujoco>"""

TWO_LINKS = """
<mujoco model="two_links"><option timestep="{step}"/><compiler angle="radian"/>
<default><joint damping="0.1"/><geom contype="0" conaffinity="0"/></default><worldbody>
  <body name="upper" pos="0 0 1" euler="0.1 0.2 0.3"><joint name="shoulder" axis="0 1 0" armature="0.02"/>
    <geom type="box" size="0.2 0.03 0.02" pos="0.2 0 0"/>
    <body name="lower" pos="0.4 0 0" quat="0.9 0.1 0 0.2">
      <joint name="elbow" axis="1 1 0" pos="0.02 0 0" armature="0.05" stiffness="2" springref="0.3"/>
      <inertial pos="0.1 0.01 0" mass="0.7" fullinertia="0.002 0.006 0.007 0.0005 0.0002 0.0001"/>
    </body></body>
</worldbody></mujoco>"""

SERVO = """
<mujoco model="servo"><option timestep="{step}"/><worldbody>
  <body name="arm" pos="0 0 1"><joint name="shoulder" axis="0 1 0" armature="0.03"/>
    <geom type="cylinder" size="0.03" fromto="0 0 0 0.5 0 0" mass="1.2" contype="0" conaffinity="0"/></body>
</worldbody><actuator><position joint="shoulder" kp="30" kv="2" forcerange="-5 5"/></actuator></mujoco>"""

MODELS = {"pendulum": PENDULUM, "two_links": TWO_LINKS, "servo": SERVO}


def reference(text):
    """rotations of the bodies [n, bodies, 3, 3], every REFERENCE_STEP from time 0; MuJoCo"""
    model = mujoco.MjModel.from_xml_string(text.format(step=REFERENCE_STEP))
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    rotations = []
    for _ in range(round(DURATION / REFERENCE_STEP) + 1):
        mujoco.mj_kinematics(model, data)
        rotations.append(data.xmat[1:].reshape(-1, 3, 3).copy())
        mujoco.mj_step(model, data)
    return numpy.array(rotations)


def imported(program, text, step, folder):
    """times [n, s] and the same rotations from `phyvisgen simulate`, whose last body is the world"""
    scene, states = folder / "model.xml", folder / "model.h5"
    scene.write_text(text.format(step=step))
    states.unlink(missing_ok=True)
    subprocess.run([program, "simulate", scene, "--duration", str(DURATION), "-o", states], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with h5py.File(states) as file:
        return file["time"][()], file["T_rigid"][:, :-1, :, :3]


def angle_between(first, second):
    """of two rotations [..., 3, 3, rad]"""
    apart = numpy.einsum("...ji,...jk->...ik", first, second)
    axis = numpy.stack([apart[..., 2, 1] - apart[..., 1, 2], apart[..., 0, 2] - apart[..., 2, 0],
                        apart[..., 1, 0] - apart[..., 0, 1]], axis=-1)
    return numpy.arctan2(numpy.linalg.norm(axis, axis=-1), numpy.trace(apart, axis1=-2, axis2=-1) - 1)


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else "build/bin/phyvisgen"
    is_good = True
    for name, text in MODELS.items():
        expected = reference(text)
        errors = []
        with tempfile.TemporaryDirectory() as folder:
            for step in STEPS:
                times, rotations = imported(program, text, step, pathlib.Path(folder))
                at = expected[numpy.rint(times / REFERENCE_STEP).astype(int)]
                errors.append(angle_between(at, rotations).max())
        span = angle_between(expected[:1], expected).max()
        good = errors[1] < 2e-3 and errors[0] > 1.7 * errors[1]
        is_good = is_good and good
        print(f"{name}: moves by {span:.3f} rad; largest error {1e3 * errors[0]:.3f} mrad at {1e3 * STEPS[0]:g} ms, "
              f"{1e3 * errors[1]:.3f} mrad at {1e3 * STEPS[1]:g} ms{'' if good else '  <- too much'}")
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
