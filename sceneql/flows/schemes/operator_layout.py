"""The integers of a field's operator of viscosity or diffusion (operators_kernels), by their places."""

from sceneql.flows.layout import PLAN

DECAYS, SIZES_AT, TALLY, EXACT, PLANS_AT = 9, 12, 13, 14, 15
"""Tables of decay rates by mode along x, y, z; of sizes; the entry that tells what has come in, or -1; 1: transforms
solve it; the plans of these."""
ODD = PLANS_AT + 3 * PLAN
"""In the tables: where the equation is not the box's, as beside_solids_kernels takes it; -1: not to be used."""
LINES = ODD + 1
"""Of a flat field, in the tables: for which a the store of lines_kernels behind these is filled; what ties are along y,
in parts of a; numbers of the store, and where it begins. -1: there is none."""
A_OF, TIE_OF, SIZE_OF, STORE_OF = range(4)
OPERATOR = LINES + 1
"""Number of integers."""
