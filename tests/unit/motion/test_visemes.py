"""The tables of phones to visemes, and the keyframes of one phone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from fapstream import data
from fapstream.errors import DataError, UnknownLanguage
from fapstream.fap import EXPRESSIONS, visemes
from fapstream.motion import visemes as module
from fapstream.motion.visemes import N_CHANNELS, keyframes, mouth, phone_shapes, shapes
from fapstream.records import N_FAPS, SILENCE, Phone, TimedPhone
from fapstream.tts import LANGUAGES, phone_set

RATES = (16000, 22050)


def mixed(first: int, second: int, blend: int) -> NDArray[np.float64]:
    """ISO/IEC 14496-2, FAP 1: viseme1 * (blend / 63) + viseme2 * (1 - blend / 63)."""
    values: NDArray[np.float64] = visemes()[first] * (blend / 63) + visemes()[second] * (1 - blend / 63)
    return values


@pytest.mark.parametrize("lang", LANGUAGES)
def test_every_phone_has_a_row_and_every_row_is_a_phone(lang: str) -> None:
    assert set(phone_shapes(lang)) == set(phone_set(lang))


@pytest.mark.parametrize("lang", LANGUAGES)
def test_rows_make_sense(lang: str) -> None:
    for name, shape in phone_shapes(lang).items():
        assert shape.targets, name
        at = [t.at for t in shape.targets]
        assert at == sorted(set(at)), name
        assert all(0 < a < 1 for a in at), name
        assert 0.5 <= shape.unstressed <= 1, name


@pytest.mark.parametrize(
    ("lang", "phone", "expected"),
    [("en", "p", [(1, 1, 63)]), ("en", "@", [(11, 12, 34)]), ("en", "aU", [(10, 10, 63), (14, 14, 63)]),
     ("el", "a", [(10, 10, 63)]), ("el", "L", [(8, 12, 36)]), ("el", "ts", [(4, 7, 24)])],
)  # fmt: skip
def test_shapes_are_visemes_and_blends_of_two(
    lang: str, phone: str, expected: list[tuple[int, int, int]]
) -> None:
    targets = phone_shapes(lang)[phone].targets
    assert len(targets) == len(expected)
    for target, blend in zip(targets, expected, strict=True):
        assert target.values[:N_FAPS] == pytest.approx(mixed(*blend))


@pytest.mark.parametrize("lang", LANGUAGES)
def test_lips_that_must_close_are_never_weakened(lang: str) -> None:
    for phone in "pbmfv":
        assert phone_shapes(lang)[phone].unstressed == 1
        assert phone_shapes(lang)[phone].hold_ms >= 40, "a frame at 25 fps falls into it"


@pytest.mark.parametrize("lang", ["xx", "", "../en", "EN"])
def test_an_unknown_language(lang: str) -> None:
    with pytest.raises(UnknownLanguage) as caught:
        phone_shapes(lang)
    assert set(caught.value.known) == set(LANGUAGES)


@pytest.mark.parametrize(
    "row",
    ["a\t10@50\t0", "a\t10@50\t0\t100\tmore", "a\t10\t0\t100", "a\t15@50\t0\t100", "a\t-1@50\t0\t100",
     "a\t10/11:64@50\t0\t100", "a\t10/11@50\t0\t100", "a\tx@50\t0\t100", "a\t10@50\tx\t100", 
     "a\t10@x\t0\t100", "a\t\t0\t100", "a\t10@101\t0\t100"],
)  # fmt: skip
def test_a_bad_row_names_its_line(row: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "motion/data"
    folder.mkdir(parents=True)
    head = "# a comment\n# phone\ttargets\thold_ms\tunstressed\n\n"
    (folder / "visemes_qq.tsv").write_text(f"{head}_\t0@50\t0\t100\n{row}\n", encoding="utf-8")
    monkeypatch.setattr(data, "PACKAGE", str(tmp_path))
    with pytest.raises(DataError, match=r"visemes_qq\.tsv:5: "):
        phone_shapes.__wrapped__("qq")


def keys(
    name: str, length: int, rate: int = 16000, lang: str = "en", **more: object
) -> list[module.Keyframe]:
    phone = Phone(name, 1000 * length / rate, **more)  # type: ignore[arg-type]
    return list(keyframes(TimedPhone(phone, 1000, 1000 + length), lang, rate))


def test_one_shape_is_reached_in_the_middle() -> None:
    [key] = keys("s", 1600)
    assert key.sample == 1800
    assert key.values == pytest.approx(shapes()[7])
    assert not key.rest


def test_a_diphthong_has_two_shapes() -> None:
    first, second = keys("AI", 2000, stress=1)
    assert (first.sample, second.sample) == (1560, 2600)
    assert first.values == pytest.approx(shapes()[10])
    assert second.values == pytest.approx(shapes()[12])


def test_stress_opens_the_mouth_further() -> None:
    [strong], [weak] = keys("E", 1600, stress=1), keys("E", 1600)
    assert weak.values[:N_FAPS] == pytest.approx(0.85 * strong.values[:N_FAPS])
    assert weak.values[N_FAPS:].tolist() == strong.values[N_FAPS:].tolist() == [1, 0, 0]


def test_the_mouth_speaks_in_every_shape_and_touches_where_it_must() -> None:
    assert shapes().shape == (15, N_CHANNELS)
    table = [mouth(row) for row in shapes()]
    assert [m.speaks for m in table] == [0.0] + [1.0] * 14
    assert [m.seal for m in table] == [0.0, 1.0] + [0.0] * 13
    assert [m.bite for m in table] == [0.0, 0.0, 1.0] + [0.0] * 12
    for lang in LANGUAGES:
        for name, shape in phone_shapes(lang).items():
            touches = [max(mouth(t.values).seal, mouth(t.values).bite) for t in shape.targets]
            assert touches == ([1.0] if name in "pbmfv" else [0.0] * len(touches)), name


def test_a_closure_is_held_but_stays_within_its_phone() -> None:
    shut, still = keys("b", 1600)
    assert still.sample - shut.sample == 640
    assert np.array_equal(shut.values, still.values)
    for length in range(1, 1600, 7):
        inside = keys("p", length)
        assert all(1000 <= k.sample <= 1000 + length for k in inside)


@given(
    st.sampled_from([(lang, name) for lang in LANGUAGES for name in phone_set(lang)]),
    st.integers(0, 8000),
    st.sampled_from(RATES),
    st.sampled_from([None, *EXPRESSIONS]),
)
def test_keyframes_come_in_order_within_their_phone(
    phone: tuple[str, str], length: int, rate: int, expression: str | None
) -> None:
    lang, name = phone
    found = keys(name, length, rate, lang, expression=expression if name == SILENCE else None)
    samples = [k.sample for k in found]
    assert samples == sorted(samples)
    assert all(1000 <= s <= 1000 + length for s in samples)
    assert all(k.rest == (name == SILENCE) for k in found)


def test_a_pause_rests() -> None:
    into, out = keys(SILENCE, 16000)
    assert (into.sample, out.sample) == (1000 + 1920, 1000 + 16000 - 1920)
    assert not into.values.any()
    assert not out.values.any()
