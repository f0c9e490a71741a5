#!/usr/bin/env python3
"""The physics table: masks of a gripper's fingers, of simulations against a reality that no one told them of.

    physics_table.py OUT --seed N [--only beaker] [--minutes M] [--program build/bin/phyvisgen]

Reality is a simulation with fingers of other meshes, half the step and another integrator, another law of friction,
another modulus, a loose drive, and a camera with a lens, blur and noise; Cycles draws it. Its numbers are drawn from the
seed and written to OUT/reality.json, which nothing but reality reads. Three simulations have the same commands: fingers
that are rigid, the nominal model, and the nominal model after `diagnose` from the masks and joint logs of another grasp
of that reality, proved on the judged one. Run it by scripts/fidelity_tables.sh. What is there is not made again.
"""
import argparse
import json
import pathlib
import subprocess
import sys

import h5py
import numpy as np
import yaml
from PIL import Image

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import grasp_scene as scenes  # noqa: E402
from grasp_scene import Grasp, Model  # noqa: E402

FPS, FIRST = 50, 0.02  # of the pictures; the first shows the end of the first step of 20 ms [s]
DEFORMED = 0.001       # [m]: frames count in which a point of the fingers has moved so far from where its carriage puts it
ENCODER = 2e-5         # [m], one sigma of the joint logs


def drawn(seed):
    """What reality is."""
    random = np.random.default_rng(seed)
    law = str(random.choice(["velocity_dependent_friction", "anisotropic_friction"]))
    change = float(random.uniform(-0.4, -0.15))
    return dict(seed=seed, modulus=10e6 * float(random.choice([0.8, 1.2])), law=law, change=change,
                friction=float(random.uniform(0.6, 0.9)), play=float(random.uniform(0.6e-3, 1.2e-3)),
                k1=float(random.uniform(0.02, 0.05) * random.choice([-1, 1])), k1_calibrated_off=float(random.normal(0, 0.002)),
                blur=float(random.uniform(0.5, 0.9)), noise=float(random.uniform(0.01, 0.03)))


def grasps(thing, seed):
    """One grasp to fit, one to judge: the object stands elsewhere, the fingers close further and hold for a second, as a
    manipulation does. Both open again: while a gripper only closes, play and dry friction of a drive hold its slide back
    alike."""
    random = np.random.default_rng([seed, len(thing)])
    closed = scenes.OBJECTS[thing]["closed"]

    def at(yaw):
        return tuple(float(f"{x:.5f}") for x in random.uniform(-0.001, 0.001, 2)), round(float(random.uniform(-yaw, yaw)), 4)

    (fit, yaw), (judged, _) = at(0.2), at(0.2)  # a recording states places of its runs, not turns
    return {"fit": Grasp(thing, fit, yaw, closed, 0.16, 0.04, 0.08),
            "judged": Grasp(thing, judged, yaw, max(closed - 0.006, 0.0), 0.20, 1.0, 0.08)}


def picture_times(grasp):
    """times of the pictures [n, s]: while the grasp closes and holds; the joint logs go on while it opens"""
    return np.arange(FIRST, grasp.opens_at, 1 / FPS)


def reality_model(truth, thing):
    law = (f"{{effect: {truth['law']}, target: {thing}/fingers, change: {truth['change']:.4f}"
           + (", velocity: 0.02}" if truth["law"].startswith("velocity") else "}"))
    return Model(step=0.010, integrator="bdf2", modulus=truth["modulus"], friction=truth["friction"], finger="real.obj",
                 effects=(law, f"{{effect: backlash, target: left_slide, play: {truth['play']:.6f}}}"))


