"""The web client and the viewer draw the same faces: real Chromium against EGL, picture by picture."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image as Picture
from playwright.async_api import Browser, Page

from fapstream.fap.tables import expressions, visemes
from fapstream.head.deformer import head_turn
from fapstream.head.gltf import read_head
from fapstream.head.gltf_write import write_head
from fapstream.head.mesh import Head, Material, Part
from fapstream.server import packaged_heads
from fapstream.viewer.camera import lens
from fapstream.viewer.canvas import Studio
from fapstream.viewer.look import load_look
from tests.benchmarks.server import server

SIZE = 512
LEAST_OVERLAP = 0.98
MOST_GAP_PX = 1
MOST_DIFFERENCE = 5.0
INSIDE = ("teeth", "tongue", "mouth", "gum")

PAGE = """<!doctype html><meta charset="utf-8"><title>both</title><link rel="icon" href="data:,">
<body style="margin:0"><script type="module" src="http://{server}/fap-head.js"></script>
<fap-head id="head" capture antialias="on" head="{head}" style="width:512px;height:512px"></fap-head>
"""
READY = """
(name) => {
  const { presenter, shadowRoot } = document.querySelector("#head");
  return shadowRoot?.querySelector("canvas.ready") && presenter?.stage?.head?.name === name;
}
"""
DRAW = """
(values) => {
  const { presenter, shadowRoot } = document.querySelector("#head");
  presenter.frame = () => {};
  // in software GL the shadow of this face comes with one of four pictures
  for (let k = 0; k < 4; k++) presenter.stage.draw(Float32Array.from(values));
  return shadowRoot.querySelector("canvas").toDataURL("image/png");
}
"""


def faces() -> dict[str, NDArray[np.float64]]:
    """FAPs (68,) by name."""
    found = {"neutral": np.zeros(68), "smile": expressions()["joy"].copy()}
    found |= {f"viseme {k}": visemes()[k].copy() for k in (1, 10, 14)}
    found["jaw open"] = of({3: 600, 5: -500, 10: -430, 11: -430, 52: -480, 57: -350, 58: -350})
    found["turned"] = of({48: 10_000, 49: 35_000, 50: -6_000, 3: 300, 5: -280, 10: -240, 11: -240, 52: -270})
    return {name: np.rint(face) for name, face in found.items()}


def of(faps: dict[int, float]) -> NDArray[np.float64]:
    face = np.zeros(68)
    for fap, value in faps.items():
        face[fap - 1] = value
    return face


def coded(head: Head) -> Head:
    """The same head, green, with a red inside of the mouth: lips and gap can be told by colour."""

    def painted(part: Part) -> Part:
        inside = part.name.startswith(INSIDE)
        color = (1.0, 0.0, 0.0, 1.0) if inside else (0.0, 1.0, 0.0, 1.0)
        return replace(part, material=Material("red" if inside else "green", color, roughness=1.0))

    solid = [part for part in head.parts if part.material.alpha != "BLEND"]
    names = {part.name for part in solid}
    return replace(
        head,
        name="coded",
        parts=tuple(painted(part) for part in solid),
        fat=tuple(entry for entry in head.fat if entry.part in names),
        turns=tuple(
            replace(
                turn,
                parts=None if turn.parts is None else tuple(n for n in turn.parts if n in names),
                weights={n: w for n, w in turn.weights.items() if n in names},
            )
            for turn in head.turns
        ),
    )


@pytest.fixture(scope="module")
def heads(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, dict[str, Head]]]:
    """A server with the packaged heads and the coded one, and the heads."""
    found = {name: read_head(file.read_bytes(), name) for name, file in packaged_heads().items()}
    path = tmp_path_factory.mktemp("heads") / "coded.glb"
    path.write_bytes(write_head(coded(found["generic"])))
    found["coded"] = read_head(path.read_bytes(), "coded")
    with server("--head", str(path)) as (address, _):
        yield address, found


async def drawn_by_both(
    page: Page, elsewhere: tuple[Path, str], address: str, key: str, head: Head
) -> list[tuple[NDArray, NDArray]]:
    """Every face as the web client and as the viewer draws it: uint8 (512, 512, 4)."""
    folder, origin = elsewhere
    (folder / "page.html").write_text(PAGE.format(server=address, head=key), encoding="utf-8")
    await page.goto(f"{origin}/page.html")
    await page.wait_for_function(READY, arg=head.name)
    studio, found = Studio(head, (SIZE, SIZE)), []
    for face in faces().values():
        url = await page.evaluate(DRAW, [0.0, *face.tolist()])
        picture = Picture.open(io.BytesIO(base64.b64decode(url.partition(",")[2])))
        found.append((np.asarray(picture.convert("RGBA")), studio.picture(face, backdrop=False)))
    studio.close()
    return found


def overlap(one: NDArray[np.bool_], two: NDArray[np.bool_]) -> float:
    """Intersection over union."""
    return float((one & two).sum() / (one | two).sum())


def gap_height(picture: NDArray[np.uint8], column: int) -> int:
    """Rows in which the mouth's inside is seen at its middle; the median of five columns."""
    rgb = picture[:, column - 2 : column + 3, :3].astype(int)
    red = (rgb[..., 0] > rgb[..., 1] + 8) & (picture[:, column - 2 : column + 3, 3] > 127)
    return int(np.median(red.sum(axis=0)))


