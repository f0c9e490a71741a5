#!/usr/bin/env python3
"""Tunes MuJoCo models by mujoco.sysid on rigid cases of the hidden suite, and prints what it says of them.

    python3 -m venv out/sysid && out/sysid/bin/pip install "mujoco[sysid]>=4.0" pyyaml
    out/sysid/bin/python scripts/hidden_suite/compare_mujoco_sysid.py data/hidden/{flight,pendulum,slide,tracked,driven}_*

The toolbox fits the numbers that its caller lists. Listed here are the numbers of MuJoCo's own model that can change what a
case measures, all at once, and the start of each fitting run. Left out is what these measurements leave free whatever they
are, a factor on all efforts and inertias: the depth of a pendulum's centre, the armature of a driven joint. The held-out run
is judged whole; its start alone is fitted to it, with the numbers of the scene and with those that were found. Residuals are
in units of the noise that the recording states. A case prints the root mean square of the residuals, processor seconds of
the fit, and each number with its interval of 95 %.
"""
import argparse
import contextlib
import csv
import os
import pathlib
import time

import mujoco
import numpy as np
import yaml
from mujoco import sysid

STEP = 1e-3  # of MuJoCo's simulation [s]
LONGEST_DELAY = 0.05  # of a sensor, that is searched [s]

HINGE = """<mujoco><option timestep="{step}" integrator="implicitfast" gravity="{gravity}"/><worldbody><body name="body">
<joint name="joint" type="hinge" axis="{axis}"/>
<geom type="box" size="0.05 0.05 0.05" pos="{centre}" mass="1" contype="0" conaffinity="0"/>
<site name="marker" pos="0.04 0.02 -0.15"/></body></worldbody>{actuator}<sensor>{sensor}</sensor></mujoco>"""
# the second actuator acts on the commanded rate, as the damping of the scene's drive does
DRIVE = """<actuator><position name="position" joint="joint" kp="20"/>
<velocity name="rate" joint="joint" kv="0.6"/></actuator>"""
FLIGHT = """<mujoco><option timestep="{step}" integrator="RK4"/><worldbody><body name="body"><freejoint name="joint"/>
<geom type="sphere" size="0.05" mass="0.2" contype="0" conaffinity="0" fluidshape="ellipsoid" fluidcoef="0.5 0 0 0 0"/>
</body></worldbody><sensor>{sensor}</sensor></mujoco>"""
# With this softness the block sinks in by 0.01 mm; on stiffer contacts it hops by some mm when it starts to slide. The cone
# is the same in all directions.
SLIDE = """<mujoco><option timestep="{step}" integrator="implicitfast" cone="elliptic" impratio="10"/><worldbody>
<geom name="floor" type="plane" size="5 5 0.1"/><body name="body"><joint name="joint" type="free"/>
<geom name="block" type="box" size="0.05 0.05 0.02" mass="0.4"/></body></worldbody><contact>
<pair geom1="floor" geom2="block" friction="0.3 0.3 0 0 0" condim="3" solref="0.02 1" solimp="0.99 0.99 0.001"/></contact>
<sensor>{sensor}</sensor></mujoco>"""
SENSORS = {  # by the kind of body; a marker's comes after the joint's
    "joint": '<jointpos name="q" joint="joint"/>',
    "marker": '<framepos name="marker" objtype="site" objname="marker"/>',
    "body": '<framepos name="place" objtype="body" objname="body"/>',
}


def of_joint(key):
    """Writes a number of the joint; of damping and stiffness, polynomials, the linear coefficient."""

    def write(spec, p):
        numbers = np.atleast_1d(getattr(spec.joint("joint"), key)).astype(float)
        numbers[0] = p.value[0]
        setattr(spec.joint("joint"), key, numbers if numbers.size > 1 else numbers[0])

    return write


def of_gravity(axis):
    def write(spec, p):
        gravity = np.array(spec.option.gravity)
        gravity[axis] = p.value[0]
        spec.option.gravity = gravity

    return write


def of_option(key):
    return lambda spec, p: setattr(spec.option, key, p.value[0])


def write_centre(spec, p):
    geom = spec.body("body").geoms[0]
    geom.pos = np.r_[p.value[0], geom.pos[1:]]


def write_friction(spec, p):
    spec.pairs[0].friction = [p.value[0], p.value[0], 0, 0, 0]


def write_stiffness_of_drive(spec, p):
    sysid.apply_pgain(spec, "position", p.value[0])


def write_damping_of_drive(spec, p):
    actuator = spec.actuator("rate")
    actuator.gainprm[0], actuator.biasprm[2] = p.value[0], -p.value[0]


