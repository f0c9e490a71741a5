"""Scene and task files: what is no YAML, keys, numbers, units, names, and what contradicts itself."""
from table import DONE, FAILED, WRONG_USE, append, cut, edit, link, make_folder, remove, row, write

N = WRONG_USE
SCENE, TASK = "simulate scene.yaml -o s.h5", "generate task.yaml -o o --no-render"

# ---- no file, or none of this kind
for command, file, need in ((SCENE, "scene.yaml", "scene"), (TASK, "task.yaml", "task"),
                            ("render scene.yaml -o p.png", "scene.yaml", "scene"),
                            ("submit task.yaml -n 2 -o o", "task.yaml", "task")):
    row("no such file", command, N, f"{file}.*no such", remove(file), needs=need)
    row("a folder instead of a file", command, N, file, remove(file), make_folder(file), needs=need)
    row("an empty file", command, N, file, write(file), needs=need)
    row("bytes that are no text", command, N, file, write(file, bytes(range(256)) * 20), needs=need)
    row("a file that is cut off", command, N, file, cut(file, 0.5), needs=need)
    row("a link that leads nowhere", command, N, file, remove(file), link(file, "nowhere"), needs=need)
    row("a link to itself", command, N, file, remove(file), link(file, file), needs=need)
    row("a device without end", command, N, file, remove(file), link(file, "/dev/zero"), needs=need)
    row("a list instead of keys", command, N, f"{file}.*mapping", write(file, "- a\n- b\n"), needs=need)
    row("a word instead of keys", command, N, f"{file}.*mapping", write(file, "hello\n"), needs=need)
    row("a pipe that nobody writes to", command, N, file, shell=f"rm {file}; mkfifo {file}; exec $B {command}",
        needs=need, changes=[file])
for name, content in (("tabs", "schema: 1\n\tname: x\n"), ("an open bracket", "schema: [1\n"), ("an open quote", 'name: "x\n'),
                      ("an unknown alias", "schema: *one\n"), ("two documents", "schema: 1\n---\nschema: 1\n"),
                      ("a NUL", "schema: 1\0\nname: x\n"), ("UTF-16", "schema: 1\n".encode("utf-16")),
                      ("an anchor that holds itself", "schema: &a [*a]\n"), ("a merge key", "base: &b {schema: 1}\n<<: *b\n"),
                      ("a key that is a list", "? [1, 2]\n: 3\n"), ("a tag", "schema: !!binary aGVsbG8=\n"),
                      ("a directive", "%YAML 9.9\n---\nschema: 1\n")):
    row(f"YAML with {name}", SCENE, N, r"scene\.yaml", write("scene.yaml", content))
LAUGHS = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]\n" for i in range(1, 10))
row("a bomb of aliases", SCENE, N, "scene.yaml", write("scene.yaml", LAUGHS + "schema: 1\nbodies: *a9\n"))
row("a bomb of aliases in a recording", "diagnose rec --check", N, "recording.yaml",
    write("rec/recording.yaml", LAUGHS + "schema: 1\nchannels: *a9\n"), needs="rec")
row("brackets a hundred thousand deep", SCENE, N, "scene.yaml", write("scene.yaml", "schema: " + "[" * 100000))
row("mappings a hundred thousand deep", SCENE, N, "scene.yaml", write("scene.yaml", "schema: " + "{a: " * 100000))
row("a line of ten million letters", SCENE, N, "scene.yaml", write("scene.yaml", "schema: " + "x" * 10**7))
row("a hundred thousand keys", SCENE, N, "scene.yaml:", append("scene.yaml", "".join(f"k{i}: 1\n" for i in range(100000))),
    needs="scene")

for name, content, line, cause in (("a colon in a value", "schema: 1\nname: a: b\n", 2, "a colon stands where none may"),
                                   ("a key further in than its neighbours", "schema: 1\n  name: x\n", 2, "same column"),
                                   ("a brace that is open", "schema: 1\nbodies:\n  - {name: a\n  - {name: b}\n", 4, "brace { is not closed"),
                                   ("a tab", "schema: 1\nbodies:\n\t- {name: a}\n", 3, "tab")):
    row(f"YAML with {name} is told the cause", SCENE, N, rf"scene\.yaml:{line}: this is not YAML: .*{cause}", write("scene.yaml", content))

# ---- keys
row("a key that is unknown", SCENE, N, r"scene.yaml:\d+:.*`colour`.*unknown", append("scene.yaml", "colour: red\n"), needs="scene")
row("a key twice", SCENE, N, r"scene.yaml:\d+:.*`duration`.*second time", append("scene.yaml", "duration: 1\n"), needs="scene")
row("a key twice within a body", SCENE, N, r"scene.yaml:\d+:.*density.*second time",
    edit("scene.yaml", "density: 1000", "density: 1000, density: 2000"), needs="scene")
