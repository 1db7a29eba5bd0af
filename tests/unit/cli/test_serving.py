"""One process of a server as its options want it: tokens, TLS, figures, health."""

from __future__ import annotations

import asyncio
import json
import ssl
import subprocess
import sys
import time
import urllib.request
from pathlib import Path
from urllib.error import HTTPError

import pytest

from fapstream.cli import main
from fapstream.client import ServerError, connect, listen
from fapstream.records import Packet
from fapstream.server.tokens import Grant, mint
from tests.e2e.servers import serving

SECRET = "0123456789abcdef0123456789abcdef"


def token(*scopes: str, channel: str | None = None) -> str:
    return mint(SECRET.encode(), Grant(frozenset(scopes), channel), 60, time.time())


@pytest.fixture
def secret(tmp_path: Path) -> str:
    (tmp_path / "secrets").write_text(SECRET + "\n")
    return str(tmp_path / "secrets")


def fetch(url: str, bearer: str | None = None) -> tuple[int, str]:
    request = urllib.request.Request(url, headers={"Authorization": f"Bearer {bearer}"} if bearer else {})
    try:
        with urllib.request.urlopen(request, timeout=5) as answer:
            return answer.status, answer.read().decode()
    except HTTPError as e:
        return e.code, e.read().decode()


async def test_who_has_no_token_is_told_and_who_has_one_may(secret: str) -> None:
    async with serving("--secret-file", secret, "--channel", "news") as server:
        for shown in (None, "garbage", token("listen")):
            with pytest.raises(ServerError) as caught:
                async with connect(server.url, token=shown):
                    pass
            assert (caught.value.code, caught.value.fatal) == ("unauthorised", True)
        async with connect(server.url, token=token("speak"), share=True) as talker:
            assert talker.ready.channel
            assert talker.ready.listen
            async with listen(server.url, talker.ready.channel, token=talker.ready.listen) as audience:
                await talker.say("Hello.")
                async for event in audience:
                    if isinstance(event, Packet):
                        break
            with pytest.raises(ServerError):
                async with listen(server.url, "news", token=talker.ready.listen):
                    pass
        assert (await asyncio.to_thread(fetch, f"http://{server.address}/metrics"))[0] == 401
        status, text = await asyncio.to_thread(fetch, f"http://{server.address}/metrics", token("metrics"))
        assert status == 200
        assert 'fapstream_errors_total{code="unauthorised"} 4.0' in text
        await server.stop()
        assert server.process.stderr
        said = (await server.process.stderr.read()).decode()
        assert SECRET not in said
        assert "eyJ" not in said


async def test_figures_and_health(tmp_path: Path) -> None:
    log = tmp_path / "log"
    async with serving("--log-format", "json", "--log-file", str(log), "--log-level", "info") as server:
        async with connect(server.url) as talker:
            turn = await talker.say("Hello there.")
            async for event in turn:
                if isinstance(event, Packet):
                    await talker.acknowledge(turn, event.start)
        assert (await asyncio.to_thread(fetch, f"http://{server.address}/healthz"))[0] == 200
        assert (await asyncio.to_thread(fetch, f"http://{server.address}/readyz"))[0] == 200
        _, text = await asyncio.to_thread(fetch, f"http://{server.address}/metrics")
        figures = dict(line.rsplit(" ", 1) for line in text.splitlines() if not line.startswith("#"))
        assert figures['fapstream_turns_total{reason="end"}'] == "1.0"
        assert figures["fapstream_first_audio_seconds_count"] == "1.0"
        assert float(figures["fapstream_packet_lateness_seconds_count"]) > 10
        assert float(figures["fapstream_sent_bytes_total"]) > 10_000
    for line in log.read_text().splitlines():
        assert json.loads(line)["level"]


async def test_tls(tmp_path: Path) -> None:
    key, certificate = tmp_path / "key.pem", tmp_path / "cert.pem"
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost",
         "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", str(key), "-out", str(certificate)],
        check=True, capture_output=True,
    )  # fmt: skip
    async with serving("--tls-cert", str(certificate), "--tls-key", str(key)) as server:
        trusting = ssl.create_default_context(cafile=str(certificate))

        def page() -> bytes:
            with urllib.request.urlopen(f"https://{server.address}/", context=trusting, timeout=5) as answer:
                return bytes(answer.read())

        assert b"fap-head" in await asyncio.to_thread(page)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--host", "0.0.0.0"], "--secret-file"),
        (["--host", "192.0.2.1", "--open"], "cannot listen"),
        (["--tls-cert", "x"], "belong together"),
        (["--tls-cert", "nothing.pem", "--tls-key", "nothing.pem"], "nothing.pem"),
        (["--bus", "amqp://x"], "redis://"),
        (["--origin", "example.org"], "no origin"),
        (["--trust-proxy", "everybody"], "no address"),
        (["--secret-file", "/dev/null"], "no secret"),
    ],
)
async def test_what_cannot_be_is_said(options: list[str], says: str) -> None:
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "fapstream", "serve", "--port", "0", *options,
        stderr=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE,
    )  # fmt: skip
    _, err = await asyncio.wait_for(process.communicate(), 30)
    assert process.returncode == 1
    assert says in err.decode()
    assert "Traceback" not in err.decode()


@pytest.mark.parametrize(
    "options", [["--workers", "0"], ["--workers", "x"], ["--channel", "a b"], ["--drain", "-1"]]
)
def test_what_is_no_option_is_said(options: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["serve", *options])
    assert caught.value.code == 2
    assert options[0] in capsys.readouterr().err