class Table:
    def __init__(self, options):
        self.out, self.program, self.seed = options.out.resolve(), options.program, options.seed
        self.minutes, self.samples, self.mesh = options.minutes, options.samples, options.mesh.split()
        self.diagnoses = not options.no_diagnosis
        self.out.mkdir(parents=True, exist_ok=True)
        self.truth = drawn(options.seed)
        (self.out / "reality.json").write_text(json.dumps(self.truth, indent=1) + "\n")

    def run(self, *arguments):
        subprocess.run([self.program, *map(str, arguments)], check=True)

    def simulated(self, name, text):
        """The states of a scene, simulated once."""
        scene, states = name.with_suffix(".yaml"), name.with_suffix(".h5")
        if not states.exists():
            scene.write_text(text)
            self.run("simulate", scene, "-o", states)
        return scene, states

    def reality(self, folder, thing, name, grasp):
        """folder/real_NAME: masks/NAME.png and pictures; log.npz with times, commands and joint positions"""
        import photograph
        _, states = self.simulated(folder / f"real_{name}", scenes.text(grasp, reality_model(self.truth, thing), folder))
        seen = folder / f"real_{name}"
        if (seen / "log.npz").exists():
            return seen
        motion = photograph.Motion(states)
        random = np.random.default_rng([self.seed, len(thing), len(name)])
        height = scenes.OBJECTS[thing]["above"] + scenes.TOOL_Z
        camera = dict(scenes.CAMERA, position=(0.082, 0, height - 0.020), target=(0.014, 0, height - 0.125), up=(1, 0, 0))
        photographer = photograph.Photographer(camera, self.truth, self.samples, random)
        (seen / "masks").mkdir(parents=True, exist_ok=True)
        times = picture_times(grasp)
        points, triangles = visual(thing)
        rest, deformed = motion.fingers(0), []
        for i, t in enumerate(times):
            step = int(np.argmin(abs(motion.time - t)))
            surfaces = {"fingers": (motion.fingers(step), motion.triangles()),
                        thing: (moved(points, motion.pose(thing, step)), triangles)}
            coverage = photographer.through_lens(photographer.draw(surfaces, True))[..., 1]
            Image.fromarray(np.uint8(255 * (coverage > 0.5))).save(seen / f"masks/wrist_{i:06}.png")
            if name == "judged" and i % 4 == 1:  # to look at; masks are all that is compared
                picture = photographer.through_lens(photographer.draw(surfaces, False))
                Image.fromarray(photograph.shown(picture)).save(seen / f"wrist_{i:06}.png")
            bend = motion.fingers(step) - rest
            for carriage, is_its in (("left_carriage", rest[:, 1] < 0), ("right_carriage", rest[:, 1] > 0)):
                bend[is_its] -= motion.pose(carriage, step)[:, 3] - motion.pose(carriage, 0)[:, 3]
            deformed.append(float(np.linalg.norm(bend, axis=1).max()))
        time, q = self.joint_log(motion, thing, name)
        np.savez(seen / "log.npz", time=time, q=q, frames=times, deformed=deformed)
        return seen

    def joint_log(self, motion, thing, name):
        """time [n, s] and positions of both slides [n, 2, m] as encoders tell them, from the start on"""
        random = np.random.default_rng([self.seed, len(thing), len(name), 1])
        q = np.concatenate([np.full((1, 2), scenes.OBJECTS[thing]["open"]), motion.file["joint/position"][:, :2]])
        return np.concatenate([[0.0], motion.time]), q + random.normal(0, ENCODER, q.shape)

    def masks(self, name, scene, states, grasp):
        """folder with masks/NAME.png of a simulation until the grasp opens, as the camera takes them"""
        seen = name
        if not (seen / "masks").exists():
            self.run("render", scene, "--states", states, "--fps", FPS, "--samples", 1, "--ground-truth", "-o", seen)
            (seen / "masks").mkdir()
            with h5py.File(seen / "wrist_truth.h5") as file:
                names = [n.decode() if isinstance(n, bytes) else str(n) for n in file["part"].attrs["names"]]
                fingers = [i for i, n in enumerate(names) if n.startswith("finger")]
                for i, part in enumerate(file["part"][:len(picture_times(grasp))]):
                    Image.fromarray(np.uint8(255 * np.isin(part, fingers))).save(seen / f"masks/wrist_{i:06}.png")
        return seen

    def nominal(self, **changes):
        return Model(distortion=self.truth["k1"] + self.truth["k1_calibrated_off"], **changes)

    def recording(self, folder, thing, seen, both):
        """folder/recording: masks and joint logs of both grasps, with the nominal scene; the judged one is held out, as
        a diagnosis names nothing that it cannot prove on another motion."""
        case = folder / "recording"
        case.mkdir(exist_ok=True)
        (case / "scene.yaml").write_text(scenes.text(both["fit"], self.nominal(), folder))
        runs = ""
        for name, grasp in both.items():
            log = np.load(seen[name] / "log.npz")
            rows = [f"{t:.3f},{grasp.command(t):.7f},{q[0]:.7f},{q[1]:.7f}" for t, q in zip(log["time"], log["q"])]
            (case / f"{name}.csv").write_text("t,command,left,right\n" + "\n".join(rows) + "\n")
            masks = np.stack([np.array(Image.open(f)) > 0 for f in sorted((seen[name] / "masks").glob("*.png"))])
            with h5py.File(case / f"{name}.h5", "w") as file:
                part = file.create_dataset("part", data=masks.astype(np.uint8), compression="gzip")
                part.attrs["names"] = ["nothing", "fingers"]
                file["time"] = np.round(log["frames"], 3)
            x, y = grasp.offset  # the gripper stands open and still before it closes
            slides = ", ".join(f"joint/{side}_slide/position: {scenes.OBJECTS[thing]['open']}, joint/{side}_slide/velocity: 0"
                               for side in ("left", "right"))
            runs += (f"  - {{file: {name}.csv, role: {'fit' if name == 'fit' else 'held_out'}, "
                     f"initial: {{body/{thing}/position: [{x}, {y}, 0.0005], {slides}}}}}\n")
        inputs = "".join(f"  - {{column: command, target: joint/{s}_slide/position, unit: m}}\n" for s in ("left", "right"))
        channels = "".join(f"  - {{column: {s}, kind: position, joint: {s}_slide, unit: m, noise: {ENCODER}}}\n"
                           for s in ("left", "right"))
        (case / "recording.yaml").write_text(
            f"schema: 1\nscene: scene.yaml\nruns:\n{runs}inputs:\n{inputs}channels:\n{channels}"
            "  - {file: \"{run}.h5\", kind: mask, camera: wrist, part: fingers}\n")
        return case

    def diagnosed(self, case):
        """report.json of the diagnosis"""
        report = case / "report"
        if not (report / "report.json").exists():
            self.run("diagnose", case, "-o", report, "--minutes", self.minutes, "--max-effects", 3)
        return report

    def compare(self, folder, real, simulated, baselines):
        """evaluate fidelity's JSON over the frames in which the gripper is deformed, and over those in which it is held"""
        frames = np.flatnonzero(np.load(real / "log.npz")["deformed"] > DEFORMED)
        results = {}
        for name, first in (("deformed", frames[0]), ("held", frames[-1] - 3)):
            arguments = ["evaluate", "fidelity", real, simulated, "--frames", f"{first}:{frames[-1] + 1}", "--stretch", 3,
                         "-o", folder / f"report_{name}", "--json"]
            for baseline, place in baselines.items():
                arguments += ["--baseline", f"{baseline}={place}"]
            done = subprocess.run([self.program, *map(str, arguments)], check=True, capture_output=True, text=True)
            results[name] = json.loads(done.stdout)
        return results

    def row(self, thing):
        """mean IoU over both choices of frames, by column; what the diagnosis says"""
        folder = self.out / thing
        folder.mkdir(exist_ok=True)
        opening = scenes.OBJECTS[thing]["open"]
        if not (folder / "real.obj").exists():
            scenes.write_fingers(folder / "nominal.obj", opening)
            scenes.write_fingers(folder / "real.obj", opening, *self.mesh)
        both = grasps(thing, self.seed)
        judged = both["judged"]
        columns = {}
        for name, model in (("rigid", self.nominal(rigid=True)), ("nominal", self.nominal())):
            columns[name] = self.masks(folder / name, *self.simulated(folder / name, scenes.text(judged, model, folder)),
                                       judged)
        real = self.reality(folder, thing, "judged", judged)
        sentence = "not diagnosed"
        if self.diagnoses:
            seen = {"fit": self.reality(folder, thing, "fit", both["fit"]), "judged": real}
            report = self.diagnosed(self.recording(folder, thing, seen, both))
            sentence = json.loads((report / "report.json").read_text())["sentence"]
            amended = yaml.safe_load((report / "scene_amended.yaml").read_text())
            text = judged_scene(amended, scenes.text(judged, self.nominal(), folder))
            columns["after"] = self.masks(folder / "after", *self.simulated(report / "after", text), judged)
        sheet(real, columns).save(folder / "sheet.png")
        last = list(columns)[-1]
        compared = self.compare(folder, real, columns[last], {k: v for k, v in columns.items() if k != last})
        return {frames: {**{k: result["baselines"][k]["mask"] for k in columns if k != last}, last: result["mask"]}
                for frames, result in compared.items()}, sentence


