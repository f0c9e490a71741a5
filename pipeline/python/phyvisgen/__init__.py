"""PhyVisGen from Python: scenes and tasks that are stepped, environments that Gymnasium and lerobot know, records, evaluation.

`import phyvisgen` registers an environment per task of the program, such as `phyvisgen/WeighBeaker-v0`, and
`phyvisgen/Task-v0` for any task file (`gymnasium.make("phyvisgen/Task-v0", task="my_task.yaml")`).
"""

from gymnasium.envs.registration import register, registry

from .environment import EVALUATION_SEED, TaskEnvironment
from .program import find_program, find_scene, find_task, scenes, tasks
from .scene_facts import Body, Contacts, Forces, Joint, SceneFacts
from .server import Answer, Column, Facts, ServeError, Server, World
from .simulation import Simulation, StepFailure
from .vector import TaskVectorEnvironment

__all__ = [
    "EVALUATION_SEED",
    "Answer",
    "Body",
    "Column",
    "Contacts",
    "Facts",
    "Forces",
    "Joint",
    "SceneFacts",
    "ServeError",
    "Server",
    "Simulation",
    "StepFailure",
    "TaskEnvironment",
    "TaskVectorEnvironment",
    "World",
    "environment_id",
    "find_program",
    "find_scene",
    "find_task",
    "scenes",
    "tasks",
]


def environment_id(task: str) -> str:
    """weigh_beaker -> phyvisgen/WeighBeaker-v0"""
    return "phyvisgen/" + "".join(word.capitalize() for word in task.split("_")) + "-v0"


def _register() -> None:
    entry = "phyvisgen.environment:TaskEnvironment"
    together = "phyvisgen.vector:TaskVectorEnvironment"
    if "phyvisgen/Task-v0" not in registry:
        register("phyvisgen/Task-v0", entry_point=entry, vector_entry_point=together)
    try:
        known = tasks()
    except FileNotFoundError:  # the program may be named later; any task can be made by phyvisgen/Task-v0
        return
    for name, file in known.items():
        if environment_id(name) not in registry:
            register(environment_id(name), entry_point=entry, vector_entry_point=together, kwargs={"task": str(file)})


_register()