# name, value of the scene, lowest, highest, how it is written
JOINT = [
    ("damping", 0, 0, 1, of_joint("damping")),
    ("frictionloss", 0, 0, 1, of_joint("frictionloss")),
    ("stiffness", 0, 0, 5, of_joint("stiffness")),
]
GRAVITY_XY = [("gravity_x", 0, -3, 3, of_gravity(0)), ("gravity_y", 0, -3, 3, of_gravity(1))]
NUMBERS = {  # by the name of the scene
    "pendulum": JOINT + [("armature", 0, 0, 0.1, of_joint("armature")), ("centre_x", 0, -0.05, 0.05, write_centre)],
    "driven_joint": JOINT + [("kp", 20, 1, 400, write_stiffness_of_drive), ("kv", 0.6, 0, 12, write_damping_of_drive)],
    "flight": GRAVITY_XY + [("gravity_z", -9.81, -15, -5, of_gravity(2)), ("density", 0, 0, 100, of_option("density")),
                            ("viscosity", 0, 0, 2, of_option("viscosity"))],
    "slide": [("friction", 0.3, 0.01, 2, write_friction)] + GRAVITY_XY,
}
MODELS = {
    "pendulum": HINGE.replace("{gravity}", "0 0 -9.81").replace("{axis}", "0 1 0").replace("{centre}", "0 0 -0.2").replace(
        "{actuator}", ""),
    "driven_joint": HINGE.replace("{gravity}", "0 0 0").replace("{axis}", "0 0 1").replace("{centre}", "0.15 0 0").replace(
        "{actuator}", DRIVE),
    "flight": FLIGHT,
    "slide": SLIDE,
}


class Case:
    """A recording, its MuJoCo model, and what is tuned."""

    def __init__(self, folder):
        recording = yaml.safe_load((folder / "recording.yaml").read_text())
        name = yaml.safe_load((folder / "scene.yaml").read_text())["name"]
        if name not in MODELS:
            raise SystemExit(f"{folder}: the scene `{name}` has no MuJoCo model here; take one of {', '.join(MODELS)}")
        channels = recording["channels"]
        self.columns = [column for c in channels for column in c.get("columns", [c.get("column")])]
        self.noise = np.array([c["noise"] for c in channels for _ in c.get("columns", [0])])
        self.command = recording["inputs"][0]["column"] if "inputs" in recording else None
        has_marker = any(c["kind"] == "marker" for c in channels)
        self.n_places = {"slide": 2, "flight": 3}.get(name, 1)  # numbers that say where a run starts
        sensor = SENSORS["body"] if self.n_places > 1 else SENSORS["joint"] + (SENSORS["marker"] if has_marker else "")
        self.text = MODELS[name].format(step=STEP, sensor=sensor)
        self.numbers = list(NUMBERS[name])
        # of the joint's sensor, against the marker or the command; without these a delay is another start
        self.has_delay = has_marker or self.command is not None
        if self.has_delay:
            self.numbers.append(("delay", 0, -LONGEST_DELAY, LONGEST_DELAY, None))
        self.first_time = LONGEST_DELAY if self.has_delay else STEP  # what is earlier may not have been simulated
        self.runs = [Run(self, folder, run) for run in recording["runs"]]