for key in ("schema", "name", "time_step"):
    row(f"no `{key}`", SCENE, N, f"scene.yaml.*`{key}`.*missing", edit("scene.yaml", f"{key}:", f"x{key}:"), needs="scene")
for schema in ("2", "0", "-1", "one", "[1]", "1.5", ""):
    row(f"the schema `{schema}`", SCENE, N, "scene.yaml.*schema", edit("scene.yaml", "schema: 1", f"schema: {schema}"),
        needs="scene")
for key, value in (("bodies", "3"), ("bodies", "{a: 1}"), ("bodies", "[1, 2]"), ("bodies", "[[]]"), ("bodies", "[null]"),
                   ("gravity", "9.81"), ("gravity", "[0, 0]"), ("gravity", "[0, 0, a]"), ("gravity", "[0, 0, .nan]"),
                   ("gravity", "[0, 0, -.inf]"), ("solver", "fast"), ("contact", "[]"), ("separate", "yes"),
                   ("joints", "hinge"), ("stitches", "7")):
    row(f"{key}: {value}", SCENE, N, rf"scene.yaml:\d+:.*{key}", *( [edit("scene.yaml", "bodies:", f"{key}: {value}\nxbodies:")]
        if key == "bodies" else [append("scene.yaml", f"{key}: {value}\n")]), needs="scene")

# ---- numbers and units
for number in ("nan", ".nan", "NaN", "inf", "-.inf", "1e999", "0x10", "", "~", "ten", "1 2", "1,5 ms", "[1]", "{a: 1}", "--1",
               "1_000", "10 mm", "10 hours", "10ms ms", "-10 ms", "0", "1e99 s"):
    row(f"the time step `{number}`", SCENE, N, r"scene.yaml:\d+:.*time_step",
        edit("scene.yaml", "time_step: 10 ms", f"time_step: {number}"), needs="scene")
for old, new, key in (("density: 1000", "density: -1", "density"), ("density: 1000", "density: 0", "density"),
                      ("density: 1000", "density: 1000 kg", "density"), ("density: 1000", "mass: 0", "mass"),
                      ("density: 1000", "density: 1000, mass: 1", "density.*mass"), ("density: 1000", "friction: 1", "density.*mass"),
                      ("density: 1000", "density: 1000, friction: -1", "friction"),
                      ("density: 1000", "density: 1000, inertia: [1, 1, 3]", "inertia"),
                      ("density: 1000", "density: 1000, inertia: [0, 1, 1]", "inertia"),
                      ("[0.1, 0.1, 0.1]", "[0.1, 0.1]", "size"), ("[0.1, 0.1, 0.1]", "[0, 0.1, 0.1]", "size"),
                      ("[0.1, 0.1, 0.1]", "[-0.1, 0.1, 0.1]", "size"), ("[0.1, 0.1, 0.1]", "[1e9, 0.1, 0.1]", "size"),
                      ("{box: {size: [0.1, 0.1, 0.1]}}", "{}", "shape"),
                      ("{box: {size: [0.1, 0.1, 0.1]}}", "{cube: {size: 1}}", "shape|cube"),
                      ("{box: {size: [0.1, 0.1, 0.1]}}", "{box: {size: [0.1, 0.1, 0.1]}, sphere: {radius: 1}}", "shape|sphere"),
                      ("{box: {size: [0.1, 0.1, 0.1]}}", "{box: {size: [0.1, 0.1, 0.1], divisions: [1000000, 1000000, 1]}}", "divisions"),
                      ("{box: {size: [0.1, 0.1, 0.1]}}", "{sphere: {radius: 0.1, subdivisions: 99}}", "subdivisions"),
                      ("{box: {size: [0.1, 0.1, 0.1]}}", "{cylinder: {radius: 0.1, length: 0.1, sides: 2}}", "sides"),
                      ("{box: {size: [0.1, 0.1, 0.1]}}", "{hexahedron: {corners: [0,0,0]}}", "corners"),
                      ("position: [0, 0, 0.2]", "position: [0, 0, 1e9]", "position"),
                      ("position: [0, 0, 0.2]", "position: [0, 0, 200 deg]", "position"),
                      ("position: [0, 0, 0.2]", "position: [0, 0, 0.2], rotation: [9, 0, 0]", "rotation"),
                      ("kind: rigid", "kind: jelly", "kind.*jelly.*rigid"), ("kind: rigid, ", "", "kind"),
                      ("kind: rigid", "kind: moving, path: []", "path"),
                      ("duration: 20 ms", "duration: -1", "duration"), ("duration: 20 ms", "duration: 1e9", "duration")):
    row(f"{new} instead of {old}", SCENE, N, rf"scene.yaml:\d+:.*({key})", edit("scene.yaml", old, new), needs="scene")