def middle_column(head: Head, face: NDArray[np.float64]) -> int:
    """Where the middle of the lips is seen: the mouth's centre, turned with the head."""
    camera = lens(head.camera, load_look().fov, 1.0)
    clip = camera.projection @ camera.view @ head_turn(head, face) @ np.array([*head.mouth.center, 1.0])
    return round((clip[0] / clip[3] + 1) / 2 * SIZE)


async def test_both_clients_draw_the_same_faces(
    browser: Browser, elsewhere: tuple[Path, str], heads: tuple[str, dict[str, Head]], tmp_path: Path
) -> None:
    """Silhouettes (IoU 0.98) and colours agree for all heads, mouths open by the same height (1 px)."""
    address, found = heads
    page = await browser.new_page(viewport={"width": SIZE, "height": SIZE})
    drawn = {key: await drawn_by_both(page, elsewhere, address, key, head) for key, head in found.items()}
    sheet(drawn, tmp_path / "both.png")
    for key, pairs in drawn.items():
        shared = [overlap(web[..., 3] > 127, here[..., 3] > 127) for web, here in pairs]
        colours = [difference(web, here) for web, here in pairs]
        print(f"{key:<8} IoU at least {min(shared):.4f}, mean colour difference at most {max(colours):.2f}")
        assert min(shared) >= LEAST_OVERLAP, key
        assert max(colours) < MOST_DIFFERENCE, key
    opened = 0
    for (name, face), pair in zip(faces().items(), drawn["coded"], strict=True):
        column = middle_column(found["coded"], face)
        gaps = [gap_height(picture, column) for picture in pair]
        opened = max(opened, *gaps)
        print(f"{name:<10} openings {gaps} px")
        assert abs(gaps[0] - gaps[1]) <= MOST_GAP_PX, name
    assert opened > 12, "no mouth was open"


def difference(web: NDArray[np.uint8], here: NDArray[np.uint8]) -> float:
    """Mean over colours and pixels that both cover, in levels of 255."""
    both = (web[..., 3] > 250) & (here[..., 3] > 250)
    return float(np.abs(web[both].astype(int) - here[both]).mean())


def sheet(drawn: dict[str, list[tuple[NDArray, NDArray]]], path: Path) -> None:
    """Both clients' pictures above each other, for people."""
    rows = [np.hstack([pair[i] for pair in pairs]) for pairs in drawn.values() for i in (0, 1)]
    Picture.fromarray(np.vstack(rows)).convert("RGB").reduce(4).save(path)
    print(f"see {path}")
