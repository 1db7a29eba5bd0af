"""A person's articulation as it was learned: the file that `tools/train_motion` writes and mouths read.

A NumPy archive of arrays. `version`; `names`, `mean`, `basis` (articulation.py); `asked` (the features that
the trees' questions are about), `tree_K`, `state_mean`, `state_var`, `state_stay`, `smoothness` (trees.py,
spline.py); `ohman_targets`, `ohman_values`, `ohman_consonants`, `ohman_weight`, `ohman_target`, `ohman_curve`
(ohman.py); where there was sound, `heard_mean`, `heard_scale`, `heard_hidden`, `heard_out` (hearing.py);
`made`: how and of what.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal
from zipfile import BadZipFile

import numpy as np

from fapstream.data import read_bytes
from fapstream.errors import DataError
from fapstream.motion.articulation import Articulation
from fapstream.motion.hearing import Heard, HearingMouth
from fapstream.motion.hmm import HmmMouth
from fapstream.motion.learned import MouthModel
from fapstream.motion.ohman import Ohman, OhmanMouth
from fapstream.motion.questions import asked
from fapstream.motion.spline import Smoothness
from fapstream.motion.trees import N_TREES, TiedStates, Tree

FILE = "speaker.npz"
VERSION = 1
HEARD = ("mean", "scale", "hidden", "out")


@dataclass(frozen=True, slots=True)
class Speaker:
    """Everything that was learned of one person. `made`: how and of what, in words. `heard` is None if
    there was no sound."""

    articulation: Articulation
    states: TiedStates
    smoothness: Smoothness
    ohman: Ohman
    made: str
    heard: Heard | None = None

    def mouth(self, model: Literal["ohman", "hmm"]) -> MouthModel:
        """The model of that name."""
        return OhmanMouth(self.ohman) if model == "ohman" else HmmMouth(self.states, self.smoothness)


@cache
def speaker() -> Speaker:
    """The one that the package speaks with. Raises DataError."""
    return unpack(read_bytes("motion", FILE), FILE)


def hearing_mouth(rate: int, gain: float = 1.0) -> HearingMouth:
    """A mouth that says what it hears, sound at `rate`. Raises DataError."""
    person = speaker()
    if person.heard is None:
        raise DataError(FILE, None, "was made without sound: it cannot hear")
    return HearingMouth(rate, person.heard, person.articulation, gain)


def pack(person: Speaker) -> bytes:
    """The file."""
    arrays: dict[str, Any] = {
        "version": VERSION,
        "made": person.made,
        "names": np.array(person.articulation.names),
        "asked": np.array(asked()),
        "smoothness": np.array([person.smoothness.width_s, person.smoothness.weight]),
        "ohman_targets": np.array(person.ohman.targets),
        "ohman_consonants": np.array(person.ohman.consonants),
        **{f"tree_{k}": tree.nodes.astype(np.int16) for k, tree in enumerate(person.states.trees)},
    }
    numbers = {
        "mean": person.articulation.mean, "basis": person.articulation.basis,
        "state_mean": person.states.mean, "state_var": person.states.var, "state_stay": person.states.stay,
        "ohman_values": person.ohman.values, "ohman_weight": person.ohman.weight,
        "ohman_target": person.ohman.target, "ohman_curve": person.ohman.curve,
    }  # fmt: skip
    if person.heard is not None:
        numbers |= {f"heard_{name}": getattr(person.heard, name) for name in HEARD}
    file = io.BytesIO()
    arrays |= {name: value.astype(np.float32) for name, value in numbers.items()}
    np.savez(file, **arrays)
    return file.getvalue()


def unpack(data: bytes, name: str) -> Speaker:
    """What a file holds. Raises DataError naming it."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            if int(file["version"]) != VERSION:
                raise DataError(name, None, f"is of version {int(file['version'])}, not {VERSION}")
            if tuple(file["asked"]) != asked():
                raise DataError(
                    name, None, "was made with other features than data/features.tsv; make it again"
                )
            return _read({key: file[key] for key in file.files})
    except (KeyError, ValueError, TypeError, EOFError, OSError, BadZipFile) as e:
        raise DataError(name, None, f"holds no articulation ({e})") from None


def _read(file: dict[str, Any]) -> Speaker:
    def numbers(key: str) -> Any:
        found = file[key].astype(np.float64)
        if not np.isfinite(found).all():
            raise ValueError(f"{key} holds what is no number")
        return found

    trees = tuple(Tree(file[f"tree_{k}"].astype(np.int64)) for k in range(N_TREES))
    return Speaker(
        Articulation(tuple(map(str, file["names"])), numbers("mean"), numbers("basis")),
        TiedStates(trees, numbers("state_mean"), numbers("state_var"), numbers("state_stay")),
        Smoothness(*map(float, file["smoothness"])),
        Ohman(
            tuple(map(str, file["ohman_targets"])), numbers("ohman_values"),
            tuple(map(str, file["ohman_consonants"])), numbers("ohman_weight"),
            numbers("ohman_target"), numbers("ohman_curve"),
        ),
        str(file["made"]),
        Heard(*(numbers(f"heard_{name}") for name in HEARD)) if "heard_mean" in file else None,
    )  # fmt: skip
