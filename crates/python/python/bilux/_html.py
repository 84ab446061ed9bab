"""A view as plain HTML, without anywidget: a comm brings pictures and takes the mouse's moves, in notebooks that let a page reach
it. Elsewhere it shows a finished picture."""

from __future__ import annotations

import base64
import uuid
from importlib import import_module
from typing import TYPE_CHECKING, Any

from ._mouse import FOLLOW_MOUSE

if TYPE_CHECKING:
    from ._view import View

PATIENCE = 3.0
"""Seconds that the first picture may take until the cell shows what there is."""

PAGE = """
<div id="ID"><img width="WIDTH" height="HEIGHT" draggable="false" style="touch-action: none" src="data:image/png;base64,PNG">
<div style="font: 12px sans-serif; opacity: 0.7">CAPTION</div></div>
<script>
(() => {
FOLLOW
  const kernel = window.Jupyter && Jupyter.notebook && Jupyter.notebook.kernel;
  if (!kernel) return;
  const [image, caption] = document.getElementById("ID").children;
  image.style.cursor = "grab";
  const comm = kernel.comm_manager.new_comm("ID", {});
  comm.on_msg((message) => {
    const { png, text } = message.content.data;
    if (png) image.src = "data:image/png;base64," + png;
    caption.textContent = text;
  });
  followMouse(image, (moved) => comm.send(moved));
})();
</script>
"""


def shown(view: View) -> dict[str, Any]:
    """What a notebook displays: HTML, and a PNG for notebooks that run no scripts."""
    picture = view.wait(PATIENCE)
    target = f"bilux-view-{uuid.uuid4().hex}"
    manager = _comms()
    if manager is not None:
        manager.register_target(target, lambda comm, _opened: connect(view, comm))
    png = base64.b64encode(picture._repr_png_()).decode()
    width, height = view.size
    caption = f"{picture.info['spp']} samples per pixel (with the package anywidget, the mouse turns it)"
    texts = {"FOLLOW": FOLLOW_MOUSE, "ID": target, "WIDTH": str(width), "HEIGHT": str(height), "CAPTION": caption, "PNG": png}
    page = PAGE
    for name, text in texts.items():
        page = page.replace(name, text)
    return {"text/html": page, "image/png": png, "text/plain": repr(view)}


def connect(view: View, comm: Any) -> None:
    """Sends pictures to a comm, and takes what it sends."""
    view.show(lambda png, text: comm.send({"png": base64.b64encode(png).decode(), "text": text}))
    comm.on_msg(lambda message: view.receive(message["content"]["data"]))


def _comms() -> Any:
    """The kernel's comms; None outside a notebook."""
    try:
        shell = import_module("IPython").get_ipython()
    except ImportError:
        return None
    kernel = getattr(shell, "kernel", None)
    return getattr(kernel, "comm_manager", None)
