"""Mesh files of every format, and what becomes of them by chance. As a program, it reads many: (how many, the first).

Run by test_mesh_fuzz.py in a process of its own, whose memory and processor time for each file have limits.
"""

import base64
import json
import random
import re
import resource
import signal
import sys
import tempfile
from pathlib import Path

import numpy as np
import trimesh

from sceneql.failure import LimitRefused
from sceneql.kinds import Exceeds
from sceneql.shapes import read_mesh
from sceneql.shapes.mesh_header import declared

SECONDS = 5
MEMORY = 300 * 2**20
OBJ = """mtllib a.mtl
o a
v 0 0 0
v 1 0.25 0 # a comment
v 1 1 .5e0
v 0 1 1.00000000000000000001
v 0.5 0.5 1 1 0 0.5
vt 0.5 0.5
vn 0 0 1
usemtl b
s 1
f 1 2 3 4
f 1/1/1 2/1/1 5//1
f -3/1 -2 \\
 -1
f 3 4 5 1 2
"""
EXTREMES = (
    b"0", b"-1", b"1e999", b"-1e308", b"nan", b"inf", b"4294967295", b"-2147483649", b"99999999999999999999", b"1e-400",
    b"true", b"null", b"[]", b"{}", b'""', b"1.5", b"3", b"\\\n", b"/", b"#", b"\n", b"\r", b"\0", b"\xff",
)  # fmt: skip


def embedded(scene):
    """A scene as glTF with its numbers inside."""
    files = scene.export(file_type="gltf")
    tree = json.loads(files["model.gltf"])
    for buffer in tree["buffers"]:
        buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(files[buffer["uri"]]).decode()
    return json.dumps(tree).encode()


def samples():
    """By format the bytes of whole files."""
    ball = trimesh.creation.icosphere(1)
    ball.visual.vertex_colors = np.abs(255 * ball.vertices).astype(np.uint8)
    scene = trimesh.Scene()
    scene.add_geometry(ball, node_name="a", transform=trimesh.transformations.translation_matrix([5, 0, 0]))
    mirror = np.diag([-2.0, 2.0, 2.0, 1.0])
    scene.add_geometry(trimesh.creation.box(), node_name="b", parent_node_name="a", transform=mirror)
    quads = b"OFF\n5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n4 0 1 2 3\n3 0 1 4\n"
    mixed = b"ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    mixed += b"element face 2\nproperty list uchar int vertex_indices\nend_header\n" + quads.partition(b"0\n")[2]
    return {
        "obj": [OBJ.encode(), ball.export(file_type="obj").encode()],
        "ply": [ball.export(file_type="ply"), ball.export(file_type="ply", encoding="ascii"), mixed],
        "stl": [ball.export(file_type="stl"), ball.export(file_type="stl_ascii").encode()],
        "off": [quads, ball.export(file_type="off").encode()],
        "glb": [scene.export(file_type="glb")],
        "gltf": [embedded(scene)],
    }


def mutant(data, chance):
    """A file with one to four accidents."""
    for _ in range(chance.choice([1, 1, 1, 2, 4])):
        at, to = sorted(chance.randrange(len(data) + 1) for _ in range(2))
        to = min(to, at + chance.choice([1, 4, 40, 4000]))
        numbers = list(re.finditer(rb"[-+.\d]+(?:e[-+]?\d+)?|\w+", data[:4000])) or [re.match(b"", data)]
        number = chance.choice(numbers)
        how = chance.randrange(8)
        if how == 0:
            data = data[:at] + bytes(chance.randrange(256) for _ in range(min(to - at, 8))) + data[to:]
        elif how == 1:
            data = data[:at] + data[to:]
        elif how == 2:
            data = data[:to] + data[at:to] * chance.choice([1, 1, 100]) + data[to:]
        elif how == 3:
            data = data[:at]
        elif how == 4 or how == 5:
            data = data[: number.start()] + chance.choice(EXTREMES) + data[number.end() :]
        elif how == 6:
            data = data[:at] + chance.choice(EXTREMES) + data[at:]
        else:
            lines = data.split(b"\n")
            one, other = (chance.randrange(len(lines)) for _ in range(2))
            lines[one], lines[other] = lines[other], lines[one]
            data = b"\n".join(lines)
    return data


def too_long(*_):
    """End a read that has taken its time."""
    raise TimeoutError(f"more than {SECONDS} s of processor time")


def read(path):
    """Whether a file was read; one that was not was refused as a user sees it."""
    try:
        declared(str(path))
        read_mesh.load(str(path), 0.7)
    except (OSError, LimitRefused, Exceeds) as error:
        told = str(error).removeprefix("error[limit-refused]: ")
    else:
        return True
    assert told.startswith(path.name), told
    assert told.isprintable(), repr(told)
    return False


def main(count, first):
    """Read mutants by their numbers; prints how many were read, of how many of each format."""
    every = samples()
    kinds = [*every, *["obj"] * len(every)]  # every second one is an OBJ
    found = dict.fromkeys(every, 0)
    signal.signal(signal.SIGPROF, too_long)
    with tempfile.TemporaryDirectory() as folder:
        for form, files in every.items():  # compile, and import
            for number, data in enumerate(files):
                path = Path(folder) / f"whole{number}.{form}"
                path.write_bytes(data)
                assert read(path), path.name
        in_use = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (in_use + MEMORY, -1))
        for number in range(first, first + count):
            chance = random.Random(number)
            form = kinds[number % len(kinds)]
            path = Path(folder) / f"{number}.{form}"
            data = mutant(chance.choice(every[form]), chance)
            path.write_bytes(data)
            signal.setitimer(signal.ITIMER_PROF, SECONDS)
            try:
                found[form] += read(path)
            except BaseException:
                print(f"the mutant {number} of {form}: {data[:2000]!r}", file=sys.stderr)
                raise
            signal.setitimer(signal.ITIMER_PROF, 0)
            path.unlink()
    print(json.dumps(found))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
