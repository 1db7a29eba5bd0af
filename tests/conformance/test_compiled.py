"""What is compiled reads as its sources do (tools/compile.py)."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

import fapstream.tts.plan

ROOT = Path(__file__).parents[2]
COMPILED = fapstream.tts.plan.__file__.endswith(".so")
SENTENCES = {
    "en": "He paid $3.5m on 21/3/2026, <emphasis>not</emphasis> 5%; the zylograph of Οδυσσέας \\:) wept?",
    "el": "Πλήρωσε 3,5 εκ. € στις 21/3, <prosody rate='slow'>όχι</prosody> 5%· το iPhone \\:( έκλαψε;",
}
DATA = ROOT / "tests" / "benchmarks" / "data"
TEXTS = {
    lang: f"{more}\n\n{(DATA / f'udhr_{lang}.txt').read_text(encoding='utf-8')[:4000]}"
    for lang, more in SENTENCES.items()
}
READ = """
import json, sys
sys.path.insert(0, sys.argv[1])
from fapstream.tts import PHRASE, FrontEnd, Manner
from fapstream.tts import plan
found = []
for lang, text in json.load(sys.stdin).items():
    for look_ahead in (0, 1, PHRASE):
        front = FrontEnd(lang, Manner(look_ahead=look_ahead, rate=1.1))
        for at in range(0, len(text), 7):
            found += map(repr, front.feed(text[at : at + 7]))
            found += map(repr, front.hold() if at % 210 == 0 else [])
        found += map(repr, front.end())
json.dump([plan.__file__, found], sys.stdout)
"""


def read(directory: Path) -> tuple[str, list[str]]:
    """Where the planner came from, and the utterances, every figure of them."""
    done = subprocess.run(
        [sys.executable, "-c", READ, directory],
        input=json.dumps(TEXTS), capture_output=True, text=True, check=True,
    )  # fmt: skip
    path, utterances = json.loads(done.stdout)
    return path, utterances


@pytest.mark.skipif(not COMPILED, reason="the speech front-end runs from its sources")
def test_compiled_as_from_source(tmp_path: Path) -> None:
    package = tmp_path / "fapstream"
    (package / "tts").mkdir(parents=True)
    for path in [*(ROOT / "fapstream").iterdir(), *(ROOT / "fapstream" / "tts").iterdir()]:
        if path.name not in ("tts", "__pycache__") and path.suffix != ".so":
            (package / path.relative_to(ROOT / "fapstream")).symlink_to(path)
    from_source, compiled = read(tmp_path), read(ROOT)
    assert from_source[0].endswith(".py")
    assert compiled[0].endswith(".so")
    assert len(compiled[1]) > 100
    assert compiled[1] == from_source[1]
