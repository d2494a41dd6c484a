"""Webgui scenes of executed notebooks as plain HTML: live pictures without a notebook server.

A widget's state holds what the browser has to draw. It goes to a script of its own, which the page
loads when the picture comes into view; no page needs anything from elsewhere.
"""

import json

__all__ = ["TakeScenes"]

VIEW = "application/vnd.jupyter.widget-view+json"
STATE = "application/vnd.jupyter.widget-state+json"


def TakeScenes(notebook, name):
    """Replace the widgets in the outputs of `notebook` by boxes; returns the scenes by name."""
    state = notebook.metadata.pop("widgets", {}).get(STATE, {}).get("state", {})
    scenes = {}
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            view = output.get("data", {}).get(VIEW)
            if view is None:
                continue
            widget = state[view["model_id"]]["state"]
            key = f"{name}-{len(scenes) + 1}"
            scenes[key] = widget["value"]
            size = f"width: {widget['width']}; height: {widget['height']}"
            output["data"] = {
                "text/html": f'<div class="webgui" data-scene="{key}" style="{size}"></div>'
            }
    return scenes


def Script(key, scene):
    """The scene as a script, since browsers do not let pages on a disk read other files."""
    return f"webguiScenes[{json.dumps(key)}] = {json.dumps(scene)};\n"
