#!/usr/bin/env python3
"""Known vulnerabilities of what is pinned: constraints.txt by pip-audit, package-lock.json by npm audit.

Exit status 1 if there is one that is not in ACCEPTED. A registry that does not answer, or not about all,
is said and passes: tests shall not fail because of a network.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
PATIENCE_S = 120

ACCEPTED: dict[str, str] = {}
"""Identifiers of vulnerabilities that do not concern us, and why not."""

PIP = (
    sys.executable,
    "-m",
    "pip_audit",
    "-r",
    "constraints.txt",
    "--no-deps",
    "--disable-pip",
    "--format",
    "json",
)
NPM = ("npm", "audit", "--json")


@dataclass(frozen=True, slots=True)
class Found:
    """What a registry said: vulnerabilities, a line each, and what it said nothing about."""

    vulnerable: tuple[str, ...]
    asked: int
    """Packages that it knows."""
    unanswered: str = ""


def of_pip(output: str) -> Found:
    """What pip-audit printed. Raises ValueError, KeyError, TypeError if it is no report."""
    packages = json.loads(output)["dependencies"]
    skipped = [p["name"] for p in packages if "skip_reason" in p]
    bad = [
        f"{p['name']} {p['version']}: {v['id']}{_fixed(v['fix_versions'])}"
        for p in packages
        for v in p.get("vulns", ())
        if not ACCEPTED.keys() & {v["id"], *v.get("aliases", ())}
    ]
    unanswered = f"nothing about {len(skipped)} of {len(packages)} packages" if skipped else ""
    return Found(tuple(bad), len(packages) - len(skipped), unanswered)


def _fixed(versions: Sequence[str]) -> str:
    return f", fixed in {', '.join(versions)}" if versions else ", not fixed yet"


def of_npm(output: str) -> Found:
    """What npm audit printed. Raises ValueError, KeyError, TypeError if it is no report."""
    report = json.loads(output)
    bad = [line for name, entry in report["vulnerabilities"].items() for line in _of_entry(name, entry)]
    return Found(tuple(bad), report["metadata"]["dependencies"]["total"])


def _of_entry(name: str, entry: Any) -> Iterator[str]:
    """Only what is wrong with the package itself; names stand for what it got from others."""
    for via in entry["via"]:
        if not isinstance(via, str) and via["url"].rpartition("/")[2] not in ACCEPTED:
            yield f"{name} {entry['range']}: {via['title']} ({entry['severity']}), {via['url']}"


def asked(command: Sequence[str], folder: Path) -> tuple[str, str]:
    """(what a program printed, the last it complained of)."""
    try:
        run = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=PATIENCE_S, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as e:
        return "", str(e)
    complaints = [line for line in run.stderr.splitlines() if line.strip() and "complete log" not in line]
    return run.stdout, complaints[-1] if complaints else "no answer"


def judged(what: str, reader: Any, output: str, complaint: str) -> bool:
    """Say what came of it; whether it passes."""
    try:
        found: Found = reader(output)
    except (ValueError, KeyError, TypeError, AttributeError):
        print(f"{what}: not audited, the registry does not answer ({complaint})")
        return True
    for line in found.vulnerable:
        print(f"{what}: {line}")
    if found.asked and not found.vulnerable:
        print(f"{what}: {found.asked} packages without a known vulnerability")
    if found.unanswered:
        print(f"{what}: not audited, the registry says {found.unanswered}")
    return not found.vulnerable


def main() -> int:
    """Ask for all three, whatever comes of the first."""
    web = ROOT / "clients/web"
    passed = [
        judged("Python", of_pip, *asked(PIP, ROOT)),
        judged("npm, shipped", of_npm, *asked((*NPM, "--omit=dev"), web)),
        judged("npm, for building", of_npm, *asked(NPM, web)),
    ]
    return 0 if all(passed) else 1


if __name__ == "__main__":
    raise SystemExit(main())
