"""A report of `diagnose`, read as data; and reports that are none."""

import json
import math
import subprocess
import tempfile
import unittest
from pathlib import Path

import phyvisgen
from phyvisgen.diagnosis import read_diagnosis

ROOT = Path(__file__).resolve().parents[3]
CASE = ROOT / "data/hidden/pendulum_joint_coulomb_friction_10x"


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name) / "diagnosis"
        words = [phyvisgen.find_program(), "diagnose", CASE, "--minutes", "60", "-o", cls.path]
        subprocess.run(words, check=True, capture_output=True)
        cls.raw = json.loads((cls.path / "report.json").read_text())

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_what_was_found_is_data(self):
        report = read_diagnosis(self.path)
        self.assertEqual(report.verdict, "effect")
        effect = report.effects[0]
        self.assertEqual((effect.name, effect.family, effect.target), ("joint_coulomb_friction", "physical", "hinge"))
        effort = effect.parameters["effort"]
        self.assertEqual(effort.unit, "N m")
        self.assertLess(effort.low, effort.value)
        self.assertLess(effort.value, effort.high)
        self.assertIn(effect.name, report.ranking[0].name)
        self.assertGreater(report.ranking[0].probability, 0.5)
        self.assertLess(report.held_out.after, report.held_out.before)
        self.assertTrue(report.amended_scene.is_file())
        self.assertEqual(read_diagnosis(self.path / "report.json").effects, report.effects)

    def test_nothing_of_the_file_is_lost(self):
        """Every key of the file that the program writes is a field, so that a new one is seen here."""
        known = "schema verdict sentence effects adjusted ranking inseparable next_experiment next_scene next_run where held_out "
        known += "regressed fit notes left_out could_show amended_scene seconds simulations noise supposed_noise"
        self.assertLessEqual(set(self.raw), set(known.split()))
        report = read_diagnosis(self.path)
        self.assertEqual(len(report.ranking), len(self.raw["ranking"]))
        self.assertEqual(report.where[0].share, self.raw["where"][0]["share"])
        self.assertEqual([each.channel for each in report.noise], [each["channel"] for each in self.raw["noise"]])
        self.assertEqual(report.simulations, self.raw["simulations"])
        if report.next_run is not None:
            self.assertEqual(vars(report.next_run), self.raw["next_run"])

    def spoiled(self, change):
        raw = json.loads(json.dumps(self.raw))
        change(raw)
        file = Path(self.folder.name) / "spoiled.json"
        file.write_text(json.dumps(raw))
        return file

    def test_what_is_not_finite_is_nan(self):
        self.assertTrue(math.isnan(read_diagnosis(self.spoiled(lambda raw: raw["fit"].update(before=None))).fit_before))

    def test_a_file_that_is_no_report_is_named_with_its_key(self):
        for change, part in (
            (lambda raw: raw.pop("held_out"), "the key `held_out` is missing"),
            (lambda raw: raw["held_out"].pop("floor"), "the key `held_out.floor` is missing"),
            (lambda raw: raw["effects"][0].update(name=3), r"`effects\[0\].name` is a text, this one is 3"),
            (lambda raw: raw.update(schema=2), "has schema 2, this package reads 1"),
            (lambda raw: raw.update(verdict="perhaps"), "`verdict` is one of effect"),
        ):
            with self.assertRaisesRegex(ValueError, part):
                read_diagnosis(self.spoiled(change))
        with self.assertRaisesRegex(ValueError, "is no JSON"):
            file = Path(self.folder.name) / "text.json"
            file.write_text("{")
            read_diagnosis(file)
        with self.assertRaises(FileNotFoundError):
            read_diagnosis(self.path / "nowhere.json")


if __name__ == "__main__":
    unittest.main()
