"""How a turn is to be read: what a user can ask for, and the voice's pitch."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from fapstream.errors import DataError
from fapstream.records import Spoken
from fapstream.tts.say_as import phones_of
from fapstream.tts.tables import LANGUAGES, phone_set
from fapstream.tts.voices import Voice

PHRASE = 1_000_000
"""A look-ahead so long that it ends at the phrase's end."""

DEFAULT_LOOK_AHEAD = 0
"""What a text that is still being written is read with, if nobody says otherwise."""

SCALES = (0.25, 4.0)
"""Least and most of rate, pitch and volume."""

MEAN_LIMITS_MS = (10.0, 1000.0)
MAX_LEXICON = 200_000
"""Entries."""


@dataclass(frozen=True, slots=True)
class Manner:
    """The way a turn is read.

    `rate`, `pitch` and `volume` are factors. `f0_hz` is the voice's middle pitch and `range_hz` the width of
    its range. `look_ahead`: how many words after a word are waited for before it is spoken, PHRASE for as
    many as its phrase has. `lexicon`: the user's own readings, by the word in lower case. `prosody`: what
    stands instead of the same entries of prosody.toml. `means`: mean durations of phones by language, ms.
    """

    rate: float = 1.0
    pitch: float = 1.0
    volume: float = 1.0
    f0_hz: float = 120.0
    range_hz: float = 170.0
    look_ahead: int = PHRASE
    lexicon: Mapping[str, tuple[Spoken, ...]] = field(default_factory=dict)
    prosody: Mapping[str, Any] = field(default_factory=dict)
    means: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def of(self, voice: Voice) -> Manner:
        """The same for a voice."""
        low, high = voice.f0_range_hz
        return replace(self, f0_hz=voice.f0_hz, range_hz=high - low)


def read_lexicon(text: str, path: str, lang: str) -> dict[str, tuple[Spoken, ...]]:
    """A user's lexicon: lines of a word, a tab, and its phones, or in quotation marks the words it is read
    as.

    Phones are those of `fapstream phonemes`, one blank apart, vowels followed by their stress (0, 1 or 2).
    Blank lines and those beginning with `;` or `#` are skipped. Raises DataError naming the line.
    """
    entries: dict[str, tuple[Spoken, ...]] = {}
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line[0] in ";#":
            continue
        if len(entries) >= MAX_LEXICON:
            raise DataError(path, number, f"more than {MAX_LEXICON} entries")
        word, _, reading = (part.strip() for part in line.partition("\t"))
        if not (word and reading) or " " in word:
            raise DataError(path, number, "expected one word, a tab, and its phones or its reading in quotes")
        entries[word.lower()] = _reading(reading, path, number, lang)
    return entries


def _reading(reading: str, path: str, number: int, lang: str) -> tuple[Spoken, ...]:
    if reading[0] == '"' and reading[-1] == '"' and len(reading) > 2:
        words = reading[1:-1].split()
        if all(w.isalpha() or "'" in w for w in words):
            return tuple(words)
        raise DataError(path, number, f"a reading is made of words: {reading[:60]}")
    phones = phones_of(reading, lang)
    if phones is None:
        known = " ".join(sorted(name for name in phone_set(lang) if name != "_"))
        raise DataError(path, number, f"{reading[:60]!r} are not phones; there are: {known}")
    return (phones,)


def read_profile(text: str, path: str, manner: Manner) -> Manner:
    """`manner` with what a profile asks for: TOML with `rate`, `pitch`, `volume`, a table [phones.<language>]
    of mean durations in ms, and tables [durations.<language>], [melody], [stops], [tunes.<language>] with the
    entries of prosody.toml that are to be others. Raises DataError."""
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise DataError(path, None, f"not a profile: {error}") from error
    scales = [_scale(table.pop(n, getattr(manner, n)), n, path) for n in ("rate", "pitch", "volume")]
    means = {lang: _means(lang, given, path) for lang, given in table.pop("phones", {}).items()}
    _check(table, path)
    rate, pitch, volume = scales
    return replace(manner, rate=rate, pitch=pitch, volume=volume, prosody=table, means=means)


def _scale(value: Any, name: str, path: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not SCALES[0] <= value <= SCALES[1]:
        raise DataError(path, None, f"{name} is a number from {SCALES[0]:g} to {SCALES[1]:g}, not {value!r}")
    return float(value)


def _means(lang: str, given: Any, path: str) -> dict[str, float]:
    if lang not in LANGUAGES or not isinstance(given, dict):
        raise DataError(path, None, f"[phones.{lang}]: the languages are {', '.join(LANGUAGES)}")
    for name, ms in given.items():
        low, high = MEAN_LIMITS_MS
        if (
            name not in phone_set(lang)
            or isinstance(ms, bool)
            or not isinstance(ms, int | float)
            or not low <= ms <= high
        ):
            raise DataError(
                path,
                None,
                f"[phones.{lang}] {name} = {ms!r}: a phone and {low:g} to {high:g} ms are expected",
            )
    return {name: float(ms) for name, ms in given.items()}


def _check(table: Mapping[str, Any], path: str) -> None:
    known = ("durations", "melody", "stops", "tunes")
    for name in table:
        if name not in known or not isinstance(table[name], dict):
            raise DataError(
                path, None, f"{name}: a profile has rate, pitch, volume, phones, {', '.join(known)}"
            )
