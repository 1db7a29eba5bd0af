"""How long our phones are, beside espeak-ng's plan of the same text and beside one speaker's own.

usage: tools/bench durations [--json] [--grid DIRECTORY]

Phones of the same name are compared one by one along the text; ours are scaled to the other side's mean
first, because speaking rates differ. --grid: the folder of the GRID recordings' alignment (phones.json,
phone_durations.tsv), which is not part of the project: there a man speaks quick command sentences, and
espeak-ng is compared with him too.
"""

from __future__ import annotations

import argparse
import json
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from fapstream.records import SILENCE, Utterance
from fapstream.tts import FrontEnd, phone_set
from tests.benchmarks import espeak
from tests.benchmarks.sequences import Agreement, aligned
from tools.cmudict import token

DATA = Path(__file__).parent / "data"
ALLOPHONES = {
    "en": {"p_h": "p", "t_h": "t", "k_h": "k", "4": "t"},
    "el": {"S": "ts", "Z": "dz", "q": "gj", "N": "J", "V": "N", "R": "r", "X": "k", "Y": "p", "M": "m"},
}
"""Phones of us1 and gr2 that are realisations of others."""

Timed = list[tuple[str, float]]


def ours(text: str, lang: str) -> tuple[Timed, list[Utterance]]:
    """Phones and ms of a text, without pauses."""
    front = FrontEnd(lang)
    utterances = front.feed(text) + front.end()
    phones = [(p.name, p.duration_ms) for u in utterances for p in u.phones if p.name != SILENCE]
    return phones, utterances


def theirs(text: str, lang: str) -> Timed:
    """The same of espeak-ng, in our phones."""
    known = ALLOPHONES[lang]
    return [(known.get(p.name, p.name), p.ms) for p in espeak.plan(text, lang) if p.name != SILENCE]


def compare(pairs: Iterable[tuple[Timed, Timed]], lang: str) -> dict[str, Any]:
    """RMSE and correlation by phone class over texts."""
    classes: dict[str, Agreement] = defaultdict(Agreement)
    for a, b in pairs:
        for i, j in aligned([name for name, _ in a], [name for name, _ in b]):
            for kind in (phone_set(lang)[a[i][0]].kind, "all"):
                classes[kind].add(a[i][1], b[j][1])
    scale = sum(classes["all"].theirs) / sum(classes["all"].ours)
    table: dict[str, Any] = {"scale": round(scale, 3)}
    for kind, agreement in sorted(classes.items()):
        table[kind] = {
            "n": agreement.n,
            "rmse_ms": round(agreement.rmse(scale), 1),
            "correlation": round(agreement.correlation(), 3),
        }
    return table


def rate(lang: str, paragraphs: list[str]) -> float:
    """Syllables a second within phrases."""
    ms = syllables = 0.0
    for text in paragraphs:
        phones, _ = ours(text, lang)
        ms += sum(length for _, length in phones)
        syllables += sum(phone_set(lang)[name].kind == "vowel" for name, _ in phones)
    return round(1000 * syllables / ms, 2)


def grid(folder: Path, limit: int) -> dict[str, Any]:
    """Sentences of the speaker against our plan and espeak-ng's."""
    clips = json.loads((folder / "phones.json").read_text(encoding="utf-8"))
    real, us, es = [], [], []
    for words in list(clips.values())[:: max(1, len(clips) // limit)]:
        spoken = [w for w in words if not w[0].startswith("<")]
        text = " ".join(w[0].upper() if len(w[0]) == 1 else w[0] for w in spoken) + "."
        real.append([(token(p).rstrip("012"), 1000 * ms) for w in spoken for p, _, ms in w[3]])
        us.append(ours(text, "en")[0])
        es.append(theirs(text, "en") if espeak.available() else [])
    table = {"ours": compare(zip(us, real, strict=True), "en")}
    if espeak.available():
        table["espeak"] = compare(zip(es, real, strict=True), "en")
    table["means"] = _means(folder / "phone_durations.tsv", us)
    return table


def _means(path: Path, plans: Iterable[Timed]) -> dict[str, Any]:
    """Mean duration of each phone, ours in the same sentences against the measured table."""
    lengths: dict[str, list[float]] = defaultdict(list)
    for plan in plans:
        for name, ms in plan:
            lengths[name].append(ms)
    agreement = Agreement()
    for line in path.read_text(encoding="utf-8").splitlines()[1:]:
        phone, _, mean, *_ = line.split("\t")
        if phone == "SIL":
            continue
        name = token(phone).rstrip("012")
        if name in lengths:
            agreement.add(sum(lengths[name]) / len(lengths[name]), float(mean))
    scale = sum(agreement.theirs) / sum(agreement.ours)
    return {
        "n": agreement.n,
        "scale": round(scale, 3),
        "rmse_ms": round(agreement.rmse(scale), 1),
        "correlation": round(agreement.correlation(), 3),
    }


def measure(args: argparse.Namespace) -> dict[str, Any]:
    """Every table."""
    figures: dict[str, Any] = {}
    for lang in ("en", "el"):
        text = (DATA / f"udhr_{lang}.txt").read_text(encoding="utf-8")
        paragraphs = [p for p in text.split("\n\n") if p.strip()]
        figures[f"{lang}_syllables_per_s"] = rate(lang, paragraphs)
        if espeak.available():
            pairs = ((ours(p, lang)[0], theirs(p, lang)) for p in paragraphs)
            figures[f"{lang}_against_espeak"] = compare(pairs, lang)
    if args.grid:
        figures["grid"] = grid(args.grid, args.sentences)
    return figures


def show(name: str, value: Any, indent: str = "") -> None:
    """A table, or a figure."""
    if not isinstance(value, dict):
        print(f"{indent}{name:<24}{value:>10}")
    elif "rmse_ms" in value:
        row = "n {n:>6}  RMSE {rmse_ms:>6.1f} ms  r {correlation:>6.3f}".format(**value)
        print(f"{indent}{name:<12} {row}")
    else:
        print(f"{indent}{name}")
        for key, inner in value.items():
            show(key, inner, indent + "  ")


def main() -> None:
    """Print the tables, or one JSON object."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--grid", type=Path, metavar="DIRECTORY")
    parser.add_argument("--sentences", type=int, default=200, help="of the recordings")
    args = parser.parse_args()
    figures = measure(args)
    if args.json:
        written = json.dumps(figures)
        print(json.dumps(json.loads(written, parse_constant=lambda nan: None)))  # JSON has no NaN
        return
    for name, value in figures.items():
        show(name, value)


if __name__ == "__main__":
    main()
