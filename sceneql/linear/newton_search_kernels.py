# mypy: ignore-errors
"""Newton's method for one implicit stage where the plain iteration fails: updates are searched for less.

Where an island has a potential E, the stage's solution is a stationary point of (v - base) M (v - base)/2 + E(x) on
x = base + a v; elsewhere what falls is the residual, in the same norm of the masses M; and where surfaces are kept
apart without a potential, as beside bodies that turn, the next update that the same slopes would give: a residual is
as large as their barriers are stiff (natural monotonicity: Deuflhard, Newton Methods for Nonlinear Problems, 2004,
3.3). A stiff spring that turns first stretches, and the next update repairs it: so whole updates are taken as long as
one of a few brings less than the least so far (watchdog: Chamberlain, Powell, Lemarechal & Pedersen 1982). Where none
does, the search goes back to the least and goes from there along an update by Armijo's rule (Nocedal & Wright,
Numerical Optimization, 2006, ch. 3); where surfaces are kept apart it does so along each update.

Slopes are the positive ones (Slopes.positive); where these converge slowly, the true ones, as long as their matrix is
positive definite, as the signs of its pivots tell.
"""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.compiled.pointers_kernels import (
    AT_ENERGY,
    AT_JACOBIAN,
    AT_LIMIT,
    energy_at,
    jacobian_at,
    limit_at,
)
from sceneql.linear.newton_kernels import (
    CAREFUL,
    CLEAR,
    CONTRACTION,
    FACTORED,
    FACTORIZATIONS,
    ITERATIONS,
    LOOSELY,
    NEWTON,
    NOISE,
    NOISE_APART,
    POSITIVE,
    SHARE,
    SLOW,
    TINY,
    UNSEEN,
    foresee,
    largest,
    norm,
    remain,
    unlike,
)
from sceneql.linear.stage_kernels import (
    BORDER,
    CORE_AT,
    KEEPS,
    POSITIONS,
    POSITIONS_AT,
    SOLVE_STAGE,
    UNKNOWNS,
    along,
    assemble_stage,
    factor_stage,
    indefinite,
    solve_stage,
)

MOST, MOST_APART = 120, 400
"""Largest number of updates; of such where surfaces are kept apart, whose friction sticks and slips pair by pair."""
WATCHED = 20
"""Whole updates that need not bring less; none where surfaces are kept apart."""
SLOWED, SLOWED_APART = 0.5, 0.1
"""Contraction from which on positive slopes are slow; where surfaces are kept apart."""
TRUE_AFTER, TRUE_AFTER_APART = 3, 1
"""Slow updates after which true slopes are tried; twice as many after each time that these fail, RARELY at most."""
RARELY = 8
ENOUGH = 1e-4
"""Part of the fall that the slope predicts which a step must bring (Armijo)."""
KEEPING = 0.3
"""Contraction up to which factors are kept where surfaces are kept apart: an update with new ones takes four times as
long, and positive slopes bring no more."""
KEPT = 4
"""Evaluations of slopes where surfaces are kept apart that take those of strain from before (channels.KEEPS)."""
EASY = 4
"""Updates up to which a search where surfaces are kept apart was none: the next stage begins plainly, and may keep its
factors through free flight."""
SHORTEST = 1e-10
"""Part of an update below which no shorter one is tried."""
ROUNDING = 1e-13
"""Relative rounding error of a potential."""
NOISY = 1e5
"""Fall of a potential that the slope predicts, in rounding errors, from which on its value tells nothing: energies of
stiff solids are small differences."""
ULPS, UNTOLD = 1.0 + 4e-16, 100.0
"""Factor by which a state is rounded another way; fall of a potential, over what that changes, up to which likewise."""
LESS = 0.25
"""Square of the part to which an update must bring down the residual where the potential tells nothing of it."""
LOOSE = 0.3
"""Last update, over the largest with the same loads of friction, from which on these are taken anew."""
UNMOVED = 1e-12
"""Part of an update that a limit allows, below which nothing can move."""


