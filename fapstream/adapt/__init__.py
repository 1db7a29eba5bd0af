"""A head of one's own: the generic head fitted to photos of a person, part by part.

Points in photos (`points`) become points in space (`refine`, from the paper's two views in `views`); a
method (`fit`) makes of them a warp; the head is carried through it (`carry`); the photos become its skin
(`texture`). `person` goes the whole way.
"""

from fapstream.adapt.fit import METHODS
from fapstream.adapt.person import DEFAULT_METHOD, Fit, fit_points, make_head, of_pictures, of_size
from fapstream.adapt.photos import MAX_BYTES as MAX_PHOTO_BYTES
from fapstream.adapt.photos import read_photo
from fapstream.adapt.points import MAX_FILE as MAX_POINTS_BYTES
from fapstream.adapt.points import (
    Marks,
    PhotoPoints,
    facing_of,
    feature_points,
    format_points,
    generic_places,
    read_points,
)

__all__ = [
    "DEFAULT_METHOD",
    "MAX_PHOTO_BYTES",
    "MAX_POINTS_BYTES",
    "METHODS",
    "Fit",
    "Marks",
    "PhotoPoints",
    "facing_of",
    "feature_points",
    "fit_points",
    "format_points",
    "generic_places",
    "make_head",
    "of_pictures",
    "of_size",
    "read_photo",
    "read_points",
]
