"""Cases of separate_names.py: systems of scenario_systems.py whose recorded runs are so alike that names are confused, each
with another motion, load or command that would tell them apart. A case is a function of a random generator that returns the
scenario and what is wrong: name, target, parameters, names that no motion, command or load can tell from it: the same law,
or one that contains it. Of a wrong number of the scene the parameters are its key in `numbers` and a change.
"""
from scenario_systems import Run, carriage, flight, hung, pendulum, sampled, slide

LENGTH = 1.6  # of the recorded runs [s]


def with_runs(scenario, starts, length=LENGTH):
    """All runs released from rest, the last one held out; only the first sensor, at a usual rate, its noise told."""
    scenario.runs = [Run(tuple(start), length, is_released=True) for start in starts]
    scenario.runs[-1].role = "held_out"
    scenario.sensors = scenario.sensors[:1]
    for sensor in scenario.sensors:
        sensor.rate, sensor.jitter = 100, 0.0
    return scenario


def effect_of(scenario, name, target, same):
    _, at, parameters, _ = next(e for e in scenario.singles if e[0] == name and target in ("", e[1]))
    return name, at, parameters, same


def small_swings(rng, name, target, same):
    """A pendulum that was released from nearly the same angle each time."""
    scenario = with_runs(pendulum(rng), [(q, 0.0) for q in rng.uniform(0.42, 0.5, 3) * [1, -1, 1]])
    return scenario, effect_of(scenario, name, target, same)


def small_bounces(rng, name, target, same):
    """A weight on a spring, released equally far from its rest, without a load."""
    scenario = hung(rng)
    rest = -scenario.numbers["mass"] * 9.81 / scenario.numbers["stiffness"]
    scenario = with_runs(scenario, [(rest + s, 0.0) for s in rng.uniform(0.035, 0.045, 3) * [1, -1, 1]])
    if name == "retune_drive_stiffness":
        return scenario, (name, "guide", {"stiffness": 0.05}, same)
    return scenario, effect_of(scenario, name, target, same)


def equal_speeds(rng, name, target, same):
    """A carriage that was moved at one speed."""
    scenario = carriage(rng)
    speed = rng.uniform(0.08, 0.12)
    ramp = lambda sign, begin: (lambda t: sign * speed * max(t - begin, 0.0))
    scenario.runs = [Run((0.0, 0.0), LENGTH, sampled(ramp(sign, begin), LENGTH, 100), "fit", True) for sign, begin in ((1, 0.1), (-1, 0.3))]
    scenario.runs.append(Run((0.0, 0.0), LENGTH, sampled(ramp(1, 0.5), LENGTH, 100), "held_out", True))
    scenario.sensors[0].rate, scenario.sensors[0].jitter = 100, 0.0
    return scenario, effect_of(scenario, name, target, same)


def one_ball(rng, name, target, same):
    """A ball that is thrown, always the same one: a force along gravity is another gravity."""
    scenario = flight(rng)
    throw = lambda: (0.0, 0.0, rng.uniform(0.8, 1.5), rng.uniform(2, 4), rng.uniform(-1, 1), rng.uniform(1, 3))
    scenario.runs = [Run(throw(), 0.6, is_released=False) for _ in range(3)]
    scenario.runs[-1].role = "held_out"
    scenario.sensors[0].rate, scenario.sensors[0].jitter = 100, 0.0
    parameters = {"gravity": 0.02} if name == "retune_gravity" else {"x": 0.0, "y": 0.0, "z": 0.03}
    return scenario, (name, target, parameters, same)


def one_block(rng, name, target, same):
    """A block that slides, always the same one: a tilt pulls as a steady force does."""
    scenario = slide(rng)
    scenario.runs = [Run((0, 0, *v), 0.5) for v in ((1.0, 0.1), (0.1, 1.1), (-0.8, 0.7))]
    scenario.runs[-1].role = "held_out"
    scenario.sensors[0].rate, scenario.sensors[0].jitter = 100, 0.0
    return scenario, (name, target, {"about_x": 0.01, "about_y": 0.01}, same)


# make, effect, target, size in units of the noise, names that are the same law or contain it
CASES = {
    "swings_quadratic_drag": (small_swings, "quadratic_drag", "", 4, []),
    "swings_coulomb": (small_swings, "joint_coulomb_friction", "", 4, ["joint_stribeck_friction"]),
    "swings_stribeck": (small_swings, "joint_stribeck_friction", "", 4, []),
    "swings_spring": (small_swings, "joint_spring", "", 6, []),
    "swings_tilt": (small_swings, "gravity_tilt", "", 6, ["bias", "center_of_mass_offset"]),
    "bounces_payload": (small_bounces, "payload_mass", "", 10, ["retune_mass"]),
    "bounces_stiffness": (small_bounces, "retune_drive_stiffness", "", 10, ["actuator_gain", "joint_spring"]),
    "bounces_quadratic_drag": (small_bounces, "quadratic_drag", "", 4, []),
    "bounces_coulomb": (small_bounces, "joint_coulomb_friction", "", 4, ["joint_stribeck_friction"]),
    "carriage_coulomb": (equal_speeds, "joint_coulomb_friction", "", 6, ["joint_stribeck_friction"]),
    "carriage_viscous": (equal_speeds, "joint_viscous_friction", "", 6, ["linear_drag"]),
    "carriage_payload": (equal_speeds, "payload_mass", "", 6, ["retune_mass", "rotor_inertia", "retune_inertia"]),
    "ball_constant_force": (one_ball, "constant_force", "ball", 6, []),
    "ball_gravity": (one_ball, "retune_gravity", "scene", 6, ["length_scale", "clock_rate"]),
    "block_tilt": (one_block, "gravity_tilt", "scene", 6, []),
}
