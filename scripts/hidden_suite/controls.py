"""Controls of the hidden-effect suite: recordings in which something is wrong that is no effect, so nothing may be named.
Each is a function (experiment, number of the run, times, rng) -> what the table says was measured.
"""
import math


def other_command(experiment, number, times, rng, samples_of):
    """The angle of a joint that follows another command than the one the table says: that of its neighbour."""
    start, length, _, role = experiment.runs[number]
    amplitude, rate, phase = rng.uniform(0.2, 0.5), rng.uniform(0.3, 1.5), rng.uniform(0, 2 * math.pi)
    neighbour = lambda t: amplitude * (math.sin(2 * math.pi * rate * max(t, 0) + phase) - math.sin(phase))
    return samples_of(experiment, (start, length, neighbour, role), {}, times, rng)


def other_run(experiment, number, times, rng, samples_of):
    """What was measured in the next run, beside the command of this one."""
    start, _, command, role = experiment.runs[(number + 1) % len(experiment.runs)]
    return samples_of(experiment, (start, times[-1], command, role), {}, times, rng)


def shuffled_times(experiment, number, times, rng, samples_of):
    """The rows of a table in any order."""
    return rng.permutation(samples_of(experiment, experiment.runs[number], {}, times, rng))


CONTROLS = [("driven", other_command), ("driven", other_run), ("driven", shuffled_times), ("pendulum", shuffled_times),
            ("flight", shuffled_times)]
