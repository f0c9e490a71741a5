"""Started by check_openpi.sh: a server that packs and unpacks with openpi-client and stays where it is."""

import threading
from pathlib import Path

import numpy as np
from openpi_client import msgpack_numpy
from websockets.sync.server import serve

import phyvisgen
from phyvisgen.evaluation import evaluate
from phyvisgen.openpi import OpenPiPolicy

TASK = Path(__file__).resolve().parents[1] / "tests/pipeline/small_task/push_beaker.yaml"
HORIZON = 4
asked = []


def answer(connection):
    packer = msgpack_numpy.Packer()
    connection.send(packer.pack({"policy": "stays"}))
    for frame in connection:
        asked.append(msgpack_numpy.unpackb(frame))
        actions = np.repeat(asked[-1]["observation/state"][None], HORIZON, axis=0)
        connection.send(packer.pack({"actions": actions, "server_timing": {"infer_ms": 0.1}}))


with serve(answer, "localhost", 0, compression=None) as server:
    threading.Thread(target=server.serve_forever, daemon=True).start()
    url = f"ws://localhost:{server.socket.getsockname()[1]}"
    with phyvisgen.Server(TASK, width=32, height=24) as task:
        policy = OpenPiPolicy(url, "push the beaker", ("front",))
        result = evaluate(task, policy, episodes=2, length=6)
        policy.close()
    server.shutdown()
assert policy.metadata == {"policy": "stays"}, policy.metadata
assert len(asked) == 4, len(asked)  # 6 periods by chunks of 4, twice
assert asked[0]["observation/images/front"].shape == (24, 32, 3)
assert asked[0]["observation/images/front"].dtype == np.uint8
assert asked[0]["observation/state"].dtype == np.float32
assert result.n_successes == 0 and all(episode.periods == 6 for episode in result.episodes)
print("openpi-client: 2 episodes, 4 chunks, every array as it was sent")
