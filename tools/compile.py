#!/usr/bin/env python3
"""Compiles the inner rooms of the speech front-end with mypyc, in place, next to their sources.

usage: compile.py [--check | --remove]

The same typed sources run with and without it; compiled they are more than twice as fast. Needs mypy,
setuptools, and a C compiler with Python's headers. Who edits a source afterwards must compile again or
`--remove`: Python takes the compiled module whatever its source says (tools/run, tools/test and tools/bench
see to it).
"""

from __future__ import annotations

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "fapstream" / "tts"
MODULES = [
    *("durations", "english", "forest", "frontend", "greek", "greek_agreement", "greek_readers"),
    *("homographs", "language", "lexicon", "lts", "markup", "melody", "normalise", "numerals", "patterns"),
    *("plan", "pronounce", "prosody", "reader", "readers", "rules", "segment", "sounds", "spelling", "stems"),
]
"""What every word goes through. records.py is not among them: its named tuples would not gain."""

BUILD = """
import sys
from mypyc.build import mypycify
from setuptools import setup

arguments = ["--ignore-missing-imports", "--follow-imports=silent", *sys.argv[1:]]
setup(
    name="compiled",
    packages=[],
    py_modules=[],
    ext_modules=mypycify(arguments, opt_level="2", debug_level="0", group_name="fapstream.tts.compiled"),
    script_args=["-q", "build_ext", "-i"],
)
"""


DIGEST = PACKAGE / "compiled.sha256"
"""Of what was compiled."""


def digest() -> str:
    """Of everything that decides what is compiled."""
    found = hashlib.sha256(f"{sys.version} {MODULES} {BUILD}".encode())
    outside = [PACKAGE.parent / name for name in ("errors.py", "records.py", "data.py")]
    for path in [*sorted(PACKAGE.glob("*.py")), *outside]:
        found.update(path.read_bytes())
    return found.hexdigest()


def is_current() -> bool:
    """Whether what is compiled is compiled of these sources."""
    return DIGEST.exists() and DIGEST.read_text() == digest()


def remove() -> None:
    """The sources are what runs."""
    for path in [*PACKAGE.glob("*.so"), *PACKAGE.glob(DIGEST.name)]:
        path.unlink()


def compile_modules() -> None:
    """Builds in a copy, so that nothing but the result is left in the project. Raises CalledProcessError."""
    with tempfile.TemporaryDirectory() as directory:
        copy = Path(directory) / "fapstream"
        shutil.copytree(ROOT / "fapstream", copy, ignore=_all_but_sources)
        sources = [f"fapstream/tts/{name}.py" for name in MODULES]
        exact = os.environ | {"CFLAGS": "-ffp-contract=off"}  # the same floats as from the sources
        subprocess.run(
            [sys.executable, "-c", BUILD, *sources],
            cwd=directory, env=exact, check=True, capture_output=True, text=True,
        )  # fmt: skip
        remove()
        for built in (copy / "tts").glob("*.so"):
            shutil.copy(built, PACKAGE)
        DIGEST.write_text(digest())


def _all_but_sources(directory: str, names: list[str]) -> list[str]:
    return [n for n in names if not (n.endswith(".py") or (Path(directory) / n).is_dir())]


def main() -> int:
    """Compiles, tells whether that is needed, or takes what is compiled away."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    either = parser.add_mutually_exclusive_group()
    either.add_argument(
        "--check", action="store_true", help="0 if what is compiled is compiled of these sources"
    )
    either.add_argument("--remove", action="store_true", help="back to the sources")
    args = parser.parse_args()
    if args.check:
        return 0 if is_current() else 1
    if args.remove:
        remove()
        return 0
    try:
        compile_modules()
    except subprocess.CalledProcessError as error:
        print("\n".join((error.stdout + error.stderr).splitlines()[-20:]), file=sys.stderr)
        print("compile.py: the speech front-end could not be compiled; it runs as it is", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
