"""Text through the front-end into the real MBROLA: it accepts every line and makes the promised samples."""

from __future__ import annotations

import random
import shutil
import subprocess
from pathlib import Path

import pytest

from fapstream.tts import FrontEnd, Manner
from fapstream.tts.english import english
from fapstream.tts.pho import Realiser
from fapstream.tts.voices import Voice, voices

DATABASES = Path("/usr/share/mbrola")
TEXTS = {
    "en": """The prime minister said on Tuesday that the government would publish its plans by 21:45.
Is it true? Dr. Smith paid $5 million for 3% of the U.S. firm (founded in 1984), didn't
he! NASA, pdf, XKCD; café and Γεια σου, κόσμε: the judge's badge, a thousand months,
sixths, rhythm, hmm, tsk, "Pfizer" and Schwarzenegger. """,
    "el": """Ο πρωθυπουργός δήλωσε ότι στις 21:45 η κυβέρνηση θα δημοσιεύσει τα σχέδιά της· αλήθεια;
Το 1821, οι άνθρωποι πλήρωναν 1.500 € για τρία γκαράζ, τσάι, τζατζίκι, παιδιά και
αγγούρια! Χιόνια, γιαγιά, μυαλό, λαχτάρα, στρατός, ψάρι, ξύλο, σβήνω, ΑΤΜ, laptop και
internet με e-mail στο Λος Άντζελες. """,
}

installed = [
    pytest.param(
        v, id=v.name, marks=() if (DATABASES / v.name / v.name).is_file() else pytest.mark.skip("no database")
    )
    for v in voices()
    if v.engine == "mbrola"
]


def speak(v: Voice, lines: str) -> tuple[int, str, int]:
    """(samples, standard error, exit status) of a fresh MBROLA."""
    database = DATABASES / v.name / v.name
    done = subprocess.run(
        ["mbrola", "-v", str(v.drive), str(database), "-", "-.raw"], input=lines.encode(), capture_output=True
    )
    return len(done.stdout) // 2, done.stderr.decode(), done.returncode


def written(v: Voice, text: str, step: int) -> tuple[str, int]:
    """The .pho of a text fed `step` characters at a time with a hold now and then, and its samples."""
    front, realiser = FrontEnd(v.lang, Manner(look_ahead=0).of(v)), Realiser(v)
    utterances = []
    for at in range(0, len(text), step):
        utterances += front.feed(text[at : at + step])
        if at % 5 == 0:
            utterances += front.hold()
    lines, samples = "", 0
    for utterance in utterances + front.end():
        written = realiser.write(utterance)
        lines += written.lines
        samples += written.ends[-1] if written.ends else 0
    return lines, samples


@pytest.mark.skipif(shutil.which("mbrola") is None, reason="MBROLA is not installed")
@pytest.mark.parametrize("v", installed)
@pytest.mark.parametrize("step", [7, 100_000])
def test_sentences(v: Voice, step: int) -> None:
    lines, promised = written(v, TEXTS[v.lang], step)
    samples, complaint, status = speak(v, lines)
    assert (complaint, status) == ("", 0)
    assert 0 <= promised - samples < v.period


@pytest.mark.skipif(shutil.which("mbrola") is None, reason="MBROLA is not installed")
@pytest.mark.parametrize("v", installed)
def test_random_words(v: Voice) -> None:
    """Real and invented words in any order, without `-e`: a missing diphone would end MBROLA."""
    rng = random.Random(7)
    if v.lang == "en":
        real = rng.sample(english().lexicon_words(), 3000)
        letters = "abcdefghijklmnopqrstuvwxyz"
    else:
        real = TEXTS["el"].split() * 5
        letters = "αβγδεζηθικλμνξοπρστυφχψωάέήίόύώϊϋΐΰ"
    invented = ["".join(rng.choices(letters, k=rng.randint(1, 9))) for _ in range(2000)]
    words = real + invented
    rng.shuffle(words)
    lines, promised = written(v, " ".join(words), 100_000)
    samples, complaint, status = speak(v, lines)
    assert (complaint, status) == ("", 0)
    assert 0 <= promised - samples < v.period
