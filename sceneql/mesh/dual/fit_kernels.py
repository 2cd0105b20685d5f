# mypy: ignore-errors
"""Least-squares intersection of planes in a box, by truncated eigenvectors."""

from sceneql.compiled.kernels import inlined

SWEEPS = 12
TRUNCATION = 0.01
"""Eigenvalues below this part of the largest count as zero: planes within about 11 degrees make no edge."""
LARGEST = 1.0e300
SLACK = 1.0
"""How far a vertex may leave its cell, in sides of the cell."""
EXACT = 1.0e-7
"""Root of the summed squared distances, in sides of a cell, up to which the planes count as met."""
BETTER = 0.1
"""Factor by which leaving the cell must lower the sum of squared distances."""


@inlined
def diagonalize(a, v):
    """Jacobi's rotations (1846): a (3, 3), symmetric, becomes diagonal, v (3, 3) its eigenvectors as columns."""
    for i in range(3):
        for j in range(3):
            v[i, j] = 1.0 if i == j else 0.0
    for _ in range(SWEEPS):
        off = a[0, 1] * a[0, 1] + a[0, 2] * a[0, 2] + a[1, 2] * a[1, 2]
        if off <= 1.0e-32 * (a[0, 0] * a[0, 0] + a[1, 1] * a[1, 1] + a[2, 2] * a[2, 2]):
            return
        for p in range(2):
            for q in range(p + 1, 3):
                if a[p, q] == 0.0:
                    continue
                theta = 0.5 * (a[q, q] - a[p, p]) / a[p, q]
                if abs(theta) > 1.0e150:
                    a[p, q] = 0.0
                    a[q, p] = 0.0
                    continue
                t = (1.0 if theta >= 0.0 else -1.0) / (abs(theta) + (theta * theta + 1.0) ** 0.5)
                c = 1.0 / (t * t + 1.0) ** 0.5
                s = t * c
                for k in range(3):
                    x = a[k, p]
                    y = a[k, q]
                    a[k, p] = c * x - s * y
                    a[k, q] = s * x + c * y
                for k in range(3):
                    x = a[p, k]
                    y = a[q, k]
                    a[p, k] = c * x - s * y
                    a[q, k] = s * x + c * y
                    x = v[k, p]
                    y = v[k, q]
                    v[k, p] = c * x - s * y
                    v[k, q] = s * x + c * y
                a[p, q] = 0.0
                a[q, p] = 0.0


@inlined
def fitted(normal, right, sides, box, a, v, step):
    """Least change ``step`` (3,) from the start that fits the planes best with some axes held; rank in the free axes.

    ``normal`` (3, 3) and ``right`` (3,) are the normal equations, ``box`` (2, 3) the room below and above the start;
    ``sides`` holds for each axis a ternary digit: 0 if it is free, 1 and 2 if it is at its lower and upper bound.
    """
    for i in range(3):
        held = sides // 3**i % 3
        step[i] = 0.0 if held == 0 else box[held - 1, i]
    for i in range(3):
        for j in range(3):
            free = sides // 3**i % 3 == 0 and sides // 3**j % 3 == 0
            a[i, j] = normal[i, j] if free else 0.0
    diagonalize(a, v)
    largest = max(normal[0, 0], normal[1, 1], normal[2, 2])
    rank = 0
    rest0 = right[0] - normal[0, 0] * step[0] - normal[0, 1] * step[1] - normal[0, 2] * step[2]
    rest1 = right[1] - normal[1, 0] * step[0] - normal[1, 1] * step[1] - normal[1, 2] * step[2]
    rest2 = right[2] - normal[2, 0] * step[0] - normal[2, 1] * step[1] - normal[2, 2] * step[2]
    for k in range(3):
        if a[k, k] > TRUNCATION * largest:
            rank += 1
            share = (v[0, k] * rest0 + v[1, k] * rest1 + v[2, k] * rest2) / a[k, k]
            for i in range(3):
                if sides // 3**i % 3 == 0:
                    step[i] += share * v[i, k]
    return rank


@inlined
def misfit(normal, right, step):
    """Change by a step of the sum of squared distances from the planes."""
    total = 0.0
    for i in range(3):
        total -= 2.0 * right[i] * step[i]
        for j in range(3):
            total += step[i] * normal[i, j] * step[j]
    return total


@inlined
def placed(normal, right, box, a, v, step, best):
    """Best step (3,) within the box over all choices of axes at bounds: (its misfit, rank, whether none is at one)."""
    whole = 0
    least = LARGEST
    free = False
    for sides in range(27):
        rank = fitted(normal, right, sides, box, a, v, step)
        if sides == 0:
            whole = rank
        within = True
        for i in range(3):
            within = within and box[0, i] <= step[i] and step[i] <= box[1, i]
        if not within:
            continue
        found = misfit(normal, right, step)
        if found < least:
            least = found
            for i in range(3):
                best[i] = step[i]
        if sides == 0:
            free = True
            break
    return least, whole, free


@inlined
def held(normal, right, square, box, h, a, v, step, best):
    """As ``placed``, in the cell ``box`` of side h or, if the planes meet far better there, a little outside it.

    ``square`` is the sum of squared distances of the planes before the step. An edge that cuts a corner off a cell
    passes it by although its planes are seen there. Returns the rank.
    """
    least, rank, free = placed(normal, right, box, a, v, step, best)
    if free or square + least <= (EXACT * h) ** 2:
        return rank
    x = best[0]
    y = best[1]
    z = best[2]
    for i in range(3):
        box[0, i] -= SLACK * h
        box[1, i] += SLACK * h
    wide, rank, free = placed(normal, right, box, a, v, step, best)
    if not square + wide < BETTER * (square + least):
        best[0] = x
        best[1] = y
        best[2] = z
    return rank
