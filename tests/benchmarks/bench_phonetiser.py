"""Text to timed phones: how fast, how right, how big, beside espeak-ng and g2p-en in the same run.

usage: tools/bench phonetiser [--json] [--greek-list greek_wikipron_dev.tsv] [--runs N]

Speed: the first 1000 words of the Universal Declaration of Human Rights in English and in Greek, one thread,
after warm-up on another text, everything up to the last phone's pitch; `espeak-ng` writing .pho for the same
words, the whole command. Both take the text as a stream and give phones as they go: ours is fed PIECE
characters at a time, and what comes is counted and let go as a server does it; `at_once` is one call that
returns everything. English words: the tenth of CMUdict that the trees were never shown (split by the word's
CRC-32). Greek words: a list in WikiPron's format, which is not part of the project: say where it is.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from fapstream.tts import DEFAULT_LOOK_AHEAD, PHRASE, FrontEnd, Manner
from tests.benchmarks import english_list, espeak, greek_list

DATA = Path(__file__).parent / "data"
WORDS = 1000
WARM_UP = {
    "en": "Yesterday it rained all day long; nobody went out, and by 9:30 the streets were under water. "
    "Will the trains run again tomorrow? Engineers hope so! ",
    "el": "Χθες έβρεχε όλη τη μέρα· κανείς δεν βγήκε, και στις 9:30 οι δρόμοι της Λάρισας είχαν πλημμυρίσει. "
    "Θα ξανατρέξουν αύριο τα τρένα; Οι μηχανικοί το ελπίζουν! ",
}
WARM_UPS = 40
"""How often it is read before each run, a thousand words: the other contestant has had the processor."""

PIECE = 200
"""Characters, about a sentence and a half."""

READY = """
import resource, sys, time
def rss(): return int(open("/proc/self/statm").read().split()[1]) * resource.getpagesize()
begin, before = time.perf_counter(), rss()
from fapstream.tts import FrontEnd
front = FrontEnd({lang!r})
front.feed({word!r}); front.end()
ready = time.perf_counter() - begin
{then}
print(ready, rss() - before)
"""
OWN = "from fapstream.tts.english import English; import numpy; before = rss(); own = English(); "
MEMORY = {
    "lexicon_mb": OWN + "own.lexicon_words()",
    "trees_mb": OWN + "own.lexicon_words(); before = rss(); own.warm()",
}
"""What is done between two looks at the memory: the lexicon with every word ready, then the trees."""


def text(lang: str) -> str:
    """The first words of the text."""
    return " ".join((DATA / f"udhr_{lang}.txt").read_text(encoding="utf-8").split()[:WORDS])


def ours(lang: str, look_ahead: int, piece: int) -> Callable[[], float]:
    """A function that reads the text once and tells how many seconds that took, after another one."""
    whole, manner = text(lang), Manner(look_ahead=look_ahead)

    def run() -> float:
        front = FrontEnd(lang, manner)
        front.feed(WARM_UP[lang] * WARM_UPS)
        front.end()
        begin = time.perf_counter()
        front = FrontEnd(lang, manner)
        words = 0
        for at in range(0, len(whole), piece):
            words += sum([len(u.words) for u in front.feed(whole[at : at + piece])])
        words += sum([len(u.words) for u in front.end()])
        elapsed = time.perf_counter() - begin
        assert words > 0.9 * WORDS
        return elapsed

    return run


def speed(runs: int) -> dict[str, float]:
    """Words a second, ours and espeak-ng's in turn; the best run of each: a busy machine only ever adds."""
    contestants: dict[str, Callable[[], float]] = {}
    for lang in WARM_UP:
        contestants[f"{lang}_words_per_s"] = ours(lang, PHRASE, PIECE)
        contestants[f"{lang}_words_per_s_usual_look_ahead"] = ours(lang, DEFAULT_LOOK_AHEAD, PIECE)
        contestants[f"{lang}_words_per_s_at_once"] = ours(lang, PHRASE, 10**9)
        if espeak.available():
            contestants[f"espeak_{lang}_words_per_s"] = partial(espeak.seconds, text(lang), lang)
            contestants[f"espeak_{lang}_start_s"] = partial(espeak.seconds, "a", lang)
    times: dict[str, list[float]] = {name: [] for name in contestants}
    for _ in range(runs):
        for name, run in contestants.items():
            times[name].append(run())
    found = {name: min(values) for name, values in times.items()}
    figures = {n: round(WORDS / s) for n, s in found.items() if not n.endswith("_start_s")}
    for part in ("{}words_per_s", "{}words_per_s_at_once", "espeak_{}words_per_s"):
        seconds = [found.get(part.format(f"{lang}_")) for lang in WARM_UP]
        if all(seconds):
            figures[part.format("")] = round(len(seconds) * WORDS / sum(s for s in seconds if s))
    figures |= {n: round(1000 * s, 1) for n, s in found.items() if n.endswith("_start_s")}
    return figures


