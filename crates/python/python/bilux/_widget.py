"""A view as a widget, where anywidget is installed."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._view import View

# The mouse's moves are summed up, and sent once for each frame of the browser.
SCRIPT = """
export default {
  render({ model, el }) {
    const [image, caption] = [document.createElement("img"), document.createElement("div")];
    Object.assign(image, { width: model.get("width"), height: model.get("height"), draggable: false });
    image.style.cssText = "cursor: grab; touch-action: none; background: #8884";
    caption.style.cssText = "font: 12px sans-serif; opacity: 0.7";
    el.append(image, caption);
    let address = null;
    const show = () => {
      const bytes = model.get("png");
      if (bytes && bytes.byteLength) {
        if (address) URL.revokeObjectURL(address);
        address = URL.createObjectURL(new Blob([bytes], { type: "image/png" }));
        image.src = address;
      }
      caption.textContent = model.get("caption");
    };
    model.on("change:png", show);
    model.on("change:caption", show);
    show();
    let moved = { drag: [0, 0], zoom: 1 }, waits = false;
    const send = () => {
      waits = false;
      model.send(moved);
      moved = { drag: [0, 0], zoom: 1 };
    };
    const soon = () => {
      if (!waits) requestAnimationFrame(send);
      waits = true;
    };
    image.addEventListener("pointerdown", (event) => image.setPointerCapture(event.pointerId));
    image.addEventListener("pointermove", (event) => {
      if (!event.buttons) return;
      moved.drag[0] += event.movementX / image.width;
      moved.drag[1] += event.movementY / image.height;
      soon();
    });
    image.addEventListener("wheel", (event) => {
      event.preventDefault();
      moved.zoom *= Math.exp(-event.deltaY / 500);
      soon();
    }, { passive: false });
  },
};
"""


def of(view: View) -> Any:
    """The view's widget; None without anywidget."""
    try:
        anywidget, traitlets = import_module("anywidget"), import_module("traitlets")
    except ImportError:
        return None
    members = {
        "_esm": SCRIPT,
        "png": traitlets.Bytes().tag(sync=True),
        "caption": traitlets.Unicode().tag(sync=True),
        "width": traitlets.Int().tag(sync=True),
        "height": traitlets.Int().tag(sync=True),
    }
    width, height = view.size
    widget = type("ViewWidget", (anywidget.AnyWidget,), members)(width=width, height=height)

    def show(png: bytes, caption: str) -> None:
        with widget.hold_sync():
            widget.caption = caption
            if png:
                widget.png = png

    view.show(show)
    widget.on_msg(lambda _widget, message, _buffers: view.receive(message) if isinstance(message, dict) else None)
    return widget
