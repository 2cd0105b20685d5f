"""Packing of a frame into the tracer's flat arrays."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from renderers.tracing import layout
from renderers.tracing.certified import BOUNCES, TOLERANCE
from renderers.tracing.light.embers import embers_of
from renderers.tracing.scene_kernels import TEXTURE, Scene
from renderers.tracing.solids.hierarchy import hierarchy
from renderers.tracing.solids.thin_capsules_kernels import TENT
from renderers.tracing.solids.triangles import LARGE, Packed, boxes_of, corners_of, rows_of, still_mesh
from sceneql import frame as seen
from sceneql.compiled.kernels import address
from sceneql.field.roots.balls import ball_around
from sceneql.field.tape.plans import ray_plan
from sceneql.field.tape.tape_ops import scratch_rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, LightSource, SeenFrame, Tape, View


UNBOUNDED = np.repeat([-np.inf, np.inf], 3)
NO_BALL = (0.0, 0.0, 0.0, np.inf)
FADE = 0.04
"""Default of `layout.FADE`: floors fade close above the horizon."""
SAME = 1e-3
"""Distance [half pixels] below which two ends of thin capsules count as one place."""


def pack(
    frame: SeenFrame, tolerance: float = TOLERANCE, samples: int = 0, certain: bool = False, bounces: int = BOUNCES
) -> tuple[Scene, int]:
    """Scene of a frame, and number of scratch rows that its kernels need.

    ``samples``: if not 0, number of samples on a ray that replace the search for roots of implicit objects.
    ``certain``: whether roots are searched by certified intervals alone. ``bounces``: largest number of successive
    reflections from surface to surface. Raises ValueError for an object that is no frame.Shape.
    """
    tables = Rows(frame.view)
    for index, shape in enumerate(frame.shapes):
        tables.add(index, shape)
    boxes = np.concatenate([np.empty((0, 6)), *tables.boxes])
    bounded = np.isfinite(boxes).all(axis=1)
    inner, endless = np.flatnonzero(bounded), np.flatnonzero(~bounded)
    trees = [packed.tree for packed, _ in tables.still]
    order, nodes, links = hierarchy(boxes[inner], np.array(frame.view.origin, dtype=np.float64), trees)
    nodes = np.concatenate([UNBOUNDED[None, :], nodes])
    first = np.array([[0, -len(endless), len(endless)]])
    links = np.concatenate([first, links]) + np.array([1, len(endless), 0])
    lights = _lights(frame.lights)
    head = np.zeros(layout.LIGHTS)
    head[layout.SKY : layout.SKY + 14] = _sky(frame, bounces)
    head[[layout.TOLERANCE, layout.SAMPLES]] = tolerance, samples
    head[layout.CAMERA : layout.CAMERA + 16] = _camera(frame.view)
    head[layout.FADE : layout.FADE + 4] = _cove(frame)
    if frame.view.orthographic:
        from renderers.tracing.window import window

        head[layout.CAMERA : layout.CAMERA + 3] = window(frame.view, nodes[1:2], tables.floors, len(endless))
    panels = _soft_boxes(frame.lights)
    surfaces_at = layout.LIGHTS + lights.size + panels.size
    nodes_at = surfaces_at + layout.SURFACE_SIZE * len(frame.shapes)
    reals_at = nodes_at + nodes.size
    items = np.concatenate([np.empty((0, 4), np.int64), *tables.items])
    items = np.concatenate([items[endless], np.concatenate([items[inner], *(own for _, own in tables.still)])[order]])
    items[:, layout.REALS_AT] += reals_at
    items[:, layout.SURFACE_AT] = surfaces_at + layout.SURFACE_SIZE * items[:, layout.SHAPE]
    links_at = layout.ITEMS + items.size
    ranges_at = links_at + links.size
    embers = embers_of(frame.shapes, frame.lights)
    parts = [lights.ravel(), panels.ravel(), *tables.surfaces, nodes.ravel(), *tables.reals, embers.ravel()]
    mists = np.array(tables.mists, dtype=np.int64) + reals_at
    reals = np.concatenate([head, *parts])
    header = [len(nodes), len(items), len(endless), len(lights), nodes_at, links_at, len(frame.shapes), tables.thin]
    header += [len(panels), len(reals) - embers.size, (len(embers) + 1) // 2, 0, len(mists), bounces]
    ranges_of = [*tables.ranges, *tables.textures]
    code_at = ranges_at + sum(map(len, ranges_of))
    ints = np.concatenate([header, items.ravel(), links.ravel(), *ranges_of, *tables.codes, mists], dtype=np.int32)
    ints[layout.MISTS_AT] = len(ints) - len(mists)
    for k in range(len(tables.implicits)):
        place = ranges_at + layout.RANGES * k
        ranges = ints[place : place + layout.RANGES]
        code = [0, layout.CELLS_AT, layout.PAINT, layout.WITHIN, layout.PLAN]
        ranges[code] += code_at
        ranges[[2, 4, layout.PAINT + 2, layout.PAINT + 4, layout.WITHIN + 2, layout.WITHIN + 4]] += reals_at
        reals[reals_at + tables.implicits[k] + 6] = place
    for k, index in enumerate(tables.painted):
        place = ranges_at + sum(map(len, ranges_of[: len(tables.ranges) + k]))
        ints[place] += code_at
        ints[[place + 2, place + 4]] += reals_at
        reals[surfaces_at + layout.SURFACE_SIZE * index + layout.TEXTURE] = place
    scene = Scene(reals, ints, 0, 0, 0, 0, 0, 0, 0)
    if tables.painted:
        from renderers.tracing.solids.texture_kernels import texture

        scene = scene._replace(texture=address(texture, TEXTURE))
    if any(isinstance(shape, seen.Grid) for shape in frame.shapes):
        from renderers.tracing.solids.grids import found_by_cells

        scene = found_by_cells(scene)
    if tables.mists:
        from renderers.tracing.mist import passed

        scene = passed(scene)
    rows = tables.rows + len(frame.shapes) + 1
    if tables.implicits:
        from renderers.tracing.solids.implicit import prepared

        sheets = any(isinstance(shape, seen.Implicit) and shape.within is not None for shape in frame.shapes)
        scene = prepared(scene, sheets=sheets, march=samples > 0, certain=certain)
    return scene, rows


class Rows:
    """Builder of a Scene; places count from the items' first real, and from the first integer of code."""

    def __init__(self, view: View) -> None:
        self.view = view
        self.thin = False
        """Whether there are capsules that may appear thinner than a pixel."""
        self.boxes: list[Floats] = []
        self.floors: list[Floats] = []
        """Half-spaces, (1, 4) each: unit normal, and height of the face."""
        self.items: list[NDArray[np.int64]] = []
        self.surfaces: list[Floats] = []
        self.reals: list[Floats] = []
        self.ranges: list[NDArray[np.int64]] = []
        self.codes: list[NDArray[np.int32]] = []
        self.implicits: list[int] = []
        self.painted: list[int] = []
        self.textures: list[NDArray[np.int64]] = []
        """Ranges of the tapes of meshes, the shapes ``painted``; they follow those of implicit objects."""
        self.still: list[tuple[Packed, NDArray[np.int64]]] = []
        """Meshes with their own hierarchies: packed data, and items, which are not in ``items``."""
        self.mists: list[int] = []
        """Places of the mists' reals."""
        self.rows = 0
        self._size = 0
        self._code_size = 0

    def add(self, index: int, shape: Any) -> None:
        """Append shape number ``index`` of the frame. Raises ValueError for an object that is no frame.Shape."""
        self.surfaces.append(_surface(shape.surface))
        if isinstance(shape, seen.Mesh):
            self._mesh(index, shape)
        elif isinstance(shape, seen.Quadric):
            plane = _half_space(shape)
            if plane is None:
                self._items(index, layout.QUADRIC, quadric_box(shape)[None, :], _quadric(shape))
            else:
                self.floors.append(plane)
                self._items(index, layout.HALF_SPACE, UNBOUNDED[None, :], plane)
        elif isinstance(shape, seen.Implicit):
            self._implicit(index, shape)
        elif isinstance(shape, seen.Grid):
            self._grid(index, shape)
        elif isinstance(shape, seen.Mist):
            from renderers.tracing.mist import row

            self.mists.append(self._place(row(shape)))
        elif isinstance(shape, seen.Points) and shape.soft is not None:
            pass  # drawn over the picture (sprites.py)
        elif isinstance(shape, seen.Points):
            zero = np.zeros((len(shape.centers), 3))
            self._rounds(index, shape.centers, zero, shape.radii, shape.colors)
        elif isinstance(shape, seen.Segments):
            pixels = half_pixels(shape, self.view)
            thin = pixels > shape.radii
            self.thin |= bool(thin.any())
            for kind, some in ((layout.ROUND, ~thin), (layout.THIN, thin)):
                if some.any():
                    ends, colors = shape.ends[some], None if shape.colors is None else shape.colors[some]
                    axes = ends[:, 1] - ends[:, 0]
                    blurred = None
                    if kind == layout.THIN:
                        from renderers.tracing.solids.line_pieces import line_lengths

                        blurred = TENT * pixels[some], line_lengths(shape.ends, SAME * float(pixels[some].min()))[some]
                    self._rounds(index, ends[:, 0], axes, shape.radii[some], colors, kind, blurred)
        else:
            raise ValueError(f"shape {index} is a {type(shape).__name__}, which is none of the closed set")

    def _items(self, index: int, kind: int, boxes: Floats, reals: Floats) -> None:
        """Append items with bounds (n, 6) [m] and reals (n, r)."""
        self.items.append(self._rows(index, kind, reals))
        self.boxes.append(boxes)

    def _rows(self, index: int, kind: int, reals: Floats) -> NDArray[np.int64]:
        """Items (n, 4) with reals (n, r), which are appended."""
        count, columns = reals.shape
        items = np.zeros((count, 4), dtype=np.int64)
        items[:, layout.KIND], items[:, layout.SHAPE] = kind, index
        items[:, layout.REALS_AT] = self._place(reals) + columns * np.arange(count)
        return items

    def _place(self, reals: Floats) -> int:
        """Append reals; returns their first place."""
        begin = self._size
        self.reals.append(np.ascontiguousarray(reals, dtype=np.float64).ravel())
        self._size += reals.size
        return begin

    def _mesh(self, index: int, mesh: seen.Mesh) -> None:
        if mesh.paint is not None:
            self.painted.append(index)
            self.textures.append(np.array(self._tape(mesh.paint)))
        still = len(mesh.triangles) >= LARGE and seen.is_held(mesh.vertices) and seen.is_held(mesh.triangles)
        packed = still_mesh(mesh) if still else None
        if packed is not None and np.isfinite(packed.tree.bounds).all():
            self.still.append((packed, self._rows(index, layout.TRIANGLE, packed.rows)))
        else:
            corners = corners_of(mesh)
            self._items(index, layout.TRIANGLE, boxes_of(corners), rows_of(mesh, corners))

    def _rounds(
        self, index: int, ends: Floats, axes: Floats, radii: Floats, colors: Floats | None, kind: int = layout.ROUND,
        blurred: tuple[Floats, Floats] | None = None,
    ) -> None:  # fmt: skip
        """Append balls and capsules; ``blurred`` of THIN ones: blur radii [m], and lengths of their lines [m]."""
        shades = np.full((len(ends), 3), np.nan) if colors is None else colors
        radii = np.asarray(radii, dtype=np.float64)[:, None]
        around = radii if blurred is None else radii + blurred[0][:, None]
        low, high = np.minimum(ends, ends + axes) - around, np.maximum(ends, ends + axes) + around
        lengths = np.empty((len(ends), 0)) if blurred is None else blurred[1][:, None]
        rows = np.concatenate([ends, axes, radii, shades, lengths], axis=1)
        self._items(index, kind, np.concatenate([low, high], axis=1), rows)

    def _implicit(self, index: int, shape: seen.Implicit) -> None:
        ball = ball_around(shape.tape) if shape.within is None else NO_BALL
        box = np.array([[*shape.low, *shape.high, 0.0, *ball, index]], dtype=np.float64)
        self.implicits.append(self._size)
        self._items(index, layout.IMPLICIT if shape.within is None else layout.SHEET, box[:, :6], box)
        ranges = self._tape(shape.tape)
        ranges.append(self._code(np.full(layout.CELLS**3, layout.UNKNOWN, dtype=np.int32)))
        for other in (shape.paint, shape.within):
            ranges += [0] * (layout.WITHIN - layout.PAINT) if other is None else self._tape(other)
        plan = ray_plan(shape.tape)
        ranges += [self._code(plan), len(plan)]
        self.ranges.append(np.array(ranges))

    def _grid(self, index: int, shape: seen.Grid) -> None:
        from renderers.tracing.solids.grids import box, row

        self._items(index, layout.GRID, box(shape), row(shape))

    def _tape(self, tape: Tape) -> list[int]:
        """Append a tape; returns its ranges."""
        self.rows = max(self.rows, scratch_rows(len(tape.code), len(tape.parts)))
        ranges = [self._code(tape.code), len(tape.code), self._place(tape.constants), len(tape.constants)]
        return [*ranges, self._place(tape.parts), len(tape.parts)]

    def _code(self, code: Ints) -> int:
        """Append integers; returns their first place."""
        begin = self._code_size
        self.codes.append(code.ravel())
        self._code_size += code.size
        return begin