solve_by_kept = lazy("sceneql.linear.kept_factors_kernels:solve_by_kept", SOLVE_STAGE)


@lean_inlined
def prescribe(change, residual, y, plan):
    """Put entries that no unknown moves, as the velocities of guided pins, where they will be."""
    for k in range(y.size):
        change[k] = 1.0
    for k in range(plan[CORE_AT], plan[CORE_AT] + plan[UNKNOWNS] - plan[BORDER]):
        change[plan[k]] = 0.0
    at = plan[POSITIONS_AT]
    for k in range(at, at + 3 * plan[POSITIONS], 3):
        change[plan[k]] = 0.0
    for k in range(y.size):
        y[k] += change[k] * residual[k]


@lean_inlined
def aim(y, change, floats):
    """Store y and y + change as the states before and after an update (newton_kernels.foresee)."""
    n = y.size
    before, after = floats.size - channels.BEFORE * n, floats.size - channels.AFTER * n
    for k in range(n):
        floats[before + k] = y[k]
        floats[after + k] = y[k] + change[k]


@lean_inlined
def go(y, change, part, floats):
    """Move y from the state before to that after a part of an update."""
    n = y.size
    before, after = floats.size - channels.BEFORE * n, floats.size - channels.AFTER * n
    for k in range(n):
        y[k] = floats[after + k] = floats[before + k] + part * change[k]


@lean_inlined
def shorter(part, low, slope, value):
    """The next part of an update to try: the least of the parabola through what is known, within a tenth and a half."""
    bend = value - low - part * slope
    found = -0.5 * slope * part * part / bend if math.isfinite(bend) and bend > 0.0 else 0.0
    return min(0.5 * part, max(0.1 * part, found))


@lean_inlined
def measure(functions, t, a, base, y, residual, change, jacobian, store, scales, plan, natural, floats, ints):
    """What is searched for less of, at a state whose residual is known; and its rounding error. ``change``: scratch."""
    if natural:
        for k in range(y.size):
            change[k] = residual[k]
        if not solve_stage(plan, a, jacobian, scales, store, change):
            return math.inf, 0.0
        return 0.5 * along(plan, scales, change, change), 0.0
    if functions[AT_ENERGY] == 0:
        return 0.5 * along(plan, scales, residual, residual), 0.0
    for k in range(y.size):
        change[k] = y[k] - base[k]
    kinetic = 0.5 * along(plan, scales, change, change)
    stored = energy_at(functions[AT_ENERGY])(t, y, floats, ints)
    return kinetic + stored, ROUNDING * (kinetic + abs(stored))


