"""The list of voices, and the command line's own manners."""

from __future__ import annotations

import pytest

from fapstream import __version__
from fapstream.adapters.pool import installed
from fapstream.cli import COMMANDS, main
from fapstream.tts.voices import voices


def test_one_line_a_voice(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["voices"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == [v.name for v in voices()]
    for line, v in zip(lines, voices(), strict=True):
        assert line.split()[1:4] == [v.lang, v.engine, str(v.sample_rate)]
        assert ("not installed" in line) == (not installed(v))
        assert line.endswith(v.description)


def exit_status(argv: list[str]) -> object:
    with pytest.raises(SystemExit) as caught:
        main(argv)
    return caught.value.code


@pytest.mark.parametrize("command", [m.__name__.rpartition(".")[2] for m in COMMANDS])
def test_every_command_explains_itself(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_status([command, "--help"]) == 0
    assert command in capsys.readouterr().out


def test_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_status(["--help"]) == 0
    out = capsys.readouterr().out
    assert all(m.HELP in out for m in COMMANDS)
    assert exit_status(["--version"]) == 0
    assert capsys.readouterr().out == f"fapstream {__version__}\n"


@pytest.mark.parametrize("argv", [[], ["sing"], ["voices", "x"], ["--nope"]])
def test_a_wrong_call_exits_2(argv: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_status(argv) == 2
    assert "usage: fapstream" in capsys.readouterr().err