def quadric_box(shape: seen.Quadric) -> Floats:
    """World bounds (6,) [m] of a quadric: of its local box, cut to the quadric's extent along each axis."""
    low, high = np.array(shape.low, dtype=np.float64), np.array(shape.high, dtype=np.float64)
    # sum s (p + l/2s)^2 <= sum l^2/4s - constant over the axes with s > 0; bounded only if the others have l = 0.
    curved = [k for k in range(3) if shape.squares[k] > 0]
    if all(shape.linear[k] == 0 for k in range(3) if k not in curved):
        rest = sum(shape.linear[k] ** 2 / (4 * shape.squares[k]) for k in curved) - shape.constant
        for k in curved:
            top, half = -shape.linear[k] / (2 * shape.squares[k]), math.sqrt(max(rest, 0.0) / shape.squares[k])
            low[k], high[k] = max(low[k], top - half), min(high[k], top + half)
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        return UNBOUNDED
    matrix = np.linalg.inv(np.asarray(shape.to_local)[:, :3])
    middle = matrix @ (0.5 * (low + high) - np.asarray(shape.to_local)[:, 3])
    reach = np.abs(matrix) @ (0.5 * (high - low)) * (1 + 1e-9) + 1e-12
    return np.concatenate([middle - reach, middle + reach])


