"""The names of the linear solvers on grids, for the fields of solvers."""

from __future__ import annotations

from typing import Literal

Linear = Literal["auto", "direct", "multigrid", "conjugate_gradient", "gauss_seidel", "sor", "fast_transform"]
