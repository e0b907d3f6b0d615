# SPDX-License-Identifier: MIT
"""The add-on's manifest, by the rules of Blender's own tool for extensions."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import bpy
import pytest

MANIFEST = Path(__file__).resolve().parents[2] / "blender_addon" / "shlight_blender" / "blender_manifest.toml"
TOOL = Path(bpy.utils.system_resource("SCRIPTS")) / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"


@pytest.mark.skipif(not TOOL.is_file(), reason="this Blender has no tool for extensions")
def test_manifest_is_valid() -> None:
    specification = importlib.util.spec_from_file_location("blender_ext", TOOL)
    assert specification is not None
    assert specification.loader is not None
    tool = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(tool)
    found = tool.pkg_manifest_from_toml_and_validate_all_errors(str(MANIFEST), strict=True)
    assert not isinstance(found, list), found
    assert found.permissions is not None
