"""Writes protocol/vectors/life.json: the idle face of a few seeds at a few instants, for both languages.

python tools/build_life_vectors.py
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import get_args

from fapstream.motion import IdleLife, idle_face
from fapstream.motion.idle import Mode

OUT = Path(__file__).parents[1] / "protocol/vectors/life.json"
SEEDS = (1, 2, 4_000_000_000)
TIMES = (0.0, 0.04, 0.5, 1.03, 2.2, 3.77, 5.0, 5.02, 5.04, 5.06, 8.131, 13.5, 61.7, 200.25, 3600.5)


def case(seed: int, mode: Mode) -> dict[str, object]:
    """One face: the FAPs that moved and a row of values for each instant, to a thousandth of a unit."""
    life = IdleLife(seed, mode)
    rows = [idle_face(life.at(t)) for t in TIMES]
    faps = sorted({fap for row in rows for fap in range(1, 69) if row[fap - 1]})
    values = [[round(float(row[fap - 1]), 3) for fap in faps] for row in rows]
    return {"seed": seed, "mode": mode, "times": TIMES, "faps": faps, "values": values}


def main() -> None:
    cases = [case(seed, mode) for seed in SEEDS for mode in get_args(Mode)]
    lines = ",\n".join(json.dumps(c) for c in cases)
    OUT.write_text(f"[\n{lines}\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
