# mypy: ignore-errors
"""Statements of OBJ files (Wavefront, Advanced Visualizer, appendix B1): vertices and faces, a block of text at a time.

Numbers of up to 15 digits and powers of ten to 22 are exact by one product or quotient (Clinger 1990); others are
copied, for a reader that rounds correctly.
"""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.shapes.ears_kernels import cut_ears, turn

VERTICES, LINE, PLACES, CORNERS, FACES, HARD, HARD_LENGTH, HIGHEST, HIGHEST_LINE, WRONG, FROM, UNTIL = range(12)
"""The state of reading: vertices of all blocks before; lines; vertices, corners, faces and hard numbers of this block,
and the bytes of the latter; the highest vertex that a face names, and where; the error, and its bytes of the text."""
NOT_A_NUMBER, FEW_NUMBERS, NOT_AN_INDEX, NO_ZERO, TOO_FAR_BACK, FEW_CORNERS = range(1, 7)
NUMBERS = 6
"""Of a vertex: its place, then red, green and blue, which few files have."""
GIVEN = NUMBERS
"""The column behind them: how many there are."""
WIDTH = NUMBERS + 1
STEADY = 1 << 53
"""Integers below it are exact as doubles."""
TRIED = 32
"""Corners of a polygon up to which a fan from each corner is tried."""
TEXT = types.Array(types.uint8, 1, "C", readonly=True)
BYTES = types.uint8[::1]
INTS = types.int32[::1]
PLACE = types.float64[:, ::1]
STATE = types.int64[::1]


@lean_inlined
def byte(text, at):
    """The byte there, a line's end behind the text."""
    return text[at] if at < len(text) else 10


@lean_inlined
def ends_line(c):
    """Whether a byte ends a line."""
    return c == 10 or c == 13


@lean_inlined
def joins(text, at):
    """How many bytes a backslash and the line's end behind it take; 0 for anything else."""
    if byte(text, at) != 92:
        return 0
    c = byte(text, at + 1)
    return 2 if c == 10 else 3 if c == 13 and byte(text, at + 2) == 10 else 0


@lean_inlined
def ends_word(text, at):
    """Whether no word goes on there."""
    c = byte(text, at)
    return c == 32 or c == 9 or c == 10 or c == 13 or c == 11 or c == 12 or joins(text, at) > 0


@lean_inlined
def next_word(text, at, state):
    """Where the statement's next word begins; where a comment or the line's end begins, if there is none.

    A backslash before a line's end joins the next line.
    """
    while True:
        c = byte(text, at)
        if c == 32 or c == 9 or c == 11 or c == 12:
            at += 1
        elif joins(text, at):
            state[LINE] += 1
            at += joins(text, at)
        else:
            return at


@lean_inlined
def next_line(text, at, state):
    """Where the next line begins."""
    while not ends_line(byte(text, at)):
        at += 1
    state[LINE] += 1
    return at + 2 if byte(text, at) == 13 and byte(text, at + 1) == 10 else at + 1


@lean_inlined
def fail(text, at, state, error):
    """Note an error at a word."""
    state[WRONG], state[FROM] = error, at
    while not ends_word(text, at):
        at += 1
    state[UNTIL] = min(at, len(text))


@lean_inlined
def read_number(text, at, state, places, column, hard, hard_at):
    """Read a decimal number into the vertex at hand; returns where it ends. What is none is an error."""
    begin = at
    c = byte(text, at)
    negative = c == 45
    if c == 45 or c == 43:
        at += 1
    digits = 0
    whole = 0
    power = 0
    easy = True
    point = False
    while True:
        c = byte(text, at)
        if 48 <= c <= 57:
            digits += 1
            if whole < STEADY:
                whole = 10 * whole + (c - 48)
                power -= 1 if point else 0
            else:
                easy = False
        elif c == 46 and not point:
            point = True
        else:
            break
        at += 1
    good = digits > 0
    if good and (c == 101 or c == 69):
        at += 1
        c = byte(text, at)
        falls = c == 45
        if c == 45 or c == 43:
            at += 1
        good = 48 <= byte(text, at) <= 57
        exponent = 0
        while 48 <= byte(text, at) <= 57:
            exponent = min(10 * exponent + (byte(text, at) - 48), 100000)
            at += 1
        power += -exponent if falls else exponent
    if not good or not ends_word(text, at):
        fail(text, begin, state, NOT_A_NUMBER)
        return at
    row = state[PLACES]
    if easy and whole < STEADY and -22 <= power <= 22:
        scale = 1.0
        for _ in range(abs(power)):
            scale *= 10.0
        value = float(whole) * scale if power > 0 else float(whole) / scale
        places[row, column] = -value if negative else value
    else:
        hard_at[state[HARD]] = WIDTH * row + column
        state[HARD] += 1
        for k in range(begin, at):
            hard[state[HARD_LENGTH]] = text[k]
            state[HARD_LENGTH] += 1
        hard[state[HARD_LENGTH]] = 32
        state[HARD_LENGTH] += 1
    return at


@lean_inlined
def read_vertex(text, at, state, places, hard, hard_at):
    """Read three numbers and more: a fourth is a weight of curves, six have a color; returns where the line ends."""
    begin = at
    count = 0
    while True:
        at = next_word(text, at, state)
        c = byte(text, at)
        if ends_line(c) or c == 35:
            break
        if count < NUMBERS:
            at = read_number(text, at, state, places, count, hard, hard_at)
            if state[WRONG]:
                return at
        else:
            while not ends_word(text, at):
                at += 1
        count += 1
    if count < 3:
        fail(text, begin, state, FEW_NUMBERS)
    places[state[PLACES], GIVEN] = count
    state[PLACES] += 1
    return at


