# mypy: ignore-errors
"""An elimination order of a sparse matrix's graph, found in compiled code while a simulation runs.

Minimum degree on the quotient graph (George & Liu 1989, SIAM Review 31, 1-19): what is eliminated stands as an element,
with the vertices that it ties; an element that meets the next one's pivot is absorbed in it, and is its child.
"""

from numba import types

from sceneql.compiled.integers_kernels import filled, longer
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.system.signatures_kernels import I, N


@lean(types.void(I, I, I), inner=True)
def neighbors(edges, starts, ends):
    """Writes where each vertex's neighbors start (n + 1,), 0 before, and the neighbors, for edges (a, b)."""
    n = starts.size - 1
    for k in range(edges.size):
        starts[edges[k] + 1] += 1
    for k in range(n):
        starts[k + 1] += starts[k]
    for k in range(0, edges.size, 2):
        a, b = edges[k], edges[k + 1]
        ends[starts[a]], ends[starts[b]] = b, a
        starts[a] += 1
        starts[b] += 1
    for k in range(n, 0, -1):
        starts[k] = starts[k - 1]
    starts[0] = 0


@lean_inlined
def tied(v, starts, counts, lists, bounds, members, parents, mark, stamp, out, at):
    """Writes the vertices that v is tied to, by edges and elements, to out[at:], and marks them; where they end."""
    mark[v] = stamp
    for k in range(starts[v], starts[v] + counts[v]):
        x = lists[k]
        if bounds[2 * x] < 0:
            if mark[x] != stamp:
                mark[x] = stamp
                out[at] = x
                at += 1
            continue
        parents[x] = v
        for j in range(bounds[2 * x], bounds[2 * x + 1]):
            y = members[j]
            if mark[y] != stamp:
                mark[y] = stamp
                out[at] = y
                at += 1
    return at


@lean_inlined
def degree(v, starts, counts, lists, bounds, members, mark, stamp):
    """How many vertices v is tied to."""
    mark[v] = stamp
    found = 0
    for k in range(starts[v], starts[v] + counts[v]):
        x = lists[k]
        if bounds[2 * x] < 0:
            if mark[x] != stamp:
                mark[x] = stamp
                found += 1
            continue
        for j in range(bounds[2 * x], bounds[2 * x + 1]):
            y = members[j]
            if mark[y] != stamp:
                mark[y] = stamp
                found += 1
    return found


@lean(types.void(I, I, I), inner=True)
def children_first(parents, order, work):
    """Writes the vertices of a forest, each after its children and every subtree in a row. ``work`` (3 n,)."""
    n = parents.size
    first, following, stack = work[:n], work[n : 2 * n], work[2 * n :]
    for k in range(n):
        first[k] = -1
    for k in range(n - 1, -1, -1):
        if parents[k] >= 0:
            following[k] = first[parents[k]]
            first[parents[k]] = k
    done = 0
    for root in range(n):
        if parents[root] >= 0:
            continue
        stack[0], deep = root, 1
        while deep > 0:
            child = first[stack[deep - 1]]
            if child < 0:
                deep -= 1
                order[done] = stack[deep]
                done += 1
            else:
                first[stack[deep - 1]] = following[child]
                stack[deep] = child
                deep += 1


@kernel(types.Tuple((I, I, I, I))(N, I), inner=True)
def elimination(n, edges):
    """The order of n vertices with these edges (m 2,): the vertices, every subtree of the tree in a row.

    Besides each vertex's parent in the tree (-1: a root); where its structure begins and ends (n 2,): the vertices
    eliminated after it that its row reaches; the structures.
    """
    starts, lists = filled(n + 1, 0), filled(edges.size, 0)
    neighbors(edges, starts, lists)
    counts, degrees = filled(n, 0), filled(n, 0)
    parents, bounds = filled(n, -1), filled(2 * n, -1)
    mark, stamp = filled(n, -1), 0
    members, end = filled(4 * n + 2 * edges.size, 0), 0
    for v in range(n):
        counts[v] = degrees[v] = starts[v + 1] - starts[v]
    for done in range(n):
        v = -1
        for k in range(n):
            if bounds[2 * k] < 0 and (v < 0 or degrees[k] < degrees[v]):
                v = k
        if end + n > members.size:
            members = longer(members, end, 2 * members.size + n)
        stamp += 1
        begin, end = end, tied(v, starts, counts, lists, bounds, members, parents, mark, stamp, members, end)
        bounds[2 * v], bounds[2 * v + 1] = begin, end
        own = stamp
        # What the new element ties is reached through it, no more by edges within it or by elements that it absorbed.
        for k in range(begin, end):
            i = members[k]
            kept = starts[i]
            for j in range(starts[i], starts[i] + counts[i]):
                x = lists[j]
                if (bounds[2 * x] < 0 and mark[x] != own) or (bounds[2 * x] >= 0 and x != v and parents[x] < 0):
                    lists[kept] = x
                    kept += 1
            lists[kept] = v
            counts[i] = kept + 1 - starts[i]
        if end - begin == n - done - 1:
            # All that is left is tied to one another: it is eliminated as it stands.
            for k in range(begin, end):
                i = members[k]
                for j in range(starts[i], starts[i] + counts[i]):
                    x = lists[j]
                    if bounds[2 * x] >= 0 and parents[x] < 0:
                        parents[x] = i
                parents[i] = members[k + 1] if k + 1 < end else -1
                bounds[2 * i], bounds[2 * i + 1] = k + 1, end
            break
        for k in range(begin, end):
            stamp += 1
            degrees[members[k]] = degree(members[k], starts, counts, lists, bounds, members, mark, stamp)
    order = filled(n, 0)
    children_first(parents, order, filled(3 * n, 0))
    return order, parents, bounds, members
