"""The report."""

from __future__ import annotations

import base64
import io
import re

import numpy as np
from PIL import Image as Picture

from fapstream.adapt.person import make_head
from fapstream.adapt.report import overlay, report
from tests.unit.adapt.painted import fit
from tests.unit.head.packaged import packaged

PHOTO = np.full((1000, 1000, 3), 128, np.uint8)


def test_everything_is_in_one_page() -> None:
    head = make_head(packaged(), fit(), {}, "<b>Me</b>")
    view = np.zeros((40, 40, 3), np.uint8)
    page = report(packaged(), head, fit(), {"front": PHOTO, "profile": PHOTO}, {"from in front": view})
    assert "<b>Me" not in page
    assert "&lt;b&gt;Me" in page
    pictures = re.findall(r'src="data:image/jpeg;base64,([^"]+)"', page)
    assert len(pictures) == 4, "two overlays, one view, the skin"
    for data in pictures:
        Picture.open(io.BytesIO(base64.b64decode(data))).verify()
    assert not re.search(r'(src|href)="(?!data:)', page), "nothing is fetched"
    for name in fit().located.names:
        assert f"<td>{name}</td>" in page
    assert "px mean" in page
    assert "MNS0" in page


def test_the_overlay_shows_points_where_they_were_given() -> None:
    picture = overlay(packaged(), fit(), "front", PHOTO)
    assert picture.shape == (900, 900, 3)
    i = fit().located.names.index("9.3")
    x, y = (fit().located.sights["front"].seen[i] * 0.9).astype(int)
    near = picture[y - 5 : y + 6, x - 5 : x + 6].astype(int)
    assert (near[..., 1] - near[..., 0]).max() > 100, "green"
    assert (picture[:20, :20] == 128).all()
