"""Feature points in files: `.fdp`, a list of points, and xfdp, Xface's XML that binds points to a mesh."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from math import isfinite
from xml.parsers import expat

from fapstream.errors import DataError
from fapstream.records import N_FAPS

Point = tuple[float, float, float]

GROUP_SIZES = {2: 14, 3: 14, 4: 6, 5: 4, 6: 4, 7: 1, 8: 10, 9: 15, 10: 10, 11: 6}

FDP_NAMES = tuple(f"{group}.{k}" for group, size in GROUP_SIZES.items() for k in range(1, size + 1))
"""The 84 feature points of ISO/IEC 14496-2, Annex C."""

FAPU_NAMES = ("IRISD0", "ES0", "ENS0", "MNS0", "MW0")

RAISED_COSINE = "RaisedCosInfluenceSph"

MAX_CHARACTERS = 1 << 24
MAX_DEPTH = 16
MAX_MESHES = 1024
MAX_INFLUENCES = 4096


def read_fdp(text: str, where: str) -> dict[str, Point]:
    """Feature points of a `.fdp` file: lines `2.1 x y z`, in metres, with `#` comments.

    White space and commas separate. Raises DataError with the line: an unknown or repeated point, not
    three finite numbers.
    """
    points: dict[str, Point] = {}
    for number, line in enumerate(text.removeprefix("\ufeff").splitlines(), 1):
        words = line.partition("#")[0].replace(",", " ").split()
        if not words:
            continue
        name, *numbers = words
        _check_name(name, points, where, number)
        if len(numbers) != 3:
            raise DataError(where, number, f"expected x y z after {name}, found {len(numbers)} words")
        x, y, z = (_number(n, where, number) for n in numbers)
        points[name] = (x, y, z)
    return points


def format_fdp(points: Mapping[str, Point]) -> str:
    """The text of a `.fdp` file, in the order of the standard."""
    lines = ["# MPEG-4 feature points: name, x (to the subject's left), y (up), z (gaze), in metres"]
    lines += [" ".join([name, *(f"{c:.6f}" for c in points[name])]) for name in FDP_NAMES if name in points]
    return "\n".join(lines) + "\n"


@dataclass(frozen=True, slots=True)
class Influence:
    """A FAP that moves vertices (1-68; the file counts from 0). Weight 0.5 is the FAP's own displacement."""

    fap: int
    weight: float
    type: str = RAISED_COSINE


@dataclass(frozen=True, slots=True)
class BoundPoint:
    """A feature point: vertex `index` of `mesh`, and the vertices that move with it."""

    name: str
    mesh: str
    index: int
    indices: tuple[int, ...] = ()
    influences: tuple[Influence, ...] = ()


@dataclass(frozen=True, slots=True)
class Xfdp:
    """An xfdp file: FAPU distances by name, in the mesh's units; mesh files as (file, format)."""

    fapu: Mapping[str, float]
    meshes: tuple[tuple[str, str], ...]
    points: tuple[BoundPoint, ...]


def read_xfdp(text: str, where: str) -> Xfdp:
    """Xface's XML. A DOCTYPE is refused, and with it every entity of the file's own.

    Raises DataError with the line: broken XML, another root, unknown or repeated points, FAPs and indices
    that cannot be, more than MAX_CHARACTERS.
    """
    if len(text) > MAX_CHARACTERS:
        raise DataError(where, None, f"more than {MAX_CHARACTERS} characters")
    return _XfdpReader(where).read(text)


def format_xfdp(xfdp: Xfdp) -> str:
    """The text of an xfdp file."""
    known = [(name, xfdp.fapu[name]) for name in FAPU_NAMES if name in xfdp.fapu]
    fapu = " ".join(f'{name}="{value:.9g}"' for name, value in known)
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', "<xfdp>", f"  <fapu {fapu}/>", "  <source>"]
    for file, kind in xfdp.meshes:
        lines.append(f"    <entity><mesh file={_quoted(file)} format={_quoted(kind)}/></entity>")
    lines.append("  </source>")
    for point in xfdp.points:
        lines.append(
            f"  <fdp name={_quoted(point.name)} index={_quoted(str(point.index))}"
            f" affects={_quoted(point.mesh)}>"
        )
        lines.append(f"    <indices>{' '.join(map(str, point.indices))}</indices>")
        lines += [
            f'    <influence fap="{i.fap - 1}" weight="{i.weight:.9g}" type={_quoted(i.type)}/>'
            for i in point.influences
        ]
        lines.append("  </fdp>")
    return "\n".join([*lines, "</xfdp>", ""])