@lean_inlined
def read_face(text, at, state, corners, sizes):
    """Read corners a, a/b, a//c or a/b/c, of which a is the vertex; returns where the line ends."""
    begin = at
    count = 0
    while True:
        at = next_word(text, at, state)
        c = byte(text, at)
        if ends_line(c) or c == 35:
            break
        word = at
        back = c == 45
        if c == 45 or c == 43:
            at += 1
        digits = 0
        number = 0
        while 48 <= byte(text, at) <= 57:
            number = min(10 * number + (byte(text, at) - 48), 1 << 40)
            digits += 1
            at += 1
        if byte(text, at) == 47:
            while 45 <= byte(text, at) <= 57 and byte(text, at) != 46:  # further indices, of textures and normals
                at += 1
        if digits == 0 or not ends_word(text, at):
            fail(text, word, state, NOT_AN_INDEX)
            return at
        if number == 0:
            fail(text, word, state, NO_ZERO)
            return at
        so_far = state[VERTICES] + state[PLACES]
        index = so_far - number if back else number - 1
        if index < 0:
            fail(text, word, state, TOO_FAR_BACK)
            return at
        if index > state[HIGHEST]:
            state[HIGHEST], state[HIGHEST_LINE] = index, state[LINE]
        corners[state[CORNERS]] = min(index, (1 << 31) - 1)
        state[CORNERS] += 1
        count += 1
    if count < 3:
        fail(text, begin, state, FEW_CORNERS)
    sizes[state[FACES]] = count
    state[FACES] += 1
    return at


@lean(types.void(TEXT, STATE, PLACE, INTS, INTS, BYTES, INTS))
def parse(text, state, places, corners, sizes, hard, hard_at):
    """Read whole lines of text, to the first error; what is neither vertex nor face is passed over.

    Written are ``places`` (vertices, WIDTH), ``corners``, vertices counted from 0 of all faces one after another,
    ``sizes``, how many each has, ``hard``, texts of numbers with a space behind each, and ``hard_at``, where in
    ``places`` they belong; their lengths are in ``state``.
    """
    at = 0
    while at < len(text):
        at = next_word(text, at, state)
        c = byte(text, at)
        if (c == 118 or c == 102) and ends_word(text, at + 1):
            if c == 118:
                at = read_vertex(text, at + 1, state, places, hard, hard_at)
            else:
                at = read_face(text, at + 1, state, corners, sizes)
            if state[WRONG]:
                return
        at = next_line(text, at, state)


@lean_inlined
def is_fan(flat, count, k):
    """Whether no triangle of the fan from corner k turns right."""
    for step in range(1, count - 1):
        if turn(flat, k, (k + step) % count, (k + step + 1) % count) < 0.0:
            return False
    return True


@lean(types.int64(PLACE, INTS, INTS, INTS, PLACE, STATE, types.int64[:, ::1], types.int64))
def triangulate(places, corners, sizes, triangles, flat, left, found, work):
    """Triangles of polygons, flat: a fan, from the first corner where that will do, else ears.

    ``places`` (n, 3); ``corners`` and ``sizes`` as ``parse`` writes them; ``triangles`` (3 m). ``flat`` (k, 2),
    ``left`` (k) and ``found`` (k, 3) are room for the largest polygon. Returns what is left of ``work``, below 0 where
    the polygons need more tests of corners (ears_kernels.cut_ears).
    """
    first = 0
    made = 0
    for face in range(len(sizes)):
        count = sizes[face]
        fan = 0
        if count > 3:
            fan = -1
            x, y, z = 0.0, 0.0, 0.0
            o = corners[first]
            for k in range(1, count - 1):
                a, b = corners[first + k], corners[first + k + 1]
                ax, ay, az = places[a, 0] - places[o, 0], places[a, 1] - places[o, 1], places[a, 2] - places[o, 2]
                bx, by, bz = places[b, 0] - places[o, 0], places[b, 1] - places[o, 1], places[b, 2] - places[o, 2]
                x += ay * bz - az * by
                y += az * bx - ax * bz
                z += ax * by - ay * bx
            axis = 0 if abs(x) >= abs(y) and abs(x) >= abs(z) else 1 if abs(y) >= abs(z) else 2
            sense = x if axis == 0 else y if axis == 1 else z
            u, v = (axis + 1) % 3, (axis + 2) % 3
            if sense < 0.0:
                u, v = v, u
            for k in range(count):
                p = corners[first + k]
                flat[k, 0] = places[p, u] - places[o, u]
                flat[k, 1] = places[p, v] - places[o, v]
            for k in range(count if count <= TRIED else 1):
                if is_fan(flat, count, k):
                    fan = k
                    break
            if fan < 0:
                work = cut_ears(flat, count, left, found, work)
                if work < 0:
                    return work
        for k in range(count - 2):
            for c in range(3):
                if fan < 0:
                    corner = found[k, c]
                else:
                    corner = fan if c == 0 else (fan + k + c) % count
                triangles[made] = corners[first + corner]
                made += 1
        first += count
    return work
