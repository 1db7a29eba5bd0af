"""The log of a server: lines for people or JSON for programs, without secrets and never in its way."""

from __future__ import annotations

import argparse
import atexit
import errno
import json
import logging
import os
import re
import signal
import sys
import time
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

LEVELS = ("debug", "info", "warning", "error")
FORMATS = ("text", "json")
CHATTY = ("fapstream.websockets", "websockets")
"""Loggers that write down every frame when they debug, with everything that is said in it."""

STANDARD = frozenset(vars(logging.makeLogRecord({}))) | {"message", "asctime", "taskName"}
"""What every record has; the rest was given by `extra`."""

LONGEST = 8000
"""Characters of a message or traceback."""
HIDDEN = "[hidden]"
SECRET = r"(?:token|secret|password|resume(?:_?key)?|api_?key)"
IS = r"[\"']?\s*[=:]\s*"
SECRETS = (
    re.compile(r"\b()eyJ[\w-]+\.[\w-]*\.[\w-]*"),  # a JSON Web Token wherever it stands
    re.compile(rf"(?i)\b((?:authorization|cookie){IS}[\"']?)[^\"'\r\n]+"),
    re.compile(r"(?i)\b(bearer\s+)[^\s\"']+"),
    re.compile(rf"(?i)(?<![a-z])({SECRET}{IS}b?[\"']?)[^\s\"'&,;)}}\]]+"),
    re.compile(rf"(?i)\b(text{IS}b?)(?:\"(?:[^\"\\]|\\.)*\"?|'(?:[^'\\]|\\.)*'?)"),  # what is being said
)
"""What stands before a secret, to be kept, and the secret."""
PRIVATE = re.compile(rf"(?i)text|.*_text|.*{SECRET}.*|authorization|cookie")
"""Names of fields whose values are nobody's business."""


def add_log_arguments(parser: argparse.ArgumentParser) -> None:
    """--log-format, --log-file, --log-level."""
    parser.add_argument(
        "--log-format", choices=FORMATS, default=FORMATS[0], help="lines for people, or JSON (default text)"
    )
    parser.add_argument(
        "--log-file", type=Path, metavar="F", help="where the log goes (default: stderr); may be rotated"
    )
    parser.add_argument("--log-level", choices=LEVELS, help="how much is logged (default warning)")


def start_log(form: str, file: Path | None, level: str, secrets: Iterable[str] = ()) -> None:
    """Log from now on in this process. `secrets` are hidden wherever they turn up.

    With a file, SIGHUP opens it anew; a file that was moved away is noticed without it. To be called by the
    main thread. Raises OSError if the file cannot be opened now; what happens to it later is said on stderr.
    """
    handler = FileSink(file) if file else StderrSink()
    hide = Hide(secrets)
    handler.setFormatter(JsonFormatter(hide) if form == "json" else TextFormatter(hide))
    logging.basicConfig(level=level.upper(), handlers=[handler], force=True)
    atexit.register(_let_go)
    for name in CHATTY:
        logging.getLogger(name).setLevel(max(logging.INFO, logging.getLogger().level))
    if isinstance(handler, FileSink) and signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:  # as under nohup
        signal.signal(signal.SIGHUP, handler.reopen)


def _let_go() -> None:
    """What a stderr that is gone does not take any more is no failure of the whole program at its end."""
    try:
        sys.stderr.flush()
    except (OSError, ValueError):
        sys.stderr = None


class Hide:
    """Takes secrets out of text: those it is told, and whatever looks like one."""

    def __init__(self, secrets: Iterable[str] = ()) -> None:
        known = sorted(filter(None, secrets), key=len, reverse=True)
        self._known = re.compile("|".join(map(re.escape, known))) if known else None

    def text(self, text: str) -> str:
        """The text without them, and without what makes it longer than a log has use for."""
        text = text if len(text) <= LONGEST else f"{text[:LONGEST]}..."
        if self._known:
            text = self._known.sub(HIDDEN, text)
        for pattern in SECRETS:
            text = pattern.sub(rf"\1{HIDDEN}", text)
        return text

    def value(self, name: str, value: Any) -> Any:
        """The value of a field as it may be written: numbers as they are, all else as text."""
        if PRIVATE.fullmatch(name):
            return f"{HIDDEN} {len(value)}" if isinstance(value, str | bytes) else HIDDEN
        if value is None or isinstance(value, bool | int):
            return value
        if isinstance(value, float):
            return value if abs(value) < float("inf") else str(value)
        return self.text(str(value))


