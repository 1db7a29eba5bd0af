"""What the editor page works with."""

from __future__ import annotations

import sys

import pytest

from fapstream.cli.editor import editor
from fapstream.errors import InputError


def test_a_session_is_ready() -> None:
    message = editor(lambda: 0.0).ready()
    assert message["type"] == "ready"
    assert isinstance(message["automatic"], bool)


def test_without_the_extra_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith("fapstream.adapt.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delitem(sys.modules, "fapstream.adapt", raising=False)
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(InputError, match="adapt"):
        editor(lambda: 0.0)
