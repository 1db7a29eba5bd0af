"""Tokens: what their holder may do and until when, signed so that nobody else can make one.

They are JSON Web Tokens (RFC 7519) with HMAC-SHA-256, so that any back end can make them. Claims: `scope`,
words with spaces between; `exp`, seconds since 1970, always there; `sub`, who it is, for the log; `channel`,
the only one to speak into or listen to.
"""

from __future__ import annotations

import math
import secrets as chance
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jwt
from jwt.types import Options

from fapstream.errors import InputError, NotAuthorised

SCOPES = ("speak", "listen", "adapt", "metrics")
ALGORITHM = "HS256"
LEAST_SECRET_BYTES = 32
"""As long as what it signs with; RFC 7518, 3.2."""
LONGEST_TOKEN = 4096
"""Characters; as much as fits into `hello`."""
LONGEST_NAME = 64
LONGEST_SUBJECT = 200
LEEWAY_S = 30.0
"""How far the clocks of two machines may be apart."""
SECRET_VARIABLE = "FAPSTREAM_SECRET"

CHECKED: Options = {
    "verify_signature": True, "require": ["exp"],
    "verify_exp": False, "verify_nbf": False, "verify_iat": False,
}  # fmt: skip
"""Times are compared with `now` here, not with the clock of the machine there."""


@dataclass(frozen=True, slots=True)
class Grant:
    """What the holder of a token may do."""

    scopes: frozenset[str]
    channel: str | None = None
    """The only channel to speak into or to listen to; None: any, and sessions without one."""
    subject: str = ""
    """Who it is, for the log."""

    def require(self, scope: str, channel: str | None = None) -> None:
        """Raises NotAuthorised unless the scope is granted, for that channel if it is about one."""
        if scope not in self.scopes:
            raise NotAuthorised(f"the token does not allow to {scope}; ask for one with the scope {scope!r}")
        if scope in ("speak", "listen") and self.channel not in (None, channel):
            raise NotAuthorised(f"the token is for the channel {self.channel!r} only")


EVERYTHING = Grant(frozenset(SCOPES))
"""What everybody may do where no tokens are asked for."""


def mint(secret: bytes, grant: Grant, ttl_s: float, now: float) -> str:
    """A token for `ttl_s` seconds from `now` (seconds since 1970).

    Raises InputError for a secret, scope or time that is none.
    """
    _check_secret(secret, "the secret")
    if unknown := sorted(grant.scopes - set(SCOPES)):
        raise InputError(f"no scope called {unknown[0][:40]!r}; there are: {', '.join(SCOPES)}")
    if not grant.scopes:
        raise InputError(f"a token without a scope allows nothing; there are: {', '.join(SCOPES)}")
    if not 0 < ttl_s < math.inf:
        raise InputError(f"a token cannot be good for {ttl_s:g} seconds")
    claims: dict[str, Any] = {"scope": " ".join(sorted(grant.scopes)), "exp": math.ceil(now + ttl_s)}
    claims |= {"channel": grant.channel} if grant.channel is not None else {}
    claims |= {"sub": grant.subject} if grant.subject else {}
    _grant(claims)
    return jwt.encode(claims, secret, ALGORITHM)


def check(token: str, secrets: Sequence[bytes], now: float) -> Grant:
    """What a token grants at `now` (seconds since 1970); it may be signed with any of the secrets.

    Raises NotAuthorised and nothing else.
    """
    if not token:
        raise NotAuthorised("a token is needed here")
    if len(token) > LONGEST_TOKEN or not token.isascii():
        raise NotAuthorised("this is no token")
    claims = _claims(token, secrets)
    if _time(claims, "exp", now) <= now - LEEWAY_S:
        raise NotAuthorised("the token has expired; ask for a new one", expired=True)
    if _time(claims, "nbf", now) > now + LEEWAY_S:
        raise NotAuthorised("the token is not good yet")
    try:
        return _grant(claims)
    except InputError as e:
        raise NotAuthorised(str(e)) from None


def _claims(token: str, secrets: Sequence[bytes]) -> dict[str, Any]:
    """Raises NotAuthorised. What went wrong with whose secret is nobody's business."""
    for secret in secrets:
        try:
            return jwt.decode(token, secret, algorithms=[ALGORITHM], options=CHECKED)
        except jwt.InvalidSignatureError:
            continue
        except jwt.MissingRequiredClaimError:
            raise NotAuthorised("the token never expires; it needs the claim `exp`") from None
        except (jwt.PyJWTError, ValueError, TypeError, RecursionError):
            raise NotAuthorised("this is no token") from None
    raise NotAuthorised("the token was not signed with this server's secret")


def _time(claims: Mapping[str, Any], name: str, default: float) -> float:
    value = claims.get(name, default)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < 1e12:
        raise NotAuthorised(f"the token's claim `{name}` is no time")
    return value


def _grant(claims: Mapping[str, Any]) -> Grant:
    """Scopes that are not ours are somebody else's and skipped. Raises InputError."""
    scope, channel, subject = claims.get("scope"), claims.get("channel"), claims.get("sub", "")
    scopes = frozenset(scope.split()) & set(SCOPES) if isinstance(scope, str) else frozenset()
    if not scopes:
        raise InputError(f"the token has no scope of ours: {', '.join(SCOPES)}")
    if "channel" in claims and not (isinstance(channel, str) and 0 < len(channel) <= LONGEST_NAME):
        raise InputError(f"the token's channel is no name of at most {LONGEST_NAME} characters")
    if not isinstance(subject, str) or len(subject) > LONGEST_SUBJECT:
        raise InputError(f"the token's subject is no name of at most {LONGEST_SUBJECT} characters")
    return Grant(scopes, channel, subject)


def new_secret() -> str:
    """A fresh secret, safe in files and environments: 64 characters with 384 bits of chance."""
    return chance.token_urlsafe(48)


def read_secrets(file: Path | None, environment: Mapping[str, str]) -> tuple[bytes, ...]:
    """The secrets of a file, one a line, else of FAPSTREAM_SECRET, with white space between; () if neither.

    The first signs, all are good. Raises InputError for a short one or a file without any, OSError.
    """
    if file is not None:
        try:
            words = file.read_text("utf-8").split()
        except UnicodeDecodeError:
            raise InputError(f"{file} is no text; it should hold one secret a line") from None
        if not words:
            raise InputError(f"{file} holds no secret; `fapstream token --new-secret` makes one")
    else:
        words = environment.get(SECRET_VARIABLE, "").split()
    found = tuple(word.encode("utf-8", "surrogateescape") for word in words)
    for number, secret in enumerate(found, 1):
        _check_secret(secret, f"secret {number} of {file or SECRET_VARIABLE}")
    return found


def _check_secret(secret: bytes, what: str) -> None:
    if len(secret) < LEAST_SECRET_BYTES:
        raise InputError(
            f"{what} has {len(secret)} bytes; at least {LEAST_SECRET_BYTES} are needed "
            "(`fapstream token --new-secret` makes one)"
        )
