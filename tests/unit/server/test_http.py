"""The few files that can be fetched, and that nothing else can."""

from __future__ import annotations

import gzip
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import InputError
from fapstream.server import http
from fapstream.server.http import Answer, Site, plain


@pytest.fixture(scope="module")
def heads(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("heads")
    (folder / "mine.glb").write_bytes(b"glTF" + b"\0" * 4000)
    (folder / "secret.txt").write_bytes(b"secret")
    return {"mine": folder / "mine.glb"}


@pytest.fixture(scope="module")
def site(heads: dict[str, Path]) -> Site:
    return Site(heads)


def header(answer: Answer, name: str) -> str | None:
    found = [value for key, value in answer.headers if key.lower() == name.lower()]
    assert len(found) <= 1
    return found[0] if found else None


@pytest.mark.parametrize(
    ("path", "kind"),
    [("/fap-head.js", "text/javascript; charset=utf-8"),
     ("/fap-worklet.js", "text/javascript; charset=utf-8"),
     ("/demo.css", "text/css; charset=utf-8"), ("/favicon.svg", "image/svg+xml"),
     ("/heads/mine.glb", "model/gltf-binary"), ("/heads/generic.glb", "model/gltf-binary")],
)  # fmt: skip
def test_what_pages_anywhere_may_embed(site: Site, path: str, kind: str) -> None:
    answer = site.answer(path)
    assert answer.status == 200
    assert header(answer, "Content-Type") == kind
    assert header(answer, "Access-Control-Allow-Origin") == "*"
    assert header(answer, "Cross-Origin-Resource-Policy") == "cross-origin"
    assert header(answer, "Content-Encoding") is None
    assert header(answer, "Content-Security-Policy") == "default-src 'none'; frame-ancestors 'none'"


@pytest.mark.parametrize("path", ["/", "/index.html", "/adapt", "/adapt.html"])
def test_pages(site: Site, path: str) -> None:
    answer = site.answer(path)
    assert answer.status == 200
    assert header(answer, "Content-Type") == "text/html; charset=utf-8"
    assert header(answer, "Access-Control-Allow-Origin") is None
    assert header(answer, "Cross-Origin-Resource-Policy") == "same-origin"
    assert header(answer, "Cross-Origin-Opener-Policy") == "same-origin"
    allowed = header(answer, "Permissions-Policy") or ""
    assert "microphone=(self)" in allowed
    assert "camera=()" in allowed


@pytest.mark.parametrize("path", ["/", "/adapt"])
def test_pages_run_nothing_but_the_scripts_that_are_listed(site: Site, path: str) -> None:
    """The policy allows nothing inline, so the pages must have nothing inline (tests/e2e tries it)."""
    answer = site.answer(path)
    policy = dict(
        rule.split(" ", 1) for rule in (header(answer, "Content-Security-Policy") or "").split("; ")
    )
    assert policy["default-src"] == "'none'"
    assert policy["script-src"] == policy["style-src"] == "'self'"
    assert not any("unsafe" in sources or "*" in sources for sources in policy.values())
    html = answer.body.decode()
    assert not re.search(r"<style|\sstyle=|\son\w+=|javascript:|<script(?![^>]*\ssrc=)|https?:", html)


@pytest.mark.parametrize("path", ["/", "/adapt", "/demo.js", "/heads/generic.glb", "/nothing", "/%00"])
@pytest.mark.parametrize("method", ["GET", "HEAD", "POST"])
@pytest.mark.parametrize("tag", ["", "*"])
def test_every_answer_is_guarded(site: Site, path: str, method: str, tag: str) -> None:
    tag = header(site.answer(path), "ETag") or "" if tag else ""
    answer = site.answer(path, "gzip", tag, method)
    assert header(answer, "X-Content-Type-Options") == "nosniff"
    assert header(answer, "Referrer-Policy") == "no-referrer"
    assert (header(answer, "Content-Security-Policy") or "").startswith("default-src 'none'; ")
    assert header(answer, "Content-Type")
    for name, value in answer.headers:
        assert re.fullmatch(r"[A-Za-z-]+", name)
        assert re.fullmatch(r"[ -~]+", value)


def test_only_get_and_head(site: Site) -> None:
    assert site.answer("/", method="HEAD") == site.answer("/")
    for method in ("POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "get", "", "GET "):
        answer = site.answer("/", method=method)
        assert (answer.status, header(answer, "Allow")) == (405, "GET, HEAD")


def test_a_line_of_text() -> None:
    answer = plain(426, "Nein, Ω\n", ("Upgrade", "websocket"))
    assert (answer.status, answer.body.decode()) == (426, "Nein, Ω\n")
    assert header(answer, "Upgrade") == "websocket"
    assert header(answer, "Cache-Control") == "no-store"


def test_a_query_is_ignored(site: Site, heads: dict[str, Path]) -> None:
    assert site.answer("/heads/mine.glb?v=2&../..").body == heads["mine"].read_bytes()


@pytest.mark.parametrize(
    "path",
    [
        "",
        "//",
        "/..",
        "/../",
        "/../../etc/passwd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "/..%2f..%2fetc%2fpasswd",
        "/heads/../heads/mine.glb",
        "/heads/..%2fmine.glb",
        "/heads/secret.txt",
        "/heads/",
        "/heads",
        "/heads/.glb",
        "/heads/../../http.py",
        "/heads/nobody.glb",
        "/heads/mine.glb/",
        "/heads/mine.glb\n",
        "/heads/mine.glb\0",
        "/http.py",
        "/app.py",
        "/__init__.py",
        "/web",
        "/web/index.html",
        "/./index.html",
        "/index.html/",
        "/INDEX.HTML",
        "/.gitignore",
        "/C:\\windows",
        "/\\..\\..\\x",
        "/etc/passwd",
        "/favicon.svg\u202e",
        "/%66ap-head.js",
        "/fap-head%2ejs",
        "/fap-head.js%00",
        "/fap-head.js%00.css",
        "/fap-head.js;x",
        "/fap-head.js#x",
        "/fap-head.js::$DATA",
        "/fap-head.js.",
        "/fap-head..js",
        "/%c0%ae%c0%ae/etc/passwd",
        "/%252e%252e/etc/passwd",
        "/..;/etc/passwd",
        "/\uff0e\uff0e/etc/passwd",
        "/\uff46ap-head.js",
        "/\u0131ndex.html",
        "http://127.0.0.1/fap-head.js",
        "*",
        "/heads/mine.glb.gz",
        "/heads/m\u0131ne.glb",
        "/heads/default.glb/../mine.glb",
        "/heads\\mine.glb",
        "//heads/mine.glb",
        "/heads//mine.glb",
        "/" + "a" * 9000,
    ],
)
def test_nothing_else_can_be_fetched(site: Site, path: str) -> None:
    answer = site.answer(path)
    assert answer.status == 404
    assert answer.body == b"Not found\n"
    assert ("Access-Control-Allow-Origin", "*") in answer.headers


LISTED = {"/", "/index", "/adapt", *(f"/{name}" for name in http._pages())}
LISTED |= {f"/heads/{name}.glb" for name in ("mine", "default", *http.packaged_heads())}
PIECES = [
    "..", ".", "/", "\\", "%2e", "%2E%2e", "%2f", "%5c", "%00", "\0", "%c0%ae", "%252e", "~", ":", ";", "?",
    "#", "\n", "\u2024", "\uff0f", "\u202e", "heads", "mine", "secret", "default", "generic", ".glb", ".txt",
    ".py", "http", "app", "web", "index", "adapt", ".html", "fap-head", ".js", "etc", "passwd", "C", "a",
]  # fmt: skip


@given(st.lists(st.sampled_from(PIECES) | st.text(max_size=3), max_size=9).map("".join))
def test_no_path_whatever_reads_anything_but_what_is_listed(site: Site, path: str) -> None:
    """What is found was asked for by exactly its name; only the suffix of pages may be left out."""
    answer = site.answer("/" + path)
    assert answer.status == (200 if ("/" + path).partition("?")[0] in LISTED else 404)


@given(st.text(max_size=80))
def test_sources_are_only_those_listed(path: str) -> None:
    with pytest.MonkeyPatch.context() as patch:
        read: list[str] = []
        patch.setattr(http, "_loaded", {})
        patch.setattr(
            http, "_read", lambda source: read.append(source.name) or http.File(b"", b"", "x", '"x"')
        )
        site = Site()
        for prefix in ("/", "/heads/", "/heads/generic.glb", ""):
            site.answer(prefix + path)
            site.answer(prefix + path + ".glb")
    assert set(read) <= {*http._pages(), *(f"{name}.glb" for name in http.packaged_heads())}


def test_gzip_for_who_takes_it(site: Site) -> None:
    plain = site.answer("/fap-head.js")
    packed = site.answer("/fap-head.js", accept_encoding="br, gzip;q=0.8")
    assert header(packed, "Content-Encoding") == "gzip"
    assert header(packed, "Vary") == header(plain, "Vary") == "Accept-Encoding"
    assert gzip.decompress(packed.body) == plain.body
    assert site.answer("/heads/mine.glb", "gzip").body != site.answer("/heads/mine.glb", "identity").body


def test_who_refuses_gzip_gets_none(site: Site) -> None:
    assert header(site.answer("/", accept_encoding="gzip;q=0, identity"), "Content-Encoding") is None


def test_not_modified(site: Site) -> None:
    first = site.answer("/heads/mine.glb")
    tag = header(first, "ETag")
    assert tag
    again = site.answer("/heads/mine.glb", "gzip", tag)
    assert (again.status, again.body) == (304, b"")
    assert header(again, "ETag") == tag
    assert header(again, "Access-Control-Allow-Origin") == "*"
    assert site.answer("/heads/mine.glb", "", f'"other", W/{tag}').status == 304
    assert site.answer("/heads/mine.glb", "", '"other"').status == 200
    assert header(site.answer("/heads/generic.glb"), "ETag") != tag


def test_the_generic_head_is_the_default_unless_there_are_others(site: Site, heads: dict[str, Path]) -> None:
    assert Site().heads[0] == "generic"
    assert Site().answer("/heads/default.glb").body == Site().answer("/heads/generic.glb").body
    assert site.heads[0] == "mine"
    assert "generic" in site.heads
    assert site.answer("/heads/default.glb").body == heads["mine"].read_bytes()


def test_a_head_of_ones_own_may_take_the_place_of_a_packaged_one(heads: dict[str, Path]) -> None:
    own = Site({"generic": heads["mine"]})
    assert own.answer("/heads/generic.glb").body == heads["mine"].read_bytes()
    assert own.heads.count("generic") == 1


@pytest.mark.parametrize("name", ["", "a b", "../x", "-x", "a.b", "é", "a" * 65, "x\n"])
def test_a_name_that_no_address_could_have_is_refused(name: str, heads: dict[str, Path]) -> None:
    with pytest.raises(InputError, match="cannot be called"):
        Site({name: heads["mine"]})


def test_a_file_is_read_once(site: Site, monkeypatch: pytest.MonkeyPatch) -> None:
    site.answer("/")
    monkeypatch.setattr(http, "_read", lambda _: pytest.fail("read again"))
    assert site.answer("/").status == 200
