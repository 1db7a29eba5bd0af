"""Rhythm and melody of a language as `data/prosody.toml` has them, with what a user wants to be other."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

from fapstream.errors import DataError
from fapstream.tts.durations import DurationModel
from fapstream.tts.melody import MelodyModel, Tune
from fapstream.tts.sounds import Sound, sounds
from fapstream.tts.tables import read_text

PATH = "prosody.toml"
LIMIT = 10_000.0
"""No entry of the table is greater."""


class Stop(NamedTuple):
    """What a phrase end sounds like: pause, tune, and how far the declination starts again (0..1)."""

    pause_ms: float
    tune: str
    reset: float


@dataclass(frozen=True, slots=True)
class Prosody:
    """Everything that makes phones of one language last and sing."""

    sounds: dict[str, Sound]
    durations: DurationModel
    melody: MelodyModel
    stops: Mapping[str, Stop]
    emphasis_length: float
    """How much longer a word of emphasis 1 is."""
    emphasis_gain: float
    """How much louder."""


@cache
def _table() -> Mapping[str, Any]:
    return tomllib.loads(read_text(PATH))


@cache
def standard(lang: str) -> Prosody:
    """The language's own. Raises DataError."""
    return prosody(lang, {}, {})


def prosody(lang: str, changes: Mapping[str, Any], means: Mapping[str, float]) -> Prosody:
    """With `changes` to entries of the table, which has the same shape, and mean durations of phones in ms.

    Raises DataError where an entry is none of the table's or out of bounds.
    """
    table = _merged(_table(), changes, "")
    emphasis = table["emphasis"]
    tunes = {name: Tune(**values) for name, values in table["tunes"][lang].items()}
    return Prosody(
        sounds=sounds(lang, means),
        durations=DurationModel(lang, table["durations"][lang]),
        melody=MelodyModel(table["melody"], tunes),
        stops={kind: Stop(**values) for kind, values in table["stops"].items()},
        emphasis_length=emphasis["length"],
        emphasis_gain=emphasis["gain"],
    )


def question_words(lang: str) -> frozenset[str]:
    """Spoken words with one of which among its first two a question falls at its end."""
    return frozenset(_table()["question_words"][lang])


def _merged(base: Mapping[str, Any], changes: Mapping[str, Any], where: str) -> dict[str, Any]:
    out = dict(base)
    for name, value in changes.items():
        place = f"{where}.{name}".lstrip(".")
        if name not in base:
            raise DataError(
                "profile", None, f"there is no {place}; {where or 'it'} has {', '.join(base)}"[:400]
            )
        old = base[name]
        if isinstance(old, Mapping):
            if not isinstance(value, Mapping):
                raise DataError("profile", None, f"{place} is a table")
            out[name] = _merged(old, value, place)
        elif isinstance(old, str):
            if value not in _names(base, name):
                raise DataError("profile", None, f"{place}: there is no {value!r}")
            out[name] = value
        elif isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise DataError("profile", None, f"{place} is a number, not {value!r}")
        elif abs(value) > LIMIT or (old > 0.0 > value and place.startswith(("stops", "durations"))):
            raise DataError("profile", None, f"{place} = {value!r} is out of bounds")
        else:
            out[name] = float(value)
    return out


def _names(base: Mapping[str, Any], name: str) -> frozenset[str]:
    """What may stand for a name: the tunes."""
    return frozenset(_table()["tunes"]["en"]) if name == "tune" else frozenset((base[name],))
