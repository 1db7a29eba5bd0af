"""`fapstream say`: four files of one turn that agree with each other."""

from __future__ import annotations

import base64
import io
import json
import os
import sys
import wave
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from fapstream.adapters.audio import AudioUnavailable, Render
from fapstream.adapters.pool import installed
from fapstream.cli import main, say
from fapstream.records import Pcm
from fapstream.tts import pho
from fapstream.tts.voices import voice
from fapstream.viewer.sound import SilentDevice

TEXT = {"en": "Hello world, it is 21:45. \\:)500 Good bye!", "el": "Καλημέρα κόσμε. \\:)500 Τι κάνεις;"}

VOICES = [
    pytest.param(name, marks=() if installed(voice(name)) else pytest.mark.skip("not installed"))
    for name in ("us1", "gr2", "espeak-en", "espeak-el")
]


class Files:
    def __init__(self, folder: Path) -> None:
        self.wav, self.fap, self.pho, self.marks = (folder / f"a.{x}" for x in ("wav", "fap", "pho", "json"))
        self.options = [f"--{x}={getattr(self, x)}" for x in ("wav", "fap", "pho", "marks")]

    def sound(self) -> tuple[int, Pcm]:
        with wave.open(str(self.wav)) as f:
            assert (f.getnchannels(), f.getsampwidth()) == (1, 2)
            return f.getframerate(), np.frombuffer(f.readframes(f.getnframes()), "<i2")

    def described(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(self.marks.read_text(encoding="utf-8"))
        return found


@pytest.fixture
def files(tmp_path: Path) -> Files:
    return Files(tmp_path)


@pytest.mark.parametrize("fps", [25, 50])
@pytest.mark.parametrize("name", VOICES)
def test_the_files_agree(name: str, fps: int, files: Files) -> None:
    v = voice(name)
    assert main(["say", TEXT[v.lang], "--voice", name, f"--fps={fps}", *files.options]) == 0
    rate, pcm = files.sound()
    assert rate == v.sample_rate
    assert np.abs(pcm).max() > 2000
    described = files.described()
    assert (described["voice"], described["lang"], described["sample_rate"]) == (name, v.lang, rate)

    header = files.fap.read_text(encoding="ascii").splitlines()[0].split()
    assert header == ["2.1", "a", str(fps), str(-(-len(pcm) * fps // rate))]

    marks = described["marks"]
    phones = [m for m in marks if m["kind"] == "phone"]
    end = phones[-1]["sample"] + phones[-1]["duration"]
    assert abs(end - len(pcm)) <= 0.001 * rate + 2 * v.period
    assert [m["text"] for m in marks if m["kind"] == "expression"] == ["joy"]
    assert all(m["time_ms"] == pytest.approx(1000 * m["sample"] / rate, abs=0.001) for m in marks)
    text = TEXT[v.lang]
    written = [m for m in marks if m["kind"] == "word"]
    assert all(text[m["char_start"] : m["char_end"]] == m["text"] for m in written)

    lines = pho.parse(files.pho.read_text(encoding="ascii"))
    if v.engine == "mbrola":
        total = sum(int(line.duration_ms * rate / 1000) for line in lines)
        assert total == len(pcm) + v.period
    else:
        assert [line.name for line in lines] == [m["text"] for m in phones]


def test_the_same_call_writes_the_same_files(tmp_path: Path) -> None:
    made = []
    for folder in (tmp_path / "1", tmp_path / "2"):
        folder.mkdir()
        files = Files(folder)
        assert main(["say", TEXT["en"] * 3, *files.options]) == 0
        made.append([files.wav.read_bytes(), files.pho.read_bytes(), files.marks.read_bytes()])
    assert made[0] == made[1]


def test_seed_and_rate(files: Files) -> None:
    def faces(*options: str) -> str:
        assert main(["say", "Hello there, you.", f"--fap={files.fap}", f"--wav={files.wav}", *options]) == 0
        return files.fap.read_text(encoding="ascii")

    assert faces("--seed=1") != faces("--seed=2")
    slow = len(files.sound()[1])
    faces("--rate=2")
    assert len(files.sound()[1]) < 0.75 * slow


@pytest.mark.parametrize("text", ["", "  \n", "...", "🫨", "\x00\x07"])
def test_nothing_to_say_writes_empty_files(text: str, files: Files) -> None:
    assert main(["say", text, *files.options]) == 0
    assert len(files.sound()[1]) == 0
    assert files.fap.read_text(encoding="ascii").split()[:4] == ["2.1", "a", "25", "0"]
    assert files.described()["marks"] == []


def test_an_argument_that_is_no_unicode(files: Files) -> None:
    assert main(["say", "one \udcff two", *files.options]) == 0
    words = [m["text"] for m in files.described()["marks"] if m["kind"] == "word"]
    assert words == ["one", "two"]


class Pipe:
    """Standard input as a pipe that already holds everything."""

    def __init__(self, data: bytes) -> None:
        self._read, write = os.pipe()
        os.write(write, data)
        os.close(write)

    def fileno(self) -> int:
        return self._read


def test_text_from_stdin(files: Files, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(say, "READ_BYTES", 3)
    monkeypatch.setattr("sys.stdin", Pipe("Καλημέρα κόσμε. \xff".encode()[:-2] + b"\xff \xce"))
    assert main(["say", "-", "--lang", "el", *files.options]) == 0
    words = [m["text"] for m in files.described()["marks"] if m["kind"] == "word"]
    assert words[:2] == ["Καλημέρα", "κόσμε"]


def test_more_text_than_may_wait(files: Files) -> None:
    assert main(["say", " " * 300_000 + "yes.", *files.options]) == 0
    [word] = [m for m in files.described()["marks"] if m["kind"] == "word"]
    assert (word["text"], word["char_start"]) == ("yes", 300_000)


class Card(SilentDevice):
    """Nobody hears it, but it keeps count."""

    made: ClassVar[list[Card]] = []

    def __init__(self, sample_rate: int, render: Render) -> None:
        self.loud, self.closed = 0, False
        super().__init__(sample_rate, lambda n, at: self._counted(render(n, at)))
        self.made.append(self)

    def _counted(self, pcm: Pcm) -> Pcm:
        self.loud += int((pcm != 0).sum())
        return pcm

    def close(self) -> None:
        self.closed = True


def test_playing(files: Files, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(say, "Output", Card)
    Card.made.clear()
    assert main(["say", "Hello."]) == 0
    assert main(["say", "Hello.", "--play", f"--wav={files.wav}"]) == 0
    assert [card.closed for card in Card.made] == [True, True]
    written = int((files.sound()[1] != 0).sum())
    assert [card.loud for card in Card.made] == [pytest.approx(written, rel=0.02)] * 2


def test_no_way_to_play_exits_1(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def card(*_: object) -> None:
        raise AudioUnavailable("no sound device can be opened")

    monkeypatch.setattr(say, "Output", card)
    assert main(["say", "Hello."]) == 1
    assert capsys.readouterr().err == "fapstream: no sound device can be opened; or write a file with --wav\n"


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (["--voice", "nobody"], "no voice called 'nobody'"),
        (["--voice", "us1", "--lang", "el"], "us1"),
        (["--wav", "/nowhere/at/all.wav"], "/nowhere/at/all.wav"),
        (["--fap", "/nowhere/at/all.fap"], "all.fap"),
    ],
)
def test_what_cannot_be_done_exits_1(
    argv: list[str], message: str, files: Files, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["say", "Hello.", f"--marks={files.marks}", *argv]) == 1
    error = capsys.readouterr().err
    assert error.startswith("fapstream: ")
    assert message in error
    assert error.count("\n") == 1


CHILDREN = Path(f"/proc/self/task/{os.getpid()}/children")


@pytest.mark.skipif(not CHILDREN.exists(), reason="the kernel does not tell")
def test_a_voice_is_given_back_when_a_file_cannot_be_written() -> None:
    """Or its program would outlive the command's event loop."""
    before = children()
    assert main(["say", "Hello.", "--wav=/nowhere/at/all.wav"]) == 1
    assert children() == before


def children() -> set[str]:
    """Processes that this one has started and that have not ended."""
    return set(CHILDREN.read_text(encoding="ascii").split())


@pytest.mark.parametrize(
    "argv",
    [
        [],
        ["a", "--fps", "30"],
        ["a", "--lang", "xx"],
        ["a", "--rate", "0.1"],
        ["a", "--rate", "nan"],
        ["a", "b"],
        ["a", "--seed", "x"],
    ],
)
def test_a_wrong_call_exits_2(argv: list[str]) -> None:
    try:
        status: object = main(["say", *argv])
    except SystemExit as e:
        status = e.code
    assert status == 2


def test_stdin_is_not_read_for_a_text_given(files: Files, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("never"))
    assert main(["say", "Hello.", *files.options]) == 0


def test_explain_says_where_phones_come_from(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    lexicon = tmp_path / "l.tsv"
    lexicon.write_text("fapstream\tf { p s t r i1 m\n")
    text = "Hello fapstream, it is 21:45 γεια."
    assert main(["say", text, "--voice=espeak-en", "--explain", f"--lexicon={lexicon}"]) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines() if not line.startswith(" ")]
    assert {row[0]: row[3] for row in rows} == {
        "Hello": "lexicon",
        "fapstream": "user",
        "it": "lexicon",
        "is": "lexicon",
        "21:45": "lexicon",
        "γεια": "rule",
    }


def test_a_voice_program_and_a_file_of_timed_phones(files: Files, tmp_path: Path) -> None:
    program = Path(__file__).parents[2] / "e2e" / "sine_voice.py"
    assert main(["say", "Hello there.", f"--voice-program={sys.executable} {program}", *files.options[:2],
                 files.options[3]]) == 0  # fmt: skip
    rate, pcm = files.sound()
    assert rate == 16000
    described = files.described()
    assert [m["text"] for m in described["marks"] if m["kind"] == "word"] == ["Hello", "there"]
    marks = [m for m in described["marks"] if m["kind"] == "phone"]
    rows = [{"sample_rate": rate}]
    rows += [
        {"phone": m["text"], "start": m["sample"] / rate, "duration": m["duration"] / rate} for m in marks
    ]
    rows += [{"pcm": base64.b64encode(pcm.astype("<i2").tobytes()).decode()}]
    timed = tmp_path / "t.jsonl"
    timed.write_text("\n".join(map(json.dumps, rows)))
    face = files.fap.read_bytes()
    assert main(["say", "Hello there.", f"--timed={timed}", *files.options[:2], files.options[3]]) == 0
    assert np.array_equal(files.sound()[1], pcm)
    assert files.fap.read_bytes() == face, "the same phones at the same times make the same face"


@pytest.mark.parametrize(
    "options", [["--timed=a", "--voice-program=b"], ["--timed=a", "--pho=b"], ["--timed=a", "--voice=us1"]]
)
def test_three_voices_at_once_are_refused(options: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["say", "a", *options]) == 1
    assert "three voices" in capsys.readouterr().err


def f0(sound: np.ndarray, rate: int) -> float:
    """Median pitch of the loudest frames, by the highest peak of their autocorrelation."""
    size, found = rate // 20, []
    frames = [sound[at : at + size] for at in range(0, len(sound) - size, size)]
    for frame in sorted(frames, key=lambda f: float((f**2).sum()))[len(frames) // 2 :]:
        own = np.correlate(frame, frame, "full")[size - 1 :]
        low, high = rate // 400, rate // 70
        found.append(rate / (low + int(own[low:high].argmax())))
    return float(np.median(found))


@pytest.mark.parametrize("name", VOICES)
def test_volume_and_pitch_are_heard(name: str, files: Files) -> None:
    def loudness(*options: str) -> tuple[float, float]:
        text = TEXT[voice(name).lang].split("\\")[0]
        assert main(["say", text, "--voice", name, files.options[0], *options]) == 0
        rate, pcm = files.sound()
        sound = pcm.astype(float)
        return float(np.sqrt((sound**2).mean())), f0(sound, rate)

    plain, soft, high = loudness(), loudness("--volume=0.5"), loudness("--pitch=1.5")
    assert soft[0] == pytest.approx(0.5 * plain[0], rel=0.05)
    assert 1.25 < high[1] / plain[1] < 1.8
