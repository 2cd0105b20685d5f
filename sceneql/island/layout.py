"""The layout of an island's array of integers, with the section of its Jacobian at the end: indices by name."""

TRIPLES_AT, TRIPLES, FREES_AT, FREES, TIED, TABLE_AT, RANGES_AT, SLOPES_AT = range(8)
TERMS, EXACT, LOCAL, AFTER, SETTLING, MOTIONS, DRIFTS, LIMITS, GROUPS, CALLS_AT, GROUPS_AT = range(8, 19)
CALLS = 2
"""All indices are absolute. At TRIPLES_AT: TRIPLES triples (POSITION, VELOCITY, COUNT) of pairs; at FREES_AT:
FREES times offset and number of the entries of y that a free motion moves; TIED: whether drifts end where ties hold; at
TABLE_AT: the start of every block and the end of the last; at RANGES_AT: the first pair of every exact contact and the
end. Block 0 is the program of the values that vary in time. At SLOPES_AT: the section of the Jacobian.

A group is a run of blocks with the same kernel; at GROUPS_AT: the index in the table of each group's first block. TERMS
to LIMITS: the first group of each stage, in the order of Structure; GROUPS: how many there are. At CALLS_AT, for each
group, CALLS addresses, which march.driver writes: that of its kernel, or of the place of one that is compiled at its
first call (motions and drifts); and that of what belongs to it: of an exact contact's gap the impact, of a term the
place of its energy, or 0."""
POSITION, VELOCITY, COUNT, TRIPLE = range(4)

VALUES, ENTRIES, BLOCKS, BLOCK_TILES, MASSES_AT, MASSES, BLOCKS_AT, BLOCK_PARTS_AT = range(8)
SINGLES, SINGLE_TILES, SINGLES_AT, SINGLE_PARTS_AT, ENTRY, THREADS, BLOCK_TILE_AT, SINGLE_TILE_AT = range(8, 16)
KERNELS, KERNELS_AT, BORDERED, HEAD = range(16, 20)
"""The section of the Jacobian: numbers of its VALUES and of the ENTRIES of slopes behind them; at MASSES_AT triples
(velocity_at, inverse_at, count); the result of threads_kernels.threads, and the addresses of the tiles' kernels; the
number of KERNELS, one for each group, and at KERNELS_AT for each CALLS addresses, which march.driver writes: its own,
and the place of that of positive slopes where that is another, or 0; whether slopes need the rate (Slopes.border). From
HEAD on the first term of every group and the end of the last; a term is (start and end of its integers, start and end
of its entries).

At BLOCKS_AT, for each block: the start of its parts and the offset of its rows' inverse mass (-1: none). At SINGLES_AT,
for each value outside blocks or block value with single entries: value, inverse mass, start of its parts. A part is
entry k (a block's first) to be added, or -1 - k to be subtracted."""
