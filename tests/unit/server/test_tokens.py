"""Tokens: what was granted is what is found, and nothing that was not signed here is ever believed."""

from __future__ import annotations

import base64
import hashlib
import hmac
import json
from pathlib import Path
from typing import Any

import jwt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import InputError, NotAuthorised
from fapstream.server import tokens
from fapstream.server.tokens import EVERYTHING, SCOPES, Grant, check, mint, new_secret, read_secrets

NOW = 1_800_000_000.0
SECRET = b"a secret of more than thirty-two bytes"
OTHER = b"another one that is as long as it must be"
CLAIMS = {"scope": "speak listen", "exp": NOW + 60, "sub": "ann", "channel": "news"}
GRANT = Grant(frozenset({"speak", "listen"}), "news", "ann")


def part(value: Any) -> str:
    data = value if isinstance(value, bytes) else json.dumps(value).encode()
    return base64.urlsafe_b64encode(data).rstrip(b"=").decode()


def signed(claims: Any, header: Any = None, secret: bytes = SECRET) -> str:
    """A token made by hand after RFC 7515, the way a back end in another language would."""
    body = f"{part(header or {'alg': 'HS256', 'typ': 'JWT'})}.{part(claims)}"
    return f"{body}.{part(hmac.digest(secret, body.encode(), hashlib.sha256))}"


def refused(token: str, *secrets: bytes, now: float = NOW) -> str:
    """Why; the token is never in it."""
    with pytest.raises(NotAuthorised) as caught:
        check(token, secrets or (SECRET,), now)
    assert caught.value.code == "unauthorised"
    message = str(caught.value)
    assert len(token) < 12 or not any(p in message for p in token.split(".") if len(p) > 8)
    return message


@given(
    scopes=st.sets(st.sampled_from(SCOPES), min_size=1),
    channel=st.none() | st.text(min_size=1, max_size=64).filter(lambda t: t.isprintable()),
    subject=st.text(max_size=200).filter(lambda t: t.isprintable()),
    ttl_s=st.floats(1, 1e8),
)
def test_what_was_granted_is_found_until_it_expires(
    scopes: set[str], channel: str | None, subject: str, ttl_s: float
) -> None:
    grant = Grant(frozenset(scopes), channel, subject)
    token = mint(SECRET, grant, ttl_s, NOW)
    assert check(token, [SECRET], NOW) == grant
    assert check(token, [SECRET], NOW + ttl_s) == grant
    assert "expired" in refused(token, now=NOW + ttl_s + tokens.LEEWAY_S + 1)


def test_a_token_made_by_hand_after_the_rfc_is_good() -> None:
    assert check(signed(CLAIMS), [SECRET], NOW) == GRANT


def test_ours_can_be_read_by_others() -> None:
    token = mint(SECRET, GRANT, 60, NOW)
    claims = jwt.decode(token, SECRET, algorithms=["HS256"], options={"verify_exp": False})
    assert claims == CLAIMS | {"scope": "listen speak"}


@pytest.mark.parametrize(("late_s", "good"), [(29, True), (31, False)])
def test_clocks_may_be_half_a_minute_apart(late_s: float, good: bool) -> None:
    token = signed(CLAIMS | {"exp": NOW})
    early = signed(CLAIMS | {"nbf": NOW + late_s})
    if good:
        assert check(token, [SECRET], NOW + late_s) == check(early, [SECRET], NOW) == GRANT
    else:
        assert "expired" in refused(token, now=NOW + late_s)
        assert "not good yet" in refused(early)


def test_who_is_late_can_tell() -> None:
    with pytest.raises(NotAuthorised) as caught:
        check(signed(CLAIMS), [SECRET], NOW + 1000)
    assert caught.value.expired
    with pytest.raises(NotAuthorised) as caught:
        check(signed(CLAIMS), [OTHER], NOW + 1000)
    assert not caught.value.expired, "who cannot sign is told nothing"


