"""Bones and kinds of parts in other people's heads, told by their names."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache

from fapstream.data import read_lines
from fapstream.head.nodes import Node

EYES = {"l": "leftEye", "r": "rightEye"}
_SIDE = {
    "l": re.compile(r"left|(?:^|[\s_.:-])l(?:[\s_.:-]|$)", re.IGNORECASE),
    "r": re.compile(r"right|(?:^|[\s_.:-])r(?:[\s_.:-]|$)", re.IGNORECASE),
}
_NO_EYE = re.compile(r"brow|lid|lash|end$|target|look|corner", re.IGNORECASE)
_LAST = re.compile(r"(?:^|[\s_.:-]|(?<=[a-z0-9])(?=[HN]))([Hh]ead|HEAD|[Nn]eck|NECK)$")


def bones(nodes: list[Node], shown: set[int], given: Mapping[str, int]) -> dict[str, int]:
    """Node numbers of `head`, `neck`, `leftEye` and `rightEye`, as far as there are any.

    `shown` are nodes with meshes, which are no bones; `given` is what the file itself says.
    """
    found = {name: given[name] for name in ("head", "neck", *EYES.values()) if name in given}
    for i, node in enumerate(nodes):
        if i in shown:
            continue
        last = _LAST.search(node.name)
        if last:
            found.setdefault(last[1].lower(), i)
        elif "eye" in node.name.lower() and not _NO_EYE.search(node.name):
            for side, name in EYES.items():
                if _SIDE[side].search(node.name):
                    found.setdefault(name, i)
    return found


def kind_of(names: tuple[str, ...]) -> str:
    """What a part is, from the names of its material, mesh and node; `part` where nothing is recognised."""
    for name in names:
        for kind, words in _words():
            if any(word in name.lower().replace("brown", "") for word in words):
                return kind
    return "part"


@cache
def _words() -> tuple[tuple[str, tuple[str, ...]], ...]:
    rows = (line.partition("\t") for _, line in read_lines("head", "part_names.tsv"))
    return tuple((kind, tuple(words.split())) for kind, _, words in rows)
