"""Pictures a second of the viewer at 512x512: a head that speaks and lives, beside the same scene, materials,
lights and textures drawn without any deformation; in turns, in one run. Set OPENBLAS_NUM_THREADS=1.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

from fapstream.head.gltf import read_head
from fapstream.viewer.canvas import SAMPLES, Canvas
from fapstream.viewer.graphics import is_software, open_context
from fapstream.viewer.renderer import Renderer
from tests.benchmarks.bench_render import HEADS, spoken_frames

WARM_UP = 3


def measure(path: Path, size: int, pictures: int) -> dict[str, Any]:
    """Pictures a second of both sides (medians, in turns) and their ratio, as in a window of this size."""
    head = read_head(path.read_bytes(), str(path))
    context = open_context()
    software = is_software(context)
    renderer = Renderer(context, head, thrifty=software)
    canvas = Canvas(context, (size, size), 0 if software else SAMPLES)
    faces = np.array(spoken_frames())[:, 1:]
    took: dict[bool, list[float]] = {True: [], False: []}
    for k in range(2 * (pictures + WARM_UP)):
        deforming = k % 2 == 0
        start = time.perf_counter()
        if deforming:
            renderer.deform(faces[k // 2 % len(faces)])
        renderer.draw(canvas.framebuffer)
        context.finish()
        took[deforming].append(time.perf_counter() - start)
    moving, still = (float(np.median(took[side][WARM_UP:])) for side in (True, False))
    return {
        "fps_deforming": round(1 / moving, 1),
        "fps_static": round(1 / still, 1),
        "ratio": round(still / moving, 3),
        "deform_ms": round(1000 * (moving - still), 2),
        "renderer": context.info["GL_RENDERER"],
    }


def main() -> None:
    """Print the table, or one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--pictures", type=int, default=200)
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--head", type=Path, default=HEADS / "generic.glb")
    args = parser.parse_args()
    figures = measure(args.head, args.size, args.pictures)
    if args.json:
        print(json.dumps(figures))
        return
    for name, value in figures.items():
        print(f"{name.replace('_', ' '):<16}{value:>14}")


if __name__ == "__main__":
    main()
