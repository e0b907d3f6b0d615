# SPDX-License-Identifier: GPL-3.0-or-later
"""Script nodes beside Cycles': scripts of Open Shading Language, whose outputs are the light of patches of faces."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import _cycles
import bpy
import numpy as np
import pytest
from test_nodes_against_cycles import RAISED, SEEDS, SIDE, Case, picture, stage

SOCKETS = {"float": "Float", "int": "Int", "color": "Color"}
# Each body makes the output R of numbers x, y and t and of vectors a and b.
BODIES = (
    "R = vector(sin(20*x), cos(20*y), tan(x));",
    "R = vector(asin(t), acos(x), atan(y));",
    "R = vector(atan2(x, y), sinh(x), cosh(2*y));",
    "R = vector(tanh(x), exp(x), exp2(y) + expm1(t) + expm1(t/100));",
    "R = vector(log(t), log2(t), log10(t) + logb(y));",
    "R = vector(pow(t, y), pow(x, 3), pow(x, 2) + pow(x, 0) + pow(t, 0.5) + pow(x, y));",
    "R = vector(cbrt(x), erf(y), erfc(t) + inversesqrt(t) + sqrt(x));",
    "R = vector(x/y, x/(y - y), mod(x, 0.3) + fmod(y, 0.3) + fmod(x, t));",
    "R = vector(floor(x) + ceil(y), round(x) + trunc(y), sign(x) + step(x, y) + smoothstep(-1, 1, x));",
    "R = vector(clamp(x, -1, 1), mix(x, y, t), max(x, y) - min(x, t) + abs(y));",
    "int i = int(10*x); int j = int(10*y); R = vector(i/3 + i%3, (i&5) + (j|8), (i^j) - (i<<2) + (j>>1) + ~i);",
    "R = vector(dot(a, b), length(a), distance(a, b)) + normalize(b) + cross(a, b);",
    "R = color(\"hsv\", x, t, 2) + luminance(a) + transformc(\"hsv\", \"rgb\", color(y, t, 1));",
    "R = vector(isnan(x), isfinite(y), isinf(t)) + (x < y) + (x >= y && t > 0.5 || x == y) + !int(x) + (a == a);",
    "float n = noise(\"uperlin\", 3*a, x); R = n + vector(noise(3*x), snoise(3*x, y), noise(\"perlin\", 3*a));",
    "float s[5]; for (int i = 0; i < 9; i++) s[i % 5] = i*x; vector w[2]; w[0] = w[1] = b; w[int(2*t)] = a;"
    " R = w[1] + s[3]; R[1] = s[int(4*t)];",
    "int i = 0; R = 0; do { i++; if (i == 3) continue; R += i*x; if (R[0] > 9) break; } while (i < 7);"
    " while (i < 20) { i += 2; R[2] += y; }",
    "float f(float q) { if (q < 0) return 1; return q*q; } R = f(x) + 2*f(y); if (t < 0.5) exit(); R[1] = 3;",
    # The chaos of a fractal shows each rounding, and 0 times what is infinite is 0 of constants alone.
    "float p = x, r = y, n = 4; int i; for (i = 0; i < 60; i++) { float w = p;"
    " p = sin(p*p - r*r) + 1e30*(r + 9)*1e30*0 + pow(t, n); r = 2*w*r + cos(w)*sinh(r); if (hypot(p, r) > 400) break; }"
    " R = vector(i/6.0, clamp(p, -1, 1), clamp(r, -1, 1));",
    "R = P/100 + N + 2*Ng + vector(I[0], u - u, v - v) + k + hidden[2] + q[1];",
)  # fmt: skip


def compiled(body: str, folder: Path) -> str:
    """The text of a script, as Blender's own compiler makes it."""
    source, result = folder / "script.osl", folder / "script.oso"
    source.write_text(
        "shader s(float x = 0, float y = 0, float t = 0, vector a = 0, vector b = 0, int k = 2,"
        f' point q = point(1, 2, 3), point hidden = P [[string widget = "null"]], output vector R = 0) {{ {body} }}'
    )
    assert _cycles.osl_compile(str(source), str(result)), body
    return result.read_text()