@lean(NEWTON, inner=True)
def search(functions, t, a, base, y0, y, scratch, jacobian, store, scales, memory, plan, floats, ints):
    """Solve for y as newton_kernels.newton does."""
    slopes = jacobian_at(functions[AT_JACOBIAN])
    has_potential, has_limit = functions[AT_ENERGY] != 0, functions[AT_LIMIT] != 0
    noise = NOISE_APART if has_limit else NOISE
    n = y.size
    change, residual = scratch[:n], scratch[n : 2 * n]
    best, moved = scratch[2 * n : 3 * n], scratch[3 * n : 4 * n]
    remain(functions, t, a, base, y, residual, plan, floats, ints)
    prescribe(change, residual, y, plan)
    remain(functions, t, a, base, y, residual, plan, floats, ints)
    foresee(y0, y0, floats)
    memory[FACTORED] = 0.0
    natural = False
    lowest, rounding = measure(
        functions, t, a, base, y, residual, moved, jacobian, store, scales, plan, natural, floats, ints
    )
    natural = has_limit and not has_potential
    floor = 0.0
    if has_limit and has_potential:
        # At rest a potential is the small difference of large numbers: what another rounding of the state makes of it.
        for k in range(n):
            moved[k] = ULPS * y[k]
        energies = energy_at(functions[AT_ENERGY])
        floor = abs(energies(t, moved, floats, ints) - energies(t, y, floats, ints))
        floor = UNTOLD / NOISY * floor if floor < math.inf else 0.0
    rounding = max(rounding, floor)
    for k in range(n):
        best[k] = y[k]
    positive, searching = True, has_limit
    stale = regular = True
    kept = 0
    slow = failing = since = 0
    patience, slowed = (TRUE_AFTER_APART, SLOWED_APART) if has_limit else (TRUE_AFTER, SLOWED)
    before = before_mean = first = 0.0
    rubs = floats[channels.STALE] > unlike(memory)
    keeps = has_limit and has_potential and plan[KEEPS] == 1
    kept_factors = aged = False
    for update in range(MOST_APART if has_limit else MOST):
        solved = False
        if not stale and aged:
            for k in range(n):
                change[k] = residual[k]
            solved = solve_by_kept(plan, a, jacobian, scales, store, change)
            stale = not solved
        while stale:
            floats[channels.NEWTON] = a * a
            floats[channels.POSITIVE] = 1.0 if positive else 0.0
            likewise = has_limit and kept > 0
            floats[channels.KEEPS] = 1.0 if likewise else 0.0
            kept = kept - 1 if likewise else KEPT
            slopes(functions, t, y, jacobian, floats, ints)
            floats[channels.NEWTON] = floats[channels.POSITIVE] = floats[channels.KEEPS] = 0.0
            if floats[channels.GROWS] != 0.0:
                return False
            if kept_factors:
                assemble_stage(plan, a, jacobian, scales, store)
                for k in range(n):
                    change[k] = residual[k]
                solved = solve_by_kept(plan, a, jacobian, scales, store, change)
                aged = solved
                if solved:
                    break
            memory[FACTORIZATIONS] += 1.0
            regular = factor_stage(plan, a, jacobian, scales, store)
            kept_factors, aged = keeps and regular, False
            if positive or (regular and not indefinite(plan, store)):
                break
            kept_factors = False  # they are of a matrix that is not positive
            positive, slow = True, 0
            patience = min(2 * patience, RARELY)
        memory[ITERATIONS] += 1.0
        if not solved:
            for k in range(n):
                change[k] = residual[k]
            if not regular or not solve_stage(plan, a, jacobian, scales, store, change):
                break
        left = along(plan, scales, residual, residual)
        if natural:
            lowest = 0.5 * along(plan, scales, change, change)
        slope = -along(plan, scales, residual, change) if has_potential else -2.0 * lowest
        # Beside energies of next to nothing all of an update may be rounding, however little that is.
        tiny = has_limit and largest(change, y0, y, memory) <= NOISE_APART
        noisy = has_limit and (tiny or -slope <= NOISY * rounding)
        part = 1.0
        aim(y, change, floats)
        if has_limit:
            old, new = floats[floats.size - channels.BEFORE * n :], floats[floats.size - channels.AFTER * n :]
            part = limit_at(functions[AT_LIMIT])(t, old[:n], new[:n], floats, ints)
            if part < UNMOVED:
                break
            if part < 1.0:
                part *= CLEAR
        longest = part
        go(y, change, part, floats)
        remain(functions, t, a, base, y, residual, plan, floats, ints)
        value, _ = measure(
            functions, t, a, base, y, residual, moved, jacobian, store, scales, plan, natural, floats, ints
        )
        noisy = noisy and (tiny or value <= lowest + NOISY * rounding)
        if has_limit and not noisy and not value <= lowest + ENOUGH * part * slope + rounding:
            # Friction learns where the whole update led (friction_slopes_kernels), though only a part of it is taken.
            floats[channels.NEWTON] = a * a
            floats[channels.POSITIVE] = floats[channels.KEEPS] = 1.0
            slopes(functions, t, y, jacobian, floats, ints)
            floats[channels.NEWTON] = floats[channels.POSITIVE] = floats[channels.GROWS] = floats[channels.KEEPS] = 0.0
        while (
            searching
            and not noisy
            and not value <= lowest + ENOUGH * part * slope + rounding
            and part > SHORTEST * longest
        ):
            part = shorter(part, lowest, slope, value)
            go(y, change, part, floats)
            remain(functions, t, a, base, y, residual, plan, floats, ints)
            value, _ = measure(
                functions, t, a, base, y, residual, moved, jacobian, store, scales, plan, natural, floats, ints
            )
        if part <= SHORTEST * longest and has_limit and has_potential:
            # Where the potential tells nothing of an update, the forces that are left do.
            go(y, change, longest, floats)
            remain(functions, t, a, base, y, residual, plan, floats, ints)
            if along(plan, scales, residual, residual) <= LESS * left:
                part, value = longest, lowest
        if part <= SHORTEST * longest:
            if positive and stale and failing == 0:
                break
            go(y, change, 0.0, floats)
            if failing > 0:  # what is searched for less of may have been let grow where it told nothing
                for k in range(n):
                    y[k] = best[k]
                foresee(y, y, floats)
            remain(functions, t, a, base, y, residual, plan, floats, ints)
            positive = stale = True
            since = slow = failing = 0
            patience = min(2 * patience, RARELY)
            continue
        searching = has_limit
        for k in range(n):
            change[k] *= part
        # The tests of convergence are those of newton_kernels.newton.
        size = largest(change, y0, y, memory)
        mean = norm(change, y0, y, memory) if size < math.inf else math.inf
        contraction = max(UNSEEN, memory[CONTRACTION])
        if part < 1.0 or not size < math.inf:
            foresee(y, y, floats)
            since = 0
        elif since > 0:
            contraction = size / before if before > 0.0 else 0.0
            memory[CONTRACTION] = max(contraction, 1e-3)
        first = max(first, size) if size < math.inf else first
        anew = False
        if part == 1.0 and size < math.inf:
            done = size == 0.0 or (contraction < 1.0 and size * contraction <= memory[SHARE] * (1.0 - contraction))
            done = done and (since > 0 or memory[SHARE] < 1.0 or size < TINY)
            done = done or (since > 0 and max(size, before) <= noise)
            if since > 0 and size <= memory[SHARE]:
                done = done or mean * mean <= memory[SHARE] * (before_mean - mean)
            loose = contraction < 1.0 and size * contraction <= LOOSE * first * (1.0 - contraction)
            if rubs and since > 0 and (done or loose) and value <= lowest + rounding:
                # Loads of friction follow the state, before the solution with those of before is exact.
                anew = floats[channels.STALE] > LOOSELY
                floats[channels.LAGS] += 1.0
                floats[channels.STALE] = first = 0.0
                remain(functions, t, a, base, y, residual, plan, floats, ints)
                foresee(y, y, floats)  # the directions of friction have learned what there was to learn
                rubs = floats[channels.STALE] > unlike(memory)
                done = False
            if done:
                memory[FACTORED] = 0.0 if aged else a
                memory[POSITIVE] = memory[CAREFUL] = 1.0 if positive else 0.0
                if has_limit:
                    memory[CAREFUL] = 0.0 if update < EASY else 1.0
                return True
            since += 1
        before, before_mean = size, mean
        if value <= lowest + rounding:
            failing = 0
            lowest, rounding = measure(
                functions, t, a, base, y, residual, moved, jacobian, store, scales, plan, natural, floats, ints
            )
            rounding = max(rounding, floor)
            for k in range(n):
                best[k] = y[k]
        else:
            failing += 1
            if failing > (0 if has_limit and not noisy else WATCHED) or not math.isfinite(value):
                for k in range(n):
                    y[k] = best[k]
                foresee(y, y, floats)
                remain(functions, t, a, base, y, residual, plan, floats, ints)
                positive = searching = stale = True
                failing = since = slow = 0
                continue
        well = has_limit and since > 1 and contraction <= KEEPING and not anew
        stale = ((positive or has_limit) and not well) or part < 1.0 or (since > 1 and contraction > SLOW)
        slow = slow + 1 if contraction > slowed and since > 1 else 0
        if positive and slow >= patience:
            positive, slow, stale = False, 0, True
        elif not positive and slow > 0 and contraction >= 1.0:
            positive, slow, stale = True, 0, True
            patience = min(2 * patience, RARELY)
    return False
