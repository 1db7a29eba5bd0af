"""The whole way from a folder of a talker of whom everything is known, and what can go wrong on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream.errors import ClipError, DataError, FapstreamError
from fapstream.learn.articulatory import NAMES
from fapstream.learn.clips import Clip, Folder
from fapstream.learn.hmm import Recipe
from fapstream.learn.landmarks import Landmarks
from fapstream.learn.measured import RATE, Measured
from fapstream.learn.sentences import Sentence
from fapstream.learn.sentences import sentence as made_of
from fapstream.learn.training import (
    LEAST_CLIPS,
    SPEECH_S,
    WEIGHTS,
    WIDTHS_S,
    Filmed,
    Trained,
    choose,
    film,
    mean_fapu,
    predicted,
    speech,
    train,
)
from fapstream.motion.articulation import COLUMNS, SPOKEN
from fapstream.motion.hmm import HmmMouth
from fapstream.motion.learned import MouthModel
from fapstream.motion.speaker import FILE, pack, unpack
from fapstream.motion.spline import STEP_S, Smoothness
from fapstream.motion.units import TimedUnit
from tests.unit.learn.faces import FAPU
from tests.unit.learn.folders import SILENCE, heard
from tests.unit.learn.talkers import WORDS, Talker
from tools import train_motion

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
BIN = ("bin", WORDS["bin"])
QUICK = Recipe(flat=3, realigned=1, cloned=1, tied=1, min_frames=20.0, min_gain=20.0)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Folder:
    path = tmp_path_factory.mktemp("talker")
    return Folder(Talker().folder(path / "clips", {"train": 25, "dev": 4, "held": 8}))


@pytest.fixture(scope="module")
def trained(folder: Folder) -> Trained:
    return train(folder, "a talker of whom everything is known", recipe=QUICK)


def held(folder: Folder) -> list[tuple[Filmed, Sentence]]:
    """Clips that nothing was learned from; their sentences' parameters are the measured FAPs."""
    found = []
    for filmed in film(folder, "held", {}):
        found.append((filmed, made_of(filmed.clip, filmed.measured.faps[:, COLUMNS], False)))
    return found


def error(mouth: MouthModel, trained: Trained, clips: Sequence[tuple[Filmed, Sentence]]) -> float:
    """The part of the FAPs' variance in speech that a mouth does not predict from phones and times."""
    wrong, wanted = [], []
    for _, sentence in clips:
        made = trained.speaker.articulation.faps(predicted(mouth, sentence))
        measured = sentence.parameters[:: round(STEP_S * RATE)]
        n = min(len(made), len(measured))
        wrong.append(made[:n] - measured[:n])
        wanted.append(measured[:n])
    return float((np.concatenate(wrong) ** 2).mean() / np.concatenate(wanted).var(axis=0).mean())


def test_clips_that_were_not_learned_from_are_predicted(folder: Folder, trained: Trained) -> None:
    """A constant, the mean, would be wrong by 1."""
    clips = held(folder)
    assert len(clips) == 8
    assert error(trained.speaker.mouth("hmm"), trained, clips) < 0.15
    assert error(trained.speaker.mouth("ohman"), trained, clips) < 0.1


OTHERS = {"B": "G", "S": "B", "N": "P", "T": "W"}


def test_phones_matter(folder: Folder, trained: Trained) -> None:
    """Other words at the same times are predicted worse."""
    clips = held(folder)
    exchanged = [
        (
            filmed,
            replace(
                sentence,
                units=tuple(OTHERS.get(u, u) for u in sentence.units),
            ),
        )
        for filmed, sentence in clips
    ]
    mouth = trained.speaker.mouth("hmm")
    assert error(mouth, trained, exchanged) > 3 * error(mouth, trained, clips)


def test_the_same_clips_give_the_same_bytes(folder: Folder, trained: Trained) -> None:
    again = train(Folder(folder.path), trained.speaker.made, recipe=QUICK)
    assert pack(again.speaker) == pack(trained.speaker)


def test_a_speaker_is_small_and_is_read_again(trained: Trained) -> None:
    data = pack(trained.speaker)
    assert len(data) < 1_000_000
    found = unpack(data, "a file")
    assert pack(found) == data
    assert found.made == "a talker of whom everything is known"
    np.testing.assert_allclose(found.states.mean, trained.speaker.states.mean, rtol=1e-6, atol=1e-6)
    assert found.ohman.consonants == trained.speaker.ohman.consonants


def test_what_is_worth_knowing_is_told(trained: Trained) -> None:
    assert trained.left_out == {}
    assert trained.speaker.articulation.names == NAMES
    assert trained.explained.shape == (6,)
    assert 0.99 < trained.explained.sum() <= trained.components.sum() <= 1 + 1e-9
    assert trained.components.shape == (9,)


