"""How near our mouth is to a filmed one, beside what else predicts it and what rivals make of the same
sentences.

usage: tools/bench motion --data DIR [--part NAME] [--json]

DIR is a folder as fapstream/learn/clips.py has it; regressions and rivals' mappings are fitted to its part
`train`. Of each sentence (speech and 0.1 s around it) the correlation of lip aperture, mouth width and chin
with what was measured, and the root mean square error in mm at 90 mm between the outer corners of the eyes;
medians over the sentences. Rivals' viseme weights become those quantities by least squares.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import ExtraTreesRegressor
from sklearn.tree import DecisionTreeRegressor

from fapstream.adapters.sound_file import read_sound
from fapstream.errors import FapstreamError
from fapstream.head import Fapu
from fapstream.learn.clips import Folder
from fapstream.learn.training import TRAIN, Filmed, film, mean_fapu, speech
from fapstream.motion import MODELS, Motion
from fapstream.motion.hearing import HearingMouth
from tests.benchmarks import rivals
from tests.benchmarks.mouths import (
    QUANTITIES,
    SAMPLE_RATE,
    apart_in_closures,
    contexts,
    from_sound,
    heard,
    least_squares,
    ours,
    planned,
    quantities,
    regressed,
)
from tests.benchmarks.warping import warped

Floats = NDArray[np.float64]

MARGIN_S = 0.1
HEARD = f"from sound, {1000 * HearingMouth.delay_s:.0f} ms late"
CLOSED_MM = 2.0
TALKING_HEAD = Path("build/rivals/talkinghead-1.7.0")
LEAF = 30
"""Instants that a leaf of the context tree stands for at least."""
TREES, EVERY = 60, 2


@dataclass(frozen=True, slots=True)
class Scene:
    """What is compared: clips to fit to and clips to score, and what was measured in them, (n, 3) each; and
    where their sound is."""

    train: Sequence[Filmed]
    scored: Sequence[Filmed]
    fapu: Fapu
    sounds: Path

    def measured(self, filmed: Filmed) -> Floats:
        """The three quantities, mm."""
        return quantities(filmed.measured.faps, filmed.measured.fapu)


@dataclass(frozen=True, slots=True)
class Score:
    """Medians over sentences, of each quantity; `closures`: in how many B, P and M the lips are nearer than
    CLOSED_MM."""

    r: Floats
    rmse: Floats
    closures: float | None = None


def score(scene: Scene, made: Sequence[Floats]) -> Score:
    """Of what somebody makes of the clips that are scored."""
    r, rmse, apart = [], [], []
    for filmed, rows in zip(scene.scored, made, strict=True):
        there = speech(filmed, MARGIN_S)
        wanted = scene.measured(filmed)[there]
        given = rows[there][: len(wanted)]
        wanted = wanted[: len(given)]
        r.append(correlations(given, wanted))
        rmse.append(np.sqrt(((given - wanted) ** 2).mean(axis=0)))
        apart += apart_in_closures(filmed, rows)
    closed = float(np.mean(np.array(apart) < CLOSED_MM)) if apart else None
    return Score(np.median(r, axis=0), np.median(rmse, axis=0), closed)


def correlations(a: Floats, b: Floats) -> Floats:
    """Of columns; 0 where one does not move."""
    a, b = a - a.mean(axis=0), b - b.mean(axis=0)
    size = np.sqrt((a**2).sum(axis=0) * (b**2).sum(axis=0))
    return np.where(size > 1e-9, (a * b).sum(axis=0) / np.maximum(size, 1e-9), 0.0)


def warped_score(scene: Scene, made: Sequence[Floats]) -> Score:
    """The same after dynamic time warping."""
    r, rmse = [], []
    for filmed, rows in zip(scene.scored, made, strict=True):
        wanted = scene.measured(filmed)[speech(filmed, MARGIN_S)]
        given = warped(rows, wanted)
        r.append(correlations(given, wanted))
        rmse.append(np.sqrt(((given - wanted) ** 2).mean(axis=0)))
    return Score(np.median(r, axis=0), np.median(rmse, axis=0))


def contestants(scene: Scene) -> Iterator[tuple[str, Score]]:
    """Everybody's score, one after the other."""
    wanted = [scene.measured(filmed) for filmed in scene.train]
    mean = np.concatenate([rows[speech(f)] for f, rows in zip(scene.train, wanted, strict=True)]).mean(axis=0)
    yield "constant", score(scene, [np.tile(mean, (len(f.measured.seen), 1)) for f in scene.scored])
    for model in MODELS:
        yield model, score(scene, [ours(heard(f.clip), Motion(model), scene.fapu) for f in scene.scored])
    if scene.sounds.is_dir():
        sound = [read_sound(scene.sounds / f"{f.clip.name}.flac", SAMPLE_RATE) for f in scene.scored]
        yield HEARD, score(scene, [from_sound(pcm, scene.fapu) for pcm in sound])
    inputs = [(f, contexts(f.clip, len(f.measured.seen))) for f in scene.train]
    asked = [contexts(f.clip, len(f.measured.seen)) for f in scene.scored]
    for name, fit in (("context tree", _tree), ("extra trees", _extra_trees)):
        predict = regressed(fit, inputs, wanted)
        yield name, score(scene, [predict(rows) for rows in asked])
    yield from _rivals(scene, wanted)


