"""How the integers of an island lie in its one array, and behind them the section of its Jacobian: indices by name."""

TRIPLES_AT, TRIPLES, TABLE_AT, RANGES_AT, SLOPES_AT, GROUPS_AT = range(6)
"""All indices are absolute. At TRIPLES_AT so many triples (POSITION, VELOCITY, COUNT) of pairs; at TABLE_AT the start
of every block and the end of the last; at RANGES_AT the first pair of every exact contact and the end. Block 0 is the
program of the values that vary in time; a group is a run of blocks with the same kernel, and from GROUPS_AT on stands
where in the table the first of each is. At SLOPES_AT the section of the Jacobian, which has a kernel of its own, so
that explicit solvers compile nothing of it."""
POSITION, VELOCITY, COUNT, TRIPLE = range(4)

VALUES, ENTRIES, BLOCKS, BLOCK_TILES, MASSES_AT, MASSES, BLOCKS_AT, BLOCK_PARTS_AT = range(8)
SINGLES, SINGLE_TILES, SINGLES_AT, SINGLE_PARTS_AT, ENTRY, THREADS, BLOCK_TILE_AT, SINGLE_TILE_AT, HEAD = range(8, 17)
"""Of the section: how many VALUES the Jacobian has, and ENTRIES of slopes, which stand behind them; at MASSES_AT so
many triples (velocity_at, inverse_at, count); what threads_kernels.threads gives, and the addresses of the tiles'
kernels. From HEAD on the first term of every group and the end of the last; a term is (first and last of its integers,
first and last of its entries).

At BLOCKS_AT of each block where its parts start, and which of the floats is the inverse mass of its rows (-1: none). At
SINGLES_AT the values outside blocks, and those inside to which single entries are added: value, inverse mass, where its
parts start. A part is an entry, k (of a block its first), or, to be taken away, -1 - k."""
