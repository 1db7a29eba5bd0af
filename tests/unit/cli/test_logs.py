"""The log: every line can be read by a program, no secret is in it, and nothing that happens to it hurts."""

from __future__ import annotations

import argparse
import json
import logging
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.cli import logs
from fapstream.cli.logs import Hide, JsonFormatter, TextFormatter, add_log_arguments, start_log

log = logging.getLogger("fapstream.server")


@pytest.fixture(autouse=True)
def as_before() -> Iterator[None]:
    """The root logger and SIGHUP as pytest wants them."""
    root = logging.getLogger()
    handlers, level, hangup = root.handlers[:], root.level, signal.getsignal(signal.SIGHUP)
    yield
    for handler in root.handlers:
        if handler not in handlers:
            handler.close()
    root.handlers[:] = handlers
    root.setLevel(level)
    for name in logs.CHATTY:
        logging.getLogger(name).setLevel(logging.NOTSET)
    signal.signal(signal.SIGHUP, hangup)


def lines(file: Path) -> list[Any]:
    return [json.loads(line) for line in file.read_text("utf-8").splitlines()]


def record(message: Any, *args: Any, **extra: Any) -> logging.LogRecord:
    return log.makeRecord(log.name, logging.INFO, "x.py", 1, message, args, None, extra=extra)


def test_a_line_of_json(tmp_path: Path) -> None:
    before = datetime.now(UTC)
    start_log("json", tmp_path / "log", "info")
    log.info("turn %d is over", 3, extra={"session": "ab12", "samples": 16_000, "share": 0.5, "ok": True})
    log.debug("not said")
    (line,) = lines(tmp_path / "log")
    assert (datetime.fromisoformat(line.pop("time")) - before).total_seconds() < 5
    assert line == {
        "level": "info", "logger": "fapstream.server", "message": "turn 3 is over", "session": "ab12",
        "samples": 16_000, "share": 0.5, "ok": True,
    }  # fmt: skip


def test_what_was_raised_stands_in_the_line(tmp_path: Path) -> None:
    start_log("json", tmp_path / "log", "info")
    try:
        raise ValueError("token=abcdefgh")
    except ValueError:
        log.exception("a session failed")
    (line,) = lines(tmp_path / "log")
    assert "Traceback" in line["exception"]
    assert line["exception"].endswith("ValueError: token=[hidden]")


def test_a_line_of_text() -> None:
    said = TextFormatter(Hide()).format(record("%s came", "Ann\n2027 forged\x1b[2J", session="ab12"))
    assert re.fullmatch(
        r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z info    fapstream\.server "
        r"Ann\\n2027 forged\\x1b\[2J came session=ab12",
        said,
    )