def test_the_jaw_opens_with_its_parameter(trained: Trained) -> None:
    jaw = trained.speaker.articulation.basis[0]
    assert jaw[SPOKEN.index(3)] > 50
    assert jaw[SPOKEN.index(5)] < -20


def test_every_step_is_told_as_often_as_the_tool_counts(folder: Folder) -> None:
    """The bar of tools/train_motion would else end before or after its end."""
    told: list[str] = []
    train(folder, "", told.append, QUICK)
    clips = len(folder.part("train")) + len(folder.part("dev"))
    assert len(told) == clips + QUICK.steps + 2 + 2
    assert told[:25] == ["measuring"] * 25


def clips_of(path: Path, talker: Talker, **split: int) -> Folder:
    return Folder(talker.folder(path / "clips", split))


def test_clips_that_cannot_be_used_are_left_out_and_it_is_said_why(tmp_path: Path) -> None:
    """A film that ends before what is said does too; one that goes on to the end of the last word is used."""
    long: tuple[str, tuple[str, ...]] = ("<sil>", ("SIL",) * 12)
    late = heard([long, long, BIN], 0.09)
    talker = Talker(
        lost={
            "train0": slice(14, 22),
            "train1": slice(None),
            "train2": slice(5, None),
            "dev0": slice(12, 24),
        },
        words={
            "train3": heard([SILENCE, SILENCE] * 6),
            "train4": late,
            "train5": heard([long, BIN]),
        },
        frames={"train4": 40, "train6": 0},
    )
    found = train(clips_of(tmp_path, talker, train=32, dev=2), "", recipe=QUICK)
    assert dict(found.left_out) == {
        "train0": "the face is lost while something is said",
        "train1": "there is no face in the clip",
        "train2": "the face is to be seen in only 5 frames: too short a clip",
        "train3": "train3: nothing is said in the clip",
        "train4": "the face is lost while something is said",
        "train6": "there is no face in the clip",
        "dev0": "the face is lost while something is said",
    }


def test_too_few_clips_are_refused(tmp_path: Path) -> None:
    talker = Talker(lost={f"train{i}": slice(None) for i in range(4)})
    folder = clips_of(tmp_path, talker, train=LEAST_CLIPS + 3, dev=0)
    with pytest.raises(ClipError, match=rf"clips: only {LEAST_CLIPS - 1} clips .* at least {LEAST_CLIPS}"):
        train(folder, "")


def test_an_empty_part_is_refused_and_an_empty_development_part_is_done_without(tmp_path: Path) -> None:
    with pytest.raises(ClipError, match="only 0 clips"):
        train(clips_of(tmp_path, Talker(), train=0, dev=2), "")
    found = train(clips_of(tmp_path, Talker(), train=LEAST_CLIPS, dev=0), "", recipe=QUICK)
    assert found.speaker.smoothness == Smoothness(WIDTHS_S[2], WEIGHTS[2])


@pytest.mark.parametrize("absent", ["train", "dev"])
def test_a_part_that_is_not_there_is_named_before_anything_is_learned(absent: str, tmp_path: Path) -> None:
    split = {"train": LEAST_CLIPS, "dev": 1}
    del split[absent]
    told: list[str] = []
    with pytest.raises(ClipError, match=f"no part '{absent}'"):
        train(clips_of(tmp_path, Talker(), **split), "", told.append, QUICK)
    assert told == []


def test_faces_that_are_lost_in_all_speech_leave_nothing_to_learn_from(tmp_path: Path) -> None:
    talker = Talker(lost={f"train{i}": slice(12, 24) for i in range(LEAST_CLIPS)})
    with pytest.raises(ClipError, match="no sentences to learn from"):
        train(clips_of(tmp_path, talker, train=LEAST_CLIPS, dev=0), "", recipe=QUICK)


def filmed(words: Sequence[tuple[str, Sequence[str]]], frames: int, scale: float = 1.0) -> Filmed:
    fapu = replace(FAPU, **{name: scale * getattr(FAPU, name) for name in ("irisd0", "mns0", "mw0")})
    measured = Measured(np.zeros((frames, 68)), np.zeros((frames, 1, 2)), np.ones(frames, bool), fapu)
    return Filmed(Clip("a clip", Landmarks(np.zeros((0, 0, 3)), ()), heard(words)), measured)


def test_speech_is_where_words_are_and_a_little_around_them() -> None:
    long = ("<sil>", ("SIL",) * 8)
    found = filmed([long, BIN, long], 200)
    assert speech(found) == slice(80 - round(SPEECH_S * 100), 110 + round(SPEECH_S * 100) + 1)
    assert speech(found, 0.0) == slice(80, 111)
    assert speech(filmed([BIN], 35)) == slice(0, 35)
    assert speech(filmed([BIN], 20), 0.0) == slice(0, 20)