def _tree(x: Floats, y: Floats) -> Callable[[Floats], Floats]:
    found: Any = DecisionTreeRegressor(min_samples_leaf=LEAF, random_state=0).fit(x, y)
    return lambda rows: np.asarray(found.predict(rows))


def _extra_trees(x: Floats, y: Floats) -> Callable[[Floats], Floats]:
    model = ExtraTreesRegressor(TREES, min_samples_leaf=5, max_features=0.4, n_jobs=2, random_state=0)
    found: Any = model.fit(x[::EVERY], y[::EVERY])
    return lambda rows: np.asarray(found.predict(rows))


def _rivals(scene: Scene, wanted: Sequence[Floats]) -> Iterator[tuple[str, Score]]:
    """Those that are installed; of each its ordinary way and the one that suits it best here."""
    clips = [*scene.train, *scene.scored]
    spoken = [_spoken(f) for f in clips]
    ways: dict[str, Callable[[], list[Floats]]] = {
        "TalkingHead": lambda: rivals.talkinghead(spoken, TALKING_HEAD),
        "TalkingHead, letters spelled": lambda: rivals.talkinghead(
            [rivals.spelled(each) for each in spoken], TALKING_HEAD
        ),
        "openfacefx": lambda: rivals.openfacefx(spoken),
        "openfacefx, jali": lambda: rivals.openfacefx(spoken, jali=True),
    }
    for name, way in ways.items():
        try:
            weights = way()
        except rivals.RivalMissing as e:
            print(f"{name} is left out: {e}", file=sys.stderr)
            continue
        n = len(scene.train)
        predict = regressed(least_squares, list(zip(scene.train, weights[:n], strict=True)), wanted)
        yield name, score(scene, [predict(rows) for rows in weights[n:]])


def _spoken(filmed: Filmed) -> rivals.Spoken:
    words = tuple(
        (w.text, w.start, w.end - w.start, tuple((p.name, p.start, p.end - p.start) for p in w.phones))
        for w in filmed.clip.words
    )
    return rivals.Spoken(words, len(filmed.measured.seen))


def chains(scene: Scene) -> Iterator[tuple[str, Score]]:
    """The whole chain from text, beside the true phone times, both warped to what was measured."""
    for name, of in (("true times", heard), ("our durations", planned)):
        for model in MODELS:
            made = [ours(of(f.clip), Motion(model), scene.fapu) for f in scene.scored]
            if of is heard:
                made = [rows[speech(f, MARGIN_S)] for f, rows in zip(scene.scored, made, strict=True)]
            yield f"{model}, {name}", warped_score(scene, made)


def figures(scores: Mapping[str, Score]) -> dict[str, float | None]:
    """The keys that are compared from release to release."""
    theirs = [s.r[0] for name, s in scores.items() if name.startswith(("TalkingHead", "openfacefx"))]
    found: dict[str, float | None] = {
        f"hmm_{q}_r": round(float(scores["hmm"].r[i]), 3) for i, q in enumerate(QUANTITIES)
    }
    found["ohman_aperture_r"] = round(float(scores["ohman"].r[0]), 3)
    found["keyframes_aperture_r"] = round(float(scores["keyframes"].r[0]), 3)
    found["heard_aperture_r"] = round(float(scores[HEARD].r[0]), 3) if HEARD in scores else None
    found["closures"] = scores["hmm"].closures
    found["best_rival_aperture_r"] = round(float(max(theirs)), 3) if theirs else None
    return found


def line(name: str, found: Score) -> str:
    """A row of the table."""
    closed = "" if found.closures is None else f"{100 * found.closures:9.1f}"
    numbers = "".join(f"{r:7.3f}{e:7.2f}" for r, e in zip(found.r, found.rmse, strict=True))
    return f"{name:<30}{numbers}{closed}"


def main() -> int:
    """The table, or JSON."""
    parser = argparse.ArgumentParser(prog="tools/bench motion", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--data", type=Path, required=True, metavar="DIR")
    parser.add_argument("--part", default="dev", help="the part of the folder that is scored (default: dev)")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    left_out: dict[str, str] = {}
    try:
        folder = Folder(options.data)
        train = film(folder, TRAIN, left_out)
        scene = Scene(train, film(folder, options.part, left_out), mean_fapu(train), options.data / "flac")
    except FapstreamError as e:
        print(f"motion: {e}", file=sys.stderr)
        return 1
    if not options.json:
        print(f"{len(scene.scored)} sentences; {len(left_out)} clips left out")
        print(f"{'':<30}" + "".join(f"{q + ' r':>9}{'mm':>5}" for q in QUANTITIES) + "  closed %")
    scores = {}
    for name, found in contestants(scene):
        scores[name] = found
        if not options.json:
            print(line(name, found), flush=True)
    if options.json:
        print(json.dumps(figures(scores)))
        return 0
    print("\nwarped in time to what was measured")
    for name, found in chains(scene):
        print(line(name, found), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
