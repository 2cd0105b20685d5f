"""The layout of the integers of an island's ties, and of each of them: indices by name."""

MOVERS, ROWS, MOVERS_AT, ROWS_AT, SHARED_AT, PLAN_AT, PLAN = range(7)
MOVED_AT, VALUES_AT, VALUES, FACTORS_AT, FACTORS, WORK_AT, WORK, RIGHT_AT, KEPT_AT, EASE_AT, TIE_AT, TIES = range(7, 19)
TIES_AT, DIAGONAL_AT, ENDED_AT, CHAIN_AT, HEAD = range(19, 24)
"""Integers of an island's ties: numbers of movers and rows; where the integers of both, of the movers that ties share
and of the plan begin, and how many the last are; offsets into the floats and sizes of what movers, matrix, factors,
scratch and right hand side take, and what drifts keep (rattle_kernels); of EASE; of T of a tie; the number of ties and
where their SIDES begin; the offset of the matrix's diagonal; where the last of what follows begins; the offset of what
tie_chain_kernels need, -1 where ties are not chains. Of chains there are factors alone, and no values. Else few rows
have a matrix that is whole, its factors in place, and no plan, or it is in blocks of two ties (rows of one x rows of
the other), as they are read. A mover that ties share: their number n and its own; where the one before begins (-1:
none), and which half of T it has; of each tie OF_TIE: its first row, how many it has, their floats at its side, whether
its own block is complete with this mover; then n x n, twice where the block of two ties begins (-1: it is not read),
and 1 where nothing is there yet. They stand in the order in which ties have had all of theirs."""
SHARERS, SHARED_MOVER, BEFORE, HALF, OF_SHARED = range(5)
OF_TIE = 4
ROWS_OF, ROWS_FROM, ONE, OTHER, KINDS, NUMBERS_FROM, STRIDE, TIE_HOLDS, MARKS = range(9)
FIRST_ROW, FACTORS_FROM, PARENT, CHILDREN, SIDES = 9, 10, 11, 12, 14
"""Integers of a tie: how many rows, offset of the first one's floats; its movers; the kinds of its rows, KIND_BITS
each, the first one lowest; offset of the numbers of the first one, and of each further one that has some from there; of
whether it holds; marks; the number of its first row. Of chains: the offset of its factors; the tie that is eliminated
after it and has a mover of it (-1: none); of each of its movers twice the tie that is eliminated before it and has
that mover, and 1 where that is the other one of that tie (-1: none)."""
KIND_BITS = 3
FRESH, LAST, SOLVED = 1, 4, 16
"""Marks of ONE, and times 2 of OTHER: no tie before has this mover; none behind has it, and it is solved; it is
solved."""
KEPT = 12
"""Floats of a row that drifts keep of where they began: J."""
MOST_ROWS, LANES = 6, 8
"""Rows that a tie of chains may have; numbers in a register."""
MOST_AT, DEPENDENT_AT, COLUMNS, WEIGHED, CHAIN = 0, 1, 8, 136, 232
"""Floats at CHAIN_AT: the largest part diagonal / pivot, infinite where the matrix cannot be factored; the part of its
diagonal above which a pivot must be; J of a tie, turned over, by each of its movers; T by each."""


def of_chain(rows: int) -> int:
    """How many factors a tie of chains has, of so many rows."""
    return 2 * LANES * rows
