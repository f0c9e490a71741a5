"""MJCF and URDF files as scenes, and tasks that are perturbed."""
from table import WRONG_USE, row, write

N = WRONG_USE


def model(bodies):
    return f"<mujoco><worldbody>{bodies}</worldbody></mujoco>"


def body(inside, joint="<joint type='hinge'/>"):
    return model(f"<body name='a'>{joint}{inside}</body>")


BOX = "<geom type='box' size='0.1 0.1 0.1'/>"
for name, text, pattern in (
        ("empty", "", "no valid XML"), ("of noise", bytes(range(256)), "no valid XML"), ("cut", body(BOX)[:-20], "no valid XML"),
        ("of another kind", "<html/>", "html|mujoco"), ("without bodies", "<mujoco/>", "no bodies"),
        ("that includes itself", "<mujoco><include file='arm.xml'/></mujoco>", "circle"),
        ("that includes nothing", "<mujoco><include file='none.xml'/></mujoco>", "none.xml"),
        ("of 20 000 levels", model("<body>" * 20000 + "</body>" * 20000), "a thousand elements"),
        ("with a size of nan", body("<geom type='box' size='1 1 nan'/>"), "size.*finite"),
        ("with a size in words", body("<geom type='box' size='big'/>"), "size.*finite"),
        ("with a size of two numbers", body("<geom type='box' size='1 1'/>"), "size"),
        ("with a negative size", body("<geom type='sphere' size='-1'/>"), "size|radius"),
        ("of 1e300 kg", body("<geom type='box' size='0.1 0.1 0.1' mass='1e300'/>"), "mass.*1e.300"),
        ("with a mesh that is not there", "<mujoco><asset><mesh name='m' file='none.stl'/></asset><worldbody><body name='a'>"
         "<joint/><geom type='mesh' mesh='m'/></body></worldbody></mujoco>", "none.stl"),
        ("with a mesh without a file", body("<geom type='mesh' mesh='m'/>"), "mesh"),
        ("with a class that is not there", body("<geom class='c' size='1'/>"), "class"),
        ("with a joint of an unknown type", body(BOX, "<joint type='rope'/>"), "type|rope"),
        ("with a name that leaves the folder", model("<body name='../../evil'><joint/>" + BOX + "</body>"), "name"),
        ("with two joints of one body", body(BOX, "<joint name='j' type='hinge'/><joint name='k' type='slide'/>"), "joints"),
        ("with two joints of one name", model("<body name='a'><joint name='j'/>" + BOX + "</body><body name='b'><joint name='j'/>" + BOX + "</body>"), "twice"),
        ("with tendons", "<mujoco><tendon><fixed/></tendon>" + body(BOX)[8:], "fixed.*not supported"),
        ("with a motor of no joint", "<mujoco><actuator><motor joint='none'/></actuator>" + body(BOX)[8:], "none")):
    row(f"an MJCF file {name}", "import arm.xml -o arm.yaml", N, pattern, write("arm.xml", text))
    row(f"simulate an MJCF file {name}", "simulate arm.xml -o states.h5", N, pattern, write("arm.xml", text))
row("an MJCF file that is not there", "import none.xml -o arm.yaml", N, "none.xml")
row("import onto its file", "import arm.xml -o arm.xml", N, "arm.xml", write("arm.xml", body(BOX)))
row("import of nothing", "import", N, "import needs")
row("import of a picture", "import arm.png -o arm.yaml", N, "arm.png", write("arm.png", bytes(range(256))))
row("a URDF file without links", "import arm.urdf -o arm.yaml", N, "no links", write("arm.urdf", "<robot name='r'/>"))
row("a URDF file of noise", "import arm.urdf -o arm.yaml", N, "arm.urdf", write("arm.urdf", bytes(range(256))))

for given, pattern in (("friction=nan", "friction.*nan"), ("friction=0", "friction.*0"), ("friction", "friction"), ("friktion=1", "NAME=NUMBER"),
                       ("=1", "NAME=NUMBER"), ("latency=-1", "latency.*-1"), ("backlash=1e9", "backlash.*1e9"), ("mass=1,5", "mass.*1,5")):
    row(f"serve --perturb {given}", f"serve task.yaml --no-render --perturb {given}", N, pattern, needs="task")