def test_the_first_secret_signs_and_all_are_good() -> None:
    old, new = signed(CLAIMS, secret=OTHER), signed(CLAIMS)
    assert check(old, [SECRET, OTHER], NOW) == check(new, [SECRET, OTHER], NOW) == GRANT
    assert "not signed" in refused(old, SECRET)
    assert "not signed" in refused(old)


@pytest.mark.parametrize(
    "header",
    [{"alg": "none"}, {"alg": "None"}, {"alg": "HS512"}, {"alg": "RS256"}, {"alg": ""}, {}, {"alg": None},
     {"alg": ["HS256"]}, {"alg": {}}, {"alg": "HS256", "kid": 5}, {"alg": "HS256", "crit": ["x"], "x": 1},
     {"alg": "HS256", "b64": False, "crit": ["b64"]}],
    ids=str,
)  # fmt: skip
def test_other_algorithms_are_refused(header: dict[str, Any]) -> None:
    refused(signed(CLAIMS, header or b"{}"))
    unsigned = f"{part(header)}.{part(CLAIMS)}."
    refused(unsigned)


def test_none_is_not_an_algorithm() -> None:
    refused(jwt.encode(CLAIMS, None, "none"))


@pytest.mark.parametrize(
    ("changed", "message"),
    [({"exp": None}, "never expires"), ({"exp": "soon"}, "no time"), ({"exp": True}, "no time"),
     ({"exp": float("inf")}, "no time"), ({"exp": float("nan")}, "no time"), ({"exp": 10**400}, "no time"),
     ({"exp": []}, "no time"), ({"nbf": "x"}, "no time"), ({"scope": None}, "no scope"),
     ({"scope": ["speak"]}, "no scope"), ({"scope": ""}, "no scope"), ({"scope": "Speak speakers"}, "scope"),
     ({"channel": None}, "channel"), ({"channel": ""}, "channel"), ({"channel": 5}, "channel"),
     ({"channel": "x" * 65}, "channel"), ({"channel": ["news"]}, "channel"), ({"sub": 5}, "no token"),
     ({"sub": "x" * 201}, "subject")],
    ids=str,
)  # fmt: skip
def test_claims_that_say_nothing_sensible(changed: dict[str, Any], message: str) -> None:
    """Above all: a channel that cannot be read never becomes every channel."""
    assert message in refused(signed(CLAIMS | changed))


def test_a_token_without_an_end_is_refused() -> None:
    assert "never expires" in refused(signed({"scope": "speak"}))


@pytest.mark.parametrize("claims", [b"[]", b"null", b"5", b"", b"\xff", b"[" * 2900], ids=repr)
def test_claims_that_are_no_map(claims: bytes) -> None:
    refused(signed(claims))


@pytest.mark.parametrize("header", [b"[" * 2900, b"[]", b"\xff\xfe", b"null"], ids=lambda h: repr(h[:9]))
def test_headers_that_are_no_map(header: bytes) -> None:
    refused(signed(CLAIMS, header))


def test_scopes_of_others_are_skipped() -> None:
    assert check(signed(CLAIMS | {"scope": "admin speak x:y"}), [SECRET], NOW).scopes == {"speak"}


@given(
    st.text(max_size=200) | st.from_regex(r"[A-Za-z0-9_-]*\.[A-Za-z0-9_-]*\.[A-Za-z0-9_-]*", fullmatch=True)
)
def test_garbage_is_refused_and_nothing_else_happens(token: str) -> None:
    refused(token)


@given(st.data())
def test_what_was_tampered_with_is_refused(data: st.DataObject) -> None:
    token = signed(CLAIMS)
    place = data.draw(st.integers(0, len(token) - 2))  # the last character has bits that mean nothing
    letter = data.draw(st.sampled_from("ABCDabcd0189-_."))
    if token[place] != letter:
        refused(token[:place] + letter + token[place + 1 :])