@dataclass(slots=True)
class _Open:
    """The fdp element that is being read."""

    name: str
    mesh: str
    index: int
    indices: list[int] = field(default_factory=list)
    influences: list[Influence] = field(default_factory=list)


class _XfdpReader:
    def __init__(self, where: str) -> None:
        self._where = where
        self._path: list[str] = []
        self._text: list[str] = []
        self._fapu: dict[str, float] = {}
        self._meshes: list[tuple[str, str]] = []
        self._points: dict[str, BoundPoint] = {}
        self._open: _Open | None = None
        self._parser = expat.ParserCreate("utf-8")
        self._parser.StartDoctypeDeclHandler = self._doctype
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._characters

    def read(self, text: str) -> Xfdp:
        try:
            self._parser.Parse(text.encode("utf-8", "replace"), True)
        except expat.ExpatError as e:
            raise DataError(self._where, e.lineno, f"broken XML: {expat.ErrorString(e.code)}") from None
        return Xfdp(self._fapu, tuple(self._meshes), tuple(self._points.values()))

    def _fail(self, reason: str) -> DataError:
        return DataError(self._where, self._parser.CurrentLineNumber, reason)

    def _doctype(self, *_: object) -> None:
        raise self._fail("a DOCTYPE is not allowed")

    def _start(self, tag: str, given: dict[str, str]) -> None:
        if not self._path and tag != "xfdp":
            raise self._fail(f"the root is <{tag[:40]}>, not <xfdp>")
        if len(self._path) == MAX_DEPTH:
            raise self._fail(f"elements within more than {MAX_DEPTH} others")
        self._path.append(tag)
        self._text = []
        if tag == "fapu":
            line = self._parser.CurrentLineNumber
            self._fapu |= {n: _number(given[n], self._where, line) for n in FAPU_NAMES if n in given}
        elif tag == "mesh":
            if len(self._meshes) == MAX_MESHES:
                raise self._fail(f"more than {MAX_MESHES} meshes")
            self._meshes.append((given.get("file", ""), given.get("format", "")))
        elif tag == "fdp":
            self._start_point(given)
        elif tag == "influence" and self._open:
            self._influence(self._open, given)

    def _start_point(self, given: dict[str, str]) -> None:
        if self._open:
            raise self._fail("an fdp within an fdp")
        name = given.get("name", "")
        _check_name(name, self._points, self._where, self._parser.CurrentLineNumber)
        self._open = _Open(name, given.get("affects", ""), self._whole(given.get("index", ""), "index"))

    def _influence(self, point: _Open, given: dict[str, str]) -> None:
        fap = self._whole(given.get("fap", ""), "fap")
        if fap >= N_FAPS:
            raise self._fail(f"fap {fap}; it counts from 0, to {N_FAPS - 1}")
        if len(point.influences) == MAX_INFLUENCES:
            raise self._fail(f"more than {MAX_INFLUENCES} influences of one point")
        weight = _number(given.get("weight", "1"), self._where, self._parser.CurrentLineNumber)
        point.influences.append(Influence(fap + 1, weight, given.get("type", RAISED_COSINE)))

    def _characters(self, text: str) -> None:
        if self._path[-1] == "indices":
            self._text.append(text)

    def _end(self, tag: str) -> None:
        self._path.pop()
        if tag == "indices" and self._open:
            self._open.indices += [self._whole(word, "index") for word in "".join(self._text).split()]
        elif tag == "fdp" and self._open:
            p, self._open = self._open, None
            self._points[p.name] = BoundPoint(p.name, p.mesh, p.index, tuple(p.indices), tuple(p.influences))

    def _whole(self, word: str, what: str) -> int:
        if not (word.isascii() and word.isdigit() and len(word) < 10):
            raise self._fail(f"{word[:40]!r} is no {what}")
        return int(word)


def _quoted(text: str) -> str:
    """As an attribute's value; white space too comes back as it was."""
    return f'"{escape(text).translate({9: "&#9;", 10: "&#10;", 13: "&#13;"})}"'


def _check_name(name: str, known: Mapping[str, object], where: str, line: int) -> None:
    if name not in FDP_NAMES:
        raise DataError(where, line, f"{name[:40]!r} is none of the {len(FDP_NAMES)} feature points")
    if name in known:
        raise DataError(where, line, f"feature point {name} is there twice")


def _number(word: str, where: str, line: int) -> float:
    try:
        value = float(word)
    except ValueError:
        value = float("nan")
    if not isfinite(value) or "_" in word:
        raise DataError(where, line, f"{word[:40]!r} is no number")
    return value
