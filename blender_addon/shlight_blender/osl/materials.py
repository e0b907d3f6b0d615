# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that emit what they reflect of lamps: nodes beside those of their surface, put in and taken out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import bpy

from ..compat import uses_nodes
from ..names import name_of
from . import script

MARK = "shlight_osl"  # on the nodes that are put in: the lamp of a group's node, a number on others
EMISSION = "shlight_emission_sampling"  # on a material: Cycles' setting from before
UNLIT = {"EMISSION", "BSDF_TRANSPARENT", "HOLDOUT"}
LOBES = {"GGX": 1, "MULTI_GGX": 2}
NORMALIZED = "1/(4*pi)"


def problem_of_lamp(lamp: Any) -> str:
    """Why a lamp's light cannot be put into materials, "" if it can."""
    if lamp.data.type != "POINT":
        return "only point lamps are supported"
    return "" if not uses_nodes(lamp.data) or _is_plain(lamp.data) else "lamps with nodes are not supported"


def _is_plain(data: Any) -> bool:
    """Whether the nodes of a lamp leave its light as it is, as those that all lamps have in Blender 5.2 do at first."""
    output = data.node_tree.get_output_node("CYCLES")
    node = output.inputs["Surface"].links[0].from_node if output and output.inputs["Surface"].links else None
    if node is None or node.type != "EMISSION" or any(socket.is_linked for socket in node.inputs):
        return False
    return (*node.inputs["Color"].default_value[:3], node.inputs["Strength"].default_value) == (1.0, 1.0, 1.0, 1.0)


def surface_nodes(material: Any) -> list[Any]:
    """The nodes of a material's surface that reflect lamps' light. Raises ValueError saying what is not supported."""
    output = material.node_tree.get_output_node("CYCLES") if uses_nodes(material) else None
    if material.library is not None or output is None:
        raise ValueError("it is linked from another file or has no surface of nodes")
    found: dict[str, Any] = {}
    waiting = [output.inputs["Surface"]]
    while waiting:
        for link in waiting.pop().links:
            node = link.from_node
            if node.type in ("MIX_SHADER", "ADD_SHADER", "REROUTE"):
                waiting += [socket for socket in node.inputs if socket.type == "SHADER"]
            elif node.type in ("BSDF_DIFFUSE", "BSDF_GLOSSY"):
                found[node.name] = node
            elif node.type not in UNLIT and MARK not in node:
                raise ValueError(f"{node.bl_label} is not supported")
            if node.mute:
                raise ValueError(f"{node.bl_label} is muted")
    for node in found.values():
        # Inputs of Diffuse BSDF and Glossy BSDF that must be 0.
        for name in ("Roughness",) if node.type == "BSDF_DIFFUSE" else ("Anisotropy",):
            if node.inputs[name].is_linked or node.inputs[name].default_value != 0.0:
                raise ValueError(f"{name} of {node.bl_label} is not supported")
        if node.type == "BSDF_GLOSSY" and node.distribution not in LOBES:
            raise ValueError(f"{node.distribution} of {node.bl_label} is not supported")
    return list(found.values())


def insert(material: Any, lamps: Iterable[Any]) -> None:
    """Adds the light of lamps to a material where it is missing; what is there takes over changes of the surface.

    Raises ValueError as `surface_nodes` does.
    """
    tree = material.node_tree
    for node in surface_nodes(material):
        there = list(_beside(node))
        for light in there:
            _take_surface(light, node, tree)
        for lamp in lamps:
            if any(light[MARK] == lamp for light in there):
                continue
            light, total = tree.nodes.new("ShaderNodeGroup"), tree.nodes.new("ShaderNodeAddShader")
            light.node_tree = script.group()
            light[MARK], total[MARK] = lamp, 1
            x, y = node.location
            light.location, total.location = (x, y - 250), (x + 200, y)
            targets = [link.to_socket for link in node.outputs[0].links]
            tree.links.new(node.outputs[0], total.inputs[0])
            tree.links.new(light.outputs[0], total.inputs[1])
            for target in targets:
                tree.links.new(total.outputs[0], target)
            _take_surface(light, node, tree)
            _follow_lamp(light, lamp)
    if EMISSION not in material:
        # Rays are not worth sending to surfaces that emit a little everywhere.
        material[EMISSION], material.cycles.emission_sampling = material.cycles.emission_sampling, "NONE"


def _beside(node: Any) -> Iterator[Any]:
    """The nodes of light that were added to a node's."""
    while node.outputs[0].links and MARK in (total := node.outputs[0].links[0].to_node):
        yield total.inputs[1].links[0].from_node
        node = total


