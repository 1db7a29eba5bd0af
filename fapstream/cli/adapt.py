"""Make a head of one's own from a front photo and, better, a profile photo as well.

Feature points are found in the photos where the landmarks extra is installed; or they come from a file, which
the editor writes (fapstream serve, then /adapt in a browser).
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fapstream.adapters.files import read_file
from fapstream.cli.heads import packaged
from fapstream.cli.progress import Progress
from fapstream.errors import FapstreamError, InputError
from fapstream.fap import visemes
from fapstream.head.gltf import read_head
from fapstream.head.gltf_write import write_head
from fapstream.head.mesh import Head
from fapstream.viewer.camera import View
from fapstream.viewer.canvas import Studio

if TYPE_CHECKING:
    from fapstream.adapt import Fit, PhotoPoints

HELP = "make a head from photos of a person"
METHODS = ("best", "fpd", "rbf", "diffeo", "rigid")
NEEDED = "adapting a head needs Pillow and SciPy: pip install 'fapstream[adapt]'"
SIDES = {"from in front": 0, "left": 45, "left profile": 90, "right": -45, "right profile": -90}
VIEW_SIZE = (640, 640)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """FRONT [PROFILE] [--points F.json] [--method M] --out F.glb [--report F.html] [--name NAME]"""
    parser.add_argument("front", type=Path, metavar="FRONT", help="photo from in front, mouth closed")
    parser.add_argument("profile", type=Path, nargs="?", metavar="PROFILE", help="photo from either side")
    parser.add_argument(
        "--points", type=Path, metavar="F.json", help="feature points of the photos; else they are looked for"
    )
    parser.add_argument(
        "--save-points", type=Path, metavar="F.json", help="write the feature points that were used"
    )
    parser.add_argument(
        "--method", choices=METHODS, default=METHODS[0],
        help="the most probable face, facial parts, radial functions, a diffeomorphism, or rotation and size"
        " alone (default %(default)s)",
    )  # fmt: skip
    parser.add_argument("--name", help="what the head is called (default: after the file)")
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="F.glb")
    parser.add_argument("--report", type=Path, metavar="F.html", help="write how well it fits, with pictures")


def run(args: argparse.Namespace) -> int:
    """Raises OSError, InputError, PhotoError, PointsError."""
    try:
        import fapstream.adapt as adapt
    except ModuleNotFoundError as e:
        if (e.name or "").partition(".")[0] in ("PIL", "scipy"):
            raise InputError(NEEDED) from None
        raise
    generic = read_head(packaged("generic").read_bytes(), "generic")
    files = {"front": args.front, "profile": args.profile}
    pictures = {
        view: adapt.read_photo(read_file(path, adapt.MAX_PHOTO_BYTES), str(path))
        for view, path in files.items()
        if path is not None
    }
    photos = _points(args.points, pictures)
    if args.save_points:
        args.save_points.write_text(adapt.format_points(photos), encoding="utf-8")
    fit = adapt.fit_points(generic, photos, args.method)
    head = adapt.make_head(generic, fit, pictures, args.name or args.out.stem, Progress("steps"))
    data = write_head(head)
    args.out.write_bytes(data)
    off = ", ".join(f"{view} {fit.located.mean_error(view):.1f} px" for view in fit.located.sights)
    print(f"{args.out}: {head.name}, {len(data)} bytes; points off by {off} in the mean")
    if args.report:
        _report(args.report, generic, head, fit, pictures)
    return 0


def _points(path: Path | None, pictures: dict[str, Any]) -> PhotoPoints:
    """From the file, or from the photos themselves."""
    import fapstream.adapt as adapt

    if path is not None:
        text = read_file(path, adapt.MAX_POINTS_BYTES).decode("utf-8", "replace")
        return adapt.of_pictures(adapt.read_points(text, str(path)), pictures)
    from fapstream.adapters.landmarks import Landmarker

    finder = Landmarker()
    front = finder.front(pictures["front"])
    if "profile" not in pictures:
        return adapt.PhotoPoints(front)
    profile, facing = finder.profile(pictures["profile"])
    return adapt.PhotoPoints(front, profile, facing)


def _report(path: Path, generic: Head, head: Head, fit: Fit, pictures: dict[str, Any]) -> None:
    from fapstream.adapt.report import report

    views: dict[str, Any] = {}
    try:
        views = _views(head)
    except FapstreamError as e:
        print(f"fapstream: the report goes without views of the head: {e}", file=sys.stderr)
    path.write_text(report(generic, head, fit, pictures, views), encoding="utf-8")
    print(f"{path}: how well it fits")


def _views(head: Head) -> dict[str, Any]:
    """Pictures of the head from five sides, and talking. Raises FapstreamError where nothing can be drawn."""
    studio = Studio(head, VIEW_SIZE)
    rest, wide = visemes()[0], visemes()[10]
    shots = [(side, rest, View(yaw=yaw)) for side, yaw in SIDES.items()] + [("talking", wide, View(yaw=15))]
    pictures = {what: studio.picture(face, view)[..., :3].copy() for what, face, view in shots}
    studio.close()
    return pictures