def sheet(real, columns):
    """What the camera saw in the last picture that was taken, and beside it the masks of each column: grey where both
    are, red where reality alone is, blue where the simulation alone is."""
    photo = sorted(real.glob("wrist_*.png"))[-1]
    truth = np.array(Image.open(real / "masks" / photo.name)) > 0
    parts = [np.array(Image.open(photo))]
    for folder in columns.values():
        mask = np.array(Image.open(folder / "masks" / photo.name)) > 0
        part = np.zeros(mask.shape + (3,), np.uint8)
        part[mask & truth], part[truth & ~mask], part[mask & ~truth] = 200, (230, 60, 40), (40, 90, 240)
        parts.append(part)
    return Image.fromarray(np.concatenate(parts, axis=1))


def moved(points, pose):
    return points @ pose[:, :3].T + pose[:, 3]


def visual(thing):
    """points, triangles of what is seen of an object"""
    surface = scenes.read_obj(scenes.ROOT / f"data/objects/{thing}_visual.obj")
    triangles = [(f[0], f[i], f[i + 1]) for f in surface.faces for i in range(1, len(f) - 1)]
    return surface.points, np.array(triangles)


def judged_scene(amended, judged):
    """The amended scene with the start and the commands of another grasp."""
    other = yaml.safe_load(judged)
    for body in amended["bodies"]:
        body.update({k: v for k, v in next(b for b in other["bodies"] if b["name"] == body["name"]).items() if k == "pose"})
    for joint in amended["joints"]:
        theirs = next(j for j in other["joints"] if j["name"] == joint["name"])["drive"]
        joint["drive"].update({k: theirs[k] for k in ("target", "target_times")})
    amended["duration"] = other["duration"]
    return yaml.safe_dump(amended, sort_keys=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--only", choices=scenes.OBJECTS, action="append")
    parser.add_argument("--minutes", type=float, default=5, help="of each diagnosis")
    parser.add_argument("--no-diagnosis", action="store_true", help="leave the last column out")
    parser.add_argument("--mesh", default="--layers 2 --across 8",
                        help="of reality's fingers, words for make_gripper.py; unless given some 20,000 elements")
    parser.add_argument("--samples", type=int, default=16, help="of Cycles per pixel")
    parser.add_argument("--program", default=str(scenes.ROOT / "build/bin/phyvisgen"))
    options = parser.parse_args()
    table = Table(options)
    for thing in options.only or scenes.OBJECTS:
        row, sentence = table.row(thing)
        for frames, columns in row.items():
            cells = [f"{name} {100 * c['miou']:.2f} ({100 * c['low']:.2f} to {100 * c['high']:.2f})" for name, c in columns.items()]
            print(f"{thing}, frames in which the gripper is {frames}: mean IoU [%] {', '.join(cells)}", flush=True)
        print(f"{thing}: {sentence}", flush=True)


if __name__ == "__main__":
    main()