row("a box in the ground", SCENE, N, "scene.yaml.*(box.*ground|ground.*box).*`pose`", edit("scene.yaml", "[0, 0, 0.2]", "[0, 0, 0]"), needs="scene")
row("friction of a pair twice", SCENE, N, r"scene.yaml.*`pair_friction`.*pair of `ground` and `box` twice",
    append("scene.yaml", "pair_friction: [{first: box, second: ground, coefficient: 0.1}, {first: ground, second: box, coefficient: 0.9}]\n"),
    needs="scene")
row("a box inside of another one", SCENE, N, "scene.yaml.*(box.*block|block.*box).*`pose`",
    append("scene.yaml", "  - {name: block, kind: static, shape: {box: {size: [1, 1, 0.3]}}, pose: {position: [0, 0, 0.2]}}\n"), needs="scene")
row("a joint of bodies that are not there", SCENE, N, r"scene.yaml:\d+:.*moon",
    append("scene.yaml", "joints: [{name: j, type: revolute, parent: box, child: moon, axis: [0, 0, 1]}]\n"), needs="scene")
row("a joint of a body with itself", SCENE, N, r"scene.yaml:\d+:.*(child|itself|parent)",
    append("scene.yaml", "joints: [{name: j, type: revolute, parent: box, child: box, axis: [0, 0, 1]}]\n"), needs="scene")
row("a joint without an axis", SCENE, N, r"scene.yaml:\d+:.*axis",
    append("scene.yaml", "joints: [{name: j, type: revolute, parent: ground, child: box, axis: [0, 0, 0]}]\n"), needs="scene")
row("two bodies of one name", SCENE, N, r"scene.yaml:\d+:.*`box`",
    append("scene.yaml", "  - {name: box, kind: rigid, shape: {sphere: {radius: 0.1}}, mass: 1, pose: {position: [1, 0, 2]}}\n"),
    needs="scene")
row("an unknown effect", SCENE, N, r"scene.yaml:\d+:.*(effect|magic)", append("scene.yaml", "effects: [{name: magic, body: box}]\n"),
    needs="scene")

# ---- names: words that may become the names of files, checked where they are read
BAD = ("../evil", "a/b", ".", "..", "a b", "ü", '"a\\nb"', '""', "n" * 65, "'a$b'", "'*'", "'\\'")
for bad in BAD:
    row(f"a body that is called {bad}", SCENE, N, r"scene.yaml:\d+:.*name", edit("scene.yaml", "name: box, kind", f"name: {bad}, kind"),
        needs="scene")
    row(f"a task that is called {bad}", TASK, N, r"task.yaml:\d+:.*name", edit("task.yaml", "name: push_beaker", f"name: {bad}"),
        needs="task")
for what, old in (("an object", "name: beaker\n"), ("a material", "{name: clay"), ("a light", "{name: above"), ("a camera", "name: front\n")):
    for bad in ("../../evil", "a/b", "n" * 65):
        new = old.split("name: ")[0] + f"name: {bad}" + ("\n" if old.endswith("\n") else "")
        row(f"{what} that is called {bad}", TASK, N, r"task.yaml:\d+:.*name.*letters", edit("task.yaml", old, new), needs="task")
row("a finger that is called ../left", TASK, N, r"gripper.yaml:\d+:.*name", edit("gripper.yaml", "- name: left", "- name: ../left"),
    needs="task")
row("a joint that is called a/b", SCENE, N, r"scene.yaml:\d+:.*name",
    append("scene.yaml", "joints: [{name: a/b, type: revolute, parent: ground, child: box, axis: [0, 0, 1]}]\n"), needs="scene")
row("a cloth that is called a/b", SCENE, N, r"scene.yaml:\d+:.*name", append("scene.yaml", "cloths: [{name: a/b, shape: {sheet: {size: "
    "[0.3, 0.2], divisions: [2, 2]}}, material: {area_density: 0.3, thickness: 2 mm, stretch_warp: 3000, bending: 2e-5}}]\n"),
    needs="scene")
row("a robot that is called a/b", TASK, N, r"task.yaml:\d+:.*name", edit("task.yaml", "\nrobot:", "\nrobots:\n  - name: a/b\n    robot:\n      x: 1\nxrobot:"),
    edit("task.yaml", "gripper: gripper.yaml", ""),
    needs="task")

