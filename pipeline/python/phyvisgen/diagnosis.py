"""Reader of what `phyvisgen diagnose -o FOLDER` writes into report.json (docs/guide/measurements.md).

    report = read_diagnosis("out/diagnosis")
    for effect in report.effects:
        for name, number in effect.parameters.items():
            print(effect.name, effect.target, name, number.value, number.low, number.high, number.unit)
"""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Callable, TypeVar

__all__ = [
    "Adjusted",
    "Cell",
    "Diagnosis",
    "Effect",
    "HeldOut",
    "Noise",
    "Number",
    "Ranked",
    "Regressed",
    "Showable",
    "read_diagnosis",
]

SCHEMA = 1
_Kind = TypeVar("_Kind")
VERDICTS = ("effect", "retune", "measurement", "none", "agrees")


@dataclass(frozen=True)
class Number:
    """low, high: interval of two standard deviations."""

    value: float
    low: float
    high: float
    unit: str  # "1": none


@dataclass(frozen=True)
class Effect:
    name: str
    family: str
    site: str
    law: str
    target: str  # joint, body or pair of bodies
    parameters: dict[str, Number]


@dataclass(frozen=True)
class Adjusted:
    """A number of the scene that was fitted along within its stated uncertainty `sigma`."""

    name: str
    target: str
    unit: str
    stated: float
    sigma: float
    value: float
    deviation: float


@dataclass(frozen=True)
class Ranked:
    """A model: one candidate, or several, whose names are joined by " + ". error: of left-out fitting runs, in units of
    noise. parameters, deviations: by "effect.parameter"; without a deviation the data do not bound it."""

    name: str
    target: str
    error: float
    evidence: float  # logarithm
    probability: float
    parameters: dict[str, float]
    deviations: dict[str, float]
    fails_held_out: bool


@dataclass(frozen=True)
class Cell:
    """What part of the misfit is of this body in this phase. onset: NaN where there is none."""

    body: str
    phase: str
    share: float
    onset: float = field(metadata={"key": "onset_s"})  # [s]
    rms: float = field(metadata={"key": "rms_in_noise"})  # in units of noise
    p_value: float
    significant: bool


@dataclass(frozen=True)
class HeldOut:
    """Error before and after, and what noise alone leaves, in `unit`; gap_closed: (before - after) / (before - floor)."""

    before: float
    after: float
    floor: float
    unit: str
    gap_closed: float


@dataclass(frozen=True)
class Regressed:
    """A law without a name: formulas by column, coefficients by name."""

    effect: str
    target: str
    formula: Any
    coefficients: Any
    unit: str
    held_out: HeldOut
    fit_after: float


@dataclass(frozen=True)
class Showable:
    """The smallest parameter of an effect that these data could show. look_alike: the effect most like it;
    sigma_beside: standard deviation beside it, NaN where it has no bound."""

    name: str
    target: str
    parameter: str
    unit: str
    sigma: float
    smallest: float
    look_alike: str | None
    sigma_beside: float


@dataclass(frozen=True)
class Noise:
    """Of a channel; source: given, measured, repeats (of runs with the same commands) or assumed."""

    channel: str
    sigma: float
    least: float
    unit: str
    source: str


@dataclass(frozen=True)
class NextRun:
    """The motion that tells confused names apart best, in the words of a recording. initial, set: as a run states them, in
    SI units; commands: `time` [s] and `value` of each driven joint's target, by joint/NAME."""

    seconds: float
    initial: dict[str, Any]
    commands: dict[str, Any]
    set: dict[str, Any]


