"""Feature points in files: lists of points, and Xface's XML."""

from __future__ import annotations

import time
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.errors import DataError
from fapstream.fap import fdp
from fapstream.fap.fdp import (
    FDP_NAMES,
    BoundPoint,
    Influence,
    Xfdp,
    format_fdp,
    format_xfdp,
    read_fdp,
    read_xfdp,
)
from fapstream.fap.tables import faps

COORDINATES = st.integers(-(10**6), 10**6).map(lambda n: n / 10**6)
POINTS = st.dictionaries(st.sampled_from(FDP_NAMES), st.tuples(COORDINATES, COORDINATES, COORDINATES))


def test_there_are_84_points_and_the_faps_move_some() -> None:
    assert len(FDP_NAMES) == len(set(FDP_NAMES)) == 84
    assert {name for f in faps() for name in f.fdp} <= set(FDP_NAMES)


@settings(deadline=None)
@given(POINTS)
def test_points_round_trip(points: dict[str, tuple[float, float, float]]) -> None:
    assert read_fdp(format_fdp(points), "p") == points


def test_points_by_hand() -> None:
    text = "\ufeff# head\r\n2.1\t0 -0.5 +1e-1  # chin\r\n\r\n  10.10, 1, 2, 3\r\n9.15 .5 5. -0"
    assert read_fdp(text, "p") == {"2.1": (0, -0.5, 0.1), "10.10": (1, 2, 3), "9.15": (0.5, 5, 0)}
    assert format_fdp({"10.1": (1, 2, 3), "2.1": (0, -0.5, 0.1)}).splitlines()[1:] == [
        "2.1 0.000000 -0.500000 0.100000", "10.1 1.000000 2.000000 3.000000"
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("1.1 0 0 0", "'1.1' is none of the 84"),
        ("2.15 0 0 0", "'2.15' is none of the 84"),
        ("2.01 0 0 0", "is none of the 84"),
        ("x", "'x' is none of the 84"),
        ("2.2", "expected x y z after 2.2, found 0 words"),
        ("2.2 0 0", "found 2 words"),
        ("2.2 0 0 0 0", "found 4 words"),
        ("2.2 0 a 0", "'a' is no number"),
        ("2.2 0 nan 0", "'nan' is no number"),
        ("2.2 0 1e999 0", "'1e999' is no number"),
        ("2.2 0 1_0 0", "'1_0' is no number"),
        ("2.1 0 0 0", "2.1 is there twice"),
        ("2" * 99, "is none"),
    ],
)
def test_bad_points_name_their_line(line: str, reason: str) -> None:
    with pytest.raises(DataError, match=reason) as caught:
        read_fdp(f"# points\n2.1 0 0 0\n\n{line}\n", "bad.fdp")
    assert (caught.value.path, caught.value.line) == ("bad.fdp", 4)


XFACE = """<?xml version="1.0" encoding="ISO-8859-1"?>
<!-- as Xface has it -->
<xfdp>
  <head version="0.2"/>
  <fapu ENS0="94" ES0="62.5" IRISD0="13" MNS0="3.5e1" MW0="87"/>
  <source>
    <entity alias="REST" category="ES"><mesh file="&lt;alice&gt;.wrl" format="wrl"/></entity>
  </source>
  <fdp affects="Face" index="2088" name="8.1">
    <indices>1 2
      3</indices>
    <influence fap="50" type="RaisedCosInfluenceWaveY" weight="0.5"/>
    <influence fap="16" weight="1"/>
  </fdp>
  <fdp affects="Hair" index="0" name="11.1"/>
</xfdp>
"""

READ = Xfdp(
    {"ENS0": 94, "ES0": 62.5, "IRISD0": 13, "MNS0": 35, "MW0": 87},
    (("<alice>.wrl", "wrl"),),
    (
        BoundPoint(
            "8.1", "Face", 2088, (1, 2, 3),
            (Influence(51, 0.5, "RaisedCosInfluenceWaveY"), Influence(17, 1, "RaisedCosInfluenceSph")),
        ),
        BoundPoint("11.1", "Hair", 0),
    ),
)  # fmt: skip


def test_xfdp_by_hand() -> None:
    """In the file FAPs count from 0."""
    assert read_xfdp(XFACE, "x") == READ


def test_xfdp_round_trip() -> None:
    text = format_xfdp(READ)
    assert 'fap="50"' in text
    assert read_xfdp(text, "x") == READ
    assert format_xfdp(read_xfdp(text, "x")) == text


NASTY = Xfdp(
    {}, (("\"&<'>", "\u03b1\n"),), (BoundPoint("2.1", "a\"b'c<", 7, (), (Influence(68, 1e-9, "&amp;"),)),)
)


def test_xfdp_escapes() -> None:
    assert read_xfdp(format_xfdp(NASTY), "x").points == NASTY.points


BOMB = '<?xml version="1.0"?>\n<!DOCTYPE x [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;&a;">]>\n<xfdp>&b;</xfdp>'
POINT = '<xfdp><fdp name="2.1" index="1">'
OUTSIDE = '<!DOCTYPE xfdp SYSTEM "file:///etc/passwd">\n<xfdp/>'


