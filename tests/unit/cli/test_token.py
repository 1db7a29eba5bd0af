"""`fapstream token`: what it prints is what a server with the same secret believes."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from fapstream.cli import main
from fapstream.server.tokens import SECRET_VARIABLE, Grant, check

SECRET = "s" * 40
NEWER = "n" * 40


@pytest.fixture(autouse=True)
def nothing_set(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(SECRET_VARIABLE, raising=False)


def printed(capsys: pytest.CaptureFixture[str], *argv: str) -> str:
    assert main(["token", *argv]) == 0
    out = capsys.readouterr().out
    assert out.count("\n") == 1
    return out.strip()


def test_a_token_signed_with_the_first_secret_of_a_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "secrets"
    file.write_text(f"{NEWER}\n{SECRET}\n")
    token = printed(
        capsys, "--scope", "speak", "--scope", "listen", "--channel", "news", "--subject", "ann",
        "--secret-file", str(file),
    )  # fmt: skip
    granted = Grant(frozenset({"speak", "listen"}), "news", "ann")
    assert check(token, [NEWER.encode()], time.time()) == granted
    hours = 3600 * 12
    check(token, [NEWER.encode()], time.time() + hours - 60)
    with pytest.raises(Exception, match="expired"):
        check(token, [NEWER.encode()], time.time() + hours + 90)


@pytest.mark.parametrize(("option", "seconds"), [(["--minutes", "5"], 300), (["--hours", "0.5"], 1800)])
def test_how_long(
    option: list[str], seconds: float, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(SECRET_VARIABLE, SECRET)
    token = printed(capsys, "--scope", "adapt", *option)
    check(token, [SECRET.encode()], time.time() + seconds)
    with pytest.raises(Exception, match="expired"):
        check(token, [SECRET.encode()], time.time() + seconds + 120)


def test_a_new_secret_can_be_used(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    secret = printed(capsys, "--new-secret")
    assert secret != printed(capsys, "--new-secret")
    monkeypatch.setenv(SECRET_VARIABLE, secret)
    assert check(printed(capsys, "--scope", "speak"), [secret.encode()], time.time()).scopes == {"speak"}


@pytest.mark.parametrize(
    ("argv", "message"),
    [(["--scope", "speak"], "no secret to sign with"), ([], "what shall the token allow"),
     (["--scope", "speak", "--secret-file", "/nowhere/f"], "/nowhere/f: No such file")],
)  # fmt: skip
def test_what_cannot_be_done_exits_1(
    argv: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["token", *argv]) == 1
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    "argv",
    [["--scope", "fly"], ["--hours", "0"], ["--hours", "1", "--minutes", "5"], ["--hours", "x"], ["x"]],
)
def test_a_wrong_call_exits_2(argv: list[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["token", *argv])
    assert caught.value.code == 2