@dataclass(frozen=True)
class Diagnosis:
    """verdict: effect (one that the scene lacks), retune (a number of the scene is wrong), measurement (an error of the
    sensors), none or agrees. Errors are in units of noise where nothing else is said; one that is not known is NaN.
    inseparable: sets of effects that these data cannot tell apart. whole_runs: none where whole runs were not judged,
    and `not_judged` says why."""

    folder: Path
    verdict: str
    sentence: str
    effects: tuple[Effect, ...]
    adjusted: tuple[Adjusted, ...]
    ranking: tuple[Ranked, ...]
    inseparable: tuple[tuple[str, ...], ...]
    where: tuple[Cell, ...]
    held_out: HeldOut
    whole_runs: HeldOut | None
    not_judged: str
    fit_before: float
    fit_after: float
    regressed: Regressed | None
    could_show: tuple[Showable, ...]
    noise: tuple[Noise, ...]
    notes: tuple[str, ...]
    left_out: tuple[str, ...]
    next_experiment: str
    amended_scene: Path
    next_scene: Path | None
    next_run: NextRun | None
    seconds: float
    simulations: int
    supposed_noise: str  # empty: none was supposed
    raw: dict[str, Any]  # the file as it stands


class _Section:
    """An object of the file, whose keys are demanded by type."""

    def __init__(self, file: Path, name: str, value: Any) -> None:
        self._file, self._name = file, name
        if not isinstance(value, dict):
            raise ValueError(f"{file}: `{name or 'report'}` is no object; is it a report of phyvisgen diagnose?")
        self._value = value

    def _get(self, key: str, kind: str, is_valid: Callable[[Any], bool]) -> Any:
        name = f"{self._name}.{key}" if self._name else key
        if key not in self._value:
            raise ValueError(f"{self._file}: the key `{name}` is missing; is it a report of phyvisgen diagnose?")
        if not is_valid(self._value[key]):
            raise ValueError(f"{self._file}: `{name}` is {kind}, this one is {json.dumps(self._value[key])[:40]}")
        return self._value[key]

    def has(self, key: str) -> bool:
        return key in self._value

    def text(self, key: str) -> str:
        return self._get(key, "a text", lambda value: isinstance(value, str))

    def number(self, key: str) -> float:
        """null, which JSON has for what is not finite, as NaN"""
        is_number = lambda value: value is None or (isinstance(value, (int, float)) and not isinstance(value, bool))
        value = self._get(key, "a number", is_number)
        return math.nan if value is None else float(value)

    def truth(self, key: str) -> bool:
        return self._get(key, "true or false", lambda value: isinstance(value, bool))

    def anything(self, key: str) -> Any:
        return self._get(key, "given", lambda _: True)

    def section(self, key: str) -> _Section:
        name = f"{self._name}.{key}" if self._name else key
        return _Section(self._file, name, self._get(key, "an object", lambda value: isinstance(value, dict)))

    def sections(self, key: str) -> list[_Section]:
        name = f"{self._name}.{key}" if self._name else key
        rows = self._get(key, "a list", lambda value: isinstance(value, list))
        return [_Section(self._file, f"{name}[{i}]", row) for i, row in enumerate(rows)]

    def texts(self, key: str) -> tuple[str, ...]:
        is_texts = lambda value: isinstance(value, list) and all(isinstance(each, str) for each in value)
        return tuple(self._get(key, "a list of texts", is_texts))

    def keys(self) -> list[str]:
        return list(self._value)

    def numbers(self, key: str) -> dict[str, float]:
        """An object of numbers; {} where there is none."""
        if not self.has(key):
            return {}
        section = self.section(key)
        return {name: section.number(name) for name in section.keys()}


def _effect(row: _Section) -> Effect:
    parameters = {}
    section = row.section("parameters")
    for name in section.keys():
        number = section.section(name)
        parameters[name] = Number(number.number("value"), number.number("low"), number.number("high"), number.text("unit"))
    return Effect(row.text("name"), row.text("family"), row.text("site"), row.text("law"), row.text("target"), parameters)


def _row_of(kind: type[_Kind], row: _Section) -> _Kind:
    """A class of texts, numbers and truths alone: each field by its type, from the key that its metadata or name says."""
    read = {"str": row.text, "float": row.number, "bool": row.truth}
    return kind(*(read[each.type](each.metadata.get("key", each.name)) for each in fields(kind)))


