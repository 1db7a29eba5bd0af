"""What holds for all tests."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent


def pytest_sessionstart() -> None:
    """Compiled modules hide their sources: tests of those that were compiled yesterday would tell nothing."""
    if not any((ROOT / "fapstream" / "tts").glob("*.so")):
        return
    if subprocess.run([sys.executable, ROOT / "tools" / "compile.py", "--check"]).returncode:
        pytest.exit(
            "the sources of the speech front-end have changed since it was compiled: tools/test compiles it "
            "again, tools/compile.py --remove does without",
            returncode=2,
        )