def _take_surface(light: Any, node: Any, tree: Any) -> None:
    """Gives a light's node what the surface's node has. Drivers would make the tree depend on itself."""
    light.inputs["Lobe"].default_value = 0 if node.type == "BSDF_DIFFUSE" else LOBES[node.distribution]
    for name in ("Color", "Roughness", "Normal"):
        source, target = node.inputs[name], light.inputs[name]
        if source.is_linked:
            tree.links.new(source.links[0].from_socket, target)
        else:
            for link in target.links:
                tree.links.remove(link)
            if name != "Normal":
                target.default_value = source.default_value


def _follow_lamp(light: Any, lamp: Any) -> None:
    data = lamp.data
    for index, axis in enumerate("XYZ"):
        _drive(light.inputs["Center"], "place", {"place": (lamp, f"LOC_{axis}")}, index)
    _drive(light.inputs["Radius"], "radius", {"radius": (data, "shadow_soft_size")})
    _drive(light.inputs["Is_Disk"], "disk", {"disk": (data, "use_soft_falloff")})
    for index in range(3):
        variables = {"power": (data, "energy"), "color": (data, f"color[{index}]")}
        expression = f"power*color*{NORMALIZED}"
        if hasattr(data, "normalize"):  # and with it, since Blender 4.5, the others
            variables |= {"radius": (data, "shadow_soft_size"), "normal": (data, "normalize")}
            variables |= {"warm": (data, "use_temperature"), "hue": (data, f"temperature_color[{index}]")}
            variables["stops"] = (data, "exposure")
            expression = f"power*color*pow(2,stops)*(hue if warm else 1)*({NORMALIZED} if normal else radius*radius)"
        _drive(light.inputs["Intensity"], expression, variables, index)


def _drive(socket: Any, expression: str, variables: dict[str, tuple[Any, str]], index: int = -1) -> None:
    """Lets a value follow properties by their owners and paths, or the place of an object."""
    driver = socket.driver_add("default_value", index).driver
    for name, (owner, path) in variables.items():
        variable = driver.variables.new()
        variable.name = name
        if path.startswith("LOC_"):
            variable.type = "TRANSFORMS"
            variable.targets[0].transform_type = path
        else:
            variable.targets[0].id_type = owner.id_type
            variable.targets[0].data_path = path
        variable.targets[0].id = owner
    driver.expression = expression


def remove(material: Any) -> set[Any]:
    """Takes all that `insert` added out of a material; the lamps whose light that was."""
    tree = material.node_tree
    marked = [node for node in tree.nodes if MARK in node] if tree else []
    lamps = {node[MARK] for node in marked if node.type == "GROUP"}
    for node in marked:
        if node.type == "ADD_SHADER" and node.inputs[0].links:
            source = node.inputs[0].links[0].from_socket
            for target in [link.to_socket for link in node.outputs[0].links]:
                tree.links.new(source, target)
    for node in marked:
        for socket in node.inputs:
            socket.driver_remove("default_value")
        tree.nodes.remove(node)
    if marked and not tree.animation_data.drivers and tree.animation_data.action is None:
        tree.animation_data_clear()
    if EMISSION in material:
        material.cycles.emission_sampling = material.pop(EMISSION)
    for group in [group for group in bpy.data.node_groups if script.GROUP in group and not group.users]:
        bpy.data.node_groups.remove(group)
    return lamps - {None}


def is_lit_by(material: Any, lamp: Any) -> bool:
    """Whether a material emits the light of a lamp."""
    return bool(material and material.node_tree) and any(node.get(MARK) == lamp for node in material.node_tree.nodes)


def link_light(lamp: Any) -> list[str]:
    """Hides a lamp from the objects whose materials emit its light; remarks on what that does not do.

    The lamp gets a collection of receivers for it, which goes when it is empty.
    """
    owned, name = lamp.light_linking.receiver_collection, name_of(lamp)
    if owned is not None and MARK not in owned:
        return [f"{name} has light linking of its own, and lights the objects twice"]
    lit = [shown for shown in bpy.data.objects if any(is_lit_by(s.material, lamp) for s in shown.material_slots)]
    if owned is not None:
        bpy.data.collections.remove(owned)
    if lit:
        owned = bpy.data.collections.new(f"shlight {name}")
        owned[MARK] = 1
        lamp.light_linking.receiver_collection = owned
        for shown in lit:
            owned.objects.link(shown)
        for member in owned.collection_objects:
            member.light_linking.link_state = "EXCLUDE"
    others = [name_of(shown) for shown in lit if not all(is_lit_by(s.material, lamp) for s in shown.material_slots)]
    return [f"{name} does not light the other materials of {other}" for other in others]
