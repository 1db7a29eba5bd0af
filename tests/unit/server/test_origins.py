"""Which pages may talk to the server, as a table."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import InputError
from fapstream.server.origins import Doors, listed, refusal

HOME = Doors()
LISTED = Doors(listed(["https://app.example.org", "http://intra:8080", "HTTPS://Big.example:443/"]))
ANY = Doors(listed(["*"]), loopback=False)
OPEN = Doors(loopback=False)
TOKENS = Doors(loopback=False, tokens=True)
BOTH = Doors(listed(["https://app.example.org"]), loopback=False, tokens=True)

LET_IN = [
    # programs
    (HOME, None, "127.0.0.1:8765"),
    (HOME, None, "localhost:8765"),
    (HOME, None, "[::1]:8765"),
    (HOME, None, "LocalHost"),
    (HOME, None, "head.localhost:1"),
    (HOME, None, "192.168.1.5:8765"),
    (HOME, None, None),
    (OPEN, None, "203.0.113.9"),
    (OPEN, None, "[2001:db8::1]:8765"),
    (TOKENS, None, "speak.example.org"),
    (LISTED, None, "app.example.org"),
    (LISTED, None, "intra:9999"),
    # pages of this machine, of any port
    (HOME, "http://localhost:3000", "127.0.0.1:8765"),
    (HOME, "https://localhost", "localhost:8765"),
    (HOME, "http://127.0.0.1:8765", "127.0.0.1:8765"),
    (HOME, "http://127.9.9.9", "127.0.0.1:8765"),
    (HOME, "http://[::1]:5173", "[::1]:8765"),
    # our own pages
    (OPEN, "http://192.168.1.5:8765", "192.168.1.5:8765"),
    (OPEN, "http://192.168.1.5", "192.168.1.5:80"),
    (OPEN, "https://192.168.1.5:443", "192.168.1.5"),
    (OPEN, "http://[2001:db8::1]:8765", "[2001:db8::1]:8765"),
    (OPEN, "http://localhost:8765", "localhost:8765"),
    (TOKENS, "https://speak.example.org", "speak.example.org"),
    (TOKENS, "https://SPEAK.example.org", "speak.EXAMPLE.org"),
    # pages that were named
    (LISTED, "https://app.example.org", "127.0.0.1:8765"),
    (LISTED, "https://app.example.org", "app.example.org"),
    (LISTED, "http://intra:8080", "intra:8765"),
    (LISTED, "https://big.example", "127.0.0.1:8765"),
    (BOTH, "https://app.example.org", "speak.example.org"),
    (Doors(listed(["null"])), "null", "127.0.0.1:8765"),
    (ANY, "https://evil.example", "evil.example"),
    (ANY, "null", None),
    (ANY, None, "anything"),
]

REFUSED = [
    # a foreign page
    (HOME, "https://evil.example", "127.0.0.1:8765"),
    (HOME, "http://192.168.1.5:8765", "127.0.0.1:8765"),
    (HOME, "null", "127.0.0.1:8765"),
    (HOME, "", "127.0.0.1:8765"),
    (HOME, "file://", "127.0.0.1:8765"),
    (TOKENS, "https://evil.example", "speak.example.org"),
    (LISTED, "http://app.example.org", "127.0.0.1:8765"),
    (LISTED, "https://app.example.org:8443", "127.0.0.1:8765"),
    (LISTED, "https://app.example.org.evil.example", "127.0.0.1:8765"),
    (LISTED, "https://x.app.example.org", "127.0.0.1:8765"),
    # pages of a visitor's own machine, where others can come in
    (OPEN, "http://localhost:3000", "192.168.1.5:8765"),
    (OPEN, "http://192.168.1.5:3000", "192.168.1.5:8765"),
    (OPEN, "https://192.168.1.5", "192.168.1.5:80"),
    # DNS rebinding: a foreign name that means this server, with and without a page
    (HOME, "http://evil.example:8765", "evil.example:8765"),
    (HOME, None, "evil.example:8765"),
    (HOME, None, "localhost.evil.example"),
    (HOME, None, "evil-localhost"),
    (HOME, None, "127.0.0.1.nip.io"),
    (HOME, None, "127.0.0.1.evil.example:8765"),
    (OPEN, "http://evil.example:8765", "evil.example:8765"),
    (OPEN, None, "evil.example"),
    (LISTED, None, "evil.example"),
    # lookalikes
    (HOME, "http://localhost.evil.example", "127.0.0.1:8765"),
    (HOME, "http://localhost@evil.example", "127.0.0.1:8765"),
    (HOME, "http://127.evil.example", "127.0.0.1:8765"),
    (HOME, "http://[::1].evil.example", "127.0.0.1:8765"),
    (HOME, "http://localhost/", "127.0.0.1:8765"),
    (HOME, "http://localhost:99999999", "127.0.0.1:8765"),
    (HOME, "ftp://localhost", "127.0.0.1:8765"),
    (HOME, "chrome-extension://localhost", "127.0.0.1:8765"),
    (HOME, "http://localhost, http://evil.example", "127.0.0.1:8765"),
    # hosts that are none
    (HOME, None, ""),
    (HOME, None, "a b"),
    (HOME, None, "127.0.0.1:8765@evil.example"),
    (TOKENS, None, "evil/../x"),
    (TOKENS, None, "x" + "\0"),
]


@pytest.mark.parametrize(("doors", "origin", "host"), LET_IN)
def test_let_in(doors: Doors, origin: str | None, host: str | None) -> None:
    assert refusal(origin, host, doors) is None


@pytest.mark.parametrize(("doors", "origin", "host"), REFUSED)
def test_refused(doors: Doors, origin: str | None, host: str | None) -> None:
    said = refusal(origin, host, doors)
    assert said is not None
    assert "--origin" in said
    assert len(said) < 200


@given(st.text(max_size=40), st.text(max_size=40))
def test_whatever_is_sent_only_what_is_plainly_ours_comes_in(origin: str, host: str) -> None:
    assert refusal(f"https://{origin}.evil.example", "127.0.0.1", HOME) is not None
    assert refusal(None, f"{host}.evil.example", OPEN) is not None
    refusal(origin, host, TOKENS)


@pytest.mark.parametrize(
    "text",
    ["", "example.org", "https://", "https://a/b", "https://a b", "https://é.gr", "https://*.a.org", "**"],
)
def test_origins_that_are_none(text: str) -> None:
    with pytest.raises(InputError, match="is no origin such as https:"):
        listed([text])
