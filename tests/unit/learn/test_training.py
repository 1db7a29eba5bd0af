"""From a folder to a speaker: the whole way, small, twice."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from fapstream.errors import ClipError, FapstreamError
from fapstream.learn.articulatory import ArticulatoryParameters
from fapstream.learn.clips import Folder
from fapstream.learn.hmm import Recipe
from fapstream.learn.training import Trained, choose, film, mean_fapu, predicted, sentences, speech, train
from fapstream.motion.hmm import HmmMouth
from fapstream.motion.ohman import OhmanMouth
from fapstream.motion.speaker import Speaker, pack, unpack
from fapstream.motion.spline import Smoothness
from tests.unit.learn.talker import MNS, folder

sys.path.insert(0, str(Path(__file__).parents[3]))

RECIPE = Recipe(min_frames=20, min_gain=10)


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> Folder:
    return Folder(folder(tmp_path_factory.mktemp("clips")))


@pytest.fixture(scope="module")
def trained(here: Folder) -> Trained:
    return train(here, "by a test", recipe=RECIPE)


def test_the_same_clips_make_the_same_file(here: Folder, trained: Trained) -> None:
    data = pack(trained.speaker)
    assert pack(train(here, "by a test", recipe=RECIPE).speaker) == data
    assert len(data) < 1_000_000
    assert unpack(data, "it").made == "by a test"
    assert not trained.left_out


@pytest.mark.parametrize("model", ["hmm", "ohman"])
def test_what_was_learned_predicts_clips_that_were_not(here: Folder, trained: Trained, model: str) -> None:
    left_out: dict[str, str] = {}
    learned = film(here, "train", left_out)
    parameters = ArticulatoryParameters().fit(
        [f.measured.points[speech(f)] for f in learned], mean_fapu(learned)
    )
    speaker = trained.speaker
    mouth = HmmMouth(speaker.states, speaker.smoothness) if model == "hmm" else OhmanMouth(speaker.ohman)
    for heard in sentences(film(here, "dev", left_out), parameters, False, left_out):
        made = predicted(mouth, heard)
        wanted = heard.parameters[::2][: len(made)]
        made = made[: len(wanted)]
        for k in range(2):
            assert np.corrcoef(made[:, k], wanted[:, k])[0, 1] > 0.75


def test_explained_variance_is_told(trained: Trained) -> None:
    assert trained.explained.shape == (6,)
    assert 0.9 < trained.explained.sum() <= 1
    assert trained.components.sum() <= 1 + 1e-9


def test_the_mean_face_has_its_units(here: Folder) -> None:
    assert mean_fapu(film(here, "train", {})).mns0 == pytest.approx(MNS / 1000, rel=0.03)


def test_smoothness_is_what_fits_sentences_that_were_not_learned(here: Folder, trained: Trained) -> None:
    assert choose(trained.speaker.states, []) == Smoothness(0.08, 0.3)
    assert trained.speaker.smoothness.width_s in (0.04, 0.06, 0.08, 0.1, 0.12)


def test_too_few_clips_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ClipError, match="only 5 clips"):
        train(Folder(folder(tmp_path, 5, 1)), "", recipe=RECIPE)


def test_clips_that_cannot_be_used_are_left_out_with_the_reason(tmp_path: Path) -> None:
    path = folder(tmp_path, 24, 2)
    file = dict(np.load(path / "landmarks.npz"))
    file["xyz64"][0] = -32768
    file["xyz64"][1, 14:30] = -32768
    np.savez(path / "landmarks.npz", **file)
    left_out = train(Folder(path), "", recipe=RECIPE).left_out
    assert "no face" in left_out["clip00"]
    assert "lost" in left_out["clip01"]


def test_no_part_is_needed_to_choose_by_but_one_to_learn_from(tmp_path: Path) -> None:
    path = folder(tmp_path, 24, 1)
    (path / "split.json").write_text('{"train": [], "dev": []}')
    with pytest.raises(ClipError, match="only 0 clips"):
        train(Folder(path), "", recipe=RECIPE)


def test_a_model_that_cannot_be_read_again_replaces_nothing(
    trained: Trained, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from tools import train_motion

    out = tmp_path / "speaker.npz"
    train_motion.write(trained, out)
    good = out.read_bytes()
    monkeypatch.setattr(train_motion, "pack", lambda _: good[:1000])
    with pytest.raises(FapstreamError):
        train_motion.write(trained, out)
    monkeypatch.setattr(train_motion, "pack", lambda _: good)
    monkeypatch.setattr(train_motion, "MOST_BYTES", 100)
    with pytest.raises(FapstreamError, match="allowed"):
        train_motion.write(trained, out)
    assert out.read_bytes() == good
    assert [p.name for p in tmp_path.iterdir()] == ["speaker.npz"]


def test_the_speaker_is_complete(trained: Trained) -> None:
    assert isinstance(trained.speaker, Speaker)
    for model in ("hmm", "ohman"):
        assert trained.speaker.mouth(model).look_ahead in (2, 4)  # type: ignore[arg-type]