@given(st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=9),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(
        ["scope", "exp", "nbf", "iat", "sub", "channel", "aud", "iss", "jti"]), inner, max_size=6),
))  # fmt: skip
def test_whatever_is_signed_grants_only_what_it_says(claims: Any) -> None:
    try:
        grant = check(signed(json.dumps(claims).encode("utf-8", "surrogatepass")), [SECRET], NOW)
    except NotAuthorised:
        return
    assert grant.scopes <= set(claims["scope"].split())
    assert grant.channel == claims.get("channel")


def test_too_much_is_refused_unread() -> None:
    assert refused(signed(CLAIMS) + "A" * 5000) == "this is no token"
    assert refused("") == "a token is needed here"


def test_a_grant_is_asked() -> None:
    GRANT.require("speak", "news")
    with pytest.raises(NotAuthorised, match="'news' only"):
        GRANT.require("listen", "sport")
    with pytest.raises(NotAuthorised, match="'news' only"):
        GRANT.require("speak")
    with pytest.raises(NotAuthorised, match="scope 'adapt'"):
        GRANT.require("adapt")
    Grant(frozenset({"adapt"}), "news").require("adapt")
    for scope in SCOPES:
        EVERYTHING.require(scope, "any")
        EVERYTHING.require(scope)


@pytest.mark.parametrize(
    ("secret", "grant", "ttl_s", "message"),
    [(b"short", GRANT, 60, "has 5 bytes; at least 32"), (b"x" * 31, GRANT, 60, "31 bytes"),
     (SECRET, Grant(frozenset()), 60, "allows nothing"),
     (SECRET, Grant(frozenset({"fly"})), 60, "no scope called 'fly'"), (SECRET, GRANT, 0, "0 seconds"),
     (SECRET, GRANT, float("inf"), "inf"), (SECRET, GRANT, float("nan"), "nan"),
     (SECRET, Grant(frozenset({"speak"}), ""), 60, "channel"),
     (SECRET, Grant(frozenset({"speak"}), "x" * 65), 60, "channel")],
)  # fmt: skip
def test_what_cannot_be_minted(secret: bytes, grant: Grant, ttl_s: float, message: str) -> None:
    with pytest.raises(InputError, match=message):
        mint(secret, grant, ttl_s, NOW)


def test_fresh_secrets_are_good_and_never_the_same() -> None:
    made = {new_secret() for _ in range(50)}
    assert len(made) == 50
    for secret in made:
        assert check(mint(secret.encode(), GRANT, 60, NOW), [secret.encode()], NOW) == GRANT


def test_secrets_are_read(tmp_path: Path) -> None:
    file = tmp_path / "secrets"
    file.write_bytes(SECRET.replace(b" ", b"-") + b"\r\n\n  " + OTHER.replace(b" ", b"-") + b"\n")
    found = read_secrets(file, {"FAPSTREAM_SECRET": "not looked at"})
    assert found == (SECRET.replace(b" ", b"-"), OTHER.replace(b" ", b"-"))
    assert read_secrets(None, {"FAPSTREAM_SECRET": " ".join(s.decode() for s in found)}) == found
    assert read_secrets(None, {}) == ()


@pytest.mark.parametrize(
    ("content", "message"),
    [(b"", "holds no secret"), (b" \n", "holds no secret"),
     (b"x" * 40 + b"\nshort\n", "secret 2 of .* 5 bytes"),
     (b"\xff" * 40, "no text")],
)  # fmt: skip
def test_files_that_hold_no_secrets(tmp_path: Path, content: bytes, message: str) -> None:
    (tmp_path / "f").write_bytes(content)
    with pytest.raises(InputError, match=message) as caught:
        read_secrets(tmp_path / "f", {})
    assert "xxxx" not in str(caught.value)


def test_a_short_secret_in_the_environment() -> None:
    with pytest.raises(InputError, match="secret 1 of FAPSTREAM_SECRET has 5 bytes") as caught:
        read_secrets(None, {"FAPSTREAM_SECRET": "short"})
    assert "'short'" not in str(caught.value)