class Run:
    """One run of a case: its table, its start, and the toolbox's residual of it."""

    def __init__(self, case, folder, entry):
        self.case, self.name, self.is_held_out = case, entry["file"].split(".")[0], entry["role"] == "held_out"
        with open(folder / entry["file"]) as file:
            rows = list(csv.DictReader(file))
        column = lambda name: np.array([float(row[name] or "nan") for row in rows])
        self.times = column("t")
        self.measured = np.column_stack([column(name) for name in case.columns])
        self.is_used = ~np.isnan(self.measured) & (self.times >= case.first_time)[:, None]
        self.spec = mujoco.MjSpec.from_string(case.text)
        model = self.spec.compile()
        grid = np.arange(0, self.times[-1] + 2 * LONGEST_DELAY, STEP)
        control = np.zeros((len(grid), model.nu))
        if case.command:
            command = column(case.command)
            control[:, 0] = np.interp(grid, self.times[~np.isnan(command)], command[~np.isnan(command)])
            control[:, 1] = np.gradient(control[:, 0], STEP)
        self.start = self.first_start()
        sequence = sysid.ModelSequences(
            self.name, self.spec, self.name, sysid.create_initial_state(model, *self.state_of(self.start)),
            sysid.TimeSeries(grid, control, sysid.TimeSeries.compute_all_control_mapping(model)),
            sysid.TimeSeries(self.times, self.measured, sysid.TimeSeries.compute_all_sensor_mapping(model)))
        self.residual = sysid.build_residual_fn(
            models_sequences=[sequence], modify_residual=self.difference, custom_rollout=self.roll, n_threads=1)

    def first_start(self):
        """Places, then velocities, by a parabola through the first tenth of a second."""
        lines = []
        for y in self.measured.T[: self.case.n_places]:
            early = (self.times < 0.1) & ~np.isnan(y)
            lines.append(np.polyfit(self.times[early], y[early], 2))
        return np.array([line[2] for line in lines] + [line[1] for line in lines])

    def start_parameter(self):
        width = np.repeat([0.1, 2.0], self.case.n_places)  # wide enough for a delay
        return sysid.Parameter(f"start of {self.name}", self.start, self.start - width, self.start + width)

    def state_of(self, start):
        """qpos and qvel of a start; bodies do not turn, and one that slides starts on the floor."""
        place, velocity = np.split(np.asarray(start), 2)
        if self.case.n_places == 1:
            return place, velocity
        if self.case.n_places == 2:
            place, velocity = np.r_[place, 0.02], np.r_[velocity, 0]
        return np.r_[place, 1, 0, 0, 0], np.r_[velocity, 0, 0, 0]

    def roll(self, models, datas, control_signal, initial_states, param_dicts, **mappings):
        starts = [
            sysid.create_initial_state(model, *self.state_of(params[f"start of {self.name}"].value))
            for model, params in zip(models, param_dicts)
        ]
        return sysid.sysid_rollout(models, datas, control_signal, starts, **mappings)

    def difference(self, params, predicted, measured, model, return_all, state=None):
        """Residuals [n_times, n_columns] in units of the noise; 0 in gaps."""
        residual = np.zeros_like(self.measured)
        for k in range(residual.shape[1]):
            delay = params["delay"].value[0] if self.case.has_delay and k == 0 else 0
            seen = np.interp(self.times - delay, predicted.times, predicted.data[:, k])
            residual[:, k] = (seen - self.measured[:, k]) / self.case.noise[k]
        residual[~self.is_used] = 0
        return residual, measured, measured


def parameters(case, runs, values):
    """The starts of these runs; without `values` the numbers of the model too, else they are written into the models."""
    params = sysid.ParameterDict()
    for name, value, low, high, write in case.numbers:
        params.add(sysid.Parameter(name, value if values is None else values[name], low, high, values is not None, write))
        if values is not None and write:  # the toolbox writes no frozen ones
            for run in runs:
                write(run.spec, params[name])
    for run in runs:
        params.add(run.start_parameter())
    return params.move_off_bounds()  # as the toolbox advises


def fit(case, runs, values=None, optimizer="mujoco"):
    """What the optimizer found, its residuals, and its result; with `values` of the numbers starts alone are fitted."""

    def residual(x, params):
        parts = [run.residual(x, params) for run in runs]
        return tuple([one for part in parts for one in part[k]] for k in range(3))

    more = {} if optimizer == "mujoco" else {"x_scale": "jac"}
    with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere):
        found, result = sysid.optimize(parameters(case, runs, values), residual, optimizer, False, max_iters=100, **more)
    return found, np.concatenate([np.ravel(one) for one in residual(found.as_vector(), found)[0]]), result


def rms(residual, runs):
    return float(np.sqrt(np.sum(residual**2) / sum(np.count_nonzero(run.is_used) for run in runs)))


def report(folder, optimizer):
    case = Case(folder)
    fitted, held_out = ([run for run in case.runs if run.is_held_out == h] for h in (False, True))
    begin = time.process_time()
    found, residual, result = fit(case, fitted, None, optimizer)
    seconds = time.process_time() - begin
    _, half_widths = sysid.calculate_intervals([residual[residual != 0]], np.asarray(result.jac))
    before = rms(fit(case, held_out, {name: value for name, value, *_ in case.numbers}, optimizer)[1], held_out)
    values = {name: float(found[name].value[0]) for name, *_ in case.numbers}
    after = rms(fit(case, held_out, values, optimizer)[1], held_out)
    print(f"{folder.name}: fit {rms(residual, fitted):.3g}, held out {before:.4g} to {after:.4g} noise, {seconds:.1f} s")
    for (name, value, low, high, _), half in zip(case.numbers, half_widths):
        is_at_bound = min(values[name] - low, high - values[name]) < 1e-6 * (high - low)
        print(f"    {name:13} {value:8.4g} to {values[name]:11.5g} +- {half:.2g}{'  at a bound' if is_at_bound else ''}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", type=pathlib.Path, nargs="+")
    parser.add_argument("--optimizer", choices=["mujoco", "scipy", "scipy_parallel_fd"], default="mujoco", help="of the toolbox")
    options = parser.parse_args()
    for folder in options.cases:
        report(folder, options.optimizer)


if __name__ == "__main__":
    main()
