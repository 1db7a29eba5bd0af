"""What look-ahead costs and buys: the plan against that of whole phrases, and how soon sound can begin.

usage: tools/bench incremental [--json]

The text is the Universal Declaration of Human Rights. Price: durations and pitch of the phones, word by word
the same in every plan, against the plan with unlimited look-ahead. Gain: text comes at so many words a
second; onset is the time from the first word's arrival to when its phones are certain; gaps are what a
listener waits in between, the sound played as soon as it can be.
"""

from __future__ import annotations

import argparse
import json
import statistics
from pathlib import Path
from typing import Any

from fapstream.records import SILENCE, Phone, Utterance
from fapstream.tts import PHRASE, FrontEnd, Manner
from fapstream.tts.voices import default_voice
from tests.benchmarks import espeak
from tests.benchmarks.sequences import aligned

DATA = Path(__file__).parent / "data"
LOOK_AHEAD = (0, 1, 2, PHRASE)
WORDS_PER_S = (3.0, 5.0, 10.0)


def sentences(lang: str) -> list[str]:
    """Paragraphs of the text."""
    text = (DATA / f"udhr_{lang}.txt").read_text(encoding="utf-8")
    return [p.strip() for p in text.split("\n\n") if len(p.split()) > 5]


def manner(lang: str, look_ahead: int) -> Manner:
    """That of the language's voice."""
    return Manner(look_ahead=look_ahead).of(default_voice(lang))


def phones(lang: str, text: str, look_ahead: int) -> list[Phone]:
    """The plan, pauses left out."""
    front = FrontEnd(lang, manner(lang, look_ahead))
    found = [u for token in text.split(" ") for u in front.feed(token + " ")] + front.end()
    return [p for u in found for p in u.phones if p.name != SILENCE]


def price(lang: str, look_ahead: int) -> dict[str, float]:
    """Differences of durations and pitch from the whole phrase's plan."""
    ms, hz, changed = [], [], 0
    for text in sentences(lang):
        plan, whole = phones(lang, text, look_ahead), phones(lang, text, PHRASE)
        for a, b in zip(plan, whole, strict=True):
            assert a.name == b.name
            ms.append(a.duration_ms - b.duration_ms)
            hz.append(a.pitch[0][1] - b.pitch[0][1])
            changed += a.duration_ms != b.duration_ms or a.pitch != b.pitch
    return {
        "duration_rmse_ms": round(_rms(ms), 2),
        "pitch_rmse_hz": round(_rms(hz), 2),
        "phones_changed": round(changed / len(ms), 4),
    }


def _rms(values: list[float]) -> float:
    return float(statistics.fmean(v * v for v in values) ** 0.5)


def gain(lang: str, look_ahead: int, words_per_s: float) -> dict[str, float]:
    """Seconds to the first sound, and of waiting inside a sentence per word, at a pace of writing."""
    onsets, gaps, words = [], 0.0, 0
    for text in sentences(lang):
        front = FrontEnd(lang, manner(lang, look_ahead))
        free = None
        tokens = text.split(" ")
        for i, token in enumerate(tokens):
            now = i / words_per_s
            found = front.feed(token + " ")
            if i + 1 == len(tokens):
                found += front.end()
            if not found:
                continue
            if free is None:
                onsets.append(now)
                free = now
            gaps += max(0.0, now - free)
            free = max(free, now) + _seconds(found)
        words += len(tokens)
    return {"onset_s": round(statistics.fmean(onsets), 3), "gap_s_per_word": round(gaps / words, 4)}


def _seconds(utterances: list[Utterance]) -> float:
    return sum(p.duration_ms for u in utterances for p in u.phones) / 1000


def against_espeak(lang: str, look_ahead: int) -> dict[str, float]:
    """Correlation of a word's mean pitch with espeak-ng's plan of the whole text, as a yardstick."""
    ours, theirs = [], []
    for text in sentences(lang)[:20]:
        plan = phones(lang, text, look_ahead)
        other = [p for p in espeak.plan(text, lang) if p.name != SILENCE]
        for i, j in aligned([p.name for p in plan], [p.name for p in other]):
            if (f0 := other[j].f0_hz) is not None:
                ours.append(plan[i].pitch[0][1])
                theirs.append(f0)
    return {"pitch_correlation_with_espeak": round(statistics.correlation(ours, theirs), 3)}


def measure() -> dict[str, Any]:
    """Every row."""
    rows: dict[str, Any] = {}
    for lang in ("en", "el"):
        for look_ahead in LOOK_AHEAD:
            row: dict[str, float] = price(lang, look_ahead)
            for pace in WORDS_PER_S:
                row |= {f"{k}_at_{pace:g}": v for k, v in gain(lang, look_ahead, pace).items()}
            if espeak.available():
                row |= against_espeak(lang, look_ahead)
            rows[f"{lang}_{'phrase' if look_ahead == PHRASE else look_ahead}"] = row
    return rows


def main() -> None:
    """Print the table, or one JSON object."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    rows = measure()
    if args.json:
        print(json.dumps(rows))
        return
    names = list(next(iter(rows.values())))
    print(f"{'':<40}" + "".join(f"{name:>11}" for name in rows))
    for name in names:
        print(f"{name:<40}" + "".join(f"{row[name]:>11g}" for row in rows.values()))


if __name__ == "__main__":
    main()
