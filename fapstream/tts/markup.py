"""The subset of SSML that the reader understands, tag by tag: how words are to be delivered, pauses, marks.

W3C, Speech Synthesis Markup Language 1.1. Elements: `speak p s break prosody emphasis say-as sub phoneme lang
mark`. A tag that is none of these, or lacks or garbles what it needs, is no tag: the reader reads it as text.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

from fapstream.tts.tables import LANGUAGES

MAX_BREAK_MS = 10_000.0
SCALE_LIMITS = (0.25, 4.0)
"""Nothing is spoken faster, higher or louder than this by mark-up, nor slower, lower or softer."""

_TAG = re.compile(r"<\s*(/?)\s*([A-Za-z][\w.-]*)((?:\s+[\w:.-]+\s*=\s*(?:\"[^\"<]*\"|'[^'<]*'))*)\s*(/?)\s*>")
_ATTRIBUTE = re.compile(r"([\w:.-]+)\s*=\s*(?:\"([^\"]*)\"|'([^']*)')")
_TIME = re.compile(r"\+?(\d{1,6}(?:\.\d{1,3})?)(ms|s)")
_PERCENT = re.compile(r"([+-]?)(\d{1,4}(?:\.\d{1,3})?)%")
_SEMITONES = re.compile(r"([+-]\d{1,2}(?:\.\d{1,3})?)st")
_DECIBELS = re.compile(r"([+-]\d{1,2}(?:\.\d{1,3})?)dB", re.IGNORECASE)
_NUMBER = re.compile(r"\d{1,3}(?:\.\d{1,3})?")
_COMMENT = re.compile(r"<(?:!--.*?--|[!?][^<>]*)>", re.DOTALL)

RATES = {"x-slow": 0.5, "slow": 0.75, "medium": 1.0, "default": 1.0, "fast": 1.35, "x-fast": 1.8}
PITCHES = {"x-low": 0.7, "low": 0.85, "medium": 1.0, "default": 1.0, "high": 1.2, "x-high": 1.45}
VOLUMES = {
    "silent": 0.0,
    "x-soft": 0.25,
    "soft": 0.5,
    "medium": 1.0,
    "default": 1.0,
    "loud": 1.5,
    "x-loud": 2.0,
}
EMPHASES = {"strong": 0.8, "moderate": 0.4, "none": 0.0, "reduced": -0.5}
BREAKS_MS = {"none": 0.0, "x-weak": 60.0, "weak": 150.0, "medium": 350.0, "strong": 700.0, "x-strong": 1200.0}
SAY_AS = frozenset(
    ("cardinal", "number", "ordinal", "digits", "characters", "spell-out", "verbatim", "date", "time",
     "telephone", "currency", "unit", "fraction")
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Style:
    """How words are delivered, besides what the whole turn asks for: factors on rate, pitch, range and
    volume; `emphasis` from -0.5 to 0.8; the language they are read in if not the turn's."""

    rate: float = 1.0
    pitch: float = 1.0
    range: float = 1.0
    volume: float = 1.0
    emphasis: float = 0.0
    lang: str = ""


PLAIN: Final = Style()


_NONE: Mapping[str, str] = {}


class Tag(NamedTuple):
    """One tag: `kind` is open, close or empty. `attributes` have been checked."""

    name: str
    kind: str
    attributes: Mapping[str, str] = _NONE


def parse(text: str) -> Tag | None:
    """The tag that a text from `<` to `>` is, or None if it is none; comments and the like have no name."""
    if _COMMENT.fullmatch(text):
        return Tag("", "empty")
    found = _TAG.fullmatch(text)
    if not found:
        return None
    closing, name, inside, empty = found.groups()
    attributes = {
        a.group(1).rpartition(":")[2]: a.group(2) or a.group(3) or "" for a in _ATTRIBUTE.finditer(inside)
    }
    check = _ELEMENTS.get(name)
    if check is None or (closing and (empty or inside)):
        return None
    if closing:
        return Tag(name, "close")
    return Tag(name, "empty" if empty else "open", attributes) if check(attributes) else None