def test_the_mean_face_is_the_mean_of_all() -> None:
    found = mean_fapu([filmed([], 1), filmed([], 1, 2.0)])
    assert found.mw0 == pytest.approx(1.5 * FAPU.mw0)
    assert found.es0 == pytest.approx(FAPU.es0)


def test_the_smoothness_with_the_least_error_is_chosen(trained: Trained, folder: Folder) -> None:
    """Talks that one of them made are nearest to what it makes."""
    states = trained.speaker.states
    truth = Smoothness(WIDTHS_S[3], WEIGHTS[3])
    talks = []
    for _, sentence in held(folder)[:3]:
        made = predicted(HmmMouth(states, truth), sentence)
        talks.append(replace(sentence, parameters=np.repeat(made, round(STEP_S * RATE), axis=0)))
    assert choose(states, talks) == truth
    assert choose(states, []) == Smoothness(WIDTHS_S[2], WEIGHTS[2])


class Watched:
    """A mouth that tells which instant it was asked for, and in which unit."""

    look_ahead = 2

    def parameters(self, units: Sequence[TimedUnit], of: Ints, first: int, rate: int) -> Floats:
        seconds = (first + np.arange(len(of))) * STEP_S
        starts, ends = (np.array([getattr(units[at], edge) for at in of]) for edge in ("start", "end"))
        assert (seconds * rate < ends + 1e-6).all()
        assert (seconds * rate >= np.maximum(starts, 0) - 1e-6).all()
        return np.stack([first + np.arange(len(of)), of], axis=1).astype(float)


def test_instants_are_made_once_in_the_units_that_they_are_in() -> None:
    lengths = np.array([13.7, 0.4, 1.2, 7.0, 2.0, 9.5])
    edges = np.concatenate([[-4.0], -4 + np.cumsum(lengths)])
    times = np.stack([edges[:-1], edges[1:]], axis=1)
    talk = Sentence("", np.zeros((30, 1)), ("SIL", "B", "AH0", "S", "T", "SIL"), times, (False,) * 6)
    found = predicted(Watched(), talk)
    assert found[:, 0].tolist() == list(range(15))
    assert (np.diff(found[:, 1]) >= 0).all()


def old(tmp_path: Path) -> Path:
    path = tmp_path / FILE
    path.write_bytes(b"a good file")
    return path


def test_a_good_file_takes_the_place_of_the_old_one(trained: Trained, tmp_path: Path) -> None:
    path = old(tmp_path)
    train_motion.write(trained, path)
    assert path.read_bytes() == pack(trained.speaker)
    assert [p.name for p in tmp_path.iterdir()] == [FILE]


def test_a_bad_file_never_takes_the_place_of_a_good_one(
    trained: Trained, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One that would not be read again, that holds what is no number, in which nothing stands in for some
    phones, that is too large, or for which there is no room."""
    path, speaker = old(tmp_path), trained.speaker
    states = replace(speaker.states, trees=speaker.states.trees[:-1])
    with pytest.raises(DataError, match=FILE):
        train_motion.write(replace(trained, speaker=replace(speaker, states=states)), path)
    for name in ("mean", "var", "stay"):
        states = replace(speaker.states, **{name: np.full_like(getattr(speaker.states, name), np.nan)})
        with pytest.raises(DataError, match=FILE):
            train_motion.write(replace(trained, speaker=replace(speaker, states=states)), path)
    ohman = replace(speaker.ohman, consonants=tuple(f"x{name}" for name in speaker.ohman.consonants))
    with pytest.raises(DataError, match="stands in for"):
        train_motion.write(replace(trained, speaker=replace(speaker, ohman=ohman)), path)
    with pytest.raises(FapstreamError, match="1000000 are allowed"):
        train_motion.write(replace(trained, speaker=replace(speaker, made="x" * 1_000_000)), path)

    def full(self: Path, data: bytes) -> int:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(Path, "write_bytes", full)
        with pytest.raises(OSError, match="No space"):
            train_motion.write(trained, path)
    assert path.read_bytes() == b"a good file"


def test_the_tool_says_what_is_wrong_and_leaves_the_file_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = old(tmp_path)
    few = Talker().folder(tmp_path / "few", {"train": 2, "dev": 1})
    for data, reason in ((tmp_path / "nowhere", "split.json"), (few, "only 2 clips")):
        monkeypatch.setattr("sys.argv", ["train_motion", str(data), "--out", str(path)])
        assert train_motion.main() == 1
        assert reason in capsys.readouterr().err
    assert path.read_bytes() == b"a good file"


def test_the_tool_trains_and_reports(
    folder: Folder, trained: Trained, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    path = old(tmp_path)
    monkeypatch.setattr("sys.argv", ["train_motion", str(folder.path), "--out", str(path), "--made", "here"])
    assert train_motion.main() == 0
    assert unpack(path.read_bytes(), FILE).made == "here"
    told = capsys.readouterr().out
    assert f"{path.stat().st_size} bytes" in told
    assert all(name in told for name in NAMES)