def half_pixels(shape: seen.Segments, view: View) -> Floats:
    """Half of a pixel's width (n,) [m] at each capsule's farther end, where it is largest."""
    pixel = view.half_height / view.size[1]
    if view.orthographic:
        return np.full(len(shape.radii), pixel)
    depth = (np.asarray(view.origin) - shape.ends) @ np.asarray(view.axes)[2]
    farthest: Floats = pixel * depth.max(axis=1)
    return farthest


def _half_space(shape: seen.Quadric) -> Floats | None:
    """Unit normal and height of the face, (1, 4), if a quadric is a half-space, else None."""
    if any(shape.squares) or not np.isinf([*shape.low, *shape.high]).all():
        return None
    normal = np.array([*shape.linear, 0.0]) @ np.vstack([shape.to_local, np.zeros(4)])
    normal[3] += shape.constant
    length = np.linalg.norm(normal[:3])
    return None if length == 0 else np.array([[*normal[:3], -normal[3]]]) / length


def _quadric(shape: seen.Quadric) -> Floats:
    values = [*shape.squares, *shape.linear, shape.constant, *shape.low, *shape.high]
    return np.concatenate([np.asarray(shape.to_local, dtype=np.float64).ravel(), values])[None, :]


def _surface(s: seen.Surface) -> Floats:
    answer = (s.roughness, s.metallic, s.specular, s.transmission, s.index_of_refraction)
    return np.array([*s.color, *answer, *s.emission, s.checker_size, *s.checker_color, 0.0], dtype=np.float64)