def break_ms(tag: Tag) -> float:
    """How long a `break` is, ms."""
    if time := _TIME.fullmatch(tag.attributes.get("time", "").strip()):
        return min(float(time.group(1)) * (1.0 if time.group(2) == "ms" else 1000.0), MAX_BREAK_MS)
    return BREAKS_MS[tag.attributes.get("strength", "medium")]


def styled(style: Style, tag: Tag) -> Style:
    """The style inside an element that stands in text of `style`."""
    given = tag.attributes
    if tag.name == "emphasis":
        return replace(style, emphasis=EMPHASES[given.get("level", "moderate")])
    if tag.name == "lang":
        return replace(style, lang=given["lang"][:2].lower())
    if tag.name != "prosody":
        return style
    return replace(
        style,
        rate=_bounded(style.rate * (_rate(given.get("rate", "medium")) or 1.0)),
        pitch=_bounded(style.pitch * (_pitch(given.get("pitch", "medium")) or 1.0)),
        range=_bounded(style.range * (_pitch(given.get("range", "medium")) or 1.0)),
        volume=min(style.volume * _number_or(_volume(given.get("volume", "medium")), 1.0), SCALE_LIMITS[1]),
    )


def _bounded(value: float) -> float:
    return min(max(value, SCALE_LIMITS[0]), SCALE_LIMITS[1])


def _number_or(value: float | None, other: float) -> float:
    return other if value is None else value


def _rate(text: str) -> float | None:
    """A name, or a percentage of the rate (`+20%` is relative in the same sense), or a plain factor."""
    if (named := RATES.get(text)) is not None:
        return named
    if percent := _PERCENT.fullmatch(text):
        return _relative(percent)
    return float(text) if _NUMBER.fullmatch(text) and float(text) > 0 else None


def _pitch(text: str) -> float | None:
    if (named := PITCHES.get(text)) is not None:
        return named
    if percent := _PERCENT.fullmatch(text):
        return _relative(percent)
    semitones = _SEMITONES.fullmatch(text)
    return 2.0 ** (float(semitones.group(1)) / 12.0) if semitones else None


def _volume(text: str) -> float | None:
    """A name, decibels, or 0 to 100 as in SSML 1.0."""
    if (named := VOLUMES.get(text)) is not None:
        return named
    if decibels := _DECIBELS.fullmatch(text):
        return float(10.0 ** (float(decibels.group(1)) / 20.0))
    if percent := _PERCENT.fullmatch(text):
        return _relative(percent)
    return float(text) / 100.0 if _NUMBER.fullmatch(text) and float(text) <= 100 else None


def _relative(percent: re.Match[str]) -> float:
    value = float(percent.group(2)) / 100.0
    return (
        value if not percent.group(1) else 1.0 + value if percent.group(1) == "+" else 1.0 - min(value, 0.9)
    )


def _readable(attributes: Mapping[str, str], **readers: Callable[[str], float | None]) -> bool:
    return all(reader(attributes[name]) is not None for name, reader in readers.items() if name in attributes)


def _is_break(attributes: Mapping[str, str]) -> bool:
    time = attributes.get("time", "0ms").strip()
    return bool(_TIME.fullmatch(time)) and attributes.get("strength", "none") in BREAKS_MS


_ELEMENTS: Mapping[str, Callable[[Mapping[str, str]], bool]] = {
    "speak": lambda a: True,
    "p": lambda a: True,
    "s": lambda a: True,
    "break": _is_break,
    "prosody": lambda a: _readable(a, rate=_rate, pitch=_pitch, range=_pitch, volume=_volume),
    "emphasis": lambda a: a.get("level", "moderate") in EMPHASES,
    "lang": lambda a: a.get("lang", "")[:2].lower() in LANGUAGES,
    "say-as": lambda a: a.get("interpret-as", "") in SAY_AS,
    "sub": lambda a: bool(a.get("alias", "").strip()),
    "phoneme": lambda a: bool(a.get("ph", "").strip()),
    "mark": lambda a: bool(a.get("name", "").strip()),
}
