"""The layout of an island's array of integers, as named indices; the section of its Jacobian stands at the end."""

TRIPLES_AT, TRIPLES, FREES_AT, FREES, TIED, TABLE_AT, RANGES_AT, SLOPES_AT = range(8)
TERMS, EXACT, LOCAL, AFTER, SETTLING, MOTIONS, DRIFTS, LIMITS, GROUPS, CALLS_AT, GROUPS_AT = range(8, 19)
CALLS = 2
"""All indices are absolute.

TRIPLES_AT: the TRIPLES triples (POSITION, VELOCITY, COUNT) of pairs. FREES_AT: FREES pairs (offset in y, number of
entries), one for each force-free motion. TIED: whether drifts are corrected to end where ties hold. TABLE_AT: the start
of every block and the end of the last. RANGES_AT: the first pair of every exact contact, and the end. SLOPES_AT: the
section of the Jacobian. Block 0 is the program of the values that vary in time.

A group is a run of blocks with the same kernel. GROUPS_AT: the index in the table of each group's first block. TERMS to
LIMITS: the first group of each stage, in the order of Structure. GROUPS: the number of groups. CALLS_AT: for each group
CALLS addresses, which march.driver writes. The first is that of its kernel, or, for a kernel that is compiled at its
first call (motions and drifts), of the place of its address. The second is the impact of an exact contact's gap, the
place of a term's energy, or 0."""
POSITION, VELOCITY, COUNT, TRIPLE = range(4)

VALUES, ENTRIES, BLOCKS, BLOCK_TILES, MASSES_AT, MASSES, BLOCKS_AT, BLOCK_PARTS_AT = range(8)
SINGLES, SINGLE_TILES, SINGLES_AT, SINGLE_PARTS_AT, ENTRY, THREADS, BLOCK_TILE_AT, SINGLE_TILE_AT = range(8, 16)
KERNELS, KERNELS_AT, BORDERED, HEAD = range(16, 20)
"""The section of the Jacobian. VALUES, ENTRIES: the number of its values, and of the entries of slopes behind them.
MASSES_AT: triples (velocity_at, inverse_at, count). ENTRY, THREADS: the result of threads_kernels.threads.
BLOCK_TILE_AT, SINGLE_TILE_AT: addresses of the tiles' kernels. KERNELS: number of slopes kernels, one for each group.
KERNELS_AT: for each kernel CALLS addresses, which march.driver writes: its own, and the place of the address of the
kernel of positive slopes where that is another one, or 0. BORDERED: whether slopes need the rate (Slopes.border). From
HEAD on: the first term of every group and the end of the last; a term is (start and end of its integers, start and end
of its entries).

BLOCKS_AT: for each block the start of its parts and the offset of its rows' inverse mass (-1: none). SINGLES_AT: for
each value outside blocks, or block value with single entries, (value, inverse mass, start of its parts). A part is k
where entry k (a block's first) is added, -1 - k where it is subtracted."""
