"""The options that say how a face moves, for every command that makes one speak."""

from __future__ import annotations

import argparse

from fapstream.cli.arguments import between
from fapstream.motion import DEFAULT_MODEL, GAINS, MODELS, Motion


def add_motion(parser: argparse.ArgumentParser) -> None:
    """--motion and --articulation."""
    group = parser.add_argument_group("how the face moves")
    group.add_argument(
        "--motion", choices=MODELS, default=DEFAULT_MODEL,
        help="what moves the mouth: `hmm`, hidden Markov models learned from a person; `ohman`, "
        "coarticulation with numbers learned from that person; `keyframes`, shapes made by hand "
        f"(default: {DEFAULT_MODEL})",
    )  # fmt: skip
    group.add_argument(
        "--articulation", type=between(*GAINS), default=1.0, metavar="X",
        help=f"how much jaw and lips move, {GAINS[0]:g} (mumbling) to {GAINS[1]:g}; 1 is normal",
    )  # fmt: skip


def motion(args: argparse.Namespace) -> Motion:
    """What the options ask for."""
    return Motion(args.motion, args.articulation)
