"""The layout of an island's array of integers, with the section of its Jacobian at the end: indices by name."""

TRIPLES_AT, TRIPLES, FREES_AT, FREES, TIED, TABLE_AT, RANGES_AT, SLOPES_AT, GROUPS_AT = range(9)
"""All indices are absolute. At TRIPLES_AT: TRIPLES triples (POSITION, VELOCITY, COUNT) of pairs; at FREES_AT:
FREES times offset and number of the entries of y that a free motion moves; TIED: whether drifts end where ties hold; at
TABLE_AT: the start
of every block and the end of the last; at RANGES_AT: the first pair of every exact contact and the end. Block 0 is the
program of the values that vary in time. A group is a run of blocks with the same kernel; at GROUPS_AT: the index in the
table of each group's first block. At SLOPES_AT: the section of the Jacobian, which has a kernel of its own, so that
explicit solvers compile nothing of it."""
POSITION, VELOCITY, COUNT, TRIPLE = range(4)

VALUES, ENTRIES, BLOCKS, BLOCK_TILES, MASSES_AT, MASSES, BLOCKS_AT, BLOCK_PARTS_AT = range(8)
SINGLES, SINGLE_TILES, SINGLES_AT, SINGLE_PARTS_AT, ENTRY, THREADS, BLOCK_TILE_AT, SINGLE_TILE_AT, HEAD = range(8, 17)
"""The section of the Jacobian: numbers of its VALUES and of the ENTRIES of slopes behind them; at MASSES_AT triples
(velocity_at, inverse_at, count); the result of threads_kernels.threads, and the addresses of the tiles' kernels. From
HEAD on the first term of every group and the end of the last; a term is (start and end of its integers, start and end
of its entries).

At BLOCKS_AT, for each block: the start of its parts and the offset of its rows' inverse mass (-1: none). At SINGLES_AT,
for each value outside blocks or block value with single entries: value, inverse mass, start of its parts. A part is
entry k (a block's first) to be added, or -1 - k to be subtracted."""
