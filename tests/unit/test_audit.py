"""tools/audit: a known vulnerability fails, a registry that does not answer is said and passes."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

TOOL = Path(__file__).parents[2] / "tools/audit.py"


@pytest.fixture
def audit(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    spec = importlib.util.spec_from_file_location("audit", TOOL)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "audit", module)
    spec.loader.exec_module(module)
    return module


CLEAN = {"name": "numpy", "version": "2.0", "vulns": []}
SKIPPED = {"name": "glfw", "skip_reason": "Dependency not found on PyPI"}
BAD = {
    "name": "pillow", "version": "9.0",
    "vulns": [{"id": "PYSEC-1", "fix_versions": ["9.1"], "aliases": ["CVE-1"], "description": "..."}],
}  # fmt: skip
UNFIXED = {**BAD, "vulns": [{"id": "PYSEC-2", "fix_versions": [], "aliases": [], "description": "..."}]}


def pip(*packages: Any) -> str:
    return json.dumps({"dependencies": packages, "fixes": []})


def npm(**vulnerabilities: Any) -> str:
    total = {"dependencies": {"total": 7}}
    return json.dumps({"auditReportVersion": 2, "vulnerabilities": vulnerabilities, "metadata": total})


ADVISORY = {
    "title": "Path traversal", "url": "https://github.com/advisories/GHSA-1", "severity": "high",
    "range": "<6",
}  # fmt: skip
VITE = {"name": "vite", "severity": "high", "range": "<6", "via": [ADVISORY]}
THROUGH_VITE = {"name": "vitest", "severity": "high", "range": "*", "via": ["vite"]}


@pytest.mark.parametrize(
    ("reader", "output", "passes", "said"),
    [
        ("of_pip", pip(CLEAN), True, "x: 1 packages without a known vulnerability\n"),
        ("of_pip", pip(CLEAN, BAD), False, "x: pillow 9.0: PYSEC-1, fixed in 9.1\n"),
        ("of_pip", pip(UNFIXED), False, "x: pillow 9.0: PYSEC-2, not fixed yet\n"),
        ("of_pip", pip(SKIPPED), True, "x: not audited, the registry says nothing about 1 of"),
        ("of_npm", npm(), True, "x: 7 packages without a known vulnerability\n"),
        (
            "of_npm", npm(vite=VITE, vitest=THROUGH_VITE), False,
            "x: vite <6: Path traversal (high), https://github.com/advisories/GHSA-1\n",
        ),
        ("of_npm", '{"statusCode": 405, "error": {"summary": ""}}', True, "does not answer (why)"),
        ("of_npm", "[]", True, "does not answer (why)"),
        ("of_pip", "", True, "does not answer (why)"),
        ("of_pip", "null", True, "does not answer (why)"),
    ],
)  # fmt: skip
def test_what_registries_say(
    audit: ModuleType, capsys: pytest.CaptureFixture[str], reader: str, output: str, passes: bool, said: str
) -> None:
    assert audit.judged("x", getattr(audit, reader), output, "why") is passes
    assert said in capsys.readouterr().out


def test_what_was_accepted_passes(audit: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(audit, "ACCEPTED", {"CVE-1": "we read no such pictures", "GHSA-1": "not served"})
    assert audit.of_pip(pip(BAD)).vulnerable == ()
    assert audit.of_npm(npm(vite=VITE)).vulnerable == ()


def test_programs_that_fail_or_are_missing_say_why(audit: ModuleType, tmp_path: Path) -> None:
    failing = "echo half; printf 'first\\nlast\\n\\nA complete log of this\\n' >&2; exit 1"
    assert audit.asked(["sh", "-c", failing], tmp_path) == ("half\n", "last")
    output, complaint = audit.asked(["no-such-program"], tmp_path)
    assert output == ""
    assert "no-such-program" in complaint


@pytest.mark.parametrize(("answers", "status"), [((pip(CLEAN), npm(), npm()), 0), ((pip(BAD), "", npm()), 1)])
def test_all_are_asked_and_one_is_enough_to_fail(
    audit: ModuleType, monkeypatch: pytest.MonkeyPatch, answers: tuple[str, ...], status: int
) -> None:
    waiting = list(answers)
    monkeypatch.setattr(audit, "asked", lambda *_: (waiting.pop(0), "why"))
    assert audit.main() == status
    assert waiting == []