# ---- cameras
for up, pattern in (("[0, 0, 0]", "`cameras.*up` must be a direction.*zero"), ("[-10, 0, -1]", "`cameras.*up` must not be parallel.*such as \\[0, 1, 0\\]"),
                    ("[10, 0, 1]", "`cameras.*up` must not be parallel")):
    row(f"a camera with up: {up}", "render shown.yaml -o p.png", N, r"shown.yaml:\d+: " + pattern, edit("shown.yaml", "up: [0, 0, 1]", f"up: {up}"),
        needs="shown")
row("a camera that looks down and has no up", "render shown.yaml -o p.png", N, r"shown.yaml:\d+: `cameras.*up` is not given.*parallel",
    edit("shown.yaml", "position: [1, 0, 0.3], look_at: [0, 0, 0.2], up: [0, 0, 1]", "position: [0, 0, 1], look_at: [0, 0, 0.2]"), needs="shown")
row("a camera that looks at itself", "render shown.yaml -o p.png", N, r"shown.yaml:\d+: `cameras.*look_at` must be another point",
    edit("shown.yaml", "look_at: [0, 0, 0.2]", "look_at: [1, 0, 0.3]"), needs="shown")
row("a camera inside of a body", "render shown.yaml -o p.png", DONE, "camera front is inside of `thing`",
    edit("shown.yaml", "position: [1, 0, 0.3]", "position: [0.01, 0.01, 0.21]"), needs="shown", makes=["p.png"])

# ---- numbers without a unit that look as if another one was meant
LIGHT = r"density` is 0.3 kg/m\^3.*Write `0.3 g/cm\^3`, or `0.3 kg/m\^3`"
row("a density that may be in g/cm^3", "simulate scene.yaml -o s.h5", DONE, r"note: .*scene.yaml:7: `bodies\[1\]." + LIGHT,
    edit("scene.yaml", "density: 1000", "density: 0.3"), needs="scene", makes=["s.h5"])
row("a density of 0.3 kg/m^3 that is meant", "simulate scene.yaml -o s.h5", DONE, r"^(?![\s\S]*note)",
    edit("scene.yaml", "density: 1000", "density: 0.3 kg/m^3"), needs="scene", makes=["s.h5"])
TURNS = r"{} holds -?90 rad.*Write `-?90 deg`, or `-?90 rad`"
for old, new, key in (("axis", "limits: [-90, 90], axis", "limits`"), ("axis", "drive: {stiffness: 1, target: 90}, axis", "drive.target`")):
    row(f"{new} of a joint that turns", "simulate scene.yaml -o s.h5", DONE, r"note: .*scene.yaml:8: `joints\[0\]." + TURNS.format(key),
        append("scene.yaml", "joints: [{name: j, type: revolute, parent: ground, child: box, axis: [0, 0, 1]}]\n"),
        edit("scene.yaml", old, new), needs="scene", makes=["s.h5"])
row("an object's density that may be in g/cm^3", "render shown.yaml -o p.png", DONE, r"note: .*shown.yaml:5: `objects\[0\]." + LIGHT,
    edit("shown.yaml", "density: 1000", "density: 0.3"), needs="shown", makes=["p.png"])

