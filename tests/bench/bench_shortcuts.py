"""What each replacement of a part of numba saves: processor time of compiling KERNELS without it, and with all.

    python tests/bench/bench_shortcuts.py [RUNS [NAME...]]    least of RUNS (5); all replacements, or those named

Each run is a fresh process with an empty cache that compiles on one thread; its imports count, since some replacements
save those. The share is what a replacement saves of the time that compiling takes without it. The variants take turns,
so that what slows the machine for a while slows them alike.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import nullcontext
from importlib import import_module

KERNELS = (
    "sceneql.bodies.bodies_kernels",
    "sceneql.bodies.bodies_slopes_kernels",
    "sceneql.bodies.emitter_kernels",
    "sceneql.bodies.mass_spring_energy_kernels",
    "sceneql.bodies.mass_spring_slopes_kernels",
    "sceneql.bodies.pins_kernels",
    "sceneql.bodies.tear_kernels",
    "sceneql.compiled.start_threads_kernels",
    "sceneql.contacts.carry_kernels",
    "sceneql.contacts.hit_kernels",
    "sceneql.contacts.moving_kernels",
    "sceneql.contacts.mutual.sphere_events_kernels",
    "sceneql.contacts.mutual.sphere_hit_kernels",
    "sceneql.contacts.near_kernels",
    "sceneql.contacts.resting_ties_kernels",
    "sceneql.contacts.search_kernels",
    "sceneql.contacts.shapes.box_kernels",
    "sceneql.grids.drift_slopes_kernels",
    "sceneql.stepping.radau_stages_kernels",
    "sceneql.words.forces.drag_kernels",
    "sceneql.words.forces.gravity_kernels",
)


def without_own_pipelines() -> None:
    """All passes of numba, its lowering and its libraries of code."""
    from sceneql.compiled.numba import kernel_compiler

    kernel_compiler.PIPELINES = ({}, {}, {})


def without_own_lowering() -> None:
    """numba's lowering of statements, and freeing of all variables."""
    from numba.core.lowering import Lower
    from numba.core.typed_passes import IRLegalization

    from sceneql.compiled.numba import kernel_compiler

    for lowering in (kernel_compiler.KernelLowering, kernel_compiler.HelperLowering):
        lowering.lowering_class = Lower
    kernel_compiler.FRONT = (*kernel_compiler.FRONT[:-1], IRLegalization)


def without_unchecked_modules() -> None:
    """numba's way of taking in LLVM's words."""
    from sceneql.compiled.numba import kernel_compiler

    del kernel_compiler.KernelLibrary.add_ir_module


def without_object_code() -> None:
    """LLVM's words of a kernel in the cache, beside its machine code."""
    from sceneql.compiled.numba import kernel_compiler

    del kernel_compiler.KernelLibrary.serialize_using_object_code


def without_helper_library() -> None:
    """Machine code for helpers, which nobody calls."""
    from sceneql.compiled.numba import kernel_compiler

    for name in ("_optimize_final_module", "_finalize_final_module"):
        delattr(kernel_compiler.HelperLibrary, name)


def without_calls_by_name() -> None:
    """Each kernel's code in all kernels that call it."""
    from sceneql.compiled import kernels

    kernels.call_by_name = lambda *_: None


def without_python_entries() -> None:
    """What Python calls a kernel by, made with every kernel that Python may call."""
    from sceneql.compiled import kernels

    kernels.UNWRAPPED["no_cpython_wrapper"] = False


def without_collecting_later() -> None:
    """The garbage collector at work while numba compiles."""
    from sceneql.compiled import kernels

    kernels.collecting_later = nullcontext


def without_any() -> None:
    """numba as it is."""


OTHERS: dict[str, Callable[[], None]] = {
    name.removeprefix("without_"): act
    for name, act in dict(globals()).items()
    if name.startswith("without_") and callable(act)
}


def replacements() -> list[str]:
    """Names of what replaces parts of numba for a whole process."""
    from sceneql.compiled.numba import kernel_compiler

    return [one.__name__ for one in kernel_compiler.REPLACEMENTS]


def compile_all(without: str) -> None:
    """What a process does."""
    if without != "any":
        from sceneql.compiled.numba import kernel_compiler

        kernel_compiler.REPLACEMENTS[:] = [one for one in kernel_compiler.REPLACEMENTS if one.__name__ != without]
    if without in OTHERS:
        OTHERS[without]()
    for module in KERNELS:
        import_module(module)


def spent(without: str) -> float:
    """Processor seconds of a process."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "SCENEQL_CACHE": cache, "SCENEQL_NUMBA": "plain" if without == "any" else ""}
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, __file__, "--compile", without], env=environment, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Print the table."""
    if sys.argv[1:2] == ["--compile"]:
        compile_all(sys.argv[2])
        return
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    names = ["", *(sys.argv[2:] or [*replacements(), *OTHERS])]
    least = dict.fromkeys(names, float("inf"))
    for _ in range(runs):
        for name in names:
            least[name] = min(least[name], spent(name))
    whole = least.pop("")
    print(f"{'without':28s} {'processor s':>12s} {'saved':>8s}\n{'nothing':28s} {whole:12.2f}")
    for name, seconds in sorted(least.items(), key=lambda item: -item[1]):
        print(f"{name:28s} {seconds:12.2f} {1.0 - whole / seconds:8.1%}")


if __name__ == "__main__":
    main()
