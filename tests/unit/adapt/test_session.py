"""The session of the editor page, as protocol/ADAPT.md has it."""

from __future__ import annotations

import io
from itertools import count

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image as Picture

from fapstream.adapt.points import Facing, Marks, feature_points, read_points
from fapstream.adapt.session import Message, Session, wireframe
from fapstream.errors import PhotoError
from fapstream.head.gltf import read_head
from fapstream.protocol import adapting
from tests.unit.adapt.painted import PERSON, photographed, plain
from tests.unit.adapt.persons import known
from tests.unit.head.packaged import packaged


class Finder:
    """Finds the person's own points, or nothing in a black picture."""

    def front(self, picture: np.ndarray) -> Marks:
        if not picture.any():
            raise PhotoError("front: there is no face.")
        return Marks((500, 500), {"9.3": (250.0, 260.0)}, {"9.3": 0.5})

    def profile(self, picture: np.ndarray) -> tuple[Marks, Facing]:
        return Marks((500, 500), {"9.3": (20.0, 260.0)}), "left"


def session(finder: Finder | None = None) -> Session:
    ticks = count()
    return Session(packaged(), finder, lambda: next(ticks) / 100)


def jpeg(pixels: np.ndarray) -> bytes:
    out = io.BytesIO()
    Picture.fromarray(pixels).save(out, "JPEG", quality=95)
    return out.getvalue()


def points_of(view: str) -> dict[str, list[float]]:
    marks = getattr(known(PERSON), view)
    return {name: [x / 2, y / 2] for name, (x, y) in marks.points.items()}


def with_photos(finder: Finder | None = None, views: tuple[str, ...] = ("front", "profile")) -> Session:
    made = session(finder)
    for view in views:
        data = jpeg(photographed(plain)[view].pixels)
        assert made.answer({"type": "photo", "view": view, "data": data})["type"] == "photo"
    return made


def sent(message: Message) -> Message:
    """As the other side gets it."""
    return adapting.decode(adapting.encode(message))


def test_ready_says_what_there_is() -> None:
    message = sent(session().ready())
    assert [p["name"] for p in message["points"]] == list(feature_points())
    assert message["automatic"] is False
    assert message["methods"][0] == "best"
    points, edges = wireframe(packaged())
    assert np.array_equal(np.frombuffer(message["edges"], "<u2").reshape(-1, 2), edges)
    assert len(points) < 65536
    assert edges.max() == len(points) - 1
    assert session(Finder()).ready()["automatic"] is True


def test_a_photo_comes_back_upright_with_what_was_found() -> None:
    data = jpeg(photographed(plain)["front"].pixels)
    answer = sent(session(Finder()).answer({"type": "photo", "view": "front", "data": data}))
    assert (answer["width"], answer["height"]) == (500, 500)
    assert Picture.open(io.BytesIO(answer["picture"])).size == (500, 500)
    assert answer["points"] == {"9.3": [250, 260, 0.5]}
    assert "note" not in answer
    profile = sent(session(Finder()).answer({"type": "photo", "view": "profile", "data": data}))
    assert profile["facing"] == "left"
    black = jpeg(np.zeros((300, 300, 3), np.uint8))
    nothing = sent(session(Finder()).answer({"type": "photo", "view": "front", "data": black}))
    assert nothing["points"] == {}
    assert "no face" in nothing["note"]
    assert "by hand" in nothing["note"]


def test_points_are_fitted_and_seen_in_both_photos() -> None:
    made = with_photos()
    message = {"type": "points", "seq": 7, "front": points_of("front"), "profile": points_of("profile")}
    answer = sent(made.answer(message))
    assert (answer["type"], answer["seq"], answer["fitted"]) == ("fit", 7, True)
    assert answer["error_px"] < 1
    assert answer["ms"] > 0
    n = len(wireframe(packaged())[0])
    for view in ("front", "profile"):
        mesh = np.frombuffer(answer[view]["mesh"], "<f4").reshape(-1, 2)
        assert mesh.shape == (n, 2)
        assert ((mesh > -100) & (mesh < 600)).mean() > 0.95
        for name, at in message[view].items():  # type: ignore[attr-defined]
            assert np.hypot(*np.subtract(answer[view]["points"][name], at)) < 4, name
        missing = {n for n, p in feature_points().items() if view in p.views} - set(answer[view]["points"])
        assert not missing, "predicted as well"
    assert answer["profile"]["facing"] == known(PERSON).facing


