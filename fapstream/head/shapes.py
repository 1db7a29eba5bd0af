"""The face shapes other people's avatars have, ARKit's 52 and Oculus' 15, and how FAPs drive them."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fapstream.data import read_lines
from fapstream.errors import DataError
from fapstream.fap.tables import visemes
from fapstream.records import N_FAPS

Drive = tuple[tuple[int, float], ...]
PRESET = "vrm:"
"""Before the names of VRM's presets, which are not names of morph targets."""


@dataclass(frozen=True, slots=True)
class Plan:
    """What drives the shapes a head has.

    `missing`: the ARKit shapes it lacks and could use; `instead`: what stands in for them, by their names.
    """

    drives: Mapping[str, Drive]
    missing: tuple[str, ...]
    instead: Mapping[str, tuple[str, ...]]


@cache
def arkit() -> Mapping[str, NDArray[np.float64]]:
    """The 52 shapes at full strength as low-level FAPs, (68,) each, FAP n at n-1."""
    table = {}
    for name, pairs in _pairs("shapes.tsv", _fap):
        table[name] = np.zeros(N_FAPS)
        for fap, value in pairs:
            table[name][int(fap) - 1] = value
    return table


@cache
def oculus() -> Mapping[str, NDArray[np.float64]]:
    """The 15 visemes by their names in glTF files, as low-level FAPs (68,)."""
    return {name: visemes()[int(number)] for _, name, number in _lines("visemes.tsv")}


@cache
def drives() -> Mapping[str, Drive]:
    """(FAP, strength per FAP unit) pairs that drive each ARKit shape; the sum is held between 0 and 1."""
    return {
        name: tuple((int(fap), value / 1000) for fap, value in pairs)
        for name, pairs in _pairs("drives.tsv", _fap)
    }


def known(name: str) -> str | None:
    """The name used here for what a file calls `name`; None for what is no face shape.

    Case, blanks, underscores, prefixes up to a dot or colon and a final .001 do not count; _L is Left.
    """
    preset = PRESET if name.startswith(PRESET) else ""
    return _names().get(preset + _key(name.removeprefix(PRESET)))


def plan(names: Collection[str], without: tuple[str, ...] = ()) -> Plan:
    """How FAPs drive a head that has the shapes `names`, as `known` calls them.

    ARKit shapes that begin with one of `without` are not needed, so neither driven nor missing.
    """
    needed = {name: drive for name, drive in drives().items() if not name.startswith(without or ("-",))}
    found: dict[str, dict[int, float]] = {}
    instead: dict[str, tuple[str, ...]] = {}
    missing = [name for name in needed if name not in names]
    for name, drive in needed.items():
        parts = {name: 1.0} if name in names else stand_ins(name, names)
        if name not in names and parts:
            instead[name] = tuple(parts)
        for other, strength in parts.items():
            row = found.setdefault(other, {})
            for fap, value in drive:
                row[fap] = row.get(fap, 0.0) + strength * value
    tidy = {
        name: tuple((fap, v) for fap, v in sorted(row.items()) if abs(v) > 1e-9)
        for name, row in found.items()
    }
    return Plan({name: drive for name, drive in tidy.items() if drive}, tuple(missing), instead)


def stand_ins(name: str, names: Collection[str], seen: tuple[str, ...] = ()) -> dict[str, float]:
    """The shapes among `names`, with strengths, that stand in for one that is missing; {} if none can."""
    for choice in _substitutes().get(name, ()):
        total: dict[str, float] = {}
        for other, strength in choice:
            if other in names:
                found = {other: 1.0}
            else:
                found = {} if other in seen else stand_ins(other, names, (*seen, name))
            if not found:
                total = {}
                break
            for shape, share in found.items():
                total[shape] = total.get(shape, 0.0) + strength * share
        if total:
            return total
    return {}


def strengths(values: NDArray[np.int32], names: Collection[str]) -> dict[str, NDArray[np.float64]]:
    """How strong the shapes `names` are under frames of FAPs (n, 68): (n,) each, from 0 to 1."""
    rows = {}
    for name, drive in plan(names).drives.items():
        total = sum(share * values[:, fap - 1].astype(float) for fap, share in drive)
        rows[name] = np.clip(total, 0.0, 1.0)
    return rows


def _key(name: str) -> str:
    name = re.sub(r"\.\d+$", "", name)
    name = re.sub(r"[\s_-](l|left)$", "Left", name, flags=re.IGNORECASE)
    name = re.sub(r"[\s_-](r|right)$", "Right", name, flags=re.IGNORECASE)
    return re.sub(r"[^a-z0-9]", "", re.split(r"[.:]", name)[-1].lower())


@cache
def _names() -> Mapping[str, str]:
    proper = {*drives(), *oculus(), *arkit()}
    proper |= {other for choices in _substitutes().values() for choice in choices for other, _ in choice}
    table = {_key(name): name for name in proper}
    for _, name, aliases in _lines("aliases.tsv"):
        for alias in aliases.split():
            preset = PRESET if alias.startswith(PRESET) else ""
            table[preset + _key(alias.removeprefix(PRESET))] = name
    return table | {PRESET + key: name for key, name in table.items() if not key.startswith(PRESET)}


@cache
def _substitutes() -> Mapping[str, list[tuple[tuple[str, float], ...]]]:
    table: dict[str, list[tuple[tuple[str, float], ...]]] = {}
    for name, pairs in _pairs("substitutes.tsv", str):
        table.setdefault(name, []).append(pairs)
    return table


def _fap(text: str) -> str:
    if not 3 <= int(text) <= N_FAPS:
        raise ValueError
    return text


def _pairs(file: str, check: Callable[[str], str]) -> Iterator[tuple[str, tuple[tuple[str, float], ...]]]:
    """Lines `name<TAB>key=value key=value ...`."""
    for number, name, text in _lines(file):
        try:
            rows = [pair.split("=") for pair in text.split()]
            yield name, tuple((check(key), float(value)) for key, value in rows)
        except ValueError:
            raise DataError(file, number, f"{text[:60]!r} is not key=value pairs") from None


def _lines(file: str) -> Iterator[tuple[int, str, str]]:
    for number, line in read_lines("head", file):
        name, _, rest = line.partition("\t")
        yield number, name, rest
