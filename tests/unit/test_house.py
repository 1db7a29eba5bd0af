"""The rules of the house: who may import whom, no circles, and a test for every module."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "fapstream"

IO_MODULES = {
    "asyncio", "threading", "multiprocessing", "concurrent", "subprocess", "socket", "ssl", "urllib", "http",
    "time", "logging", "websockets", "pyaudio", "moderngl", "glfw", "select", "selectors", "signal",
}  # fmt: skip

EVERYONE = {"errors", "records", "ports", "data"}

ROOMS: dict[str, set[str]] = {
    # room: the rooms it may import besides EVERYONE
    "errors": set(),
    "records": set(),
    "ports": {"adapt"},
    "data": set(),
    "tts": set(),
    "fap": set(),
    "motion": {"fap"},
    "learn": {"fap", "head", "motion", "tts"},
    "head": {"fap"},
    "adapt": {"fap", "head"},
    "stream": set(),
    "protocol": set(),
    "pipeline": {"tts", "motion", "fap", "stream"},
    "talk": {"pipeline"},
    "hearing": {"motion", "stream"},
    "ears": {"hearing"},
    "adapters": {"adapt", "tts"},
    "server": {"ears", "hearing", "motion", "tts", "pipeline", "talk", "protocol", "stream"},
    "client": {"protocol"},
    "viewer": {"adapters", "client", "fap", "head", "motion", "protocol", "stream"},
    "bridges": {"fap", "head", "stream"},
    "cli": {
        "adapt",
        "adapters",
        "client",
        "fap",
        "head",
        "motion",
        "pipeline",
        "protocol",
        "server",
        "stream",
        "talk",
        "tts",
        "viewer",
    },
}

IO_ROOMS = {"talk", "ears", "adapters", "server", "client", "viewer", "bridges", "cli"}

THIRD_PARTY: dict[str, set[str]] = {
    "adapt": {"scipy", "PIL"},
    "learn": {"scipy"},
    "protocol": {"msgpack"},
    "adapters": {
        "pyaudio",
        "espeakng_loader",
        "ai_edge_litert",
        "prometheus_client",
        "redis",
        "soundfile",
        "scipy",
        "pocketsphinx",
    },
    "server": {"websockets", "jwt"},
    "client": {"websockets"},
    "viewer": {"websockets", "moderngl", "glfw", "PIL"},
    "cli": {"websockets"},
}
COMMON_THIRD_PARTY = {"numpy"}
"""What every installation has."""


def modules() -> list[Path]:
    return sorted(p for p in PACKAGE.rglob("*.py"))


def name_of(path: Path) -> str:
    parts = list(path.relative_to(ROOT).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports(path: Path) -> set[str]:
    """Dotted names of the modules that a file imports, wherever the import stands."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            assert node.module
            found.add(node.module)
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def room_of(dotted: str) -> str:
    parts = dotted.split(".")
    return parts[1] if len(parts) > 1 else ""


@pytest.mark.parametrize("path", modules(), ids=name_of)
def test_imports_keep_the_rules(path: Path) -> None:
    room = room_of(name_of(path))
    if room in ("", "__main__"):
        return
    assert room in ROOMS, f"{room} is no room of the house; add it to ROOMS with what it may import"
    for dotted in imports(path):
        top = dotted.partition(".")[0]
        if top == "fapstream":
            other = room_of(dotted)
            allowed = ROOMS[room] | EVERYONE | {room, "", "__version__", "connect"}
            assert other in allowed, f"{room} may not import {other}"
        elif top in IO_MODULES and room not in IO_ROOMS:
            pytest.fail(f"{room} is pure and may not import {top}")
        elif top not in sys.stdlib_module_names:
            allowed_third = COMMON_THIRD_PARTY | THIRD_PARTY.get(room, set())
            assert top in allowed_third, f"{room} may not import {top}"


def test_there_are_no_import_circles() -> None:
    names = {name_of(p): p for p in modules()}
    edges = {n: {d for d in imports(p) if d in names and d != n} for n, p in names.items()}
    # a package's face hands names on; what counts is what its modules need
    done: set[str] = set()

    def visit(node: str, trail: tuple[str, ...]) -> None:
        assert node not in trail, "circle: " + " -> ".join((*trail[trail.index(node) :], node))
        if node not in done:
            for other in sorted(edges[node]):
                if not node.startswith(other + "."):
                    visit(other, (*trail, node))
            done.add(node)

    for name in sorted(names):
        visit(name, ())


GENERATED_OR_SHELL = {
    "fapstream.__main__",
    "fapstream.errors",
    "fapstream.records",
    "fapstream.ports",
    "fapstream.protocol.generated",
}


@pytest.mark.parametrize(
    "path",
    [p for p in modules() if p.stem != "__init__" and name_of(p) not in GENERATED_OR_SHELL],
    ids=name_of,
)
def test_every_module_has_its_test(path: Path) -> None:
    relative = path.relative_to(PACKAGE)
    mirror = ROOT / "tests" / "unit" / relative.parent / f"test_{relative.name}"
    assert mirror.is_file(), f"no {mirror.relative_to(ROOT)}"


ABOUT_NO_MODULE = {"head/test_fat.py", "server/test_stateful.py", "test_audit.py", "test_deploy.py"}
"""Tests of the packaged heads, of whole sessions, and of what is in tools/."""


def test_every_unit_test_mirrors_a_module() -> None:
    """What a module does in one language may have a test of its own, with the language at its end."""
    for test in (ROOT / "tests" / "unit").rglob("test_*.py"):
        relative = test.relative_to(ROOT / "tests" / "unit")
        if relative == Path("test_house.py") or relative.as_posix() in ABOUT_NO_MODULE:
            continue
        package = ROOT / "tests" if relative.parts[0] == "benchmarks" else PACKAGE
        name = re.sub(r"^test_(.*?)(_en|_el)?\.py$", r"\1.py", relative.name)
        assert (package / relative.parent / name).is_file(), f"{relative} tests no module"


def test_generated_equals_committed() -> None:
    check = [sys.executable, str(ROOT / "tools" / "generate_protocol.py"), "--check"]
    result = subprocess.run(check, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout


def test_lock_files_carry_no_addresses() -> None:
    assert "://" not in (ROOT / "constraints.txt").read_text(encoding="utf-8")
    assert '"resolved"' not in (ROOT / "clients/web/package-lock.json").read_text(encoding="utf-8")
