"""The voices: what each database or engine calls its phones, what it lacks, and how high it speaks."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Literal

from fapstream.errors import DataError, UnknownVoice
from fapstream.records import SILENCE
from fapstream.tts.rules import RuleSet
from fapstream.tts.tables import phone_set, read_text, require_language

_NAMES = ("us1", "us2", "us3", "en1", "gr1", "gr2", "espeak-en", "espeak-el")
_DEFAULTS = {"en": ("us1", "espeak-en"), "el": ("gr2", "espeak-el")}
_FIRST_CODE = 0xE000


@dataclass(frozen=True, slots=True)
class Voice:
    """One voice as its table `data/voices/<name>.toml` has it.

    `engine_voice`: the voice's name inside its engine. `period`: samples of one pitch period of an MBROLA
    database, 0 for others. `gain` multiplies the PCM; `drive` is MBROLA's own volume ratio (its
    option -v), below 1 where the database would clip.
    `phones`: language phone -> voice phones (eSpeak NG: its mnemonics), the identity where absent.
    `rules`: contextual realisations, over the characters of `code`. `stand_ins`: voice phones that may take
    another's place, best first. `missing`: left voice phone -> right ones that the database cannot join
    to it. `heard_ms`: classes of two neighbours -> how much later their boundary is heard than it is marked.
    """

    name: str
    engine: Literal["mbrola", "espeak"]
    engine_voice: str
    lang: str
    sample_rate: int
    period: int
    f0_hz: float
    f0_range_hz: tuple[float, float]
    gain: float
    drive: float
    description: str
    inventory: frozenset[str]
    phones: Mapping[str, tuple[str, ...]] = field(repr=False)
    rules: RuleSet = field(repr=False, compare=False)
    stand_ins: Mapping[str, tuple[str, ...]] = field(repr=False)
    missing: Mapping[str, frozenset[str]] = field(repr=False)
    heard_ms: Mapping[tuple[str, str], float] = field(repr=False)

    def heard_shift(self, left: str, right: str) -> int:
        """Samples from where the database puts the boundary of two language phones to where it is heard."""
        kinds = phone_set(self.lang)[left].kind, phone_set(self.lang)[right].kind
        return round(self.heard_ms.get(kinds, 0.0) * self.sample_rate / 1000)

    def joins(self, left: str, right: str) -> bool:
        """Whether the database has this diphone."""
        return right not in self.missing.get(left, ())


@cache
def phone_codes(lang: str) -> dict[tuple[str, int], str]:
    """(language phone, stress 0..2) -> the character that stands for it in a voice's rules."""
    names = [(name, stress) for name in phone_set(lang) for stress in range(3)]
    return {key: chr(_FIRST_CODE + i) for i, key in enumerate(names)}


def voices() -> tuple[Voice, ...]:
    """Every known voice, whether its program is on this machine or not. Raises DataError."""
    return tuple(voice(name) for name in _NAMES)


@cache
def voice(name: str) -> Voice:
    """The voice of that name. Raises UnknownVoice, DataError."""
    if name not in _NAMES:
        raise UnknownVoice(name, _NAMES)
    path = f"voices/{name}.toml"
    try:
        return _voice(path, tomllib.loads(read_text(path)))
    except (tomllib.TOMLDecodeError, KeyError, TypeError) as error:
        raise DataError(path, None, f"not a voice table: {error}") from error


def default_voice(lang: str, engine: Literal["mbrola", "espeak"] = "mbrola") -> Voice:
    """The voice a language is read with when none is asked for. Raises UnknownLanguage."""
    mbrola, espeak = _DEFAULTS[require_language(lang)]
    return voice(mbrola if engine == "mbrola" else espeak)


def _voice(path: str, table: dict[str, Any]) -> Voice:
    missing: dict[str, frozenset[str]] = {}
    for lefts, rights in table.get("missing", []):
        for left in lefts.split():
            missing[left] = missing.get(left, frozenset()) | set(rights.split())
    return Voice(
        name=table["name"],
        engine=table["engine"],
        engine_voice=table.get("engine_voice", table["name"]),
        lang=table["lang"],
        sample_rate=table["sample_rate"],
        period=table.get("period", 0),
        f0_hz=table["f0_hz"],
        f0_range_hz=(table["f0_range_hz"][0], table["f0_range_hz"][1]),
        gain=table["gain"],
        drive=table.get("drive", 1.0),
        description=table["description"],
        inventory=frozenset(table.get("inventory", SILENCE).split()),
        phones={name: tuple(own.split()) for name, own in table.get("map", {}).items()},
        rules=_rules(path, table),
        stand_ins={name: tuple(other.split()) for name, other in table.get("stand_ins", {}).items()},
        missing=missing,
        heard_ms={(k.split()[0], k.split()[1]): float(v) for k, v in table.get("heard_ms", {}).items()},
    )


def _rules(path: str, table: dict[str, Any]) -> RuleSet:
    codes = phone_codes(table["lang"])

    def encode(symbol: str) -> list[str]:
        """A vowel with a digit is that stress only, one without is any."""
        if symbol[-1] in "012":
            return [codes[(symbol[:-1], int(symbol[-1]))]]
        return [codes[(symbol, stress)] for stress in range(3)]

    rules = []
    for rule in table.get("rules", []):
        left, text, right, output = (part.strip() for part in rule.split("|"))
        rules.append((None, (left, text, right, output)))
    return RuleSet(rules, table.get("classes", {}), encode, path)