@pytest.mark.parametrize(
    ("text", "line", "reason"),
    [
        ("", 1, "broken XML: no element found"),
        ("hello", 1, "broken XML"),
        ("<html/>", 1, "the root is <html>, not <xfdp>"),
        ("<xfdp>\n<fdp>\n</xfdp>", 2, "'' is none of the 84"),
        ("<xfdp>\n</fdp>", 2, "broken XML: mismatched tag"),
        ("<xfdp>\n&x;</xfdp>", 2, "broken XML: undefined entity"),
        (BOMB, 2, "a DOCTYPE is not allowed"),
        (OUTSIDE, 1, "a DOCTYPE is not allowed"),
        ("<xfdp>\n" + "<a>" * 20, 2, "elements within more than 16 others"),
        ('<xfdp>\n<fapu MW0="wide"/></xfdp>', 2, "'wide' is no number"),
        ('<xfdp>\n<fapu MW0="inf"/></xfdp>', 2, "'inf' is no number"),
        ('<xfdp><fdp name="1.2" index="0"/></xfdp>', 1, "none of the 84"),
        ('<xfdp><fdp name="2.1"/></xfdp>', 1, "'' is no index"),
        ('<xfdp><fdp name="2.1" index="-1"/></xfdp>', 1, "'-1' is no index"),
        ('<xfdp><fdp name="2.1" index="\u0661"/></xfdp>', 1, "is no index"),
        (f'<xfdp><fdp name="2.1" index="{"9" * 99}"/></xfdp>', 1, "is no index"),
        (f"{POINT}</fdp>\n{POINT[6:]}</fdp></xfdp>", 2, "2.1 is there twice"),
        (f"{POINT}\n{POINT[6:]}</fdp></fdp></xfdp>", 2, "an fdp within an fdp"),
        (f"{POINT}<indices>1\nx</indices></fdp></xfdp>", 2, "'x' is no index"),
        (f'{POINT}<influence fap="68"/></fdp></xfdp>', 1, "fap 68; it counts from 0, to 67"),
        (f"{POINT}<influence/></fdp></xfdp>", 1, "'' is no fap"),
        (f'{POINT}<influence fap="1" weight="x"/></fdp></xfdp>', 1, "'x' is no number"),
    ],
)  # fmt: skip
def test_bad_xfdp_names_its_line(text: str, line: int, reason: str) -> None:
    with pytest.raises(DataError, match=reason) as caught:
        read_xfdp(text, "bad.xfdp")
    assert (caught.value.path, caught.value.line) == ("bad.xfdp", line)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("MAX_CHARACTERS", "<xfdp>" + " " * 99),
        ("MAX_MESHES", "<xfdp>" + "<mesh/>" * 20 + "</xfdp>"),
        ("MAX_INFLUENCES", POINT + '<influence fap="1"/>' * 20 + "</fdp></xfdp>"),
    ],
)
def test_sizes_are_bounded(name: str, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fdp, name, 9)
    with pytest.raises(DataError, match="more than 9"):
        read_xfdp(text, "x")


def test_a_bomb_takes_no_time() -> None:
    entities = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10 if k else "lol"}">' for k in range(12))
    began = time.process_time()
    with pytest.raises(DataError, match="DOCTYPE"):
        read_xfdp(f"<!DOCTYPE x [{entities}]><xfdp>&e11;</xfdp>", "x")
    assert time.process_time() - began < 0.5


PIECES = st.sampled_from(
    ["<xfdp>", "</xfdp>", '<fdp name="2.1" index="1">', "</fdp>", "<indices>", "</indices>", "1 2 3", "&lt;",
     "<influence fap='3' weight='0.5'/>", "<mesh file='a'/>", "<fapu MW0='1'/>", "<!-- x -->", "]]>",
     "<![CDATA[", "\0"]
)  # fmt: skip


@settings(deadline=None)
@given(st.lists(PIECES | st.text(max_size=5), max_size=20).map("".join))
def test_fuzz_xfdp(text: str) -> None:
    with suppress(DataError):
        xfdp = read_xfdp(text, "fuzz")
        assert read_xfdp(format_xfdp(xfdp), "again").points == xfdp.points


WORDS = st.sampled_from(["2.1", "3.3", "0", "-1.5", "nan", "#", "\n", ","]) | st.text(max_size=4)


@settings(deadline=None)
@given(st.lists(WORDS).map(" ".join))
def test_fuzz_fdp(text: str) -> None:
    with suppress(DataError):
        read_fdp(text, "fuzz")


CORPUS = Path(__file__).with_name("corpus")


@pytest.mark.parametrize("path", sorted(CORPUS.glob("*fdp")), ids=lambda path: path.name)
def test_the_corpus(path: Path) -> None:
    """What was found by mutation: refused, with the line."""
    read = read_xfdp if path.suffix == ".xfdp" else read_fdp
    text = path.read_bytes().decode("utf-8", "replace")
    with pytest.raises(DataError, match=rf"^{path.name}:\d+: "):
        read(text, path.name)