def test_a_few_points_lay_the_generic_head_over_the_photo() -> None:
    made = with_photos(views=("front",))
    nothing = sent(made.answer({"type": "points", "seq": 1, "front": {}}))
    assert nothing["fitted"] is False
    assert "error_px" not in nothing
    assert "profile" not in nothing
    middle = np.frombuffer(nothing["front"]["mesh"], "<f4").reshape(-1, 2).mean(0)
    assert np.abs(middle - 250).max() < 60
    some = {name: points_of("front")[name] for name in ("3.5", "3.6", "2.1")}
    three = sent(made.answer({"type": "points", "seq": 2, "front": some}))
    assert three["fitted"] is False
    for name, at in some.items():
        assert np.hypot(*np.subtract(three["front"]["points"][name], at)) < 25
    one = sent(made.answer({"type": "points", "seq": 3, "front": {"9.3": [100, 120]}}))
    assert one["front"]["points"]["9.3"] == pytest.approx([100, 120], abs=0.01)


def test_a_profile_without_points_yet_is_laid_over() -> None:
    made = with_photos()
    answer = sent(made.answer({"type": "points", "seq": 1, "front": points_of("front"), "profile": {}}))
    assert answer["fitted"] is True
    assert len(np.frombuffer(answer["profile"]["mesh"], "<f4")) == 2 * len(wireframe(packaged())[0])


def test_a_head_is_made_and_its_points_are_a_file() -> None:
    made = with_photos()
    message = {
        "type": "head",
        "seq": 9,
        "name": "Me",
        "front": points_of("front"),
        "profile": points_of("profile"),
    }
    answer = sent(made.answer(message))
    head = read_head(answer["head"], "answer")
    assert head.name == "Me"
    assert head.part("skin").material.texture != packaged().part("skin").material.texture
    saved = read_points(answer["points"])
    assert saved.front.size == (500, 500)
    assert set(saved.front.points) == set(message["front"])  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("message", "code"),
    [
        ({"type": "what"}, "bad_input"),
        ({"type": "photo"}, "bad_input"),
        ({"type": "photo", "view": "above", "data": b""}, "bad_input"),
        ({"type": "photo", "view": "front", "data": b"no"}, "bad_photo"),
        ({"type": "points", "front": {}}, "bad_input"),
        ({"type": "points", "seq": 1, "front": {"9.99": [1, 2]}}, "bad_points"),
        ({"type": "points", "seq": 1, "front": {"9.3": [1e9, 2]}}, "bad_points"),
        ({"type": "points", "seq": 1, "front": 5}, "bad_points"),
        ({"type": "points", "seq": 1, "front": {}, "method": "magic"}, "bad_input"),
        ({"type": "points", "seq": 1, "front": {}, "method": [1]}, "bad_input"),
        ({"type": "head", "seq": 1, "front": {}}, "bad_points"),
        ({"type": "head", "seq": 1, "front": {}, "name": "x" * 81}, "bad_input"),
        ({"type": "head", "seq": 1, "front": {}, "name": 5}, "bad_input"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_answered_and_changes_nothing(message: Message, code: str) -> None:
    made = with_photos()
    answer = sent(made.answer(message))
    assert (answer["type"], answer["code"]) == ("error", code)
    assert answer.get("seq") == message.get("seq")
    assert "fatal" not in answer
    good = made.answer(
        {"type": "points", "seq": 2, "front": points_of("front"), "profile": points_of("profile")}
    )
    assert good["fitted"] is True


def test_without_a_front_photo_there_is_nothing_to_fit() -> None:
    assert session().answer({"type": "points", "seq": 1, "front": {}})["code"] == "bad_input"
    profile = with_photos(views=("profile",))
    assert "front" in profile.answer({"type": "points", "seq": 1, "front": {}})["message"]


ANY = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**60), 2**60)
    | st.floats()
    | st.text(max_size=9)
    | st.binary(max_size=9),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
)


@settings(deadline=None, max_examples=60)
@given(st.dictionaries(st.sampled_from(["seq", "view", "data", "front", "profile", "method", "name"]), ANY),
       st.sampled_from(["photo", "points", "head", "x"]))  # fmt: skip
def test_no_message_raises(fields: Message, kind: str) -> None:
    made = session()
    made._photos["front"] = with_photos_once()._photos["front"]
    answer = made.answer({"type": kind, **fields})
    assert answer["type"] in ("error", "fit", "photo", "head")
    adapting.encode(answer)


def with_photos_once(made: list[Session] = []) -> Session:  # noqa: B006 - made once on purpose
    if not made:
        made.append(with_photos(views=("front",)))
    return made[0]