def _lights(lights: tuple[LightSource, ...]) -> Floats:
    rows = []
    for light in lights:
        if isinstance(light, seen.Sun):
            direction = np.array(light.direction) / np.linalg.norm(light.direction)
            rows.append([layout.SUN, *direction, *light.irradiance, light.angle, math.tan(0.5 * light.angle)])
        elif not isinstance(light, seen.Sky):
            rows.append([layout.POINT, *light.position, *light.intensity, light.radius, light.radius])
    return np.array(rows, dtype=np.float64).reshape(-1, layout.LIGHT)


def _soft_boxes(lights: tuple[LightSource, ...]) -> Floats:
    rows = []
    for box in (box for light in lights if isinstance(light, seen.Sky) for box in light.boxes):
        toward = np.array(box.direction) / np.linalg.norm(box.direction)
        across = np.cross((0.0, 1.0, 0.0) if abs(toward[1]) < 0.99 else (0.0, 0.0, 1.0), toward)
        across /= np.linalg.norm(across)
        sides = (math.tan(0.5 * side) for side in box.size)
        rows.append([*toward, *across, *np.cross(toward, across), *sides, *box.radiance])
    return np.array(rows, dtype=np.float64).reshape(-1, layout.BOX)


def _sky(frame: SeenFrame, bounces: int) -> Floats:
    """Reals (14,) of the sum of all skies; `visible` is that of the last sky that has it."""
    row = np.zeros(14)
    shines = [light for light in frame.lights if bounces > 0 or isinstance(light, seen.Sky)]
    row[layout.HAS_LIGHT] = any(shines) or any(any(shape.surface.emission) for shape in frame.shapes)
    for sky in frame.lights:
        if isinstance(sky, seen.Sky):
            row[:9] += [*sky.zenith, *sky.horizon, *sky.ground]
            if sky.visible is not None:
                row[9:12] = sky.visible
                row[13] = 1.0
    return row


def _cove(frame: SeenFrame) -> Floats:
    """Reals (4,) for the fading of endless floors into the background, from the last visible sky."""
    row = np.array([FADE, 0.0, 0.0, 0.0])
    for sky in frame.lights:
        if isinstance(sky, seen.Sky) and sky.visible is not None:
            row[:] = FADE if sky.fade is None else sky.fade, *(sky.below or sky.visible)
    return row


def _camera(view: seen.View) -> Floats:
    axes = np.asarray(view.axes, dtype=np.float64).ravel()
    return np.array([*view.origin, *axes, view.half_height, float(view.orthographic), *view.size], dtype=np.float64)