def script_node(tree: Any, text: str) -> Any:
    """A node of a compiled script; bpy as a module cannot make its sockets."""
    node = tree.nodes.new("ShaderNodeScript")
    node.bytecode, node.bytecode_hash = text, hashlib.md5(text.encode()).hexdigest()
    for kind, of, name, *values in (line.split() for line in text.splitlines() if line.startswith(("param", "oparam"))):
        sockets = node.inputs if kind == "param" else node.outputs
        made = sockets.new(f"NodeSocket{SOCKETS.get(of, 'Vector')}", name, identifier=name)
        if of == "point":
            made.default_value = [float(value) + 1.0 for value in values[:3]]
        elif of == "int":
            made.default_value = 5
    return node


def material(text: str, attributes: tuple[str, ...] = ("x", "y", "t", "a", "b")) -> Any:
    """A material that emits what a script gives, raised so that it is not negative."""
    made = bpy.data.materials.new("Script")
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    node = script_node(tree, text)
    for name in attributes:
        source = tree.nodes.new("ShaderNodeAttribute")
        source.attribute_name = name
        tree.links.new(source.outputs["Vector" if name in "ab" else "Fac"], node.inputs[name])
    raised = tree.nodes.new("ShaderNodeVectorMath")
    raised.inputs[1].default_value = (RAISED,) * 3
    tree.links.new(node.outputs[0], raised.inputs[0])
    lit, output = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(raised.outputs[0], lit.inputs["Color"])
    tree.links.new(lit.outputs[0], output.inputs["Surface"])
    return made


@pytest.mark.parametrize("runs", [True, False])
def test_scripts(studio: Any, tmp_path: Path, runs: bool) -> None:
    """Values of scripts; what Cycles draws where it does not run them is what sockets hold."""
    listed = [(Case(body), material(compiled(body, tmp_path))) for body in BODIES]
    stage(studio, listed)
    studio.scene.cycles.shading_system = runs
    found, references = picture(studio, "SHLIGHT"), [picture(studio, "CYCLES", seed) for seed in SEEDS]
    errors = [np.abs(np.maximum(found, 0.0) - np.maximum(own, 0.0)) for own in references]
    error = np.min(errors, axis=0) / np.maximum(1.0, np.abs(references[0]))
    assert (np.ptp(references[0][:SIDE, : SIDE * len(BODIES)]) > 1.0) == runs
    for number, (case, _) in enumerate(listed):
        own = error[:SIDE, SIDE * number :][:, :SIDE]
        # Other processors and versions round functions otherwise, which the fractal's steps multiply.
        bounds = {"snoise": 3e-4, "P/": 1e-5, "tan(": 2e-5, "sinh(r)": 0.05}
        assert own.max() <= max((bound for text, bound in bounds.items() if text in case.node), default=1e-6), case.node


def test_report_of_scripts(studio: Any, tmp_path: Path) -> None:
    """What is not supported is named; scripts of files are read."""
    ball = studio.ball()
    ball.data.materials.append(material(compiled("R = cellnoise(x);", tmp_path)))
    studio.camera(location=(0, -6, 0), target=(0, 0, 0))
    studio.scene.cycles.shading_system = True
    assert any("script uses cellnoise, which is not supported" in line for line in studio.messages())
    node = next(n for n in ball.data.materials[0].node_tree.nodes if n.type == "SCRIPT")
    compiled("R = t;", tmp_path)
    node.mode, node.filepath = "EXTERNAL", str(tmp_path / "script.osl")
    assert not any("script" in line.lower() for line in studio.messages())
    node.filepath = str(tmp_path / "missing.oso")
    assert any("it has no compiled script" in line for line in studio.messages())
