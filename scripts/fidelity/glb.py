"""Binary glTF files as this program writes them: numbers of 32 bits, one after the other."""
import json
import struct

import numpy as np


def read_glb(path):
    """The file's JSON, and a function from the number of an accessor to its array [n x 3]"""
    data = path.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    gltf, blob = json.loads(data[20:20 + length]), data[28 + length:]

    def array(index):
        accessor = gltf["accessors"][index]
        view = gltf["bufferViews"][accessor["bufferView"]]
        kind = {5125: "<u4", 5126: "<f4"}[accessor["componentType"]]
        n = accessor["count"] * {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
        return np.frombuffer(blob, kind, n, view.get("byteOffset", 0) + accessor.get("byteOffset", 0)).reshape(-1, 3)
    return gltf, array
