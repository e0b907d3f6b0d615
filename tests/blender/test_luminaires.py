# SPDX-License-Identifier: MIT
"""Lamps with an IES Texture beside Cycles."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import pytest
from luminaires import luminaire

SLOW = pytest.mark.slow
TURNED = {"rotation_euler": (0.5, 0.3, 0.8), "visible_camera": False}
LAMPS: dict[str, tuple[str, dict[str, Any]]] = {
    "point": ("POINT", {"shadow_soft_size": 0.0}),
    "disk": ("POINT", {"shadow_soft_size": 0.3}),
    "sphere": ("POINT", {"shadow_soft_size": 0.3, "use_soft_falloff": False}),
    "spot": ("SPOT", {"shadow_soft_size": 0.2, "spot_size": 1.6, "spot_blend": 0.4}),
    "scaled": ("SPOT", {"shadow_soft_size": 0.0, "spot_size": 1.6, "scale": (1.0, 2.0, 0.7)}),
    "area": ("AREA", {"shape": "RECTANGLE", "size": 0.8, "size_y": 0.4}),
    "narrow": ("AREA", {"shape": "DISK", "size": 0.8, "spread": 1.4}),
}


def lit(studio: Any, lamp: Any, text: str) -> Any:
    """Lets a lamp shine as a luminaire; returns the IES Texture node."""
    lamp.data.use_nodes = True
    tree = lamp.data.node_tree
    node = tree.nodes.new("ShaderNodeTexIES")
    node.ies = bpy.data.texts.new("Luminaire")
    node.ies.write(text)
    shown = next(node for node in tree.nodes if node.type == "EMISSION")
    tree.links.new(node.outputs["Fac"], shown.inputs["Strength"])
    shown.inputs["Color"].default_value = (1.0, 0.8, 0.5, 1.0)
    return node


@pytest.mark.parametrize("case", [name if name == "point" else pytest.param(name, marks=SLOW) for name in LAMPS])
def test_it_lights_floors_as_in_cycles(studio: Any, case: str) -> None:
    kind, properties = LAMPS[case]
    lamp = studio.lamp(kind, 3.0, (0.3, -0.4, 1.3), **(TURNED | properties))
    lit(studio, lamp, luminaire("half"))
    studio.floors()
    assert studio.messages() == []
    studio.compare(mean=3e-3, error=3e-3)


def test_a_file_beside_the_scene(studio: Any, tmp_path: Path) -> None:
    lamp = studio.lamp("POINT", 3.0, (0.3, -0.4, 1.3), **TURNED)
    node = lit(studio, lamp, "")
    node.mode, node.filepath = "EXTERNAL", str(tmp_path / "lamp.ies")
    studio.floors()
    (message,) = studio.messages()
    assert "its file cannot be read" in message
    Path(node.filepath).write_text(luminaire("quarter"))
    assert studio.messages() == []
    studio.compare(mean=3e-3, error=3e-3)
