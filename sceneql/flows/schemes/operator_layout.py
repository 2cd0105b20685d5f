"""The integers of a field's operator of viscosity or diffusion (operators_kernels), by their places."""

from sceneql.flows.layout import PLAN

DECAYS, SIZES_AT, TALLY, EXACT, PLANS_AT = 9, 12, 13, 14, 15
"""Tables of decay rates by mode along x, y, z; of sizes; the entry that tells what has come in, or -1; 1: transforms
solve it; the plans of these."""
ODD = PLANS_AT + 3 * PLAN
"""From and to before which cell along x, y, z the equation is not the box's; -1: not known, or not to be used."""
OPERATOR = ODD + 6
"""Number of integers."""