def start_up(runs: int) -> dict[str, float]:
    """Milliseconds from `import` to the first phones, and what the English lexicon and its trees
    take in memory."""
    out: dict[str, float] = {}
    for lang, word in (("en", "Hello."), ("el", "Γεια.")):
        code = READY.format(lang=lang, word=word, then="")
        rows = [_run(code) for _ in range(runs)]
        out[f"{lang}_start_ms"] = round(1000 * statistics.median(r[0] for r in rows), 1)
    for name, then in MEMORY.items():
        code = READY.format(lang="el", word="Γεια.", then=then)
        out[name] = round(statistics.median(_run(code)[1] for _ in range(3)) / 1e6, 1)
    return out


def _run(code: str) -> tuple[float, int]:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    ready, grown = done.stdout.split()
    return float(ready), int(grown)


def english(limit: int) -> dict[str, dict[str, float]]:
    """Held-out words: ours by the trees alone, ours with stems and compounds of the other nine tenths,
    others."""
    words = english_list.held_out(limit)
    found = {}
    for name, predict in english_list.contestants(words).items():
        score = english_list.score_words(predict, words)
        found[name] = {
            "words": score.words,
            "accuracy": round(score.right / score.words, 4),
            "accuracy_with_stress": round(score.right_with_stress / score.words, 4),
            "phone_error_rate": round(score.phone_error_rate, 4),
        }
    return found


def greek(path: Path) -> dict[str, Any]:
    """The list: accuracy after mapping, strictly, and with free nasals merged; the classes of differences."""
    listed = greek_list.read_list(path)
    found: dict[str, Any] = {}
    for name, pronounce in (("ours", greek_list.ours), ("espeak", greek_list.espeak)):
        if name == "espeak" and not espeak.available():
            continue
        score = greek_list.score(pronounce(listed), listed)
        found[name] = {
            "words": score.words,
            "accuracy": round(score.percent("merged") / 100, 4),
            "accuracy_strict": round(score.percent("strict") / 100, 4),
            "accuracy_nasals_free": round(score.percent("nasal") / 100, 4),
            "differences": {kind: len(words) for kind, words in score.differences.items()},
        }
    return found


def measure(args: argparse.Namespace) -> dict[str, Any]:
    """Every figure."""
    figures: dict[str, Any] = {**speed(args.runs), **start_up(max(3, args.runs // 2))}
    if espeak.available():
        for name in ("words_per_s", "words_per_s_at_once"):
            figures[f"{name}_to_espeak"] = round(figures[name] / figures["espeak_words_per_s"], 2)
    figures["english"] = english(args.words)
    figures["en_word_accuracy"] = figures["english"]["trees"]["accuracy"]
    figures["en_phone_error_rate"] = figures["english"]["trees"]["phone_error_rate"]
    if args.greek_list:
        figures["greek"] = greek(args.greek_list)
        figures["el_word_accuracy"] = figures["greek"]["ours"]["accuracy"]
    return figures


def show(figures: dict[str, Any]) -> None:
    """The tables."""
    for name, value in figures.items():
        if not isinstance(value, dict):
            print(f"{name:<32}{value:>12,}")
    for table in ("english", "greek"):
        for name, row in figures.get(table, {}).items():
            cells = "  ".join(f"{k} {v:.4f}" for k, v in row.items() if isinstance(v, float))
            print(f"{table} {name:<18}{row['words']:>7} words  {cells}")
            if "differences" in row:
                print(
                    "   differences, strictly:", ", ".join(f"{k} {v}" for k, v in row["differences"].items())
                )
    if "greek" not in figures:
        print("greek: say where the list is: --greek-list greek_wikipron_dev.tsv")


def main() -> None:
    """Print the tables, or one JSON object."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--runs", type=int, default=15)
    parser.add_argument("--words", type=int, default=0, help="held-out English words to take; 0 for all")
    parser.add_argument("--greek-list", type=Path, metavar="F.tsv")
    args = parser.parse_args()
    figures = measure(args)
    if args.json:
        print(json.dumps(figures))
    else:
        show(figures)


if __name__ == "__main__":
    main()
