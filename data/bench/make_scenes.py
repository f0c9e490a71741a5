#!/usr/bin/env python3
"""Writes the scenes of the family `block`: a soft block on a table, pressed by a plate, in four resolutions.

Run in this folder: ./make_scenes.py
"""

BLOCKS = {"block_1k": (6, 6, 5), "block_4k": (9, 9, 8), "block_16k": (14, 14, 14), "block_64k": (22, 22, 22)}

SCENE = """\
# A soft block of {tetrahedra} linear tetrahedra on a table, pressed by a plate that comes down at 0.1 m/s.
schema: 1
name: {name}
time_step: 10 ms
duration: 0.1 s
gravity: [0, 0, -9.81]
contact: {{activation_distance: 0.5 mm, stiffness: 1 MPa, friction_lag_passes: 1, friction_velocity: 1 mm/s}}
solver: {{velocity_tolerance: 1 mm/s}}
bodies:
  - {{name: table, kind: half_space, point: [0, 0, 0], normal: [0, 0, 1], friction: 0.5}}
  - {{name: plate, kind: moving, shape: {{box: {{size: [0.14, 0.14, 0.01]}}}}, friction: 0.5, pose: {{position: [0, 0, 0.1061]}}, velocity: [0, 0, -0.1]}}
  - name: block
    kind: soft
    shape: {{bar: {{size: [0.1, 0.1, 0.1], divisions: [{x}, {y}, {z}], nodes_per_element: 4}}}}
    material: {{density: 1000, youngs_modulus: 100 kPa, poisson_ratio: 0.45}}
    friction: 0.5
    pose: {{position: [0, 0, 0.0504]}}
"""

for name, (x, y, z) in BLOCKS.items():
    with open(name + ".yaml", "w") as file:
        file.write(SCENE.format(name=name, x=x, y=y, z=z, tetrahedra=6 * x * y * z))