@given(st.text(), st.dictionaries(st.text(min_size=1), st.none() | st.floats() | st.text() | st.binary()))
def test_whatever_is_logged_is_one_line_of_good_json(message: str, extra: dict[str, Any]) -> None:
    made = record("%s", message)
    vars(made).update({f"x{name}": value for name, value in extra.items()})
    line = JsonFormatter(Hide()).format(made)
    assert "\n" not in line
    parsed = json.loads(line, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    assert set(parsed) == {"time", "level", "logger", "message", *(f"x{name}" for name in extra)} or any(
        0xD800 <= ord(c) < 0xE000 for name in extra for c in name
    )
    assert TextFormatter(Hide()).format(made).count("\n") == 0


def test_extra_never_replaces_what_a_line_has() -> None:
    line = json.loads(JsonFormatter(Hide()).format(record("hello", time=5, level="x", logger=1)))
    assert (line["level"], line["logger"], line["message"]) == ("info", "fapstream.server", "hello")


def test_wrong_calls_and_values_that_cannot_be_shown_hurt_nobody(tmp_path: Path) -> None:
    class Bad:
        def __str__(self) -> str:
            raise RuntimeError("no")

    start_log("json", tmp_path / "log", "info")
    log.info("%d turns", "many")
    log.info("bad", extra={"bad": Bad()})
    log.info("after")
    said = [line["message"] for line in lines(tmp_path / "log")]
    assert said == ["%d turns ('many',)", "after", "1 lines of this log were lost"]


# secrets

JWT = "eyJhbGciOiJIUzI1NiJ9.eyJzY29wZSI6InNwZWFrIn0.c2lnbmF0dXJlLXRoYXQtaXMtbG9uZw"
OURS = "our-own-secret-of-more-than-thirty-two-bytes"


@pytest.mark.parametrize(
    "message",
    [
        "GET /ws?lang=en&token=S3CRET&x=1 HTTP/1.1",
        "GET /ws?token=S3CRET",
        "Authorization: Bearer S3CRET",
        "authorization: Basic S3CRET==",
        "> Authorization: Digest username=x, response=S3CRET",
        "{'Authorization': 'Bearer S3CRET', 'a': 1}",
        '{"token": "S3CRET", "a": 1}',
        "Hello(client='x', token='S3CRET', lang='en')",
        "Resume(session='ab12', resume_key='S3CRET')",
        "resume=S3CRET",
        "resume: S3CRET",
        "session_token = S3CRET",
        "SECRET=S3CRET",
        "FAPSTREAM_SECRET=S3CRET",
        "api_key: S3CRET",
        "Cookie: a=1; b=S3CRET",
        "bearer S3CRET",
        "token=b'S3CRET'",
        "Speak(turn=1, text=b'say S3CRET, please', lang='en')",
        'Speak(turn=1, text="it\'s S3CRET", lang=None)',
        "Speak(turn=1, text='it is \\'S3CRET\\' here')",
        "{'text': 'S3CRET', 'turn': 1}",
        f"somebody came with {JWT}".replace("c2lnbmF0dXJl", "S3CRET"),
        f"{OURS} was S3CRET".replace(" was S3CRET", ""),
    ],
)
def test_secrets_are_hidden(message: str) -> None:
    hide = Hide([OURS])
    for form in (JsonFormatter(hide), TextFormatter(hide)):
        for made in (record(message), record("%s", message), record("hello", peer=message)):
            said = form.format(made)
            assert "S3CRET" not in said
            assert OURS not in said
            assert "[hidden]" in said


@pytest.mark.parametrize(
    "message",
    ["3 tokens a second", "token expired", "the text is too long: 70000 characters",
     "GET /ws?lang=en HTTP/1.1", "resumes: 5", "text=12", "context: 'x'"],
)  # fmt: skip
def test_what_is_no_secret_stays(message: str) -> None:
    assert Hide([OURS]).text(message) == message


@pytest.mark.parametrize(
    "name", ["token", "text", "resume_key", "Authorization", "secret", "new_text", "x_token_y"]
)
def test_fields_named_like_secrets_say_how_long_they_are(name: str) -> None:
    line = json.loads(JsonFormatter(Hide()).format(record("hello", **{name: "S3CRET"})))
    assert line[name] == "[hidden] 6"
    assert "S3CRET" not in TextFormatter(Hide()).format(record("hello", **{name: ["S3CRET"]}))


def test_frames_are_never_written_down(tmp_path: Path) -> None:
    """At DEBUG websockets logs what is said."""
    start_log("text", tmp_path / "log", "debug")
    for name in logs.CHATTY:
        logging.getLogger(f"{name}.server").debug("> BINARY 83 a4 ...")
    assert (tmp_path / "log").read_text() == ""


def test_very_long_messages_are_cut() -> None:
    assert len(Hide().text("x" * 10**6)) == logs.LONGEST + 3
    assert "S3CRET" not in Hide().text("eyJ-" * 100_000 + " token=S3CRET")


# misfortune


def test_a_full_disk_is_said_once_and_hurts_nobody(capsys: pytest.CaptureFixture[str]) -> None:
    start_log("json", Path("/dev/full"), "info")
    for n in range(5):
        log.info("line %d", n)
    said = capsys.readouterr().err
    assert (
        said == "fapstream: the log /dev/full cannot be written: No space left on device; going on without\n"
    )


FULL = """
import json, logging, resource, sys
from pathlib import Path
from fapstream.cli.logs import start_log
file = Path(sys.argv[1])
start_log("json", file, "info")
log = logging.getLogger("x")
limit = resource.getrlimit(resource.RLIMIT_FSIZE)
log.info("first")
resource.setrlimit(resource.RLIMIT_FSIZE, (file.stat().st_size + 20, limit[1]))
for _ in range(9):
    log.info("there is no room for this")
resource.setrlimit(resource.RLIMIT_FSIZE, limit)
log.info("room again")
log.info("last")
"""


def test_a_disk_that_has_room_again_is_written_again(tmp_path: Path) -> None:
    """A file may grow no further in the middle of a line; later it may."""
    file = tmp_path / "log"
    run = subprocess.run([sys.executable, "-c", FULL, str(file)], capture_output=True, text=True, check=True)
    cannot, again = run.stderr.splitlines()
    assert re.fullmatch(rf"fapstream: the log {file} cannot be written: .+; going on without", cannot)
    assert again == f"fapstream: the log {file} is written again; 9 lines were lost"
    text = file.read_text().splitlines()
    whole = [json.loads(text[n])["message"] for n in (0, 2, 3, 4)]
    assert len(text) == 5
    assert len(text[1]) == 20, "the torn line"
    assert whole == ["first", "room again", "9 lines of this log were lost", "last"]


STDERR = """
import logging, os, sys
from fapstream.cli.logs import start_log
start_log("text", None, "info")
if sys.argv[1] == "fd":
    os.close(2)
elif sys.argv[1] == "stream":
    sys.stderr.close()
for n in range(2000):
    logging.getLogger("x").warning("line %d", n)
print("alive", flush=True)
"""


@pytest.mark.parametrize("how", ["fd", "stream", "pipe", "none", "full"])
def test_a_closed_stderr_hurts_nobody(how: str) -> None:
    redirection = {"pipe": "2> >(exec true)", "none": "2>&-", "full": "2>/dev/full"}.get(how, "")
    shell = f'"$0" -c "$1" {how} {redirection}'
    run = subprocess.run(
        ["bash", "-c", shell, sys.executable, STDERR], capture_output=True, text=True, check=False
    )
    assert run.stdout == "alive\n"
    assert run.returncode == 0


@pytest.mark.parametrize("hangup", [False, True])
def test_a_file_that_was_moved_away_is_begun_anew(tmp_path: Path, hangup: bool) -> None:
    file, old = tmp_path / "log", tmp_path / "log.1"
    start_log("json", file, "info")
    log.info("old")
    file.rename(old)
    if hangup:
        os.kill(os.getpid(), signal.SIGHUP)
    log.info("new")
    assert [line["message"] for line in lines(old)] == ["old"]
    assert [line["message"] for line in lines(file)] == ["new"]
    assert file.stat().st_mode & 0o007 == 0, "not for everybody's eyes"


def test_sighup_opens_anew_what_looks_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # under nohup it would be ignored
    start_log("text", tmp_path / "log", "info")
    opened: list[str] = []
    real = os.open
    monkeypatch.setattr(logs.os, "open", lambda *args: opened.append(str(args[0])) or real(*args))
    log.info("one")
    assert opened == []
    signal.raise_signal(signal.SIGHUP)
    log.info("two")
    log.info("three")
    assert opened == [str(tmp_path / "log")]


def test_a_file_that_was_emptied_goes_on_at_its_beginning(tmp_path: Path) -> None:
    start_log("json", tmp_path / "log", "info")
    log.info("old")
    os.truncate(tmp_path / "log", 0)
    log.info("new")
    assert [line["message"] for line in lines(tmp_path / "log")] == ["new"]


def test_a_folder_that_vanished_and_came_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "logs"
    folder.mkdir()
    start_log("json", folder / "log", "info")
    folder.rename(tmp_path / "elsewhere")
    log.info("lost")
    folder.mkdir()
    log.info("found")
    assert [line["message"] for line in lines(folder / "log")] == ["found", "1 lines of this log were lost"]
    assert "No such file" in capsys.readouterr().err


def test_who_ignores_hangups_goes_on_doing_so(tmp_path: Path) -> None:
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    start_log("text", tmp_path / "log", "info")
    assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN


def test_a_file_that_cannot_be_opened_is_said_at_once(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        start_log("text", tmp_path / "nowhere" / "log", "info")


def test_the_options() -> None:
    parser = argparse.ArgumentParser()
    add_log_arguments(parser)
    args = parser.parse_args(["--log-format", "json", "--log-file", "f", "--log-level", "info"])
    assert (args.log_format, args.log_file, args.log_level) == ("json", Path("f"), "info")
    assert parser.parse_args([]).log_level is None