class JsonFormatter(logging.Formatter):
    """One JSON object a line: time (UTC), level, logger, message, what `extra` gave, exception."""

    def __init__(self, hide: Hide) -> None:
        super().__init__()
        self._hide = hide

    def format(self, record: logging.LogRecord) -> str:
        """See logging."""
        line: dict[str, Any] = {
            "time": _utc(record.created), "level": record.levelname.lower(), "logger": record.name,
            "message": self._hide.text(_message(record)),
        }  # fmt: skip
        for name, value in _extra(record).items():
            line.setdefault(name, self._hide.value(name, value))
        if record.exc_info:
            line["exception"] = self._hide.text(self.formatException(record.exc_info))
        return json.dumps(line, ensure_ascii=False).encode("utf-8", "replace").decode()


class TextFormatter(logging.Formatter):
    """Time, level, logger, message, name=value ...; a traceback on lines of its own, moved in."""

    def __init__(self, hide: Hide) -> None:
        super().__init__()
        self._hide = hide

    def format(self, record: logging.LogRecord) -> str:
        """See logging."""
        extra = [f"{name}={self._hide.value(name, value)}" for name, value in _extra(record).items()]
        words = [_utc(record.created), f"{record.levelname.lower():<7}", record.name]
        line = " ".join([*words, self._hide.text(_message(record)), *extra])
        lines = [_printable(line)]
        if record.exc_info:
            trace = self._hide.text(self.formatException(record.exc_info))
            lines += [f"  {_printable(part)}" for part in trace.splitlines()]
        return "\n".join(lines)


def _message(record: logging.LogRecord) -> str:
    try:
        return record.getMessage()
    except Exception:  # a wrong call of the logger is no reason to lose what it had to say
        return f"{record.msg} {record.args}"


def _extra(record: logging.LogRecord) -> dict[str, Any]:
    return {name: value for name, value in vars(record).items() if name not in STANDARD}


def _utc(seconds: float) -> str:
    return time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(seconds)) + f".{int(seconds % 1 * 1000):03d}Z"


def _printable(line: str) -> str:
    """Nobody's name may begin a line of its own or move the cursor."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in line)


class Sink(logging.Handler):
    """Writes lines somewhere. What cannot be written is lost and counted: the server goes on."""

    def __init__(self) -> None:
        super().__init__()
        self._lost = 0

    def write(self, line: str) -> None:
        """One line with its end. May raise anything."""
        raise NotImplementedError

    def told(self, text: str) -> None:
        """Something has to be said about this log itself, elsewhere than in it."""

    def emit(self, record: logging.LogRecord) -> None:
        """See logging. Raises nothing."""
        try:
            self.write(self.format(record) + "\n")
            if self._lost:
                lost, self._lost = self._lost, 0
                self.told(f"is written again; {lost} lines were lost")
                self.emit(_warning(f"{lost} lines of this log were lost"))
        except Exception as e:
            if not self._lost:
                self.told(f"cannot be written: {getattr(e, 'strerror', None) or e}; going on without")
            self._lost += 1


class StderrSink(Sink):
    """Writes to the stderr of the time it was made; there may be none."""

    def __init__(self) -> None:
        super().__init__()
        self._stream = sys.stderr

    def write(self, line: str) -> None:
        """Raises OSError, and AttributeError or ValueError for one that is closed."""
        self._stream.write(line)
        self._stream.flush()


class FileSink(Sink):
    """Appends to a file, line by line in one piece, so that several processes may share it. Follows when the
    file is moved away or SIGHUP asks to.
    """

    def __init__(self, path: Path) -> None:
        """Raises OSError."""
        super().__init__()
        self._path = path
        self._asked = False
        self._torn = False
        """Whether a line has no end."""
        self._file: int | None = self._opened()

    def reopen(self, *_: object) -> None:
        """Open it anew at the next line; a signal may come in the middle of one."""
        self._asked = True

    def write(self, line: str) -> None:
        """Raises OSError."""
        if self._file is None or self._moved():
            self._release()
            self._file, self._torn = self._opened(), False
        data = ("\n" if self._torn else "").encode() + line.encode("utf-8", "replace")
        written = os.write(self._file, data)
        if written:
            self._torn = written < len(data)
        if self._torn:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def told(self, text: str) -> None:
        """On stderr, if there is one."""
        with suppress(OSError, ValueError):
            print(f"fapstream: the log {self._path} {text}", file=sys.stderr, flush=True)

    def close(self) -> None:
        """See logging."""
        self._release()
        super().close()

    def _moved(self) -> bool:
        assert self._file is not None
        asked, self._asked = self._asked, False
        try:
            return asked or not os.path.samestat(os.fstat(self._file), self._path.stat())
        except FileNotFoundError:
            return True

    def _opened(self) -> int:
        return os.open(self._path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o640)

    def _release(self) -> None:
        file, self._file = self._file, None
        if file is not None:
            os.close(file)


def _warning(text: str) -> logging.LogRecord:
    return logging.LogRecord(__name__, logging.WARNING, "", 0, text, None, None)