# ---- tasks
for old, new, key in (
        ("time_step: 20 ms", "time_step: 20 s", "time_step"), ("urdf: ", "urdf: nowhere/", "urdf"), ("home: [0, ", "home: [", "home"),
        ("home: [0, ", "home: [100, ", "home|joint"), ("flange: fr3_link8", "flange: fr3_link99", "fr3_link99"),
        ("collision_links: [fr3_link7]", "collision_links: [elbow]", "elbow"), ("stiffness: 1e5 N m/rad", "stiffness: 1e5 N/m", "stiffness"),
        ("stiffness: 1e5 N m/rad", "stiffness: 0", "stiffness"), ("gripper: gripper.yaml", "gripper: none.yaml", "gripper"),
        ("gripper: gripper.yaml", "", "gripper"), ("gripper: gripper.yaml", "gripper: .", "gripper"),
        ("friction: 0.3", "friction: slippery", "friction"), ("density: 2230 kg/m^3", "density: 2230 kg/m", "density"),
        ("material: clay", "material: gold", "gold"), ("x: [0.420, 0.424]", "x: [0.424, 0.420]", "x"),
        ("x: [0.420, 0.424]", "x: [1, 2, 3]", "x"), ("x: [0.420, 0.424]", "object: beaker", "beaker"),
        ("do: approach", "do: jump", "do.*jump.*approach"), ("object: beaker", "object: cup", "cup"), ("speed: 0.5", "speed: 0", "speed"),
        ("speed: 0.5", "speed: -1", "speed"), ("quantity: tilt, of: beaker", "quantity: tilt, of: moon", "moon"),
        ("quantity: tilt", "quantity: joy", "quantity.*joy"), ("at_most: 20 deg", "at_most: 20 mm", "at_most"),
        ("at_most: 20 deg", "at_most: 20", "at_most.*180 deg"),
        ("at_most: 20 deg", "", "at_most|at_least"), ("at_most: 20 deg", "at_most: 20 deg, at_least: 30 deg", "at_least.*at_most"), ("edge_v: [0.6, 0, 0]", "edge_v: [0, 0.6, 0]", "edge"),
        ("radiance: [12, 12, 12]", "radiance: [-1, 0, 0]", "radiance"), ("radiance: [12, 12, 12]", "radiance: [0, 0, 0]", "radiance"), ("color: [0.55, 0.30, 0.20]", "color: [2, 0, 0]", "color"),
        ("kind: diffuse, color: [0.55", "kind: shiny, color: [0.55", "kind.*shiny"), ("width: 64", "width: 63", "width.*even"),
        ("width: 64", "width: 0", "width"), ("vertical_field_of_view: 44 deg", "vertical_field_of_view: 0", "vertical_field_of_view"),
        ("look_at: [0.40, 0, 0.06]", "look_at: [0.9, -0.5, 0.3]", "look_at"), ("frames_per_second: 10", "frames_per_second: 0", "frames_per_second"),
        ("frames_per_second: 10", "frames_per_second: 11", "11|frames"), ("samples: 1,", "samples: 0,", "samples"),
        ("environment: [0.6, 0.6, 0.6]", "environment_map: {file: sky.exr}", "sky.exr"),
        ("cameras:", "xcameras:", "cameras"), ("success:", "xsuccess:", "success"), ("motion:", "xmotion:", "motion|xmotion")):
    row(f"{new or 'nothing'} instead of {old}", TASK, N, rf"(task|gripper).yaml.*({key})", edit("task.yaml", old, new), needs="task")
row("a target out of reach", TASK, FAILED, "episode 0 failed:.*(reach|joints allow)", edit("task.yaml", "[-60 mm, 0, 60 mm]", "[9, 0, 60 mm]"),
    needs="task", makes=["o"])
for old in ("[-60 mm, 0, 60 mm]", "[-16.5 mm, 0, 60 mm]"):
    row(f"a target inside of the table instead of {old}", TASK, FAILED, r"episode 0 failed: .*task.yaml:\d+.*target is \d+ mm inside of `table`",
        edit("task.yaml", old, old.replace("60 mm]", "-20 mm]")), needs="task", makes=["o"], seconds=60)
row("a target under the table", TASK, FAILED, r"episode 0 failed: .*task.yaml:\d+.*pass through `table`.*move the target",
    edit("task.yaml", "[-60 mm, 0, 60 mm]", "[-60 mm, 0, -100 mm]"), needs="task", makes=["o"])
row("objects in one another", TASK, FAILED, "episode 0 failed: .*(beaker.*table|table.*beaker)", edit("task.yaml", "z: 0.5 mm", "z: -20 mm"), needs="task",
    makes=["o"])
for old, new, key in (("mesh: finger.obj", "mesh: none.obj", "none.obj"), ("poisson_ratio: 0.4}", "poisson_ratio: 0.5}", "poisson_ratio"),
                      ("youngs_modulus: 10 MPa", "youngs_modulus: 0", "youngs_modulus"), ("carriage: left_carriage", "carriage: moon", "moon"),
                      ("joints: [left_slide, right_slide]", "joints: []", "joints"), ("joints: [left_slide, right_slide]", "joints: [a, b]", "joints|`a`"),
                      ("open: 20 mm", "open: -1 mm", "open"), ("radius_edge_ratio: 4", "radius_edge_ratio: 0", "radius_edge_ratio"),
                      ("nodes_per_element: 4", "nodes_per_element: 5", "nodes_per_element"), ("low: [-12 mm", "low: [99 mm", "low|stitch"),
                      ("base_link: gripper_base", "base_link: moon", "moon"), ("schema: 1", "schema: 3", "schema"),
                      ("finger_material: finger", "finger_material: gold", "gold")):
    row(f"gripper: {new}", TASK, N, rf"(gripper|task).yaml.*({key})", edit("gripper.yaml", old, new), needs="task")
