"""The few files that can be fetched, and that nothing else can."""

from __future__ import annotations

import gzip
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import InputError
from fapstream.server import http
from fapstream.server.http import Answer, Site


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
    [("/", "text/html; charset=utf-8"), ("/index.html", "text/html; charset=utf-8"),
     ("/fap-head.js", "text/javascript; charset=utf-8"),
     ("/fap-worklet.js", "text/javascript; charset=utf-8"),
     ("/heads/mine.glb", "model/gltf-binary"), ("/heads/generic.glb", "model/gltf-binary")],
)  # fmt: skip
def test_what_there_is(site: Site, path: str, kind: str) -> None:
    answer = site.answer(path)
    assert answer.status == 200
    assert header(answer, "Content-Type") == kind
    assert header(answer, "Access-Control-Allow-Origin") == "*"
    assert header(answer, "Cross-Origin-Resource-Policy") == "cross-origin"
    assert header(answer, "X-Content-Type-Options") == "nosniff"
    assert header(answer, "Content-Encoding") is None


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
        "/" + "a" * 9000,
    ],
)
def test_nothing_else_can_be_fetched(site: Site, path: str) -> None:
    answer = site.answer(path)
    assert answer.status == 404
    assert answer.body == b"Not found\n"
    assert ("Access-Control-Allow-Origin", "*") in answer.headers


@given(st.text(st.sampled_from("abhedsx./\\%2ef\0\n~ :"), max_size=30))
def test_no_path_whatever_reads_anything_but_what_is_listed(path: str) -> None:
    answer = Site({}).answer("/" + path)
    assert answer.status == 404 or ("/" + path).partition("?")[0] in {"/"}


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
