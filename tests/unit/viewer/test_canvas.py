"""Pictures without a window, of squares of which every pixel is known, and of the packaged head."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.head.mesh import Material
from fapstream.viewer.camera import View
from fapstream.viewer.canvas import Studio
from tests.unit.head.packaged import packaged
from tests.unit.viewer.heads import face, square, squares

WHITE = Material("white", roughness=1.0)


def test_a_square_is_where_the_camera_says() -> None:
    """0.2 m of 0.4 m: the middle half of the picture; half covered pixels are half transparent."""
    studio = Studio(squares(square("shirt", 0.0, 0.1, WHITE)), (64, 64))
    alpha = studio.picture(face(), backdrop=False)[..., 3]
    inside = np.zeros((64, 64), bool)
    inside[16:48, 16:48] = True
    assert (alpha[inside] == 255).all()
    assert (alpha[~inside] == 0).all()
    studio.close()


def test_faps_move_it_and_the_first_row_is_the_top() -> None:
    studio = Studio(squares(square("shirt", 0.0, 0.1, WHITE)), (64, 64))
    up = studio.picture(face(f5=50), backdrop=False)[..., 3]
    assert up[8:40, 32].min() == 255
    assert up[:8].max() == up[40:].max() == 0
    back = studio.picture(face(), backdrop=False)[..., 3]
    assert back[16:48, 32].min() == 255
    studio.close()


def test_edges_are_smooth_where_asked_for() -> None:
    head = squares(square("shirt", 0.0, 0.1005, WHITE))
    for samples, levels in ((0, False), (4, True)):
        studio = Studio(head, (64, 64), samples)
        alpha = studio.picture(face(), View(yaw=20, pitch=10), backdrop=False)[..., 3]
        assert bool(((alpha > 0) & (alpha < 255)).any()) is levels
        studio.close()


def test_what_is_nearer_hides_and_transparent_parts_blend() -> None:
    red = Material("red", color=(1.0, 0.0, 0.0, 1.0), roughness=1.0)
    veil = Material("veil", color=(0.0, 0.0, 1.0, 0.5), roughness=1.0, alpha="BLEND")
    near, far = square("shirt", 0.0, 0.1, red), square("collar", -0.1, 0.15, WHITE)
    studio = Studio(squares(far, near), (64, 64))
    r, g, b, _ = studio.picture(face())[32, 32]
    assert r > g + 60
    assert r > b + 60
    veiled = Studio(squares(far, near, square("cornea_l", 0.05, 0.1, veil)), (64, 64))
    r2, _, b2, a2 = veiled.picture(face())[32, 32]
    assert r2 < r
    assert b2 > b
    assert a2 == 255
    for each in (studio, veiled):
        each.close()


def test_the_backdrop_fills_what_the_head_leaves_free() -> None:
    studio = Studio(packaged(), (96, 64))
    picture = studio.picture(face())
    assert picture.shape == (64, 96, 4)
    assert (picture[..., 3] == 255).all()
    corner, hair = picture[2, 2, :3].astype(int), picture[10, 48, :3].astype(int)
    assert corner.min() > 120
    assert hair.sum() < corner.sum() - 150
    studio.close()


def test_the_same_face_gives_the_same_picture_whatever_was_shown_before() -> None:
    studio = Studio(packaged(), (64, 64))
    first = studio.picture(face(f3=300, f5=-200))
    other = studio.picture(face(f48=9000, f19=900))
    again = studio.picture(face(f3=300, f5=-200))
    assert not np.array_equal(first, other)
    assert np.array_equal(first, again)
    studio.close()


@pytest.mark.parametrize(("view", "axis"), [(View(yaw=30), 1), (View(pitch=-30), 0)])
def test_the_camera_goes_to_the_subjects_left_and_up(view: View, axis: int) -> None:
    """What stands before the target then is seen further to the left; from below, further up."""
    studio = Studio(squares(square("shirt", 0.1, 0.03, WHITE)), (64, 64))
    alpha = studio.picture(face(), view, backdrop=False)[..., 3]
    assert np.nonzero(alpha)[axis].mean() < 27
    studio.close()