def _ranked(row: _Section) -> Ranked:
    return Ranked(
        row.text("name"),
        row.text("target"),
        row.number("held_out_error"),
        row.number("evidence"),
        row.number("probability"),
        row.numbers("parameters"),
        row.numbers("deviations"),
        row.has("fails_held_out") and row.truth("fails_held_out"),
    )


def _regressed(row: _Section) -> Regressed:
    return Regressed(
        row.text("effect"),
        row.text("target"),
        row.anything("formula"),
        row.anything("coefficients"),
        row.text("unit"),
        _row_of(HeldOut, row.section("held_out")),
        row.number("fit_after"),
    )


def _showable(row: _Section) -> Showable:
    return Showable(
        row.text("name"),
        row.text("target"),
        row.text("parameter"),
        row.text("unit"),
        row.number("sigma"),
        row.number("smallest"),
        row.text("look_alike") if row.has("look_alike") else None,
        row.number("sigma_beside") if row.has("sigma_beside") else math.nan,
    )


def _next_run(row: _Section) -> NextRun:
    parts = {name: row.section(name) for name in ("initial", "commands", "set")}
    return NextRun(row.number("seconds"), **{n: {k: part.anything(k) for k in part.keys()} for n, part in parts.items()})


def read_diagnosis(path: str | os.PathLike[str]) -> Diagnosis:
    """Of the folder that `diagnose -o` wrote, or of its report.json. A ValueError names what is wrong with the file."""
    file = Path(path)
    file = file / "report.json" if file.is_dir() else file
    try:
        raw = json.loads(file.read_text())
    except json.JSONDecodeError as error:
        raise ValueError(f"{file} is no JSON ({error}); give it the folder of a finished diagnosis") from error
    report = _Section(file, "", raw)
    if report.number("schema") != SCHEMA:
        raise ValueError(f"{file} has schema {raw['schema']}, this package reads {SCHEMA}; update the older of the two")
    if report.text("verdict") not in VERDICTS:
        raise ValueError(f"{file}: `verdict` is one of {', '.join(VERDICTS)}, this one is {raw['verdict']}")
    held_out, fit = report.section("held_out"), report.section("fit")
    whole = held_out.section("whole_runs")
    inseparable = report.anything("inseparable")
    return Diagnosis(
        folder=file.parent,
        verdict=report.text("verdict"),
        sentence=report.text("sentence"),
        effects=tuple(map(_effect, report.sections("effects"))),
        adjusted=tuple(_row_of(Adjusted, row) for row in report.sections("adjusted")),
        ranking=tuple(map(_ranked, report.sections("ranking"))),
        inseparable=tuple(tuple(group) for group in inseparable),
        where=tuple(_row_of(Cell, row) for row in report.sections("where")),
        held_out=_row_of(HeldOut, held_out),
        whole_runs=None if whole.has("not_judged") else _row_of(HeldOut, whole),
        not_judged=whole.text("not_judged") if whole.has("not_judged") else "",
        fit_before=fit.number("before"),
        fit_after=fit.number("after"),
        regressed=_regressed(report.section("regressed")) if report.has("regressed") else None,
        could_show=tuple(map(_showable, report.sections("could_show"))),
        noise=tuple(_row_of(Noise, row) for row in report.sections("noise")),
        notes=report.texts("notes"),
        left_out=report.texts("left_out"),
        next_experiment=report.text("next_experiment"),
        amended_scene=file.parent / report.text("amended_scene"),
        next_scene=file.parent / report.text("next_scene") if report.has("next_scene") else None,
        next_run=_next_run(report.section("next_run")) if report.has("next_run") else None,
        seconds=report.number("seconds"),
        simulations=int(report.number("simulations")),
        supposed_noise=report.text("supposed_noise") if report.has("supposed_noise") else "",
        raw=raw,
    )
